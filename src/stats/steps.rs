//! Durations in whole steps, as a discrete law: its distribution function climbs at whole numbers
//! and is flat between them.

use super::dyadic::width;
use super::ordered::Ordered;

/// Neighbouring whole numbers, most often one alone, and how many durations are no longer than the
/// last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub first: f64,
    pub last: f64,
    pub up_to: u64,
}

/// The cells in which there are durations, ascending.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Steps(Vec<Cell>);

impl Steps {
    /// Of durations that are whole numbers.
    pub fn of(durations: &Ordered) -> Self {
        match durations {
            Ordered::Kept(kept) => Steps::of_values(kept.ascending()),
            Ordered::Binned(binned) => {
                let width = width(binned.level);
                let cell = |&(index, up_to): &(i64, u64)| {
                    let last = index as f64 * width;
                    let first = if index > 0 { last - width + 1.0 } else { last };
                    Cell { first: first.max(binned.smallest), last: last.min(binned.largest), up_to }
                };
                Steps(binned.up_to.iter().map(cell).collect())
            }
        }
    }

    fn of_values(ascending: impl Iterator<Item = f64>) -> Self {
        let mut cells: Vec<Cell> = Vec::new();
        for (value, up_to) in ascending.zip(1..) {
            match cells.last_mut() {
                Some(cell) if cell.last == value => cell.up_to = up_to,
                _ => cells.push(Cell { first: value, last: value, up_to }),
            }
        }
        Steps(cells)
    }

    /// The cells.
    pub fn cells(&self) -> &[Cell] {
        &self.0
    }

    /// The smallest whole number that a share p of the durations does not exceed, 0 < p <= 1, and
    /// its cell; NaN if there are none.
    pub fn at_least(&self, p: f64) -> (usize, f64) {
        let n = self.0.last().map_or(0, |cell| cell.up_to) as f64;
        // p n may be rounded to just above a whole number.
        let rank = (p * n * (1.0 - 4.0 * f64::EPSILON)).ceil().max(1.0);
        let place = self.place(rank);
        let Some(cell) = self.0.get(place) else { return (0, f64::NAN) };
        let (share, numbers) = (self.share(place, rank - 0.5), cell.last - cell.first + 1.0);
        (place, cell.first - 1.0 + (numbers * share).ceil())
    }

    /// The quantile of order p of the law that is spread evenly over half a step to either side of
    /// each number.
    pub fn spread(&self, p: f64) -> f64 {
        let n = self.0.last().map_or(0, |cell| cell.up_to) as f64;
        let rank = p.clamp(0.0, 1.0) * n;
        let place = self.place(rank);
        let Some(cell) = self.0.get(place) else { return f64::NAN };
        cell.first - 0.5 + (cell.last - cell.first + 1.0) * self.share(place, rank)
    }

    /// The first cell that so many durations do not exceed.
    fn place(&self, rank: f64) -> usize {
        self.0.partition_point(|cell| (cell.up_to as f64) < rank)
    }

    /// Which share of the durations of a cell has ranks up to this.
    fn share(&self, place: usize, rank: f64) -> f64 {
        let before = if place == 0 { 0 } else { self.0[place - 1].up_to };
        (rank - before as f64) / (self.0[place].up_to - before) as f64
    }
}
