//! Lanes: several paths side by side in one register, as a type that formulas read well in.
//!
//! [`Lanes`] is the arithmetic that noise and schemes need. There are three of it: eight lanes of AVX-512, four
//! of AVX2 with FMA, and four portable ones; and a single number is one lane, so that a formula is written once for a path and for
//! many. All of them compute the same bits: every operation is one that IEEE 754
//! rounds correctly, and fused multiply-adds are written out, never left to the compiler. The widest one the processor has is
//! chosen once per run ([`InstructionSet::detect`], [`InstructionSet::run`]).
//!
//! This is the only room with `unsafe` for speed. Its argument: the x86 lane types wrap intrinsics of one instruction set; code
//! that uses them is only reached through `run`, which checks with `is_x86_feature_detected!` that the processor has it.

/// Implements operators of a lane type, and those with one number for every lane. The bodies are no closures, which would not
/// be compiled for the instruction set.
macro_rules! arithmetic {
    ($Type:ident, $($Trait:ident $name:ident ($a:ident, $b:ident) $body:block)+) => {
        $(
            impl $Trait for $Type {
                type Output = Self;
                #[inline(always)]
                fn $name(self, other: Self) -> Self {
                    let ($a, $b) = (self, other);
                    $body
                }
            }
        )+
        arithmetic!(@number $Type, Add add);
        arithmetic!(@number $Type, Sub sub);
        arithmetic!(@number $Type, Mul mul);
    };
    (@number $Type:ident, $Trait:ident $name:ident) => {
        impl $Trait<f64> for $Type {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                $Trait::$name(self, Self::splat(other))
            }
        }
    };
}
use arithmetic;

mod functions;
mod portable;
mod scalar;
#[cfg(test)]
mod tests;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use functions::{cosh_and_sinh_over, exp, log1p, small_unit};
pub use portable::Portable;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers of a row: as many as fill a cache line.
pub const ROW: usize = 8;

/// Some numbers of one lane, in a cache line of their own.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Row(pub [f64; ROW]);

/// Bits of a key below those that number its entry in a [`Table`].
pub const KEY_SHIFT: u32 = 45;

/// A table with an entry for every number that the upper bits of a key can be: 19 of them.
pub type Table = [u64; 1 << (u64::BITS - KEY_SHIFT)];

