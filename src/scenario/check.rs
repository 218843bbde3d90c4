//! What follows from a scenario before it is run: derived quantities, and warnings in plain words.
//!
//! Pure functions of the scenario; nothing is simulated.

use super::{MAX_PERIODS, Scenario};
use crate::model::{InitialNoise, Model, Noise, Oscillator};
use std::f64::consts::PI;
use std::fmt;

/// What keeps the explicit step of the discrete variational inequality from growing without bound in slip.
///
/// In slip the scheme multiplies (X, V) by 1 + h lambda along each eigenvector, where lambda solves
/// m lambda^2 + 2 alpha lambda + K = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stability {
    /// alpha = 0: |1 + i h w0| > 1 for every h. The amplitude grows by exp(pi w0 h / 2) per half-cycle while friction
    /// takes 2 f_d / K from it; the two balance at A_c = 4 f_d / (pi w0 h K), above which it grows without bound.
    Undamped {
        /// A_c.
        critical_amplitude: f64,
    },
    /// alpha^2 < K m: |1 + h lambda| < 1 iff h < 2 alpha / K.
    Underdamped {
        /// 2 alpha / K.
        largest_step: f64,
    },
    /// alpha^2 >= K m: |1 + h lambda| < 1 for both lambda iff h < 2 / |lambda_max|.
    Overdamped {
        /// 2 / |lambda_max|, where |lambda_max| = (alpha + sqrt(alpha^2 - K m)) / m.
        largest_step: f64,
    },
}

impl Stability {
    fn new(oscillator: &Oscillator, dynamic_force: f64, h: f64) -> Self {
        let Oscillator { mass: m, stiffness: k, damping: alpha, .. } = *oscillator;
        let w0 = oscillator.natural_frequency();
        // alpha / sqrt(K m), formed without the product K m, which may overflow.
        let ratio = alpha / (m * w0);
        if alpha == 0.0 {
            Stability::Undamped { critical_amplitude: 4.0 * dynamic_force / (PI * w0 * h * k) }
        } else if ratio < 1.0 {
            Stability::Underdamped { largest_step: 2.0 * alpha / k }
        } else {
            Stability::Overdamped { largest_step: 2.0 / (w0 * (ratio + (ratio * ratio - 1.0).sqrt())) }
        }
    }
}

/// Quantities that follow from a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Derived {
    /// w0 = sqrt(K/m).
    pub natural_frequency: f64,
    /// w/w0 of each harmonic.
    pub frequency_ratios: Vec<f64>,
    /// f_d/f_s; none if f_s = 0.
    pub friction_ratio: Option<f64>,
    /// K |beta| rho sigma / sqrt(2 theta): the stationary sd of the noise in b; none without noise.
    pub noise_force: Option<f64>,
    /// f_s / (K |beta| rho) in units of the stationary sd of v: how far the noise must go to end a centred stick.
    pub corridor_half_width: Option<f64>,
    /// (f_s / (K beta rho sigma))^2: the time the noise takes to cross that half-width by diffusion.
    pub corridor_time: Option<f64>,
    /// Limits of the step.
    pub stability: Stability,
    /// A rough upper estimate of the largest |x|: the forced response without friction, the noise, the start.
    pub expected_amplitude: f64,
    /// P, the forcing period.
    pub forcing_period: Option<f64>,
    /// Whole forcing periods up to the end.
    pub whole_periods: f64,
    /// Steps of one path.
    pub steps: u64,
    /// Steps of all paths together.
    pub path_steps: f64,
    /// Rows of the output grid.
    pub rows: usize,
    /// Estimated size of the output file in bytes, uncompressed.
    pub output_bytes: f64,
}

impl Scenario {
    /// What follows from the scenario before it is run.
    pub fn derived(&self) -> Derived {
        let Model { oscillator, friction, temperature, .. } = &self.model;
        let (w0, h) = (oscillator.natural_frequency(), self.time.step);
        let noise = temperature.noise.as_ref();
        let noise_force = noise.map(|noise| force_per_v(oscillator, noise) * noise.stationary_sd());
        let diffusive = noise.map(|noise| force_per_v(oscillator, noise) * noise.diffusion).filter(|c| *c > 0.0);
        let period = temperature.period();
        let steps = self.time.steps();
        Derived {
            natural_frequency: w0,
            frequency_ratios: temperature.harmonics.iter().map(|harmonic| harmonic.angular_frequency / w0).collect(),
            friction_ratio: (friction.static_force > 0.0).then(|| friction.dynamic_force / friction.static_force),
            noise_force,
            corridor_half_width: noise_force.filter(|c| *c > 0.0).map(|c| friction.static_force / c),
            corridor_time: diffusive.map(|c| (friction.static_force / c).powi(2)),
            stability: Stability::new(oscillator, friction.dynamic_force, h),
            expected_amplitude: expected_amplitude(&self.model, self.time.end),
            forcing_period: period,
            whole_periods: period.map_or(0.0, |period| (self.time.end / period * (1.0 + 1e-9)).floor()),
            steps,
            path_steps: self.ensemble.paths as f64 * steps as f64,
            rows: self.timeline().rows(),
            output_bytes: output_bytes(self),
        }
    }

