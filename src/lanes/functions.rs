//! The few elementary functions that schemes evaluate in lanes. They use arithmetic alone, so that
//! they have the same bits on every instruction set.

use super::Lanes;

/// cosh y and sinh(y)/y as functions of y^2 <= 1, correct up to rounding.
#[inline(always)]
pub fn cosh_and_sinh_over<L: Lanes>(y2: L) -> (L, L) {
    let one = L::splat(1.0);
    let (mut cosh, mut sinh) = (one, one);
    // The series 1 + y^2/(n (n - 1)) (1 + ..) is summed from its last term on. The first omitted
    // term is below 1/18!.
    for n in [16.0, 14.0, 12.0, 10.0, 8.0, 6.0, 4.0, 2.0] {
        cosh = one + y2 * (cosh * (1.0 / (n * (n - 1.0))));
        sinh = one + y2 * (sinh * (1.0 / (n * (n + 1.0))));
    }
    (cosh, sinh)
}

/// cos and sin of an angle with |angle| <= 1, correct up to rounding.
#[inline(always)]
pub fn small_unit<L: Lanes>(angle: L) -> (L, L) {
    let (square, one) = (angle * angle, L::splat(1.0));
    let (mut cos, mut sin) = (one, one);
    // The series 1 - angle^2/(n (n - 1)) (1 - ..) is summed from its last term on. The first
    // omitted term is below 1/18!.
    for n in [16.0, 14.0, 12.0, 10.0, 8.0, 6.0, 4.0, 2.0] {
        cos = one - square * (cos * (1.0 / (n * (n - 1.0))));
        sin = one - square * (sin * (1.0 / (n * (n + 1.0))));
    }
    (cos, angle * sin)
}

/// 3 2^51. Adding and then subtracting it rounds a number below 2^51 to the nearest integer; the
/// lower bits of the sum hold that integer in two's complement.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// ln 2 in two parts. The product of the upper part and an integer below 2^20 is exact.
const LN2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// e^x for x <= 1, with an error of at most two roundings. Below x = -700 the result is e^-700,
/// which is 1e-304.
#[inline(always)]
pub fn exp<L: Lanes>(x: L) -> L {
    let x = L::select(x.gt(L::splat(-700.0)), x, L::splat(-700.0));
    let shifted = x * std::f64::consts::LOG2_E + ROUNDING;
    let twos = shifted - ROUNDING;
    let r = (x - twos * LN2[0]) - twos * LN2[1];
    // The first omitted term is below 1e-17, because |r| <= ln(2)/2.
    let mut sum = L::splat(1.0);
    for n in [13.0, 12.0, 11.0, 10.0, 9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0] {
        sum = sum * r * (1.0 / n) + 1.0;
    }
    let sum = sum * r + 1.0;
    L::from_bits(L::add_bits(sum.to_bits(), L::shl::<52>(shifted.to_bits())))
}

/// ln(1 + z) for 0 <= z < 2^1000, with an error of a few roundings.
#[inline(always)]
pub fn log1p<L: Lanes>(z: L) -> L {
    let one = L::splat(1.0);
    let u = z + 1.0;
    // The part of z that was lost when 1 + z was rounded.
    let lost = z - (u - 1.0);
    // u = m 2^k with m between 1/sqrt 2 and sqrt 2.
    let above = L::add_bits(u.to_bits(), L::splat_bits(ONE_BITS.wrapping_sub(ROOT_HALF_BITS)));
    let k = L::from_integers(L::add_bits(L::shr::<52>(above), L::splat_bits(1023u64.wrapping_neg())));
    let m = L::from_bits(L::add_bits(L::keep_and_set(above, (1 << 52) - 1, 0), L::splat_bits(ROOT_HALF_BITS)));
    let f = m - 1.0;
    let s = f / (f + 2.0);
    let s2 = s * s;
    // ln m = 2 s (1 + s^2/3 + ..) with |s| <= 0.172. The first omitted term is below 1e-18.
    let mut sum = L::splat(1.0 / 23.0);
    for n in [21.0, 19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0] {
        sum = sum * s2 + 1.0 / n;
    }
    let rest = s * s2 * sum * 2.0;
    // f = 2 s + f s, so that the leading term of the sum is f itself, which is exact.
    let ln = f - (f * s - rest);
    let correction = one / u * lost;
    k * LN2[0] + (ln + (k * LN2[1] + correction))
}

const ONE_BITS: u64 = 0x3FF0_0000_0000_0000;
const ROOT_HALF_BITS: u64 = 0x3FE6_A09E_667F_3BCD;

#[cfg(test)]
mod tests {
    use super::*;

    /// The functions agree with libm, whose error is at most one rounding, to within three
    /// roundings at 1e5 arguments that span eighteen powers of ten.
    #[test]
    fn functions_agree_with_libm() {
        let mut worst = [0.0f64; 5];
        for i in 0..100_000 {
            let size = 10f64.powf(-15.0 + 18.0 * f64::from(i) / 1e5);
            let off = |ours: f64, theirs: f64| (ours / theirs - 1.0).abs() / f64::EPSILON;
            if size < 700.0 {
                worst[0] = worst[0].max(off(exp(-size), libm::exp(-size)));
            }
            worst[1] = worst[1].max(off(log1p(size), libm::log1p(size)));
            if size <= 1.0 {
                let (cosh, sinh) = cosh_and_sinh_over(size * size);
                let (cos, sin) = small_unit(size);
                worst[2] = worst[2].max(off(cosh, libm::cosh(size)).max(off(size * sinh, libm::sinh(size))));
                worst[3] = worst[3].max(off(cos, libm::cos(size)).max(off(sin, libm::sin(size))));
                worst[4] = worst[4].max(off(exp(size), libm::exp(size)));
            }
        }
        println!("{worst:?}");
        assert!(worst.iter().all(|&roundings| roundings > 0.0 && roundings <= 3.0), "{worst:?}");
        assert_eq!((exp(0.0), log1p(0.0)), (1.0, 0.0));
        assert!(exp(-1e4) < 1e-300 && exp(f64::NEG_INFINITY) < 1e-300);
    }
}
