//! How much of the ladder fits into a budget of time, and with how many paths.

use super::ladder::is_exact;
use super::measure::{GROUPS, bare_plan, timed};
use super::{Ladder, LeftOut, TradeError};
use crate::ensemble::Plan;
use crate::scenario::Scenario;
use crate::scheme::{Misfit, Scheme, Timeline};
use crate::study::clock::Stopwatch;
use std::time::Duration;

/// How many paths are spent on what.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    /// Steps of the ladder that are run, from the coarsest.
    pub steps: usize,
    /// Paths of every time-stepping rung, a multiple of 20.
    pub coupled_paths: u64,
    /// Paths of each scheme without steps, in the order of the ladder; 0 is not run.
    pub free_paths: Vec<u64>,
    /// CPU seconds for timing each rung.
    pub timing: f64,
}

// Shares of the CPU time of a budget.
const STEPPING: f64 = 0.4;
const REFERENCE: f64 = 0.25;
const OTHERS: f64 = 0.15;
/// The timings are of one thread.
const TIMING: f64 = 0.1;

/// Fewest paths of a scheme without steps; two are needed for an error.
const LEAST_FREE: u64 = 32;
/// Most paths: enough for any target.
const MOST_PATHS: u64 = 1 << 22;
/// Paths of the time-stepping rungs, the best first, and the fewest steps worth running them on.
const COUPLED: [(u64, usize); 3] = [(GROUPS << 9, 4), (GROUPS << 7, 3), (GROUPS << 5, 2)];
/// A step that is fed the noise of a finer one costs about this share of that one.
const FED: f64 = 0.7;

impl Effort {
    /// What fits into `budget` of CPU time on each of `threads` threads. Numbers of paths are
    /// powers of two times a constant, so that small differences of speed do not change them. What
    /// does not fit is struck from the ladder, with the reason.
    pub fn within(
        scenario: &Scenario,
        ladder: &mut Ladder,
        budget: Duration,
        threads: usize,
    ) -> Result<Effort, TradeError> {
        if scenario.time.end == 0.0 {
            return Err(TradeError::NothingHappens);
        }
        let watch = Stopwatch::start(threads);
        let capacity = budget.as_secs_f64() * threads as f64;
        let (is_random, mut left_out) = (scenario.model.temperature.is_random(), Vec::new());
        let mut each = Vec::new();
        for &scheme in &ladder.free {
            let seconds = free_cost(scenario, scheme, 0.01 * capacity)?;
            each.push(seconds);
        }
        let (steps, coupled_paths) = if ladder.stepping.is_empty() {
            (0, 0)
        } else {
            let path = StepCost::measure(scenario, ladder)?;
            let chain = |steps: usize| ladder.stepping.len() as f64 * path.chain(&ladder.steps[..steps]);
            let fits = |paths: u64, steps: usize| chain(steps) * paths as f64 <= STEPPING * capacity;
            let most = |paths: u64| (1..=ladder.steps.len()).rev().find(|steps| fits(paths, *steps)).unwrap_or(0);
            match COUPLED.into_iter().find(|(paths, least)| most(*paths) >= *least) {
                Some((paths, _)) if is_random => {
                    let steps = most(paths);
                    let doublings = (0..32).take_while(|i| paths << i <= MOST_PATHS && fits(paths << i, steps)).count();
                    (steps, paths << doublings.saturating_sub(1))
                }
                // Equal paths: one a group.
                Some((paths, _)) => (most(paths), GROUPS),
                None => {
                    let seconds = chain(2) * COUPLED[2].0 as f64 / threads as f64;
                    let why = format!(
                        "the step {:?} needs {:.2e} steps a path, and the two coarsest steps would take about {seconds:.0} s of \
                         the budget's {:.0} s",
                        ladder.steps[0],
                        scenario.time.end / ladder.steps[0],
                        budget.as_secs_f64(),
                    );
                    left_out
                        .extend(ladder.stepping.iter().map(|s| LeftOut { what: s.name().into(), why: why.clone() }));
                    ladder.stepping.clear();
                    (0, 0)
                }
            }
        };
        // What the pilot took is gone; what stepping schemes do not need, the others may have.
        let capacity = (capacity - watch.spent()).max(0.0);
        let more = if coupled_paths > 0 { 1.0 } else { 1.0 + STEPPING / (REFERENCE + OTHERS) };
        let reference = |each: &[f64]| {
            let fits = |i: usize| each[i] * LEAST_FREE as f64 <= REFERENCE * more * capacity;
            (0..each.len()).rev().find(|i| is_exact(ladder.free[*i]) && fits(*i))
        };
        let Some(reference) = reference(&each) else {
            return Err(TradeError::BudgetTooSmall { path_seconds: each[0], least: LEAST_FREE });
        };
        let mut free_paths = Vec::new();
        for (i, (scheme, seconds)) in ladder.free.iter().zip(&each).enumerate() {
            let share = if i == reference { REFERENCE } else { OTHERS / (each.len() - 1).max(1) as f64 };
            let fitting = (share * more * capacity / seconds) as u64;
            free_paths.push(
                match fitting {
                    _ if !is_random => 2,
                    paths if paths >= LEAST_FREE => (paths + 1).next_power_of_two() >> 1,
                    _ => {
                        let why =
                            format!("{LEAST_FREE} paths of {seconds:.3} s do not fit into their share of the budget");
                        left_out.push(LeftOut { what: scheme.to_string(), why });
                        0
                    }
                }
                .min(MOST_PATHS),
            );
        }
        if free_paths[reference] == 0 {
            return Err(TradeError::BudgetTooSmall { path_seconds: each[reference], least: LEAST_FREE });
        }
        let unrun = ladder.steps.get(steps).filter(|_| steps > 0);
        left_out.extend(unrun.map(|h| LeftOut {
            what: format!("steps of {h:?} and below"),
            why: "the budget does not allow enough paths of them; predictions for them carry the fitted law on".into(),
        }));
        ladder.left_out.extend(left_out);
        let rungs = steps * ladder.stepping.len() + free_paths.iter().filter(|paths| **paths > 0).count();
        let timing = TIMING * budget.as_secs_f64() / rungs as f64;
        Ok(Effort { steps, coupled_paths, free_paths, timing })
    }
}

