//! The lanes of two registers as one.
//!
//! Four lanes at a time are few where the work on them is long, as in an event-driven cell: most of
//! it is then a chain of operations that wait for each other, and the management of a register is
//! shared by four paths only. A pair has two such chains, and shares the management among eight.

use super::{Lanes, ROW, Row, Table};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The lanes of the first register, and then those of the second. They are four each at most, so
/// that a pair has no more lanes than a [`Row`] has places.
#[derive(Clone, Copy)]
pub struct Pair<L>(L, L);

/// Implements operators between two pairs.
macro_rules! operators {
    ($($Trait:ident $name:ident)+) => {
        $(
            impl<L: Lanes> $Trait for Pair<L> {
                type Output = Self;
                #[inline(always)]
                fn $name(self, other: Self) -> Self {
                    Pair($Trait::$name(self.0, other.0), $Trait::$name(self.1, other.1))
                }
            }
        )+
    };
}
operators! { Add add Sub sub Mul mul Div div }

/// Implements operators between a pair and one number for every lane.
macro_rules! operators_with_a_number {
    ($($Trait:ident $name:ident)+) => {
        $(
            impl<L: Lanes> $Trait<f64> for Pair<L> {
                type Output = Self;
                #[inline(always)]
                fn $name(self, other: f64) -> Self {
                    Pair($Trait::<f64>::$name(self.0, other), $Trait::<f64>::$name(self.1, other))
                }
            }
        )+
    };
}
operators_with_a_number! { Add add Sub sub Mul mul }

impl<L: Lanes> Neg for Pair<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Pair(-self.0, -self.1)
    }
}

/// The rows of the second register, at the front.
#[inline(always)]
fn second<L: Lanes>(rows: &[u32; ROW]) -> [u32; ROW] {
    let mut second = [0; ROW];
    second[..L::WIDTH].copy_from_slice(&rows[L::WIDTH..2 * L::WIDTH]);
    second
}

/// Columns of both registers as columns of pairs. This is written out, because closures would not
/// be compiled for the instruction set.
#[inline(always)]
fn zip<L: Lanes>(a: [L; ROW], b: [L; ROW]) -> [Pair<L>; ROW] {
    [
        Pair(a[0], b[0]),
        Pair(a[1], b[1]),
        Pair(a[2], b[2]),
        Pair(a[3], b[3]),
        Pair(a[4], b[4]),
        Pair(a[5], b[5]),
        Pair(a[6], b[6]),
        Pair(a[7], b[7]),
    ]
}

/// The columns of both registers.
#[inline(always)]
fn unzip<L: Lanes>(c: [Pair<L>; ROW]) -> [[L; ROW]; 2] {
    [
        [c[0].0, c[1].0, c[2].0, c[3].0, c[4].0, c[5].0, c[6].0, c[7].0],
        [c[0].1, c[1].1, c[2].1, c[3].1, c[4].1, c[5].1, c[6].1, c[7].1],
    ]
}

