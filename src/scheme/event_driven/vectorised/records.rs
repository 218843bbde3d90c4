//! The pieces of paths in which an instant lies at which the paths are observed. They are recorded
//! while the lanes cross the macro step, and the states are drawn afterwards.

use super::super::law::{ObservationTime, StickEnd};
use super::jobs::RowNumbers;
use crate::lanes::{Lanes, ROW, Row};

/// The pieces in one macro step.
#[derive(Default)]
pub(super) struct Records {
    /// When the macro step begins.
    macro_step_start: f64,
    /// The instants in the macro step; none where the paths are not observed.
    times: Vec<f64>,
    pub slips: Pieces,
    /// Sticks with each [`StickEnd`].
    sticks: [Pieces; 3],
}

/// Pieces of one kind, with two rows of numbers each.
#[derive(Default)]
pub(super) struct Pieces {
    pub left: Vec<Row>,
    pub right: Vec<Row>,
    pub lanes: Vec<u32>,
    pub len: usize,
}

impl Records {
    /// Starts a new macro step, which begins at this time and has these instants inside.
    pub fn begin(&mut self, macro_step_start: f64, instants: &[ObservationTime]) {
        self.macro_step_start = macro_step_start;
        self.times.clear();
        self.times.extend(instants.iter().map(|instant| instant.at));
        self.slips.len = 0;
        self.sticks.iter_mut().for_each(|sticks| sticks.len = 0);
    }

    /// Whether the paths are observed in this macro step.
    #[inline(always)]
    pub fn is_observed(&self) -> bool {
        !self.times.is_empty()
    }

    pub fn sticks(&mut self, kind: StickEnd) -> &mut Pieces {
        &mut self.sticks[kind as usize]
    }

    /// A mask of the lanes in which a piece between these times after the start of the macro step
    /// has an instant inside.
    #[inline(always)]
    pub fn hold<L: Lanes>(&self, from: L, to: L) -> u32 {
        let start = L::splat(self.macro_step_start);
        let (from, to) = (start + from, start + to);
        let mut any = 0;
        for &time in &self.times {
            any |= L::bitmask(is_inside(time, from, to));
        }
        any
    }
}

/// The lanes in which this time is inside a piece between these times. One at the start of a piece
/// belongs to it; one at its end belongs to the next piece.
#[inline(always)]
pub(super) fn is_inside<L: Lanes>(time: f64, from: L, to: L) -> L::Mask {
    let time = L::splat(time);
    L::and(from.le(time), time.lt(to))
}

impl Pieces {
    /// Records a piece in each lane of a mask.
    #[inline(always)]
    pub fn push<L: Lanes>(
        &mut self,
        rows: &RowNumbers,
        lanes: u32,
        left: [L; ROW],
        right: [L; ROW],
    ) {
        if self.lanes.len() <= self.len + ROW {
            self.grow();
        }
        // The last row holds what is not needed.
        let nobody = self.lanes.len() - 1;
        let mut places = [nobody as u32; ROW];
        for i in 0..L::WIDTH {
            if lanes >> i & 1 == 1 {
                places[i] = self.len as u32;
                self.lanes[self.len] = rows[i];
                self.len += 1;
            }
        }
        L::scatter_rows(left, &mut self.left, &places);
        L::scatter_rows(right, &mut self.right, &places);
    }

    /// Makes room for at least one more piece in each lane of a register.
    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        let more = 2 * (self.len + ROW + 1);
        self.left.resize(more, Row([0.0; ROW]));
        self.right.resize(more, Row([0.0; ROW]));
        self.lanes.resize(more, 0);
    }

    /// The lanes of the pieces from `first` on, with a mask of them, and their rows of numbers. A
    /// place without a piece has the lane of the first one.
    #[inline(always)]
    pub fn get<L: Lanes>(&self, first: usize) -> (RowNumbers, u32, [L; ROW], [L; ROW]) {
        let count = (self.len - first).min(L::WIDTH);
        let (mut places, mut lanes) = ([first as u32; ROW], [self.lanes[first]; ROW]);
        for i in 0..count {
            places[i] = (first + i) as u32;
            lanes[i] = self.lanes[first + i];
        }
        (
            lanes,
            (1 << count) - 1,
            L::gather_rows(&self.left, &places),
            L::gather_rows(&self.right, &places),
        )
    }
}