    /// What the user should know before trusting the run, the gravest first.
    pub fn warnings(&self) -> Vec<Warning> {
        let derived = self.derived();
        let h = self.time.step;
        let mut warnings = Vec::new();
        stability_warnings(self, &derived, &mut warnings);
        resolution_warnings(self, &derived, &mut warnings);
        if let Some(time) = derived.corridor_time.filter(|time| *time > 0.0) {
            noise_warnings(self, h, time, &mut warnings);
        }
        question_warnings(self, &derived, &mut warnings);
        if derived.output_bytes > LARGE_OUTPUT {
            warnings.push(Warning::LargeOutput { bytes: derived.output_bytes });
        }
        warnings
    }
}

/// K |beta| rho: the force that one unit of v makes.
fn force_per_v(oscillator: &Oscillator, noise: &Noise) -> f64 {
    oscillator.stiffness * oscillator.dilatation.abs() * noise.intensity
}

/// Standard deviations that v is taken never to exceed: beyond 40, exp(-40^2/2) is below the smallest double.
const FARTHEST_SD: f64 = 40.0;

/// A bound of |b| = |K (beta T - x)| while x has not left x0.
pub(super) fn largest_force(model: &Model) -> f64 {
    force_bound(model, FARTHEST_SD)
}

fn force_bound(model: &Model, sds: f64) -> f64 {
    let temperature = &model.temperature;
    let harmonics: f64 = temperature.harmonics.iter().map(|harmonic| harmonic.amplitude.abs()).sum();
    let noise = temperature.noise.map_or(0.0, |noise| {
        let start = if let InitialNoise::At(v0) = noise.initial { v0.abs() } else { 0.0 };
        noise.intensity * (start + sds * noise.stationary_sd())
    });
    model.oscillator.stiffness
        * (model.oscillator.dilatation.abs() * (harmonics + noise) + model.initial_displacement.abs())
}

/// Standard deviations of the noise counted into an expected amplitude.
const TYPICAL_SD: f64 = 3.0;

fn expected_amplitude(model: &Model, end: f64) -> f64 {
    let Model { oscillator, temperature, .. } = model;
    let w0 = oscillator.natural_frequency();
    // At resonance without damping the amplitude grows by w0/2 per unit of time, so the end of the run bounds it.
    let growth = 1.0 + w0 * end / 2.0;
    let forced: f64 = temperature
        .harmonics
        .iter()
        .map(|harmonic| {
            let r = harmonic.angular_frequency / w0;
            let damping = 2.0 * oscillator.damping * harmonic.angular_frequency / oscillator.stiffness;
            harmonic.amplitude.abs() * (1.0 / (1.0 - r * r).hypot(damping)).min(growth)
        })
        .sum();
    let noise = temperature.noise.map_or(0.0, |noise| noise.intensity * TYPICAL_SD * noise.stationary_sd());
    (oscillator.dilatation.abs() * (forced + noise)).max(model.initial_displacement.abs())
}

/// Bytes of one row of the bands: x, x' and T with mean, sd and five quantiles, P(static), time.
const ROW_BYTES: f64 = 8.0 * (3.0 * 7.0 + 2.0);
/// Bytes of a path's scalars: its number, five doubles, three counts, one flag.
const PATH_BYTES: f64 = 8.0 * 6.0 + 4.0 * 3.0 + 1.0;
/// Bytes of an event: three doubles and two flags.
const EVENT_BYTES: f64 = 8.0 * 3.0 + 2.0;
/// Bytes of one row of a trajectory: three doubles and a flag.
const TRAJECTORY_BYTES: f64 = 8.0 * 3.0 + 1.0;
/// Bytes of a file that holds nothing.
const EMPTY_BYTES: f64 = 65_536.0;
/// Above this, a file deserves a word: one gigabyte.
const LARGE_OUTPUT: f64 = 1e9;

