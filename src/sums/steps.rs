//! Durations in whole steps, as a discrete law: its distribution function rises at whole numbers
//! and is constant between them.

use super::dyadic::nearest;
use super::ordered::{Binned, Ordered};

/// Consecutive whole numbers, most often a single one, and how many durations are no longer than
/// the last of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepsInBin {
    pub first: f64,
    pub last: f64,
    pub up_to: u64,
}

/// The cells in which there are durations, in ascending order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Steps(Vec<StepsInBin>);

impl Steps {
    /// The cells of durations that are whole numbers of this step.
    pub fn of(durations: &Ordered, step: f64) -> Self {
        match durations {
            Ordered::Kept(kept) => {
                Steps::of_values(kept.ascending().map(|duration| nearest(duration / step)))
            }
            Ordered::Binned(binned) => {
                let cell = |&(index, up_to): &(i64, u64)| {
                    let [first, last] = numbers_in(binned, index, step);
                    StepsInBin { first, last, up_to }
                };
                Steps(binned.up_to.iter().map(cell).collect())
            }
        }
    }

    fn of_values(ascending: impl Iterator<Item = f64>) -> Self {
        let mut cells: Vec<StepsInBin> = Vec::new();
        for (value, up_to) in ascending.zip(1..) {
            match cells.last_mut() {
                Some(cell) if cell.last == value => cell.up_to = up_to,
                _ => cells.push(StepsInBin {
                    first: value,
                    last: value,
                    up_to,
                }),
            }
        }
        Steps(cells)
    }

    /// Number of durations.
    pub fn count(&self) -> u64 {
        self.0.last().map_or(0, |cell| cell.up_to)
    }

    /// The number of durations no longer than this whole number. Those of a cell are assumed to be
    /// spread evenly over its numbers.
    pub fn up_to(&self, number: f64) -> f64 {
        let place = self.0.partition_point(|cell| cell.last <= number);
        let before = if place == 0 {
            0
        } else {
            self.0[place - 1].up_to
        } as f64;
        match self.0.get(place) {
            Some(cell) if cell.first <= number => {
                let share = (number - cell.first + 1.0) / (cell.last - cell.first + 1.0);
                before + share * (cell.up_to as f64 - before)
            }
            _ => before,
        }
    }

    /// The cells, in ascending order.
    pub fn cells(&self) -> &[StepsInBin] {
        &self.0
    }

    /// The smallest whole number m such that at least a share p of the durations are no longer than
    /// m, 0 < p <= 1, and the index of its cell; NaN if there are no durations.
    pub fn at_least(&self, p: f64) -> (usize, f64) {
        let n = self.count() as f64;
        // Rounding may put p n just above a whole number.
        let rank = (p * n * (1.0 - 4.0 * f64::EPSILON)).ceil().max(1.0);
        let place = self.place(rank);
        let Some(cell) = self.0.get(place) else {
            return (0, f64::NAN);
        };
        let (share, numbers) = (self.share(place, rank - 0.5), cell.last - cell.first + 1.0);
        (place, cell.first - 1.0 + (numbers * share).ceil())
    }

    /// The quantile of order p when each duration is spread evenly over half a step to either side.
    pub fn spread(&self, p: f64) -> f64 {
        let n = self.count() as f64;
        let rank = p.clamp(0.0, 1.0) * n;
        let place = self.place(rank);
        let Some(cell) = self.0.get(place) else {
            return f64::NAN;
        };
        cell.first - 0.5 + (cell.last - cell.first + 1.0) * self.share(place, rank)
    }

    /// The index of the first cell up to which there are at least `rank` durations.
    fn place(&self, rank: f64) -> usize {
        self.0.partition_point(|cell| (cell.up_to as f64) < rank)
    }

    /// The share of the durations of a cell that have ranks up to `rank`.
    fn share(&self, place: usize, rank: f64) -> f64 {
        let before = if place == 0 {
            0
        } else {
            self.0[place - 1].up_to
        };
        (rank - before as f64) / (self.0[place].up_to - before) as f64
    }
}

/// The first and the last whole number of steps in an occupied bin.
fn numbers_in(binned: &Binned, index: i64, step: f64) -> [f64; 2] {
    let steps = |duration: f64| nearest(duration / step);
    let (low, high) = binned.edges(index);
    let is_in = |number: &f64| binned.index(number * step) == index;
    let [first, last] = [steps(low), steps(high)];
    let first = [first - 1.0, first, first + 1.0]
        .into_iter()
        .find(is_in)
        .unwrap_or(last);
    let last = [last + 1.0, last, last - 1.0]
        .into_iter()
        .find(is_in)
        .unwrap_or(first);
    [
        first.max(steps(binned.smallest)),
        last.min(steps(binned.largest)),
    ]
}
