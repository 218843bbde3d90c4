//! The random stream of a path: xoshiro256+, seeded from (seed, path number) alone.
//!
//! Blackman and Vigna (*Scrambled linear pseudorandom number generators*, ACM TOMS 47 (2021)) made
//! this generator for floating-point numbers: only its lowest three bits are weak. They do not
//! change a normal up to 7 sigma. In the second normal of a pair they are bits 32 to 34, where they
//! do not change its uniform number by more than 2^-29.
//!
//! The four state words of path p are the p-th outputs of four SplitMix64 sequences, whose origins
//! are the first four SplitMix64 outputs from the seed. So each word is a one-to-one function of
//! the path number in which every bit of the number changes about half the bits of the word. No two
//! paths of a run share a state, and neighbouring paths share no structure. With 2^256 states,
//! streams overlap only with a probability below paths^2 * steps / 2^256.

use super::mirror;
use super::normal::{cells, half_normals};
use crate::lanes::{InstructionSet, LaneProgram, Lanes, LookupTable};
use std::f64::consts::SQRT_2;

/// Increment of SplitMix64: 2^64 / golden ratio, odd.
pub(super) const GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

/// Output function of SplitMix64 (Stafford's variant 13 of the MurmurHash3 finaliser).
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Word `i` of those that seed the random numbers of a path: the output at position path + 1 of a
/// SplitMix64 sequence whose origin is the i-th output from the seed.
pub(super) fn path_word(seed: u64, path: u64, i: u64) -> u64 {
    let origin = mix(seed.wrapping_add((i + 1).wrapping_mul(GAMMA)));
    mix(origin.wrapping_add(path.wrapping_add(1).wrapping_mul(GAMMA)))
}

/// The random stream of one path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    state: [u64; 4],
    /// The bits of [`mirror::parts`].
    pub(super) flip: u64,
}

impl Stream {
    /// The stream of path `path` of the ensemble with this seed. With [`super::MIRROR`] in `path`,
    /// it is the stream of a mirror image.
    pub fn new(seed: u64, path: u64) -> Self {
        let (path, flip) = mirror::parts(path);
        Stream {
            state: std::array::from_fn(|i| path_word(seed, path, i as u64)),
            flip,
        }
    }

    /// The four state words.
    pub fn state(&self) -> [u64; 4] {
        self.state
    }

    /// The next 64 random bits.
    #[inline(always)]
    pub fn next_u64(&mut self) -> u64 {
        let s = &mut self.state;
        let result = s[0].wrapping_add(s[3]);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        result
    }
}

/// The streams of several paths, for drawing in lanes. Lane i is the stream of `paths[i]`; further
/// paths fill the lanes up to whole registers.
#[derive(Clone, Debug)]
pub struct LaneStreams {
    words: [Vec<u64>; 4],
    /// The bits of [`mirror::parts`], lane by lane.
    flips: Vec<u64>,
    /// Whether the next normal of a lane is the second of a pair.
    is_second: Vec<bool>,
}

impl LaneStreams {
    /// The streams of these paths, and of further paths up to `lanes` streams.
    pub fn new(seed: u64, paths: &[u64], lanes: usize) -> Self {
        let beyond = paths.last().map_or(0, |p| p.wrapping_add(1));
        let padded = paths
            .iter()
            .copied()
            .chain((0..).map(|i| beyond.wrapping_add(i)))
            .take(lanes);
        let mut words: [Vec<u64>; 4] = std::array::from_fn(|_| Vec::with_capacity(lanes));
        let mut flips = Vec::with_capacity(lanes);
        for path in padded {
            let stream = Stream::new(seed, path);
            for (word, s) in words.iter_mut().zip(stream.state) {
                word.push(s);
            }
            flips.push(stream.flip);
        }
        LaneStreams {
            words,
            flips,
            is_second: vec![false; lanes],
        }
    }

