//! White noise of the temperature, approximated by a fast Ornstein-Uhlenbeck process.

use crate::model::{Friction, InitialNoise, OrnsteinUhlenbeck, Problem};
use crate::scheme::{CheckError, Scheme};

/// White noise sqrt(2 D) xi(t) of the temperature, with xi of unit intensity.
///
/// It is approximated by v with dv = theta (xi - v) dt, whose correlation time 1/theta is short
/// compared with the velocity relaxation time of the body, and which has the same D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WhiteNoise {
    /// D > 0, in the square of the unit of temperature times the unit of time.
    pub strength: f64,
    /// theta, if the scenario gives it.
    pub relaxation_rate: Option<f64>,
}

impl WhiteNoise {
    /// The noise that is simulated: with rho = sqrt(2 D) and sigma = theta, rho v has the strength
    /// D at every theta. By default, theta is chosen such that the correlation time is the
    /// tolerance times the velocity relaxation time of the body.
    ///
    /// # Errors
    ///
    /// If theta is not given and the scheme has no tolerance to determine it.
    pub fn simulated(
        &self,
        model: &Problem,
        scheme: Scheme,
        end: f64,
    ) -> Result<OrnsteinUhlenbeck, CheckError> {
        let strength = ("temperature.noise.strength", self.strength);
        let memory = self.memory_of_body(model);
        if memory.is_none() && self.relaxation_rate.is_none() {
            let problem = "is white noise, but the velocity relaxation time of the body is \
                           unknown, because only `force.expression` acts on it";
            let remedy = "give the noise a `relaxation_rate` much larger than that of the body, \
                          e.g. `relaxation_rate = 1000`";
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
        Ok(OrnsteinUhlenbeck {
            intensity: (2.0 * self.strength).sqrt(),
            relaxation_rate,
            diffusion: relaxation_rate,
            initial: InitialNoise::Stationary,
        })
    }

    /// Under white noise the force on a body at rest exceeds every threshold immediately.
    pub(super) fn check_error(&self, model: &Problem) -> Option<CheckError> {
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

    /// The correlation time of the noise relative to the velocity relaxation time of the body,
    /// which is the order of magnitude of the relative error of statistics; none if the latter is
    /// unknown.
    pub fn share(&self, model: &Problem) -> Option<f64> {
        let memory = self
            .memory_of_body(model)
            .filter(|memory| memory.is_finite())?;
        Some(1.0 / (model.temperature.noises.first()?.relaxation_rate * memory))
    }

    /// The shortest velocity relaxation time of the body: by friction, c^2 D/f_d^2; by the spring,
    /// sqrt(m/K); by damping, m/(2 alpha). User-defined forces are not included; without any other
    /// force the time is unknown.
    fn memory_of_body(&self, model: &Problem) -> Option<f64> {
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
