//! The states of the paths at the border of two macro steps: one row of numbers for each lane, so
//! that any lanes can be taken into a register together.

use super::jobs::{Queue, RowNumbers};
use crate::lanes::{Lanes, ROW, Row};
use crate::noise::LaneDraws;

/// The state of a path at the border of two macro steps, and the keys of its random numbers
/// ([`crate::noise::AddressedDraws::keys`]).
#[derive(Clone, Copy)]
pub(super) struct Border<L: Lanes> {
    pub x: L,
    /// x', zero in a stick.
    pub v: L,
    pub n: L,
    /// b.
    pub force: L,
    /// The direction of the slip; zero in a stick.
    pub eps: L,
    pub origin: L::Bits,
    pub key: L::Bits,
    pub flip: L::Bits,
}

impl<L: Lanes> Border<L> {
    #[inline(always)]
    pub fn get(states: &[Row], rows: &RowNumbers) -> Self {
        let [x, v, n, force, eps, origin, key, flip] = L::gather_rows(states, rows);
        Border {
            x,
            v,
            n,
            force,
            eps,
            origin: origin.to_bits(),
            key: key.to_bits(),
            flip: flip.to_bits(),
        }
    }

    #[inline(always)]
    pub fn put(self, states: &mut [Row], rows: &RowNumbers) {
        let Border {
            x,
            v,
            n,
            force,
            eps,
            origin,
            key,
            flip,
        } = self;
        let [origin, key, flip] = [L::from_bits(origin), L::from_bits(key), L::from_bits(flip)];
        L::scatter_rows([x, v, n, force, eps, origin, key, flip], states, rows);
    }

    /// The random numbers of the paths at this address, macro step 2^32 + place.
    #[inline(always)]
    pub fn draws(&self, address: u64) -> LaneDraws<L> {
        LaneDraws::at([self.origin, self.key, self.flip], address)
    }
}

/// The rows of [`ROW`] neighbouring lanes.
#[inline(always)]
pub(super) fn rows_from(lane: usize) -> RowNumbers {
    let mut rows = [0; ROW];
    for (i, row) in (0..).zip(&mut rows) {
        *row = lane as u32 + i;
    }
    rows
}

/// Which lanes hold a path, and which of these slip.
pub(super) struct Phases {
    /// For each row of [`ROW`] lanes, a mask of those that hold a path which has not been given up.
    present: Vec<u32>,
    /// For each row of [`ROW`] lanes, a mask of those that slip.
    slips: Vec<u32>,
}

impl Phases {
    /// `count` lanes with a path in a stick.
    pub fn new(count: usize) -> Self {
        let rows = (0..count).step_by(ROW);
        Phases {
            slips: rows.clone().map(|_| 0).collect(),
            present: rows
                .map(|lane| (1 << (count - lane).min(ROW)) - 1)
                .collect(),
        }
    }

    /// Takes a lane out, because its path has been given up.
    pub fn leave_out(&mut self, lane: usize) {
        self.present[lane / ROW] &= !(1 << (lane % ROW));
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, is_slip: bool) {
        let (slips, bit) = (&mut self.slips[lane / ROW], 1 << (lane % ROW));
        *slips = if is_slip { *slips | bit } else { *slips & !bit };
    }

    /// Sets the phase of the lanes of a mask.
    #[inline(always)]
    pub fn set_all(&mut self, rows: &RowNumbers, mut lanes: u32, is_slip: bool) {
        while lanes != 0 {
            self.set(rows[lanes.trailing_zeros() as usize] as usize, is_slip);
            lanes &= lanes - 1;
        }
    }

    /// Puts the lanes that slip, and those that stick, into queues.
    #[inline(always)]
    pub fn divide<L: Lanes>(&self, slips: &mut Queue, sticks: &mut Queue) {
        slips.clear();
        sticks.clear();
        for (i, (&present, &slip)) in self.present.iter().zip(&self.slips).enumerate() {
            for part in (0..ROW).step_by(L::WIDTH) {
                let rows = rows_from(i * ROW + part);
                let mask = (1 << L::WIDTH) - 1;
                slips.push::<L>(&rows, (present & slip) >> part & mask);
                sticks.push::<L>(&rows, (present & !slip) >> part & mask);
            }
        }
    }
}
