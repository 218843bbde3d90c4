//! x at the whole periods P: drift velocity, diffusion coefficient, spread at one phase of
//! the forcing.
//!
//! The first two are slopes of ordinary least squares over the K instants t_n = n P that are
//! counted. They are written with the weights c_n = (t_n - mean t) / sum (t_n - mean t)^2:
//!
//! ```text
//! drift velocity          V   = mean over paths of   sum_n c_n (x_i(t_n) - x0)
//! diffusion coefficient   D   = 1/2 sum_n c_n Var x(t_n)
//! spread at one phase     S^2 = 1/K sum_n Var x(t_n)
//! ```

use super::measure::{Measure, Sampled};
use super::period_displacements::{PeriodDisplacements, PeriodDisplacementsFold};
use super::{PeriodMoments, Statistic};
use crate::scheme::{Snapshot, Timeline};
use crate::sums::Ends;
use crate::sums::Replicate;
use crate::sums::codec::sums;
use crate::sums::interval::Measured;
use crate::sums::moments::FourMoments;
use crate::sums::range::Range;
use crate::sums::rare::{FEWEST, FEWEST_FOR_SPREAD};
use crate::sums::spread::SpreadMoments;

/// The times of the whole periods, and the weights of the counted ones in a slope.
#[derive(Clone, Debug, PartialEq)]
struct Slope {
    time: Vec<f64>,
    /// Number of instants before the first one that is counted.
    skipped: usize,
    /// c_n; empty if fewer than two instants are counted, because then there is no slope.
    weights: Vec<f64>,
}

impl Slope {
    fn over(timeline: &Timeline) -> Self {
        let period = timeline.period.unwrap_or(0.0);
        let time: Vec<f64> = (1..=timeline.periods())
            .map(|n| (n as f64 * period).min(timeline.end))
            .collect();
        let skipped = (timeline.first_period() - 1).min(time.len());
        let counted = &time[skipped..];
        let middle = counted.iter().sum::<f64>() / counted.len() as f64;
        let spread: f64 = counted.iter().map(|t| (t - middle) * (t - middle)).sum();
        let weights = if counted.len() < 2 {
            Vec::new()
        } else {
            counted.iter().map(|t| (t - middle) / spread).collect()
        };
        Slope {
            time,
            skipped,
            weights,
        }
    }
}

sums! {
    /// Moments of x at the whole periods, and of the slopes and spreads of single paths.
    #[derive(Clone, Debug, PartialEq)]
    pub(super) struct PeriodSums {
        /// Moments of x(t_n) - x0.
        displacement: Vec<SpreadMoments>,
        /// Moments of the slope of each path.
        drift: FourMoments,
        /// Moments of each path's contribution to the slope of the variance.
        spreading: FourMoments,
        /// Moments of each path's contribution to S^2.
        spread: FourMoments,
        pub period_displacements: PeriodDisplacements,
    }
}

impl PeriodSums {
    pub fn empty(timeline: &Timeline) -> Self {
        PeriodSums {
            displacement: vec![SpreadMoments::default(); timeline.periods()],
            drift: FourMoments::default(),
            spreading: FourMoments::default(),
            spread: FourMoments::default(),
            period_displacements: PeriodDisplacements::empty(timeline),
        }
    }

    /// V. Two instants are needed.
    pub fn drift_velocity(&self, timeline: &Timeline) -> Measured {
        if timeline.counted_periods() == 0 {
            Measured::NOTHING
        } else {
            Measured::mean_of_four(&self.drift)
        }
    }

