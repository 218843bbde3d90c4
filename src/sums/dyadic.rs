//! The lattice on which values are counted: bins of width 2^level about a centre, where two bins of
//! a level form one bin of the next.
//!
//! With u the distance of a value from the centre, with its sign, and w = 2^level,
//!
//! ```text
//! bin i > 0    u in ((i - 1) w, i w]
//! bin 0        u = 0 and nothing else: an atom at the centre is never mixed with its neighbours
//! bin i < 0    u in [i w, (i + 1) w)
//! ```
//!
//! that is |i| = ceil(|u|/w). Since ceil(ceil(y)/2) = ceil(y/2), the bin at a coarser level follows
//! from the bin alone. So it does not matter when a value is moved to a coarser level, or together
//! with which others.

/// Bins extend over this many powers of two. An index then is a whole number that an f64 holds with
/// room for rounding.
const INDEX_BITS: i32 = 50;

/// The largest index, in either direction.
pub(crate) const MAX_INDEX: i64 = 1 << (INDEX_BITS + 1);

/// The finest level. From here on neither a width nor its inverse is subnormal.
const LOWEST: i32 = -1000;

/// The finest level for values no further than `distance` from the centre. Bins of this level are a
/// few roundings of the farthest value wide.
pub(crate) fn finest(distance: f64) -> i32 {
    (exponent(distance) - INDEX_BITS).max(LOWEST)
}

/// The e with 2^e <= x < 2^(e + 1), for x > 0. Below the smallest normal number it is the e of that
/// number.
pub(crate) fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff).max(1) as i32 - 1023
}

/// 2^level, for a normal result.
pub(crate) fn width(level: i32) -> f64 {
    f64::from_bits(((level + 1023) as u64) << 52)
}

/// Adding this number to a smaller one, and subtracting it again, rounds to a whole number.
const ROUNDING: f64 = (1u64 << 52) as f64;

/// The whole number nearest to x, 0 <= x < 2^52.
#[inline(always)]
pub(crate) fn nearest(x: f64) -> f64 {
    (x + ROUNDING) - ROUNDING
}

/// Finds the bins of values at one level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ruler {
    centre: f64,
    width: f64,
    inverse: f64,
}

impl Ruler {
    /// A ruler of this level, which must not be finer than [`finest`] of the values to come.
    pub fn new(centre: f64, level: i32) -> Self {
        Ruler {
            centre,
            width: width(level),
            inverse: width(-level),
        }
    }

    /// The bin of a value, as a whole number with a sign; -0 is 0. There is no branch, so that a
    /// row of values is computed in vectors.
    #[inline(always)]
    pub fn index(&self, value: f64) -> f64 {
        let u = value - self.centre;
        let nearest = nearest(u.abs() * self.inverse);
        // The comparison is with u itself, because u/w may have vanished, and a number next to the
        // centre is not the centre.
        let above = if nearest * self.width < u.abs() {
            1.0
        } else {
            0.0
        };
        (nearest + above).copysign(u)
    }
}

/// The bin that contains bin `index`, `levels` levels up.
pub(crate) fn coarsened(index: i64, levels: u32) -> i64 {
    // Counted from 0 outwards, half of a bin's number is the number without its last bit.
    let half = |magnitude: i64| ((magnitude - 1) >> levels.min(63)) + 1;
    match index {
        0 => 0,
        1.. => half(index),
        _ => -half(-index),
    }
}

/// The number of levels up at which two different bins become one; none if they never do.
fn levels_apart(a: i64, b: i64) -> Option<u32> {
    let (a, b) = if a < 0 { (-a, -b) } else { (a, b) };
    (a > 0 && b > 0).then(|| 64 - ((a - 1) ^ (b - 1)).leading_zeros())
}

/// Bins that are not empty, ascending, with their counts.
pub(crate) type List = Vec<(i64, u64)>;

/// The number of levels up at which no more than `limit` >= 3 of these bins are left.
pub(crate) fn excess(bins: &[(i64, u64)], limit: usize) -> u32 {
    if bins.len() <= limit {
        return 0;
    }
    // The bins that are left some levels up are one more than the pairs of neighbours that are
    // farther apart than this many levels.
    let apart = bins
        .windows(2)
        .map(|pair| levels_apart(pair[0].0, pair[1].0).unwrap_or(u32::MAX));
    // Mostly one level is enough.
    if apart.clone().filter(|levels| *levels > 1).count() < limit {
        return 1;
    }
    *apart
        .collect::<Vec<u32>>()
        .select_nth_unstable_by(limit - 1, |a, b| b.cmp(a))
        .1
}

/// The same counts, `levels` levels up.
pub(crate) fn coarsen(bins: &[(i64, u64)], levels: u32) -> List {
    let mut coarse = List::with_capacity(bins.len());
    bins.iter()
        .for_each(|&(index, count)| append(&mut coarse, (coarsened(index, levels), count)));
    coarse
}