/// CPU seconds of a path, from one path, or from a few if they are quick.
fn free_cost(scenario: &Scenario, scheme: Scheme, quick: f64) -> Result<f64, Misfit> {
    let plan = bare_plan(scenario, scheme)?;
    let one = timed(&plan, 1);
    Ok(if one * 16.0 < quick { timed(&plan, 16) / 16.0 } else { one }.max(1e-9))
}

/// CPU seconds of a time-stepping path: some for what happens to it, and some for each step.
struct StepCost {
    events: f64,
    step: f64,
    end: f64,
}

/// Paths side by side in the kernel.
const LANES: u64 = 32;
/// Steps of a pilot.
const PILOT_STEPS: f64 = 4096.0;

impl StepCost {
    /// From the first steps of the finest rung, and the whole of the coarsest if that is not much
    /// longer.
    fn measure(scenario: &Scenario, ladder: &Ladder) -> Result<Self, Misfit> {
        let (kind, end) = (ladder.stepping[0], scenario.time.end);
        let seconds = |h: f64, end: f64| -> Result<f64, Misfit> {
            let scheme = kind.with(h);
            let plan = bare_plan(scenario, scheme)?;
            let timeline = Timeline { end, output_step: end, period: None, after: 0.0 };
            let short = Plan { simulation: scheme.simulation(plan.model(), &timeline), ..plan };
            timed(&short, LANES); // warm up
            Ok(timed(&short, LANES) / LANES as f64)
        };
        let (coarsest, finest) = (ladder.steps[0], ladder.steps[ladder.steps.len() - 1]);
        let pilot = (PILOT_STEPS * finest).min(end);
        let step = seconds(finest, pilot)? * finest / pilot;
        let whole = if end / coarsest <= PILOT_STEPS { seconds(coarsest, end)? } else { 0.0 };
        Ok(StepCost { events: whole, step, end })
    }

    /// Of one path on each of these steps, all fed the noise of the finest.
    fn chain(&self, steps: &[f64]) -> f64 {
        let Some(finest) = steps.last() else { return 0.0 };
        let coarser = (steps.len() - 1) as f64;
        (coarser + 1.0) * self.events + (1.0 + FED * coarser) * self.step * self.end / finest
    }
}