    /// D. Two instants and two paths are needed.
    ///
    /// The estimate is half the slope of the unbiased pooled variances. Its error is that of the
    /// mean over paths of y_i = sum_n c_n (x_i(t_n) - m_n)^2, where m_n is the mean over the block
    /// of the path. With n paths in a block, m_n is off by sd/sqrt(n), which changes the spread of
    /// the y_i by a relative O(1/n). The factor n/(n - 1) on the y_i makes this smaller: it is
    /// below 1 % of the standard error at 256 paths per block. A block of a single path has no
    /// spread and is left out.
    pub fn diffusion_coefficient(&self, timeline: &Timeline) -> Measured {
        let slope = Slope::over(timeline);
        if slope.weights.is_empty() {
            return Measured::NOTHING;
        }
        let variances = self.displacement[slope.skipped..]
            .iter()
            .map(|period| period.four.two.variance());
        let growth: f64 = slope
            .weights
            .iter()
            .zip(variances)
            .map(|(c, variance)| c * variance)
            .sum();
        Measured::mean_of_four(&self.spreading)
            .about(growth)
            .divided_by(2.0)
            .about_mean_of(self.spreading.two.count as f64)
    }

    /// S. One instant and two paths are needed. Estimate and error are found like those of D, with
    /// 1/K in place of c_n. The interval is that of a standard deviation ([`crate::sums::spread`]).
    pub fn spread_at_phase(&self, timeline: &Timeline) -> Measured {
        let counted = &self.displacement[Slope::over(timeline).skipped..];
        if counted.is_empty() {
            return Measured::NOTHING;
        }
        let variances = counted.iter().map(|period| period.four.two.variance());
        let sd = (variances.sum::<f64>() / counted.len() as f64).sqrt();
        let error = match Measured::mean_of_four(&self.spread)
            .measurement()
            .standard_error
        {
            0.0 => 0.0,
            error => error / (2.0 * sd),
        };
        Measured::spread(sd, error, self.spread.error_law(), self.spread.two.count)
    }

    pub fn summary(
        &self,
        timeline: &Timeline,
        is_random: bool,
        drift_limit: Option<f64>,
    ) -> PeriodMoments {
        let random_units = |period: &SpreadMoments| is_random.then_some(period.units.two.count);
        let two = |period: &SpreadMoments| period.four.two;
        let mean_ends = |p: &SpreadMoments| {
            Measured::mean_of_four(&p.units)
                .in_range(Range::ANY, random_units(p))
                .interval()
        };
        let sd_ends = |p: &SpreadMoments| {
            p.standard_deviation()
                .in_range(Range::NOT_NEGATIVE, random_units(p))
                .interval()
        };
        PeriodMoments {
            drift_limit,
            time: Slope::over(timeline).time,
            mean: self
                .displacement
                .iter()
                .map(|period| two(period).mean())
                .collect(),
            mean_ends: self.displacement.iter().map(mean_ends).collect(),
            variance: self
                .displacement
                .iter()
                .map(|period| two(period).variance())
                .collect(),
            // The ends of the interval of a variance are the squares of those of the standard
            // deviation.
            variance_ends: self
                .displacement
                .iter()
                .map(|p| sd_ends(p).map(|end| end * end))
                .collect::<Ends>(),
        }
    }
}

/// Folds one block of paths, period by period.
pub(super) struct PeriodFold {
    sums: PeriodSums,
    slope: Slope,
    x0: f64,
    /// x - x0 of each path at the present period.
    displacement: Vec<f64>,
    /// The slope of each path, summed up to the present period.
    drift: Vec<f64>,
    /// y_i of each path, summed up to the present period.
    spreading: Vec<f64>,
    /// The contribution of each path to S^2, summed up to the present period.
    spread: Vec<f64>,
    period_displacements: PeriodDisplacementsFold,
    unit: Replicate,
}

impl PeriodFold {
    pub fn new(timeline: &Timeline, x0: f64, paths: usize, unit: Replicate) -> Self {
        let slope = Slope::over(timeline);
        let numbers = |are_there: bool| vec![0.0; if are_there { paths } else { 0 }];
        PeriodFold {
            sums: PeriodSums::empty(timeline),
            x0,
            displacement: Vec::new(),
            drift: numbers(!slope.weights.is_empty()),
            spreading: numbers(!slope.weights.is_empty()),
            spread: numbers(slope.skipped < slope.time.len()),
            slope,
            period_displacements: PeriodDisplacementsFold::new(timeline, paths),
            unit,
        }
    }