fn output_bytes(scenario: &Scenario) -> f64 {
    let paths = scenario.ensemble.paths as f64;
    let rows = scenario.timeline().rows() as f64;
    // At most about two events (a slip, a stick) per half-cycle of the oscillator.
    let events = 2.0 * scenario.time.end * scenario.model.oscillator.natural_frequency() / PI;
    let events = events.min(scenario.time.steps() as f64) + 1.0;
    let record = &scenario.record;
    EMPTY_BYTES
        + rows * ROW_BYTES
        + if record.paths { paths * PATH_BYTES } else { 0.0 }
        + if record.events { paths * (4.0 + events * EVENT_BYTES) } else { 0.0 }
        + paths.min(record.trajectories as f64) * rows * TRAJECTORY_BYTES
}

/// Something that makes a scenario's results differ from what they seem to be.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// The damped step is beyond its stability limit.
    StepUnstable {
        /// h.
        step: f64,
        /// It must stay below this.
        limit: f64,
    },
    /// Undamped, and the expected amplitude is above the critical one.
    AmplitudeAboveCritical {
        /// Expected largest |x|.
        expected: f64,
        /// A_c.
        critical: f64,
    },
    /// Few steps per half-cycle of the oscillator.
    StepAgainstOscillator {
        /// pi / (w0 h).
        steps_per_half_cycle: f64,
    },
    /// Few steps per period of a harmonic.
    StepAgainstForcing {
        /// w.
        angular_frequency: f64,
        /// 2 pi / (w h).
        steps_per_period: f64,
    },
    /// theta h > 1: the noise forgets itself within a step.
    StepAgainstNoise {
        /// theta h.
        relaxations_per_step: f64,
    },
    /// The noise crosses a good part of the corridor of a stick within a step.
    StepAgainstCorridor {
        /// h.
        step: f64,
        /// (f_s / (K beta rho sigma))^2.
        crossing_time: f64,
    },
    /// f_s = f_d with noise: stick counts and durations are properties of the step.
    EqualFriction,
    /// The stick exit is looked for only every h: an error of order sqrt(h).
    StickExitBias {
        /// Rough relative error of the mean stick duration.
        relative: f64,
    },
    /// The step is longer than the time in which a slip that has just begun may turn back.
    MicroSlips {
        /// h.
        step: f64,
        /// ((f_s - f_d) / (K beta rho sigma))^2.
        return_time: f64,
    },
    /// |b| cannot reach f_s.
    NeverSlips {
        /// A bound of |b|.
        largest_force: f64,
    },
    /// Nothing random: every path is the same.
    IdenticalPaths {
        /// How many.
        paths: u64,
    },
    /// beta = 0: the temperature moves nothing.
    NoDilatation,
    /// Too few forcing periods to estimate a drift.
    FewPeriods {
        /// Whole forcing periods up to the end.
        periods: f64,
    },
    /// Too many forcing periods to keep.
    ManyPeriods {
        /// Whole forcing periods up to the end.
        periods: f64,
    },
    /// A large file.
    LargeOutput {
        /// Estimated size.
        bytes: f64,
    },
}

/// Fewest steps per half-cycle of the oscillator before its discretisation is worth a word.
const FEW_STEPS: f64 = 16.0;

fn stability_warnings(scenario: &Scenario, derived: &Derived, warnings: &mut Vec<Warning>) {
    let step = scenario.time.step;
    match derived.stability {
        Stability::Undamped { critical_amplitude } => {
            // What the scheme makes of the amplitude over the whole run; below 1 % nothing can have grown.
            let growth = derived.natural_frequency.powi(2) * step * scenario.time.end / 2.0;
            if derived.expected_amplitude > critical_amplitude && growth > 0.01 {
                let (expected, critical) = (derived.expected_amplitude, critical_amplitude);
                warnings.push(Warning::AmplitudeAboveCritical { expected, critical });
            }
        }
        Stability::Underdamped { largest_step: limit } | Stability::Overdamped { largest_step: limit } => {
            if step >= limit {
                warnings.push(Warning::StepUnstable { step, limit });
            }
        }
    }
}

