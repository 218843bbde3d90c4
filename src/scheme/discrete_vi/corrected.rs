//! The same step with its stick exits corrected. A stick exit is looked for only every h, which
//! makes sticks too long; the correction makes the statistics of sticks of order 1 instead of 1/2,
//! at no cost.
//!
//! A stick ends at [`corrected_exit`], f_s less [`monitoring_shift`], and the body moves with its
//! new velocity, X_{n+1} = X_n + h V_{n+1}.

use super::limits;
use super::simulation::DiscreteSimulation;
use crate::model::{Friction, Model};
use crate::numbers::tidy;
use crate::scheme::{Discretisation, Look, Method, Misfit, Parameter, Stability, Timeline};

/// The corrected discrete variational inequality with this step; sound while [`monitoring_shift`]
/// is small against f_s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectedVi {
    /// h > 0.
    pub step: f64,
}

impl Method for CorrectedVi {
    const NAME: &'static str = "corrected-vi";
    const MEANING: &'static str = "the discrete variational inequality with corrected stick exits";
    const PARAMETER: Parameter = Parameter::Step;
    const LOOK: Look = Look { colour: "#0072B2", dash: "8 3 2 3" };
    type Simulation = DiscreteSimulation;

    fn with(step: f64) -> Self {
        CorrectedVi { step }
    }

    fn parameter(self) -> f64 {
        self.step
    }

    fn simulation(self, model: &Model, timeline: &Timeline) -> DiscreteSimulation {
        DiscreteSimulation::corrected(model, timeline, self.step)
    }

    fn discretisation(self) -> Discretisation {
        Discretisation::CorrectedStep { h: self.step }
    }

    /// The multipliers of a step in slip solve mu^2 - (2 - a - c) mu + 1 - a = 0 with a = 2 alpha
    /// h/m, c = (h w0)^2; both lie within the unit circle iff 2 a + c < 4 (on it without damping:
    /// the amplitude neither grows nor decays).
    fn stability(self, model: &Model) -> Option<Stability> {
        let w0 = model.oscillator.natural_frequency();
        let ratio = model.oscillator.damping / (model.oscillator.mass * w0);
        Some(Stability::NewVelocity { largest_step: 2.0 / (w0 * (ratio + ratio.hypot(1.0))) })
    }

    fn check(self, model: &Model, _end: f64) -> Result<(), Misfit> {
        limits::check_noise(model)?;
        limits::check_step(model, self.step)?;
        self.check_shift(model)?;
        limits::check_increments(model, self.step)
    }
}

/// The scheme is refused where its shift is this share of f_s or more, because the corridor that is
/// left has little to do with the one that was asked for.
const LARGEST_SHIFT: f64 = 0.5;

impl CorrectedVi {
    /// The correction of the stick exit is the first term of an expansion: it must be small against
    /// f_s.
    fn check_shift(self, model: &Model) -> Result<(), Misfit> {
        let (f_s, shift) = (model.friction.static_force, monitoring_shift(model, self.step));
        if shift == 0.0 || shift < LARGEST_SHIFT * f_s {
            return Ok(());
        }
        let problem = format!(
            "makes the corrected-vi scheme lower the threshold f_s = `friction.static` = {f_s:?} by its shift 0.5826 K \
             beta rho sigma sqrt(h) = {:?}, half of it or more",
            tidy(shift)
        );
        let limit = (LARGEST_SHIFT * f_s / monitoring_shift(model, 1.0)).powi(2);
        let remedy = if limit > 0.0 {
            format!("choose `time.step` below {:?}, or `--scheme event-driven`", tidy(limit))
        } else {
            "without friction there is no stick to correct: choose `--scheme discrete-vi` or `--scheme event-driven`"
                .into()
        };
        Err(Misfit::new(&[("time.step", self.step)], problem, remedy))
    }
}

/// -zeta(1/2) / sqrt(2 pi): by how many standard deviations of a step a random walk overshoots a
/// barrier, in the mean.
const OVERSHOOT: f64 = 0.582_597_157_939_010_7;

/// What looking at a barrier only every h amounts to, as a force: 0.5826 K beta rho sigma sqrt(h).
/// Lowering the threshold by it gives the exit time of continuous monitoring up to o(sqrt(h))
/// (Broadie, Glasserman, Kou, Math. Finance 7 (1997); for moving barriers Gobet, Menozzi, Stoch.
/// Proc. Appl. 120 (2010)).
pub fn monitoring_shift(model: &Model, h: f64) -> f64 {
    let Model { oscillator, temperature, .. } = model;
    let noise = temperature.effective_noise().map_or(0.0, |noise| noise.intensity * noise.diffusion);
    // The product is formed from the left, constant first. With K beta as one factor it would be
    // rounded otherwise, which would move exits by a last bit.
    OVERSHOOT * oscillator.stiffness * oscillator.dilatation.abs() * noise * h.sqrt()
}

/// The force at which the corrected scheme leaves a stick: f_s less [`monitoring_shift`], and never
/// below f_d. A body let go at |b| < f_d would be driven by |b| - f_d, against b, where friction
/// holds it; so what f_s - f_d has no room for is not corrected.
pub fn corrected_exit(model: &Model, h: f64) -> f64 {
    let Friction { static_force, dynamic_force } = model.friction;
    (static_force - monitoring_shift(model, h)).max(dynamic_force)
}
