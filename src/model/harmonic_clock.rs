//! The deterministic temperature at the instants t_n = n h, with an error that does not grow with
//! the number of steps.

use super::{Harmonic, Series, Temperature};
use std::f64::consts::TAU;
use std::sync::Arc;

/// 1/(2 pi) to 107 bits, as the sum of two doubles.
const TURNS_PER_RADIAN: (f64, f64) = (0.159_154_943_091_895_35, -9.839_338_337_591_243e-18);

/// The number of values between two reductions of the phase.
const RUN: u64 = 64;

/// sum_i a_i cos(w_i n h + phi_i) plus the measured temperature, at consecutive n.
///
/// At every 64th n the phase is reduced in turns: n w h / (2 pi) is computed in double-double
/// arithmetic and whole turns are subtracted exactly, so its error stays below 1e-15 turns up to n
/// = 2^53. The 64 values from there on follow from the angle-addition theorem, with a table of
/// cos(w_i j h) and sin(w_i j h), j < 64. No value depends on an earlier run of 64, so errors do
/// not accumulate: each value has an error below 1e-14 sum_i |a_i|, and has the same bits for every
/// n from which the caller starts.
#[derive(Clone, Debug)]
pub struct HarmonicClock {
    harmonics: Vec<HarmonicTable>,
    /// The measured temperature, and h.
    series: Option<(Arc<Series>, f64)>,
    /// The constant, and the change of the trend in a step.
    line: Option<[f64; 2]>,
}

/// One harmonic, with its table.
#[derive(Clone, Debug)]
struct HarmonicTable {
    amplitude: f64,
    phase: f64,
    /// w h / (2 pi), high and low part.
    turns: (f64, f64),
    /// (cos, sin) of w j h, j = 0, 1, ...
    ahead: Vec<(f64, f64)>,
}

impl HarmonicClock {
    /// The values of these harmonics for steps of length `h`.
    pub fn new(harmonics: &[Harmonic], h: f64) -> Self {
        let table = |harmonic: &Harmonic| {
            let mut table = HarmonicTable {
                amplitude: harmonic.amplitude,
                phase: harmonic.phase,
                turns: product(two_product(harmonic.angular_frequency, h), TURNS_PER_RADIAN),
                ahead: Vec::new(),
            };
            table.ahead = (0..RUN)
                .map(|j| libm::sincos(table.angle(j)))
                .map(|(s, c)| (c, s))
                .collect();
            table
        };
        HarmonicClock {
            harmonics: harmonics.iter().map(table).collect(),
            series: None,
            line: None,
        }
    }

    /// The values of the line, the harmonics and the series of a temperature, for steps of length
    /// `h`.
    pub fn of(temperature: &Temperature, h: f64) -> Self {
        let series = temperature.series.clone().map(|series| (series, h));
        let line = temperature
            .has_line()
            .then_some([temperature.offset, temperature.trend * h]);
        HarmonicClock {
            series,
            line,
            ..Self::new(&temperature.harmonics, h)
        }
    }

    /// Writes the values at t_n, t_{n+1}, ... into `values`.
    pub fn fill(&self, n: u64, values: &mut [f64]) {
        let (first, rest) = values.split_at_mut(((RUN - n % RUN) as usize).min(values.len()));
        self.fill_run(n, first);
        for (run, values) in (n / RUN + 1..).zip(rest.chunks_mut(RUN as usize)) {
            self.fill_run(run * RUN, values);
        }
    }

    /// Writes values that all lie between two multiples of 64.
    fn fill_run(&self, n: u64, values: &mut [f64]) {
        values.fill(0.0);
        for table in &self.harmonics {
            let (s, c) = libm::sincos(table.angle(n - n % RUN) + table.phase);
            let (s, c) = (table.amplitude * s, table.amplitude * c);
            for (value, (cos, sin)) in values.iter_mut().zip(&table.ahead[(n % RUN) as usize..]) {
                *value += c * cos - s * sin;
            }
        }
        if let Some([offset, change]) = self.line {
            for (n, value) in (n..).zip(values.iter_mut()) {
                *value += change.mul_add(n as f64, offset);
            }
        }
        if let Some((series, h)) = &self.series {
            let mut piece = series.piece(n as f64 * h);
            for (n, value) in (n..).zip(values) {
                let t = n as f64 * h;
                while piece + 2 < series.times().len() && series.times()[piece + 1] <= t {
                    piece += 1;
                }
                *value += series.on(piece, t);
            }
        }
    }
}

