//! Multilevel Monte Carlo over the corrected discrete VI, for means over paths.
//!
//! ```text
//! E P(h_L) = E P(h_0) + sum over l = 1 .. L of E [P(h_l) - P(h_{l-1})],   h_l = h_0 / 2^l
//! ```
//!
//! Both members of a difference are simulated on one realisation of the noise. The variance of a
//! difference therefore falls with its steps, and few of the expensive paths are needed. Let V_l be
//! the variance and C_l the cost of one sample of level l. If the numbers of paths are proportional
//! to sqrt(V_l / C_l), a variance v is reached at the least cost, (sum sqrt(V_l C_l))^2 / v. The
//! bias beyond the finest level is about as large as the difference on that level, because the
//! scheme is of order 1. Levels are added until it is small against the target.
//!
//! M. B. Giles, *Multilevel Monte Carlo path simulation*, Operations Research 56 (2008).
//!
//! The method is of advantage for statistics that change little when an exit from stick comes a
//! little later, such as the displacement and the work. The number of sticks differs between the
//! two members of a pair for every step, so its variance does not fall.

use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use stickslip::ensemble::{BLOCK_SIZE, Plan, in_order};
use stickslip::model::Problem;
use stickslip::scheme::{CorrectedVi, Scheme, Simulate as _, Timeline};
use stickslip::stats::{BlockResult, PathColumns, Record, Statistic};
use stickslip::sums::{Merge as _, Moments};

/// Blocks of a new level, simulated before anything is known of its variance.
const PILOT_BLOCKS: u64 = 4;

/// Number of levels at the start; convergence cannot be judged on fewer.
const FIRST_LEVELS: usize = 3;

/// Largest number of levels, so that the finest step is h_0 / 2^16.
const MOST_LEVELS: usize = 17;

/// Blocks of path numbers for one level. Level l uses the path numbers from l 2^40 on, so that
/// levels are independent.
const LEVEL_BLOCKS: u64 = (1 << 40) / BLOCK_SIZE;

/// Largest h_0 relative to the time scales of oscillator, forcing and noise: the fastest of them
/// advances by a quarter of a radian in a step.
const COARSEST: f64 = 0.25;

/// The cost of one event, in steps (measured: 30 ns against 1.3 ns).
const EVENT_COST: f64 = 20.0;

/// A mean over paths, with the steps it is computed on.
#[derive(Clone, Debug)]
pub struct Multilevel {
    model: Problem,
    end: f64,
    statistic: Statistic,
    seed: u64,
    /// t_end / h_0, a whole number.
    coarsest_steps: f64,
}

/// The results of one level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The step h_l.
    pub step: f64,
    /// Number of paths, or on levels above 0 of pairs.
    pub paths: u64,
    /// Mean of P(h_l) - P(h_{l-1}); on level 0 of P(h_0).
    pub mean: f64,
    /// Variance of one sample of it.
    pub variance: f64,
    /// Cost of one sample: the steps of both members of a pair, and their events expressed in
    /// steps.
    pub cost: f64,
}

/// The result.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The sum of the means of all levels.
    pub estimate: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Estimated bias of the finest step, in magnitude.
    pub bias: f64,
    /// Its standard error.
    pub bias_error: f64,
    /// The levels, from the coarsest to the finest.
    pub levels: Vec<Level>,
}

/// Why there is no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MultilevelError {
    /// The caller has stopped it.
    #[error("interrupted")]
    Interrupted,
    /// A path diverged.
    #[error("a path diverged")]
    Diverged,
    /// The bias is above the target even on the finest level.
    #[error("the bias is above the target on the finest level")]
    NotConverged,
}

impl Multilevel {
    /// A study of `statistic`. `None` if it is not a mean over paths, without noise (one path then
    /// gives the value), with noise that the scheme cannot simulate, and if the duration is 0 or
    /// takes too many steps.
    pub fn new(model: &Problem, end: f64, statistic: Statistic, seed: u64) -> Option<Self> {
        value_of(statistic)?;
        // The scheme simulates a single noise, and its steps do not fall on the samples that noise
        // may be pinned to.
        let temperature = &model.temperature;
        let fits = !temperature.is_pinned && !temperature.has_two_noises();
        let noise = temperature.effective_noise().filter(|_| fits)?;
        let rates = model
            .temperature
            .harmonics
            .iter()
            .map(|harmonic| harmonic.angular_frequency.abs());
        let rates = rates.chain(
            model
                .temperature
                .series
                .as_ref()
                .map(|series| 1.0 / series.usual_spacing()),
        );
        let fastest = rates.fold(
            model
                .oscillator
                .natural_frequency()
                .max(noise.relaxation_rate),
            f64::max,
        );
        let coarsest_steps = (end * fastest / COARSEST).ceil();
        let is_usable = end > 0.0 && coarsest_steps * 2f64.powi(MOST_LEVELS as i32) < 1e15;
        is_usable.then(|| Multilevel {
            model: model.clone(),
            end,
            statistic,
            seed,
            coarsest_steps,
        })
    }

