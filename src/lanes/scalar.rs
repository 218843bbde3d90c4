//! `f64` as a single lane, for code that follows paths one by one.

use super::{KEY_SHIFT, Lanes, LookupTable, ROW, Row};

impl Lanes for f64 {
    const WIDTH: usize = 1;
    type Bits = u64;
    type Mask = bool;

    super::inlined! {
        fn splat(value: f64) -> Self { value }
        fn load(from: &[f64]) -> Self { from[0] }
        fn store(self, to: &mut [f64]) { to[0] = self; }
        fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW] { table[rows[0] as usize].0 }
        fn scatter_rows(columns: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]) {
            table[rows[0] as usize] = Row(columns);
        }
        fn sqrt(self) -> Self { f64::sqrt(self) }
        fn abs(self) -> Self { f64::abs(self) }
        fn mul_add(self, factor: Self, term: Self) -> Self { f64::mul_add(self, factor, term) }
        fn gt(self, other: Self) -> bool { self > other }
        fn lt(self, other: Self) -> bool { self < other }
        fn ge(self, other: Self) -> bool { self >= other }
        fn le(self, other: Self) -> bool { self <= other }
        fn select(mask: bool, a: Self, b: Self) -> Self { if mask { a } else { b } }
        fn either(up: bool, a: Self, down: bool, b: Self) -> Self {
            if up { a } else if down { b } else { 0.0 }
        }
        fn where_zero(self, zero: Self, other: Self) -> Self { if self == 0.0 { zero } else { other } }
        fn add_where(self, other: Self, keep: bool) -> Self { if keep { self + other } else { 0.0 } }
        fn or(a: bool, b: bool) -> bool { a | b }
        fn and(a: bool, b: bool) -> bool { a & b }
        fn not(mask: bool) -> bool { !mask }
        fn always() -> bool { true }
        fn not_beyond(self, least: Self, most: Self, among: bool) -> bool { among && !(self < least || self > most) }
        fn bitmask(mask: bool) -> u32 { u32::from(mask) }
        fn lookup(table: &LookupTable, key: u64) -> u64 { table[(key >> KEY_SHIFT) as usize] }
        fn to_bits(self) -> u64 { f64::to_bits(self) }
        fn from_bits(bits: u64) -> Self { f64::from_bits(bits) }
        fn splat_bits(value: u64) -> u64 { value }
        fn load_bits(from: &[u64]) -> u64 { from[0] }
        fn store_bits(bits: u64, to: &mut [u64]) { to[0] = bits; }
        fn add_bits(a: u64, b: u64) -> u64 { a.wrapping_add(b) }
        fn mul_bits(a: u64, b: u64) -> u64 { a.wrapping_mul(b) }
        fn xor(a: u64, b: u64) -> u64 { a ^ b }
        fn xor3(a: u64, b: u64, c: u64) -> u64 { a ^ b ^ c }
        fn keep_and_set(bits: u64, keep: u64, set: u64) -> u64 { (bits & keep) | set }
        fn from_integers(bits: u64) -> Self { bits as i64 as f64 }
        fn shr<const N: u32>(bits: u64) -> u64 { bits >> N }
        fn shl<const N: u32>(bits: u64) -> u64 { bits << N }
        fn rotate_left<const N: i32>(bits: u64) -> u64 { bits.rotate_left(N as u32) }
    }
}
