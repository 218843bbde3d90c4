//! The discrete variational inequality with corrected stick exits. The plain step checks for stick
//! exits only once per step h, which makes sticks too long. The correction makes the error of the
//! statistics of sticks of order 1 instead of order 1/2, at no cost.
//!
//! A stick ends at [`corrected_exit`], f_s minus [`monitoring_shift`], and the body moves with its
//! new velocity, X_{n+1} = X_n + h V_{n+1}.

use super::limits;
use super::simulation::DiscreteSimulation;
use crate::model::{Drive, Friction, Problem};
use crate::scheme::{
    Appearance, CheckError, Discretisation, Method, Parameter, Stability, Timeline,
};
use stickslip_text::numbers::tidy;

/// The corrected discrete variational inequality with this step. It is valid while
/// [`monitoring_shift`] is small compared with f_s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectedVi {
    /// The time step h > 0.
    pub step: f64,
}

impl Method for CorrectedVi {
    const NAME: &'static str = "corrected-vi";
    const MEANING: &'static str = "the discrete variational inequality with corrected stick exits";
    const PARAMETER: Parameter = Parameter::Step;
    const APPEARANCE: Appearance = Appearance {
        colour: "#0072B2",
        dash: "8 3 2 3",
    };
    type Simulation = DiscreteSimulation;

    fn with(step: f64) -> Self {
        CorrectedVi { step }
    }

    fn parameter(self) -> f64 {
        self.step
    }

    fn simulation(self, model: &Problem, timeline: &Timeline) -> DiscreteSimulation {
        DiscreteSimulation::corrected(model, timeline, self.step)
    }

    fn discretisation(self) -> Discretisation {
        Discretisation::CorrectedStep { h: self.step }
    }

    /// During a slip, the multipliers of a step solve mu^2 - (2 - a - c) mu + 1 - a = 0 with a = 2
    /// alpha h/m, c = (h w0)^2. Both lie within the unit circle if and only if 2 a + c < 4. Without
    /// damping they lie on it, and the amplitude neither grows nor decays. With alpha < 0 it grows
    /// like that of the body.
    fn stability(self, model: &Problem) -> Option<Stability> {
        let (w0, gamma) = (
            model.oscillator.natural_frequency(),
            model.oscillator.damping_rate(),
        );
        if gamma < 0.0 {
            return model
                .runaway_amplitude(0.0)
                .map(|critical_amplitude| Stability::Growing { critical_amplitude });
        }
        let rate = gamma + gamma.hypot(w0);
        (rate > 0.0).then(|| Stability::NewVelocity {
            largest_step: 2.0 / rate,
        })
    }

    fn check(self, model: &Problem, end: f64) -> Result<(), CheckError> {
        limits::check_noise(model)?;
        limits::check_step(model, self.step, end)?;
        self.check_shift(model)?;
        limits::check_increments(model, self.step)
    }
}

/// The scheme is refused where its shift is this fraction of f_s or more, because the remaining
/// stick band would have little to do with the given f_s.
const LARGEST_SHIFT: f64 = 0.5;

impl CorrectedVi {
    /// Checks that the shift is small compared with f_s, because the correction of the stick exit
    /// is only the first term of an expansion.
    fn check_shift(self, model: &Problem) -> Result<(), CheckError> {
        let (f_s, shift) = (
            model.friction.static_force,
            monitoring_shift(model, self.step),
        );
        if shift == 0.0 || shift < LARGEST_SHIFT * f_s {
            return Ok(());
        }
        let problem = format!(
            "makes the corrected-vi scheme lower the threshold f_s = `friction.static` = {f_s:?} by half or \
             more: the shift 0.5826 K beta rho sigma sqrt(h) is {:?}",
            tidy(shift)
        );
        let limit = (LARGEST_SHIFT * f_s / monitoring_shift(model, 1.0)).powi(2);
        let remedy = if limit > 0.0 {
            format!(
                "choose `time.step` below {:?}, or `scheme.kind = \"event-driven\"`",
                tidy(limit)
            )
        } else {
            "without friction there is no stick to correct: choose `scheme.kind = \"discrete-vi\"` or `scheme.kind = \"event-driven\"`"
                .into()
        };
        Err(CheckError::new(
            &[("time.step", self.step)],
            problem,
            remedy,
        ))
    }
}

/// -zeta(1/2) / sqrt(2 pi): the mean overshoot of a random walk over a barrier, in standard
/// deviations of one step.
const OVERSHOOT: f64 = 0.582_597_157_939_010_7;

/// The effect of monitoring a barrier only once per step h, as a force: 0.5826 K beta rho sigma
/// sqrt(h). With a threshold that is lower by this shift, the exit time agrees with that of
/// continuous monitoring up to o(sqrt(h)) (Broadie, Glasserman, Kou, Math. Finance 7 (1997); for
/// moving barriers Gobet, Menozzi, Stoch. Proc. Appl. 120 (2010)).
pub fn monitoring_shift(model: &Problem, h: f64) -> f64 {
    let Problem {
        oscillator,
        temperature,
        ..
    } = model;
    let noise = temperature
        .effective_noise()
        .map_or(0.0, |noise| noise.intensity * noise.diffusion);
    // The product is formed from the left, with the constant first. With K beta as one factor it
    // would be rounded differently, which would change the last bit of exits.
    let overshoot = match oscillator.drive {
        Drive::Dilatation(beta) => OVERSHOOT * oscillator.stiffness * beta.abs(),
        Drive::Force(c) => OVERSHOOT * c.abs(),
    };
    overshoot * noise * h.sqrt()
}

/// The force at which the corrected scheme leaves a stick: f_s minus [`monitoring_shift`], but
/// never below f_d. A body released at |b| < f_d would be moved by |b| - f_d, against b, although
/// friction holds it in place. So the part of the shift that exceeds f_s - f_d is not corrected.
pub fn corrected_exit(model: &Problem, h: f64) -> f64 {
    let Friction {
        static_force,
        dynamic_force,
    } = model.friction;
    (static_force - monitoring_shift(model, h)).max(dynamic_force)
}
