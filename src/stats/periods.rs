//! x at the whole forcing periods: drift velocity and diffusion coefficient.
//!
//! Both are slopes of ordinary least squares over t_n = n P, n = 1..N, written with the weights
//! c_n = (t_n - mean t) / sum (t_n - mean t)^2:
//!
//! ```text
//! drift velocity          V = mean over paths of   sum_n c_n (x_i(t_n) - x0)
//! diffusion coefficient   D = 1/2 sum_n c_n Var x(t_n)
//! ```

use super::codec::codec_of_fields;
use super::interval::Measured;
use super::moments::Moments;
use super::range::Range;
use super::spread::SpreadMoments;
use super::{Ends, PeriodMoments};
use crate::scheme::{Snapshot, Timeline};

/// Times of the whole forcing periods and their weights in a slope.
#[derive(Clone, Debug, PartialEq)]
struct Slope {
    time: Vec<f64>,
    /// c_n; empty if there are fewer than two periods, hence no slope.
    weights: Vec<f64>,
}

impl Slope {
    fn over(timeline: &Timeline) -> Self {
        let period = timeline.period.unwrap_or(0.0);
        let time: Vec<f64> = (1..=timeline.periods()).map(|n| (n as f64 * period).min(timeline.end)).collect();
        let middle = time.iter().sum::<f64>() / time.len() as f64;
        let spread: f64 = time.iter().map(|t| (t - middle) * (t - middle)).sum();
        let weights = if time.len() < 2 { Vec::new() } else { time.iter().map(|t| (t - middle) / spread).collect() };
        Slope { time, weights }
    }
}

/// Moments of x at the whole forcing periods, and of the two slopes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PeriodSums {
    /// Of x(t_n) - x0.
    displacement: Vec<SpreadMoments>,
    /// Of each path's slope.
    drift: Moments,
    /// Of each path's share in the slope of the variance.
    spreading: Moments,
}

codec_of_fields!(PeriodSums { displacement, drift, spreading });

impl PeriodSums {
    pub fn empty(timeline: &Timeline) -> Self {
        let displacement = vec![SpreadMoments::default(); timeline.periods()];
        PeriodSums { displacement, drift: Moments::default(), spreading: Moments::default() }
    }

    pub fn merge(&mut self, other: &PeriodSums) {
        for (mine, more) in self.displacement.iter_mut().zip(&other.displacement) {
            mine.merge(more);
        }
        self.drift.merge(&other.drift);
        self.spreading.merge(&other.spreading);
    }

    /// V; it takes two periods.
    pub fn drift_velocity(&self) -> Measured {
        if self.displacement.len() < 2 { Measured::NOTHING } else { Measured::mean(&self.drift) }
    }

    /// D; it takes two periods and two paths.
    ///
    /// The estimate is half the slope of the unbiased pooled variances. Its error is that of the mean over paths of
    /// y_i = sum_n c_n (x_i(t_n) - m_n)^2, whose centre m_n is the mean over the path's block. With n paths in a block m_n is off
    /// by sd/sqrt(n), which changes the spread of the y_i by a relative O(1/n), made smaller by the factor n/(n - 1) on them:
    /// below 1 % of the standard error at 256 paths a block. A block of a single path has no spread and is left out.
    pub fn diffusion_coefficient(&self, timeline: &Timeline) -> Measured {
        let slope = Slope::over(timeline);
        if slope.weights.is_empty() {
            return Measured::NOTHING;
        }
        let variances = self.displacement.iter().map(|period| period.four.two.variance());
        let growth: f64 = slope.weights.iter().zip(variances).map(|(c, variance)| c * variance).sum();
        Measured::mean(&self.spreading).about(growth).divided_by(2.0)
    }

    pub fn summary(&self, timeline: &Timeline, is_random: bool) -> PeriodMoments {
        let chance = |period: &SpreadMoments| is_random.then_some(period.four.two.count);
        let two = |period: &SpreadMoments| period.four.two;
        let mean_ends = |p: &SpreadMoments| Measured::mean(&two(p)).in_range(Range::ANY, chance(p)).interval();
        let sd_ends = |p: &SpreadMoments| p.standard_deviation().in_range(Range::NOT_NEGATIVE, chance(p)).interval();
        PeriodMoments {
            time: Slope::over(timeline).time,
            mean: self.displacement.iter().map(|period| two(period).mean()).collect(),
            mean_ends: self.displacement.iter().map(mean_ends).collect(),
            variance: self.displacement.iter().map(|period| two(period).variance()).collect(),
            // The square of a standard deviation is where the squares of the ends are.
            variance_ends: self.displacement.iter().map(|p| sd_ends(p).map(|end| end * end)).collect::<Ends>(),
        }
    }
}

