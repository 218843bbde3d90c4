//! Quantities that follow from a scenario.

use super::amplitude::expected_amplitude;
use super::size::output_bytes;
use crate::model::{OrnsteinUhlenbeck, Problem};
use crate::scenario::{Period, Scenario};
use crate::scheme::{Discretisation, Resolution, Stability, monitoring_shift};

/// Quantities that follow from a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Derived {
    /// Natural frequency w0 = sqrt(K/m), in radians per unit of time.
    pub natural_frequency: f64,
    /// Frequency of each harmonic relative to the natural frequency, w/w0.
    pub frequency_ratios: Vec<f64>,
    /// Damping ratio alpha/(m w0); none without a spring.
    pub damping_ratio: Option<f64>,
    /// K |beta| times the sum of the amplitudes of the harmonics.
    pub harmonic_force: f64,
    /// Friction ratio f_d/f_s; none if f_s = 0.
    pub friction_ratio: Option<f64>,
    /// K |beta| rho sigma / sqrt(2 theta): the stationary standard deviation of the noise in b, of
    /// two noises together; none without noise.
    pub noise_force: Option<f64>,
    /// f_s / (K |beta| rho), in units of the stationary standard deviation of v: the distance that
    /// the noise must move to end a centred stick.
    pub stick_band_half_width: Option<f64>,
    /// (f_s / (K beta rho sigma))^2: the time in which the noise diffuses over that half-width.
    pub stick_band_time: Option<f64>,
    /// A of [`Problem::runaway_amplitude`], if the damping is negative.
    pub runaway_amplitude: Option<f64>,
    /// Limits of the step, if the scheme has a step.
    pub stability: Option<Stability>,
    /// Shift 0.5826 K |beta| rho sigma sqrt(h) by which the corrected scheme lowers f_s; none for
    /// other schemes.
    pub monitoring_shift: Option<f64>,
    /// The resolution limit of the event-driven scheme if f_s and f_d are (nearly) equal under
    /// noise.
    pub resolution: Option<Resolution>,
    /// The relative tolerance of a scheme without a step.
    pub tolerance: Option<f64>,
    /// A rough upper estimate of the largest |x|: the forced response without friction, a free
    /// oscillation, and the noise.
    pub expected_amplitude: f64,
    /// P, the time between the instants at which x is compared, and its source.
    pub period: Option<Period>,
    /// Whole periods up to the end of the run.
    pub whole_periods: f64,
    /// Whole periods that are counted, from the end of the first one or of the burn-in on.
    pub counted_periods: usize,
    /// Steps of one path, if the scheme has a step.
    pub steps: Option<u64>,
    /// Steps of all paths together, if the scheme has a step.
    pub path_steps: Option<f64>,
    /// Rows of the output grid.
    pub rows: usize,
    /// Estimated size of the output file in bytes, uncompressed.
    pub output_bytes: f64,
}

/// The value of a quantity that follows from a scenario, for lists of such quantities.
#[derive(Clone, Debug, PartialEq)]
pub enum DerivedQuantity {
    /// The quantity does not exist in this scenario.
    Unknown,
    /// A real number.
    Real(f64),
    /// A whole number.
    Count(u64),
    /// Several real numbers.
    Reals(Vec<f64>),
}

impl From<Option<f64>> for DerivedQuantity {
    fn from(number: Option<f64>) -> Self {
        number.map_or(DerivedQuantity::Unknown, DerivedQuantity::Real)
    }
}

/// The name of each quantity for programs, and its meaning for people.
const QUANTITIES: [(&str, &str); 23] = [
    ("natural_frequency", "w0 = sqrt(K/m), natural frequency"),
    ("frequency_ratios", "w/w0, forcing"),
    ("damping_ratio", "alpha/(m w0), damping ratio"),
    ("harmonic_force", "K beta sum |a|, force of the harmonics"),
    ("friction_ratio", "f_d/f_s, friction ratio"),
    ("noise_force", "K beta rho sigma/sqrt(2 theta), noise in b"),
    (
        "stick_band_half_width",
        "f_s/(K beta rho), half stick band in v",
    ),
    (
        "stick_band_time",
        "(f_s/(K beta rho sigma))^2, time to cross it",
    ),
    (
        "runaway_amplitude",
        "amplitude beyond which the motion grows",
    ),
    ("critical_amplitude", "A_c, critical amplitude of the step"),
    ("largest_step", "stability limit of the step"),
    (
        "monitoring_shift",
        "0.5826 K beta rho sigma sqrt(h), shift of f_s",
    ),
    ("tolerance", "tolerance, relative"),
    ("resolution_static_force", "resolution: f_s as simulated"),
    (
        "resolution_shortest_slip",
        "resolution: shortest slip resolved, about",
    ),
    ("expected_amplitude", "largest |x| expected, roughly"),
    ("period", "P, period at which displacements are compared"),
    ("whole_periods", "whole periods P"),
    ("counted_periods", "whole periods P that are counted"),
    ("steps", "steps of a path"),
    ("path_steps", "path-steps in all"),
    ("rows", "rows of the output grid"),
    ("output_bytes", "output file, about"),
];

