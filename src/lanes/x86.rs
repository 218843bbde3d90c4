//! Eight lanes of AVX-512 and four of AVX2. Most methods are one intrinsic.
//!
//! SAFETY, for every `unsafe` block of this file. Arithmetic intrinsics have one precondition: that
//! the processor has their instruction set. The two lane types are private to this file and are
//! only named by `run_avx512`, `run_avx2` and `run_avx2_paired`, which [`super::InstructionSet`]
//! calls after detecting that instruction set. Loads from and stores to slices need no alignment,
//! and they reach exactly `WIDTH` elements of a slice whose length is checked first, or no more
//! elements of an array than its type has. The aligned loads and stores of AVX-512 go to entries of
//! a [`Row`], which is aligned to 64 bytes. Table lookups read the entry whose index is 64 bits
//! shifted right by `KEY_SHIFT`, and a [`LookupTable`] has one entry for each such index.

use super::pair::Pair;
use super::{InstructionSet, KEY_SHIFT, LaneProgram, Lanes, LookupTable, ROW, Row};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Functions of intrinsics, compiled for the instruction set of the caller.
macro_rules! intrinsics {
    ($($(#[$about:meta])* fn $name:ident $(<const N: $Number:ty>)? ($($arguments:tt)*) $(-> $Result:ty)? { $($body:tt)* })*) => {
        super::inlined! {
            // SAFETY: see the head of this file.
            $($(#[$about])* fn $name $(<const N: $Number>)? ($($arguments)*) $(-> $Result)? { unsafe { $($body)* } })*
        }
    };
}

/// Functions that run a program on lanes of a type, compiled for its instruction set.
macro_rules! runners {
    ($($name:ident: $Lanes:ty, $features:literal;)+) => {
        $(
            pub(super) fn $name(program: &mut impl LaneProgram) {
                #[target_feature(enable = $features)]
                fn widened(program: &mut impl LaneProgram) {
                    program.run::<$Lanes>();
                }
                // SAFETY: see the head of this file.
                unsafe { widened(program) }
            }
        )+
    };
}

runners! {
    run_avx512: Avx512, "avx512f,avx512dq,avx512vl,avx2,fma,popcnt";
    run_avx2: Avx2, "avx2,fma,popcnt";
    run_avx2_paired: Pair<Avx2>, "avx2,fma,popcnt";
}

/// Eight lanes.
#[derive(Clone, Copy)]
struct Avx512(__m512d);

super::arithmetic! { Avx512,
    Add add(a, b) { unsafe { Avx512(_mm512_add_pd(a.0, b.0)) } }
    Sub sub(a, b) { unsafe { Avx512(_mm512_sub_pd(a.0, b.0)) } }
    Mul mul(a, b) { unsafe { Avx512(_mm512_mul_pd(a.0, b.0)) } }
    Div div(a, b) { unsafe { Avx512(_mm512_div_pd(a.0, b.0)) } }
}

impl Neg for Avx512 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        unsafe { Avx512(_mm512_xor_pd(self.0, _mm512_set1_pd(-0.0))) }
    }
}

impl Lanes for Avx512 {
    const WIDTH: usize = 8;
    type Bits = __m512i;
    type Mask = __mmask8;

    intrinsics! {
        fn splat(value: f64) -> Self { Avx512(_mm512_set1_pd(value)) }
        fn load(from: &[f64]) -> Self { Avx512(_mm512_loadu_pd(from[..8].as_ptr())) }
        fn store(self, to: &mut [f64]) { _mm512_storeu_pd(to[..8].as_mut_ptr(), self.0) }
        fn sqrt(self) -> Self { Avx512(_mm512_sqrt_pd(self.0)) }
        fn abs(self) -> Self { Avx512(_mm512_abs_pd(self.0)) }
        fn mul_add(self, factor: Self, term: Self) -> Self { Avx512(_mm512_fmadd_pd(self.0, factor.0, term.0)) }
        fn gt(self, other: Self) -> Self::Mask { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, other.0) }
        fn lt(self, other: Self) -> Self::Mask { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
        fn ge(self, other: Self) -> Self::Mask { _mm512_cmp_pd_mask::<_CMP_GE_OQ>(self.0, other.0) }
        fn le(self, other: Self) -> Self::Mask { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) }
        fn select(mask: Self::Mask, a: Self, b: Self) -> Self { Avx512(_mm512_mask_blend_pd(mask, b.0, a.0)) }
        fn either(up: Self::Mask, a: Self, down: Self::Mask, b: Self) -> Self { Avx512(_mm512_mask_mov_pd(_mm512_maskz_mov_pd(down, b.0), up, a.0)) }
        fn where_zero(self, zero: Self, other: Self) -> Self {
            let is_zero = _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, _mm512_setzero_pd());
            Avx512(_mm512_mask_blend_pd(is_zero, other.0, zero.0))
        }
        fn add_where(self, other: Self, keep: Self::Mask) -> Self { Avx512(_mm512_maskz_add_pd(keep, self.0, other.0)) }
        fn not_beyond(self, least: Self, most: Self, among: Self::Mask) -> Self::Mask {
            let among = _mm512_mask_cmp_pd_mask::<_CMP_NLT_UQ>(among, self.0, least.0);
            _mm512_mask_cmp_pd_mask::<_CMP_NGT_UQ>(among, self.0, most.0)
        }
        fn lookup(table: &LookupTable, key: Self::Bits) -> Self::Bits {
            eight_entries(table, _mm512_srli_epi64::<KEY_SHIFT>(key), gathers())
        }
        fn to_bits(self) -> Self::Bits { _mm512_castpd_si512(self.0) }
        fn from_bits(bits: Self::Bits) -> Self { Avx512(_mm512_castsi512_pd(bits)) }
        fn splat_bits(value: u64) -> Self::Bits { _mm512_set1_epi64(value as i64) }
        fn load_bits(from: &[u64]) -> Self::Bits { _mm512_loadu_si512(from[..8].as_ptr().cast()) }
        fn store_bits(bits: Self::Bits, to: &mut [u64]) { _mm512_storeu_si512(to[..8].as_mut_ptr().cast(), bits) }
        fn add_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits { _mm512_add_epi64(a, b) }
        fn mul_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits { _mm512_mullo_epi64(a, b) }
        fn xor(a: Self::Bits, b: Self::Bits) -> Self::Bits { _mm512_xor_si512(a, b) }
        fn from_integers(bits: Self::Bits) -> Self { Avx512(_mm512_cvtepi64_pd(bits)) }
        fn shr<const N: u32>(bits: Self::Bits) -> Self::Bits { _mm512_srli_epi64::<N>(bits) }
        fn shl<const N: u32>(bits: Self::Bits) -> Self::Bits { _mm512_slli_epi64::<N>(bits) }
        fn rotate_left<const N: i32>(bits: Self::Bits) -> Self::Bits { _mm512_rol_epi64::<N>(bits) }
    }

    super::inlined! {
        fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW] {
            macro_rules! loaded {
                ($($i:literal)+) => { [$(_mm512_load_pd(table.get_unchecked(rows[$i] as usize).0.as_ptr())),+] };
            }
            assert_in(table, rows);
            // SAFETY: `assert_in` has checked that all rows are in the table, and a `Row` is aligned to
            // 64 bytes.
            let c = unsafe { transposed(loaded!(0 1 2 3 4 5 6 7)) };
            [Avx512(c[0]), Avx512(c[1]), Avx512(c[2]), Avx512(c[3]), Avx512(c[4]), Avx512(c[5]), Avx512(c[6]), Avx512(c[7])]
        }
        fn scatter_rows(c: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]) {
            assert_in(table, rows);
            let lanes = transposed([c[0].0, c[1].0, c[2].0, c[3].0, c[4].0, c[5].0, c[6].0, c[7].0]);
            macro_rules! store {
                ($($i:literal)+) => {
                    $(_mm512_store_pd(table.get_unchecked_mut(rows[$i] as usize).0.as_mut_ptr(), lanes[$i]);)+
                };
            }
            // SAFETY: `assert_in` has checked that all rows are in the table, and a `Row` is aligned to
            // 64 bytes.
            unsafe {
                store!(0 1 2 3 4 5 6 7);
            }
        }
        fn compress(entries: &[u32; ROW], lanes: u32) -> [u32; ROW] {
            let mut all = [0; ROW];
            unsafe {
                let entries = _mm256_loadu_si256(entries.as_ptr().cast());
                _mm256_storeu_si256(all.as_mut_ptr().cast(), _mm256_maskz_compress_epi32(lanes as __mmask8, entries));
            }
            all
        }
        fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask { a | b }
        fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask { a & b }
        fn not(mask: Self::Mask) -> Self::Mask { !mask }
        fn always() -> Self::Mask { 0xFF }
        fn bitmask(mask: Self::Mask) -> u32 { u32::from(mask) }
        fn keep_and_set(bits: Self::Bits, keep: u64, set: u64) -> Self::Bits {
            // 0xEA is the truth table of (a & b) | c.
            unsafe { _mm512_ternarylogic_epi64::<0xEA>(bits, Self::splat_bits(keep), Self::splat_bits(set)) }
        }
        fn xor3(a: Self::Bits, b: Self::Bits, c: Self::Bits) -> Self::Bits {
            // 0x96 is the truth table of a ^ b ^ c.
            unsafe { _mm512_ternarylogic_epi64::<0x96>(a, b, c) }
        }
    }
}

