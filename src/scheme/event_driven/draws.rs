//! The random numbers of one path: its stream, and nothing else.

use crate::noise::Stream;

/// Uniform and standard normal numbers from the stream of one path.
#[derive(Clone, Debug)]
pub struct Draws(Stream);

impl Draws {
    /// Those of path `path` of the ensemble with this seed.
    pub fn new(seed: u64, path: u64) -> Self {
        Draws(Stream::new(seed, path))
    }

    /// Uniform in (0, 1).
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        self.0.uniform()
    }

    /// Standard normal, one draw of the stream each.
    #[inline]
    pub fn normal(&mut self) -> f64 {
        standard_normal(self.0.next_u64())
    }
}

/// Wichura's algorithm AS 241 (Applied Statistics 37, 1988), PPND16: relative accuracy 1e-16.
#[inline]
fn standard_normal(bits: u64) -> f64 {
    let p = ((bits >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0);
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        return q * ratio(0.180625 - q * q, &CENTRE.0, &CENTRE.1);
    }
    let r = (-libm::log(if q < 0.0 { p } else { 1.0 - p })).sqrt();
    let (shift, (above, below)) = if r <= 5.0 { (1.6, &MIDDLE) } else { (5.0, &TAIL) };
    ratio(r - shift, above, below).copysign(q)
}

fn ratio(r: f64, above: &[f64; 8], below: &[f64; 8]) -> f64 {
    let horner = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, &c| sum * r + c);
    horner(above) / horner(below)
}

type Rational = ([f64; 8], [f64; 8]);

const CENTRE: Rational = (
    [
        3.387_132_872_796_366_5,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_854e3,
    ],
);
const MIDDLE: Rational = (
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
);
const TAIL: Rational = (
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_invert_their_distribution_function() {
        // Phi(-1), Phi(-4), Phi(-7) to 16 digits; p is known within a cell of 2^-53, z within that over the density.
        let cases: [(f64, f64); 3] =
            [(0.158_655_253_931_457_05, -1.0), (3.167_124_183_311_992e-5, -4.0), (1.279_812_543_885_835e-12, -7.0)];
        for (p, z) in cases {
            let bits = (p * 9_007_199_254_740_992.0) as u64;
            let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
            assert!((standard_normal(bits << 11) - z).abs() < 2.3e-16 / density + 1e-15, "{z}");
        }
    }
}
