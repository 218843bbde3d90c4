//! Coulomb friction with two thresholds, and the proximal map that a discrete step of it solves.

/// f_s and f_d, with 0 <= f_d <= f_s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// f_s: a stick lasts while |b| <= f_s.
    pub static_force: f64,
    /// f_d: |F| while x' != 0.
    pub dynamic_force: f64,
}

/// The soft threshold: the unique V with
///
/// ```text
/// (s - V) (phi - V) + c |V| <= c |phi|     for every velocity phi,
/// ```
///
/// which is V = 0 if |s| <= c and V = s - c sign(s) otherwise. With s = V_n + (h/m) b and c = (h/m) f
/// this is the paper's discrete variational inequality for f_d = f_s = f (its section 3.1.1).
pub fn prox(s: f64, c: f64) -> f64 {
    if s.abs() <= c { 0.0 } else { s - c.copysign(s) }
}
