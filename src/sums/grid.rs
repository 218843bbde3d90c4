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
use std::cmp::Ordering;

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
    const NOTHING: GridAxis = GridAxis {
        level: LOWEST,
        first: 0,
        cells: 0,
    };

    /// The finest axis of no more than `most` cells that hold these numbers.
    fn over([least, greatest]: [f64; 2], most: usize) -> GridAxis {
        let farthest = least.abs().max(greatest.abs());
        let span = exponent((greatest - least) / most as f64) - 1;
        let mut level = span.max(exponent(farthest) - INDEX_BITS).max(LOWEST);
        loop {
            let [first, last] = [least, greatest].map(|number| cell(number, width(-level)));
            if (last - first) < most as i64 {
                return GridAxis {
                    level,
                    first,
                    cells: (last - first + 1) as usize,
                };
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
                        return GridAxis {
                            level,
                            first,
                            cells: (end - first) as usize,
                        };
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
        GridAxis {
            level,
            first,
            cells: (last - first + 1) as usize,
        }
    }

    fn end(self) -> i64 {
        self.first + self.cells as i64
    }

    /// Whether the axis stays as it is with a number in this cell.
    fn has(self, cell: i64) -> bool {
        self.first <= cell && cell < self.end() && cell.unsigned_abs() < 1 << INDEX_BITS
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
        if self.cells == 0 {
            Vec::new()
        } else {
            (self.first..=self.end())
                .map(|i| i as f64 * width)
                .collect()
        }
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
        self.rise_to(std::array::from_fn(|i| {
            self.axes[i].with(other.axes[i], self.most[i])
        }));
        self.add(other.axes, &other.counts);
    }
}

impl Grid {
    /// No pairs.
    pub fn empty(most: [usize; 2], batches: usize) -> Self {
        Grid {
            most,
            batches,
            axes: [GridAxis::NOTHING; 2],
            counts: Vec::new(),
        }
    }

    /// The axes.
    pub fn axes(&self) -> &[GridAxis; 2] {
        &self.axes
    }

    /// The counts of the batches, for each cell, the second axis fastest.
    pub fn cells(&self) -> impl Iterator<Item = &[u64]> {
        self.counts.chunks(self.batches)
    }

    /// Count the ticks from `first` to `last` of a motion from one pair of numbers to another on
    /// which both numbers are monotone. `crossing` is the tick at which the number of an axis
    /// passes an edge, and depends on nothing else. Then the ticks of a cell do not depend on the
    /// cells that it was formed of. A motion is left out if one of its numbers is NaN or beyond all
    /// cells; its path diverges.
    pub fn pass(
        &mut self,
        [from, to]: [[f64; 2]; 2],
        [first, last]: [u64; 2],
        batch: usize,
        crossing: impl Fn(usize, f64) -> u64,
    ) {
        if !from
            .iter()
            .chain(&to)
            .all(|number| number.abs() <= FARTHEST)
        {
            return;
        }
        // The cells of both ends along both axes.
        let cells = |axes: [GridAxis; 2]| {
            let inverse = axes.map(|axis| width(-axis.level));
            [from, to].map(|pair| [cell(pair[0], inverse[0]), cell(pair[1], inverse[1])])
        };
        let mut ends = cells(self.axes);
        if !ends
            .iter()
            .all(|cells| self.axes[0].has(cells[0]) && self.axes[1].has(cells[1]))
        {
            self.rise_to(std::array::from_fn(|i| {
                let needed = GridAxis::over([from[i].min(to[i]), from[i].max(to[i])], self.most[i]);
                self.axes[i].with(needed, self.most[i])
            }));
            ends = cells(self.axes);
        }
        let ([mut at, end], axes) = (ends, self.axes);
        // When the motion leaves the cell along an axis; never, if it ends there.
        let leaves = |i: usize, at: i64| match at.cmp(&end[i]) {
            Ordering::Less => crossing(i, (at + 1) as f64 * width(axes[i].level)),
            Ordering::Equal => u64::MAX,
            Ordering::Greater => crossing(i, at as f64 * width(axes[i].level)),
        };
        let (mut next, mut now) = ([leaves(0, at[0]), leaves(1, at[1])], first);
        loop {
            let i = usize::from(next[1] < next[0]);
            let until = next[i].clamp(now, last);
            let [row, column] = std::array::from_fn(|i| (at[i] - axes[i].first) as usize);
            self.counts[(row * axes[1].cells + column) * self.batches + batch] += until - now;
            if next[i] == u64::MAX {
                return;
            }
            now = until;
            at[i] += (end[i] - at[i]).signum();
            next[i] = leaves(i, at[i]);
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
            let place = axes[0].place_in(self.axes[0], row) * self.axes[1].cells
                + axes[1].place_in(self.axes[1], column);
            let mine = &mut self.counts[place * self.batches..][..self.batches];
            mine.iter_mut()
                .zip(more)
                .for_each(|(mine, more)| *mine += more);
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
        let is_sound = (i64::from(LOWEST)..=1024).contains(&level)
            && first.unsigned_abs() <= 1 << (INDEX_BITS + 2);
        if !is_sound || cells > 1 << 16 {
            return Err(Damaged);
        }
        *self = GridAxis {
            level: level as i32,
            first,
            cells: cells as usize,
        };
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
        let are_few = self
            .axes
            .iter()
            .zip(self.most)
            .all(|(axis, most)| axis.cells <= most);
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

    impl Grid {
        /// Counts a pair some times.
        fn count(&mut self, pair: [f64; 2], times: u64, batch: usize) {
            self.pass([pair; 2], [0, times], batch, |_, _| 0);
        }
    }

    fn grid<'x>(of: impl IntoIterator<Item = &'x f64>) -> Grid {
        let mut grid = Grid::empty([16, 4], 2);
        of.into_iter()
            .for_each(|x| grid.count([*x, -x], 1, usize::from(*x > 0.0)));
        grid
    }

    /// Motions from one number to the next, along both axes, in the order of their indices.
    fn motions(numbers: &[f64], order: impl Iterator<Item = usize>) -> Grid {
        let mut grid = Grid::empty([16, 4], 2);
        for i in order {
            let ([a, b], start) = ([numbers[i], numbers[i + 1]], (i as u64) << 40);
            let crossing = |axis: usize, edge: f64| {
                let edge = if axis == 0 { edge } else { -edge };
                start + ((edge - a) / (b - a) * (1u64 << 40) as f64).round() as u64
            };
            grid.pass(
                [[a, -a], [b, -b]],
                [start, start + (1 << 40)],
                i % 2,
                crossing,
            );
        }
        grid
    }

    proptest! {
        #[test]
        fn counts_are_those_of_all_numbers_however_they_are_merged(a in numbers(), b in numbers()) {
            let whole = grid(a.iter().chain(&b));
            let other = grid(b.iter().chain(&a));
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

        #[test]
        fn the_ticks_of_a_cell_do_not_depend_on_finer_cells(numbers in numbers()) {
            let whole = motions(&numbers, 0..numbers.len() - 1);
            prop_assert_eq!(&motions(&numbers, (0..numbers.len() - 1).rev()), &whole);
            let mut merged = motions(&numbers, (1..numbers.len() - 1).step_by(2));
            merged.merge(&motions(&numbers, (0..numbers.len() - 1).step_by(2)));
            prop_assert_eq!(&merged, &whole);
            prop_assert_eq!(whole.cells().flatten().sum::<u64>(), (numbers.len() as u64 - 1) << 40);
        }
    }

    /// Such numbers are observed of paths that diverge, until their block is simulated without them.
    #[test]
    fn numbers_that_are_none_or_too_far_are_left_out() {
        let extreme = [
            0.0,
            -0.0,
            5e-324,
            1.0,
            FARTHEST,
            1e300 * FARTHEST.sqrt(),
            f64::MAX,
            f64::INFINITY,
            f64::NAN,
        ];
        let numbers: Vec<f64> = extreme.iter().flat_map(|x| [*x, -x]).collect();
        let sound = numbers.iter().filter(|x| x.abs() <= FARTHEST).count() as u64;
        let count = |grid: &Grid| grid.cells().flatten().sum::<u64>();
        for first in &numbers {
            let mut grid = Grid::empty([16, 4], 2);
            for x in &numbers {
                grid.count([*first, 1.0], 1, 0);
                grid.count([*x, *first], 1, 1);
            }
            let of_first = if first.abs() <= FARTHEST {
                sound + numbers.len() as u64
            } else {
                0
            };
            assert_eq!(count(&grid), of_first, "{first}");
            let mut whole = Grid::empty([16, 4], 2);
            numbers.iter().for_each(|x| whole.count([*x, *x], 1, 0));
            whole.merge(&grid);
            assert_eq!(count(&whole), of_first + sound, "{first}");
        }
    }

    #[test]
    fn equal_numbers_have_one_cell_and_others_many() {
        let mut grid = Grid::empty([256, 1], 1);
        grid.count([0.0, 0.0], 2, 0);
        grid.count([0.0, 0.0], 1, 0);
        assert_eq!(
            (grid.axes()[0].cells(), grid.cells().next().unwrap()[0]),
            (1, 3)
        );
        (0..1000).for_each(|i| grid.count([f64::from(i) / 1000.0 - 0.3, 0.0], 1, 0));
        assert!(
            (128..=256).contains(&grid.axes()[0].cells()),
            "{:?}",
            grid.axes()
        );
        assert_eq!(grid.cells().map(|counts| counts[0]).sum::<u64>(), 1003);
    }
}