    /// Simulate until the root mean square error is `target`. The bias may use at most half of its
    /// square, and the variance uses the rest. Fails if it is stopped, if a path diverges, or if
    /// the bias stays too large.
    pub fn run(
        &self,
        target: f64,
        threads: usize,
        stop: &AtomicBool,
    ) -> Result<Outcome, MultilevelError> {
        let most_bias = target / std::f64::consts::SQRT_2;
        let mut samples = vec![Sample::default(); FIRST_LEVELS];
        self.extend(&mut samples, |_| PILOT_BLOCKS, threads, stop)?;
        loop {
            let outcome = self.outcome(&samples);
            let wanted = blocks_for(
                &outcome.levels,
                target.powi(2) - outcome.bias.min(most_bias).powi(2),
            );
            let is_short = samples
                .iter()
                .zip(&wanted)
                .any(|(sample, wanted)| sample.blocks < wanted - wanted / 50);
            // More paths also make the bias better known. They are not worth simulating if the bias
            // is too large with certainty.
            let least_bias = outcome.bias - 2.0 * outcome.bias_error;
            if is_short && least_bias <= most_bias {
                self.extend(&mut samples, |l| wanted[l], threads, stop)?;
            } else if outcome.bias <= most_bias {
                return Ok(outcome);
            } else if samples.len() < MOST_LEVELS {
                samples.push(Sample::default());
                self.extend(&mut samples, |_| PILOT_BLOCKS, threads, stop)?;
            } else {
                return Err(MultilevelError::NotConverged);
            }
        }
    }

    fn level(&self, l: usize, sample: &Sample) -> Level {
        let steps = self.coarsest_steps * 2f64.powi(l as i32);
        let both = if l == 0 { steps } else { 1.5 * steps };
        Level {
            step: self.end / steps,
            paths: sample.values.count,
            mean: sample.values.mean(),
            variance: sample.values.variance(),
            cost: both + EVENT_COST * sample.events / sample.values.count as f64,
        }
    }

    fn outcome(&self, samples: &[Sample]) -> Outcome {
        let levels: Vec<Level> = samples
            .iter()
            .enumerate()
            .map(|(l, sample)| self.level(l, sample))
            .collect();
        let variance_of_mean = |level: &Level| level.variance / level.paths as f64;
        // The scheme is of order 1, so the remaining bias is about the last difference or half of
        // the one before it. The greater of the two is used.
        let (before, last) = (&levels[levels.len() - 2], &levels[levels.len() - 1]);
        let (bias, bias_error) = if last.mean.abs() >= before.mean.abs() / 2.0 {
            (last.mean.abs(), variance_of_mean(last).sqrt())
        } else {
            (
                before.mean.abs() / 2.0,
                variance_of_mean(before).sqrt() / 2.0,
            )
        };
        Outcome {
            estimate: levels.iter().map(|level| level.mean).sum(),
            standard_error: levels.iter().map(variance_of_mean).sum::<f64>().sqrt(),
            bias,
            bias_error,
            levels,
        }
    }

