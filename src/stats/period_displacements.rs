//! Displacements from one period to the next.
//!
//! From the displacements u_n = x((n + 1)P) - x(nP), n = 1..M, each path contributes the means
//!
//! ```text
//! a = mean u_n,   b = mean u_n^2
//! c = mean u_n u_{n+1},   d = mean (u_n + u_{n+1})/2,   e = mean (u_n^2 + u_{n+1}^2)/2
//! ```
//!
//! the last three over n = 1..M-1. In terms of the means of these over paths, the mean of u is a
//! and its variance is b - a^2. The correlation of neighbours is that of the pairs: their
//! covariance c - d^2 over the variance e - d^2 of their members, both about the mean d of the
//! members. So it lies between -1 and 1, and u_1 and u_M, which are in one pair only, count half in
//! it. Errors follow from the scatter of a to e from path to path.

use crate::scheme::Timeline;
use crate::sums::Replicate;
use crate::sums::codec::sums_of_fields;
use crate::sums::interval::Measured;
use crate::sums::moments::JointMoments;
use crate::sums::rare::{FEWEST, FEWEST_FOR_SPREAD};
use crate::sums::spread::Tails;

/// Moments of the displacements from period to period.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PeriodDisplacements {
    /// M, which follows from the timeline.
    displacements: usize,
    /// Moments of a, b, c, d and e.
    paths: JointMoments<5>,
    /// Powers of the influences on the standard deviation of u_n, and on their correlation.
    tails: Tails,
    correlation_tails: Tails,
    /// Units that move from one period to the next.
    moving: u64,
}

impl PeriodDisplacements {
    pub fn empty(timeline: &Timeline) -> Self {
        PeriodDisplacements {
            displacements: timeline.counted_periods(),
            paths: JointMoments::default(),
            tails: Tails::default(),
            correlation_tails: Tails::default(),
            moving: 0,
        }
    }

    /// A number that depends only on moving bodies. Their periods do not show how rare they are.
    pub fn moved(&self, measured: Measured, fewest: u64) -> Measured {
        measured.of_few(self.moving, self.paths.count, fewest)
    }

    /// Mean of u_n.
    pub fn mean(&self) -> Measured {
        if self.displacements == 0 {
            Measured::NOTHING
        } else {
            self.moved(Measured::mean_of(&self.paths, 0), FEWEST)
        }
    }

    /// Standard deviation of u_n. A value below 1e-8 of the root mean square is lost in rounding,
    /// and the result is zero.
    pub fn sd(&self, unit: Replicate) -> Measured {
        // A single number has no spread.
        if self.displacements as u64 * self.paths.count * unit.size() < 2 {
            return Measured::NOTHING;
        }
        let [a, b, ..] = self.paths.mean;
        match variance(b, a) {
            0.0 => Measured::smooth(0.0, &self.paths, [0.0; 5], self.paths.count),
            variance => {
                let sd = variance.sqrt();
                let smooth = Measured::smooth(
                    sd,
                    &self.paths,
                    [-a / sd, 0.5 / sd, 0.0, 0.0, 0.0],
                    self.paths.count,
                );
                let error = smooth.measurement().standard_error;
                let law = self.tails.error_law(self.paths.count);
                let spread = Measured::spread(sd, error, law, self.paths.count);
                self.moved(spread, FEWEST_FOR_SPREAD)
            }
        }
    }

    /// Correlation of u_n and u_{n+1}; it does not exist where u_n does not vary.
    pub fn correlation(&self) -> Measured {
        let [.., c, d, e] = self.paths.mean;
        let variance = variance(e, d);
        if self.displacements < 2 || self.paths.count == 0 || variance == 0.0 {
            return Measured::NOTHING;
        }
        let r = (c - d * d) / variance;
        let gradient = on_correlation(d, r).map(|g| g / variance);
        // Rounding may carry the estimate out of the range of a correlation.
        let smooth = Measured::smooth(r.clamp(-1.0, 1.0), &self.paths, gradient, self.paths.count);
        let law = self.correlation_tails.error_law(self.paths.count);
        self.moved(
            smooth.with_law(law).about_mean_of(self.paths.count as f64),
            FEWEST_FOR_SPREAD,
        )
    }
}

