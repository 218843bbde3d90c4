//! Counts of pairs of numbers in the cells of a plane, on the finest dyadic lattice on which no
//! more than a given number of cells along each axis hold them all.
//!
//! Cell i of an axis of level l is [i w, (i + 1) w), w = 2^l. Two cells form one of the next level,
//! so the cell at a coarser level follows from the cell alone. The level of an axis follows from
//! the smallest and the largest number, so that counts do not depend on the order in which parts
//! are merged.

use super::Merge;
use super::codec::{Codec, Damaged, Reader};
use super::dyadic::{exponent, width};

/// Indices of cells are whole numbers that an f64 holds with room for a fraction.
const INDEX_BITS: i32 = 45;

/// The finest level that is used.
const LOWEST: i32 = -900;

/// Numbers beyond this size have no cell: at the coarsest level, the width of a cell and its inverse
/// are still normal.
const FARTHEST: f64 = f64::from_bits((1000 + 1023) << 52);

/// The cells along one axis: `cells` of them from `first` on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GridAxis {
    level: i32,
    first: i64,
    cells: usize,
}

impl GridAxis {
    /// An axis without cells.
    const NOTHING: GridAxis = GridAxis { level: LOWEST, first: 0, cells: 0 };

    /// The finest axis of no more than `most` cells that hold these numbers.
    fn over([least, greatest]: [f64; 2], most: usize) -> GridAxis {
        let farthest = least.abs().max(greatest.abs());
        let span = exponent((greatest - least) / most as f64) - 1;
        let mut level = span.max(exponent(farthest) - INDEX_BITS).max(LOWEST);
        loop {
            let [first, last] = [least, greatest].map(|number| cell(number, width(-level)));
            if (last - first) < most as i64 {
                return GridAxis { level, first, cells: (last - first + 1) as usize };
            }
            level += 1;
        }
    }

    /// The finest axis of no more than `most` cells that hold those of both.
    fn with(self, other: GridAxis, most: usize) -> GridAxis {
        match (self.cells, other.cells) {
            (_, 0) => self,
            (0, _) => other,
            _ => {
                let mut level = self.level.max(other.level);
                loop {
                    let [a, b] = [self, other].map(|axis| axis.coarsened(level));
                    let (first, end) = (a.first.min(b.first), a.end().max(b.end()));
                    if end - first <= most as i64 {
                        return GridAxis { level, first, cells: (end - first) as usize };
                    }
                    level += 1;
                }
            }
        }
    }

    /// The same cells at a coarser level.
    fn coarsened(self, level: i32) -> GridAxis {
        let up = (level - self.level).min(63) as u32;
        let (first, last) = (self.first >> up, (self.end() - 1) >> up);
        GridAxis { level, first, cells: (last - first + 1) as usize }
    }

    fn end(self) -> i64 {
        self.first + self.cells as i64
    }

    /// The place among the cells of `coarser` of place `place` among these.
    fn place_in(self, coarser: GridAxis, place: usize) -> usize {
        let up = (coarser.level - self.level).min(63) as u32;
        (((self.first + place as i64) >> up) - coarser.first) as usize
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// The edges of the cells, one more than there are cells.
    pub fn edges(&self) -> Vec<f64> {
        let width = width(self.level);
        if self.cells == 0 { Vec::new() } else { (self.first..=self.end()).map(|i| i as f64 * width).collect() }
    }
}

/// The cell of a number, whose width is the inverse of `inverse`: the largest whole number that is
/// not above the quotient.
#[inline]
fn cell(number: f64, inverse: f64) -> i64 {
    let quotient = number * inverse;
    let whole = quotient as i64;
    whole - i64::from(whole as f64 > quotient)
}

/// Counts of pairs, separately for each of some batches.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    /// The largest number of cells along each axis.
    most: [usize; 2],
    batches: usize,
    axes: [GridAxis; 2],
    /// The count of each cell and batch: the second axis fastest, then the batches.
    counts: Vec<u64>,
}