/// Whether entries of a table are read by gather instructions, or one by one. A gather is microcode on
/// AMD processors before Zen 5, and slowed by security updates on some of Intel's, so its time decides.
/// The kernel tests this at every lookup: a copy for each way would be compiled twice.
static GATHERS: AtomicBool = AtomicBool::new(false);

#[inline(always)]
pub(super) fn gathers() -> bool {
    GATHERS.load(Ordering::Relaxed)
}

/// The sum of the entries for some keys.
type Way = fn(&LookupTable, &[u64]) -> u64;

/// By gather instructions and one by one, in the lanes of this processor.
pub(super) fn ways() -> Option<[Way; 2]> {
    match InstructionSet::detect() {
        // SAFETY: the processor has the instruction set.
        InstructionSet::Avx512 => Some([
            |table, keys| unsafe { sum_of_eights(table, keys, true) },
            |table, keys| unsafe { sum_of_eights(table, keys, false) },
        ]),
        InstructionSet::Avx2 => Some([
            |table, keys| unsafe { sum_of_fours(table, keys, true) },
            |table, keys| unsafe { sum_of_fours(table, keys, false) },
        ]),
        InstructionSet::Portable => None,
    }
}

/// Measure the faster way on this processor, in about 20 us, for tables that hold what this one does.
pub(super) fn choose_lookup(table: &LookupTable) {
    let Some(ways) = ways() else { return };
    // Keys as doubles of both signs and all sizes up to 2^63, like those of random integers.
    let key = |i: u64| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) as i64 as f64).to_bits();
    let keys: Vec<u64> = (1..=TRIED).map(key).collect();
    let mut least = [Duration::MAX; 2];
    for _ in 0..TRIALS {
        for (least, way) in least.iter_mut().zip(ways) {
            let start = Instant::now();
            std::hint::black_box(way(table, &keys));
            *least = start.elapsed().min(*least);
        }
    }
    GATHERS.store(least[0] < least[1], Ordering::Relaxed);
}

