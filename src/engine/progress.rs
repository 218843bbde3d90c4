//! Whom a run tells how far it has come.

/// Told once a block, on whichever thread has finished it. Every method does nothing unless it is written.
pub trait Progress: Send {
    /// So many paths are done, and so many will be needed in all, as far as can be told now.
    fn paths(&mut self, done: u64, expected: u64) {
        let _ = (done, expected);
    }

    /// The paths are done; the bias of the step is being estimated.
    fn estimating_bias(&mut self) {}
}

/// Nobody is told.
impl Progress for () {}
