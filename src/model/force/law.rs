//! What a force is to a scheme.

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

    /// The same for several registers.
    #[inline(always)]
    fn values<L: Lanes, const R: usize>(&self, x: &[L; R], velocity: &[L; R], time: L) -> [L; R] {
        let mut g = *x;
        for (g, velocity) in g.iter_mut().zip(velocity) {
            *g = self.value(*g, *velocity, time);
        }
        g
    }

    /// Whether g depends on t.
    fn depends_on_time(&self) -> bool {
        true
    }
}
