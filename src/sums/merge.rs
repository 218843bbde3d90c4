//! Merging of sums of parts into those of the whole.

/// Sums that can be merged.
pub trait Merge {
    /// Add the sums of `other`, whose blocks come after those of `self`.
    fn merge(&mut self, other: &Self);
}

/// A count.
impl Merge for u64 {
    fn merge(&mut self, other: &u64) {
        *self += other;
    }
}

/// Numbers that are added, such as powers.
impl Merge for f64 {
    fn merge(&mut self, other: &f64) {
        *self += other;
    }
}

impl<T: Merge, const N: usize> Merge for [T; N] {
    fn merge(&mut self, other: &Self) {
        self.iter_mut()
            .zip(other)
            .for_each(|(mine, more)| mine.merge(more));
    }
}

/// A list whose length is fixed by the scenario.
impl<T: Merge> Merge for Vec<T> {
    fn merge(&mut self, other: &Self) {
        self.iter_mut()
            .zip(other)
            .for_each(|(mine, more)| mine.merge(more));
    }
}

/// An optional part, depending on the scenario.
impl<T: Merge> Merge for Option<Box<T>> {
    fn merge(&mut self, other: &Self) {
        self.iter_mut()
            .zip(other)
            .for_each(|(mine, more)| mine.merge(more));
    }
}
