//! Friction that varies over time: with the season, or steadily.
//!
//! A - G/2 = f_d/(K beta) and G vary by their own multiples of the same functions of time. All slips
//! show G, and the middles of all jumps show A - G/2; its changes between slips to either side show
//! it best, but are rare while friction is large.

use super::motion::Motion;
use super::samples::spread;
use crate::linear::Normal;
use std::f64::consts::TAU;

/// Seconds of a year.
const YEAR: f64 = 365.25 * 86_400.0;

/// The functions of time by which friction varies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CourseShape {
    /// None: friction is constant.
    #[default]
    Constant,
    /// A cosine and a sine of a year, from this time on.
    Season(f64),
    /// A straight line from -1 to 1 between these times, and constant after them.
    Trend([f64; 2]),
}

impl CourseShape {
    /// Number of functions.
    pub fn columns(self) -> usize {
        match self {
            CourseShape::Constant => 0,
            CourseShape::Season(_) => 2,
            CourseShape::Trend(_) => 1,
        }
    }

    /// The functions at a time; zero for those that it does not have.
    pub fn at(self, time: f64) -> [f64; 2] {
        match self {
            CourseShape::Constant => [0.0; 2],
            CourseShape::Season(start) => {
                let (sine, cosine) = libm::sincos(TAU * (time - start) / YEAR);
                [cosine, sine]
            }
            CourseShape::Trend([begin, end]) => {
                let share = (time - begin) / (end - begin);
                [2.0 * share.clamp(0.0, 1.0) - 1.0, 0.0]
            }
        }
    }

    /// One and the functions, averaged over these times: a row of a regression.
    pub fn row(self, times: &[f64]) -> [f64; 3] {
        let mut row = [1.0, 0.0, 0.0];
        for time in times {
            let [a, b] = self.at(*time);
            row[1] += a / times.len() as f64;
            row[2] += b / times.len() as f64;
        }
        row
    }
}

/// Friction over time, relative to a motion of mean friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// The functions of time.
    pub shape: CourseShape,
    /// By how much they change A - G/2, in kelvin.
    pub kinetic: [f64; 2],
    /// By how much they change G, in kelvin.
    pub jump: [f64; 2],
}

/// A and G are at least this share of their means.
const LEAST: f64 = 0.1;

impl Course {
    /// Whether friction varies.
    pub fn varies(&self) -> bool {
        self.shape != CourseShape::Constant
    }

    /// The motion at a time, if this is the one of mean friction.
    pub fn motion(&self, mean: &Motion, time: f64) -> Motion {
        if !self.varies() {
            return *mean;
        }
        let at = self.shape.at(time);
        let [kinetic, jump] = [self.kinetic, self.jump].map(|of| of[0] * at[0] + of[1] * at[1]);
        let kinetic = (mean.kinetic_reach() + kinetic).max(LEAST * mean.kinetic_reach());
        let jump = (mean.jump + jump).max(LEAST * mean.jump);
        Motion {
            reach: kinetic + 0.5 * jump,
            jump,
            ..*mean
        }
    }

    /// xi at each of these temperatures, one after the other, where levels are closer by `overlooked`
    /// kelvin.
    pub fn follow(
        &self,
        mean: &Motion,
        overlooked: f64,
        [times, temperatures]: [&[f64]; 2],
    ) -> Vec<f64> {
        let mut xi = mean.start;
        let step = |(time, temperature): (&f64, &f64)| {
            let motion = self.motion(mean, *time).at_samples(overlooked);
            xi = motion.next(xi, *temperature);
            xi
        };
        times.iter().zip(temperatures).map(step).collect()
    }

    /// The smallest and the largest A over a year, or over the record, relative to its mean.
    pub fn range(&self, mean: &Motion) -> [f64; 2] {
        let [begin, end] = match self.shape {
            CourseShape::Trend(ends) => ends,
            CourseShape::Season(start) => [start, start + YEAR],
            CourseShape::Constant => [0.0; 2],
        };
        const PLACES: u32 = 366;
        let reach = |i: u32| {
            let time = begin + (end - begin) * f64::from(i) / f64::from(PLACES);
            self.motion(mean, time).reach / mean.reach
        };
        let all = || (0..=PLACES).map(reach);
        [
            all().fold(f64::INFINITY, f64::min),
            all().fold(0.0, f64::max),
        ]
    }

    /// The coefficients of the functions it has, for A - G/2 and for G.
    pub fn coefficients(&self) -> Vec<f64> {
        let n = self.shape.columns();
        [&self.kinetic[..n], &self.jump[..n]].concat()
    }

    /// The same with these coefficients.
    pub fn with(&self, coefficients: &[f64]) -> Self {
        let mut course = *self;
        let (kinetic, jump) = coefficients.split_at(self.shape.columns());
        course.kinetic[..kinetic.len()].copy_from_slice(kinetic);
        course.jump[..jump.len()].copy_from_slice(jump);
        course
    }
}

/// A row of a regression on one and the functions of a shape, and its value.
pub type CourseRow = ([f64; 3], f64);

