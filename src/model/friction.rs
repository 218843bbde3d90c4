//! Coulomb friction with two thresholds, and the proximal map that solves one discrete step of it.

use super::Sign;

/// The two thresholds f_s and f_d, with 0 <= f_d <= f_s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// f_s, a force: a stick lasts while |b| <= f_s.
    pub static_force: f64,
    /// f_d, a force: |F| while x' != 0.
    pub dynamic_force: f64,
}

impl Friction {
    /// The limits of b and of -b in a stick, where they exceed f_s by this.
    #[inline(always)]
    pub fn limits(&self, excess: [f64; 2]) -> [f64; 2] {
        excess.map(|excess| self.static_force + excess)
    }

    /// The threshold used for an infinite one: out of reach, and its fourth power is finite.
    pub const NEVER: f64 = 1e70;

    /// Of friction forwards and backwards, that with the smaller f_s, which is made finite.
    pub fn weaker([forwards, backwards]: [Friction; 2]) -> Friction {
        let weaker = if backwards.static_force < forwards.static_force {
            backwards
        } else {
            forwards
        };
        let static_force = if weaker.static_force.is_finite() {
            weaker.static_force
        } else {
            Friction::NEVER
        };
        Friction {
            static_force,
            ..weaker
        }
    }
}

/// The direction in which a body at rest starts to slip, if the force b exceeds a limit, up or
/// down.
#[inline(always)]
pub fn let_go(b: f64, [up, down]: [f64; 2]) -> Option<Sign> {
    if b > up {
        Some(Sign::Positive)
    } else if -b > down {
        Some(Sign::Negative)
    } else {
        None
    }
}

/// The soft threshold: the unique V with
///
/// ```text
/// (s - V) (phi - V) + c |V| <= c |phi|     for every velocity phi,
/// ```
///
/// which is V = 0 if |s| <= c and V = s - c sign(s) otherwise. With s = V_n + (h/m) b and c = (h/m)
/// f this is the paper's discrete variational inequality for f_d = f_s = f (its section 3.1.1).
pub fn prox(s: f64, c: f64) -> f64 {
    if s.abs() <= c { 0.0 } else { s - c.copysign(s) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Tests the inequality itself, for arbitrary velocities phi, up to the rounding of its
        /// terms.
        #[test]
        fn prox_solves_the_variational_inequality(s in -1e3..1e3f64, c in 0.0..1e3f64, phi in -1e4..1e4f64) {
            let v = prox(s, c);
            let rounding = 1e-12 * (1.0 + s.abs() + c) * (1.0 + phi.abs() + v.abs());
            prop_assert!((s - v) * (phi - v) + c * v.abs() <= c * phi.abs() + rounding);
        }

        /// No other velocity is a solution: with one, the inequality fails for at least one of
        /// three velocities phi.
        #[test]
        fn nothing_else_solves_it(s in -1e3..1e3f64, c in 0.0..1e3f64, off in prop_oneof![-10.0..-1e-3f64, 1e-3..10.0f64]) {
            let v = prox(s, c) + off;
            let holds = |phi: f64| (s - v) * (phi - v) + c * v.abs() <= c * phi.abs() + 1e-9;
            prop_assert!(![prox(s, c), 0.0, 2.0 * v].into_iter().all(holds));
        }

        #[test]
        fn prox_is_odd_nonexpansive_and_zero_within_the_bound(s in -1e3..1e3f64, r in -1e3..1e3f64, c in 0.0..1e3f64) {
            prop_assert_eq!(prox(-s, c), -prox(s, c));
            prop_assert!((prox(s, c) - prox(r, c)).abs() <= (s - r).abs() * (1.0 + 1e-15) + 1e-12);
            prop_assert_eq!(prox(s.clamp(-c, c), c), 0.0);
        }
    }
}
