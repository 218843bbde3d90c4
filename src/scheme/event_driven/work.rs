//! How much computing one path may take.
//!
//! The steps of these schemes follow from the scene, so nobody can see in a scenario how many there
//! will be: an oscillator of 1e9 Hz that never comes to rest needs 1e15 of them for a million
//! seconds. Whatever is evaluated in a loop that the scene decides (steps, intervals of a
//! bisection, points of a root search, events) is paid for here, so that every path ends.

/// What a path may still spend.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    left: u64,
}

/// What simulating some paths came to.
#[derive(Clone, Debug, Default)]
pub struct Simulated {
    /// The lanes of those that had to be given up.
    pub lost: Vec<usize>,
    /// What was evaluated for all of them together: how long it takes, on whatever machine.
    pub evaluations: u64,
}

/// A path that spent all its work, or met a value that is not a number: it is given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unresolved;

/// Work of a path: ten seconds to two minutes of computing, as its evaluations go. Paths of
/// interest take microseconds to seconds.
pub const WORK_LIMIT: u64 = 100_000_000;

impl Work {
    /// So much of it.
    pub fn new(limit: u64) -> Self {
        Work { left: limit }
    }

    /// What is left.
    pub fn left(self) -> u64 {
        self.left
    }

    /// So many more evaluations at once, as far as they are granted.
    pub fn spend_all(&mut self, evaluations: u64) {
        self.left = self.left.saturating_sub(evaluations);
    }

    /// One more evaluation, if it is granted.
    #[inline(always)]
    pub fn spend(&mut self) -> Result<(), Unresolved> {
        self.left = self.left.checked_sub(1).ok_or(Unresolved)?;
        Ok(())
    }
}
