//! The bias of the step, measured with paths of the run at three steps.
//!
//! The first few paths of the run are simulated with the steps h, 2h and 4h on one realisation of
//! the noise. The changes of the statistics from 4h to 2h and from 2h to h are then known far
//! better than the statistics themselves. They give the remaining change of the statistics from h
//! to 0 ([`super::extrapolation`]), with an error from groups of paths.
//!
//! Only a statistic that depends smoothly on the step can be extrapolated. A median does not
//! ([`is_smooth`]). If sticks are either short or long, a step may miss some of the short ones. The
//! median may then belong to the long ones at h, 2h and 4h, and to the short ones at zero step.

use super::extrapolation::{Levels, is_smooth, leading_order, model_error_share, weight};
use super::no_bias::{MIN_STEPS, NoBias};
use crate::ensemble::{Flight, drawn, in_order_while};
use crate::model::Problem;
use crate::scheme::{Scheme, Simulate as _, Simulation, Timeline};
use crate::stats::{
    Bias, BlockObserver, Dimension, Estimate, GroupValues, Record, Statistic, Totals,
};
use crate::sums::{Merge as _, Replicate, jackknife};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// One path in this many of a run is simulated at three steps. This takes at most three times the
/// work of a path, since each step draws the normals of the finest one: at most a sixteenth of the
/// time of the run, plus the sums.
const ONE_PATH_IN: u64 = 48;

/// Number of groups of paths from which the standard error is computed. Its own error is 18 %,
/// which Student's t with 15 degrees of freedom allows for.
const GROUPS: usize = 16;

/// 97.5 % quantile of Student's t with GROUPS - 1 degrees of freedom (Abramowitz and Stegun, table
/// 26.10).
const STUDENT: f64 = 2.131;

/// The values at one step over all paths, and without each group.
type LevelValues = (GroupValues, Vec<GroupValues>);

/// The steps, in units of h.
const LEVELS: [usize; 3] = [1, 2, 4];

/// An observed order with a larger standard error than this is not reported.
const MAX_ORDER_ERROR: f64 = 0.5;

/// Largest number of paths of a group in a piece of work. With 16 groups a piece is then as wide as
/// a block.
const MAX_WIDTH: u64 = 16;

/// Number of pieces into which a level is divided at least, so that threads can share the work.
/// With more of them, most of the time would go into their sums and into vectors that are not full.
const PIECES: u64 = 2;

/// Statistics that grow if an explicit step is too long for the stiffness of a force, so that the
/// scheme adds energy.
const GROWING: [Statistic; 2] = [Statistic::FrictionWorkMean, Statistic::DisplacementEndSd];

/// If these grow by a larger factor from h to 2h or 4h, extrapolation is meaningless.
const MOST_GROWTH: f64 = 2.0;

/// The bias of a statistic by extrapolation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extrapolated {
    pub statistic: Statistic,
    pub bias: Bias,
    /// The standard error of the statistic from these paths, times the root of their number; zero
    /// where it rests on a few of them.
    scatter: f64,
}

/// The paths that measure a bias are considered typical of the run if the scatter of the statistic
/// among them is at least this fraction of that among the paths of the run. From 16 groups of
/// normal numbers, a smaller share has a probability of 0.2 %.
const TYPICAL: f64 = 0.5;

impl Extrapolated {
    /// Whether these paths are typical of those of a run with this estimate. They are not if the
    /// statistic depends on rare events of which they have few or none.
    pub fn is_typical_of(&self, run: &Estimate, paths: u64) -> bool {
        let scatter = run.standard_error * (paths as f64).sqrt();
        self.scatter >= TYPICAL * scatter || !scatter.is_finite()
    }
}

/// Some paths of a run, to be simulated at three steps. The three simulations end, and observe
/// whole periods, at the same instants. These are the multiples of 4h nearest to the
/// instants of the run, which changes the statistics and their bias by a share of at most 2h/t_end.
#[derive(Clone, Debug)]
pub struct Differences {
    model: Problem,
    timeline: Timeline,
    levels: [Simulation; LEVELS.len()],
    h: f64,
    seed: u64,
    groups: usize,
    per_group: u64,
    antithetic: bool,
    /// The records of the run, except those of single paths.
    pub(super) record: Record,
}

