//! What is independent of one another in an ensemble: paths, or antithetic pairs of them.
//!
//! Estimates are functions of means over paths either way. Their errors come from how units
//! scatter, and a pair contributes the mean of what its paths do. What is counted without telling
//! which paths it is from (quantiles, standard deviations and static paths of a row, phases that
//! run at the end) is taken to be as uncertain as if both paths of a pair were one and the same,
//! which is the most that two paths may depend on each other.

use std::borrow::Cow;

/// The independent unit of an ensemble.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// A path.
    #[default]
    Path,
    /// Paths 2k and 2k + 1.
    Pair,
}

impl Unit {
    /// How many paths it holds.
    pub fn size(self) -> u64 {
        match self {
            Unit::Path => 1,
            Unit::Pair => 2,
        }
    }

    /// The number of the unit that a path is in.
    #[inline]
    pub fn of(self, path: u64) -> u64 {
        match self {
            Unit::Path => path,
            Unit::Pair => path / 2,
        }
    }

    /// The mean of each unit, from one value a path.
    pub fn means(self, values: &[f64]) -> Cow<'_, [f64]> {
        match self {
            Unit::Path => Cow::Borrowed(values),
            Unit::Pair => values.as_chunks().0.iter().map(|[a, b]| 0.5 * (a + b)).collect(),
        }
    }

    /// Units of which a path, at least one, is what is asked.
    pub fn count<T>(self, paths: &[T], is: impl Fn(&T) -> bool) -> u64 {
        match self {
            Unit::Path => paths.iter().filter(|path| is(path)).count() as u64,
            Unit::Pair => paths.as_chunks().0.iter().filter(|[a, b]| is(a) || is(b)).count() as u64,
        }
    }
}