    /// Simulate the missing blocks of each level.
    fn extend(
        &self,
        samples: &mut [Sample],
        wanted: impl Fn(usize) -> u64,
        threads: usize,
        stop: &AtomicBool,
    ) -> Result<(), MultilevelError> {
        let missing: Vec<(usize, u64)> = samples
            .iter()
            .enumerate()
            .flat_map(|(l, sample)| (sample.blocks..wanted(l)).map(move |block| (l, block)))
            .collect();
        let pairs: Vec<Pair> = (0..samples.len()).map(|l| self.pair(l)).collect();
        let make = |piece: u64| {
            let (l, block) = missing[piece as usize];
            (
                l,
                pairs[l].sample(l as u64 * LEVEL_BLOCKS + block, self.statistic),
            )
        };
        let mut diverged = false;
        let deliver = |(l, sample): (usize, Option<Sample>)| {
            match sample {
                Some(sample) => samples[l].merge(&sample),
                None => diverged = true,
            }
            Ok::<_, Infallible>(if diverged {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        };
        match in_order(missing.len() as u64, threads, stop, make, deliver) {
            _ if diverged => Err(MultilevelError::Diverged),
            Ok(_) if stop.load(Ordering::Relaxed) => Err(MultilevelError::Interrupted),
            Ok(_) => Ok(()),
        }
    }

    /// The plans of the two members of level `l`.
    fn pair(&self, l: usize) -> Pair {
        let plan = |steps: f64, refinement: usize| {
            let timeline = Timeline {
                end: self.end,
                output_step: self.end,
                period: None,
                after: 0.0,
            };
            let scheme = Scheme::from(CorrectedVi {
                step: self.end / steps,
            });
            let simulation = scheme
                .simulation(&self.model, &timeline)
                .fed_by_finer(refinement);
            let record = Record {
                paths: true,
                ..Record::NOTHING
            };
            Plan {
                simulation,
                record,
                seed: self.seed,
                paths: u64::MAX,
                antithetic: false,
            }
        };
        let steps = self.coarsest_steps * 2f64.powi(l as i32);
        Pair {
            fine: plan(steps, 1),
            coarse: (l > 0).then(|| plan(steps / 2.0, 2)),
        }
    }
}

/// The number of blocks of each level that reaches this variance of the estimate at the least cost.
fn blocks_for(levels: &[Level], variance: f64) -> Vec<u64> {
    let total: f64 = levels
        .iter()
        .map(|level| (level.variance * level.cost).sqrt())
        .sum();
    let paths = |level: &Level| (level.variance / level.cost).sqrt() * total / variance;
    levels
        .iter()
        .map(|level| ((paths(level) / BLOCK_SIZE as f64).ceil() as u64).max(PILOT_BLOCKS))
        .collect()
}

/// The plans that simulate a level: the fine member and, except on level 0, the coarse one.
struct Pair {
    fine: Plan,
    coarse: Option<Plan>,
}

impl Pair {
    /// Simulate one block of a level; `None` if a path diverged.
    fn sample(&self, block: u64, statistic: Statistic) -> Option<Sample> {
        let value = value_of(statistic)?;
        let fine = self.fine.block(block);
        let mut values = value(&self.fine, kept(&fine)?);
        let mut events = events_of(kept(&fine)?);
        if let Some(coarse) = &self.coarse {
            let block = coarse.block(block);
            let columns = kept(&block)?;
            values
                .iter_mut()
                .zip(value(coarse, columns))
                .for_each(|(fine, coarse)| *fine -= coarse);
            events += events_of(columns);
        }
        Some(Sample {
            blocks: 1,
            values: Moments::of(&values),
            events,
        })
    }
}

/// The scalars of the paths of a block, if none of its paths diverged.
fn kept(block: &BlockResult) -> Option<&PathColumns> {
    block
        .rows
        .path_columns
        .as_ref()
        .filter(|_| block.diverged.is_empty())
}

fn events_of(columns: &PathColumns) -> f64 {
    let all = columns
        .sub_phases
        .iter()
        .zip(&columns.slips)
        .zip(&columns.sticks);
    all.map(|((sub_phases, slips), sticks)| f64::from(sub_phases + slips.max(sticks)))
        .sum()
}

type Value = fn(&Plan, &PathColumns) -> Vec<f64>;

/// The number per path of which a statistic is the mean, if it is such a mean.
fn value_of(statistic: Statistic) -> Option<Value> {
    let value: Value = match statistic {
        Statistic::DisplacementEndMean => |_, columns| columns.displacement_end.clone(),
        Statistic::FrictionWorkMean => |_, columns| columns.friction_work.clone(),
        Statistic::StickingFraction => |plan, columns| {
            columns
                .stick_time
                .iter()
                .map(|t| t / plan.timeline().end)
                .collect()
        },
        Statistic::SticksPerPath => {
            |_, columns| columns.sticks.iter().map(|&n| f64::from(n)).collect()
        }
        Statistic::SlipsPerPath => {
            |_, columns| columns.slips.iter().map(|&n| f64::from(n)).collect()
        }
        _ => return None,
    };
    Some(value)
}

#[derive(Clone, Debug, Default)]
struct Sample {
    blocks: u64,
    values: Moments,
    events: f64,
}

impl Sample {
    fn merge(&mut self, other: &Sample) {
        self.blocks += other.blocks;
        self.values.merge(&other.values);
        self.events += other.events;
    }
}