/// One block of paths on its way through the periods.
pub(super) struct PeriodFold {
    sums: PeriodSums,
    /// t_n.
    time: Vec<f64>,
    /// c_n.
    weights: Vec<f64>,
    x0: f64,
    /// x - x0 of each path at the present period.
    displacement: Vec<f64>,
    /// Each path's slope, as far as it has come.
    slope: Vec<f64>,
    /// Each path's y_i, as far as it has come.
    spread: Vec<f64>,
}

impl PeriodFold {
    pub fn new(timeline: &Timeline, x0: f64, paths: usize) -> Self {
        let Slope { time, weights } = Slope::over(timeline);
        let paths = if weights.is_empty() { 0 } else { paths };
        PeriodFold {
            sums: PeriodSums::empty(timeline),
            time,
            weights,
            x0,
            displacement: Vec::new(),
            slope: vec![0.0; paths],
            spread: vec![0.0; paths],
        }
    }

    /// The paths at the end of period `n` = 1, 2, ... A scheme with a step shows the instant of it that is nearest to t_n;
    /// from there to t_n they go on at the velocity that they have.
    pub fn observe(&mut self, n: usize, snapshot: &Snapshot<'_>) {
        let missing = self.time.get(n - 1).map_or(0.0, |time| time - snapshot.time);
        let states = snapshot.displacement.iter().zip(snapshot.velocity);
        self.fold(n, &states.map(|(x, v)| x + missing * v).collect::<Vec<f64>>());
    }

    /// x of each path at the end of period `n` = 1, 2, ...
    pub fn fold(&mut self, n: usize, displacement: &[f64]) {
        self.displacement.clear();
        self.displacement.extend(displacement.iter().map(|x| x - self.x0));
        let spread = SpreadMoments::of(&self.displacement);
        let moments = spread.four.two;
        if let Some(slot) = self.sums.displacement.get_mut(n - 1) {
            *slot = spread;
        }
        let Some(&weight) = self.weights.get(n - 1) else { return };
        for ((slope, spread), &u) in self.slope.iter_mut().zip(&mut self.spread).zip(&self.displacement) {
            *slope += weight * u;
            *spread += weight * (u - moments.mean) * (u - moments.mean);
        }
    }

