//! The independent unit of an ensemble: a path, or an antithetic pair of paths.
//!
//! Estimates are functions of means over paths in either case. Their errors come from the scatter
//! of units, where a pair contributes the mean of its two paths. Some numbers are counted without
//! keeping their paths apart: quantiles, standard deviations and static paths of a row, and phases
//! that run at the end. Their uncertainty is computed as if both paths of a pair were equal, the
//! strongest possible dependence.

use std::borrow::Cow;

/// The independent unit of an ensemble.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Replicate {
    /// A path.
    #[default]
    Path,
    /// An antithetic pair: paths 2k and 2k + 1.
    Pair,
}

impl Replicate {
    /// Number of paths in a unit.
    pub fn size(self) -> u64 {
        match self {
            Replicate::Path => 1,
            Replicate::Pair => 2,
        }
    }

    /// The number of the unit that contains a path.
    #[inline]
    pub fn of(self, path: u64) -> u64 {
        match self {
            Replicate::Path => path,
            Replicate::Pair => path / 2,
        }
    }

    /// The mean of each unit, from one value per path.
    pub fn means(self, values: &[f64]) -> Cow<'_, [f64]> {
        match self {
            Replicate::Path => Cow::Borrowed(values),
            Replicate::Pair => values
                .as_chunks()
                .0
                .iter()
                .map(|[a, b]| 0.5 * (a + b))
                .collect(),
        }
    }

    /// One number for each unit: the mean of a number of its paths.
    pub fn column<T>(self, paths: &[T], of: impl Fn(&T) -> f64) -> Vec<f64> {
        self.means(&paths.iter().map(of).collect::<Vec<f64>>())
            .into_owned()
    }

    /// Number of units in which at least one path satisfies `is`.
    pub fn count<T>(self, paths: &[T], is: impl Fn(&T) -> bool) -> u64 {
        match self {
            Replicate::Path => paths.iter().filter(|path| is(path)).count() as u64,
            Replicate::Pair => paths
                .as_chunks()
                .0
                .iter()
                .filter(|[a, b]| is(a) || is(b))
                .count() as u64,
        }
    }
}
