//! Four lanes in plain Rust, for processors without the wide instruction sets.

use super::{Lanes, LookupTable, ROW, Row};
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

/// Implements methods and functions of [`Lanes`] by those of a single lane.
macro_rules! in_each {
    (
        methods { $($method:ident($($other:ident: $Other:ident),*) -> $Result:ident;)* }
        functions { $($function:ident($($arg:ident: $Arg:ident),*) -> $Out:ident;)* }
    ) => {
        $(
            #[inline(always)]
            fn $method(self $(, $other: in_each!(@type $Other))*) -> in_each!(@type $Result) {
                let lane = |i: usize| <f64 as Lanes>::$method(self.0[i] $(, in_each!(@lane $Other $other i))*);
                in_each!(@all $Result lane)
            }
        )*
        $(
            #[inline(always)]
            fn $function($($arg: in_each!(@type $Arg)),*) -> in_each!(@type $Out) {
                let lane = |_i: usize| <f64 as Lanes>::$function($(in_each!(@lane $Arg $arg _i)),*);
                in_each!(@all $Out lane)
            }
        )*
    };
    (@type Self) => { Self };
    (@type $Type:ident) => { Self::$Type };
    (@lane Self $lanes:ident $i:ident) => { $lanes.0[$i] };
    (@lane $Type:ident $lanes:ident $i:ident) => { $lanes[$i] };
    (@all Self $lane:ident) => { Portable(std::array::from_fn($lane)) };
    (@all $Type:ident $lane:ident) => { std::array::from_fn($lane) };
}

impl Lanes for Portable {
    const WIDTH: usize = 4;
    type Bits = [u64; 4];
    type Mask = [bool; 4];

    super::same_in_every_lane!(in_each);

    super::inlined! {
        fn splat(value: f64) -> Self { Portable([value; 4]) }
        fn load(from: &[f64]) -> Self { Portable(std::array::from_fn(|i| from[i])) }
        fn store(self, to: &mut [f64]) { to[..4].copy_from_slice(&self.0); }
        fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW] {
            let rows: [usize; 4] = std::array::from_fn(|i| rows[i] as usize);
            std::array::from_fn(|column| Portable(rows.map(|row| table[row].0[column])))
        }
        fn scatter_rows(columns: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]) {
            for (i, &row) in rows[..4].iter().enumerate() {
                table[row as usize] = Row(columns.map(|column| column.0[i]));
            }
        }
        fn bitmask(mask: Self::Mask) -> u32 {
            mask.iter().enumerate().map(|(i, &yes)| u32::from(yes) << i).sum()
        }
        fn lookup(table: &LookupTable, key: Self::Bits) -> Self::Bits { key.map(|key| <f64 as Lanes>::lookup(table, key)) }
        fn splat_bits(value: u64) -> Self::Bits { [value; 4] }
        fn load_bits(from: &[u64]) -> Self::Bits { std::array::from_fn(|i| from[i]) }
        fn store_bits(bits: Self::Bits, to: &mut [u64]) { to[..4].copy_from_slice(&bits); }
        fn keep_and_set(bits: Self::Bits, keep: u64, set: u64) -> Self::Bits { bits.map(|b| (b & keep) | set) }
        fn shr<const N: u32>(bits: Self::Bits) -> Self::Bits { bits.map(|b| b >> N) }
        fn shl<const N: u32>(bits: Self::Bits) -> Self::Bits { bits.map(|b| b << N) }
        fn rotate_left<const N: i32>(bits: Self::Bits) -> Self::Bits { bits.map(|b| b.rotate_left(N as u32)) }
    }
}