impl Merge for Grid {
    fn merge(&mut self, other: &Self) {
        self.rise_to(std::array::from_fn(|i| self.axes[i].with(other.axes[i], self.most[i])));
        self.add(other.axes, &other.counts);
    }
}

impl Grid {
    /// No pairs.
    pub fn empty(most: [usize; 2], batches: usize) -> Self {
        Grid { most, batches, axes: [GridAxis::NOTHING; 2], counts: Vec::new() }
    }

    /// The axes.
    pub fn axes(&self) -> &[GridAxis; 2] {
        &self.axes
    }

    /// The counts of the batches, for each cell, the second axis fastest.
    pub fn cells(&self) -> impl Iterator<Item = &[u64]> {
        self.counts.chunks(self.batches)
    }

    /// Count these pairs, each so many times and with its batch. A pair is left out if one of its
    /// numbers is none or is farther than any cell; it is of a path that diverges.
    pub fn count(&mut self, pairs: impl Iterator<Item = ([f64; 2], u64, usize)> + Clone) {
        let pairs = pairs.filter(|(pair, ..)| pair.iter().all(|number| number.abs() <= FARTHEST));
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (pair, ..) in pairs.clone() {
            for (ends, number) in ends.iter_mut().zip(pair) {
                // Faster than `min` and `max`, which look for NaN.
                *ends =
                    [if number < ends[0] { number } else { ends[0] }, if number > ends[1] { number } else { ends[1] }];
            }
        }
        if ends[0][0] > ends[0][1] {
            return;
        }
        let needed: [GridAxis; 2] = std::array::from_fn(|i| GridAxis::over(ends[i], self.most[i]));
        self.rise_to(std::array::from_fn(|i| self.axes[i].with(needed[i], self.most[i])));
        let inverse = self.axes.map(|axis| width(-axis.level));
        let [first, second] = self.axes;
        for ([x, y], times, batch) in pairs {
            let (row, column) = (cell(x, inverse[0]) - first.first, cell(y, inverse[1]) - second.first);
            self.counts[(row as usize * second.cells + column as usize) * self.batches + batch] += times;
        }
    }

    /// Move the counts to axes that hold all of their cells.
    fn rise_to(&mut self, axes: [GridAxis; 2]) {
        if axes != self.axes {
            let old = std::mem::replace(&mut self.axes, axes);
            let counts = vec![0; axes[0].cells * axes[1].cells * self.batches];
            let counts = std::mem::replace(&mut self.counts, counts);
            self.add(old, &counts);
        }
    }

    fn add(&mut self, axes: [GridAxis; 2], counts: &[u64]) {
        for (at, more) in counts.chunks(self.batches).enumerate() {
            let [row, column] = [at / axes[1].cells, at % axes[1].cells];
            let place =
                axes[0].place_in(self.axes[0], row) * self.axes[1].cells + axes[1].place_in(self.axes[1], column);
            let mine = &mut self.counts[place * self.batches..][..self.batches];
            mine.iter_mut().zip(more).for_each(|(mine, more)| *mine += more);
        }
    }
}

impl Codec for GridAxis {
    fn write(&self, out: &mut Vec<u8>) {
        let [level, first] = [i64::from(self.level), self.first].map(i64::cast_unsigned);
        [level, first, self.cells as u64].write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        let [level, first, cells] = from.value::<[u64; 3]>()?;
        let (level, first) = (level.cast_signed(), first.cast_signed());
        let is_sound = (i64::from(LOWEST)..=1024).contains(&level) && first.unsigned_abs() <= 1 << (INDEX_BITS + 2);
        if !is_sound || cells > 1 << 16 {
            return Err(Damaged);
        }
        *self = GridAxis { level: level as i32, first, cells: cells as usize };
        Ok(())
    }
}

