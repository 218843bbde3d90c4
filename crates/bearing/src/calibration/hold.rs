//! Quantities fixed at given values instead of being fitted.

use super::motion::Motion;
use super::quantity::{Held, Quantity, Values, with_derived};
use super::uncertainty::Replicates;

/// The estimates with these quantities fixed; the replicates are changed in the same way.
///
/// The errors of the estimates are correlated, so fixing one quantity also corrects the others.
/// This is the conditional distribution of normal errors, applied to one quantity after the other.
pub fn conditioned(
    estimates: Values,
    replicates: &mut Replicates,
    held: &[Held],
    shear_stiffness: f64,
) -> Values {
    let mut estimates = estimates;
    for (quantity, target) in held {
        let gains = replicates.gains(*quantity);
        let corrected = |values: &Values| {
            let off = target - values[*quantity as usize];
            with_derived(
                &std::array::from_fn(|i| values[i] + gains[i] * off),
                shear_stiffness,
            )
        };
        replicates.change(corrected);
        estimates = corrected(&estimates);
    }
    estimates
}

/// A fixed quantity as a linear equation for (z0, moving, still), for a given motion: the
/// coefficients, and the value of the combination, both in the unit of displacement.
pub fn row((quantity, value): &Held, motion: &Motion, shear_stiffness: f64) -> ([f64; 3], f64) {
    /// The factor of slopes, in kelvin. It is about the range of temperatures, which gives the
    /// equation the unit of displacement.
    const WIDE: f64 = 10.0;
    let kappa = value / shear_stiffness;
    let force = |reach: f64| ([0.0, 0.0, reach], value / shear_stiffness);
    match quantity {
        Quantity::Offset => ([1.0, 0.0, 0.0], *value),
        Quantity::Dilatation => ([0.0, WIDE, WIDE], WIDE * value),
        Quantity::Displacement => ([0.0, motion.start, motion.start], *value),
        Quantity::Static => force(motion.reach),
        Quantity::Dynamic => force(motion.kinetic_reach()),
        Quantity::Gap => force(0.5 * motion.jump),
        Quantity::Stiffness => ([0.0, -WIDE * kappa, WIDE * (1.0 - kappa)], 0.0),
        // Other quantities cannot be fixed.
        _ => ([0.0; 3], 0.0),
    }
}
