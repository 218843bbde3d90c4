//! x at the whole forcing periods: drift velocity and diffusion coefficient.
//!
//! Both are slopes of ordinary least squares over t_n = n P, n = 1..N, written with the weights
//! c_n = (t_n - mean t) / sum (t_n - mean t)^2:
//!
//! ```text
//! drift velocity          V = mean over paths of   sum_n c_n (x_i(t_n) - x0)
//! diffusion coefficient   D = 1/2 sum_n c_n Var x(t_n)
//! ```

use super::PeriodMoments;
use super::interval::Measured;
use super::moments::Moments;
use crate::scheme::Timeline;

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
pub(super) struct PeriodTotals {
    slope: Slope,
    /// Of x(t_n) - x0.
    displacement: Vec<Moments>,
    /// Of each path's slope.
    drift: Moments,
    /// Of each path's share in the slope of the variance.
    spreading: Moments,
}

impl PeriodTotals {
    pub fn empty(timeline: &Timeline) -> Self {
        let slope = Slope::over(timeline);
        let displacement = vec![Moments::default(); slope.time.len()];
        PeriodTotals { slope, displacement, drift: Moments::default(), spreading: Moments::default() }
    }

    pub fn merge(&mut self, other: &PeriodTotals) {
        for (mine, more) in self.displacement.iter_mut().zip(&other.displacement) {
            mine.merge(more);
        }
        self.drift.merge(&other.drift);
        self.spreading.merge(&other.spreading);
    }

    /// V; it takes two periods.
    pub fn drift_velocity(&self) -> Measured {
        if self.slope.weights.is_empty() { Measured::NOTHING } else { Measured::mean(&self.drift) }
    }

    /// D; it takes two periods and two paths.
    ///
    /// The estimate is half the slope of the unbiased pooled variances. Its error is that of the mean over paths of
    /// y_i = sum_n c_n (x_i(t_n) - m_n)^2, whose centre m_n is the mean over the path's block. With n paths in a block m_n is off
    /// by sd/sqrt(n), which changes the spread of the y_i by a relative O(1/n), made smaller by the factor n/(n - 1) on them:
    /// below 1 % of the standard error at 256 paths a block. A block of a single path has no spread and is left out.
    pub fn diffusion_coefficient(&self) -> Measured {
        if self.slope.weights.is_empty() {
            return Measured::NOTHING;
        }
        let variances = self.displacement.iter().map(Moments::variance);
        let slope: f64 = self.slope.weights.iter().zip(variances).map(|(c, variance)| c * variance).sum();
        Measured::mean(&self.spreading).about(slope).divided_by(2.0)
    }

    pub fn summary(&self) -> PeriodMoments {
        PeriodMoments {
            time: self.slope.time.clone(),
            mean: self.displacement.iter().map(Moments::mean).collect(),
            variance: self.displacement.iter().map(Moments::variance).collect(),
        }
    }
}

/// One block of paths on its way through the periods.
pub(super) struct PeriodFold {
    totals: PeriodTotals,
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
        let totals = PeriodTotals::empty(timeline);
        let paths = if totals.slope.weights.is_empty() { 0 } else { paths };
        PeriodFold { totals, x0, displacement: Vec::new(), slope: vec![0.0; paths], spread: vec![0.0; paths] }
    }

    /// The end of period `n` = 1, 2, ...
    pub fn fold(&mut self, n: usize, displacement: &[f64]) {
        self.displacement.clear();
        self.displacement.extend(displacement.iter().map(|x| x - self.x0));
        let moments = Moments::of(&self.displacement);
        if let Some(slot) = self.totals.displacement.get_mut(n - 1) {
            *slot = moments;
        }
        let Some(&weight) = self.totals.slope.weights.get(n - 1) else { return };
        for ((slope, spread), &u) in self.slope.iter_mut().zip(&mut self.spread).zip(&self.displacement) {
            *slope += weight * u;
            *spread += weight * (u - moments.mean) * (u - moments.mean);
        }
    }

    pub fn finish(mut self) -> PeriodTotals {
        self.totals.drift = Moments::of(&self.slope);
        if let n @ 2.. = self.spread.len() {
            let correction = n as f64 / (n - 1) as f64;
            self.spread.iter_mut().for_each(|y| *y *= correction);
            self.totals.spreading = Moments::of(&self.spread);
        }
        self.totals
    }
}
