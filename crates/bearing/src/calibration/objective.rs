//! A fast evaluation of the paper's least-squares criterion.
//!
//! err is the integral of (z_model - z)^2 over the measured time. z0 and the two slopes enter the
//! model linearly, so for each A, G and xi(0) their best values follow from a regression on three
//! columns. xi is constant between slips, so sums over a stick are differences of cumulative sums,
//! and the next slip is found from the extremes of whole blocks of temperatures. The cost of an
//! evaluation is therefore proportional to the number of slips and not to the number of samples.
//!
//! A body under a temperature that is rough between samples slips before a sample exceeds A. So the
//! samples are compared with A minus `overlooked` kelvin (`roughness.rs`).

use super::bearing::Sensor;
use super::motion::Motion;
use super::samples::MeasuredRecord;
use crate::linear::Normal;

/// Number of entries of one level that are combined to one entry of the next.
const RADIX: usize = 16;

/// Cumulative sums over the samples before a given one, each weighted with the time that it
/// represents.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct CumulativeSums {
    time: f64,
    temperature: f64,
    reading: f64,
}

/// err as a function of A, G and xi(0).
#[derive(Clone, Debug)]
pub struct FitObjective {
    temperatures: Vec<f64>,
    overlooked: f64,
    before: Vec<CumulativeSums>,
    /// Lowest and highest temperatures of 16 samples, of 16 times 16 samples, and so on. Single
    /// samples are not stored as pairs, which would make a calibration a tenth slower.
    extremes: Vec<Vec<[f64; 2]>>,
    /// The means of temperature and reading. All sums are of deviations from them, to avoid
    /// rounding errors.
    centre: [f64; 2],
    /// Sums of T T, T z and z z.
    products: [f64; 3],
}

