//! A year of a bearing under random weather.
//!
//! The weather is drawn exactly at the times of a grid. If it is rough, its extreme value in a step
//! is drawn from the law of a Brownian bridge; if steel smooths it, it is linear in a step. The
//! body then slips according to [`Motion`].

use super::draw::{DrawnBearing, DrawnSteel};
use crate::calibration::{Body, Response, farthest};
use crate::weather::{Passage, Square, States, System, dot, root, times};
use stickslip::model::Harmonic;
use stickslip::noise::Stream;

/// The time before a year is counted, in seconds. The body forgets its initial position once the
/// temperature has changed by more than 2 A in both directions, which takes days to weeks.
pub const BURN_IN: f64 = 90.0 * 86_400.0;

/// A year, in seconds.
pub const YEAR: f64 = 365.25 * DAY;

/// A day, in seconds; friction that varies over the year is constant within it.
const DAY: f64 = 86_400.0;

/// A quantity recorded for a simulated year.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForecastQuantity {
    /// The sum of the distances of all slips.
    SlidingPath,
    /// The number of slips.
    Slips,
    /// The highest z minus the lowest.
    Range,
    /// The largest |z|.
    Greatest,
    /// The share of time with |F| above q f_s.
    Loaded,
    /// The largest |F|.
    Force,
}

impl ForecastQuantity {
    /// All of them.
    pub const ALL: [ForecastQuantity; 6] = [
        ForecastQuantity::SlidingPath,
        ForecastQuantity::Slips,
        ForecastQuantity::Range,
        ForecastQuantity::Greatest,
        ForecastQuantity::Loaded,
        ForecastQuantity::Force,
    ];

    /// The name in files and for programs.
    pub fn name(self) -> &'static str {
        NAMES_AND_UNITS[self as usize].0
    }

    /// Whether it may be any number from 0 on; otherwise it is a share of the time.
    pub fn is_unbounded(self) -> bool {
        self != ForecastQuantity::Loaded
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        NAMES_AND_UNITS[self as usize].1
    }
}

/// The name and the unit of each of [`ForecastQuantity::ALL`].
const NAMES_AND_UNITS: [(&str, &str); ForecastQuantity::ALL.len()] = [
    ("sliding_path", "m"),
    ("slips", "1"),
    ("displacement_range", "m"),
    ("displacement_abs_max", "m"),
    ("loaded_share", "1"),
    ("force_abs_max", "N"),
];

/// One value for each of [`ForecastQuantity::ALL`].
pub type Year = [f64; ForecastQuantity::ALL.len()];

/// The longest step of the grid, in seconds.
const LONGEST: f64 = 600.0;

/// The shortest one.
const SHORTEST: f64 = 30.0;

/// A step as a fraction of the shortest correlation time of rough weather, within which it is a
/// Brownian motion to a few percent, or of the time constant of steel, within which its temperature
/// is linear.
const SHARE: f64 = 0.2;

/// The temperature of the steel on a grid that begins one burn-in before t = 0 and ends a year
/// after it.
pub struct SteelOfAYear {
    step: f64,
    /// The periodic part.
    mean: Vec<f64>,
    passage: Passage,
    /// Cholesky factors of the covariances of the states at the start, and gained in a step.
    factors: [Square; 2],
    states: usize,
    seen: States,
    /// The variance that the temperature gains within a step; 0 if it is smooth.
    gain: f64,
}

impl SteelOfAYear {
    /// The steel of this weather.
    pub fn of(drawn: &DrawnSteel) -> Self {
        let DrawnSteel { weather, lag } = drawn;
        let followers = [weather.smoothing, *lag];
        let slow = followers
            .iter()
            .filter(|tau| **tau > 0.0)
            .copied()
            .reduce(f64::min);
        let fast = || {
            weather
                .processes
                .iter()
                .map(|(rate, _)| 1.0 / rate)
                .fold(f64::INFINITY, f64::min)
        };
        let step = (SHARE * slow.unwrap_or_else(fast)).clamp(SHORTEST, LONGEST);
        let rough: f64 = weather
            .processes
            .iter()
            .map(|(rate, variance)| 2.0 * rate * variance)
            .sum();
        let system = System::new(&weather.processes, &followers, 0.0);
        let passage = system.passage(step);
        let times = (0..((BURN_IN + YEAR) / step) as usize).map(|i| i as f64 * step - BURN_IN);
        let waves = |t: f64| -> f64 {
            let wave = |wave: &Harmonic| {
                let behind = wave.angular_frequency * lag;
                let phase = wave.angular_frequency * t + wave.phase - libm::atan(behind);
                wave.amplitude * libm::cos(phase) / behind.hypot(1.0)
            };
            weather.harmonics.iter().map(wave).sum()
        };
        SteelOfAYear {
            step,
            mean: times.map(waves).collect(),
            factors: [system.stationary(), passage.gained].map(|covariance| root(&covariance)),
            passage,
            states: system.states,
            seen: system.seen,
            gain: if slow.is_some() { 0.0 } else { rough * step },
        }
    }
}

/// A simulated year, and the slips in the first part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YearAndRecord {
    pub year: Year,
    /// Number of slips from t = 0 to the end of the record.
    pub within: f64,
}

