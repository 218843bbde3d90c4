//! The mergeable sums.
/// Placeholder.
#[derive(Clone, Debug)]
pub struct Totals;
