//! The number of steps of the grid and of paths of each scheme that fit into a budget of time.

use super::setting::GROUPS;
use super::settings::is_exact;
use super::timing::{bare_plan, timed};
use super::{LeftOut, SettingGrid, TradeError};
use crate::ensemble::Plan;
use crate::scenario::Scenario;
use crate::scheme::{CheckError, Scheme, Timeline};
use crate::study::clock::Stopwatch;
use std::time::Duration;

/// The number of paths for each part of the measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedCost {
    /// Number of steps of the grid that are run, from the coarsest.
    pub steps: usize,
    /// Paths of every setting with a step, a multiple of 20.
    pub coupled_paths: u64,
    /// Paths of each setting without a step, in the order of the grid; 0 for one that is not run.
    pub free_paths: Vec<u64>,
    /// CPU seconds for timing each setting.
    pub timing: f64,
}

/// Share of the CPU time of a budget for the schemes with a step. Their paths give the law by which
/// a bias falls.
const STEPPING: f64 = 0.4;
/// Share for the reference, with which every bias is measured.
const REFERENCE: f64 = 0.25;
/// Share for all other settings without a step together.
const OTHERS: f64 = 0.15;
/// Share of the budget for timing the settings, which is done on one thread.
const TIMING: f64 = 0.1;

/// Fewest paths of a setting without a step, so that its error is known to some extent.
const LEAST_FREE: u64 = 32;
/// Largest number of paths, enough for every target.
const MOST_PATHS: u64 = 1 << 22;
/// Numbers of paths for the settings with a step, best first, each with the fewest steps for which it
/// is used.
const COUPLED: [(u64, usize); 3] = [(GROUPS << 9, 4), (GROUPS << 7, 3), (GROUPS << 5, 2)];
/// The cost of a step that gets its noise from a finer one, relative to the cost of the finer one.
const FED: f64 = 0.7;

impl PlannedCost {
    /// The planned cost that fits into `budget` of CPU time on each of `threads` threads. Numbers
    /// of paths are powers of two times a constant, so that small differences of speed do not
    /// change them. Settings that do not fit are removed from the grid, with the reason. Fails if
    /// not even the reference fits.
    pub fn within(
        scenario: &Scenario,
        grid: &mut SettingGrid,
        budget: Duration,
        threads: usize,
    ) -> Result<PlannedCost, TradeError> {
        if scenario.time.end == 0.0 {
            return Err(TradeError::NothingHappens);
        }
        let watch = Stopwatch::start(threads);
        let budget = Budget {
            time: budget,
            threads,
            is_random: scenario.model.is_random(),
        };
        let each = grid
            .free
            .iter()
            .map(|scheme| free_cost(scenario, *scheme, 0.01 * budget.capacity()));
        let each = each.collect::<Result<Vec<f64>, CheckError>>()?;
        let (steps, coupled_paths) = budget.stepping(scenario, grid)?;
        // The time of the pilot is spent. The share of the schemes with a step goes to the others
        // if none of them is run.
        let more = if coupled_paths > 0 {
            1.0
        } else {
            1.0 + STEPPING / (REFERENCE + OTHERS)
        };
        let free_paths = budget.free(
            grid,
            &each,
            more,
            (budget.capacity() - watch.spent()).max(0.0),
        )?;
        let unrun = grid.steps.get(steps).filter(|_| steps > 0);
        grid.left_out.extend(unrun.map(|h| {
            LeftOut {
                what: format!("steps of {h:?} and below"),
                why:
                    "the budget does not allow enough paths; predictions extrapolate the fitted law"
                        .into(),
            }
        }));
        let settings =
            steps * grid.stepping.len() + free_paths.iter().filter(|paths| **paths > 0).count();
        let timing = TIMING * budget.time.as_secs_f64() / settings as f64;
        Ok(PlannedCost {
            steps,
            coupled_paths,
            free_paths,
            timing,
        })
    }
}

/// CPU time on each of some threads, to be shared out.
struct Budget {
    time: Duration,
    threads: usize,
    /// Whether paths differ, so that more of them determine more.
    is_random: bool,
}

impl Budget {
    /// CPU seconds on all threads together.
    fn capacity(&self) -> f64 {
        self.time.as_secs_f64() * self.threads as f64
    }

