//! The random numbers of one path: its stream, and nothing else.

use crate::noise::{Stream, standard_normal};

/// Uniform and standard normal numbers from the stream of one path.
#[derive(Clone, Debug)]
pub struct Draws(Stream);

impl Draws {
    /// Those of path `path` of the ensemble with this seed.
    pub fn new(seed: u64, path: u64) -> Self {
        Draws(Stream::new(seed, path))
    }

    /// Uniform in (0, 1).
    #[inline(always)]
    pub fn uniform(&mut self) -> f64 {
        self.0.uniform()
    }

    /// Standard normal, one draw of the stream each.
    #[inline(always)]
    pub fn normal(&mut self) -> f64 {
        standard_normal(self.0.next_u64())
    }
}
