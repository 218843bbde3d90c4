//! How large the numbers of a model may become, and what can be computed with.

use super::Model;

/// The largest number that is computed with: squares and products of two such, summed over any run,
/// fit a double.
pub const LARGEST: f64 = 1e100;

/// Whether all of these are at most [`LARGEST`]; what is not a number is not.
pub fn can_be_computed_with(sizes: &[f64]) -> bool {
    sizes.iter().all(|size| *size <= LARGEST)
}

/// Standard deviations that v is taken never to exceed: beyond 40, exp(-40^2/2) is below the
/// smallest double.
const FARTHEST_SD: f64 = 40.0;

impl Model {
    /// A bound of |b| = |K (beta T - x)| while x has not left x0, whatever the noise does.
    pub fn largest_force(&self) -> f64 {
        self.force_bound(FARTHEST_SD)
    }

    /// The same, with the noise kept to so many stationary standard deviations.
    pub fn force_bound(&self, sds: f64) -> f64 {
        // K times a length, as b itself is formed. With K beta as one factor the product would be
        // rounded otherwise.
        self.oscillator.stiffness
            * (self.oscillator.dilatation.abs() * self.temperature.bound(sds) + self.initial_displacement.abs())
    }
}
