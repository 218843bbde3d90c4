//! Reports the progress of a run to the caller.

use crate::stats::{Estimate, Statistic};

/// Receives the progress of a run after each block, on the thread that finished the block. The
/// default of every method does nothing.
///
/// ```
/// use stickslip::engine::{Progress, Run};
/// use stickslip::scenario::Scenario;
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
    /// `done` paths are done. `expected` is the number of paths that the run will need in all, as
    /// far as it can be estimated now.
    fn paths(&mut self, _done: u64, _expected: u64) {}

    /// The statistic to report now, if any. This is called after each block, and an estimate takes
    /// as long as a few paths, so an implementation that shows it twice a second should not request
    /// it more often.
    fn watches(&mut self) -> Option<Statistic> {
        None
    }

    /// The present estimate of that statistic.
    fn estimate(&mut self, _estimate: &Estimate) {}

    /// The paths are done, and the bias of the step is being estimated.
    fn estimating_bias(&mut self) {}
}

/// No progress is reported.
impl Progress for () {}