/// The sum of two lists of counts.
pub(crate) fn union(a: &[(i64, u64)], b: &[(i64, u64)]) -> List {
    let mut both = List::with_capacity(a.len() + b.len());
    let (mut next, mut other) = (a, b);
    // The bins of one list up to the next bin of the other are copied together, because mostly one
    // list is short, or they hardly overlap.
    while let Some(&(limit, _)) = other.first() {
        let ready = next.iter().take_while(|bin| bin.0 <= limit).count();
        append_all(&mut both, &next[..ready]);
        (next, other) = (other, &next[ready..]);
    }
    append_all(&mut both, next);
    both
}

/// The counts of bins that are given one at a time, in any order.
pub(crate) fn counted(mut indices: Vec<i64>) -> List {
    indices.sort_unstable();
    let mut list = List::new();
    indices
        .into_iter()
        .for_each(|index| append(&mut list, (index, 1)));
    list
}

/// Add a bin that is not before the last one of the list.
fn append(list: &mut List, (index, count): (i64, u64)) {
    match list.last_mut() {
        Some(last) if last.0 == index => last.1 += count,
        _ => list.push((index, count)),
    }
}

/// Add the bins of another list, the first of which is not before the last one of this list.
fn append_all(list: &mut List, bins: &[(i64, u64)]) {
    if let Some((&first, others)) = bins.split_first() {
        append(list, first);
        list.extend_from_slice(others);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    /// The bin by its definition, in integers: |i| is the smallest with |u| <= |i| 2^level.
    fn by_definition(u: f64, level: i32) -> i64 {
        let magnitude = (u.abs() / width(level)).ceil() as i64;
        let magnitude = if u != 0.0 { magnitude.max(1) } else { 0 };
        if u < 0.0 { -magnitude } else { magnitude }
    }

    fn any_value() -> impl Strategy<Value = f64> {
        prop_oneof![
            -1e3..1e3f64,
            -1e-300..1e-300f64,
            -1e300..1e300f64,
            (-4096i64..4096).prop_map(|i| i as f64 / 8.0),
            Just(0.0),
            Just(-0.0),
            Just(5e-324),
        ]
    }

    proptest! {
        #[test]
        fn a_bin_is_the_one_of_the_definition_at_every_level(u in any_value(), up in 0i32..60) {
            let level = finest(u.abs()) + up;
            prop_assert_eq!(Ruler::new(0.0, level).index(u) as i64, by_definition(u, level));
        }

        #[test]
        fn coarsening_a_bin_gives_the_coarser_bin_of_the_value(
            u in any_value(),
            up in 0i32..55,
            more in 0u32..70,
        ) {
            let fine = finest(u.abs()) + up;
            let levels = more.min((1000 - fine).unsigned_abs());
            let coarse = Ruler::new(0.0, fine + levels as i32).index(u) as i64;
            prop_assert_eq!(coarsened(Ruler::new(0.0, fine).index(u) as i64, levels), coarse);
        }

        #[test]
        fn the_sum_of_two_lists_has_the_counts_of_both(
            [a, b] in prop::array::uniform2(prop::collection::btree_map(-40i64..40, 1u64..9, 0..60)),
        ) {
            let list = |counts: &BTreeMap<i64, u64>| counts.iter().map(|(&bin, &count)| (bin, count)).collect::<List>();
            let mut sum = a.clone();
            b.iter().for_each(|(&bin, &count)| *sum.entry(bin).or_default() += count);
            prop_assert_eq!(union(&list(&a), &list(&b)), list(&sum));
        }

        #[test]
        fn the_excess_is_the_smallest_that_fits(
            indices in prop::collection::btree_set(prop_oneof![-50i64..50, -1i64 << 50..1 << 50], 0..200),
            limit in 3usize..60,
        ) {
            let bins: List = indices.into_iter().map(|i| (i, 1)).collect();
            let levels = excess(&bins, limit);
            prop_assert!(coarsen(&bins, levels).len() <= limit);
            prop_assert!(levels == 0 || coarsen(&bins, levels - 1).len() > limit);
            let all: u64 = coarsen(&bins, levels).iter().map(|bin| bin.1).sum();
            prop_assert_eq!(all, bins.len() as u64);
        }
    }

    #[test]
    fn bins_pair_off_from_the_centre_outwards() {
        assert_eq!([1, 2, 3, 4, 5].map(|i| coarsened(i, 1)), [1, 1, 2, 2, 3]);
        assert_eq!(
            [-1, -2, -3, -4, -5].map(|i| coarsened(i, 1)),
            [-1, -1, -2, -2, -3]
        );
        assert_eq!(
            (coarsened(0, 7), coarsened(9, 2), coarsened(i64::MAX, 64)),
            (0, 3, 1)
        );
    }
}
