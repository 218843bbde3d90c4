//! The temperature at which a slip began.
//!
//! A slip comes when the temperature reaches a threshold c for the first time. Of c it is known
//! that the temperature did not reach it until the last sample before the slip, and reached it
//! before the first sample after it. Between two samples a and b on the near side of c, a Brownian
//! bridge reaches c with the probability
//!
//! ```text
//! p(c) = exp(-2 (c - a)(c - b)/(s^2 h)),    s^2 h: the variance gained from one sample to the next
//! ```
//!
//! So the probability of what was seen is (1 - p) for each step before the slip, times 1 minus such
//! a product for the steps in which it came. Since there was one slip and not two, c + G was not
//! reached there: the product for c + G takes the place of 1 once G is known. No c is likelier than another beforehand, since it
//! does not depend on when samples are taken; so the temperature of the slip is the mean of c,
//! weighted with this probability. With straight lines between samples, p is 0 or 1, and the mean
//! is the middle between the farthest sample before the slip and the one after it.

use super::thermometer::Thermometer;

/// When a slip came: the time of the sample after the slip before it, and the times of the samples
/// before and after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The time from which on no slip was seen.
    pub since: f64,
    /// The last sample before the slip.
    pub before: f64,
    /// The first sample after it.
    pub after: f64,
}

/// What the samples say of the temperature of a slip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Crossing {
    /// Its mean, in kelvin.
    pub temperature: f64,
    /// Its variance.
    pub variance: f64,
    /// The integral of the probability over all temperatures, in kelvin. The larger it is, the
    /// better the movement between samples explains that the slip came here.
    pub evidence: f64,
}

/// Times that are closer than this are the same, in seconds.
const SAME: f64 = 1e-3;

/// Number of temperatures at which the probability is computed.
const POINTS: usize = 120;

/// How far beyond the samples a threshold is looked for, in standard deviations of a step.
const BEYOND: f64 = 4.0;

/// Steps whose p is below e to the power of minus this are left out.
const NEGLIGIBLE: f64 = 18.0;

impl Thermometer {
    /// The crossing of a slip in this window, with its sign; `None` if the thermometer shows
    /// nothing around it. Where temperatures are drawn, each counts as it explains that the slip
    /// came here.
    pub(super) fn crossing(&self, window: &Window, sign: f64) -> Option<Crossing> {
        let one = |temperatures: &[f64]| self.crossing_of(temperatures, window, sign);
        if self.drawn.is_empty() {
            return one(&self.temperatures);
        }
        let seen: Vec<Crossing> = self.drawn.iter().filter_map(|drawn| one(drawn)).collect();
        let all: f64 = seen.iter().map(|one| one.evidence).sum();
        if all == 0.0 {
            return one(&self.temperatures);
        }
        let mean = |of: &dyn Fn(&Crossing) -> f64| {
            seen.iter().map(|one| one.evidence * of(one)).sum::<f64>() / all
        };
        let temperature = mean(&|one| one.temperature);
        let variance = mean(&|one| one.variance + (one.temperature - temperature).powi(2));
        Some(Crossing {
            temperature,
            variance,
            evidence: all / self.drawn.len() as f64,
        })
    }

    fn crossing_of(&self, temperatures: &[f64], window: &Window, sign: f64) -> Option<Crossing> {
        // Samples of the displacement are among the times, but for rounding of clocks that differ.
        let until = |time: f64| {
            self.times
                .partition_point(|t| *t <= time + SAME)
                .checked_sub(1)
        };
        let last = until(window.before)?;
        let first = until(window.since)?.min(last);
        let end = until(window.after)?.max(last + 1).min(self.times.len() - 1);
        let u = |i: usize| sign * temperatures[i];
        let farthest = (first..=last).map(u).fold(f64::NEG_INFINITY, f64::max);
        let reached = (last + 1..=end).map(u).fold(f64::NEG_INFINITY, f64::max);
        let gain = |i: usize| self.roughness * (self.times[i + 1] - self.times[i]);
        let wide = (last..end).map(gain).fold(0.0, f64::max).sqrt();
        if wide == 0.0 {
            let beyond = (reached - farthest).max(0.0);
            let temperature = sign * (farthest + 0.5 * beyond);
            return Some(Crossing {
                temperature,
                variance: beyond * beyond / 12.0,
                evidence: beyond,
            });
        }
        let is_near =
            |i: &usize| (farthest - u(*i)) * (farthest - u(i + 1)) < 0.5 * NEGLIGIBLE * gain(*i);
        let before: Vec<usize> = (first..last).filter(is_near).collect();
        let missed = |c: f64, i: usize| {
            let [a, b] = [c - u(i), c - u(i + 1)];
            if a <= 0.0 || b <= 0.0 {
                0.0
            } else {
                -libm::expm1(-2.0 * a * b / gain(i))
            }
        };
        let length = (reached - farthest).max(0.0) + BEYOND * wide;
        let step = length / POINTS as f64;
        let [mut all, mut moment, mut square] = [0.0; 3];
        for point in 0..POINTS {
            let off = (point as f64 + 0.5) * step;
            let c = farthest + off;
            let so_far: f64 = before.iter().map(|i| missed(c, *i)).product();
            let not = |c: f64| (last..end).map(|i| missed(c, i)).product::<f64>();
            let once = if self.jump.is_finite() {
                not(c + self.jump)
            } else {
                1.0
            } - not(c);
            all += so_far * once;
            moment += so_far * once * off;
            square += so_far * once * off * off;
        }
        let [off, square] = if all > 0.0 {
            [moment / all, square / all]
        } else {
            [0.0; 2]
        };
        let variance = (square - off * off).max(0.0);
        Some(Crossing {
            temperature: sign * (farthest + off),
            variance,
            evidence: all * step,
        })
    }
}