/// The gradient of the correlation r in a to e, times the variance of the members of pairs.
fn on_correlation(d: f64, r: f64) -> [f64; 5] {
    [0.0, 0.0, 1.0, -2.0 * d * (1.0 - r), -r]
}

/// The variance of numbers with this mean square and this mean; zero where it is lost in rounding.
fn variance(mean_square: f64, mean: f64) -> f64 {
    let variance = mean_square - mean * mean;
    if variance <= 4.0 * f64::EPSILON * mean_square {
        0.0
    } else {
        variance
    }
}

sums_of_fields!(PeriodDisplacements {
    paths,
    tails,
    correlation_tails,
    moving
});

/// Folds one block of paths, period by period.
pub(super) struct PeriodDisplacementsFold {
    empty: PeriodDisplacements,
    /// Number of instants so far.
    seen: usize,
    paths: Vec<PathDisplacements>,
}

#[derive(Clone, Copy, Debug, Default)]
struct PathDisplacements {
    /// x at the last instant.
    displacement: f64,
    /// u_1 and the last u_n.
    first: f64,
    last: f64,
    /// Sums of u_n, u_n^2 and u_n u_{n+1}.
    sum: f64,
    squares: f64,
    products: f64,
}

impl PeriodDisplacementsFold {
    pub fn new(timeline: &Timeline, paths: usize) -> Self {
        let empty = PeriodDisplacements::empty(timeline);
        let paths = if empty.displacements == 0 { 0 } else { paths };
        PeriodDisplacementsFold {
            empty,
            seen: 0,
            paths: vec![PathDisplacements::default(); paths],
        }
    }

    /// Add the paths at the next instant of the same phase.
    pub fn fold(&mut self, displacement: &[f64]) {
        self.seen += 1;
        for (path, &x) in self.paths.iter_mut().zip(displacement) {
            let u = x - path.displacement;
            path.displacement = x;
            if self.seen == 1 {
                continue;
            }
            if self.seen == 2 {
                path.first = u;
            }
            path.sum += u;
            path.squares += u * u;
            // `last` is zero before the first displacement.
            path.products += path.last * u;
            path.last = u;
        }
    }

