//! Building a scenario without a text.

use super::{Ensemble, Scenario, Statistics, Time};
use crate::model::{Drive, InitialNoise, Problem};
use crate::scheme::{CheckError, EventDriven, Scheme};
use crate::stats::{Record, Units};

/// Number of paths of a scenario that does not give it.
pub(crate) const DEFAULT_PATHS: u64 = 10_000;

/// The default seed is fixed, so that a scenario without a seed is still reproducible.
pub(crate) const DEFAULT_SEED: u64 = 1;

impl Scenario {
    /// A scenario of this model from 0 to t_end, a time: 10 000 paths of the event-driven scheme,
    /// from the seed 1, on an output grid of about 120 rows.
    pub fn new(model: Problem, end: f64) -> Self {
        let scheme = EventDriven::default().into();
        Scenario {
            title: String::new(),
            model,
            bearing: None,
            time: Time::with_default_rows(end, scheme),
            scheme,
            statistics: Statistics::default(),
            ensemble: Ensemble {
                paths: DEFAULT_PATHS,
                seed: DEFAULT_SEED,
                antithetic: false,
            },
            record: Record::default(),
            units: Units::default(),
            #[cfg(feature = "toml")]
            written: super::AsWritten::default(),
        }
    }

    /// Set the end and the scheme. The output grid then has about 120 rows.
    pub(crate) fn set_span(&mut self, end: f64, scheme: Scheme) {
        self.scheme = scheme;
        self.time = Time::with_default_rows(end, scheme);
    }

    /// Check the range of every value, and that the values are consistent.
    pub fn check_all(&self) -> Result<(), CheckError> {
        self.check_ranges()?;
        self.check()
    }

    fn check_ranges(&self) -> Result<(), CheckError> {
        let Problem {
            oscillator,
            temperature,
            ..
        } = &self.model;
        let (drive, factor) = match oscillator.drive {
            Drive::Dilatation(beta) => ("oscillator.dilatation", beta),
            Drive::Force(c) => ("oscillator.force_per_temperature", c),
        };
        let [forward, backward] = self.model.friction_by_direction();
        let parameter = match self.scheme.step() {
            Some(step) => ("time.step", step),
            None => ("scheme.tolerance", self.scheme.tolerance().unwrap_or(1.0)),
        };
        let mut finite = vec![
            ("oscillator.damping", oscillator.damping),
            (drive, factor),
            ("temperature.offset", temperature.offset),
            ("temperature.trend", temperature.trend),
            ("initial.displacement", self.model.initial_displacement),
            ("initial.velocity", self.model.initial_velocity),
        ];
        let mut not_negative = vec![
            ("oscillator.stiffness", oscillator.stiffness),
            ("friction.dynamic", forward.dynamic_force),
            ("friction.dynamic", backward.dynamic_force),
            ("time.end", self.time.end),
            ("statistics.after", self.statistics.after),
        ];
        let mut positive = vec![
            ("oscillator.mass", oscillator.mass),
            ("time.output_step", self.time.output_step),
            parameter,
        ];
        for one in &temperature.harmonics {
            finite.push(("temperature.harmonics.amplitude", one.amplitude));
            finite.push(("temperature.harmonics.phase", one.phase));
            not_negative.push((
                "temperature.harmonics.angular_frequency",
                one.angular_frequency,
            ));
        }
        for noise in &temperature.noises {
            if let InitialNoise::At(v0) = noise.initial {
                finite.push(("temperature.noise.initial", v0));
            }
            not_negative.push(("temperature.noise.intensity", noise.intensity));
            not_negative.push(("temperature.noise.diffusion", noise.diffusion));
            positive.push(("temperature.noise.relaxation_rate", noise.relaxation_rate));
        }
        let is_finite = |x: f64| x.is_finite();
        let is_not_negative = |x: f64| x.is_finite() && x >= 0.0;
        let is_positive = |x: f64| x.is_finite() && x > 0.0;
        out_of(&finite, is_finite, "a finite number")?;
        out_of(&not_negative, is_not_negative, "finite and not negative")?;
        out_of(&positive, is_positive, "finite and positive")?;
        let thresholds = [forward, backward].map(|one| ("friction.static", one.static_force));
        out_of(&thresholds, |f_s| f_s >= 0.0, "not negative")?;
        if self.ensemble.paths == 0 {
            let (problem, remedy) = ("`ensemble.paths` = 0", "simulate at least one path");
            return Err(CheckError::new(&[("ensemble.paths", 0.0)], problem, remedy));
        }
        Ok(())
    }
}

/// The error about the first value that is out of its range.
fn out_of(
    values: &[(&'static str, f64)],
    is_in: impl Fn(f64) -> bool,
    range: &str,
) -> Result<(), CheckError> {
    let found = values.iter().find(|(_, value)| !is_in(*value));
    found.map_or(Ok(()), |one| {
        let problem = format!("must be {range}");
        Err(CheckError::new(&[*one], problem, "change it"))
    })
}