/// Lookups of one trial, and trials of each way; the least time of a way counts.
const TRIED: u64 = 512;
const TRIALS: usize = 16;

/// The sum of the entries for these keys, read eight at a time.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2")]
fn sum_of_eights(table: &LookupTable, keys: &[u64], gathers: bool) -> u64 {
    let mut sum = _mm512_setzero_si512();
    for keys in keys.as_chunks::<8>().0 {
        let at = _mm512_srli_epi64::<KEY_SHIFT>(Avx512::load_bits(keys));
        // SAFETY: see the head of this file.
        sum = _mm512_add_epi64(sum, unsafe { eight_entries(table, at, gathers) });
    }
    _mm512_reduce_add_epi64(sum) as u64
}

/// The same, four at a time.
#[target_feature(enable = "avx2,fma,popcnt")]
fn sum_of_fours(table: &LookupTable, keys: &[u64], gathers: bool) -> u64 {
    let mut sums = [0; 4];
    let mut sum = _mm256_setzero_si256();
    for keys in keys.as_chunks::<4>().0 {
        let at = _mm256_srli_epi64::<{ KEY_SHIFT as i32 }>(Avx2::load_bits(keys));
        // SAFETY: see the head of this file.
        sum = _mm256_add_epi64(sum, unsafe { four_entries(table, at, gathers) });
    }
    Avx2::store_bits(sum, &mut sums);
    sums.into_iter().fold(0, u64::wrapping_add)
}