impl Derived {
    /// All quantities, each with its name for programs and its meaning for people.
    pub fn quantities(
        &self,
    ) -> impl Iterator<Item = (&'static str, &'static str, DerivedQuantity)> + use<> {
        use DerivedQuantity::{Count, Real, Reals, Unknown};
        let resolution = |of: fn(Resolution) -> f64| self.resolution.map(of).into();
        let critical_amplitude = match self.stability {
            Some(
                Stability::Undamped { critical_amplitude }
                | Stability::Growing { critical_amplitude },
            ) => Some(critical_amplitude),
            _ => None,
        };
        let values = [
            Real(self.natural_frequency),
            Reals(self.frequency_ratios.clone()),
            self.damping_ratio.into(),
            Real(self.harmonic_force),
            self.friction_ratio.into(),
            self.noise_force.into(),
            self.stick_band_half_width.into(),
            self.stick_band_time.into(),
            self.runaway_amplitude.into(),
            critical_amplitude.into(),
            self.stability.and_then(Stability::largest_step).into(),
            self.monitoring_shift.into(),
            self.tolerance.into(),
            resolution(|resolution| resolution.static_force),
            resolution(|resolution| resolution.shortest_slip),
            Some(self.expected_amplitude).filter(|x| !x.is_nan()).into(),
            self.period.map(|period| period.length).into(),
            Real(self.whole_periods),
            Count(self.counted_periods as u64),
            self.steps.map_or(Unknown, Count),
            self.path_steps.into(),
            Count(self.rows as u64),
            Real(self.output_bytes),
        ];
        let named = QUANTITIES.into_iter().zip(values);
        named.map(|((name, meaning), value)| (name, meaning, value))
    }
}

impl Scenario {
    /// The quantities that follow from the scenario before it is run.
    pub fn derived(&self) -> Derived {
        let Problem {
            oscillator,
            friction,
            temperature,
            ..
        } = &self.model;
        let w0 = oscillator.natural_frequency();
        let force_per_kelvin = oscillator.force_per_temperature().abs();
        // Variances of independent noises add up.
        let both = |of: fn(&OrnsteinUhlenbeck) -> f64| {
            let forces = temperature
                .effective_noises()
                .map(|noise| force_per_kelvin * noise.intensity * of(&noise));
            forces.reduce(f64::hypot)
        };
        let noise_force = both(OrnsteinUhlenbeck::stationary_sd);
        let diffusive = both(|noise| noise.diffusion).filter(|c| *c > 0.0);
        let period = self.period();
        let steps = self.steps();
        Derived {
            natural_frequency: w0,
            frequency_ratios: temperature
                .harmonics
                .iter()
                .map(|harmonic| harmonic.angular_frequency / w0)
                .collect(),
            damping_ratio: (oscillator.stiffness > 0.0)
                .then(|| oscillator.damping / (oscillator.mass * w0)),
            harmonic_force: force_per_kelvin
                * temperature
                    .harmonics
                    .iter()
                    .fold(0.0, |sum, harmonic| sum + harmonic.amplitude.abs()),
            friction_ratio: (friction.static_force > 0.0)
                .then(|| friction.dynamic_force / friction.static_force),
            noise_force,
            stick_band_half_width: noise_force
                .filter(|c| *c > 0.0)
                .map(|c| friction.static_force / c),
            stick_band_time: diffusive.map(|c| (friction.static_force / c).powi(2)),
            runaway_amplitude: self.model.runaway_amplitude(0.0),
            stability: self.scheme.stability(&self.model),
            monitoring_shift: match self.scheme.discretisation() {
                Discretisation::CorrectedStep { h } => Some(monitoring_shift(&self.model, h)),
                Discretisation::Step { .. }
                | Discretisation::Tolerance { .. }
                | Discretisation::Approximation => None,
            },
            resolution: self.resolution(),
            tolerance: self.scheme.tolerance(),
            expected_amplitude: expected_amplitude(&self.model, self.time.end, self.scheme.step()),
            period,
            whole_periods: period.map_or(0.0, |period| {
                (self.time.end / period.length * (1.0 + 1e-9)).floor()
            }),
            counted_periods: self.timeline().counted_periods(),
            steps,
            path_steps: steps.map(|steps| self.ensemble.paths as f64 * steps as f64),
            rows: self.timeline().rows(),
            output_bytes: output_bytes(self),
        }
    }
}
