//! Quantities that follow from a scenario.

use super::amplitude::expected_amplitude;
use super::size::output_bytes;
use crate::model::{Model, Noise};
use crate::scenario::{Period, Scenario};
use crate::scheme::{Discretisation, Resolution, Stability, monitoring_shift};

/// Quantities that follow from a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Derived {
    /// Natural frequency w0 = sqrt(K/m), in radians per unit of time.
    pub natural_frequency: f64,
    /// Frequency of each harmonic relative to the natural frequency, w/w0.
    pub frequency_ratios: Vec<f64>,
    /// Friction ratio f_d/f_s; none if f_s = 0.
    pub friction_ratio: Option<f64>,
    /// K |beta| rho sigma / sqrt(2 theta): the stationary standard deviation of the noise in b, of
    /// two noises together; none without noise.
    pub noise_force: Option<f64>,
    /// f_s / (K |beta| rho), in units of the stationary standard deviation of v: how far the noise
    /// must move to end a centred stick.
    pub corridor_half_width: Option<f64>,
    /// (f_s / (K beta rho sigma))^2: the time that the noise takes to cross that half-width by
    /// diffusion.
    pub corridor_time: Option<f64>,
    /// A of [`Model::runaway_amplitude`], if the damping is negative.
    pub runaway_amplitude: Option<f64>,
    /// Limits of the step, if the scheme has a step.
    pub stability: Option<Stability>,
    /// Shift 0.5826 K |beta| rho sigma sqrt(h) by which the corrected scheme lowers f_s; none for
    /// other schemes.
    pub monitoring_shift: Option<f64>,
    /// What the event-driven scheme does not resolve, where f_s and f_d are equal or nearly so
    /// under noise.
    pub resolution: Option<Resolution>,
    /// The relative tolerance of a scheme without a step.
    pub tolerance: Option<f64>,
    /// A rough upper estimate of the largest |x|: the forced response without friction, a free
    /// oscillation, and the noise.
    pub expected_amplitude: f64,
    /// P, the time between the instants at which x is compared, and where it comes from.
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

impl Derived {
    /// All quantities with their names.
    pub fn quantities(&self) -> [(&'static str, DerivedQuantity); 21] {
        let critical_amplitude = match self.stability {
            Some(
                Stability::Undamped { critical_amplitude }
                | Stability::Growing { critical_amplitude },
            ) => Some(critical_amplitude),
            _ => None,
        };
        [
            (
                "natural_frequency",
                DerivedQuantity::Real(self.natural_frequency),
            ),
            (
                "frequency_ratios",
                DerivedQuantity::Reals(self.frequency_ratios.clone()),
            ),
            ("friction_ratio", self.friction_ratio.into()),
            ("noise_force", self.noise_force.into()),
            ("corridor_half_width", self.corridor_half_width.into()),
            ("corridor_time", self.corridor_time.into()),
            ("runaway_amplitude", self.runaway_amplitude.into()),
            ("critical_amplitude", critical_amplitude.into()),
            (
                "largest_step",
                self.stability.and_then(Stability::largest_step).into(),
            ),
            ("monitoring_shift", self.monitoring_shift.into()),
            ("tolerance", self.tolerance.into()),
            (
                "resolution_static_force",
                self.resolution
                    .map(|resolution| resolution.static_force)
                    .into(),
            ),
            (
                "resolution_shortest_slip",
                self.resolution
                    .map(|resolution| resolution.shortest_slip)
                    .into(),
            ),
            (
                "expected_amplitude",
                DerivedQuantity::Real(self.expected_amplitude),
            ),
            ("period", self.period.map(|period| period.length).into()),
            ("whole_periods", DerivedQuantity::Real(self.whole_periods)),
            (
                "counted_periods",
                DerivedQuantity::Count(self.counted_periods as u64),
            ),
            (
                "steps",
                self.steps
                    .map_or(DerivedQuantity::Unknown, DerivedQuantity::Count),
            ),
            ("path_steps", self.path_steps.into()),
            ("rows", DerivedQuantity::Count(self.rows as u64)),
            ("output_bytes", DerivedQuantity::Real(self.output_bytes)),
        ]
    }
}

impl Scenario {
    /// The quantities that follow from the scenario before it is run.
    pub fn derived(&self) -> Derived {
        let Model {
            oscillator,
            friction,
            temperature,
            ..
        } = &self.model;
        let w0 = oscillator.natural_frequency();
        let force_per_kelvin = oscillator.force_per_temperature().abs();
        // Variances of independent noises add up.
        let both = |of: fn(&Noise) -> f64| {
            let forces = temperature
                .effective_noises()
                .map(|noise| force_per_kelvin * noise.intensity * of(&noise));
            forces.reduce(f64::hypot)
        };
        let noise_force = both(Noise::stationary_sd);
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
            friction_ratio: (friction.static_force > 0.0)
                .then(|| friction.dynamic_force / friction.static_force),
            noise_force,
            corridor_half_width: noise_force
                .filter(|c| *c > 0.0)
                .map(|c| friction.static_force / c),
            corridor_time: diffusive.map(|c| (friction.static_force / c).powi(2)),
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