impl Differences {
    /// The plan for a run of a scheme with a step, with this seed and number of paths.
    pub fn new(
        scheme: Scheme,
        model: &Problem,
        timeline: &Timeline,
        seed: u64,
        paths: u64,
    ) -> Result<Self, NoBias> {
        let h = scheme.step().ok_or(NoBias::FewSteps)?;
        let is_random = model.is_random();
        let is_noisy = model.temperature.is_random();
        if is_noisy && model.friction.static_force == model.friction.dynamic_force {
            return Err(NoBias::EqualFriction);
        }
        if timeline.end / h < MIN_STEPS {
            return Err(NoBias::FewSteps);
        }
        // Without randomness, one path is the ensemble.
        let (groups, per_group) = if is_random {
            (GROUPS, paths / (ONE_PATH_IN * GROUPS as u64))
        } else {
            (1, 1)
        };
        if per_group == 0 {
            return Err(NoBias::FewPaths {
                needed: ONE_PATH_IN * GROUPS as u64,
            });
        }
        // Rows of the output grid are omitted, because the bands have no bias estimate.
        let timeline = timeline.without_rows();
        let coarsest = LEVELS[LEVELS.len() - 1];
        let levels = LEVELS.map(|k| {
            let simulation = scheme
                .kind()
                .with(k as f64 * h)
                .simulation(model, &timeline);
            simulation
                .fed_by_finer(k)
                .observed_every((coarsest / k) as u64)
        });
        let (model, record) = (model.clone(), Record::NOTHING);
        Ok(Differences {
            model,
            timeline,
            levels,
            h,
            seed,
            groups,
            per_group,
            antithetic: false,
            record,
        })
    }

    /// The same for a run of antithetic pairs. Groups hold whole pairs, so that leaving out a group
    /// shows the scatter of pairs. If a group had only one path, no pairs are formed.
    pub fn in_pairs(self) -> Self {
        let per_group = self.per_group & !1;
        if per_group == 0 {
            self
        } else {
            Differences {
                per_group,
                antithetic: true,
                ..self
            }
        }
    }

    /// Number of paths that are simulated at each step.
    pub fn paths(&self) -> u64 {
        self.groups as u64 * self.per_group
    }

    /// The bias of every statistic that exists and can be extrapolated. The result has the same
    /// bits for any number of `threads`.
    pub fn estimate(
        &self,
        threads: usize,
        stop: &AtomicBool,
    ) -> Result<Vec<(Statistic, Bias)>, NoBias> {
        Ok(self
            .extrapolate(threads, stop)?
            .0
            .into_iter()
            .map(|found| (found.statistic, found.bias))
            .collect())
    }

    /// The same with the scatter of each statistic among the paths, and whether the longer steps
    /// are stable.
    pub(super) fn extrapolate(
        &self,
        threads: usize,
        stop: &AtomicBool,
    ) -> Result<(Vec<Extrapolated>, bool), NoBias> {
        // A median is expensive, so it is not computed unless it is used.
        let is_wanted = |statistic| is_smooth(statistic) || !self.model.is_random();
        let groups = self.simulate(threads, stop)?;
        let mut at_step = self.empty();
        groups[0].iter().for_each(|group| at_step.merge(group));
        let levels = groups.map(|groups| self.values(&groups, is_wanted));
        let at = |of: &dyn Fn(&LevelValues) -> f64| Levels(levels.each_ref().map(of));
        let grows =
            |statistic: Statistic| at(&|(all, _)| all[statistic.index()]).grow_by(MOST_GROWTH);
        let is_stable = !GROWING.into_iter().any(grows);
        let sticks = levels[0].0[Statistic::SticksPerPath.index()];
        let bias = |(i, &statistic): (usize, &Statistic)| {
            let all = at(&|(all, _)| all[i]);
            let without: Vec<Levels> = (0..self.groups)
                .map(|g| at(&|(_, without)| without[g][i]))
                .collect();
            let at_h: Vec<f64> = without.iter().map(|levels| levels.0[0]).collect();
            let error = if at_step.measured(statistic).rests_on_few(self.paths()) {
                0.0
            } else {
                jackknife::standard_error(&at_h)
            };
            let scatter = error * (self.paths() as f64).sqrt();
            let bias = self.bias(statistic, all, &without, sticks);
            let exists = all.are_finite() && !bias.uncertainty.is_nan();
            exists.then_some(Extrapolated {
                statistic,
                bias,
                scatter,
            })
        };
        Ok((
            Statistic::ALL.iter().enumerate().filter_map(bias).collect(),
            is_stable,
        ))
    }