impl<L: Lanes> Lanes for Pair<L> {
    const WIDTH: usize = 2 * L::WIDTH;
    type Bits = (L::Bits, L::Bits);
    type Mask = (L::Mask, L::Mask);

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Pair(L::splat(value), L::splat(value))
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Pair(L::load(from), L::load(&from[L::WIDTH..]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        self.0.store(to);
        self.1.store(&mut to[L::WIDTH..]);
    }
    #[inline(always)]
    fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW] {
        zip(L::gather_rows(table, rows), L::gather_rows(table, &second::<L>(rows)))
    }
    #[inline(always)]
    fn scatter_rows(columns: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]) {
        let [low, high] = unzip(columns);
        L::scatter_rows(low, table, rows);
        L::scatter_rows(high, table, &second::<L>(rows));
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Pair(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Pair(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn compress(entries: &[u32; ROW], lanes: u32) -> [u32; ROW] {
        L::compress(entries, lanes)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Pair(self.0.mul_add(factor.0, term.0), self.1.mul_add(factor.1, term.1))
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        (self.0.gt(other.0), self.1.gt(other.1))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        (self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        (self.0.ge(other.0), self.1.ge(other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        (self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        Pair(L::select(mask.0, a.0, b.0), L::select(mask.1, a.1, b.1))
    }
    #[inline(always)]
    fn either(up: Self::Mask, a: Self, down: Self::Mask, b: Self) -> Self {
        Pair(L::either(up.0, a.0, down.0, b.0), L::either(up.1, a.1, down.1, b.1))
    }
    #[inline(always)]
    fn where_zero(self, zero: Self, other: Self) -> Self {
        Pair(self.0.where_zero(zero.0, other.0), self.1.where_zero(zero.1, other.1))
    }
    #[inline(always)]
    fn add_where(self, other: Self, keep: Self::Mask) -> Self {
        Pair(self.0.add_where(other.0, keep.0), self.1.add_where(other.1, keep.1))
    }
    #[inline(always)]
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        (L::or(a.0, b.0), L::or(a.1, b.1))
    }
    #[inline(always)]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        (L::and(a.0, b.0), L::and(a.1, b.1))
    }
    #[inline(always)]
    fn not(mask: Self::Mask) -> Self::Mask {
        (L::not(mask.0), L::not(mask.1))
    }
    #[inline(always)]
    fn always() -> Self::Mask {
        (L::always(), L::always())
    }
    #[inline(always)]
    fn not_beyond(self, least: Self, most: Self, among: Self::Mask) -> Self::Mask {
        (self.0.not_beyond(least.0, most.0, among.0), self.1.not_beyond(least.1, most.1, among.1))
    }
    #[inline(always)]
    fn bitmask(mask: Self::Mask) -> u32 {
        L::bitmask(mask.0) | L::bitmask(mask.1) << L::WIDTH
    }
    #[inline(always)]
    fn lookup(table: &Table, key: Self::Bits) -> Self::Bits {
        (L::lookup(table, key.0), L::lookup(table, key.1))
    }
    #[inline(always)]
    fn to_bits(self) -> Self::Bits {
        (self.0.to_bits(), self.1.to_bits())
    }
    #[inline(always)]
    fn from_bits(bits: Self::Bits) -> Self {
        Pair(L::from_bits(bits.0), L::from_bits(bits.1))
    }
    #[inline(always)]
    fn splat_bits(value: u64) -> Self::Bits {
        (L::splat_bits(value), L::splat_bits(value))
    }
    #[inline(always)]
    fn load_bits(from: &[u64]) -> Self::Bits {
        (L::load_bits(from), L::load_bits(&from[L::WIDTH..]))
    }
    #[inline(always)]
    fn store_bits(bits: Self::Bits, to: &mut [u64]) {
        L::store_bits(bits.0, to);
        L::store_bits(bits.1, &mut to[L::WIDTH..]);
    }
    #[inline(always)]
    fn add_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits {
        (L::add_bits(a.0, b.0), L::add_bits(a.1, b.1))
    }
    #[inline(always)]
    fn mul_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits {
        (L::mul_bits(a.0, b.0), L::mul_bits(a.1, b.1))
    }
    #[inline(always)]
    fn xor(a: Self::Bits, b: Self::Bits) -> Self::Bits {
        (L::xor(a.0, b.0), L::xor(a.1, b.1))
    }
    #[inline(always)]
    fn xor3(a: Self::Bits, b: Self::Bits, c: Self::Bits) -> Self::Bits {
        (L::xor3(a.0, b.0, c.0), L::xor3(a.1, b.1, c.1))
    }
    #[inline(always)]
    fn keep_and_set(bits: Self::Bits, keep: u64, set: u64) -> Self::Bits {
        (L::keep_and_set(bits.0, keep, set), L::keep_and_set(bits.1, keep, set))
    }
    #[inline(always)]
    fn from_integers(bits: Self::Bits) -> Self {
        Pair(L::from_integers(bits.0), L::from_integers(bits.1))
    }
    #[inline(always)]
    fn shr<const N: u32>(bits: Self::Bits) -> Self::Bits {
        (L::shr::<N>(bits.0), L::shr::<N>(bits.1))
    }
    #[inline(always)]
    fn shl<const N: u32>(bits: Self::Bits) -> Self::Bits {
        (L::shl::<N>(bits.0), L::shl::<N>(bits.1))
    }
    #[inline(always)]
    fn rotate_left<const N: i32>(bits: Self::Bits) -> Self::Bits {
        (L::rotate_left::<N>(bits.0), L::rotate_left::<N>(bits.1))
    }
}