impl FitObjective {
    /// Prepare the evaluation for a record. Samples without a reading move the body, but are not
    /// compared. `overlooked` is the apparent decrease of A at the samples, in kelvin.
    pub fn new(record: &MeasuredRecord, overlooked: f64) -> FitObjective {
        let temperatures = &record.temperatures;
        let shares = record.shares();
        let readings: Vec<f64> = record
            .readings
            .iter()
            .map(|z| if z.is_finite() { *z } else { 0.0 })
            .collect();
        let total: f64 = shares.iter().sum();
        let mean =
            |values: &[f64]| values.iter().zip(&shares).map(|(v, w)| v * w).sum::<f64>() / total;
        let centre = [mean(temperatures), mean(&readings)];
        let mut before = vec![CumulativeSums::default()];
        let (mut sum, mut products) = (CumulativeSums::default(), [0.0; 3]);
        for i in 0..shares.len() {
            let (w, t, z) = (
                shares[i],
                temperatures[i] - centre[0],
                readings[i] - centre[1],
            );
            sum.time += w;
            sum.temperature += w * t;
            sum.reading += w * z;
            before.push(sum);
            for (product, value) in products.iter_mut().zip([t * t, t * z, z * z]) {
                *product += w * value;
            }
        }
        let mut level: Vec<[f64; 2]> = temperatures.iter().map(|t| [*t, *t]).collect();
        let mut extremes = Vec::new();
        while level.len() > RADIX {
            let widest = |part: &[[f64; 2]]| {
                part.iter()
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [l, h]| {
                        [low.min(*l), high.max(*h)]
                    })
            };
            level = level.chunks(RADIX).map(widest).collect();
            extremes.push(level.clone());
        }
        FitObjective {
            temperatures: temperatures.clone(),
            overlooked,
            before,
            extremes,
            centre,
            products,
        }
    }

    /// The index of the first sample, from `from` on, whose temperature is not between `low` and
    /// `high`.
    #[inline(always)]
    fn first_beyond(&self, from: usize, low: f64, high: f64) -> usize {
        let n = self.temperatures.len();
        let is_beyond = |[l, h]: [f64; 2]| l < low || h > high;
        let mut i = from;
        // Go up to larger blocks as long as whole blocks are inside.
        let mut height = 0;
        loop {
            if height == 0 {
                let end = (i / RADIX + 1) * RADIX;
                while i < end.min(n) {
                    if is_beyond([self.temperatures[i]; 2]) {
                        return i;
                    }
                    i += 1;
                }
                if i >= n {
                    return n;
                }
                i /= RADIX;
            } else {
                let level = &self.extremes[height - 1];
                let end = ((i / RADIX + 1) * RADIX).min(level.len());
                while i < end && !is_beyond(level[i]) {
                    i += 1;
                }
                if i < end {
                    break;
                }
                if i >= level.len() {
                    return n;
                }
                i /= RADIX;
            }
            height += 1;
            if height > self.extremes.len() {
                return n;
            }
        }
        // Go down again within the first block that is not.
        while height > 0 {
            i *= RADIX;
            height -= 1;
            let entry = |i: usize| match height {
                0 => [self.temperatures[i]; 2],
                _ => self.extremes[height - 1][i],
            };
            while !is_beyond(entry(i)) {
                i += 1;
            }
        }
        i
    }

    /// err for this motion, in the unit of displacement squared times seconds, and the sensor that
    /// minimises it.
    pub fn of(&self, motion: &Motion) -> (f64, Sensor) {
        self.best_sensor(self.sums(motion))
    }

    /// The same with linear constraints on (z0, moving, still). If they cannot all hold, err grows
    /// fast.
    pub fn held(&self, motion: &Motion, rows: &[([f64; 3], f64)]) -> (f64, Sensor) {
        /// The weight of an equation relative to the record.
        const WEIGHT: f64 = 1e4;
        let [x, xx, xt, xz] = self.sums(motion);
        let [tt, tz, zz] = self.products;
        let (time, origin) = (self.duration(), self.centre[0]);
        // The first unknown is the deviation of z from its mean, at the mean temperature of body
        // and steel, instead of z0.
        let matrix = vec![vec![time, 0.0, 0.0], vec![x, xx, 0.0], vec![0.0, xt, tt]];
        let mut normal = Normal {
            matrix,
            right: vec![0.0, xz, tz],
        };
        let moved: Vec<([f64; 3], f64)> = (rows.iter())
            .map(|([a, b, c], value)| {
                (
                    [*a, b - a * origin, c - a * origin],
                    value - a * self.centre[1],
                )
            })
            .collect();
        moved
            .iter()
            .for_each(|(row, value)| normal.add(row, *value, WEIGHT * time));
        let Some(Ok([level, moving, still])) = normal.solve().map(<[f64; 3]>::try_from) else {
            return self.best_sensor([x, xx, xt, xz]);
        };
        let quadratic = time * level * level
            + xx * moving * moving
            + tt * still * still
            + 2.0 * (x * level * moving + xt * moving * still);
        let off = |(row, value): &([f64; 3], f64)| {
            (row[0] * level + row[1] * moving + row[2] * still - value).powi(2) * WEIGHT * time
        };
        let err =
            zz - 2.0 * (moving * xz + still * tz) + quadratic + moved.iter().map(off).sum::<f64>();
        let offset = self.centre[1] + level - (moving + still) * origin;
        (
            err.max(0.0),
            Sensor {
                offset,
                moving,
                still,
            },
        )
    }

    /// Sums of xi, xi xi, xi T and xi z.
    #[inline(always)]
    fn sums(&self, motion: &Motion) -> [f64; 4] {
        let n = self.temperatures.len();
        let motion = motion.at_samples(self.overlooked);
        let mut sums = [0.0; 4];
        // xi is taken relative to the mean temperature, like the other sums.
        let origin = self.centre[0];
        let (mut i, mut k, mut xi) = (0, 0, motion.start);
        while i < n {
            let (low, high) = (xi - motion.reach, xi + motion.reach);
            if k < n && self.temperatures[k] >= low && self.temperatures[k] <= high {
                k = self.first_beyond(k + 1, low, high);
            }
            let (from, to, at) = (&self.before[i], &self.before[k], xi - origin);
            let time = to.time - from.time;
            sums[0] += at * time;
            sums[1] += at * at * time;
            sums[2] += at * (to.temperature - from.temperature);
            sums[3] += at * (to.reading - from.reading);
            if k == n {
                break;
            }
            xi = motion.next(xi, self.temperatures[k]);
            i = k;
            k += 1;
        }
        sums
    }

    fn best_sensor(&self, [x, xx, xt, xz]: [f64; 4]) -> (f64, Sensor) {
        let time = self.duration();
        let [tt, tz, zz] = self.products;
        let xx = xx - x * x / time;
        let determinant = xx * tt - xt * xt;
        // If the body never moves, the data do not determine `moving`.
        let [moving, still] = if determinant > 1e-12 * xx * tt {
            [
                (xz * tt - tz * xt) / determinant,
                (tz * xx - xz * xt) / determinant,
            ]
        } else {
            [0.0, tz / tt]
        };
        let err = zz - moving * xz - still * tz;
        let offset = self.centre[1] - moving * (self.centre[0] + x / time) - still * self.centre[0];
        (
            err.max(0.0),
            Sensor {
                offset,
                moving,
                still,
            },
        )
    }

    /// The measured time, in seconds.
    pub fn duration(&self) -> f64 {
        self.before.last().map_or(0.0, |all| all.time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::hold::row;
    use crate::calibration::quantity::{Quantity, values};
    use stickslip::noise::Stream;

    /// If beta, z0, K, f_s or f_s - f_d is held, the sensor has that value, and err is that of this
    /// sensor. If it is held at its best value, err does not change.
    #[test]
    fn a_held_quantity_has_its_value() {
        let temperatures: Vec<f64> = (0..3000)
            .map(|i| 10.0 + 8.0 * libm::sin(0.01 * f64::from(i)))
            .collect();
        let motion = Motion {
            reach: 3.0,
            jump: 0.8,
            start: 9.0,
        };
        let positions = motion.follow(&temperatures);
        let mut random = Stream::new(6, 0);
        let readings = positions
            .iter()
            .zip(&temperatures)
            .map(|(x, t)| 2.0 + 0.9 * x + 0.1 * t + 0.2 * random.normal())
            .collect();
        let times = (0..3000).map(f64::from).collect();
        let record = MeasuredRecord {
            times,
            temperatures,
            readings,
            ..MeasuredRecord::default()
        };
        let objective = FitObjective::new(&record, 0.0);
        let (least, best) = objective.of(&motion);
        let at =
            |sensor: Sensor| values(&crate::calibration::Response { motion, sensor }, Some(1e3));
        for quantity in [
            Quantity::Dilatation,
            Quantity::Offset,
            Quantity::Stiffness,
            Quantity::Static,
            Quantity::Gap,
        ] {
            for factor in [1.0, 1.2] {
                let target = factor * at(best)[quantity as usize];
                let (err, sensor) =
                    objective.held(&motion, &[row(&(quantity, target), &motion, 1e3)]);
                let got = at(sensor)[quantity as usize];
                assert!(
                    (got / target - 1.0).abs() < 1e-3,
                    "{quantity:?}: {got} for {target}"
                );
                let slow: f64 = (0..3000)
                    .map(|i| {
                        (sensor.reading(positions[i], record.temperatures[i]) - record.readings[i])
                            .powi(2)
                    })
                    .sum();
                assert!(
                    (err / slow - 1.0).abs() < 0.05,
                    "{quantity:?}: {err} for {slow}"
                );
                assert!(
                    factor > 1.0 || (err / least - 1.0).abs() < 1e-6,
                    "{quantity:?}"
                );
            }
        }
    }

    /// Compared with the model followed sample by sample: large and small motions, one without a
    /// gap, and one that never moves.
    #[test]
    fn err_is_that_of_the_model_followed_sample_by_sample() {
        let mut random = Stream::new(5, 0);
        let mut t = 10.0;
        let temperatures: Vec<f64> = (0..5000)
            .map(|_| {
                t += 0.3 * random.normal() - 0.002 * (t - 10.0);
                t
            })
            .collect();
        let [reach, jump, start] = [3.0, 0.8, 9.0];
        let hidden = Motion { reach, jump, start }.follow(&temperatures);
        let noisy = |(i, (xi, t)): (usize, (&f64, &f64))| {
            if i % 50 == 7 {
                f64::NAN
            } else {
                2.0 + 0.9 * xi + 0.1 * t + 0.2 * random.normal()
            }
        };
        let readings = hidden
            .iter()
            .zip(&temperatures)
            .enumerate()
            .map(noisy)
            .collect();
        let times = (0..5000).map(|i| 60.0 * (i + i / 900) as f64).collect();
        let record = MeasuredRecord {
            times,
            temperatures,
            readings,
            ..MeasuredRecord::default()
        };
        let objective = FitObjective::new(&record, 0.05);
        let shares = record.shares();
        for (reach, jump) in [
            (3.0, 0.8),
            (2.0, 4.0),
            (0.4, 0.01),
            (0.01, 0.003),
            (1.0, 0.0),
            (1e3, 1.0),
        ] {
            let motion = Motion {
                reach,
                jump,
                start: 9.3,
            };
            let (err, sensor) = objective.of(&Motion {
                reach: reach + 0.05,
                ..motion
            });
            let positions = motion.follow(&record.temperatures);
            let slow = |sensor: &Sensor| -> f64 {
                let seen = (0..5000).filter(|i| record.readings[*i].is_finite());
                let off = |i: usize| {
                    sensor.reading(positions[i], record.temperatures[i]) - record.readings[i]
                };
                seen.map(|i| shares[i] * off(i).powi(2)).sum()
            };
            assert!(
                (err / slow(&sensor) - 1.0).abs() < 1e-9,
                "{motion:?}: {err} and {}",
                slow(&sensor)
            );
            // No other sensor gives a smaller err.
            for [a, b, c] in [
                [1e-3, 0.0, 0.0],
                [0.0, 1e-3, 0.0],
                [0.0, 0.0, 1e-3],
                [-1e-3, 1e-4, -1e-4],
            ] {
                let other = Sensor {
                    offset: sensor.offset + a,
                    moving: sensor.moving + b,
                    still: sensor.still + c,
                };
                assert!(slow(&other) > err, "{motion:?}");
            }
        }
    }
}