    /// The bias of one statistic from its values at the three steps: `all` over all paths,
    /// `without` without each group. `sticks` is the number of sticks per path.
    fn bias(&self, statistic: Statistic, all: Levels, without: &[Levels], sticks: f64) -> Bias {
        let error = |of: &dyn Fn(Levels) -> f64| {
            jackknife::standard_error(&without.iter().map(|&y| of(y)).collect::<Vec<f64>>())
        };
        let is_determined =
            |order: &f64| order.is_finite() && error(&|y| y.observed_order()) < MAX_ORDER_ERROR;
        let order = Some(all.observed_order()).filter(is_determined);
        if !self.model.is_random() {
            let (estimate, uncertainty) = all.without_noise();
            // Both ends of a phase are on the grid, so its duration may be off by h.
            let grid = if statistic.dimension() == Dimension::TIME {
                self.h
            } else {
                0.0
            };
            return Bias {
                estimate,
                uncertainty: uncertainty + grid,
                order,
            };
        }
        let p = leading_order(statistic, all);
        let second_term_error = error(&|y| y.second_term(p));
        let weight = weight(all.second_term(p), second_term_error);
        let sampling = STUDENT * error(&|y| y.bias(p, weight));
        let grid = match statistic {
            // As the step falls, sticks become more numerous and shorter, and the two changes may
            // cancel in the fraction. The remainder is at most half a step for each stick.
            Statistic::StickingFraction => 0.5 * self.h * sticks / self.timeline.counted(),
            _ => 0.0,
        };
        let model_error = all.model_error(
            p,
            model_error_share(statistic, self.noise_to_gap()),
            STUDENT * second_term_error,
        );
        Bias {
            estimate: all.bias(p, weight),
            uncertainty: sampling.hypot(model_error) + grid,
            order,
        }
    }

    /// The standard deviation of the change of the force by the noise in a step, relative to the
    /// gap: K beta rho sigma sqrt(h)/(f_s - f_d).
    fn noise_to_gap(&self) -> f64 {
        let Problem {
            oscillator,
            friction,
            temperature,
            ..
        } = &self.model;
        let noise = temperature
            .effective_noise()
            .map_or(0.0, |noise| noise.intensity * noise.diffusion);
        let force = oscillator.force_per_temperature() * noise * self.h.sqrt();
        force.abs() / (friction.static_force - friction.dynamic_force)
    }

    /// The totals of no paths.
    fn empty(&self) -> Totals {
        Totals::empty(&self.model, &self.timeline, &self.record)
    }

    /// The wanted statistics of all paths, and without each group; NaN for the others.
    fn values(&self, groups: &[Totals], is_wanted: impl Fn(Statistic) -> bool) -> LevelValues {
        jackknife::leaving_one_out(&self.empty(), groups, |totals| totals.values(&is_wanted))
    }