/// The entries of the table with these eight indices.
///
/// SAFETY: the processor has AVX-512, and each index is below the length of the table.
#[inline(always)]
unsafe fn eight_entries(table: &LookupTable, at: __m512i, gathers: bool) -> __m512i {
    unsafe {
        if gathers {
            return _mm512_i64gather_epi64::<8>(at, table.as_ptr().cast());
        }
        let [low, high] = [
            _mm512_castsi512_si256(at),
            _mm512_extracti64x4_epi64::<1>(at),
        ]
        .map(|at| four_entries(table, at, false));
        _mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high)
    }
}

/// The entries of the table with these four indices.
///
/// SAFETY: the processor has AVX2, and each index is below the length of the table.
#[inline(always)]
unsafe fn four_entries(table: &LookupTable, at: __m256i, gathers: bool) -> __m256i {
    let pair = |at: __m128i| unsafe {
        let entry = |index: i64| table.as_ptr().add(index as usize).cast::<f64>();
        _mm_loadh_pd(
            _mm_load_sd(entry(_mm_cvtsi128_si64(at))),
            entry(_mm_extract_epi64::<1>(at)),
        )
    };
    unsafe {
        if gathers {
            return _mm256_i64gather_epi64::<8>(table.as_ptr().cast(), at);
        }
        let (low, high) = (
            pair(_mm256_castsi256_si128(at)),
            pair(_mm256_extracti128_si256::<1>(at)),
        );
        _mm256_castpd_si256(_mm256_set_m128d(high, low))
    }
}

/// Panics unless all eight rows are in the table. One comparison of all indices is cheaper than
/// eight.
#[inline(always)]
fn assert_in(table: &[Row], rows: &[u32; ROW]) {
    let length = table.len().min(i32::MAX as usize) as i32;
    // SAFETY: see the head of this file.
    let inside = unsafe {
        _mm256_cmplt_epu32_mask(
            _mm256_loadu_si256(rows.as_ptr().cast()),
            _mm256_set1_epi32(length),
        )
    };
    assert!(inside == 0xFF, "a row that the table does not have");
}

