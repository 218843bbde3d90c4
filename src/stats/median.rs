//! The median of the stick durations with Woodruff's interval: that of a share, read back through the distribution.
//!
//! The error of the share F(m) of sticks no longer than the median m is turned into one of m (R. S. Woodruff, *Confidence
//! intervals for medians and other position measures*, Journal of the American Statistical Association 47 (1952)). F(m) is
//! a ratio of sums over batches of whole paths ([`Share`]), so sticks of a path may depend on each other as they like.
//!
//! Where the interval of the share leaves (0, 1), the data bound the median by nothing but 0 or infinity.

use super::batches::Share;
use super::interval::{Measured, student};
use super::ordered::Ordered;
use super::steps::{Cell, Steps};

/// The share of durations no longer than this.
fn share(batches: &[Ordered], duration: f64) -> Share {
    Share::of(batches.iter().map(|batch| (batch.up_to(duration), batch.count() as f64)))
}

/// The median of durations of a continuous law: the quantiles at 1/2 -+ t se(F(m)) are the ends of its interval.
pub(super) fn continuous(batches: &[Ordered], pooled: &Ordered) -> Measured {
    if pooled.count() == 0 {
        return Measured::NOTHING;
    }
    let median = pooled.quantile(0.5);
    let share = share(batches, median);
    let reach = share.reach();
    if !reach.is_finite() {
        return Measured::within(median, f64::NAN, f64::NAN, f64::NAN);
    }
    let low = if reach < 0.5 { pooled.quantile(0.5 - reach) } else { 0.0 };
    let high = if reach < 0.5 { pooled.quantile(0.5 + reach) } else { f64::INFINITY };
    Measured::within(median, (high - low) / (2.0 * student(share.freedom)), low, high)
}

/// The median of durations that are whole numbers of steps, in steps: the smallest m with F(m) >= 1/2.
///
/// Its interval holds every m that the data do not refute. They refute one that lies below by F(m) < 1/2, and one that lies
/// above by F(m - 1) >= 1/2, each at the level of 2.5 %, with the error of the share at that very place: a law with atoms
/// may have quite another one next to it. Because m is a whole number the interval covers it in 95 % of all cases or more, and
/// is often a single number.
///
/// The standard error is that of the law spread evenly over half a step to either side, whose median moves smoothly. It falls like
/// 1/sqrt(paths), and is below a step where the steps are too long to tell the median any finer.
pub(super) fn of_steps(batches: &[Ordered], pooled: &Ordered) -> Measured {
    if pooled.count() == 0 {
        return Measured::NOTHING;
    }
    let steps = Steps::of(pooled);
    let (middle, median) = steps.at_least(0.5);
    let at_median = share(batches, median);
    let reach = at_median.reach();
    if !reach.is_finite() {
        return Measured::within(median, f64::NAN, f64::NAN, f64::NAN);
    }
    let (below, above) = (steps.spread(0.5 - reach), steps.spread(0.5 + reach));
    let error = (above - below) / (2.0 * student(at_median.freedom));
    if reach >= 0.5 {
        return Measured::within(median, error, 0.0, f64::INFINITY);
    }
    let is_too_low = |cell: &&Cell| {
        let share = share(batches, cell.last);
        share.estimate + share.reach() < 0.5
    };
    let is_high_enough = |cell: &&Cell| {
        let share = share(batches, cell.last);
        share.estimate - share.reach() >= 0.5
    };
    let (lower, upper) = (&steps.cells()[..=middle], &steps.cells()[middle..]);
    let low = lower.iter().rev().take_while(|cell| !is_too_low(cell)).last().map_or(median, |cell| cell.first);
    let high = upper.iter().find(is_high_enough).map_or(f64::INFINITY, |cell| cell.last);
    Measured::within(median, error, low, high)
}