impl HarmonicTable {
    /// w n h modulo whole turns, in radians.
    fn angle(&self, n: u64) -> f64 {
        let n = n as f64;
        let (high, low) = two_product(n, self.turns.0);
        TAU * ((high - high.round()) + (low + n * self.turns.1))
    }
}

/// a b = high + low, exactly.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let high = a * b;
    (high, a.mul_add(b, -high))
}

/// The product of two double-doubles.
fn product(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let (high, low) = two_product(a.0, b.0);
    (high, low + (a.0 * b.1 + a.1 * b.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// cos(0.25 * 0.01 * n) for the doubles nearest to 0.25 and 0.01, from 40-digit arithmetic
    /// (mpmath).
    const EXACT: [(u64, f64); 5] = [
        (40, 0.9950041652780258),
        (10040, 0.9994640538508954),
        (1000000, 0.7598251134902195),
        (1000000000, -0.6263685469527481),
        (1125899906842624, 0.12667961654562018),
    ];

    #[test]
    fn the_phase_holds_for_a_billion_steps_and_beyond() {
        let harmonic = Harmonic {
            amplitude: 1.0,
            angular_frequency: 0.25,
            phase: 0.0,
        };
        let clock = HarmonicClock::new(&[harmonic], 0.01);
        for (n, cosine) in EXACT {
            let mut run = [0.0; 64];
            clock.fill(n - 40, &mut run);
            assert!(
                (run[40] - cosine).abs() < 1e-14,
                "{n}: {} {cosine}",
                run[40]
            );
        }
    }

    #[test]
    fn a_value_does_not_depend_on_where_the_caller_starts() {
        let harmonic = Harmonic {
            amplitude: 1.3,
            angular_frequency: 0.7,
            phase: 0.2,
        };
        let clock = HarmonicClock::new(&[harmonic], 0.01);
        let mut all = [0.0; 300];
        clock.fill(1000, &mut all);
        for (from, length) in [(0, 1), (1, 70), (23, 1), (24, 64), (25, 200), (299, 1)] {
            let mut some = vec![0.0; length];
            clock.fill(1000 + from as u64, &mut some);
            assert_eq!(some, all[from..from + length]);
        }
    }

    #[test]
    fn several_harmonics_and_phases_add() {
        let harmonics = [
            Harmonic {
                amplitude: 2.0,
                angular_frequency: 0.0,
                phase: 0.3,
            },
            Harmonic {
                amplitude: -1.5,
                angular_frequency: 3.0,
                phase: -1.0,
            },
        ];
        let mut run = [0.0; 16];
        HarmonicClock::new(&harmonics, 0.125).fill(1000, &mut run);
        for (j, value) in run.iter().enumerate() {
            let t = (1000 + j) as f64 * 0.125;
            let direct = 2.0 * 0.3f64.cos() - 1.5 * (3.0 * t - 1.0).cos();
            assert!((value - direct).abs() < 1e-12, "{t}");
        }
    }

    /// All terms of T add, for samples that are up to 50 times closer than h and up to twice as far
    /// apart.
    #[test]
    fn the_clock_of_a_temperature_is_the_temperature_at_each_step() {
        let h = 0.125;
        let times: Vec<f64> = (0..400)
            .map(|i| 0.0025 * f64::from(i) + 0.25 * f64::from(i / 40))
            .collect();
        let values = times.iter().map(|t| (3.0 * t).sin()).collect();
        let harmonic = |amplitude, angular_frequency, phase| Harmonic {
            amplitude,
            angular_frequency,
            phase,
        };
        let temperature = Temperature {
            offset: 0.5,
            trend: -0.75,
            harmonics: vec![harmonic(2.0, 0.7, 0.3), harmonic(-1.5, 3.0, -1.0)],
            series: Some(Arc::new(Series::new(times, values).expect("a series"))),
            ..Temperature::default()
        };
        for (first, steps) in [(0, 40), (5, 1)] {
            let mut run = vec![0.0; steps];
            HarmonicClock::of(&temperature, h).fill(first, &mut run);
            for (n, value) in (first..).zip(run) {
                let direct = temperature.deterministic(n as f64 * h);
                assert!((value - direct).abs() < 1e-12, "{n}: {value} {direct}");
            }
        }
    }
}
