//! Lanes: several numbers, each of a different path, in one processor register. They are a type
//! with ordinary operators, so that formulas stay readable.
//!
//! [`Lanes`] is the arithmetic that noise and schemes need, so that a formula is written once for
//! one path and for many. It is implemented by eight lanes of AVX-512, by four lanes of AVX2 with
//! FMA, by a pair of registers as one, and by `f64` as a single lane, for all other processors; it
//! takes the least time to build. All of them compute the same bits: IEEE 754 defines the correct
//! rounding of every operation that is used, and a fused multiply-add is written out where it is
//! wanted and never left to the compiler. Each run chooses the widest lanes that the processor has
//! ([`InstructionSet::detect`], [`InstructionSet::run`]).
//!
//! This is the only module that uses `unsafe` for speed. It is sound because the x86 lane types
//! only wrap intrinsics of one instruction set, and code that uses them can only be reached through
//! `run`, `run_single` and `run_paired`. These check with `is_x86_feature_detected!` that the
//! processor has that instruction set.

/// Implements the operators between two values of a lane type, and those between lanes and one
/// number for every lane. The bodies are not passed as closures, because a closure would not be
/// compiled for the instruction set.
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

/// Marks functions `#[inline(always)]`, so that they are compiled for the instruction set of the
/// caller.
macro_rules! inlined {
    ($($(#[$about:meta])* fn $name:ident $(<const N: $Number:ty>)? ($($arguments:tt)*) $(-> $Result:ty)? $body:block)*) => {
        $($(#[$about])* #[inline(always)] fn $name $(<const N: $Number>)? ($($arguments)*) $(-> $Result)? $body)*
    };
}
use inlined;

mod functions;
mod pair;
mod scalar;
#[cfg(test)]
mod tests;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use functions::{cosh_and_sinh_over, exp, log1p, small_unit};

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::LazyLock;

/// Numbers in a [`Row`]: as many as fill a cache line of 64 bytes.
pub const ROW: usize = 8;

/// The numbers of one lane, in their own cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Row(pub [f64; ROW]);

/// The number of lower bits of a key that do not select an entry of a [`LookupTable`].
pub const KEY_SHIFT: u32 = 45;

/// A table with one entry for each value of the upper 19 bits of a key.
pub type LookupTable = [u64; 1 << (u64::BITS - KEY_SHIFT)];

/// Several numbers side by side, and the operations that the schemes need on them.
///
/// `Bits` holds the same lanes as 64-bit integers. `Mask` holds one boolean for each lane.
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
    /// The number of lanes.
    const WIDTH: usize;
    /// One 64-bit integer in each lane.
    type Bits: Copy;
    /// One boolean in each lane.
    type Mask: Copy;

    /// The same number in every lane.
    fn splat(value: f64) -> Self;
    /// The first `WIDTH` numbers of a slice.
    fn load(from: &[f64]) -> Self;
    /// Writes the lanes to the first `WIDTH` places of a slice.
    fn store(self, to: &mut [f64]);
    /// Reads `WIDTH` rows of a table as columns: lane i of result k is number k of row `rows[i]`.
    fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW];
    /// Writes columns to `WIDTH` rows of a table; the inverse of `gather_rows`.
    fn scatter_rows(columns: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]);
    /// The square root.
    fn sqrt(self) -> Self;
    /// |self|
    fn abs(self) -> Self;
    /// Those of the entries whose bit in `lanes` is set, packed at the front of the result. What
    /// follows them in the result has no meaning. No bit beyond the lanes may be set.
    #[inline(always)]
    fn compress(entries: &[u32; ROW], lanes: u32) -> [u32; ROW] {
        let (mut all, mut count) = ([0; ROW], 0);
        for (i, &entry) in entries.iter().enumerate() {
            all[count & (ROW - 1)] = entry;
            count += (lanes >> i & 1) as usize;
        }
        all
    }
    /// self * factor + term, with a single rounding.
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
    /// `a` where `up` holds, `b` where `down` holds, 0 elsewhere. No lane may be in both masks.
    fn either(up: Self::Mask, a: Self, down: Self::Mask, b: Self) -> Self;
    /// `zero` where self is zero, `other` elsewhere.
    fn where_zero(self, zero: Self, other: Self) -> Self;
    /// self + other where `keep` holds, 0 elsewhere.
    fn add_where(self, other: Self, keep: Self::Mask) -> Self;
    /// True in the lanes where at least one of the masks is true.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// True in the lanes where both masks are true.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// True in the lanes where the mask is false.
    fn not(mask: Self::Mask) -> Self::Mask;
    /// True in every lane.
    fn always() -> Self::Mask;
    /// True in the lanes of `among` where self is neither below `least` nor above `most`. A lane of
    /// `among` stays true where self is not a number.
    fn not_beyond(self, least: Self, most: Self, among: Self::Mask) -> Self::Mask;
    /// Bit i of the result is lane i of the mask.
    fn bitmask(mask: Self::Mask) -> u32;
    /// In each lane, the entry of the table whose index is `key >> KEY_SHIFT`, the upper bits of
    /// `key`.
    fn lookup(table: &LookupTable, key: Self::Bits) -> Self::Bits;

    /// The bit patterns of the lanes.
    fn to_bits(self) -> Self::Bits;
    /// The numbers that have these bit patterns.
    fn from_bits(bits: Self::Bits) -> Self;
    /// The same integer in every lane.
    fn splat_bits(value: u64) -> Self::Bits;
    /// The first `WIDTH` integers of a slice.
    fn load_bits(from: &[u64]) -> Self::Bits;
    /// Writes the lanes to the first `WIDTH` places of a slice.
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
    /// The lanes as signed integers, converted to the nearest doubles.
    fn from_integers(bits: Self::Bits) -> Self;
    /// bits >> N, filled with zeros from the left.
    fn shr<const N: u32>(bits: Self::Bits) -> Self::Bits;
    /// bits << N
    fn shl<const N: u32>(bits: Self::Bits) -> Self::Bits;
    /// bits rotated left by N, with N < 64.
    fn rotate_left<const N: i32>(bits: Self::Bits) -> Self::Bits;

    /// The larger of self and `other`; `other` where self is not a number.
    #[inline(always)]
    fn or_at_least(self, other: Self) -> Self {
        Self::select(self.gt(other), self, other)
    }

    /// The smaller of self and `other`; `other` where self is not a number.
    #[inline(always)]
    fn or_at_most(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
}

/// A computation that is generic over the lanes that it runs on.
pub trait LaneProgram {
    /// Runs the computation on lanes of type `L`. Implementations are marked `#[inline(always)]`,
    /// so that they are compiled for the instruction set of the caller.
    fn run<L: Lanes>(&mut self);
}

/// The instruction sets that lanes exist for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// Eight lanes. Needs AVX-512 F, DQ and VL.
    Avx512,
    /// Four lanes. Needs AVX2 and FMA.
    Avx2,
    /// One lane in plain Rust. Runs on every processor, but slowly on one without a fused
    /// multiply-add.
    Portable,
}

impl InstructionSet {
    /// All instruction sets, from the widest to the one that is always available.
    pub const ALL: [InstructionSet; 3] = [
        InstructionSet::Avx512,
        InstructionSet::Avx2,
        InstructionSet::Portable,
    ];

    /// The widest instruction set that this processor has.
    pub fn detect() -> Self {
        static WIDEST: LazyLock<InstructionSet> = LazyLock::new(|| {
            InstructionSet::ALL
                .into_iter()
                .find(|set| set.is_detected())
                .unwrap_or(InstructionSet::Portable)
        });
        *WIDEST
    }

    /// Measure the faster way to look up a table that holds what this one does. Lookups have the
    /// same results before and after.
    pub fn choose_lookup(table: &LookupTable) {
        #[cfg(target_arch = "x86_64")]
        x86::choose_lookup(table);
        #[cfg(not(target_arch = "x86_64"))]
        let _ = table;
    }

    /// How tables are looked up on this processor, once a way was chosen.
    pub fn lookup_name() -> &'static str {
        #[cfg(target_arch = "x86_64")]
        if x86::gathers() {
            return "gather instructions";
        }
        "single loads"
    }

    /// Whether this processor has it: each instruction set includes those after it.
    #[inline]
    pub fn is_available(self) -> bool {
        self as u8 >= Self::detect() as u8
    }

    fn is_detected(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => {
                InstructionSet::Avx2.is_detected()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("popcnt")
            }
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

    /// Runs a program on this instruction set's lanes, or on a single one if the processor
    /// lacks it; the result is the same either way.
    pub fn run(self, program: &mut impl LaneProgram) {
        match self {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 if self.is_available() => x86::run_avx512(program),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 if self.is_available() => x86::run_avx2(program),
            _ => program.run::<f64>(),
        }
    }

    /// The same for a program that follows one path at a time, for which AVX2 is as good as
    /// AVX-512.
    pub fn run_single(self, program: &mut impl LaneProgram) {
        match self {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 | InstructionSet::Avx2 if self.is_available() => {
                x86::run_avx2(program)
            }
            _ => program.run::<f64>(),
        }
    }

    /// The same, with two registers of four lanes of AVX2 as one of eight. This is for a program
    /// that takes long for each register.
    pub fn run_paired(self, program: &mut impl LaneProgram) {
        match self {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 if self.is_available() => x86::run_avx512(program),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 if self.is_available() => x86::run_avx2_paired(program),
            _ => program.run::<f64>(),
        }
    }
}
