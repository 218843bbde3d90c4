//! Quantiles of the stick durations, above all their median, with Woodruff's interval: the interval
//! of a share, read back through the distribution.
//!
//! The error of the share F(m) of sticks no longer than the quantile m is turned into one of m (R.
//! S. Woodruff, *Confidence intervals for medians and other position measures*, Journal of the
//! American Statistical Association 47 (1952)). F(m) is a ratio of sums over batches of whole paths
//! ([`Share`]), so sticks of a path may depend on each other in any way.
//!
//! Where the interval of the share leaves (0, 1), the data give no bound of the quantile, and the
//! end of its interval is 0 or infinity.

use super::batches::Share;
use super::interval::{Measured, student};
use super::ordered::Ordered;
use super::steps::{Steps, StepsInBin};

/// The quantile of order p of durations with a continuous law. The ends of its interval are the
/// quantiles of orders p -+ t se(F(m)).
pub(crate) fn continuous(batches: &[Ordered], pooled: &Ordered, p: f64) -> Measured {
    if pooled.count() == 0 {
        return Measured::NOTHING;
    }
    let quantile = pooled.quantile(p);
    let share = Share::of(
        batches
            .iter()
            .map(|batch| (batch.up_to(quantile), batch.count() as f64)),
    );
    let half_width = share.half_width();
    if !half_width.is_finite() {
        return Measured::within(quantile, f64::NAN, f64::NAN, f64::NAN);
    }
    let low = if half_width < p {
        pooled.quantile(p - half_width)
    } else {
        0.0
    };
    let high = if p + half_width < 1.0 {
        pooled.quantile(p + half_width)
    } else {
        f64::INFINITY
    };
    Measured::within(
        quantile,
        (high - low) / (2.0 * student(share.freedom)),
        low,
        high,
    )
}

/// The quantile of order p of durations that are whole numbers of steps, in steps: the smallest m
/// with F(m) >= p.
///
/// Its interval holds every m that the data do not refute. The data refute a lower m by F(m) < p,
/// and a higher m by F(m - 1) >= p, each at the level of 2.5 %. The error of the share is taken at
/// that very m, because where a law has atoms the error may differ from one value to the next.
/// Since m is a whole number, the interval covers the truth in 95 % of all cases or more, and is
/// often a single number.
///
/// The standard error is that of the law when each duration is spread evenly over half a step to
/// either side, because the median of that law moves smoothly. It falls like 1/sqrt(paths), and is
/// below a step where the steps are too long to resolve the median any further.
pub(crate) fn of_steps(batches: &[Steps], steps: &Steps, p: f64) -> Measured {
    if steps.count() == 0 {
        return Measured::NOTHING;
    }
    let share = |number: f64| {
        Share::of(
            batches
                .iter()
                .map(|batch| (batch.up_to(number), batch.count() as f64)),
        )
    };
    let (place, quantile) = steps.at_least(p);
    let at_quantile = share(quantile);
    let half_width = at_quantile.half_width();
    if !half_width.is_finite() {
        return Measured::within(quantile, f64::NAN, f64::NAN, f64::NAN);
    }
    let (below, above) = (steps.spread(p - half_width), steps.spread(p + half_width));
    let error = (above - below) / (2.0 * student(at_quantile.freedom));
    let is_too_low = |cell: &&StepsInBin| {
        let share = share(cell.last);
        share.estimate + share.half_width() < p
    };
    let is_high_enough = |cell: &&StepsInBin| {
        let share = share(cell.last);
        share.estimate - share.half_width() >= p
    };
    let (lower, upper) = (&steps.cells()[..=place], &steps.cells()[place..]);
    let low = lower
        .iter()
        .rev()
        .take_while(|cell| !is_too_low(cell))
        .last()
        .map_or(quantile, |cell| cell.first);
    let high = upper
        .iter()
        .find(is_high_enough)
        .map_or(f64::INFINITY, |cell| cell.last);
    // The data give no bound under the same condition as with a continuous law.
    let (low, high) = (
        if half_width < p { low } else { 0.0 },
        if p + half_width < 1.0 {
            high
        } else {
            f64::INFINITY
        },
    );
    Measured::within(quantile, error, low, high)
}

#[cfg(test)]
mod tests {
    use super::super::ordered::Kept;
    use super::*;

    /// 32 batches of 20 durations of 1 to 40 steps, of which those of half of the batches tend to be
    /// long. The definition, number by number: m is refuted if F(m) is significantly below p, or if
    /// F(m - 1) is significantly above it, by Student's t with 31 degrees of freedom.
    #[test]
    fn an_interval_of_steps_holds_all_that_is_not_refuted() {
        let durations = |batch: u32| {
            let of = move |i: u32| (i * i * 17 + i * batch * 13) % 33 + 1 + 7 * (batch % 2);
            (0..20).map(move |i| f64::from(of(i)))
        };
        let of = |values: Vec<f64>| Steps::of(&Ordered::Kept(Kept::of(values, 0.0, 0)), 1.0);
        let batches: Vec<Steps> = (0..32)
            .map(|batch| of(durations(batch).collect()))
            .collect();
        let pooled = of((0..32).flat_map(durations).collect());
        // The share of durations up to m, and half the width of its interval.
        let share = |m: u32| {
            let below = |batch| durations(batch).filter(|d| *d <= f64::from(m)).count() as f64;
            let share = (0..32).map(below).sum::<f64>() / 640.0;
            let squares: f64 = (0..32).map(|b| (below(b) - 20.0 * share).powi(2)).sum();
            (
                share,
                2.039_513_446 * (32.0 / 31.0 * squares).sqrt() / 640.0,
            )
        };
        for p in [0.25, 0.5, 0.75] {
            let is_possible = |m: &u32| {
                let ((to_m, reach), (to_less, reach_of_less)) = (share(*m), share(m - 1));
                to_m + reach >= p && to_less - reach_of_less < p
            };
            let possible: Vec<u32> = (1..=40).filter(is_possible).collect();
            let [first, last] = [0, possible.len() - 1].map(|i| f64::from(possible[i]));
            let found = of_steps(&batches, &pooled, p).measurement();
            assert_eq!([found.low, found.high], [first, last], "{p}: {possible:?}");
            assert!(last - first >= 3.0, "{p}: {possible:?}");
        }
    }

    /// The standard error is the interval over 2 t, up to a step at each of its ends.
    #[test]
    fn the_error_of_a_quantile_of_steps_fits_its_interval() {
        let durations =
            |batch: u32| (0..20).map(move |i| f64::from((i * 397 + batch * 131) % 1000 + 1));
        let of = |values: Vec<f64>| Steps::of(&Ordered::Kept(Kept::of(values, 0.0, 0)), 1.0);
        let batches: Vec<Steps> = (0..32)
            .map(|batch| of(durations(batch).collect()))
            .collect();
        let pooled = of((0..32).flat_map(durations).collect());
        let found = of_steps(&batches, &pooled, 0.5).measurement();
        let width = 2.0 * 2.039_513_446 * found.standard_error;
        assert!(
            (found.high - found.low - width).abs() <= 2.0 && width > 20.0,
            "{found:?}"
        );
    }
}
