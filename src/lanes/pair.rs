//! The lanes of two registers as one.
//!
//! Four lanes at a time are few where the work on them is long, as in an event-driven macro step.
//! Most of it is then a chain of operations that wait for each other, and the management of a
//! register is shared by four paths only. A pair has two such chains, and shares the management
//! among eight.

use super::{Lanes, LookupTable, ROW, Row};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The lanes of the first register, and then those of the second. They are four each at most, so
/// that a pair has no more lanes than a [`Row`] has places.
#[derive(Clone, Copy)]
pub struct Pair<L>(L, L);

/// Implements operators between a pair and another one, or one number for every lane.
macro_rules! operators {
    ($($Trait:ident $name:ident with $Other:ty: $other:ident => $a:expr, $b:expr;)+) => {
        $(
            impl<L: Lanes> $Trait<$Other> for Pair<L> {
                type Output = Self;
                #[inline(always)]
                fn $name(self, $other: $Other) -> Self {
                    Pair($Trait::$name(self.0, $a), $Trait::$name(self.1, $b))
                }
            }
        )+
    };
}
operators! {
    Add add with Self: other => other.0, other.1;
    Sub sub with Self: other => other.0, other.1;
    Mul mul with Self: other => other.0, other.1;
    Div div with Self: other => other.0, other.1;
    Add add with f64: number => number, number;
    Sub sub with f64: number => number, number;
    Mul mul with f64: number => number, number;
}

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
        [
            c[0].0, c[1].0, c[2].0, c[3].0, c[4].0, c[5].0, c[6].0, c[7].0,
        ],
        [
            c[0].1, c[1].1, c[2].1, c[3].1, c[4].1, c[5].1, c[6].1, c[7].1,
        ],
    ]
}

/// Implements methods and functions of [`Lanes`] by those of both registers.
macro_rules! in_both {
    (
        methods { $($method:ident($($other:ident: $Other:ident),*) -> $Result:ident;)* }
        functions { $($function:ident($($arg:ident: $Arg:ident),*) -> $Out:ident;)* }
    ) => {
        $(
            #[inline(always)]
            fn $method(self $(, $other: in_both!(@type $Other))*) -> in_both!(@type $Result) {
                in_both!(@both $Result, self.0.$method($($other.0),*), self.1.$method($($other.1),*))
            }
        )*
        $(
            #[inline(always)]
            fn $function($($arg: in_both!(@type $Arg)),*) -> in_both!(@type $Out) {
                in_both!(@both $Out, L::$function($($arg.0),*), L::$function($($arg.1),*))
            }
        )*
    };
    (@type Self) => { Self };
    (@type $Type:ident) => { Self::$Type };
    (@both Self, $a:expr, $b:expr) => { Pair($a, $b) };
    (@both $Type:ident, $a:expr, $b:expr) => { ($a, $b) };
}

impl<L: Lanes> Lanes for Pair<L> {
    const WIDTH: usize = 2 * L::WIDTH;
    type Bits = (L::Bits, L::Bits);
    type Mask = (L::Mask, L::Mask);

    in_both! {
        methods {
            sqrt() -> Self;
            abs() -> Self;
            mul_add(factor: Self, term: Self) -> Self;
            gt(other: Self) -> Mask;
            lt(other: Self) -> Mask;
            ge(other: Self) -> Mask;
            le(other: Self) -> Mask;
            where_zero(zero: Self, other: Self) -> Self;
            add_where(other: Self, keep: Mask) -> Self;
            not_beyond(least: Self, most: Self, among: Mask) -> Mask;
            to_bits() -> Bits;
        }
        functions {
            select(mask: Mask, a: Self, b: Self) -> Self;
            either(up: Mask, a: Self, down: Mask, b: Self) -> Self;
            or(a: Mask, b: Mask) -> Mask;
            and(a: Mask, b: Mask) -> Mask;
            not(mask: Mask) -> Mask;
            always() -> Mask;
            from_bits(bits: Bits) -> Self;
            from_integers(bits: Bits) -> Self;
            add_bits(a: Bits, b: Bits) -> Bits;
            mul_bits(a: Bits, b: Bits) -> Bits;
            xor(a: Bits, b: Bits) -> Bits;
            xor3(a: Bits, b: Bits, c: Bits) -> Bits;
        }
    }

    super::inlined! {
        fn splat(value: f64) -> Self { Pair(L::splat(value), L::splat(value)) }
        fn load(from: &[f64]) -> Self { Pair(L::load(from), L::load(&from[L::WIDTH..])) }
        fn store(self, to: &mut [f64]) {
            self.0.store(to);
            self.1.store(&mut to[L::WIDTH..]);
        }
        fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW] {
            zip(L::gather_rows(table, rows), L::gather_rows(table, &second::<L>(rows)))
        }
        fn scatter_rows(columns: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]) {
            let [low, high] = unzip(columns);
            L::scatter_rows(low, table, rows);
            L::scatter_rows(high, table, &second::<L>(rows));
        }
        fn compress(entries: &[u32; ROW], lanes: u32) -> [u32; ROW] { L::compress(entries, lanes) }
        fn bitmask(mask: Self::Mask) -> u32 { L::bitmask(mask.0) | L::bitmask(mask.1) << L::WIDTH }
        fn lookup(table: &LookupTable, key: Self::Bits) -> Self::Bits { (L::lookup(table, key.0), L::lookup(table, key.1)) }
        fn splat_bits(value: u64) -> Self::Bits { (L::splat_bits(value), L::splat_bits(value)) }
        fn load_bits(from: &[u64]) -> Self::Bits { (L::load_bits(from), L::load_bits(&from[L::WIDTH..])) }
        fn store_bits(bits: Self::Bits, to: &mut [u64]) {
            L::store_bits(bits.0, to);
            L::store_bits(bits.1, &mut to[L::WIDTH..]);
        }
        fn keep_and_set(bits: Self::Bits, keep: u64, set: u64) -> Self::Bits {
            (L::keep_and_set(bits.0, keep, set), L::keep_and_set(bits.1, keep, set))
        }
        fn shr<const N: u32>(bits: Self::Bits) -> Self::Bits { (L::shr::<N>(bits.0), L::shr::<N>(bits.1)) }
        fn shl<const N: u32>(bits: Self::Bits) -> Self::Bits { (L::shl::<N>(bits.0), L::shl::<N>(bits.1)) }
        fn rotate_left<const N: i32>(bits: Self::Bits) -> Self::Bits {
            (L::rotate_left::<N>(bits.0), L::rotate_left::<N>(bits.1))
        }
    }
}