/// A regression through most values, whatever the others are.
#[derive(Clone, Debug, PartialEq)]
pub struct Typical {
    /// The value of one and of each function.
    pub coefficients: Vec<f64>,
    /// The standard deviation of most residuals.
    pub rest: f64,
}

/// Rounds of the reweighting for least absolute deviations, and the smallest residual that counts, as a
/// share of the typical one.
const ROUNDS: u32 = 20;
const SMALLEST: f64 = 0.2;

/// Residuals beyond this many standard deviations count as much as one there.
const FAR: f64 = 2.5;

impl Typical {
    /// The regression on this many columns; `None` if the rows do not determine it.
    pub fn of(rows: &[CourseRow], columns: usize) -> Option<Self> {
        let solved = |weight: &dyn Fn(f64) -> f64, residuals: &[f64]| {
            let mut normal = Normal::of(columns);
            for ((row, y), residual) in rows.iter().zip(residuals) {
                normal.add(&row[..columns], *y, weight(*residual));
            }
            normal.solve()
        };
        let mut found = Typical {
            coefficients: solved(&|_| 1.0, &vec![0.0; rows.len()])?,
            rest: 0.0,
        };
        for round in 0..=ROUNDS {
            let residuals: Vec<f64> = rows.iter().map(|row| found.residual(row)).collect();
            found.rest = spread(&residuals);
            if found.rest.is_nan() || found.rest <= 0.0 {
                return None;
            }
            let rest = found.rest;
            let weight = |residual: f64| match round < ROUNDS {
                true => 1.0 / residual.abs().max(SMALLEST * rest),
                false => f64::from(u8::from(residual.abs() <= FAR * rest)),
            };
            found.coefficients = solved(&weight, &residuals)?;
        }
        Some(found)
    }

    /// The value of a row.
    pub fn value(&self, row: &[f64; 3]) -> f64 {
        self.coefficients.iter().zip(row).map(|(a, b)| a * b).sum()
    }

    fn residual(&self, (row, y): &CourseRow) -> f64 {
        y - self.value(row)
    }

    /// Twice the log-likelihood ratio of this regression to another of the same rows.
    pub fn gain_over(&self, other: &Typical, rows: &[CourseRow]) -> f64 {
        let far = FAR * self.rest;
        let loss = |of: &Typical| -> f64 {
            let bounded = |row| of.residual(row).abs().min(far).powi(2);
            rows.iter().map(bounded).sum()
        };
        rows.len() as f64 * libm::log(loss(other) / loss(self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::noise::Stream;

    const DAY: f64 = 86_400.0;

    /// Values of a season, of which every fifth is too large by ten standard deviations, as after missed
    /// slips; most are of one half of the year. The coefficients have standard errors below 0.02, and are
    /// within 0.1. Least squares are off by 2.
    #[test]
    fn a_typical_season_is_found_among_missed_slips() {
        let shape = CourseShape::Season(0.0);
        let mut random = Stream::new(5, 0);
        let row = |i: usize| {
            let time = DAY
                * if i < 150 {
                    i as f64
                } else {
                    2.0 * i as f64 - 150.0
                };
            let [a, b] = shape.at(time);
            let missed = if i.is_multiple_of(5) { 1.0 } else { 0.0 };
            let value = 8.0 + 1.5 * a - 0.7 * b + missed + 0.1 * random.normal();
            (shape.row(&[time]), value)
        };
        let rows: Vec<CourseRow> = (0..200).map(row).collect();
        let typical = Typical::of(&rows, 3).expect("determined");
        let off = typical.coefficients.iter().zip([8.0, 1.5, -0.7]);
        assert!(off.clone().all(|(a, b)| (a - b).abs() < 0.1), "{typical:?}");
        let constant = Typical::of(&rows, 1).expect("determined");
        assert!(typical.gain_over(&constant, &rows) > 100.0);
    }

    /// A season of +-20 % around A = 8 K and G = 1.6 K is largest at its start, and A stays within it. A
    /// trend stays where it ends.
    #[test]
    fn friction_follows_its_course() {
        let mean = Motion {
            reach: 8.0,
            jump: 1.6,
            start: 3.0,
        };
        let season = Course {
            shape: CourseShape::Season(100.0 * DAY),
            kinetic: [1.44, 0.0],
            jump: [0.32, 0.0],
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let [low, high] = season.range(&mean);
        assert!(near(low, 0.8) && near(high, 1.2), "{low} {high}");
        let summer = season.motion(&mean, 100.0 * DAY + 0.5 * YEAR);
        assert!(near(summer.reach, 6.4) && near(summer.jump, 1.28) && summer.start == 3.0);
        let trend = Course {
            shape: CourseShape::Trend([0.0, 300.0 * DAY]),
            kinetic: [-0.72, 0.0],
            jump: [-0.16, 0.0],
        };
        let [begin, end, later] =
            [0.0, 300.0, 400.0].map(|day| trend.motion(&mean, day * DAY).reach);
        assert!(near(begin, 8.8) && near(end, 7.2) && later == end);
        assert_eq!(trend.with(&trend.coefficients()), trend);
        assert_eq!(Course::default().motion(&mean, 5.0), mean);
    }
}