    /// Add the paths at the end of period `n` = 1, 2, ... A scheme with a step gives the state at
    /// its instant nearest to t_n. From there to t_n the paths are continued at their present
    /// velocity.
    pub fn observe(&mut self, n: usize, snapshot: &Snapshot<'_>) {
        let missing = self
            .slope
            .time
            .get(n - 1)
            .map_or(0.0, |time| time - snapshot.time);
        let states = snapshot.displacement.iter().zip(snapshot.velocity);
        self.fold(
            n,
            &states.map(|(x, v)| x + missing * v).collect::<Vec<f64>>(),
        );
    }

    /// Add x of each path at the end of period `n` = 1, 2, ...
    pub fn fold(&mut self, n: usize, displacement: &[f64]) {
        self.displacement.clear();
        self.displacement
            .extend(displacement.iter().map(|x| x - self.x0));
        let spread = SpreadMoments::of(&self.displacement, self.unit);
        let moments = spread.four.two;
        if let Some(slot) = self.sums.displacement.get_mut(n - 1) {
            *slot = spread;
        }
        let Some(counted) = (n - 1).checked_sub(self.slope.skipped) else {
            return;
        };
        let share = 1.0 / (self.slope.time.len() - self.slope.skipped) as f64;
        for (spread, &u) in self.spread.iter_mut().zip(&self.displacement) {
            *spread += share * (u - moments.mean) * (u - moments.mean);
        }
        self.period_displacements.fold(&self.displacement);
        let Some(&weight) = self.slope.weights.get(counted) else {
            return;
        };
        for ((drift, spreading), &u) in self
            .drift
            .iter_mut()
            .zip(&mut self.spreading)
            .zip(&self.displacement)
        {
            *drift += weight * u;
            *spreading += weight * (u - moments.mean) * (u - moments.mean);
        }
    }

    pub fn finish(mut self) -> PeriodSums {
        let unit = self.unit;
        self.sums.drift = FourMoments::of(&unit.means(&self.drift));
        self.sums.spreading = FourMoments::of(&unit.means(&unbiased(self.spreading)));
        self.sums.spread = FourMoments::of(&unit.means(&unbiased(self.spread)));
        self.sums.period_displacements = self.period_displacements.finish(unit);
        self.sums
    }
}

/// The contributions of paths to a spread about the mean of their block, times n/(n - 1). For a
/// block of a single path there are none.
fn unbiased(mut shares: Vec<f64>) -> Vec<f64> {
    let n = shares.len() as f64;
    if shares.len() < 2 {
        return Vec::new();
    }
    shares.iter_mut().for_each(|share| *share *= n / (n - 1.0));
    shares
}

