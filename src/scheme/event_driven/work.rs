//! A limit on the computing time of one path, and the check whether it is still wanted.
//!
//! The number of steps of these schemes follows from the dynamics and is not known in advance. For
//! example, an oscillator of 1e9 Hz that never comes to rest needs 1e15 steps for a million
//! seconds. Every evaluation in a loop whose length depends on the scene (steps, intervals of a
//! bisection, points of a root search, events) is counted here, so that the simulation of every
//! path ends, and immediately if the observer stops it.

/// The number of evaluations that a path may still make.
#[derive(Clone, Copy)]
pub struct WorkLeft<'w> {
    /// Evaluations until the next check whether the path is still wanted.
    left: u64,
    /// After it.
    later: u64,
    is_stopped: &'w dyn Fn() -> bool,
}

/// The result of simulating some paths.
#[derive(Clone, Debug, Default)]
pub struct Simulated {
    /// The lanes of the paths that had to be given up.
    pub lost: Vec<usize>,
    /// Why the first of them was; none for a scheme with a step.
    pub why: Option<Unresolved>,
    /// The number of evaluations of all paths together: a measure of computing time that does not
    /// depend on the machine. A scheme with a step does not count them.
    pub evaluations: u64,
}

/// Why a path is given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unresolved {
    /// It exceeded its number of evaluations.
    #[error("it needs more force evaluations than a path is allowed (a few seconds)")]
    TooLong,
    /// A value was not a finite number.
    #[error("the force is not finite, or the friction load is negative")]
    NoNumber,
    /// The shortest step is too long.
    #[error("the force changes too much within the shortest step")]
    TooFine,
    /// The observer stopped the simulation.
    #[error("it was stopped")]
    Stopped,
}

/// The result for a path, unless it is given up.
pub type Resolved<T> = Result<T, Unresolved>;

/// The number of evaluations that a path with noise may make. They take about ten seconds; the
/// paths of usual scenes take microseconds to seconds.
const WORK_LIMIT: u64 = 100_000_000;

/// How many times as long an evaluation takes elsewhere: in scenes without noise, and in those with
/// noise and a user-defined force.
pub const WITHOUT_NOISE: u64 = 5;
pub const OWN_FORCE: u64 = 30;

/// The number of evaluations that a path may make where each takes this many times as long.
pub const fn work_limit(cost: u64) -> u64 {
    WORK_LIMIT / cost
}

/// After this number of evaluations, a path checks whether it is still wanted. They take 0.1 to 10 ms.
const CHECK_EVERY: u64 = 1 << 10;

impl WorkLeft<'static> {
    /// A limit of `limit` evaluations.
    #[cfg(test)]
    pub fn new(limit: u64) -> Self {
        WorkLeft::watched(limit, &|| false)
    }
}

impl<'w> WorkLeft<'w> {
    /// A limit of `limit` evaluations, and of those made until `is_stopped`.
    pub fn watched(limit: u64, is_stopped: &'w dyn Fn() -> bool) -> Self {
        let left = limit.min(CHECK_EVERY);
        WorkLeft {
            left,
            later: limit - left,
            is_stopped,
        }
    }

    /// The number of remaining evaluations.
    pub fn left(self) -> u64 {
        self.left + self.later
    }

    /// Counts one evaluation; an error if none is left, or if the path is no longer wanted.
    #[inline(always)]
    pub fn spend(&mut self) -> Resolved<()> {
        match self.left.checked_sub(1) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => self.check_wanted(),
        }
    }

    /// Counts an evaluation when the next check is due.
    #[cold]
    #[inline(never)]
    fn check_wanted(&mut self) -> Resolved<()> {
        let Some(later) = self.later.checked_sub(1) else {
            return Err(Unresolved::TooLong);
        };
        if (self.is_stopped)() {
            return Err(Unresolved::Stopped);
        }
        *self = WorkLeft::watched(later, self.is_stopped);
        Ok(())
    }
}

impl std::fmt::Debug for WorkLeft<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} evaluations", self.left())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_path_makes_as_many_evaluations_as_it_may() {
        let looks = Cell::new(0);
        let look = || {
            looks.set(looks.get() + 1);
            looks.get() >= 3
        };
        for (limit, spent, why) in [
            (0, 0, Unresolved::TooLong),
            (1, 1, Unresolved::TooLong),
            (2 * CHECK_EVERY, 2 * CHECK_EVERY, Unresolved::TooLong),
            // The evaluation at which it looks counts as well.
            (10 * CHECK_EVERY, 3 * CHECK_EVERY + 2, Unresolved::Stopped),
        ] {
            looks.set(0);
            let mut work = WorkLeft::watched(limit, &look);
            let made = (0..).take_while(|_| work.spend().is_ok()).count() as u64;
            assert_eq!(
                (made, work.left(), work.spend()),
                (spent, limit - spent, Err(why)),
                "{limit}"
            );
        }
    }
}