    /// The number of steps of the grid, and of paths, of the schemes with a step. If no steps
    /// fit, these schemes are removed from the grid.
    fn stepping(
        &self,
        scenario: &Scenario,
        grid: &mut SettingGrid,
    ) -> Result<(usize, u64), CheckError> {
        if grid.stepping.is_empty() {
            return Ok((0, 0));
        }
        let path = StepCost::measure(scenario, grid)?;
        let chain = |steps: usize| grid.stepping.len() as f64 * path.chain(&grid.steps[..steps]);
        let fits =
            |paths: u64, steps: usize| chain(steps) * paths as f64 <= STEPPING * self.capacity();
        let most = |paths: u64| {
            (1..=grid.steps.len())
                .rev()
                .find(|steps| fits(paths, *steps))
                .unwrap_or(0)
        };
        if let Some((paths, _)) = COUPLED
            .into_iter()
            .find(|(paths, least)| most(*paths) >= *least)
        {
            let steps = most(paths);
            // Without noise all paths are equal, so there is one in each group.
            if !self.is_random {
                return Ok((steps, GROUPS));
            }
            let doublings = (0..32)
                .take_while(|i| paths << i <= MOST_PATHS && fits(paths << i, steps))
                .count();
            return Ok((steps, paths << doublings.saturating_sub(1)));
        }
        let seconds = chain(2) * COUPLED[2].0 as f64 / self.threads as f64;
        let why = format!(
            "the step {:?} needs {:.2e} steps a path, and the two coarsest steps would take about {seconds:.0} s of the \
             budget's {:.0} s",
            grid.steps[0],
            scenario.time.end / grid.steps[0],
            self.time.as_secs_f64(),
        );
        let removed = std::mem::take(&mut grid.stepping);
        grid.left_out.extend(removed.iter().map(|s| LeftOut {
            what: s.name().into(),
            why: why.clone(),
        }));
        Ok((0, 0))
    }

    /// The number of paths of each setting without a step, of which a path takes `each` seconds.
    /// The `capacity` that is left is shared out, each share times `more`.
    fn free(
        &self,
        grid: &mut SettingGrid,
        each: &[f64],
        more: f64,
        capacity: f64,
    ) -> Result<Vec<u64>, TradeError> {
        let fits = |i: usize| each[i] * LEAST_FREE as f64 <= REFERENCE * more * capacity;
        let too_small = |i: usize| TradeError::BudgetTooSmall {
            path_seconds: each[i],
            least: LEAST_FREE,
        };
        let reference = (0..each.len())
            .rev()
            .find(|i| is_exact(grid.free[*i]) && fits(*i));
        let reference = reference.ok_or_else(|| too_small(0))?;
        let mut free_paths = Vec::new();
        for (i, seconds) in each.iter().enumerate() {
            let share = if i == reference {
                REFERENCE
            } else {
                OTHERS / (each.len() - 1).max(1) as f64
            };
            let fitting = (share * more * capacity / seconds) as u64;
            let is_run = !self.is_random || fitting >= LEAST_FREE;
            if !is_run {
                let why = format!(
                    "{LEAST_FREE} paths of {seconds:.3} s do not fit into their share of the budget"
                );
                grid.left_out.push(LeftOut {
                    what: grid.free[i].to_string(),
                    why,
                });
            }
            free_paths.push(match is_run {
                true if self.is_random => ((fitting + 1).next_power_of_two() >> 1).min(MOST_PATHS),
                true => 2,
                false => 0,
            });
        }
        if free_paths[reference] == 0 {
            Err(too_small(reference))
        } else {
            Ok(free_paths)
        }
    }
}

/// CPU seconds of a path, measured on one path, or on 16 if they are quick.
fn free_cost(scenario: &Scenario, scheme: Scheme, quick: f64) -> Result<f64, CheckError> {
    let plan = bare_plan(scenario, scheme)?;
    let one = timed(&plan, 1);
    Ok(if one * 16.0 < quick {
        timed(&plan, 16) / 16.0
    } else {
        one
    }
    .max(1e-9))
}

/// CPU seconds of a path with a step: a part for its events, and a part for each step.
struct StepCost {
    events: f64,
    step: f64,
    end: f64,
}

/// Number of paths per timing, which fills the vector registers.
const LANES: u64 = 32;
/// Number of steps per timing.
const PILOT_STEPS: f64 = 4096.0;

impl StepCost {
    /// Measure the cost of a step on the first steps of the finest setting, and the cost of events on
    /// a whole path of the coarsest setting if that is short enough.
    fn measure(scenario: &Scenario, grid: &SettingGrid) -> Result<Self, CheckError> {
        let (kind, end) = (grid.stepping[0], scenario.time.end);
        let seconds = |h: f64, end: f64| -> Result<f64, CheckError> {
            let scheme = kind.with(h);
            let plan = bare_plan(scenario, scheme)?;
            let timeline = Timeline {
                end,
                output_step: end,
                period: None,
                after: 0.0,
            };
            let short = Plan {
                simulation: scheme.simulation(plan.model(), &timeline),
                ..plan
            };
            timed(&short, LANES); // The first run warms up the caches.
            Ok(timed(&short, LANES) / LANES as f64)
        };
        let (coarsest, finest) = (grid.steps[0], grid.steps[grid.steps.len() - 1]);
        let pilot = (PILOT_STEPS * finest).min(end);
        let step = seconds(finest, pilot)? * finest / pilot;
        let whole = if end / coarsest <= PILOT_STEPS {
            seconds(coarsest, end)?
        } else {
            0.0
        };
        Ok(StepCost {
            events: whole,
            step,
            end,
        })
    }

    /// CPU seconds of one path on each of these steps, all of which get their noise from the
    /// finest.
    fn chain(&self, steps: &[f64]) -> f64 {
        let Some(finest) = steps.last() else {
            return 0.0;
        };
        let coarser = (steps.len() - 1) as f64;
        (coarser + 1.0) * self.events + (1.0 + FED * coarser) * self.step * self.end / finest
    }
}
