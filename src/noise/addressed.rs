//! Random numbers of a path, each at an address of its own.
//!
//! A stream hands out its numbers in turn, so that whatever takes one more number moves all that
//! come after it. Here a number is a function of (seed, path, cell, place) alone: what a path does
//! in one cell of time leaves the numbers of the next cell as they are. That is what lets two scenes
//! see the same noise, and somebody look at a path without changing it.
//!
//! The generator is SplitMix64 (Steele, Lea and Flood, *Fast splittable pseudorandom number
//! generators*, OOPSLA 2014) at the counter `cell 2^32 + place`, with a second key of 64 bits between
//! the two rounds of its output function (Stafford's variant 13). The origin of the counter and the
//! second key are two outputs of SplitMix64 sequences, one-to-one functions of the path number like
//! the words of [`super::Stream`]. Two paths whose counters happen to overlap have other second
//! keys, so they share no number.

use super::mirror;
use super::normal::standard_normal;
use super::stream::{GAMMA, path_word};

/// The random numbers of one path; a cursor that goes on from place to place within a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AddressedDraws {
    origin: u64,
    key: u64,
    counter: u64,
    /// See [`mirror::parts`].
    flip: u64,
}

/// Places of a cell from here on are for those who only look.
const LOOKING: u64 = 1 << 31;

/// The place, in cell 0, of what a path begins with.
const START: u64 = LOOKING - 1;

impl AddressedDraws {
    /// Those of path `path` of the ensemble with this seed, or of a mirror image
    /// ([`super::MIRROR`]), at the first place of cell 0.
    pub fn new(seed: u64, path: u64) -> Self {
        let (path, flip) = mirror::parts(path);
        AddressedDraws { origin: path_word(seed, path, 4), key: path_word(seed, path, 5), counter: 0, flip }
    }

    /// Those of the same path at this place of a cell; cells and places are below 2^31.
    #[inline(always)]
    pub fn at(&self, cell: u64, place: u64) -> Self {
        AddressedDraws { counter: cell << 32 | place, ..*self }
    }

    /// Those that the same path begins with.
    pub fn for_start(&self) -> Self {
        self.at(0, START)
    }

    /// Two rows of those of the same path and cell that no event depends on.
    pub fn for_looking(&self, cell: u64) -> [Self; 2] {
        [self.at(cell, LOOKING), self.at(cell, LOOKING + LOOKING / 2)]
    }

    /// The next 64 random bits.
    #[inline(always)]
    pub fn next_u64(&mut self) -> u64 {
        let z = self.origin.wrapping_add(self.counter.wrapping_mul(GAMMA));
        self.counter += 1;
        let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9) ^ self.key;
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// The next standard normal.
    #[inline(always)]
    pub fn normal(&mut self) -> f64 {
        standard_normal(self.next_u64() ^ self.flip)
    }

    /// The next two standard normals, of one draw ([`super::Stream::normal_pair`]).
    #[inline(always)]
    pub fn normal_pair(&mut self) -> [f64; 2] {
        let draw = self.next_u64() ^ self.flip;
        // Not by `map`, which is not compiled for the instruction set of the caller.
        [standard_normal(draw), standard_normal(draw.rotate_left(32))]
    }

    /// The next three standard normals, of two draws.
    #[inline(always)]
    pub fn three_normals(&mut self) -> [f64; 3] {
        let ([one, two], three) = (self.normal_pair(), self.normal());
        [one, two, three]
    }

    /// A uniform number in (0, 1): the midpoint of one of 2^53 cells.
    #[inline(always)]
    pub fn uniform(&mut self) -> f64 {
        ((self.next_u64() >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0)
    }
}
