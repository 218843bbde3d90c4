//! What one tolerance means for the steps of the noisy scheme.
//!
//! `tolerance` is the relative error that discretisation may leave in the statistics of the
//! cascade. The errors it governs, with the power of each knob that they follow, and where the
//! knobs stand at the default:
//!
//! | knob | what it bounds | error | default |
//! |---|---|---|---|
//! | `slip_length` | relative error of the conditional law between the ends of a slip step, (rate h)^2/100 | h^2 | 1/2 |
//! | `chord_error` | bend of the corridor in a stick step against the noise, second order after its correction | kappa^2 | 0.03 |
//! | `caution` | standard deviations that count as never when a zero of x' is looked for | exp(-caution^2/2) | 4 |
//!
//! The states at the ends of slip steps are exact draws for any tolerance.

use super::scene::Scene;
use std::ops::RangeInclusive;

/// The step rules at one tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRules {
    /// Length of a slip step in units of the fastest rate's inverse.
    pub slip_length: f64,
    /// kappa of the stick steps.
    pub chord_error: f64,
    /// See [`super::first_stop::StopSearch`].
    pub caution: f64,
    /// The shortest slip resolved where f_s and f_d (nearly) meet, in units of 1/w0.
    pub shortest_slip: f64,
}

/// Discretisation error below 0.1 % of the statistics of the paper's noisy scene.
pub const DEFAULT_TOLERANCE: f64 = 1e-3;

/// The tolerances that make a difference.
pub const TOLERANCES: RangeInclusive<f64> = 1e-9..=0.1;

/// What the scheme cannot resolve and therefore replaces, where f_s and f_d (nearly) meet under
/// noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// The static threshold that is simulated instead of f_s.
    pub static_force: f64,
    /// Slips shorter than about this are not resolved.
    pub shortest_slip: f64,
}

impl StepRules {
    /// From a tolerance; values outside of [`TOLERANCES`] are taken as the nearest in it.
    pub fn new(tolerance: f64) -> Self {
        let (least, greatest) = (*TOLERANCES.start(), *TOLERANCES.end());
        let t = if tolerance > 0.0 { tolerance.clamp(least, greatest) } else { least } / DEFAULT_TOLERANCE;
        StepRules {
            slip_length: (0.5 * t.sqrt()).min(1.0),
            chord_error: (0.03 * t.sqrt()).min(0.15),
            // 4 at the default; exp(-caution^2/2) is proportional to the tolerance.
            caution: (16.0 - 2.0 * libm::log(t)).max(4.0).sqrt(),
            shortest_slip: 1e-6 * t,
        }
    }

    /// What f_s is raised by.
    ///
    /// After a stick exit x' grows with acceleration a = (f_s - f_d)/m against noise c t^{1/2}, c =
    /// s/m: slips last about (a/c)^2 or longer. With f_s = f_d there are slips of all sizes down to
    /// zero, infinitely many. The gap is therefore kept at or above s sqrt(shortest slip) - but
    /// never more than a hundredth of f_s, so that huge noise does not create friction.
    pub fn added_gap(&self, scene: &Scene) -> f64 {
        let (f_s, f_d) = (scene.friction.static_force, scene.friction.dynamic_force);
        let time = self.shortest_slip / scene.oscillator.natural_frequency();
        let least = (scene.diffusion * time.sqrt()).min(MOST_GAP * f_s);
        (least - (f_s - f_d)).max(0.0)
    }

    /// The replacement, if there is one.
    pub fn resolution(&self, scene: &Scene) -> Option<Resolution> {
        let added = self.added_gap(scene);
        (added > 0.0).then(|| {
            let static_force = scene.friction.static_force + added;
            let root = (static_force - scene.friction.dynamic_force) / scene.diffusion;
            Resolution { static_force, shortest_slip: root * root }
        })
    }
}

/// The largest share of f_s that a kept gap may be.
const MOST_GAP: f64 = 0.01;
