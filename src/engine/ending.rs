//! The reasons for which a run ends before its last path: its goals are reached, one of them cannot
//! be reached, or its time is up.
//!
//! Goals are judged after each block, on the totals that the run would have if it ended there, so
//! the block after which they end a run depends on the scenario and the seed alone. A time limit
//! ends a run after a block that depends on the machine. The outcome contains the number of blocks,
//! and a run of exactly the paths of these blocks gives the same results.

use crate::ensemble::BLOCK_SIZE;
use crate::stats::{Estimate, Goal, RunTotals, Statistic, Verdict};
use crate::sums::Merge;
use std::fmt;
use std::time::Duration;

/// Number of blocks before goals are first judged. From 1024 paths on, the relative error of a
/// standard error is a few per cent, so a run does not end too early by chance.
const FIRST_JUDGED: u64 = 4;

/// Number of blocks after which a run abandons a goal, if its statistic does not exist or is zero
/// within its error.
const PATIENCE: u64 = 64;

/// The largest number of paths of a run if none is given. It is larger than any practical file or
/// waiting time.
pub const MOST_PATHS: u64 = 1_000_000_000;

/// The recommended number of paths is this many times the number that a goal needs by the
/// 1/sqrt(paths) law.
const MARGIN: f64 = 1.05;

/// Conditions that may end a run before its last path.
#[derive(Clone, Debug)]
pub(super) struct Endings {
    pub goals: Vec<Goal>,
    /// The longest time for the simulation of paths.
    pub time: Option<Duration>,
}

/// What has ended a run before its last path.
#[derive(Clone, Debug, PartialEq)]
pub enum EndedBy {
    /// Every goal is reached.
    Goals {
        /// All goals of the run.
        goals: Vec<Goal>,
        /// The number of blocks that were needed.
        blocks: u64,
    },
    /// The time is up.
    TimeLimit {
        /// The number of blocks that were done then.
        blocks: u64,
    },
    /// A goal cannot be reached.
    Hopeless(Hopeless),
}

/// Why a goal cannot be reached.
#[derive(Clone, Debug, PartialEq)]
pub enum Hopeless {
    /// The estimate is zero within its error. A goal relative to the estimate then cannot be
    /// reached.
    Zero {
        /// The estimate and its interval.
        estimate: Estimate,
        /// The number of paths of the estimate.
        paths: u64,
    },
    /// The statistic does not exist.
    Missing {
        /// The statistic.
        statistic: Statistic,
        /// The number of paths after which this was decided.
        paths: u64,
    },
    /// The goal needs more paths than a run may have.
    TooFar {
        /// The goal.
        goal: Goal,
        /// The number of paths that the goal needs.
        needed: f64,
        /// The standard error after [`MOST_PATHS`] paths.
        least_error: f64,
    },
}

/// The text that is written to files.
impl fmt::Display for EndedBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EndedBy::Goals { goals, blocks } => {
                let goals: Vec<String> = goals.iter().map(Goal::to_string).collect();
                write!(f, "{}, after block {blocks}", goals.join(" and "))
            }
            EndedBy::TimeLimit { blocks } => write!(f, "time limit, after block {blocks}"),
            EndedBy::Hopeless(_) => f.write_str("a goal that cannot be reached"),
        }
    }
}

/// A goal that a run has not reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissedGoal {
    /// The goal.
    pub goal: Goal,
    /// The number of paths of the run.
    pub paths: u64,
    /// The state of the estimate with respect to the goal.
    pub verdict: Verdict,
}

impl MissedGoal {
    /// The number of paths, in whole blocks, that will probably reach the goal. It is `None` if no
    /// such number is known, because the estimate is zero within its error or does not exist.
    pub fn paths_needed(&self) -> Option<u64> {
        match self.verdict {
            Verdict::Ahead(times) => {
                let blocks = self.paths as f64 * times * MARGIN / BLOCK_SIZE as f64;
                Some(blocks.ceil() as u64 * BLOCK_SIZE)
            }
            Verdict::Reached | Verdict::Zero | Verdict::Missing => None,
        }
    }
}

/// The decision after the blocks so far.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Judgement {
    /// Continue. The number is the estimated total number of paths, if known.
    GoOn(Option<u64>),
    /// End the run.
    Stop(EndedBy),
}

impl Endings {
    /// Judge the goals and the time limit after the first `blocks` blocks, with their totals and
    /// the time spent on them.
    pub fn judge<X: Merge + Clone>(
        &self,
        blocks: u64,
        totals: &RunTotals<X>,
        spent: Duration,
    ) -> Judgement {
        match (self.judge_goals(blocks, totals), self.time) {
            (Judgement::GoOn(_), Some(limit)) if spent >= limit => {
                Judgement::Stop(EndedBy::TimeLimit { blocks })
            }
            (goals, _) => goals,
        }
    }

