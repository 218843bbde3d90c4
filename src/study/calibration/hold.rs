//! Parameters that are given instead of fitted.

use super::motion::Motion;
use super::quantity::{Quantity, Values, with_derived};
use super::uncertainty::Replicates;

/// A quantity, and the value it is to have.
pub type Held = (Quantity, f64);

/// The estimates, and the replicates, when these quantities have these values.
///
/// Errors of estimates go together, as the replicates do; so what is told of one corrects the
/// others. This is the conditional law of normal errors, taken for one quantity after the other.
pub fn conditioned(estimates: Values, replicates: &mut Replicates, held: &[Held], shear_stiffness: f64) -> Values {
    let mut estimates = estimates;
    for (quantity, target) in held {
        let gains = replicates.gains(*quantity);
        let corrected = |values: &Values| {
            let off = target - values[*quantity as usize];
            with_derived(&std::array::from_fn(|i| values[i] + gains[i] * off), shear_stiffness)
        };
        replicates.change(corrected);
        estimates = corrected(&estimates);
    }
    estimates
}

/// What a held quantity says of z0 and the slopes of a sensor, when the motion is this one: a
/// combination of (z0, moving, still), and what it is, both in the unit of displacement.
pub fn row((quantity, value): &Held, motion: &Motion, shear_stiffness: f64) -> ([f64; 3], f64) {
    /// What slopes are multiplied with, in kelvin: as far as temperatures go.
    const WIDE: f64 = 10.0;
    let kappa = value / shear_stiffness;
    let force = |reach: f64| ([0.0, 0.0, reach], value / shear_stiffness);
    match quantity {
        Quantity::Offset => ([1.0, 0.0, 0.0], *value),
        Quantity::Dilatation => ([0.0, WIDE, WIDE], WIDE * value),
        Quantity::Displacement => ([0.0, motion.start, motion.start], *value),
        Quantity::Static => force(motion.reach),
        Quantity::Dynamic => force(motion.reach - 0.5 * motion.jump),
        Quantity::Gap => force(0.5 * motion.jump),
        Quantity::Stiffness => ([0.0, -WIDE * kappa, WIDE * (1.0 - kappa)], 0.0),
        // No other can be held.
        _ => ([0.0; 3], 0.0),
    }
}
