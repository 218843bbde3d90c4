//! The stream of a path: xoshiro256+, seeded from (seed, path number) alone.
//!
//! Of this family it is the member made for floating-point numbers: only its lowest three bits are weak, which a normal does
//! not see before 7 sigma. Blackman and Vigna, *Scrambled linear pseudorandom number generators*, ACM TOMS 47 (2021). The four state words of path
//! p are the p-th outputs of four SplitMix64 sequences whose origins are the first four SplitMix64 outputs from the
//! seed. Each word is thus a bijective, avalanching function of the path number: no two paths of a run share a state,
//! neighbouring paths share no structure, and 2^256 states leave overlaps of streams out of reach
//! (probability below paths^2 * steps / 2^256).

use super::normal::half_normals;
use crate::lanes::Lanes;

/// Increment of SplitMix64: 2^64 / golden ratio, odd.
const GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

/// Output function of SplitMix64 (Stafford's variant 13 of the MurmurHash3 finaliser).
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The random stream of one path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stream {
    state: [u64; 4],
}

impl Stream {
    /// The stream of path `path` of the ensemble with this seed.
    pub fn new(seed: u64, path: u64) -> Self {
        let word = |i: u64| {
            let origin = mix(seed.wrapping_add((i + 1).wrapping_mul(GAMMA)));
            mix(origin.wrapping_add(path.wrapping_add(1).wrapping_mul(GAMMA)))
        };
        Stream { state: [word(0), word(1), word(2), word(3)] }
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

    /// The next standard normal.
    #[inline(always)]
    pub fn normal(&mut self) -> f64 {
        super::standard_normal(self.next_u64())
    }

    /// A uniform number in (0, 1): the midpoint of one of 2^53 cells.
    #[inline(always)]
    pub fn uniform(&mut self) -> f64 {
        ((self.next_u64() >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0)
    }
}

/// The streams of several paths, advanced together. Lane i is the stream of `paths[i]`; the lanes are padded to whole
/// registers with streams of paths beyond the last.
#[derive(Clone, Debug)]
pub struct LaneStreams {
    words: [Vec<u64>; 4],
}

impl LaneStreams {
    /// The streams of these paths, and of more paths until there are `lanes`.
    pub fn new(seed: u64, paths: &[u64], lanes: usize) -> Self {
        let beyond = paths.last().map_or(0, |p| p.wrapping_add(1));
        let padded = paths.iter().copied().chain((0..).map(|i| beyond.wrapping_add(i))).take(lanes);
        let mut words: [Vec<u64>; 4] = std::array::from_fn(|_| Vec::with_capacity(lanes));
        for path in padded {
            let state = Stream::new(seed, path).state();
            for (word, s) in words.iter_mut().zip(state) {
                word.push(s);
            }
        }
        LaneStreams { words }
    }

    /// One normal from each lane.
    pub fn next_normals(&mut self) -> Vec<f64> {
        (0..self.words[0].len())
            .map(|lane| {
                let mut stream = Stream { state: std::array::from_fn(|i| self.words[i][lane]) };
                let z = super::standard_normal(stream.next_u64());
                for (word, s) in self.words.iter_mut().zip(stream.state) {
                    word[lane] = s;
                }
                z
            })
            .collect()
    }

    /// Draw `steps` normals from each of the `L::WIDTH` lanes that start at `lane`: the n-th of them goes to
    /// `tile[n * stride ..]`.
    #[inline(always)]
    pub fn fill_normals<L: Lanes>(&mut self, lane: usize, steps: usize, tile: &mut [f64], stride: usize) {
        let mut s: [L::Bits; 4] = std::array::from_fn(|i| L::load_bits(&self.words[i][lane..]));
        for row in tile.chunks_mut(stride).take(steps) {
            half_normals::<L>(next::<L>(&mut s)).store(row);
        }
        for (word, s) in self.words.iter_mut().zip(s) {
            L::store_bits(s, &mut word[lane..]);
        }
    }

    /// The increments of an autoregression v' = decay v + xi over `refinement` steps at once: `tile[n * stride ..]` gets
    /// sum of decay^(refinement - 1 - i) xi_i over the next `refinement` normals xi_0, xi_1, ... of each lane.
    #[inline(always)]
    pub fn fill_joined_normals<L: Lanes>(
        &mut self,
        lane: usize,
        steps: usize,
        (refinement, decay): (usize, f64),
        tile: &mut [f64],
        stride: usize,
    ) {
        let decay = L::splat(decay);
        let mut s: [L::Bits; 4] = std::array::from_fn(|i| L::load_bits(&self.words[i][lane..]));
        for row in tile.chunks_mut(stride).take(steps) {
            let mut joined = L::splat(0.0);
            for _ in 0..refinement {
                joined = decay.mul_add(joined, half_normals::<L>(next::<L>(&mut s)));
            }
            joined.store(row);
        }
        for (word, s) in self.words.iter_mut().zip(s) {
            L::store_bits(s, &mut word[lane..]);
        }
    }
}

/// xoshiro256+, lane by lane; the order of [`Stream::next_u64`] with its exclusive-ors joined by threes.
#[inline(always)]
fn next<L: Lanes>(s: &mut [L::Bits; 4]) -> L::Bits {
    let result = L::add_bits(s[0], s[3]);
    let t = L::shl::<17>(s[1]);
    let [s0, s1, s2, s3] = *s;
    let s3_s1 = L::xor(s3, s1);
    *s = [L::xor(s0, s3_s1), L::xor3(s1, s2, s0), L::xor3(s2, s0, t), L::rotate_left::<45>(s3_s1)];
    result
}
