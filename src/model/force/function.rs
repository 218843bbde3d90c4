//! A force that is a function of Rust, evaluated for one path after the other.

use super::{Force, ForceLaw};
use crate::lanes::{Lanes, ROW};
use std::fmt;

/// g(x, x', t) as a function.
struct ClosureForce<G>(G);

impl<G> fmt::Debug for ClosureForce<G> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a function")
    }
}

impl<G: Fn(f64, f64, f64) -> f64 + Send + Sync> ForceLaw for ClosureForce<G> {
    #[inline(always)]
    fn value<L: Lanes>(&self, x: L, velocity: L, time: L) -> L {
        let mut columns = [[0.0; ROW]; 3];
        let lanes = [x, velocity, time];
        lanes
            .into_iter()
            .zip(&mut columns)
            .for_each(|(lanes, column)| lanes.store(column));
        let [x, velocity, time] = columns;
        let g: [f64; ROW] = std::array::from_fn(|i| {
            // Lanes that do not exist hold zeros, where g may not be defined.
            if i < L::WIDTH {
                (self.0)(x[i], velocity[i], time[i])
            } else {
                0.0
            }
        });
        L::load(&g)
    }
}

impl Force {
    /// The force g(x, x', t), for arguments in this order.
    ///
    /// It is called for one path at a time; a [`ForceLaw`] is evaluated for several at once.
    pub fn function(g: impl Fn(f64, f64, f64) -> f64 + Send + Sync + 'static) -> Self {
        Force::new(ClosureForce(g))
    }
}
