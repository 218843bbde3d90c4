//! The stream of a path: xoshiro256++, seeded from (seed, path number) alone.
//!
//! Blackman and Vigna, *Scrambled linear pseudorandom number generators*, ACM TOMS 47 (2021). The four state words of path
//! p are the p-th outputs of four SplitMix64 sequences whose origins are the first four SplitMix64 outputs from the
//! seed. Each word is thus a bijective, avalanching function of the path number: no two paths of a run share a state,
//! neighbouring paths share no structure, and 2^256 states leave overlaps of streams out of reach
//! (probability below paths^2 * steps / 2^256).

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
    pub fn next_u64(&mut self) -> u64 {
        let s = &mut self.state;
        let result = s[0].wrapping_add(s[3]).rotate_left(23).wrapping_add(s[0]);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        result
    }

    /// A uniform number in (0, 1): the midpoint of one of 2^53 cells.
    pub fn uniform(&mut self) -> f64 {
        ((self.next_u64() >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0)
    }
}
