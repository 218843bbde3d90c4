//! White noise of the temperature, which is simulated as a fast Ornstein-Uhlenbeck process.

use crate::model::{Friction, InitialNoise, Model, Noise};
use crate::scheme::{CheckError, Scheme};

/// White noise sqrt(2 D) xi(t) of the temperature, with xi of unit intensity.
///
/// In its place is simulated v with dv = theta (xi - v) dt, whose memory 1/theta is short against
/// the memory of the body, and which has the same D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WhiteNoise {
    /// D > 0, in the square of the unit of temperature times the unit of time.
    pub strength: f64,
    /// theta, if the scenario gives it.
    pub relaxation_rate: Option<f64>,
}

impl WhiteNoise {
    /// The noise that is simulated: with rho = sqrt(2 D) and sigma = theta, rho v has the strength D
    /// at every theta. A theta that is not given is so large that its memory is the tolerance as a
    /// share of the body's.
    ///
    /// # Errors
    ///
    /// If theta is not given, and the scheme has no tolerance to choose it by.
    pub fn simulated(&self, model: &Model, scheme: Scheme, end: f64) -> Result<Noise, CheckError> {
        let strength = ("temperature.noise.strength", self.strength);
        let memory = self.memory_of_body(model);
        if memory.is_none() && self.relaxation_rate.is_none() {
            let problem = "is white noise, and the time in which the body forgets its velocity is unknown, because \
                           only `force.expression` acts on it";
            let remedy = "write a `relaxation_rate` of the noise that is large against that of the body, e.g. \
                          `relaxation_rate = 1000`";
            return Err(CheckError::new(&[strength], problem, remedy));
        }
        let shortest = memory.unwrap_or(end).min(end);
        let chosen = || {
            scheme
                .tolerance()
                .map(|tolerance| 1.0 / (tolerance * shortest))
        };
        let Some(relaxation_rate) = self.relaxation_rate.or_else(chosen) else {
            let problem = format!(
                "is white noise, which the {} scheme cannot resolve because it has no tolerance",
                scheme.name()
            );
            let remedy = "choose `scheme.kind = \"event-driven\"`, or give the noise a correlation time, e.g. \
                          `relaxation_rate = 100`";
            return Err(CheckError::new(&[strength], problem, remedy));
        };
        Ok(Noise {
            intensity: (2.0 * self.strength).sqrt(),
            relaxation_rate,
            diffusion: relaxation_rate,
            initial: InitialNoise::Stationary,
        })
    }

    /// Under white noise the force on a body at rest passes every threshold at once.
    pub(super) fn check_error(&self, model: &Model) -> Option<CheckError> {
        let rubs = |friction: &Friction| friction.static_force > friction.dynamic_force;
        let of = model.friction_by_direction().into_iter().find(rubs)?;
        let problem = format!(
            "is white noise, which overcomes any static friction at once, so `friction.static` = {:?} above \
             `friction.dynamic` = {:?} would never act",
            of.static_force, of.dynamic_force
        );
        let remedy = "set `static` equal to `dynamic`, or use noise with a correlation time (`intensity`, \
                      `relaxation_rate`, `diffusion`)";
        Some(CheckError::new(
            &[("temperature.noise.strength", self.strength)],
            problem,
            remedy,
        ))
    }

    /// The memory of the noise as a share of the body's, which is how far statistics are from those
    /// under white noise, in order of magnitude; none if that of the body is unknown.
    pub fn share(&self, model: &Model) -> Option<f64> {
        let memory = self
            .memory_of_body(model)
            .filter(|memory| memory.is_finite())?;
        Some(1.0 / (model.temperature.noises.first()?.relaxation_rate * memory))
    }

    /// The shortest time in which the body forgets its velocity: by friction, c^2 D/f_d^2; by the
    /// spring, sqrt(m/K); by damping, m/(2 alpha). A user-defined force is not in it, and the
    /// time is unknown if there is no other.
    fn memory_of_body(&self, model: &Model) -> Option<f64> {
        let oscillator = &model.oscillator;
        let force = oscillator.force_per_temperature();
        let times = [
            force * force * self.strength / model.friction.dynamic_force.powi(2),
            (oscillator.mass / oscillator.stiffness).sqrt(),
            oscillator.mass / (2.0 * oscillator.damping.abs()),
        ];
        let shortest = times.into_iter().fold(f64::INFINITY, f64::min);
        (shortest.is_finite() || model.force.is_none()).then_some(shortest)
    }
}
