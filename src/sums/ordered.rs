//! Values in order: their ranks, quantiles and shares, exact or from bins.

use super::bins::{Bins, Shape};
use super::dyadic::{Ruler, width};
use super::interval::ErrorLaw;
use super::spread::Tails;

/// Number of halvings of the range of values. They reach the last digit of any value except the
/// smallest.
const BISECTIONS: usize = 64;

/// The values that a sketch holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ordered {
    /// One by one.
    Kept(Kept),
    /// In bins.
    Binned(Binned),
}

/// Values that are kept one by one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kept {
    /// A value that many paths may share.
    centre: f64,
    /// Number of values at the centre.
    at_centre: u64,
    /// Number of values below the centre.
    below: usize,
    /// The values that are not at the centre, in ascending order.
    values: Vec<f64>,
}

/// Values that are counted in bins.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Binned {
    pub shape: Shape,
    /// The width of a bin is 2^level, on the scale if there is one.
    pub level: i32,
    pub smallest: f64,
    pub largest: f64,
    /// The occupied bins in ascending order, each with the number of values in it and in lower
    /// bins.
    pub up_to: Vec<(i64, u64)>,
}

impl Ordered {
    /// Number of values.
    pub fn count(&self) -> u64 {
        match self {
            Ordered::Kept(kept) => kept.values.len() as u64 + kept.at_centre,
            Ordered::Binned(binned) => binned.count(),
        }
    }

    /// The quantile of order p, 0 <= p <= 1, interpolated between the order statistics on either
    /// side of rank p (n - 1); NaN if there are no values. This is definition 7 of R. J. Hyndman
    /// and Y. Fan, *Sample quantiles in statistical packages*, The American Statistician 50 (1996).
    pub fn quantile(&self, p: f64) -> f64 {
        let n = self.count();
        if n == 0 {
            return f64::NAN;
        }
        let rank = p * (n - 1) as f64;
        let [below, above] = ranks(rank).map(|rank| self.of_rank(rank));
        below + (above - below) * rank.fract()
    }

    /// The median of these values without those in `some`; NaN if no values are left.
    pub fn median_without(&self, some: &Ordered) -> f64 {
        let left = self.count().saturating_sub(some.count());
        if left == 0 {
            return f64::NAN;
        }
        match (self, some) {
            (Ordered::Kept(all), Ordered::Kept(some)) => {
                let mut some = some.ascending().peekable();
                let others: Vec<f64> = all
                    .ascending()
                    .filter(|value| some.next_if(|gone| gone == value).is_none())
                    .collect();
                let [below, above] =
                    ranks(0.5 * (left - 1) as f64).map(|rank| others[rank as usize]);
                below + (above - below) * 0.5
            }
            // With this many values, the median is taken as the place where the distribution
            // function of the others, which is linear within bins, is one half.
            _ => {
                let (mut low, mut high) = (self.of_rank(0), self.of_rank(self.count() - 1));
                for _ in 0..BISECTIONS {
                    let middle = low + (high - low) / 2.0;
                    let is_below = self.up_to(middle) - some.up_to(middle) < 0.5 * left as f64;
                    (low, high) = if is_below {
                        (middle, high)
                    } else {
                        (low, middle)
                    };
                }
                low + (high - low) / 2.0
            }
        }
    }

    /// The value of rank `rank`, 0 <= `rank` < n.
    fn of_rank(&self, rank: u64) -> f64 {
        match self {
            Ordered::Kept(kept) => kept
                .place(rank)
                .map_or(kept.centre, |place| kept.values[place]),
            Ordered::Binned(binned) => binned.of_rank(rank),
        }
    }

    /// The relative error of the standard deviation of independent values, and its law
    /// ([`super::spread`]). Values in a bin are assumed to lie in its middle.
    pub fn error_of_spread(&self) -> (f64, ErrorLaw) {
        let (n, values) = (self.count(), self.weighted());
        let mean = values
            .iter()
            .map(|(value, number)| number * value)
            .sum::<f64>()
            / n as f64;
        let squares: Vec<(f64, f64)> = values
            .iter()
            .map(|(value, number)| ((value - mean) * (value - mean), *number))
            .collect();
        let variance = squares
            .iter()
            .map(|(square, number)| number * square)
            .sum::<f64>()
            / n as f64;
        let mut tails = Tails::default();
        squares
            .iter()
            .for_each(|(square, number)| tails.add(square / variance - 1.0, *number));
        (
            tails.squares().sqrt() / (2.0 * n as f64),
            tails.error_law(n),
        )
    }

    /// The values in ascending order, and how many there are of each.
    fn weighted(&self) -> Vec<(f64, f64)> {
        match self {
            Ordered::Kept(kept) => kept.runs().collect(),
            Ordered::Binned(binned) => binned.middles().collect(),
        }
    }