/// Axes, and one count for each cell and batch.
impl Codec for Grid {
    fn write(&self, out: &mut Vec<u8>) {
        self.axes.write(out);
        self.counts.write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        self.axes.read(from)?;
        let are_few = self.axes.iter().zip(self.most).all(|(axis, most)| axis.cells <= most);
        let length = self.axes[0].cells * self.axes[1].cells * self.batches;
        if !are_few || from.clone().length()? != length {
            return Err(Damaged);
        }
        self.counts = vec![0; length];
        self.counts.read(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn numbers() -> impl Strategy<Value = Vec<f64>> {
        let number = (-1.0..1.0f64, -6..6i32).prop_map(|(x, power)| x * 10f64.powi(power));
        proptest::collection::vec(number, 1..60)
    }

    fn grid(of: &[f64]) -> Grid {
        let mut grid = Grid::empty([16, 4], 2);
        of.iter().for_each(|x| grid.count(std::iter::once(([*x, -x], 1, usize::from(*x > 0.0)))));
        grid
    }

    proptest! {
        #[test]
        fn counts_are_those_of_all_numbers_however_they_are_merged(a in numbers(), b in numbers()) {
            let whole = grid(&[a.clone(), b.clone()].concat());
            let mut other = Grid::empty([16, 4], 2);
            other.count(b.iter().chain(&a).map(|x| ([*x, -x], 1, usize::from(*x > 0.0))));
            let mut merged = grid(&b);
            merged.merge(&grid(&a));
            prop_assert_eq!(&whole, &other);
            prop_assert_eq!(&whole, &merged);
            let edges = whole.axes()[0].edges();
            prop_assert!(edges.len() <= 17 && whole.axes()[1].cells() <= 4);
            for (i, pair) in edges.windows(2).enumerate() {
                let expected = a.iter().chain(&b).filter(|x| pair[0] <= **x && **x < pair[1]).count() as u64;
                let columns = whole.axes()[1].cells();
                let found: u64 = whole.cells().skip(i * columns).take(columns).flatten().sum();
                prop_assert_eq!(found, expected);
            }
            let mut bytes = Vec::new();
            whole.write(&mut bytes);
            let mut back = Grid::empty([16, 4], 2);
            back.read(&mut Reader::new(&bytes)).expect("its own bytes");
            prop_assert_eq!(back, whole);
        }
    }

    /// Such numbers are observed of paths that diverge, until their block is simulated without them.
    #[test]
    fn numbers_that_are_none_or_too_far_are_left_out_and_no_number_panics() {
        let extreme = [0.0, -0.0, 5e-324, 1.0, FARTHEST, 1e300 * FARTHEST.sqrt(), f64::MAX, f64::INFINITY, f64::NAN];
        let numbers: Vec<f64> = extreme.iter().flat_map(|x| [*x, -x]).collect();
        let sound = numbers.iter().filter(|x| x.abs() <= FARTHEST).count() as u64;
        let count = |grid: &Grid| grid.cells().flatten().sum::<u64>();
        for first in &numbers {
            let mut grid = Grid::empty([16, 4], 2);
            for x in &numbers {
                grid.count([([*first, 1.0], 1, 0), ([*x, *first], 1, 1)].into_iter());
            }
            let of_first = if first.abs() <= FARTHEST { sound + numbers.len() as u64 } else { 0 };
            assert_eq!(count(&grid), of_first, "{first}");
            let mut whole = Grid::empty([16, 4], 2);
            whole.count(numbers.iter().map(|x| ([*x, *x], 1, 0)));
            whole.merge(&grid);
            assert_eq!(count(&whole), of_first + sound, "{first}");
        }
    }

    #[test]
    fn equal_numbers_have_one_cell_and_the_others_about_as_many_as_there_may_be() {
        let mut grid = Grid::empty([256, 1], 1);
        grid.count([([0.0, 0.0], 2, 0), ([0.0, 0.0], 1, 0)].into_iter());
        assert_eq!((grid.axes()[0].cells(), grid.cells().next().unwrap()[0]), (1, 3));
        grid.count((0..1000).map(|i| ([f64::from(i) / 1000.0 - 0.3, 0.0], 1, 0)));
        assert!((128..=256).contains(&grid.axes()[0].cells()), "{:?}", grid.axes());
        assert_eq!(grid.cells().map(|counts| counts[0]).sum::<u64>(), 1003);
    }
}
