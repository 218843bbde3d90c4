//! A limit on the computing time of one path.
//!
//! The number of steps of these schemes follows from the scene and cannot be read off a scenario.
//! For example, an oscillator of 1e9 Hz that never comes to rest needs 1e15 steps for a million
//! seconds. Every evaluation in a loop whose length depends on the scene (steps, intervals of a
//! bisection, points of a root search, events) is counted here, so that the simulation of every
//! path ends.

/// The number of evaluations that a path may still make.
#[derive(Clone, Copy, Debug)]
pub struct WorkLeft {
    left: u64,
}

/// The result of simulating some paths.
#[derive(Clone, Debug, Default)]
pub struct Simulated {
    /// The lanes of the paths that had to be given up.
    pub lost: Vec<usize>,
    /// The number of evaluations of all paths together: a measure of computing time that does not
    /// depend on the machine.
    pub evaluations: u64,
}

/// A path is given up, because it made all evaluations that it may or because a value was not a
/// number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unresolved;

/// The number of evaluations that a path may make. They take ten seconds to two minutes; the paths
/// of usual scenes take microseconds to seconds.
pub const WORK_LIMIT: u64 = 100_000_000;

impl WorkLeft {
    /// A limit of `limit` evaluations.
    pub fn new(limit: u64) -> Self {
        WorkLeft { left: limit }
    }

    /// The number of evaluations that are left.
    pub fn left(self) -> u64 {
        self.left
    }

    /// Counts several evaluations at once. Where fewer are left, none is left afterwards.
    pub fn spend_all(&mut self, evaluations: u64) {
        self.left = self.left.saturating_sub(evaluations);
    }

    /// Counts one evaluation; an error if none is left.
    #[inline(always)]
    pub fn spend(&mut self) -> Result<(), Unresolved> {
        self.left = self.left.checked_sub(1).ok_or(Unresolved)?;
        Ok(())
    }
}