    pub fn finish(mut self) -> PeriodSums {
        self.sums.drift = Moments::of(&self.slope);
        if let n @ 2.. = self.spread.len() {
            let correction = n as f64 / (n - 1) as f64;
            self.spread.iter_mut().for_each(|y| *y *= correction);
            self.sums.spreading = Moments::of(&self.spread);
        }
        self.sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::Statistic;
    use crate::stats::synthetic::Coverage;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::SeedableRng;

    #[test]
    fn drift_and_diffusion_of_a_brownian_motion_are_covered() {
        // x(t) = x0 + V t + sqrt(2 D) W(t), seen at 2.5, 5, ..., 15; 400 paths in blocks of 200.
        let (drift, diffusion, x0) = (-0.3, 0.7, 6.0);
        let timeline = Timeline { end: 16.0, output_step: 16.0, period: Some(2.5) };
        let mut rng = Pcg64Dxsm::seed_from_u64(1905);
        let (mut drift_held, mut diffusion_held) = (Coverage::default(), Coverage::default());
        let (mut mean_held, mut variance_held) = (Coverage::default(), Coverage::default());
        let mut mean_estimate = 0.0;
        let ensembles = 2000;
        for _ in 0..ensembles {
            let mut totals = PeriodSums::empty(&timeline);
            for _ in 0..2 {
                let mut fold = PeriodFold::new(&timeline, x0, 200);
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
            let v = totals.drift_velocity().named(Statistic::DriftVelocity);
            let d = totals.diffusion_coefficient(&timeline).named(Statistic::DiffusionCoefficient);
            drift_held.count(v.low <= drift && drift <= v.high);
            diffusion_held.count(d.low <= diffusion && diffusion <= d.high);
            // At the last period, after 15: V t and 2 D t.
            let PeriodMoments { mean_ends, variance_ends, .. } = totals.summary(&timeline, true);
            let (mean, variance) = (drift * 15.0, 2.0 * diffusion * 15.0);
            mean_held.count(mean_ends.low[5] <= mean && mean <= mean_ends.high[5]);
            variance_held.count(variance_ends.low[5] <= variance && variance <= variance_ends.high[5]);
            mean_estimate += d.estimate / f64::from(ensembles);
        }
        drift_held.assert_95_percent("drift velocity");
        diffusion_held.assert_95_percent("diffusion coefficient");
        mean_held.assert_95_percent("mean at a period");
        variance_held.assert_95_percent("variance at a period");
        // Unbiased. The slope of the variances of 400 paths has a relative sd of about 1.3 sqrt(2/400) = 0.09, so the mean
        // over the ensembles is within 4 sd = 4 * 0.09 / sqrt(2000) = 0.8 % but for a false-alarm rate of 6e-5.
        assert!((mean_estimate / diffusion - 1.0).abs() < 0.008, "{mean_estimate}");
    }

    /// Three paths over the periods 1, 2, 3 with the weights -1/2, 0, 1/2: x - x0 is 0, 1, 2 at the first and 4, 0, -1 at the last, of mean 1 both times. So the
    /// variances are 1 and 7, D = (7 - 1)/4, and the paths' shares y = (9 - 1)/2, 1/2 and (4 - 1)/2, times n/(n - 1) = 3/2, are 6, 3/4 and 9/4, of variance
    /// 7.3125; the standard error of half their mean is sqrt(7.3125/3)/2. Slopes 2, -1/2 and -3/2 of mean 0 and variance 13/4.
    #[test]
    fn the_errors_of_drift_and_diffusion_of_unequal_paths_are_those_computed_by_hand() {
        let timeline = Timeline { end: 3.0, output_step: 3.0, period: Some(1.0) };
        let mut fold = PeriodFold::new(&timeline, 6.0, 3);
        fold.fold(1, &[6.0, 7.0, 8.0]);
        fold.fold(2, &[-20.0, 30.0, 5.0]); // in the middle, where the weight is zero
        fold.fold(3, &[10.0, 6.0, 5.0]);
        let totals = fold.finish();
        let d = totals.diffusion_coefficient(&timeline).named(Statistic::DiffusionCoefficient);
        let v = totals.drift_velocity().named(Statistic::DriftVelocity);
        let t = 4.302_652_729_9; // Student's t, two degrees of freedom
        for (e, value, error) in [(d, 1.5, (7.3125f64 / 3.0).sqrt() / 2.0), (v, 0.0, (3.25f64 / 3.0).sqrt())] {
            let all = [(e.estimate, value), (e.standard_error, error), (e.high, value + t * error)];
            assert!(
                all.iter().all(|(got, expected)| (got - expected).abs() < 1e-9),
                "{e:?}, expected {value} +- {error}"
            );
        }
    }

    /// One path at x = 0.3 + 2 t - 0.7 t^2, looked at on a grid of 0.01 that no period ends on: what is told is x at the end
    /// of the period, but for the 0.7 (0.005)^2 that the velocity there misses, where x on the grid is 0.005 off.
    #[test]
    fn x_is_told_at_the_end_of_a_period_and_not_at_the_nearest_instant_of_the_grid() {
        let period = 0.314_9;
        let timeline = Timeline { end: 1.0, output_step: 1.0, period: Some(period) };
        let mut fold = PeriodFold::new(&timeline, 0.3, 1);
        let x = |t: f64| 2.0 * t - 0.7 * t * t;
        for n in 1..=3 {
            let time = (n as f64 * period / 0.01).round() * 0.01;
            let (displacement, velocity) = ([0.3 + x(time)], [2.0 - 1.4 * time]);
            let (temperature, is_static) = (&[0.0], &[false]);
            let snapshot = Snapshot { time, displacement: &displacement, velocity: &velocity, temperature, is_static };
            fold.observe(n, &snapshot);
        }
        for (n, mean) in (1..=3).zip(fold.finish().summary(&timeline, true).mean) {
            let exact = x(f64::from(n) * period);
            assert!((mean - exact).abs() <= 0.7 * 0.005f64.powi(2) + 1e-12, "{n}: {mean}, not {exact}");
        }
    }

    #[test]
    fn a_slope_takes_two_periods() {
        let timeline = Timeline { end: 4.0, output_step: 4.0, period: Some(2.5) };
        let mut fold = PeriodFold::new(&timeline, 0.0, 3);
        fold.fold(1, &[1.0, 2.0, 6.0]);
        let totals = fold.finish();
        assert!(totals.drift_velocity().named(Statistic::DriftVelocity).estimate.is_nan());
        assert!(totals.diffusion_coefficient(&timeline).named(Statistic::DiffusionCoefficient).estimate.is_nan());
        let summary = totals.summary(&timeline, true);
        assert_eq!((summary.mean, summary.variance), (vec![3.0], vec![7.0]));
    }
}
