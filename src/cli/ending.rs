//! When a run ends before its last path: its goals are reached, cannot be reached, or its time is up.
//!
//! Goals are judged at block boundaries, on the blocks delivered so far, so where they end a run depends on the scenario and the seed
//! alone. A time limit ends it wherever the machine has got to; the file says where, and that many paths give the same results again.

use super::numbers::{grouped, significant};
use std::time::{Duration, Instant};
use stick_slip::ensemble::BLOCK_SIZE;
use stick_slip::stats::{Goal, Totals, Verdict};

/// Blocks before the first look: a standard error of 1024 paths is itself known to a few per cent, so that chance does not
/// end a run early.
const FIRST_LOOK: u64 = 4;

/// Blocks after which a statistic that does not exist, or is zero within its error, is given up.
const PATIENCE: u64 = 64;

/// The most paths of a run that is not told how many: more than any file or patience holds.
pub const MOST_PATHS: u64 = 1_000_000_000;

/// What may end a run.
#[derive(Debug)]
pub struct Endings {
    pub goals: Vec<Goal>,
    pub max_time: Option<Duration>,
    /// The most paths the run may have.
    pub paths: u64,
}

/// What a look at the blocks so far says.
#[derive(Debug, PartialEq)]
pub enum Look {
    /// Go on; about so many paths will do, as far as can be told.
    GoOn(Option<u64>),
    /// Every goal is reached, or the time is up: the reason.
    Done(String),
    /// A goal cannot be reached: the reason.
    Hopeless(String),
}

impl Endings {
    /// Look at the first `blocks` blocks.
    pub fn look(&self, blocks: u64, totals: &Totals, start: Instant) -> Look {
        let done = blocks * BLOCK_SIZE;
        let goals = self.judge(blocks, done, totals);
        match (goals, self.max_time) {
            (Look::GoOn(_), Some(limit)) if start.elapsed() >= limit => {
                Look::Done(format!("time limit, after block {blocks}"))
            }
            (goals, _) => goals,
        }
    }

    fn judge(&self, blocks: u64, done: u64, totals: &Totals) -> Look {
        if self.goals.is_empty() || blocks < FIRST_LOOK {
            return Look::GoOn(None);
        }
        let mut factor: f64 = 1.0;
        let mut is_open = false;
        for goal in &self.goals {
            let estimate = totals.estimate(goal.statistic);
            let name = goal.statistic.name();
            match goal.judge(&estimate) {
                Verdict::Reached => continue,
                Verdict::Ahead(times) => factor = factor.max(times),
                Verdict::Zero if blocks >= PATIENCE => {
                    let value = significant(estimate.estimate, 3);
                    let error = significant(estimate.standard_error, 2);
                    return Look::Hopeless(format!(
                        "{name} is {value} with a standard error of {error} after {} paths: zero, as far as they tell, and no share of \
                         zero can be reached\n  fix: give a bound in its own unit, such as --until \"{name} < {error}\"",
                        grouped(done)
                    ));
                }
                Verdict::Missing if blocks >= PATIENCE => {
                    return Look::Hopeless(format!(
                        "{name} does not exist after {} paths, so its error cannot be bounded\n  fix: choose another statistic, or a \
                         longer time.end",
                        grouped(done)
                    ));
                }
                Verdict::Zero | Verdict::Missing => {}
            }
            is_open = true;
        }
        if !is_open {
            let goals: Vec<String> = self.goals.iter().map(Goal::to_string).collect();
            return Look::Done(format!("{}, after block {blocks}", goals.join(" and ")));
        }
        let needed = done as f64 * factor;
        if blocks >= PATIENCE && needed > MOST_PATHS as f64 {
            return Look::Hopeless(format!(
                "about {needed:.1e} paths would be needed, more than {}\n  fix: a wider bound",
                grouped(MOST_PATHS)
            ));
        }
        Look::GoOn((factor > 1.0).then_some(needed as u64))
    }

    /// The goals that an ended run has not reached, with what they need.
    pub fn missed(&self, totals: &Totals, done: u64) -> Vec<String> {
        let missed = |goal: &Goal| match goal.judge(&totals.estimate(goal.statistic)) {
            Verdict::Reached => None,
            Verdict::Ahead(times) => {
                let needed = (done as f64 * times * 1.05 / BLOCK_SIZE as f64).ceil() as u64 * BLOCK_SIZE;
                Some(format!("{goal} is not reached after {} paths; try --paths {needed}", grouped(done)))
            }
            Verdict::Zero => Some(format!("{goal} is not reached: the estimate may be zero; give a bound in its own unit")),
            Verdict::Missing => Some(format!("{goal} is not reached: the statistic does not exist")),
        };
        self.goals.iter().filter_map(missed).collect()
    }
}