/// Simulate a year of a bearing. The time with |F| above this `share` of f_s is counted, and so are
/// the slips until `end`.
pub fn year(
    bearing: &DrawnBearing,
    steel: &SteelOfAYear,
    share: f64,
    end: f64,
    random: &mut Stream,
) -> YearAndRecord {
    let Response { motion, sensor } = bearing.response;
    let a_day = libm::ceil(DAY / steel.step) as usize;
    let mut body = Body::new(motion, bearing.scatter);
    let burnt_in = (BURN_IN / steel.step) as usize;
    let ends = ((BURN_IN + end) / steel.step) as usize;
    let mut state = times(&steel.factors[0], &normals(steel.states, random));
    let mut before = steel.mean[0] + dot(&state, &steel.seen);
    body.motion.start = before;
    let [
        mut slips,
        mut within,
        mut sliding,
        mut farthest_off,
        mut loaded,
    ] = [0.0; 5];
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, mean) in steel.mean.iter().enumerate() {
        if i.is_multiple_of(a_day) {
            body.adopt(
                bearing
                    .course
                    .motion(&motion, i as f64 * steel.step - BURN_IN),
            );
        }
        let (carried, gained) = (
            times(&steel.passage.carry, &state),
            times(&steel.factors[1], &normals(steel.states, random)),
        );
        state = std::array::from_fn(|k| carried[k] + gained[k]);
        let temperature = mean + dot(&state, &steel.seen);
        let reached = match steel.gain {
            0.0 => temperature,
            gain => farthest([before, temperature], gain, body.motion.start, random),
        };
        before = temperature;
        let is_counting = i >= burnt_in;
        for temperature in [reached, temperature] {
            let from = body.motion.start;
            let (count, reach) = body.follow(temperature, random);
            if !is_counting {
                continue;
            }
            let xi = body.motion.start;
            slips += count;
            within += if i < ends { count } else { 0.0 };
            sliding += (xi - from).abs();
            let z = sensor.reading(xi, temperature);
            (low, high) = (low.min(z), high.max(z));
            farthest_off = farthest_off.max(reach).max((temperature - xi).abs());
        }
        let is_loaded = (temperature - body.motion.start).abs() > share * body.motion.reach;
        loaded += f64::from(u8::from(is_counting && is_loaded));
    }
    let slope = bearing.stiffness * sensor.dilatation();
    let loaded = loaded / (steel.mean.len() - burnt_in) as f64;
    let greatest = high.abs().max(low.abs());
    YearAndRecord {
        year: [
            sliding * sensor.dilatation(),
            slips,
            high - low,
            greatest,
            loaded,
            slope * farthest_off,
        ],
        within,
    }
}

/// Independent normals for this many states, and zeros for the others.
fn normals(states: usize, random: &mut Stream) -> States {
    std::array::from_fn(|i| if i < states { random.normal() } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{Course, Motion, Sensor};
    use crate::weather::Weather;

    /// The year of a bearing with this A and G, at beta = 1 and kappa = 1/4, under a daily cycle of
    /// 10 K without other weather, for steel of this lag in seconds.
    fn under_a_cycle(reach: f64, jump: f64, lag: f64, share: f64, end: f64) -> YearAndRecord {
        let cycle = Harmonic {
            amplitude: 10.0,
            angular_frequency: std::f64::consts::TAU / 86_400.0,
            phase: 0.0,
        };
        let weather = Weather {
            harmonics: vec![cycle],
            processes: Vec::new(),
            smoothing: 0.0,
        };
        let bearing = DrawnBearing {
            response: Response {
                motion: Motion {
                    reach,
                    jump,
                    start: 0.0,
                },
                sensor: Sensor::sheared(0.0, 1.0, 0.25),
            },
            course: Course::default(),
            scatter: 0.0,
            stiffness: 3.0,
        };
        let steel = SteelOfAYear::of(&DrawnSteel { weather, lag });
        year(&bearing, &steel, share, end, &mut Stream::new(1, 0))
    }

    fn of(year: &YearAndRecord, quantity: ForecastQuantity) -> f64 {
        year.year[quantity as usize]
    }

    /// The body rests at the highest temperature, from which the cycle is farther than 10 K for half
    /// of the time. The sensor moves by kappa beta times the range of 20 K, or for a lag of a day/2 pi
    /// by 1/sqrt(2) of it.
    #[test]
    fn a_body_at_rest_is_loaded_by_the_cycle() {
        let still = under_a_cycle(40.0, 1.0, 0.0, 0.25, 0.0);
        assert!(
            (of(&still, ForecastQuantity::Loaded) - 0.5).abs() < 0.005,
            "{still:?}"
        );
        assert!(
            (of(&still, ForecastQuantity::Range) - 5.0).abs() < 1e-3,
            "{still:?}"
        );
        assert!(
            (of(&still, ForecastQuantity::Force) - 60.0).abs() < 0.01,
            "{still:?}"
        );
        let behind = under_a_cycle(40.0, 1.0, 86_400.0 / std::f64::consts::TAU, 0.25, 0.0);
        let range = of(&behind, ForecastQuantity::Range);
        assert!((range - 5.0 * 0.5_f64.sqrt()).abs() < 1e-3, "{behind:?}");
    }

    /// With A = 4.2 and G = 1 a half cycle of 20 K has 12 slips of 1 K (20 - 2 * 4.2 = 11.6), so that a
    /// day has 24, as has each day of the record.
    #[test]
    fn a_cycle_makes_its_slips_every_day() {
        let found = under_a_cycle(4.2, 1.0, 0.0, 0.9, 10.0 * 86_400.0);
        let slips = of(&found, ForecastQuantity::Slips);
        assert!((slips - 24.0 * 365.25).abs() <= 24.0, "{found:?}");
        assert!((found.within - 240.0).abs() <= 1.0, "{found:?}");
        assert!((of(&found, ForecastQuantity::SlidingPath) / slips - 1.0).abs() < 1e-9);
    }
}
