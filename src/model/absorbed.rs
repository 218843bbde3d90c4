//! A force that is linear in x and x', and the sum of a line, harmonics and inputs in t: the schemes
//! without a step simulate it as a part of the body and of its temperature, in closed form.

use super::{Drive, Expression, Linear, Oscillator, Problem, Series, Temperature};
use std::sync::Arc;

/// A problem whose force is absorbed.
#[derive(Clone, Debug)]
pub struct Absorbed {
    /// The problem without the force, and with the same motion.
    pub problem: Problem,
    /// What the force adds to the temperature; none where the temperature of the problem does not
    /// drive the body, and the force takes its place.
    pub added: Option<Temperature>,
}

impl Problem {
    /// The problem without its force, if there is one that can be absorbed.
    pub fn absorbed(&self) -> Option<Absorbed> {
        let force = self
            .force
            .as_ref()
            .filter(|force| force.sides().is_none())?;
        let (drive, linear) = force.expression().and_then(Expression::driven)?;
        let oscillator = self.oscillator.with(linear)?;
        let gain = oscillator.force_per_temperature();
        let (is_driven, temperature) = (gain != 0.0, &self.temperature);
        // The noise is pinned at the samples of the temperature, not at those of an input.
        if temperature.is_pinned && drive.series.is_some() {
            return None;
        }
        let added = drive.times(if is_driven { 1.0 / gain } else { 1.0 });
        let (oscillator, temperature) = match is_driven {
            true => (oscillator, temperature.plus(&added)),
            false => {
                let drive = Drive::Force(1.0);
                (
                    Oscillator {
                        drive,
                        ..oscillator
                    },
                    added.clone(),
                )
            }
        };
        let problem = Problem {
            oscillator,
            temperature,
            force: None,
            ..self.clone()
        };
        let added = is_driven.then_some(added);
        Some(Absorbed { problem, added })
    }
}

impl Oscillator {
    /// The body with a linear force; none if the stiffness would be negative.
    pub fn with(self, linear: Linear) -> Option<Oscillator> {
        let stiffness = self.stiffness - linear.displacement;
        // The temperature acts on the spring as written, not on the total stiffness.
        let drive = match linear.displacement {
            0.0 => self.drive,
            _ => Drive::Force(self.force_per_temperature()),
        };
        (stiffness >= 0.0).then_some(Oscillator {
            stiffness,
            damping: self.damping - 0.5 * linear.velocity,
            drive,
            ..self
        })
    }
}

impl Temperature {
    /// The line, the harmonics and the series times a factor.
    fn times(&self, factor: f64) -> Temperature {
        let mut harmonics = self.harmonics.clone();
        harmonics.iter_mut().for_each(|h| h.amplitude *= factor);
        let scaled = |series: &Arc<Series>| Arc::new(Series::sum(&[(factor, series)]));
        Temperature {
            offset: factor * self.offset,
            trend: factor * self.trend,
            harmonics,
            series: self.series.as_ref().map(scaled),
            ..Temperature::default()
        }
    }

    /// The sum of two temperatures.
    fn plus(&self, other: &Temperature) -> Temperature {
        let mut sum = self.clone().with(other.clone());
        if let (Some(one), Some(two)) = (&self.series, &other.series) {
            sum.series = Some(Arc::new(Series::sum(&[(1.0, one), (1.0, two)])));
        }
        sum
    }
}
