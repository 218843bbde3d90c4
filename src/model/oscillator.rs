//! The oscillator: a mass on a spring whose rest position follows the temperature.

/// m, K, alpha and beta of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator {
    /// m > 0, the mass.
    pub mass: f64,
    /// K > 0, the stiffness of the spring, a force per length.
    pub stiffness: f64,
    /// alpha >= 0, a force per velocity; the damping force is 2 alpha x'.
    pub damping: f64,
    /// beta, a length per temperature; the rest position of the spring is beta T.
    pub dilatation: f64,
}

impl Oscillator {
    /// w0 = sqrt(K/m), the undamped natural angular frequency.
    pub fn natural_frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// K beta, the change of the force on the body at a fixed displacement per unit of temperature.
    pub fn force_per_temperature(&self) -> f64 {
        self.stiffness * self.dilatation
    }

    /// b(x, x', t) = K (beta T - x) - 2 alpha x', the sum of all forces except friction (paper,
    /// equations (engapp) and (shaw)).
    pub fn force(&self, temperature: f64, displacement: f64, velocity: f64) -> f64 {
        // K (beta T - x) instead of K beta T - K x: where the two nearly cancel, their difference
        // is rounded only once.
        self.stiffness * (self.dilatation * temperature - displacement) - 2.0 * self.damping * velocity
    }
}
