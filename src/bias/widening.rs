//! Widening of intervals from few paths.

/// The factor by which a 95 % uncertainty from this many paths is widened. With a few dozen paths
/// the intervals of skewed laws cover the truth in less than 95 % of cases, but the
/// uncertainty is stated for every statistic of every scene (`tests/library/bias_coverage.rs`).
pub(super) fn widening_factor(paths: u64) -> f64 {
    1.0 + 2.5 / (paths as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_paths_widen_the_uncertainty() {
        assert_eq!((widening_factor(25), widening_factor(10_000)), (1.5, 1.025));
    }
}
