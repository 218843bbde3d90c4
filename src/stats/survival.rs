//! The survival curve of stick durations, which takes the censored sticks into account, and its
//! uncertainty.
//!
//! The curve is Kaplan and Meier's (*Nonparametric estimation from incomplete observations*,
//! Journal of the American Statistical Association 53 (1958)). It is the product of 1 - d/n over
//! all durations, where n sticks reached a duration and d of them ended in it. Its textbook error,
//! Greenwood's, assumes that all sticks are independent. The sticks of one path are not. So the
//! error comes from batches of whole paths, by the jackknife over the curves without each batch
//! ([`crate::sums::jackknife`]).

use crate::sums::Ends;
use crate::sums::dyadic::List;
use crate::sums::interval::student;
use crate::sums::jackknife::standard_error;
use crate::sums::range::{NORMAL, wilson};

/// A survival curve, and the curves without each batch of paths.
#[derive(Debug)]
pub(super) struct Survival {
    /// P(D > t) at the upper edge t of each bin of the curve.
    pub curve: Vec<f64>,
    /// Number of sticks, and how many of them reach each of these edges.
    sticks: u64,
    at_risk: Vec<u64>,
    without: Vec<Vec<f64>>,
}

impl Survival {
    /// The curve of the sticks that ended and those that were cut off, in fine bins, for each batch.
    /// `bin_of` gives the bin of the curve in which a fine bin lies, and `bins` is the number of
    /// bins of the curve.
    pub fn new(batches: Vec<[List; 2]>, bin_of: impl Fn(i64) -> usize, bins: usize) -> Self {
        let batches: Vec<[List; 2]> = batches
            .into_iter()
            .filter(|[ended, cut]| !ended.is_empty() || !cut.is_empty())
            .collect();
        let mut keys: Vec<i64> = batches
            .iter()
            .flatten()
            .flatten()
            .map(|bin| bin.0)
            .collect();
        keys.sort_unstable();
        keys.dedup();
        let place = |key: i64| keys.partition_point(|k| *k < key);
        let mut counts = vec![[0_u64; 2]; keys.len()];
        let count = |lists: &[List; 2], counts: &mut [[u64; 2]], sign: fn(&mut u64, u64)| {
            for (which, list) in lists.iter().enumerate() {
                list.iter()
                    .for_each(|&(key, n)| sign(&mut counts[place(key)][which], n));
            }
        };
        batches
            .iter()
            .for_each(|batch| count(batch, &mut counts, |sum, n| *sum += n));
        let curve = |counts: &[[u64; 2]]| kaplan_meier(&keys, counts, &bin_of, bins);
        let (all, at_risk) = curve(&counts).into_iter().unzip();
        let without = batches.iter().map(|batch| {
            let mut rest = counts.clone();
            count(batch, &mut rest, |sum, n| *sum -= n);
            curve(&rest)
                .into_iter()
                .map(|(surviving, _)| surviving)
                .collect()
        });
        Survival {
            curve: all,
            sticks: counts.iter().flatten().sum(),
            at_risk,
            without: without.collect(),
        }
    }

    /// The 95 % intervals of the curve. `random_units` is the number of paths with sticks, if they
    /// are random. Where all batches agree on a share, its interval is Wilson's for that many
    /// paths, or for the number of sticks at risk if that is smaller.
    pub fn ends(&self, random_units: Option<u64>) -> Ends {
        let freedom = self.without.len().saturating_sub(1);
        let Some(paths) = random_units.filter(|_| freedom > 0) else {
            let exact = |&share: &f64| {
                if freedom > 0 {
                    [share; 2]
                } else {
                    [f64::NAN; 2]
                }
            };
            return self.curve.iter().map(exact).collect();
        };
        let few = |sticks: u64| sticks.clamp(1, paths.max(1)) as f64;
        let (mut highest, mut at_risk) = (1.0, self.sticks);
        let point = |(bin, &share): (usize, &f64)| {
            let error = standard_error(
                &self
                    .without
                    .iter()
                    .map(|curve| curve[bin])
                    .collect::<Vec<_>>(),
            );
            let [low, high] = if share == 0.0 {
                // The curve is at most as high as its upper end before, times the upper bound of
                // the share of the sticks left there that may last longer.
                [0.0, highest * wilson(0.0, few(at_risk), NORMAL)[1]]
            } else if error > 0.0 && share < 1.0 {
                wilson(
                    share,
                    share * (1.0 - share) / (error * error),
                    student(freedom as u64),
                )
            } else {
                wilson(share, few(self.at_risk[bin]), NORMAL)
            };
            (highest, at_risk) = (high, self.at_risk[bin]);
            [low, high]
        };
        self.curve.iter().enumerate().map(point).collect()
    }
}

/// The product, and how many sticks are left, at the upper edge of each bin. A stick that is cut
/// off in a fine bin counts as having reached the end of that bin, as is usual for ties.
fn kaplan_meier(
    keys: &[i64],
    counts: &[[u64; 2]],
    bin_of: impl Fn(i64) -> usize,
    bins: usize,
) -> Vec<(f64, u64)> {
    let mut at_risk: u64 = counts.iter().flatten().sum();
    let mut surviving = 1.0;
    let mut fine = keys.iter().zip(counts).peekable();
    let edge = |bin: usize| {
        while let Some((_, [ended, cut])) = fine.next_if(|(key, _)| bin_of(**key) == bin) {
            // The factor is a ratio of integers, so that the curve is exactly zero once the last
            // stick has ended.
            surviving *= if at_risk == 0 {
                1.0
            } else {
                (at_risk - ended) as f64 / at_risk as f64
            };
            at_risk -= ended + cut;
        }
        (surviving, at_risk)
    };
    (0..bins).map(edge).collect()
}