/// Transposes rows to columns: entry i of result k is entry k of row i.
#[inline(always)]
fn transposed(rows: [__m512d; 8]) -> [__m512d; 8] {
    let [r0, r1, r2, r3, r4, r5, r6, r7] = rows;
    unsafe {
        // Each register interleaves two rows: the first its even columns, the second its odd ones.
        let (a0, a1) = (_mm512_unpacklo_pd(r0, r1), _mm512_unpackhi_pd(r0, r1));
        let (a2, a3) = (_mm512_unpacklo_pd(r2, r3), _mm512_unpackhi_pd(r2, r3));
        let (a4, a5) = (_mm512_unpacklo_pd(r4, r5), _mm512_unpackhi_pd(r4, r5));
        let (a6, a7) = (_mm512_unpacklo_pd(r6, r7), _mm512_unpackhi_pd(r6, r7));
        // Each quarter of a register holds two rows of one column. The four registers of four rows
        // hold columns 0 and 4, 2 and 6, 1 and 5, and 3 and 7.
        let (b0, b2) = (
            _mm512_shuffle_f64x2::<0x88>(a0, a2),
            _mm512_shuffle_f64x2::<0xDD>(a0, a2),
        );
        let (b1, b3) = (
            _mm512_shuffle_f64x2::<0x88>(a1, a3),
            _mm512_shuffle_f64x2::<0xDD>(a1, a3),
        );
        let (b4, b6) = (
            _mm512_shuffle_f64x2::<0x88>(a4, a6),
            _mm512_shuffle_f64x2::<0xDD>(a4, a6),
        );
        let (b5, b7) = (
            _mm512_shuffle_f64x2::<0x88>(a5, a7),
            _mm512_shuffle_f64x2::<0xDD>(a5, a7),
        );
        [
            _mm512_shuffle_f64x2::<0x88>(b0, b4),
            _mm512_shuffle_f64x2::<0x88>(b1, b5),
            _mm512_shuffle_f64x2::<0x88>(b2, b6),
            _mm512_shuffle_f64x2::<0x88>(b3, b7),
            _mm512_shuffle_f64x2::<0xDD>(b0, b4),
            _mm512_shuffle_f64x2::<0xDD>(b1, b5),
            _mm512_shuffle_f64x2::<0xDD>(b2, b6),
            _mm512_shuffle_f64x2::<0xDD>(b3, b7),
        ]
    }
}

