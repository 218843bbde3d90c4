//! The step lengths of the noisy scheme, which all follow from one tolerance.
//!
//! `tolerance` is the relative error that discretisation may leave in the statistics of the
//! cascade. It sets these rules:
//!
//! - `slip_length` bounds the relative error of the conditional law between the ends of a slip
//!   step, (rate h)^2/100. The error is of order h^2; the default rule is 1/2.
//! - `chord_error` bounds kappa, the bend of a threshold in a stick step relative to the noise.
//!   The law of an exit is exact to first order in kappa, so the error is of order kappa^2; the
//!   default rule is 0.08.
//! - `caution` is the number of standard deviations beyond which a zero of x' is taken to be
//!   impossible. The error is of order exp(-caution^2/2); the default rule is 3.
//!
//! - `most_error` bounds what a slip step may leave of the mean of a user-defined force, and
//!   `most_bend` how much noise may bend this force. What the step leaves of it is of order h^2 in
//!   the law; the default rules are 0.001 and 0.06.
//!
//! Without a user-defined force, the states at the ends of slip steps are exact draws for any
//! tolerance.

use super::scene::Scene;
use std::ops::RangeInclusive;

/// The step rules at one tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRules {
    /// Length of a slip step, in units of the inverse of the fastest rate.
    pub slip_length: f64,
    /// kappa, the largest bend of a threshold in a stick step relative to the noise.
    pub chord_error: f64,
    /// Standard deviations beyond which a zero of x' is considered impossible (see
    /// [`super::first_stop::StopSearch`]).
    pub caution: f64,
    /// The shortest slip that is resolved where f_s and f_d are (nearly) equal, in units of 1/w0,
    /// or of 1/theta where there is no spring.
    pub shortest_slip: f64,
    /// What a slip step may leave of the mean of a user-defined force, as a fraction of f_s.
    pub most_error: f64,
    /// How much noise may bend this force on a slip step, as a fraction of the forces.
    pub most_bend: f64,
}

/// The default tolerance. It leaves a discretisation error below 0.1 % in the statistics of the
/// paper's noisy scene.
pub const DEFAULT_TOLERANCE: f64 = 1e-3;

/// The range of tolerances. Values outside of it act like the nearer end of it.
pub const TOLERANCES: RangeInclusive<f64> = 1e-9..=0.1;

/// The replacement of f_s where f_s and f_d are (nearly) equal under noise, because the scheme
/// cannot resolve arbitrarily short slips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// The static threshold that is simulated instead of f_s, a force.
    pub static_force: f64,
    /// Slips shorter than about this time are not resolved.
    pub shortest_slip: f64,
}

impl StepRules {
    /// The rules at a tolerance. Values outside of [`TOLERANCES`] are replaced by the nearest value
    /// in it.
    pub fn new(tolerance: f64) -> Self {
        let (least, greatest) = (*TOLERANCES.start(), *TOLERANCES.end());
        let t = if tolerance > 0.0 {
            tolerance.clamp(least, greatest)
        } else {
            least
        } / DEFAULT_TOLERANCE;
        StepRules {
            slip_length: (0.5 * t.sqrt()).min(1.0),
            chord_error: (0.08 * t.sqrt()).min(0.15),
            // caution is 3 at the default; exp(-caution^2/2) is proportional to the tolerance.
            caution: (9.0 - 2.0 * libm::log(t)).max(4.0).sqrt(),
            shortest_slip: 1e-6 * t,
            most_error: (0.001 * t).min(0.01),
            most_bend: (0.06 * t).min(0.2),
        }
    }

    /// The amount by which f_s is raised.
    ///
    /// After the exit from a stick, x' grows with the acceleration a = (f_s - f_d)/m against noise
    /// c t^{1/2}, where c = s/m, so slips last about (a/c)^2 or longer. With f_s = f_d there are
    /// infinitely many slips, of all lengths down to zero. Therefore f_s - f_d is kept at or above
    /// s sqrt(shortest slip). It is not raised above a hundredth of f_s, so that very strong noise
    /// does not create friction.
    pub fn added_gap(&self, scene: &Scene) -> f64 {
        let (f_s, f_d) = (scene.friction.static_force, scene.friction.dynamic_force);
        let w0 = scene.oscillator.natural_frequency();
        let time = self.shortest_slip / if w0 > 0.0 { w0 } else { scene.relaxation_rate };
        let least = (scene.diffusion * time.sqrt()).min(MOST_GAP * f_s);
        (least - (f_s - f_d)).max(0.0)
    }

    /// The threshold that is simulated and the shortest slip that is resolved; none if f_s is not
    /// raised.
    pub fn resolution(&self, scene: &Scene) -> Option<Resolution> {
        let added = self.added_gap(scene);
        (added > 0.0).then(|| {
            let static_force = scene.friction.static_force + added;
            let root = (static_force - scene.friction.dynamic_force) / scene.diffusion;
            Resolution {
                static_force,
                shortest_slip: root * root,
            }
        })
    }
}

/// The largest difference f_s - f_d that is enforced, as a fraction of f_s.
const MOST_GAP: f64 = 0.01;