    /// The totals of each group, at each step.
    fn simulate(
        &self,
        threads: usize,
        stop: &AtomicBool,
    ) -> Result<[Vec<Totals>; LEVELS.len()], NoBias> {
        let width = self.per_group.div_ceil(PIECES).min(MAX_WIDTH);
        let width = if self.antithetic {
            width.next_multiple_of(2)
        } else {
            width
        };
        let pieces = self.per_group.div_ceil(width);
        let mut levels = LEVELS.map(|_| vec![self.empty(); self.groups]);
        let mut diverged = 0;
        // The finest level comes first, because its pieces take longest.
        let make = |index: u64| {
            let (level, done) = ((index / pieces) as usize, index % pieces * width);
            let (totals, lost) = self.piece(level, done, width.min(self.per_group - done), stop)?;
            Some((level, totals, lost))
        };
        let deliver =
            |(level, totals, lost): (usize, Vec<Totals>, usize)| -> Result<_, Infallible> {
                levels[level].merge(&totals);
                diverged += lost;
                Ok(ControlFlow::Continue(()))
            };
        let count = pieces * LEVELS.len() as u64;
        let Ok(delivered) = in_order_while(count, threads, stop, make, deliver);
        match diverged {
            _ if delivered < count => Err(NoBias::Stopped),
            0 => Ok(levels),
            paths => Err(NoBias::Diverged { paths }),
        }
    }

    /// The totals of each group over its next `width` paths, after the first `done` of them, and
    /// the number of paths that diverged. `None` if `stop` is set in the meantime.
    fn piece(
        &self,
        level: usize,
        done: u64,
        width: u64,
        stop: &AtomicBool,
    ) -> Option<(Vec<Totals>, usize)> {
        let (groups, lanes) = (self.groups as u64, width as usize);
        let first = done * groups;
        let numbers: Vec<u64> = (first..first + width * groups).collect();
        let group = |numbers| {
            BlockObserver::new(
                &self.model,
                &self.timeline,
                &self.record,
                numbers,
                Replicate::Path,
            )
        };
        let observers = numbers.chunks(lanes).map(group).collect();
        let mut all = (Flight { observers, lanes }, stop);
        let lost =
            self.levels[level].simulate(self.seed, &drawn(&numbers, self.antithetic), &mut all);
        let ended = all.0.observers.into_iter().zip((first..).step_by(lanes));
        let totals = ended
            .map(|(group, first)| group.finish(first, width, Vec::new()).totals)
            .collect();
        (!stop.load(Ordering::Relaxed)).then_some((totals, lost.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;
    use crate::scheme::DiscreteVi;

    /// Null: D1 of a ratio and of a mean are within Student's t of their expectation, here the mean
    /// over all seeds, in 95 % of 400 seeds. The share is then within four binomial standard
    /// deviations, 4.4 %, and 1.5 % for the skewness of so few paths, with a false-alarm rate of
    /// 6e-5. A standard error that is wrong by a factor of two gives 70 % or 99.9 %.
    #[test]
    fn differences_of_steps_scatter_as_the_jackknife_says() {
        let model = Scenario::shipped("rho025")
            .expect("a scene of the paper")
            .model;
        let timeline = Timeline {
            end: 30.0,
            output_step: 30.0,
            period: None,
            after: 0.0,
        };
        for statistic in [Statistic::StickDurationMean, Statistic::SticksPerPath] {
            let i = statistic.index();
            let differences: Vec<(f64, f64)> = (0..400)
                .map(|seed| {
                    let scheme = DiscreteVi { step: 0.05 }.into();
                    let plan = Differences::new(scheme, &model, &timeline, seed, 8000)
                        .expect("enough paths");
                    let levels = plan
                        .simulate(1, &AtomicBool::new(false))
                        .expect("none diverges");
                    let [fine, middle, _] =
                        levels.map(|groups| plan.values(&groups, |each| each == statistic));
                    let without: Vec<f64> = middle
                        .1
                        .iter()
                        .zip(&fine.1)
                        .map(|(middle, fine)| middle[i] - fine[i])
                        .collect();
                    (middle.0[i] - fine.0[i], jackknife::standard_error(&without))
                })
                .collect();
            let n = differences.len() as f64;
            let truth = differences.iter().map(|d| d.0).sum::<f64>() / n;
            let covered = differences
                .iter()
                .filter(|d| (d.0 - truth).abs() < STUDENT * d.1)
                .count();
            let share = covered as f64 / n;
            assert!(
                (share - 0.95).abs() < 0.059,
                "{}: {share}",
                statistic.name()
            );
        }
    }
}
