//! The few elementary functions that schemes evaluate in lanes. They use arithmetic alone, so that
//! they have the same bits on every instruction set.

use super::Lanes;

/// c0 + c1 x + .. + c7 x^7, given x, x^2 and x^4.
///
/// The sum follows Estrin's scheme, in which three operations wait for each other instead of seven:
/// in lanes, most of the time is spent waiting for such chains.
#[inline(always)]
fn eight_terms<L: Lanes>(powers: [L; 3], [c0, c1, c2, c3, c4, c5, c6, c7]: [f64; 8]) -> L {
    let high = four_terms(powers, [c4, c5, c6, c7]);
    high.mul_add(powers[2], four_terms(powers, [c0, c1, c2, c3]))
}

/// c0 + c1 x + c2 x^2 + c3 x^3 likewise.
#[inline(always)]
fn four_terms<L: Lanes>([x, x2, _]: [L; 3], [c0, c1, c2, c3]: [f64; 4]) -> L {
    let high = L::splat(c3).mul_add(x, L::splat(c2));
    high.mul_add(x2, L::splat(c1).mul_add(x, L::splat(c0)))
}

/// x, x^2 and x^4.
#[inline(always)]
fn powers<L: Lanes>(x: L) -> [L; 3] {
    let x2 = x * x;
    [x, x2, x2 * x2]
}

/// first!/(first + 2)!, first!/(first + 4)!, .., which are eight coefficients of a series in every
/// second power, with alternating signs where `sign` is -1.
const fn every_second(first: u32, sign: f64) -> [f64; 8] {
    let (mut all, mut i, mut term, mut n) = ([0.0; 8], 0, 1.0, first);
    while i < 8 {
        term *= sign / ((n + 1) as f64 * (n + 2) as f64);
        all[i] = term;
        n += 2;
        i += 1;
    }
    all
}

/// cosh y and sinh(y)/y as functions of y^2 <= 1, correct up to rounding.
#[inline(always)]
pub fn cosh_and_sinh_over<L: Lanes>(y2: L) -> (L, L) {
    const COSH: [f64; 8] = every_second(0, 1.0);
    const SINH: [f64; 8] = every_second(1, 1.0);
    // The first omitted term is below 1/18!.
    let (one, powers) = (L::splat(1.0), powers(y2));
    (
        eight_terms(powers, COSH).mul_add(y2, one),
        eight_terms(powers, SINH).mul_add(y2, one),
    )
}

/// cos and sin of an angle with |angle| <= 1, correct up to rounding.
#[inline(always)]
pub fn small_unit<L: Lanes>(angle: L) -> (L, L) {
    const COS: [f64; 8] = every_second(0, -1.0);
    const SIN: [f64; 8] = every_second(1, -1.0);
    // The first omitted term is below 1/18!.
    let (square, one) = (angle * angle, L::splat(1.0));
    let powers = powers(square);
    let sin = eight_terms(powers, SIN).mul_add(square, one);
    (eight_terms(powers, COS).mul_add(square, one), angle * sin)
}

/// 3 2^51. Adding and then subtracting it rounds a number below 2^51 to the nearest integer; the
/// lower bits of the sum hold that integer in two's complement.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// ln 2 in two parts. The product of the upper part and an integer below 2^20 is exact.
const LN2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// e^x for x <= 700, with an error of at most two roundings. Below x = -700 the result is e^-700,
/// which is 1e-304.
#[inline(always)]
pub fn exp<L: Lanes>(x: L) -> L {
    let x = L::select(x.gt(L::splat(-700.0)), x, L::splat(-700.0));
    let shifted = x.mul_add(L::splat(std::f64::consts::LOG2_E), L::splat(ROUNDING));
    let twos = shifted - ROUNDING;
    let r = twos.mul_add(L::splat(-LN2[1]), twos.mul_add(L::splat(-LN2[0]), x));
    // 1 + r + r^2 (1/2! + r/3! + ..). The first omitted term is below 1e-17, because |r| is at
    // most ln(2)/2.
    const LOW: [f64; 8] = inverse_factorials(2);
    const HIGH: [f64; 4] = inverse_factorials(10);
    let powers = powers(r);
    let high = four_terms(powers, HIGH);
    let rest = high.mul_add(powers[2] * powers[2], eight_terms(powers, LOW));
    let sum = rest.mul_add(powers[1], r) + 1.0;
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
    let above = L::add_bits(
        u.to_bits(),
        L::splat_bits(ONE_BITS.wrapping_sub(ROOT_HALF_BITS)),
    );
    let k = L::from_integers(L::add_bits(
        L::shr::<52>(above),
        L::splat_bits(1023u64.wrapping_neg()),
    ));
    let m = L::from_bits(L::add_bits(
        L::keep_and_set(above, (1 << 52) - 1, 0),
        L::splat_bits(ROOT_HALF_BITS),
    ));
    let f = m - 1.0;
    let s = f / (f + 2.0);
    let s2 = s * s;
    // ln m = 2 s (1 + s^2/3 + ..) with |s| <= 0.172. The first omitted term is below 1e-18.
    const LOW: [f64; 8] = inverse_odds(3);
    const HIGH: [f64; 4] = inverse_odds(19);
    let powers = powers(s2);
    let sum = four_terms(powers, HIGH).mul_add(powers[2] * powers[2], eight_terms(powers, LOW));
    let rest = s * s2 * sum * 2.0;
    // f = 2 s + f s, so that the leading term of the sum is f itself, which is exact.
    let ln = f - (f * s - rest);
    let correction = one / u * lost;
    k * LN2[0] + (ln + (k * LN2[1] + correction))
}

/// 1/first!, 1/(first + 1)!, ..
const fn inverse_factorials<const N: usize>(first: u32) -> [f64; N] {
    let (mut all, mut factorial, mut n) = ([0.0; N], 1.0, 1);
    while n < first + N as u32 {
        factorial *= n as f64;
        if n >= first {
            all[(n - first) as usize] = 1.0 / factorial;
        }
        n += 1;
    }
    all
}

/// 1/first, 1/(first + 2), ..
const fn inverse_odds<const N: usize>(first: u32) -> [f64; N] {
    let (mut all, mut i) = ([0.0; N], 0);
    while i < N {
        all[i] = 1.0 / (first as f64 + 2.0 * i as f64);
        i += 1;
    }
    all
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
                worst[2] = worst[2]
                    .max(off(cosh, libm::cosh(size)).max(off(size * sinh, libm::sinh(size))));
                worst[3] = worst[3].max(off(cos, libm::cos(size)).max(off(sin, libm::sin(size))));
                worst[4] = worst[4].max(off(exp(size), libm::exp(size)));
            }
        }
        println!("{worst:?}");
        assert!(
            worst
                .iter()
                .all(|&roundings| roundings > 0.0 && roundings <= 3.0),
            "{worst:?}"
        );
        assert_eq!((exp(0.0), log1p(0.0)), (1.0, 0.0));
        assert!(exp(-1e4) < 1e-300 && exp(f64::NEG_INFINITY) < 1e-300);
    }
}
