//! The delete-a-group jackknife: the error of a number from its values without one group of paths
//! after another.
//!
//! If a number g is computed from all paths, and g_i from all but those of group i, then for G
//! groups
//!
//! ```text
//! standard error^2 = (G - 1)/G sum_i (g_i - mean g_i)^2
//! ```
//!
//! whatever g is: a ratio, a median, a slope, or a function of several of them. (B. Efron, *The
//! Jackknife, the Bootstrap and Other Resampling Plans*, SIAM (1982), chapter 3; J. Shao and D. Tu,
//! *The Jackknife and Bootstrap*, Springer (1995), section 2.3.)

use super::merge::Merge;

/// The standard error of a number, from its values g_i without group i; zero if there is one group
/// only.
pub(crate) fn standard_error(without: &[f64]) -> f64 {
    if without.len() < 2 {
        return 0.0;
    }
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let spread: f64 = without.iter().map(|g| (g - mean) * (g - mean)).sum();
    ((n - 1.0) / n * spread).sqrt()
}

/// The value of `of` for all groups together, merged from the last to the first, and for all groups
/// but each of them in turn. `empty` is a group of no paths.
pub(crate) fn leaving_one_out<S: Merge + Clone, T>(
    empty: &S,
    groups: &[S],
    of: impl Fn(&S) -> T,
) -> (T, Vec<T>) {
    // after[i] is the sum of the last i groups.
    let mut after = vec![empty.clone()];
    for group in groups.iter().rev() {
        let mut sum = group.clone();
        sum.merge(&after[after.len() - 1]);
        after.push(sum);
    }
    let all = of(&after[groups.len()]);
    let mut before = empty.clone();
    let without = groups
        .iter()
        .zip(after.iter().rev().skip(1))
        .map(|(group, after)| {
            let mut rest = before.clone();
            rest.merge(after);
            before.merge(group);
            of(&rest)
        });
    (all, without.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jackknife_of_a_mean_is_its_textbook_error() {
        let x = [3.0, 1.0, 4.0, 1.0, 5.0];
        let (sum, n) = (x.iter().sum::<f64>(), x.len() as f64);
        let without: Vec<f64> = x.iter().map(|x| (sum - x) / (n - 1.0)).collect();
        // s^2 = (0.04 + 3.24 + 1.44 + 3.24 + 4.84)/4 = 3.2.
        assert!((standard_error(&without) - (3.2f64 / n).sqrt()).abs() < 1e-12);
        assert_eq!(standard_error(&[7.0]), 0.0);
    }
}
