//! The CPU time of a path on this machine, measured by simulating some paths for a short time.

use super::clock::thread_seconds;
use crate::ensemble::{BLOCK_SIZE, drawn};
use crate::scenario::Scenario;
use crate::scheme::{Instant, Observer, Simulate as _, Snapshot};
use crate::stats::BlockObserver;
use crate::sums::Replicate;
use std::time::Duration;

/// An observer that ends a simulation at a given time and records the simulated time.
pub struct TimeLimit {
    /// The end, in CPU seconds of this thread.
    until: f64,
    /// The simulated time of the last row of the output grid that was reached.
    reached: f64,
}

impl TimeLimit {
    /// Ends a simulation on this thread after this much CPU time.
    pub fn of(limit: Duration) -> Self {
        TimeLimit {
            until: thread_seconds() + limit.as_secs_f64(),
            reached: 0.0,
        }
    }
}

impl Observer for TimeLimit {
    fn snapshot(&mut self, _: Instant, snapshot: Snapshot<'_>) {
        self.reached = snapshot.time;
    }

    fn is_stopped(&self) -> bool {
        thread_seconds() > self.until
    }
}

/// CPU seconds of one path on one thread, measured on one block of paths for at most `limit` of CPU
/// time. If the paths do not end in that time, the remainder is assumed to take the same time per
/// simulated time. `None` if no row of the output grid after t = 0 was reached.
pub fn seconds_per_path(scenario: &Scenario, limit: Duration) -> Option<f64> {
    let plan = scenario.plan();
    let paths: Vec<u64> = (0..BLOCK_SIZE.min(scenario.ensemble.paths)).collect();
    let begun = thread_seconds();
    let block = BlockObserver::new(
        plan.model(),
        plan.timeline(),
        &plan.record,
        &paths,
        Replicate::Path,
    );
    let mut watching = (block, TimeLimit::of(limit));
    plan.simulation
        .simulate(plan.seed, &drawn(&paths, plan.antithetic), &mut watching);
    let spent = thread_seconds() - begun;
    let end = scenario.time.end;
    let share = if watching.1.is_stopped() && end > 0.0 {
        watching.1.reached / end
    } else {
        1.0
    };
    (share > 0.0).then(|| spent / (share * paths.len() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A path with a hundredth of the step takes about a hundred times as long, whether or not the
    /// measured paths come to their end. Timings vary, so the bounds are a factor of three on both
    /// sides.
    #[test]
    fn a_path_longer_than_the_limit_is_extrapolated_from_its_part() {
        let at = |step: f64| {
            let mut scenario = Scenario::shipped("rho025").expect("shipped");
            scenario.scheme = crate::scheme::DiscreteVi { step }.into();
            seconds_per_path(&scenario, Duration::from_millis(200)).expect("some rows are reached")
        };
        let ratio = at(1e-4) / at(1e-2);
        assert!((33.0..300.0).contains(&ratio), "{ratio}");
    }
}
