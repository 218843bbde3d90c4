//! The largest numbers that a model may contain or lead to.

use super::Model;

/// The largest number that can be computed with: squares and products of two such numbers, summed
/// over any run, fit in a double.
pub const LARGEST: f64 = 1e100;

/// Whether all of these are at most [`LARGEST`]. A NaN is not.
pub fn can_be_computed_with(sizes: &[f64]) -> bool {
    sizes.iter().all(|size| *size <= LARGEST)
}

/// The number of standard deviations that v is taken never to exceed: beyond 40, exp(-40^2/2) is
/// below the smallest double.
const FARTHEST_SD: f64 = 40.0;

impl Model {
    /// A bound of |b| = |K (beta T - x)| while x = x0, for practically every realisation of the
    /// noise.
    pub fn largest_force(&self) -> f64 {
        self.force_bound(FARTHEST_SD)
    }

    /// A bound of |b| while x = x0, where each noise is bounded by `sds` stationary standard
    /// deviations.
    pub fn force_bound(&self, sds: f64) -> f64 {
        // The stiffness is multiplied by a length, as in the computation of b. With K beta as one
        // factor the product would be rounded differently.
        self.oscillator.stiffness
            * (self.oscillator.dilatation.abs() * self.temperature.bound(sds) + self.initial_displacement.abs())
    }
}
