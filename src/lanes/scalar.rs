//! `f64` as a single lane, for code that follows paths one by one.

use super::{KEY_SHIFT, Lanes, ROW, Row, Table};

impl Lanes for f64 {
    const WIDTH: usize = 1;
    type Bits = u64;
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
    #[inline(always)]
    fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW] {
        table[rows[0] as usize].0
    }
    #[inline(always)]
    fn scatter_rows(columns: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]) {
        table[rows[0] as usize] = Row(columns);
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        f64::mul_add(self, factor, term)
    }
    #[inline(always)]
    fn gt(self, other: Self) -> bool {
        self > other
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn ge(self, other: Self) -> bool {
        self >= other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn either(up: bool, a: Self, down: bool, b: Self) -> Self {
        if up {
            a
        } else if down {
            b
        } else {
            0.0
        }
    }
    #[inline(always)]
    fn where_zero(self, zero: Self, other: Self) -> Self {
        if self == 0.0 { zero } else { other }
    }
    #[inline(always)]
    fn add_where(self, other: Self, keep: bool) -> Self {
        if keep { self + other } else { 0.0 }
    }
    #[inline(always)]
    fn or(a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn and(a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn not(mask: bool) -> bool {
        !mask
    }
    #[inline(always)]
    fn always() -> bool {
        true
    }
    #[inline(always)]
    fn not_beyond(self, least: Self, most: Self, among: bool) -> bool {
        among && !(self < least || self > most)
    }
    #[inline(always)]
    fn bitmask(mask: bool) -> u32 {
        u32::from(mask)
    }
    #[inline(always)]
    fn lookup(table: &Table, key: u64) -> u64 {
        table[(key >> KEY_SHIFT) as usize]
    }
    #[inline(always)]
    fn to_bits(self) -> u64 {
        f64::to_bits(self)
    }
    #[inline(always)]
    fn from_bits(bits: u64) -> Self {
        f64::from_bits(bits)
    }
    #[inline(always)]
    fn splat_bits(value: u64) -> u64 {
        value
    }
    #[inline(always)]
    fn load_bits(from: &[u64]) -> u64 {
        from[0]
    }
    #[inline(always)]
    fn store_bits(bits: u64, to: &mut [u64]) {
        to[0] = bits;
    }
    #[inline(always)]
    fn add_bits(a: u64, b: u64) -> u64 {
        a.wrapping_add(b)
    }
    #[inline(always)]
    fn mul_bits(a: u64, b: u64) -> u64 {
        a.wrapping_mul(b)
    }
    #[inline(always)]
    fn xor(a: u64, b: u64) -> u64 {
        a ^ b
    }
    #[inline(always)]
    fn xor3(a: u64, b: u64, c: u64) -> u64 {
        a ^ b ^ c
    }
    #[inline(always)]
    fn keep_and_set(bits: u64, keep: u64, set: u64) -> u64 {
        (bits & keep) | set
    }
    #[inline(always)]
    fn from_integers(bits: u64) -> Self {
        bits as i64 as f64
    }
    #[inline(always)]
    fn shr<const N: u32>(bits: u64) -> u64 {
        bits >> N
    }
    #[inline(always)]
    fn shl<const N: u32>(bits: u64) -> u64 {
        bits << N
    }
    #[inline(always)]
    fn rotate_left<const N: i32>(bits: u64) -> u64 {
        bits.rotate_left(N as u32)
    }
}