/// The share of slips whose times say nothing of the movement between samples, because they were
/// seen a sample too early or too late.
const MISPLACED: f64 = 0.05;

/// By how much the logarithm of the likelihood of straight lines has to be larger, because
/// temperatures outdoors are rough.
const RARE: f64 = 5.0;

/// The thermometer as the times of the slips say it moves: as rough between samples as from one
/// sample to the next, or in straight lines. Samples alone do not tell these apart, but of the
/// slips under a rough temperature, one of three comes although no sample goes beyond the farthest
/// one before it.
pub fn as_slips_say(
    rough: Thermometer,
    straight: Thermometer,
    slips: &[(Window, f64)],
) -> Thermometer {
    let likelihood = |course: &Thermometer| -> f64 {
        let of = |(window, sign): &(Window, f64)| {
            let wide = (rough.roughness * (window.after - window.before)).sqrt();
            let seen = course.crossing(window, *sign).unwrap_or_default();
            libm::log((1.0 - MISPLACED) * seen.evidence + MISPLACED * wide)
        };
        slips.iter().map(of).sum()
    };
    if rough.roughness > 0.0 && likelihood(&rough) + RARE < likelihood(&straight) {
        straight
    } else {
        rough
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::MeasuredRecord;
    use stickslip::noise::Stream;

    /// A temperature starts at 0 and is seen every 600 s. It gains 0.4 K in a step, and drifts by
    /// 0.04 K. It reaches a threshold between 1 and 3 K at a time that is known to 3 s, from steps
    /// that are two hundred times shorter.
    ///
    /// Null: the temperature of the slip is right on average. Sample size: 1500, with a standard
    /// deviation of 0.17 K at most, which leave a standard error of 0.0045 K; the bound is four of
    /// them, which chance exceeds once in 16 000 times. The middle between the farthest sample and
    /// the next is off by 0.16 K. If the temperature moves in straight lines, the middle is right.
    /// The times of all slips tell one from the other.
    #[test]
    fn a_slip_is_placed_where_it_began() {
        let (parts, interval, sd, count) = (200, 600.0, 0.4, 1500);
        let small = sd / f64::from(parts).sqrt();
        for is_rough in [true, false] {
            let mut random = Stream::new(12, u64::from(is_rough));
            let (mut times, mut temperatures, mut slips) = (Vec::new(), Vec::new(), Vec::new());
            for path in 0..count {
                let (c, start) = (1.0 + 2.0 * random.uniform(), 1e7 * f64::from(path));
                let (mut t, mut has_slipped, mut n) = (0.0, false, 0);
                times.push(start);
                temperatures.push(t);
                while !has_slipped {
                    for _ in 0..parts {
                        t += 0.04 / f64::from(parts) + small * random.normal();
                        // A walk with steps goes beyond a threshold a little later than the
                        // temperature does.
                        has_slipped |= is_rough && t > c - 0.5826 * small;
                    }
                    has_slipped |= !is_rough && t > c;
                    n += 1;
                    times.push(start + interval * f64::from(n));
                    temperatures.push(t);
                }
                let after = times[times.len() - 1];
                slips.push((
                    Window {
                        since: start,
                        before: after - interval,
                        after,
                    },
                    1.0,
                    c,
                ));
            }
            let record = MeasuredRecord {
                readings: vec![0.0; times.len()],
                temperatures,
                times,
                ..MeasuredRecord::default()
            };
            let rough = Thermometer::of(&record).moving(sd * sd / interval);
            let straight = rough.clone().moving(0.0);
            let off = |course: &Thermometer| {
                let off = slips.iter().map(|(window, sign, c)| {
                    course.crossing(window, *sign).expect("seen").temperature - c
                });
                let [sum, square] = off.fold([0.0; 2], |[sum, square], off| {
                    [sum + off, square + off * off]
                });
                [sum, square.sqrt()].map(|sum| sum / f64::from(count))
            };
            let ([mean, error], [middle, _]) = (
                off(if is_rough { &rough } else { &straight }),
                off(&straight),
            );
            println!("rough {is_rough}: off by {mean:.4} +- {error:.4}, the middle by {middle:.4}");
            assert!(mean.abs() < 4.0 * error && error < 0.0045, "{mean} {error}");
            assert!(!is_rough || (middle + 0.16).abs() < 0.02, "{middle}");
            let some: Vec<(Window, f64)> = slips
                .iter()
                .take(100)
                .map(|(window, sign, _)| (*window, *sign))
                .collect();
            assert_eq!(
                as_slips_say(rough, straight, &some).roughness > 0.0,
                is_rough
            );
        }
    }
}