/// Some numbers side by side, and the few operations the schemes need on them.
///
/// `Bits` are the same lanes seen as 64-bit integers; `Mask` says yes or no for each lane.
pub trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// How many lanes.
    const WIDTH: usize;
    /// One 64-bit integer a lane.
    type Bits: Copy;
    /// One boolean a lane.
    type Mask: Copy;

    /// The same number in every lane.
    fn splat(value: f64) -> Self;
    /// The first `WIDTH` numbers of a slice.
    fn load(from: &[f64]) -> Self;
    /// Write the lanes to the first `WIDTH` places of a slice.
    fn store(self, to: &mut [f64]);
    /// The number `column` of each of `WIDTH` rows of a table, for every column.
    fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW];
    /// Write the columns of `WIDTH` rows to a table.
    fn scatter_rows(columns: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]);
    /// The square root.
    fn sqrt(self) -> Self;
    /// |self|
    fn abs(self) -> Self;
    /// Those of the entries whose lanes are in the mask, side by side; what is behind them means nothing.
    #[inline(always)]
    fn compress(entries: &[u32; ROW], lanes: u32) -> [u32; ROW] {
        let (mut all, mut count) = ([0; ROW], 0);
        for (i, &entry) in entries[..Self::WIDTH].iter().enumerate() {
            all[count & (ROW - 1)] = entry;
            count += (lanes >> i & 1) as usize;
        }
        all
    }
    /// self * factor + term, rounded once.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// self > other
    fn gt(self, other: Self) -> Self::Mask;
    /// self < other
    fn lt(self, other: Self) -> Self::Mask;
    /// self >= other
    fn ge(self, other: Self) -> Self::Mask;
    /// self <= other
    fn le(self, other: Self) -> Self::Mask;
    /// `a` where `mask` holds, `b` elsewhere.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// `a` where `up` holds, `b` where `down` holds, 0 elsewhere; they never hold both.
    fn either(up: Self::Mask, a: Self, down: Self::Mask, b: Self) -> Self;
    /// `zero` where self is zero, `other` elsewhere.
    fn where_zero(self, zero: Self, other: Self) -> Self;
    /// self + other where `keep` holds, 0 elsewhere.
    fn add_where(self, other: Self, keep: Self::Mask) -> Self;
    /// In the lanes of either mask.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// In the lanes of both masks.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// In the lanes that are not in the mask.
    fn not(mask: Self::Mask) -> Self::Mask;
    /// Yes in every lane.
    fn always() -> Self::Mask;
    /// The lanes of `among` where self is neither below `least` nor above `most`; those where it is not a number are kept.
    fn not_beyond(self, least: Self, most: Self, among: Self::Mask) -> Self::Mask;
    /// Bit i of the result is lane i of the mask.
    fn bitmask(mask: Self::Mask) -> u32;
    /// In each lane, the table entry numbered by the upper bits of `key`, `key >> KEY_SHIFT`.
    fn lookup(table: &Table, key: Self::Bits) -> Self::Bits;

    /// The lanes' bit patterns.
    fn to_bits(self) -> Self::Bits;
    /// The numbers with these bit patterns.
    fn from_bits(bits: Self::Bits) -> Self;
    /// The same integer in every lane.
    fn splat_bits(value: u64) -> Self::Bits;
    /// The first `WIDTH` integers of a slice.
    fn load_bits(from: &[u64]) -> Self::Bits;
    /// Write the lanes to the first `WIDTH` places of a slice.
    fn store_bits(bits: Self::Bits, to: &mut [u64]);
    /// a + b modulo 2^64
    fn add_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// a * b modulo 2^64
    fn mul_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// a ^ b
    fn xor(a: Self::Bits, b: Self::Bits) -> Self::Bits;
    /// a ^ b ^ c
    fn xor3(a: Self::Bits, b: Self::Bits, c: Self::Bits) -> Self::Bits;
    /// (bits & keep) | set
    fn keep_and_set(bits: Self::Bits, keep: u64, set: u64) -> Self::Bits;
    /// The doubles nearest to the lanes as signed integers.
    fn from_integers(bits: Self::Bits) -> Self;
    /// bits >> N, zeros coming in
    fn shr<const N: u32>(bits: Self::Bits) -> Self::Bits;
    /// bits << N
    fn shl<const N: u32>(bits: Self::Bits) -> Self::Bits;
    /// bits rotated left by N < 64
    fn rotate_left<const N: i32>(bits: Self::Bits) -> Self::Bits;
}

impl<L: Lanes> Choose for L {}

/// What follows from the operations of [`Lanes`].
pub trait Choose: Lanes {
    /// The larger of both; `other` where self is not a number.
    #[inline(always)]
    fn or_at_least(self, other: Self) -> Self {
        Self::select(self.gt(other), self, other)
    }

    /// The smaller of both; `other` where self is not a number.
    #[inline(always)]
    fn or_at_most(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
}

/// A computation that is generic over the lanes it runs on.
pub trait LaneProgram {
    /// Run it on these lanes. Implementations are `#[inline(always)]`, so that they compile for the caller's instruction set.
    fn run<L: Lanes>(&mut self);
}

/// The instruction sets there are lanes for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// Eight lanes; needs AVX-512 F, DQ and VL.
    Avx512,
    /// Four lanes; needs AVX2 and FMA.
    Avx2,
    /// Four lanes in plain Rust; runs anywhere, slowly where there is no fused multiply-add.
    Portable,
}

impl InstructionSet {
    /// From the widest to the one that always works.
    pub const ALL: [InstructionSet; 3] = [InstructionSet::Avx512, InstructionSet::Avx2, InstructionSet::Portable];

    /// The widest one this processor has.
    pub fn detect() -> Self {
        Self::ALL.into_iter().find(|set| set.is_available()).unwrap_or(InstructionSet::Portable)
    }

    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => {
                InstructionSet::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            InstructionSet::Portable => true,
            #[cfg(not(target_arch = "x86_64"))]
            InstructionSet::Avx512 | InstructionSet::Avx2 => false,
        }
    }

    /// Its name, as `mc run --verbose` prints it.
    pub fn name(self) -> &'static str {
        match self {
            InstructionSet::Avx512 => "AVX-512",
            InstructionSet::Avx2 => "AVX2",
            InstructionSet::Portable => "portable",
        }
    }

    /// Run a program on this instruction set's lanes, or on the portable ones if the processor lacks it; the result is the
    /// same either way.
    pub fn run(self, program: &mut impl LaneProgram) {
        match self {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 if self.is_available() => x86::run_avx512(program),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 if self.is_available() => x86::run_avx2(program),
            _ => program.run::<Portable>(),
        }
    }
}