    fn judge_goals<X: Merge + Clone>(&self, blocks: u64, totals: &RunTotals<X>) -> Judgement {
        if self.goals.is_empty() || blocks < FIRST_JUDGED {
            return Judgement::GoOn(None);
        }
        let paths = blocks * BLOCK_SIZE;
        let is_patient = blocks < PATIENCE;
        // The goal that needs the most paths, and the ratio of this number to the present one.
        let mut farthest: Option<(f64, Goal)> = None;
        let mut is_open = false;
        for &goal in &self.goals {
            let estimate = totals.estimate(goal.statistic);
            let hopeless = match goal.judge(&estimate) {
                Verdict::Reached => continue,
                Verdict::Ahead(times) => {
                    if farthest.is_none_or(|(most, _)| times > most) {
                        farthest = Some((times, goal));
                    }
                    None
                }
                Verdict::Zero => Some(Hopeless::Zero { estimate, paths }),
                Verdict::Missing => Some(Hopeless::Missing {
                    statistic: goal.statistic,
                    paths,
                }),
            };
            if let Some(hopeless) = hopeless.filter(|_| !is_patient) {
                return Judgement::Stop(EndedBy::Hopeless(hopeless));
            }
            is_open = true;
        }
        if !is_open {
            return Judgement::Stop(EndedBy::Goals {
                goals: self.goals.clone(),
                blocks,
            });
        }
        let Some((times, goal)) = farthest else {
            return Judgement::GoOn(None);
        };
        let needed = paths as f64 * times;
        if !is_patient && needed > MOST_PATHS as f64 {
            let least_error = totals.estimate(goal.statistic).standard_error
                * (paths as f64 / MOST_PATHS as f64).sqrt();
            return Judgement::Stop(EndedBy::Hopeless(Hopeless::TooFar {
                goal,
                needed,
                least_error,
            }));
        }
        Judgement::GoOn(Some(needed as u64))
    }

    /// The goals that a run with this number of paths has not reached.
    pub fn missed<X: Merge + Clone>(&self, totals: &RunTotals<X>, paths: u64) -> Vec<MissedGoal> {
        let judged = self.goals.iter().map(|&goal| MissedGoal {
            goal,
            paths,
            verdict: goal.judge(&totals.estimate(goal.statistic)),
        });
        judged
            .filter(|missed| missed.verdict != Verdict::Reached)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Override;
    use crate::engine::{Run, SoFar};
    use crate::ensemble::Plan;
    use crate::scenario::Scenario;

    fn scenario() -> Scenario {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/rho025.toml");
        let set = [
            "time.step=0.02",
            "time.end=20",
            "time.output_step=20",
            "record.paths=false",
        ];
        let overrides: Vec<Override> = set
            .iter()
            .map(|text| Override::set(text).expect("well formed"))
            .collect();
        Scenario::read(path.as_ref(), &overrides).expect("shipped")
    }

    fn plan(seed: u64) -> Plan {
        Plan {
            seed,
            paths: 400 * BLOCK_SIZE,
            ..scenario().plan()
        }
    }

    fn until(goal: &str) -> Endings {
        Endings {
            goals: vec![goal.parse().expect("a goal")],
            time: None,
        }
    }

    /// A run that ends when its standard error looks small enough is more likely to end when it
    /// underestimates this error. Null hypothesis: the 95 % intervals of such runs still contain
    /// the true value in 95 % of cases; the true value is estimated from 10^5 other paths, with an
    /// error of a ninth of that of a run. 400 runs end after 4 to 12 blocks, where the effect is
    /// greatest. The standard deviation of the share is 1.1 %, and the bounds are 3.5 of them
    /// (false-alarm rate 5e-4). Intervals of one standard error contain the value in 68 % of cases.
    #[test]
    fn intervals_of_runs_ended_by_a_goal_hold_what_they_promise() {
        let statistic = Statistic::StickDurationMean;
        let totals = |plan: &Plan, blocks: u64| {
            let mut totals = RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
            (0..blocks)
                .for_each(|block| totals.push(block, plan.block(block).totals).expect("once"));
            totals
        };
        let truth = totals(&plan(1_000_000), 400).estimate(statistic).estimate;
        let endings = until("stick_duration_mean < 1.2%");
        let (mut held, mut lengths) = (0, Vec::new());
        for seed in 0..400 {
            let plan = plan(seed);
            let mut totals = RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
            let blocks = (1..=400).find(|&blocks| {
                totals
                    .push(blocks - 1, plan.block(blocks - 1).totals)
                    .expect("once");
                matches!(
                    endings.judge(blocks, &totals, Duration::ZERO),
                    Judgement::Stop(EndedBy::Goals { .. })
                )
            });
            lengths.push(blocks.expect("the goal is near"));
            let e = totals.estimate(statistic);
            held += u32::from(e.low <= truth && truth <= e.high);
        }
        lengths.sort_unstable();
        assert!(
            lengths[20] >= 4 && lengths[380] <= 12 && lengths[20] < lengths[380],
            "{lengths:?}"
        );
        let share = f64::from(held) / 400.0;
        assert!((0.912..0.988).contains(&share), "{share}");
    }

    /// A run whose earlier sessions used up its time does no further block, though it has paths left.
    #[test]
    fn a_resumed_run_whose_time_is_used_up_does_no_further_block() {
        let plan = plan(1);
        let mut totals = RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
        (0..2).for_each(|block| totals.push(block, plan.block(block).totals).expect("once"));
        let scenario = scenario();
        let limit = Duration::from_secs(1000);
        let ended = |spent| {
            let totals = totals.clone();
            let run = Run::of(&scenario).paths(3 * BLOCK_SIZE).within(Some(limit));
            let outcome = run.without_bias().go_on(SoFar { totals, spent });
            let outcome = outcome.expect("no sink");
            assert!(outcome.seconds >= spent.as_secs_f64());
            (
                outcome.summary.completed_paths / BLOCK_SIZE,
                outcome.ended_by,
            )
        };
        assert_eq!(ended(limit), (2, Some(EndedBy::TimeLimit { blocks: 2 })));
        assert_eq!(ended(limit / 2), (3, None));
    }
}