fn resolution_warnings(scenario: &Scenario, derived: &Derived, warnings: &mut Vec<Warning>) {
    let h = scenario.time.step;
    let steps_per_half_cycle = PI / (derived.natural_frequency * h);
    if steps_per_half_cycle < FEW_STEPS {
        warnings.push(Warning::StepAgainstOscillator { steps_per_half_cycle });
    }
    for harmonic in &scenario.model.temperature.harmonics {
        let angular_frequency = harmonic.angular_frequency;
        let steps_per_period = 2.0 * PI / (angular_frequency * h);
        if steps_per_period < 2.0 * FEW_STEPS && harmonic.amplitude != 0.0 {
            warnings.push(Warning::StepAgainstForcing { angular_frequency, steps_per_period });
        }
    }
    if let Some(noise) = scenario.model.temperature.noise.filter(|noise| noise.relaxation_rate * h > 1.0) {
        warnings.push(Warning::StepAgainstNoise { relaxations_per_step: noise.relaxation_rate * h });
    }
}

/// -zeta(1/2) / sqrt(2 pi): the mean overshoot of a random walk over a barrier, in standard deviations of a step
/// (Broadie, Glasserman, Kou, Mathematical Finance 7, 1997).
const MEAN_OVERSHOOT: f64 = 0.582_597_157_939_010_7;
/// A mean overshoot above this share of the corridor makes a stick exit meaningless.
const LARGE_OVERSHOOT: f64 = 1.0 / 3.0;
/// Relative error of the mean stick duration over sqrt(h / crossing time), measured between h = 0.001 and 0.02 in the
/// scene with rho = 0.25 and forcing 1/4 (1.7 to 1.9); elsewhere a guide only.
const STICK_BIAS: f64 = 1.8;
/// A bias hint below this is not worth a line.
const SMALL_BIAS: f64 = 0.01;

fn noise_warnings(scenario: &Scenario, h: f64, crossing_time: f64, warnings: &mut Vec<Warning>) {
    let friction = &scenario.model.friction;
    let share = (h / crossing_time).sqrt();
    let overshoots = MEAN_OVERSHOOT * share > LARGE_OVERSHOOT;
    if overshoots {
        warnings.push(Warning::StepAgainstCorridor { step: h, crossing_time });
    }
    if friction.static_force == friction.dynamic_force {
        warnings.push(Warning::EqualFriction);
        return;
    }
    if !overshoots && STICK_BIAS * share > SMALL_BIAS {
        warnings.push(Warning::StickExitBias { relative: STICK_BIAS * share });
    }
    let return_time = crossing_time * (1.0 - friction.dynamic_force / friction.static_force).powi(2);
    if h > return_time {
        warnings.push(Warning::MicroSlips { step: h, return_time });
    }
}

/// Standard deviations that a stationary noise exceeds in no run of practical length.
const NEVER_SD: f64 = 10.0;

/// Warnings about the question that is asked, not about how it is answered.
fn question_warnings(scenario: &Scenario, derived: &Derived, warnings: &mut Vec<Warning>) {
    let Scenario { model, ensemble, time, .. } = scenario;
    let largest = force_bound(model, NEVER_SD);
    if largest <= model.friction.static_force {
        warnings.push(Warning::NeverSlips { largest_force: largest });
    }
    let random = model.temperature.noise.is_some_and(|noise| noise.diffusion > 0.0);
    if !random && ensemble.paths > 1 {
        warnings.push(Warning::IdenticalPaths { paths: ensemble.paths });
    }
    let temperature = &model.temperature;
    if model.oscillator.dilatation == 0.0 && (temperature.noise.is_some() || !temperature.harmonics.is_empty()) {
        warnings.push(Warning::NoDilatation);
    }
    let periods = derived.whole_periods;
    if time.end > 0.0 && derived.forcing_period.is_some() && periods < 2.0 {
        warnings.push(Warning::FewPeriods { periods });
    } else if derived.forcing_period.is_some_and(|period| time.end / period > MAX_PERIODS as f64) {
        warnings.push(Warning::ManyPeriods { periods });
    }
}