    pub fn finish(self, unit: Replicate) -> PeriodDisplacements {
        if self.paths.is_empty() {
            return self.empty;
        }
        let (all, pairs) = (
            self.empty.displacements as f64,
            self.empty.displacements as f64 - 1.0,
        );
        let column = |of: &dyn Fn(&PathDisplacements) -> f64| unit.column(&self.paths, of);
        let of_pairs = |sum: f64| if pairs > 0.0 { sum / pairs } else { 0.0 };
        let columns = [
            column(&|path| path.sum / all),
            column(&|path| path.squares / all),
            column(&|path| of_pairs(path.products)),
            column(&|path| of_pairs(path.sum - 0.5 * (path.first + path.last))),
            column(&|path| {
                of_pairs(path.squares - 0.5 * (path.first * path.first + path.last * path.last))
            }),
        ];
        let paths = JointMoments::of(columns.each_ref().map(Vec::as_slice));
        let [a, .., c, d, e] = paths.mean;
        let influences = |gradient: [f64; 5]| {
            let along = |i: usize| {
                (0..5)
                    .map(|j| gradient[j] * (columns[j][i] - paths.mean[j]))
                    .sum()
            };
            Tails::of((0..columns[0].len()).map(along))
        };
        let tails = influences([-2.0 * a, 1.0, 0.0, 0.0, 0.0]);
        let correlation_tails = influences(on_correlation(d, (c - d * d) / variance(e, d)));
        let moving = unit.count(&self.paths, |path| path.squares > 0.0);
        PeriodDisplacements {
            paths,
            tails,
            correlation_tails,
            moving,
            ..self.empty
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Merge as _;

    /// Three paths with u = 1, 2, 0 and -1, 1, 3 and -2, -1, -3, with mean 0. a is 1, 1, -2. b is
    /// 5/3, 11/3, 14/3, and its mean 10/3 is the variance. The influences on the standard deviation
    /// are (b - 10/3)/(2 sd). Of three paths, the jackknife has twice the error to first
    /// order of a spread or a correlation.
    ///
    /// Of the pairs, c is 1, 1, 5/2, with mean 3/2; d is 5/4, 1, -7/4, with mean 1/6; and e is 9/4,
    /// 3, 15/4, with mean 3. So the covariance is 3/2 - 1/36 = 53/36, the variance of the members
    /// is 107/36, and r = 53/107. The influences on it are (c - 3/2 - (1 - r)/3 (d - 1/6) - r (e -
    /// 3))/(107/36). A constant added to every u changes the mean alone.
    #[test]
    fn the_errors_of_unequal_paths_are_those_computed_by_hand() {
        let timeline = Timeline {
            end: 4.0,
            output_step: 4.0,
            period: Some(1.0),
            after: 0.0,
        };
        let u = [[1.0, 2.0, 0.0], [-1.0, 1.0, 3.0], [-2.0, -1.0, -3.0]];
        for constant in [0.0, 1.0, -7.0] {
            // The paths are in two blocks and start at different places.
            let part = |paths: &[[f64; 3]]| {
                let mut fold = PeriodDisplacementsFold::new(&timeline, paths.len());
                let mut x: Vec<f64> = (0..paths.len()).map(|path| 5.0 - path as f64).collect();
                fold.fold(&x);
                for n in 0..3 {
                    x.iter_mut()
                        .zip(paths)
                        .for_each(|(x, u)| *x += u[n] + constant);
                    fold.fold(&x);
                }
                fold.finish(Replicate::Path)
            };
            let mut all = part(&u[..1]);
            all.merge(&part(&u[1..]));
            let (sd, t) = ((10.0f64 / 3.0).sqrt(), 4.302_652_729_9);
            let on_sd = (42.0f64 / 9.0 / 6.0).sqrt() / sd;
            let r = 53.0 / 107.0;
            let on_r = [[1.0, 1.25, 2.25], [1.0, 1.0, 3.0], [2.5, -1.75, 3.75]].map(
                |[c, d, e]: [f64; 3]| c - 1.5 - (1.0 - r) / 3.0 * (d - 1.0 / 6.0) - r * (e - 3.0),
            );
            let on_r = 2.0 * (on_r.iter().map(|e| e * e).sum::<f64>() / 6.0).sqrt() * 36.0 / 107.0;
            for (measured, value, error) in [
                (all.mean(), constant, 1.0),
                (all.sd(Replicate::Path), sd, on_sd),
                (all.correlation(), r, on_r),
            ] {
                let e = measured.measurement();
                // Three numbers about their mean always have two degrees of freedom.
                let ends = match value {
                    _ if value == sd => [sd / (1.0 + t * error / sd), f64::INFINITY],
                    _ if value == r => [e.low, e.high],
                    mean => [mean - t * error, mean + t * error],
                };
                let all = [
                    (e.estimate, value),
                    (e.standard_error, error),
                    (e.low, ends[0]),
                ];
                let is_right = all
                    .iter()
                    .all(|(got, expected)| (got - expected).abs() < 1e-9);
                let is_high = e.high == ends[1] || (e.high - ends[1]).abs() < 1e-9;
                assert!(
                    is_right && is_high,
                    "{constant}: {e:?}, expected {value} +- {error}"
                );
            }
        }
    }

    #[test]
    fn constant_displacements_have_no_correlation() {
        let of = |ends: f64, paths: usize| {
            let timeline = Timeline {
                end: ends,
                output_step: ends,
                period: Some(1.0),
                after: 0.0,
            };
            let mut fold = PeriodDisplacementsFold::new(&timeline, paths);
            (0..ends as usize).for_each(|n| fold.fold(&vec![0.1 * n as f64; paths]));
            let fold = fold.finish(Replicate::Path);
            [fold.mean(), fold.sd(Replicate::Path), fold.correlation()]
                .map(|measured| measured.estimate())
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(of(1.0, 3).iter().all(|e| e.is_nan()));
        let [mean, sd, correlation] = of(4.0, 3);
        assert!(
            near(mean, 0.1) && sd == 0.0 && correlation.is_nan(),
            "{mean} {sd} {correlation}"
        );
        let [mean, sd, correlation] = of(2.0, 1);
        assert!(
            near(mean, 0.1) && sd.is_nan() && correlation.is_nan(),
            "{mean} {sd} {correlation}"
        );
    }
}
