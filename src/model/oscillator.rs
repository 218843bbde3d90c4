//! The oscillator: a mass, with or without a spring, driven by the temperature.

/// m, K, alpha of the model, and how the temperature drives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator {
    /// m > 0, the mass.
    pub mass: f64,
    /// K >= 0, the stiffness of the spring, a force per length. With K = 0 there is no spring.
    pub stiffness: f64,
    /// alpha, a force per velocity; the damping force is 2 alpha x'. With alpha < 0 the body is
    /// driven by its own velocity.
    pub damping: f64,
    /// How the temperature drives the body.
    pub drive: Drive,
}

/// How the temperature drives the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// beta, a length per temperature: the rest position of the spring is beta T.
    Dilatation(f64),
    /// c, a force per temperature: c T acts on the body, with a spring or without one.
    Force(f64),
}

impl Oscillator {
    /// w0 = sqrt(K/m), the undamped natural angular frequency.
    pub fn natural_frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// gamma = alpha/m, the rate at which damping reduces the amplitude.
    pub fn damping_rate(&self) -> f64 {
        self.damping / self.mass
    }

    /// c = K beta, the change of the force on the body at a fixed displacement per unit of
    /// temperature.
    pub fn force_per_temperature(&self) -> f64 {
        match self.drive {
            Drive::Dilatation(beta) => self.stiffness * beta,
            Drive::Force(c) => c,
        }
    }

    /// The displacement at which spring and temperature balance: beta T, or c T/K. Without a spring
    /// it is infinite or undefined.
    pub fn rest_position(&self, temperature: f64) -> f64 {
        match self.drive {
            Drive::Dilatation(beta) => beta * temperature,
            Drive::Force(c) => c * temperature / self.stiffness,
        }
    }

    /// b(x, x', t) = K (beta T - x) - 2 alpha x', the sum of all forces except friction (paper,
    /// equations (engapp) and (shaw)).
    pub fn force(&self, temperature: f64, displacement: f64, velocity: f64) -> f64 {
        self.force_at_rest(temperature, displacement) - 2.0 * self.damping * velocity
    }

    /// b(x, 0, t).
    pub fn force_at_rest(&self, temperature: f64, displacement: f64) -> f64 {
        match self.drive {
            // K (beta T - x) instead of K beta T - K x: where the two nearly cancel, their
            // difference is rounded only once.
            Drive::Dilatation(beta) => self.stiffness * (beta * temperature - displacement),
            Drive::Force(c) => c * temperature - self.stiffness * displacement,
        }
    }

    /// A bound of |b(x, 0, t)|, from bounds of |T| and |x|.
    pub fn force_bound(&self, temperature: f64, displacement: f64) -> f64 {
        match self.drive {
            // The stiffness is multiplied by a length, as in the computation of b. With K beta as
            // one factor the product would be rounded differently.
            Drive::Dilatation(beta) => self.stiffness * (beta.abs() * temperature + displacement),
            Drive::Force(c) => c.abs() * temperature + self.stiffness * displacement,
        }
    }
}
