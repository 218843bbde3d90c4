//! How long a path takes on this machine, found out by simulating some of them for a moment.

use super::clock::thread_seconds;
use crate::ensemble::{BLOCK_SIZE, drawn};
use crate::model::Event;
use crate::scenario::Scenario;
use crate::scheme::{Instant, Observer, Simulate as _, Snapshot};
use crate::stats::BlockObserver;
use std::time::Duration;

/// Ends a simulation when its time is up, and knows how far it came.
struct Patience {
    /// CPU seconds of this thread at which it ends.
    until: f64,
    /// The last instant at which the paths were looked at.
    reached: f64,
}

impl Observer for Patience {
    fn event(&mut self, _: usize, _: Event) {}

    fn snapshot(&mut self, _: Instant, snapshot: Snapshot<'_>) {
        self.reached = snapshot.time;
    }

    fn is_stopped(&self) -> bool {
        thread_seconds() > self.until
    }
}

/// CPU seconds of one path on one thread, from a block of them that is simulated for `patience` at most. None where
/// not even the first row of the output grid was reached in that time. The share of the paths that was not reached is
/// taken to be as dear as the rest.
pub fn seconds_per_path(scenario: &Scenario, patience: Duration) -> Option<f64> {
    let plan = scenario.plan();
    let paths: Vec<u64> = (0..BLOCK_SIZE.min(scenario.ensemble.paths)).collect();
    let begun = thread_seconds();
    let patience = Patience { until: begun + patience.as_secs_f64(), reached: 0.0 };
    let block = BlockObserver::new(plan.model(), plan.timeline(), &plan.record, &paths);
    let mut watching = (block, patience);
    plan.simulation.simulate(plan.seed, &drawn(&paths, plan.antithetic), &mut watching);
    let spent = thread_seconds() - begun;
    let end = scenario.time.end;
    let share = if watching.1.is_stopped() && end > 0.0 { watching.1.reached / end } else { 1.0 };
    (share > 0.0).then(|| spent / (share * paths.len() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hundredth of the step takes a hundred times as long, whether or not the paths come to their end in the time that there
    /// is. Clocks are no test, so the bounds are wide: a factor of three to both sides.
    #[test]
    fn what_takes_longer_than_the_patience_is_told_from_a_part_of_it() {
        let at = |step: f64| {
            let mut scenario = Scenario::shipped("rho025").expect("shipped");
            scenario.scheme = crate::scheme::DiscreteVi { step }.into();
            seconds_per_path(&scenario, Duration::from_millis(200)).expect("some rows are reached")
        };
        let ratio = at(1e-4) / at(1e-2);
        assert!((33.0..300.0).contains(&ratio), "{ratio}");
    }
}