impl Measure for PeriodSums {
    fn measured(
        &self,
        statistic: Statistic,
        Sampled { timeline, unit }: &Sampled,
    ) -> Option<Measured> {
        let moved = |measured, fewest| self.period_displacements.moved(measured, fewest);
        Some(match statistic {
            Statistic::DriftVelocity => moved(self.drift_velocity(timeline), FEWEST),
            Statistic::DiffusionCoefficient => {
                moved(self.diffusion_coefficient(timeline), FEWEST_FOR_SPREAD)
            }
            Statistic::PeriodDisplacementMean => self.period_displacements.mean(),
            Statistic::PeriodDisplacementSd => self.period_displacements.sd(*unit),
            Statistic::PeriodDisplacementCorrelation => self.period_displacements.correlation(),
            Statistic::PhaseDisplacementSd => {
                moved(self.spread_at_phase(timeline), FEWEST_FOR_SPREAD)
            }
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Merge as _;
    use crate::sums::coverage::Coverage;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    #[test]
    fn drift_and_diffusion_of_a_brownian_motion_are_covered() {
        // x(t) = x0 + V t + sqrt(2 D) W(t), observed at 2.5, 5, ..., 15, for 400 paths in blocks of
        // 200.
        let (drift, diffusion, x0) = (-0.3, 0.7, 6.0);
        let timeline = Timeline {
            end: 16.0,
            output_step: 16.0,
            period: Some(2.5),
            after: 0.0,
        };
        let mut rng = Pcg64Dxsm::seed_from_u64(1905);
        let (mut drift_held, mut diffusion_held) = (Coverage::default(), Coverage::default());
        let (mut mean_held, mut variance_held) = (Coverage::default(), Coverage::default());
        let (mut step_held, mut sd_held, mut correlation_held) = (
            Coverage::default(),
            Coverage::default(),
            Coverage::default(),
        );
        let mut mean_estimate = 0.0;
        let ensembles = 2000;
        for _ in 0..ensembles {
            let mut totals = PeriodSums::empty(&timeline);
            for _ in 0..2 {
                let mut fold = PeriodFold::new(&timeline, x0, 200, Replicate::Path);
                let mut x = vec![x0; 200];
                for n in 1..=6 {
                    for x in &mut x {
                        let normal: f64 = StandardNormal.sample(&mut rng);
                        *x += drift * 2.5 + (2.0 * diffusion * 2.5f64).sqrt() * normal;
                    }
                    fold.fold(n, &x);
                }
                totals.merge(&fold.finish());
            }
            let v = totals.drift_velocity(&timeline).measurement();
            let d = totals.diffusion_coefficient(&timeline).measurement();
            let sd = totals
                .period_displacements
                .sd(Replicate::Path)
                .measurement();
            let r = totals.period_displacements.correlation().measurement();
            let step = totals.period_displacements.mean().measurement();
            step_held.count(step.low <= 2.5 * drift && 2.5 * drift <= step.high);
            let step_sd = (2.0 * diffusion * 2.5f64).sqrt();
            sd_held.count(sd.low <= step_sd && step_sd <= sd.high);
            correlation_held.count(r.low <= 0.0 && 0.0 <= r.high);
            drift_held.count(v.low <= drift && drift <= v.high);
            diffusion_held.count(d.low <= diffusion && diffusion <= d.high);
            // At the last period, at t = 15, the mean is V t and the variance is 2 D t.
            let PeriodMoments {
                mean_ends,
                variance_ends,
                ..
            } = totals.summary(&timeline, true, None);
            let (mean, variance) = (drift * 15.0, 2.0 * diffusion * 15.0);
            mean_held.count(mean_ends.low[5] <= mean && mean <= mean_ends.high[5]);
            variance_held
                .count(variance_ends.low[5] <= variance && variance <= variance_ends.high[5]);
            mean_estimate += d.estimate / f64::from(ensembles);
        }
        drift_held.assert_95_percent("drift velocity");
        diffusion_held.assert_95_percent("diffusion coefficient");
        mean_held.assert_95_percent("mean at a period");
        variance_held.assert_95_percent("variance at a period");
        // Without a spring, the displacements from period to period are independent draws.
        step_held.assert_95_percent("mean displacement from period to period");
        sd_held.assert_95_percent("standard deviation of it");
        correlation_held.assert_95_percent("correlation of it");
        // The estimate is unbiased. The slope of the variances of 400 paths has a relative sd of
        // about 1.3 sqrt(2/400) = 0.09. So the mean over the ensembles is within 4 sd = 4 * 0.09 /
        // sqrt(2000) = 0.8 %, with a false-alarm rate of 6e-5.
        assert!(
            (mean_estimate / diffusion - 1.0).abs() < 0.008,
            "{mean_estimate}"
        );
    }

    /// Three paths over the periods 1, 2, 3 with the weights -1/2, 0, 1/2. x - x0 is 0, 1, 2 at the
    /// first period and 4, 0, -1 at the last, with mean 1 both times. So the variances are 1 and 7,
    /// and D = (7 - 1)/4. The contributions y = (9 - 1)/2, 1/2 and (4 - 1)/2 of the paths, times
    /// n/(n - 1) = 3/2, are 6, 3/4 and 9/4, with variance 7.3125. So the standard error of half
    /// their mean is sqrt(7.3125/3)/2. The slopes are 2, -1/2 and -3/2, with mean 0 and variance
    /// 13/4. Of three paths, the jackknife has twice the error of a variance to first order. The ends are
    /// those of a mean of the contributions.
    #[test]
    fn errors_of_drift_and_diffusion_are_those_by_hand() {
        let timeline = Timeline {
            end: 3.0,
            output_step: 3.0,
            period: Some(1.0),
            after: 0.0,
        };
        let mut fold = PeriodFold::new(&timeline, 6.0, 3, Replicate::Path);
        fold.fold(1, &[6.0, 7.0, 8.0]);
        fold.fold(2, &[-20.0, 30.0, 5.0]); // the middle period, where the weight is zero
        fold.fold(3, &[10.0, 6.0, 5.0]);
        let totals = fold.finish();
        let d = totals.diffusion_coefficient(&timeline).measurement();
        let v = totals.drift_velocity(&timeline).measurement();
        let arm = |contributions: &[f64]| {
            let mean = Measured::mean_of_four(&FourMoments::of(contributions)).measurement();
            (mean.high - mean.estimate) / mean.standard_error
        };
        let [arm_of_d, arm_of_v] = [arm(&[6.0, 0.75, 2.25]), arm(&[2.0, -0.5, -1.5])];
        for (e, value, error, arm) in [
            (d, 1.5, (7.3125f64 / 3.0).sqrt(), arm_of_d),
            (v, 0.0, (3.25f64 / 3.0).sqrt(), arm_of_v),
        ] {
            let all = [
                (e.estimate, value),
                (e.standard_error, error),
                (e.high, value + arm * error),
            ];
            assert!(
                all.iter()
                    .all(|(got, expected)| (got - expected).abs() < 1e-9),
                "{e:?}, expected {value} +- {error}"
            );
        }
    }

    /// One path at x = 0.3 + 2 t - 0.7 t^2, observed on a grid of 0.01 on which no period ends. The
    /// result is x at the end of the period, except for the 0.7 (0.005)^2 by which continuing at
    /// the velocity is off. On the grid itself x would be 0.005 off.
    #[test]
    fn x_is_told_at_the_end_of_a_period_that_the_grid_misses() {
        let period = 0.314_9;
        let timeline = Timeline {
            end: 1.0,
            output_step: 1.0,
            period: Some(period),
            after: 0.0,
        };
        let mut fold = PeriodFold::new(&timeline, 0.3, 1, Replicate::Path);
        let x = |t: f64| 2.0 * t - 0.7 * t * t;
        for n in 1..=3 {
            let time = (n as f64 * period / 0.01).round() * 0.01;
            let (displacement, velocity) = ([0.3 + x(time)], [2.0 - 1.4 * time]);
            let (temperature, is_static) = (&[0.0], &[false]);
            let snapshot = Snapshot {
                time,
                displacement: &displacement,
                velocity: &velocity,
                temperature,
                is_static,
            };
            fold.observe(n, &snapshot);
        }
        for (n, mean) in (1..=3).zip(fold.finish().summary(&timeline, true, None).mean) {
            let exact = x(f64::from(n) * period);
            assert!(
                (mean - exact).abs() <= 0.7 * 0.005f64.powi(2) + 1e-12,
                "{n}: {mean}, not {exact}"
            );
        }
    }

    /// x - x0 is 0, 1, 5 and then 3, 3, 0, with variances 7 and 3, so S^2 = 5. The contributions
    /// (4 + 1)/2, (1 + 1)/2 and (9 + 4)/2 of the paths, times 3/2, have the variance 18.1875. The
    /// instant before the end of the burn-in is in the moments of each period only.
    #[test]
    fn the_spread_at_one_phase_is_that_computed_by_hand() {
        let timeline = Timeline {
            end: 3.0,
            output_step: 3.0,
            period: Some(1.0),
            after: 1.5,
        };
        let mut fold = PeriodFold::new(&timeline, 6.0, 3, Replicate::Path);
        fold.fold(1, &[100.0, -20.0, 3.0]);
        fold.fold(2, &[6.0, 7.0, 11.0]);
        fold.fold(3, &[9.0, 9.0, 6.0]);
        let totals = fold.finish();
        let e = totals.spread_at_phase(&timeline).measurement();
        let error = (18.1875f64 / 3.0).sqrt() / 5f64.sqrt();
        // Three numbers about their mean always have two degrees of freedom. 4.3 standard errors
        // are more than S, so that the upper end is infinite.
        let low = 5f64.sqrt() / (1.0 + 4.302_652_729_9 * error / 5f64.sqrt());
        let all = [
            (e.estimate, 5f64.sqrt()),
            (e.standard_error, error),
            (e.low, low),
        ];
        assert!(
            all.iter()
                .all(|(got, expected)| (got - expected).abs() < 1e-9),
            "{e:?}"
        );
        assert_eq!(e.high, f64::INFINITY);
        assert_eq!(totals.drift_velocity(&timeline).measurement().estimate, 0.0);
        assert!((totals.period_displacements.mean().estimate()).abs() < 1e-12);
        assert_eq!(totals.summary(&timeline, true, None).mean.len(), 3);
    }

    /// For a single instant the spread at one phase is the standard deviation over paths. The only
    /// displacement from period to period has that standard deviation as well, except that n takes
    /// the place of n - 1. Both have the interval of a plain standard deviation of n numbers, to
    /// which the long tail leaves fewer than n - 1 degrees of freedom.
    #[test]
    fn spreads_of_long_tails_have_intervals_of_an_sd() {
        let n = 40.0;
        let x: Vec<f64> = (0..40)
            .map(|i| 6.0 - 3.0 * ((f64::from(i) + 0.5) / n).ln())
            .collect();
        let plain = SpreadMoments::of(&x, Replicate::Path)
            .standard_deviation()
            .measurement();
        let reported = |after: f64| {
            let timeline = Timeline {
                end: 2.0,
                output_step: 2.0,
                period: Some(1.0),
                after,
            };
            let mut fold = PeriodFold::new(&timeline, 6.0, 40, Replicate::Path);
            fold.fold(1, &[8.0; 40]);
            fold.fold(2, &x);
            let sums = fold.finish();
            (
                sums.period_displacements.sd(Replicate::Path).measurement(),
                sums.spread_at_phase(&timeline).measurement(),
            )
        };
        let relative_width = |low: f64, estimate: f64| estimate / low - 1.0;
        let wanted = relative_width(plain.low, plain.estimate);
        let students_t = 2.022_690_9; // Student's t with 39 degrees of freedom
        assert!(
            relative_width(plain.low, plain.estimate)
                > 1.1 * students_t * plain.standard_error / plain.estimate
        );
        for (e, sd) in [
            (reported(0.0).0, plain.estimate * ((n - 1.0) / n).sqrt()),
            (reported(1.5).1, plain.estimate),
        ] {
            assert!(
                (e.estimate / sd - 1.0).abs() < 1e-12,
                "{e:?}, expected {sd}"
            );
            assert!(
                (relative_width(e.low, e.estimate) / wanted - 1.0).abs() < 1e-9,
                "{e:?}, expected {wanted}"
            );
        }
    }

    #[test]
    fn a_slope_takes_two_periods() {
        let timeline = Timeline {
            end: 4.0,
            output_step: 4.0,
            period: Some(2.5),
            after: 0.0,
        };
        let mut fold = PeriodFold::new(&timeline, 0.0, 3, Replicate::Path);
        fold.fold(1, &[1.0, 2.0, 6.0]);
        let totals = fold.finish();
        assert!(
            totals
                .drift_velocity(&timeline)
                .measurement()
                .estimate
                .is_nan()
        );
        assert!(
            totals
                .diffusion_coefficient(&timeline)
                .measurement()
                .estimate
                .is_nan()
        );
        let summary = totals.summary(&timeline, true, None);
        assert_eq!((summary.mean, summary.variance), (vec![3.0], vec![7.0]));
    }
}
