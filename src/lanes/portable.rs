//! Four lanes in plain Rust, for processors without the wide instruction sets.

use super::{KEY_SHIFT, Lanes, ROW, Row, Table};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Four numbers side by side.
#[derive(Clone, Copy, Debug)]
pub struct Portable([f64; 4]);

#[inline(always)]
fn zip<T: Copy, U: Copy, R>(a: [T; 4], b: [U; 4], f: impl Fn(T, U) -> R) -> [R; 4] {
    std::array::from_fn(|i| f(a[i], b[i]))
}

super::arithmetic! { Portable,
    Add add(a, b) { Portable(zip(a.0, b.0, |a, b| a + b)) }
    Sub sub(a, b) { Portable(zip(a.0, b.0, |a, b| a - b)) }
    Mul mul(a, b) { Portable(zip(a.0, b.0, |a, b| a * b)) }
    Div div(a, b) { Portable(zip(a.0, b.0, |a, b| a / b)) }
}

impl Neg for Portable {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Portable(self.0.map(|a| -a))
    }
}

impl Lanes for Portable {
    const WIDTH: usize = 4;
    type Bits = [u64; 4];
    type Mask = [bool; 4];

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Portable([value; 4])
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Portable(std::array::from_fn(|i| from[i]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..4].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW] {
        let rows: [usize; 4] = std::array::from_fn(|i| rows[i] as usize);
        std::array::from_fn(|column| Portable(rows.map(|row| table[row].0[column])))
    }
    #[inline(always)]
    fn scatter_rows(columns: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]) {
        for (i, &row) in rows[..4].iter().enumerate() {
            table[row as usize] = Row(columns.map(|column| column.0[i]));
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Portable(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Portable(self.0.map(f64::abs))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Portable(std::array::from_fn(|i| self.0[i].mul_add(factor.0[i], term.0[i])))
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        zip(self.0, other.0, |a, b| a > b)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        zip(self.0, other.0, |a, b| a < b)
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        zip(self.0, other.0, |a, b| a >= b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        zip(self.0, other.0, |a, b| a <= b)
    }
    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        Portable(std::array::from_fn(|i| if mask[i] { a.0[i] } else { b.0[i] }))
    }
    #[inline(always)]
    fn either(up: Self::Mask, a: Self, down: Self::Mask, b: Self) -> Self {
        Portable(std::array::from_fn(|i| match (up[i], down[i]) {
            (true, _) => a.0[i],
            (_, true) => b.0[i],
            _ => 0.0,
        }))
    }
    #[inline(always)]
    fn where_zero(self, zero: Self, other: Self) -> Self {
        Portable(std::array::from_fn(|i| if self.0[i] == 0.0 { zero.0[i] } else { other.0[i] }))
    }
    #[inline(always)]
    fn add_where(self, other: Self, keep: Self::Mask) -> Self {
        Portable(std::array::from_fn(|i| if keep[i] { self.0[i] + other.0[i] } else { 0.0 }))
    }
    #[inline(always)]
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        zip(a, b, |a, b| a || b)
    }
    #[inline(always)]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        zip(a, b, |a, b| a && b)
    }
    #[inline(always)]
    fn not(mask: Self::Mask) -> Self::Mask {
        mask.map(|yes| !yes)
    }
    #[inline(always)]
    fn always() -> Self::Mask {
        [true; 4]
    }
    #[inline(always)]
    fn not_beyond(self, least: Self, most: Self, among: Self::Mask) -> Self::Mask {
        std::array::from_fn(|i| among[i] && !(self.0[i] < least.0[i] || self.0[i] > most.0[i]))
    }
    #[inline(always)]
    fn bitmask(mask: Self::Mask) -> u32 {
        mask.iter().enumerate().map(|(i, &yes)| u32::from(yes) << i).sum()
    }
    #[inline(always)]
    fn lookup(table: &Table, key: Self::Bits) -> Self::Bits {
        key.map(|key| table[(key >> KEY_SHIFT) as usize])
    }
    #[inline(always)]
    fn to_bits(self) -> Self::Bits {
        self.0.map(f64::to_bits)
    }
    #[inline(always)]
    fn from_bits(bits: Self::Bits) -> Self {
        Portable(bits.map(f64::from_bits))
    }
    #[inline(always)]
    fn splat_bits(value: u64) -> Self::Bits {
        [value; 4]
    }
    #[inline(always)]
    fn load_bits(from: &[u64]) -> Self::Bits {
        std::array::from_fn(|i| from[i])
    }
    #[inline(always)]
    fn store_bits(bits: Self::Bits, to: &mut [u64]) {
        to[..4].copy_from_slice(&bits);
    }
    #[inline(always)]
    fn add_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits {
        zip(a, b, u64::wrapping_add)
    }
    #[inline(always)]
    fn mul_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits {
        zip(a, b, u64::wrapping_mul)
    }
    #[inline(always)]
    fn xor(a: Self::Bits, b: Self::Bits) -> Self::Bits {
        zip(a, b, |a, b| a ^ b)
    }
    #[inline(always)]
    fn keep_and_set(bits: Self::Bits, keep: u64, set: u64) -> Self::Bits {
        bits.map(|b| (b & keep) | set)
    }
    #[inline(always)]
    fn xor3(a: Self::Bits, b: Self::Bits, c: Self::Bits) -> Self::Bits {
        Self::xor(Self::xor(a, b), c)
    }
    #[inline(always)]
    fn from_integers(bits: Self::Bits) -> Self {
        Portable(bits.map(|b| b as i64 as f64))
    }
    #[inline(always)]
    fn shr<const N: u32>(bits: Self::Bits) -> Self::Bits {
        bits.map(|b| b >> N)
    }
    #[inline(always)]
    fn shl<const N: u32>(bits: Self::Bits) -> Self::Bits {
        bits.map(|b| b << N)
    }
    #[inline(always)]
    fn rotate_left<const N: i32>(bits: Self::Bits) -> Self::Bits {
        bits.map(|b| b.rotate_left(N as u32))
    }
}