impl Warning {
    /// A short name for machines.
    pub fn name(&self) -> &'static str {
        match self {
            Warning::StepUnstable { .. } => "step-unstable",
            Warning::AmplitudeAboveCritical { .. } => "amplitude-above-critical",
            Warning::StepAgainstOscillator { .. } => "step-against-oscillator",
            Warning::StepAgainstForcing { .. } => "step-against-forcing",
            Warning::StepAgainstNoise { .. } => "step-against-noise",
            Warning::StepAgainstCorridor { .. } => "step-against-corridor",
            Warning::EqualFriction => "equal-friction",
            Warning::StickExitBias { .. } => "stick-exit-bias",
            Warning::MicroSlips { .. } => "micro-slips",
            Warning::NeverSlips { .. } => "never-slips",
            Warning::IdenticalPaths { .. } => "identical-paths",
            Warning::NoDilatation => "no-dilatation",
            Warning::FewPeriods { .. } => "few-periods",
            Warning::ManyPeriods { .. } => "many-periods",
            Warning::LargeOutput { .. } => "large-output",
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::StepUnstable { step, limit } => write!(
                f,
                "the step {} is beyond the stability limit {} of this damping: slips will grow until they overflow. \
                 Choose time.step below the limit",
                short(*step),
                short(*limit)
            ),
            Warning::AmplitudeAboveCritical { expected, critical } => write!(
                f,
                "without damping, the explicit step adds more energy than friction takes once the amplitude exceeds \
                 A_c = 4 f_d/(pi w0 h K) = {}, and about {} is to be expected: paths may grow without bound. A_c \
                 doubles when time.step is halved",
                short(*critical),
                short(*expected)
            ),
            Warning::StepAgainstOscillator { steps_per_half_cycle } => write!(
                f,
                "the step leaves only {} steps per half-cycle pi/w0 of the oscillator: slips are poorly resolved",
                short(*steps_per_half_cycle)
            ),
            Warning::StepAgainstForcing { angular_frequency, steps_per_period } => write!(
                f,
                "the step leaves only {} steps per period of the harmonic with angular frequency {}: the forcing is \
                 poorly resolved",
                short(*steps_per_period),
                short(*angular_frequency)
            ),
            Warning::StepAgainstNoise { relaxations_per_step } => write!(
                f,
                "theta h = {}: the noise forgets itself within a step, and what it does in between is not seen",
                short(*relaxations_per_step)
            ),
            Warning::StepAgainstCorridor { step, crossing_time } => write!(
                f,
                "the step {} is large against the time {} that the noise takes to cross the corridor of a stick, \
                 (f_s/(K beta rho sigma))^2: stick counts and durations will be far off",
                short(*step),
                short(*crossing_time)
            ),
            Warning::EqualFriction => write!(
                f,
                "f_s = f_d under noise: there are slips of all sizes down to zero, so the number of sticks grows \
                 without bound as the step falls. Stick counts and durations here are properties of the step, \
                 whatever their error bars; sticking fraction and positions do have limits"
            ),
            Warning::StickExitBias { relative } => write!(
                f,
                "the end of a stick is looked for only once a step, so sticks come out too long: roughly {} % in the \
                 mean, as a guide. The error falls like sqrt(h), and no confidence interval shows it",
                short((relative * 100.0).round().max(1.0))
            ),
            Warning::MicroSlips { step, return_time } => write!(
                f,
                "slips shorter than the step are missed: under this noise one can turn back within \
                 ((f_s - f_d)/(K beta rho sigma))^2 = {}, and the step is {}",
                short(*return_time),
                short(*step)
            ),
            Warning::NeverSlips { largest_force } => write!(
                f,
                "nothing will slip: |b| does not exceed {}, and f_s is no less. Every stick is censored",
                short(*largest_force)
            ),
            Warning::IdenticalPaths { paths } => {
                write!(f, "nothing is random here: all {paths} paths are the same, and ensemble.paths = 1 is enough")
            }
            Warning::NoDilatation => write!(f, "dilatation = 0: the temperature has no effect on the motion"),
            Warning::FewPeriods { periods } => write!(
                f,
                "the run holds {periods} whole forcing periods: drift_velocity and diffusion_coefficient need two, \
                 and will be absent"
            ),
            Warning::ManyPeriods { periods } => write!(
                f,
                "the run holds {periods:e} forcing periods, and x is kept at no more than {MAX_PERIODS}: \
                 drift_velocity and diffusion_coefficient will be absent"
            ),
            Warning::LargeOutput { bytes } => {
                write!(f, "the output file will be about {}; [record] says what is kept", size(*bytes))
            }
        }
    }
}

/// Three significant digits, without an exponent where that reads better.
fn short(x: f64) -> String {
    let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    if rounded != 0.0 && !(1e-4..1e6).contains(&rounded.abs()) { format!("{rounded:e}") } else { format!("{rounded}") }
}

/// Bytes in the largest decimal unit below them.
fn size(bytes: f64) -> String {
    let units = [(1e15, "PB"), (1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    match units.into_iter().find(|(unit, _)| bytes >= *unit) {
        Some((unit, name)) => format!("{} {name}", short(bytes / unit)),
        None => format!("{bytes:.0} B"),
    }
}