    /// The next `steps` standard normals of each lane, `[step][lane]`.
    pub fn normals(&mut self, steps: usize, instructions: InstructionSet) -> Vec<f64> {
        let mut normals = vec![0.0; steps * self.is_second.len()];
        instructions.run(&mut Fill {
            streams: self,
            normals: &mut normals,
        });
        normals
    }

    /// A copy of the streams of `R` registers of lanes, beginning at `lane`, to draw from.
    /// [`LaneStreams::put`] writes their state back.
    #[inline(always)]
    pub fn take<L: Lanes, const R: usize>(&self, lane: usize) -> LaneNormals<L, R> {
        let zero = L::splat_bits(0);
        let is_second = self.is_second[lane];
        let mut taken = LaneNormals {
            words: [[zero; 4]; R],
            flips: [zero; R],
            is_second,
            cells: cells(),
        };
        for r in 0..R {
            taken.flips[r] = L::load_bits(&self.flips[lane + r * L::WIDTH..]);
            for i in 0..4 {
                taken.words[r][i] = L::load_bits(&self.words[i][lane + r * L::WIDTH..]);
            }
        }
        taken
    }

    /// Writes back the state of the streams that were taken at `lane`.
    #[inline(always)]
    pub fn put<L: Lanes, const R: usize>(&mut self, lane: usize, taken: &LaneNormals<L, R>) {
        for r in 0..R {
            for i in 0..4 {
                L::store_bits(taken.words[r][i], &mut self.words[i][lane + r * L::WIDTH..]);
            }
        }
        self.is_second[lane..lane + R * L::WIDTH].fill(taken.is_second);
    }
}

/// The streams of `R` registers of lanes. They give normals divided by sqrt(2), in pairs as
/// [`Stream::normal_pair`] draws them.
#[derive(Clone, Copy)]
pub struct LaneNormals<L: Lanes, const R: usize> {
    words: [[L::Bits; 4]; R],
    flips: [L::Bits; R],
    is_second: bool,
    cells: &'static LookupTable,
}

impl<L: Lanes, const R: usize> LaneNormals<L, R> {
    /// The next normal of each lane, divided by sqrt(2).
    #[inline(always)]
    pub fn draw(&mut self) -> [L; R] {
        let mut normals = [L::splat(0.0); R];
        for ((normal, words), flip) in normals.iter_mut().zip(&mut self.words).zip(&self.flips) {
            let mut draw = L::xor(output::<L>(words), *flip);
            if self.is_second {
                draw = L::rotate_left::<32>(draw);
                *words = step::<L>(*words);
            }
            *normal = half_normals::<L>(self.cells, draw);
        }
        self.is_second = !self.is_second;
        normals
    }
}

struct Fill<'a> {
    streams: &'a mut LaneStreams,
    normals: &'a mut [f64],
}

impl LaneProgram for Fill<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let lanes = self.streams.is_second.len();
        for lane in (0..lanes).step_by(L::WIDTH) {
            let mut taken = self.streams.take::<L, 1>(lane);
            for row in self.normals.chunks_exact_mut(lanes) {
                taken.draw()[0]
                    .mul(L::splat(SQRT_2))
                    .store(&mut row[lane..]);
            }
            self.streams.put(lane, &taken);
        }
    }
}

/// The output of xoshiro256+ in a state.
#[inline(always)]
fn output<L: Lanes>([s0, _, _, s3]: &[L::Bits; 4]) -> L::Bits {
    L::add_bits(*s0, *s3)
}

/// The next state of xoshiro256+, as in [`Stream::next_u64`], with its exclusive-ors combined in
/// threes.
#[inline(always)]
fn step<L: Lanes>([s0, s1, s2, s3]: [L::Bits; 4]) -> [L::Bits; 4] {
    let t = L::shl::<17>(s1);
    let s3_s1 = L::xor(s3, s1);
    [
        L::xor(s0, s3_s1),
        L::xor3(s1, s2, s0),
        L::xor3(s2, s0, t),
        L::rotate_left::<45>(s3_s1),
    ]
}