    /// The number of values no larger than `value`.
    pub fn up_to(&self, value: f64) -> f64 {
        match self {
            Ordered::Kept(kept) => {
                let others = kept.values.partition_point(|v| *v <= value) as u64;
                (others
                    + if kept.centre <= value {
                        kept.at_centre
                    } else {
                        0
                    }) as f64
            }
            Ordered::Binned(binned) => binned.up_to(value),
        }
    }
}

/// The whole ranks on either side of a rank.
fn ranks(rank: f64) -> [u64; 2] {
    [rank.floor() as u64, rank.ceil() as u64]
}

impl Kept {
    /// These values, of which none is at the centre, in any order, and `at_centre` values at the
    /// centre.
    pub fn of(mut values: Vec<f64>, centre: f64, at_centre: u64) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        let below = values.partition_point(|value| *value < centre);
        Kept {
            centre,
            at_centre,
            below,
            values,
        }
    }

    /// All values in ascending order with their numbers, where those at the centre are one entry.
    fn runs(&self) -> impl Iterator<Item = (f64, f64)> {
        let (below, above) = self.values.split_at(self.below);
        let one = |value: &f64| (*value, 1.0);
        below
            .iter()
            .map(one)
            .chain([(self.centre, self.at_centre as f64)])
            .chain(above.iter().map(one))
    }

    /// All values in ascending order.
    pub fn ascending(&self) -> impl Iterator<Item = f64> {
        (0..self.values.len() as u64 + self.at_centre).map(|rank| {
            self.place(rank)
                .map_or(self.centre, |place| self.values[place])
        })
    }

    /// The index in `values` of the value of this rank; none if that value is the centre.
    fn place(&self, rank: u64) -> Option<usize> {
        let below = self.below as u64;
        if rank < below {
            Some(rank as usize)
        } else {
            (rank >= below + self.at_centre).then(|| (rank - self.at_centre) as usize)
        }
    }
}

impl Binned {
    /// The bins of values of this shape.
    pub fn of(bins: &Bins, shape: Shape) -> Self {
        let (mut up_to, mut all) = (bins.list(), 0);
        for (_, count) in &mut up_to {
            all += *count;
            *count = all;
        }
        let ends = [bins.smallest, bins.largest];
        let [smallest, largest] = shape
            .scale
            .map_or(ends, |scale| ends.map(|place| scale.number(place)));
        Binned {
            shape,
            level: bins.level,
            smallest,
            largest,
            up_to,
        }
    }

    /// The middles of the bins, and how many values are in each bin.
    fn middles(&self) -> impl Iterator<Item = (f64, f64)> {
        let mut before = 0;
        self.up_to.iter().map(move |&(index, up_to)| {
            let (low, high) = self.edges(index);
            let number = up_to - std::mem::replace(&mut before, up_to);
            (low + (high - low) / 2.0, number as f64)
        })
    }

    fn count(&self) -> u64 {
        self.up_to.last().map_or(0, |bin| bin.1)
    }

    /// The value of a rank. The values of a bin are assumed to be spread evenly over it; the
    /// smallest and the largest value are exact.
    fn of_rank(&self, rank: u64) -> f64 {
        if rank == 0 {
            return self.smallest;
        }
        if rank + 1 == self.count() {
            return self.largest;
        }
        let (place, before) = self.bin(|bin| bin.1 <= rank);
        let (index, end) = self.up_to[place];
        let (low, high) = self.edges(index);
        low + (high - low) * (((rank - before) as f64 + 0.5) / (end - before) as f64)
    }

    /// The number of values no larger than `value`. In the bin of `value` it is interpolated
    /// linearly.
    fn up_to(&self, value: f64) -> f64 {
        let (place, before) = self.bin(|bin| self.edges(bin.0).1 <= value);
        let Some(&(index, end)) = self.up_to.get(place) else {
            return before as f64;
        };
        let (low, high) = self.edges(index);
        let share = if value > low {
            (value - low) / (high - low)
        } else {
            0.0
        };
        before as f64 + share * (end - before) as f64
    }

    /// The first bin that is not passed, and how many values lie before it.
    fn bin(&self, is_passed: impl Fn(&(i64, u64)) -> bool) -> (usize, u64) {
        let place = self.up_to.partition_point(is_passed);
        (
            place,
            if place == 0 {
                0
            } else {
                self.up_to[place - 1].1
            },
        )
    }

    /// The bin of a value.
    pub fn index(&self, value: f64) -> i64 {
        Ruler::new(0.0, self.level).index(self.shape.place(value)) as i64
    }

    /// The interval in which the values of a bin may lie.
    pub fn edges(&self, index: i64) -> (f64, f64) {
        let width = width(self.level);
        let edge = |index: i64| {
            self.shape
                .value(index as f64 * width)
                .clamp(self.smallest, self.largest)
        };
        (
            edge(index - i64::from(index > 0)),
            edge(index + i64::from(index < 0)),
        )
    }
}
