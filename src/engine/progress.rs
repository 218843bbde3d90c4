//! Whom a run tells how far it has come.

use crate::stats::{Estimate, Statistic};

/// Told once a block, on whichever thread has finished it. Every method does nothing unless it is
/// written.
///
/// ```
/// use stick_slip::engine::{Progress, Run};
/// use stick_slip::scenario::Scenario;
///
/// struct Percent(u64);
///
/// impl Progress for Percent {
///     fn paths(&mut self, done: u64, expected: u64) { self.0 = 100 * done / expected; }
/// }
///
/// let mut percent = Percent(0);
/// let mut scenario = Scenario::shipped("rho025")?;
/// scenario.ensemble.paths = 600;
/// Run::of(&scenario).with_progress(&mut percent).simulate()?;
/// assert_eq!(percent.0, 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Progress: Send {
    /// So many paths are done, and so many will be needed in all, as far as can be told now.
    fn paths(&mut self, done: u64, expected: u64) {
        let _ = (done, expected);
    }

    /// Which statistic it would like to see now, if any. It is asked once a block, and an estimate
    /// of a run so far takes as long as a few paths: who shows it twice a second should not ask for
    /// more.
    fn watches(&mut self) -> Option<Statistic> {
        None
    }

    /// What is known of that statistic by now.
    fn estimate(&mut self, estimate: &Estimate) {
        let _ = estimate;
    }

    /// The paths are done; the bias of the step is being estimated.
    fn estimating_bias(&mut self) {}
}

/// Nobody is told.
impl Progress for () {}