/// For each mask of the entries of a row, the numbers of those of the mask, at the front. Entries
/// written one by one would have to reach the cache before they could be read as a whole.
static PACKED: [[u32; ROW]; 1 << ROW] = {
    let (mut all, mut mask) = ([[0; ROW]; 1 << ROW], 0);
    while mask < 1 << ROW {
        let (mut lane, mut to) = (0, 0);
        while lane < ROW {
            if mask >> lane & 1 == 1 {
                all[mask][to] = lane as u32;
                to += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    all
};

/// Four lanes.
#[derive(Clone, Copy)]
struct Avx2(__m256d);

super::arithmetic! { Avx2,
    Add add(a, b) { unsafe { Avx2(_mm256_add_pd(a.0, b.0)) } }
    Sub sub(a, b) { unsafe { Avx2(_mm256_sub_pd(a.0, b.0)) } }
    Mul mul(a, b) { unsafe { Avx2(_mm256_mul_pd(a.0, b.0)) } }
    Div div(a, b) { unsafe { Avx2(_mm256_div_pd(a.0, b.0)) } }
}

impl Neg for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        unsafe { Avx2(_mm256_xor_pd(self.0, _mm256_set1_pd(-0.0))) }
    }
}

impl Lanes for Avx2 {
    const WIDTH: usize = 4;
    type Bits = __m256i;
    type Mask = __m256d;

    intrinsics! {
        fn splat(value: f64) -> Self { Avx2(_mm256_set1_pd(value)) }
        fn load(from: &[f64]) -> Self { Avx2(_mm256_loadu_pd(from[..4].as_ptr())) }
        fn store(self, to: &mut [f64]) { _mm256_storeu_pd(to[..4].as_mut_ptr(), self.0) }
        fn sqrt(self) -> Self { Avx2(_mm256_sqrt_pd(self.0)) }
        fn abs(self) -> Self { Avx2(_mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0)) }
        fn mul_add(self, factor: Self, term: Self) -> Self { Avx2(_mm256_fmadd_pd(self.0, factor.0, term.0)) }
        fn gt(self, other: Self) -> Self::Mask { _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, other.0) }
        fn lt(self, other: Self) -> Self::Mask { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) }
        fn ge(self, other: Self) -> Self::Mask { _mm256_cmp_pd::<_CMP_GE_OQ>(self.0, other.0) }
        fn le(self, other: Self) -> Self::Mask { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0) }
        fn select(mask: Self::Mask, a: Self, b: Self) -> Self { Avx2(_mm256_blendv_pd(b.0, a.0, mask)) }
        fn either(up: Self::Mask, a: Self, down: Self::Mask, b: Self) -> Self { Avx2(_mm256_or_pd(_mm256_and_pd(up, a.0), _mm256_and_pd(down, b.0))) }
        fn where_zero(self, zero: Self, other: Self) -> Self {
            let is_zero = _mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, _mm256_setzero_pd());
            Avx2(_mm256_blendv_pd(other.0, zero.0, is_zero))
        }
        fn add_where(self, other: Self, keep: Self::Mask) -> Self { Avx2(_mm256_and_pd(_mm256_add_pd(self.0, other.0), keep)) }
        fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask { _mm256_or_pd(a, b) }
        fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask { _mm256_and_pd(a, b) }
        fn not(mask: Self::Mask) -> Self::Mask { _mm256_andnot_pd(mask, Self::always()) }
        fn always() -> Self::Mask { _mm256_castsi256_pd(_mm256_set1_epi64x(-1)) }
        fn not_beyond(self, least: Self, most: Self, among: Self::Mask) -> Self::Mask {
            let above = _mm256_and_pd(among, _mm256_cmp_pd::<_CMP_NLT_UQ>(self.0, least.0));
            _mm256_and_pd(above, _mm256_cmp_pd::<_CMP_NGT_UQ>(self.0, most.0))
        }
        fn bitmask(mask: Self::Mask) -> u32 { _mm256_movemask_pd(mask) as u32 }
        fn lookup(table: &LookupTable, key: Self::Bits) -> Self::Bits {
            four_entries(table, _mm256_srli_epi64::<{ KEY_SHIFT as i32 }>(key), gathers())
        }
        fn to_bits(self) -> Self::Bits { _mm256_castpd_si256(self.0) }
        fn from_bits(bits: Self::Bits) -> Self { Avx2(_mm256_castsi256_pd(bits)) }
        fn splat_bits(value: u64) -> Self::Bits { _mm256_set1_epi64x(value as i64) }
        fn load_bits(from: &[u64]) -> Self::Bits { _mm256_loadu_si256(from[..4].as_ptr().cast()) }
        fn store_bits(bits: Self::Bits, to: &mut [u64]) { _mm256_storeu_si256(to[..4].as_mut_ptr().cast(), bits) }
        fn add_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits { _mm256_add_epi64(a, b) }
        /// The 64-bit product, composed of products of 32-bit halves.
        fn mul_bits(a: Self::Bits, b: Self::Bits) -> Self::Bits {
            let low = _mm256_mul_epu32(a, b);
            let crossed = _mm256_mullo_epi32(a, _mm256_shuffle_epi32::<0xB1>(b));
            let crossed = _mm256_add_epi32(_mm256_slli_epi64::<32>(crossed), crossed);
            _mm256_add_epi64(low, Self::keep_and_set(crossed, 0xFFFF_FFFF_0000_0000, 0))
        }
        fn xor(a: Self::Bits, b: Self::Bits) -> Self::Bits { _mm256_xor_si256(a, b) }
        fn keep_and_set(bits: Self::Bits, keep: u64, set: u64) -> Self::Bits { _mm256_or_si256(_mm256_and_si256(bits, Self::splat_bits(keep)), Self::splat_bits(set)) }
        fn shr<const N: u32>(bits: Self::Bits) -> Self::Bits { _mm256_srl_epi64(bits, _mm_cvtsi64_si128(i64::from(N))) }
        fn shl<const N: u32>(bits: Self::Bits) -> Self::Bits { _mm256_sll_epi64(bits, _mm_cvtsi64_si128(i64::from(N))) }
        fn rotate_left<const N: i32>(bits: Self::Bits) -> Self::Bits {
            let left = _mm256_sll_epi64(bits, _mm_cvtsi64_si128(i64::from(N)));
            _mm256_or_si256(left, _mm256_srl_epi64(bits, _mm_cvtsi64_si128(i64::from(64 - N))))
        }
    }

    super::inlined! {
        fn gather_rows(table: &[Row], rows: &[u32; ROW]) -> [Self; ROW] {
            let rows = [
                &table[rows[0] as usize].0,
                &table[rows[1] as usize].0,
                &table[rows[2] as usize].0,
                &table[rows[3] as usize].0,
            ];
            let low = transposed4([
                Self::load(&rows[0][..4]),
                Self::load(&rows[1][..4]),
                Self::load(&rows[2][..4]),
                Self::load(&rows[3][..4]),
            ]);
            let high = transposed4([
                Self::load(&rows[0][4..]),
                Self::load(&rows[1][4..]),
                Self::load(&rows[2][4..]),
                Self::load(&rows[3][4..]),
            ]);
            [low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]]
        }
        fn scatter_rows(c: [Self; ROW], table: &mut [Row], rows: &[u32; ROW]) {
            let (low, high) = (transposed4([c[0], c[1], c[2], c[3]]), transposed4([c[4], c[5], c[6], c[7]]));
            let rows = &rows[..4];
            let mut i = 0;
            while i < 4 {
                let row = &mut table[rows[i] as usize].0;
                low[i].store(&mut row[..4]);
                high[i].store(&mut row[4..]);
                i += 1;
            }
        }
        fn compress(entries: &[u32; ROW], lanes: u32) -> [u32; ROW] {
            let mut all = [0; ROW];
            unsafe {
                let places = _mm256_loadu_si256(PACKED[lanes as usize & 0xFF].as_ptr().cast());
                let packed = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(entries.as_ptr().cast()), places);
                _mm256_storeu_si256(all.as_mut_ptr().cast(), packed);
            }
            all
        }
        fn xor3(a: Self::Bits, b: Self::Bits, c: Self::Bits) -> Self::Bits { Self::xor(Self::xor(a, b), c) }
        /// AVX2 has no instruction for this conversion. The upper 16 bits, signed, are added to the
        /// mantissa of 3 2^67, at the place that is worth 2^48, and the lower 48 bits become the
        /// mantissa of 2^52. Subtracting both constants from the former is exact, so only the last
        /// addition rounds.
        fn from_integers(bits: Self::Bits) -> Self {
            const UPPER: f64 = 442_721_857_769_029_238_784.0; // 3 2^67
            const LOWER: f64 = 4_503_599_627_370_496.0; // 2^52
            unsafe {
                let upper = _mm256_blend_epi16::<0x33>(_mm256_srai_epi32::<16>(bits), _mm256_setzero_si256());
                let upper = Self::add_bits(upper, _mm256_castpd_si256(_mm256_set1_pd(UPPER)));
                let lower = _mm256_blend_epi16::<0x88>(bits, _mm256_castpd_si256(_mm256_set1_pd(LOWER)));
                let upper = _mm256_sub_pd(_mm256_castsi256_pd(upper), _mm256_set1_pd(UPPER + LOWER));
                Avx2(_mm256_add_pd(upper, _mm256_castsi256_pd(lower)))
            }
        }
    }
}

/// Transposes rows to columns: entry i of result k is entry k of row i.
#[inline(always)]
fn transposed4([r0, r1, r2, r3]: [Avx2; 4]) -> [Avx2; 4] {
    unsafe {
        let (a0, a1) = (
            _mm256_unpacklo_pd(r0.0, r1.0),
            _mm256_unpackhi_pd(r0.0, r1.0),
        );
        let (a2, a3) = (
            _mm256_unpacklo_pd(r2.0, r3.0),
            _mm256_unpackhi_pd(r2.0, r3.0),
        );
        [
            Avx2(_mm256_permute2f128_pd::<0x20>(a0, a2)),
            Avx2(_mm256_permute2f128_pd::<0x20>(a1, a3)),
            Avx2(_mm256_permute2f128_pd::<0x31>(a0, a2)),
            Avx2(_mm256_permute2f128_pd::<0x31>(a1, a3)),
        ]
    }
}
