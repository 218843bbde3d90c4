//! Random numbers of a path, each at its own address.
//!
//! A stream returns its numbers in turn, so one extra number changes all later ones. Here a number
//! is a function of (seed, path, macro step, place) alone, and events in one macro step do not
//! affect the numbers of the next. Therefore two scenarios can have the same noise, and a path can
//! be observed without being changed.
//!
//! The generator is SplitMix64 at the counter `macro_step 2^32 + place` (Steele, Lea and Flood,
//! *Fast splittable pseudorandom number generators*, OOPSLA 2014). It has a second key of 64 bits
//! between the two rounds of its output function (Stafford's variant 13). The origin of the counter
//! and the second key are two outputs of SplitMix64 sequences. Both are one-to-one functions of the
//! path number, like the words of [`super::Stream`]. Two paths whose counters happen to overlap
//! have different second keys, so they share no number.

use super::mirror;
use super::normal::half_normals;
use super::stream::{GAMMA, path_word};
use crate::lanes::{Lanes, LookupTable};
use std::f64::consts::SQRT_2;

/// The random numbers of one path, from a place of a macro step on. Each draw moves on to the next
/// place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AddressedDraws {
    origin: u64,
    key: u64,
    counter: u64,
    /// The bits of [`mirror::parts`].
    pub(super) flip: u64,
}

/// The first place of a macro step whose numbers are only used for observing a path.
const OBSERVING: u64 = 1 << 31;

/// The number of places that belong to one instant at which paths are observed. The most that are
/// needed are two for each of the 1000 attempts to draw a bridge inside the band.
const PER_OBSERVATION: u64 = 1 << 11;

/// The first place of the numbers for observing a path at an instant inside a macro step. No event
/// depends on them. `ordinal` is the number of the instant among those of the run in the macro
/// step, or among the additional ones. If there are more instants than places, numbers are reused.
pub fn observation_place(ordinal: u64, is_additional: bool) -> u64 {
    let half = OBSERVING / 2;
    OBSERVING + u64::from(is_additional) * half + ordinal * PER_OBSERVATION % half
}

/// The place, in macro step 0, of the numbers for the initial state of a path.
const START: u64 = OBSERVING - 1;

impl AddressedDraws {
    /// The numbers of path `path` of the ensemble with this seed, from the first place of macro
    /// step 0 on. With [`super::MIRROR`] in `path`, they are those of a mirror image.
    pub fn new(seed: u64, path: u64) -> Self {
        let (path, flip) = mirror::parts(path);
        AddressedDraws {
            origin: path_word(seed, path, 4),
            key: path_word(seed, path, 5),
            counter: 0,
            flip,
        }
    }

    /// Numbers of this path that no scheme draws, for a user-defined statistic. A mirror image has
    /// its own numbers, not those of the other path of its pair.
    pub fn auxiliary(seed: u64, path: u64) -> Self {
        AddressedDraws {
            origin: path_word(seed, path, 6),
            key: path_word(seed, path, 7),
            counter: 0,
            flip: 0,
        }
    }

    /// The numbers of the same path from this place of a macro step on. Macro steps and places are
    /// below 2^31.
    #[inline(always)]
    pub fn at(&self, macro_step: u64, place: u64) -> Self {
        AddressedDraws {
            counter: macro_step << 32 | place,
            ..*self
        }
    }

    /// The numbers for the initial state of the same path.
    pub fn for_start(&self) -> Self {
        self.at(0, START)
    }

    /// The numbers of the same path from this place of the same macro step on.
    #[inline(always)]
    pub fn from(&self, place: u64) -> Self {
        self.at(self.counter >> 32, place)
    }

    /// The next 64 random bits.
    #[inline(always)]
    pub fn next_u64(&mut self) -> u64 {
        let counter = self.counter;
        self.counter += 1;
        mixed::<f64>(
            self.origin.wrapping_add(counter.wrapping_mul(GAMMA)),
            self.key,
        )
    }

    /// The keys that distinguish the numbers of this path from those of others: origin, key and
    /// whether its normals have the opposite sign.
    pub fn keys(&self) -> [u64; 3] {
        [self.origin, self.key, self.flip]
    }

    /// The next three standard normals, made from two draws.
    #[inline(always)]
    pub fn three_normals(&mut self) -> [f64; 3] {
        let ([one, two], three) = (self.normal_pair(), self.normal());
        [one, two, three]
    }
}

/// The 64 random bits of a state of SplitMix64, with a second key.
#[inline(always)]
fn mixed<L: Lanes>(z: L::Bits, key: L::Bits) -> L::Bits {
    let z = L::xor(z, L::shr::<30>(z));
    let z = L::xor(L::mul_bits(z, L::splat_bits(0xBF58_476D_1CE4_E5B9)), key);
    let z = L::mul_bits(
        L::xor(z, L::shr::<27>(z)),
        L::splat_bits(0x94D0_49BB_1331_11EB),
    );
    L::xor(z, L::shr::<31>(z))
}

/// The random numbers of several paths in one macro step; in each lane they are those of
/// [`AddressedDraws`]. A draw does not change this value: the argument `after` is the number of
/// places after the next one.
#[derive(Clone, Copy)]
pub struct LaneDraws<L: Lanes> {
    /// The state of SplitMix64 at the next number of each path.
    state: L::Bits,
    key: L::Bits,
    flip: L::Bits,
}

impl<L: Lanes> LaneDraws<L> {
    /// The numbers of the paths with these keys ([`AddressedDraws::keys`]) from an address, macro
    /// step 2^32 + place, on.
    #[inline(always)]
    pub fn at([origin, key, flip]: [L::Bits; 3], address: u64) -> Self {
        LaneDraws {
            state: L::add_bits(origin, L::splat_bits(address.wrapping_mul(GAMMA))),
            key,
            flip,
        }
    }

    /// The same from a place on that may differ from path to path.
    #[inline(always)]
    pub fn at_places(keys: [L::Bits; 3], macro_step: u64, place: L::Bits) -> Self {
        let first = Self::at(keys, macro_step << 32);
        LaneDraws {
            state: L::add_bits(first.state, L::mul_bits(place, L::splat_bits(GAMMA))),
            ..first
        }
    }

    #[inline(always)]
    fn bits(&self, after: u64) -> L::Bits {
        mixed::<L>(
            L::add_bits(self.state, L::splat_bits(after.wrapping_mul(GAMMA))),
            self.key,
        )
    }

    /// [`AddressedDraws::normal`].
    #[inline(always)]
    pub fn normal(&self, cells: &LookupTable, after: u64) -> L {
        half_normals::<L>(cells, L::xor(self.bits(after), self.flip)) * SQRT_2
    }

    /// [`AddressedDraws::normal_pair`].
    #[inline(always)]
    pub fn normal_pair(&self, cells: &LookupTable, after: u64) -> [L; 2] {
        let bits = L::xor(self.bits(after), self.flip);
        [
            half_normals::<L>(cells, bits) * SQRT_2,
            half_normals::<L>(cells, L::rotate_left::<32>(bits)) * SQRT_2,
        ]
    }

    /// [`AddressedDraws::three_normals`].
    #[inline(always)]
    pub fn three_normals(&self, cells: &LookupTable, after: u64) -> [L; 3] {
        let [one, two] = self.normal_pair(cells, after);
        [one, two, self.normal(cells, after + 1)]
    }

    /// [`AddressedDraws::uniform`].
    #[inline(always)]
    pub fn uniform(&self, after: u64) -> L {
        (L::from_integers(L::shr::<11>(self.bits(after))) + 0.5) * (1.0 / 9_007_199_254_740_992.0)
    }
}
