//! The operations of an expression. None of them depends on the lanes: they are correctly rounded,
//! computed with the same operations in each lane, or by `libm` lane by lane.

use crate::lanes::{Lanes, ROW, exp};

/// An operation on one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Unary {
    Negative,
    Abs,
    Sign,
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Tan,
    Atan,
    Tanh,
}

impl Unary {
    pub fn function(self) -> fn(f64) -> f64 {
        match self {
            Unary::Negative => |a| -a,
            Unary::Abs => f64::abs,
            Unary::Sign => sign,
            Unary::Sqrt => f64::sqrt,
            Unary::Exp => exponential_of_one,
            Unary::Log => libm::log,
            Unary::Sin => libm::sin,
            Unary::Cos => libm::cos,
            Unary::Tan => libm::tan,
            Unary::Atan => libm::atan,
            Unary::Tanh => libm::tanh,
        }
    }
}

/// An operation on two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    Power,
}

impl Binary {
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Min => least(a, b),
            Binary::Max => greatest(a, b),
            Binary::Power => libm::pow(a, b),
        }
    }
}

/// a to a whole power other than 0, by squaring.
pub(super) fn whole_power(a: f64, power: i32) -> f64 {
    let (mut square, mut rest, mut product) = (a, power.unsigned_abs(), None);
    while rest > 0 {
        if rest & 1 == 1 {
            product = Some(product.map_or(square, |product: f64| product * square));
        }
        square *= square;
        rest >>= 1;
    }
    let product = product.unwrap_or(1.0);
    if power < 0 { 1.0 / product } else { product }
}

/// -1, 0 or 1.
#[inline(always)]
pub(super) fn sign<L: Lanes>(a: L) -> L {
    let zero = L::splat(0.0);
    L::select(
        a.gt(zero),
        L::splat(1.0),
        L::select(a.lt(zero), L::splat(-1.0), a.abs()),
    )
}

/// The smaller number; NaN if one of them is NaN.
#[inline(always)]
pub(super) fn least<L: Lanes>(a: L, b: L) -> L {
    L::select(a.lt(b), a, L::select(b.le(a), b, a + b))
}

/// The larger number; NaN if one of them is NaN.
#[inline(always)]
pub(super) fn greatest<L: Lanes>(a: L, b: L) -> L {
    L::select(a.gt(b), a, L::select(b.ge(a), b, a + b))
}

/// e^a, with an error of at most two roundings.
#[inline(always)]
pub(super) fn exponential<L: Lanes>(a: L) -> L {
    let is_usual = a.abs().lt(L::splat(USUAL_EXPONENT));
    if L::bitmask(is_usual) == L::bitmask(L::always()) {
        exp(a)
    } else {
        each(a, exponential_of_one)
    }
}

fn exponential_of_one(a: f64) -> f64 {
    if a.abs() < USUAL_EXPONENT {
        exp(a)
    } else {
        libm::exp(a)
    }
}

/// The exponents for which lanes compute e^a.
const USUAL_EXPONENT: f64 = 700.0;

/// The function in each lane.
#[inline(always)]
pub(super) fn each<L: Lanes>(a: L, function: fn(f64) -> f64) -> L {
    let mut lanes = [0.0; ROW];
    a.store(&mut lanes);
    for lane in &mut lanes[..L::WIDTH] {
        *lane = function(*lane);
    }
    L::load(&lanes)
}

/// a^b in each lane.
#[inline(always)]
pub(super) fn power<L: Lanes>(a: L, b: L) -> L {
    let (mut bases, mut exponents) = ([0.0; ROW], [0.0; ROW]);
    a.store(&mut bases);
    b.store(&mut exponents);
    for (base, exponent) in bases[..L::WIDTH].iter_mut().zip(exponents) {
        *base = libm::pow(*base, exponent);
    }
    L::load(&bases)
}
