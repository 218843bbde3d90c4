//! The interface of forces to schemes.

use crate::lanes::Lanes;
use std::fmt::Debug;

/// A force g(x, x', t), for any number of paths at once.
///
/// The bits of g must not depend on the lanes. Operators of lanes have this property; elementary
/// functions have it if they are computed lane by lane in the same way everywhere, as `libm` does.
pub trait ForceLaw: Debug + Send + Sync {
    /// g at displacement `x`, velocity `velocity` and time `time`. Implementations are marked
    /// `#[inline(always)]`, so that they are compiled for the instruction set of the caller.
    fn value<L: Lanes>(&self, x: L, velocity: L, time: L) -> L;

    /// g of many paths at one time. The slices have one length, a multiple of the width of a
    /// register.
    #[inline(always)]
    fn fill<L: Lanes>(&self, x: &[f64], velocity: &[f64], time: L, g: &mut [f64]) {
        for from in (0..x.len()).step_by(L::WIDTH) {
            self.value(L::load(&x[from..]), L::load(&velocity[from..]), time)
                .store(&mut g[from..]);
        }
    }

    /// Whether g depends on t.
    fn depends_on_time(&self) -> bool {
        true
    }

    /// The fastest angular frequency at which g oscillates in t, from 0 to `end`; 0 where it does
    /// not. Longer steps would not resolve it.
    fn fastest_rate(&self, _end: f64) -> f64 {
        0.0
    }

    /// Times from 0 to `end` at which the slope of g in t may jump, or g is large for less than a
    /// step of this length. Steps that are exact or of high order end there.
    fn kinks(&self, _end: f64, _step: f64) -> Vec<f64> {
        Vec::new()
    }
}
