//! Compares every operation of every instruction set with the scalar lane, bit for bit. The tests
//! are small enough for Miri:
//!
//! ```text
//! MIRIFLAGS=-Zmiri-disable-isolation RUSTFLAGS="-C target-feature=+avx2,+fma,+popcnt" \
//!     cargo +nightly miri test --no-default-features --lib lanes::tests
//! ```

use super::*;

/// Numbers for which implementations may differ: zeros of both signs, subnormal and infinite
/// numbers, NaN, and numbers whose sums and products are ties of rounding.
const EDGES: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::MIN_POSITIVE,
    -5e-324,
    f64::MAX,
    f64::MIN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    1.0 + f64::EPSILON,
    -0.1,
    1e300,
    9_007_199_254_740_993.0,
    2.5,
];

/// Integers for which implementations may differ.
const WORDS: [u64; 8] = [
    0,
    1,
    u64::MAX,
    1 << 63,
    (1 << 63) - 1,
    0xFFFF_FFFF,
    0xFFFF_FFFF_0000_0000,
    (1 << 53) + 1,
];

/// Triples of numbers and of integers: every pair of edge cases with some third one, and then
/// random bits.
struct Inputs {
    numbers: [Vec<f64>; 3],
    words: [Vec<u64>; 3],
}

impl Inputs {
    fn new() -> Self {
        let random = if cfg!(miri) { 16 } else { 1 << 16 };
        let mut state = 0_u64;
        let mut next = || {
            // The generator is SplitMix64.
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mixed = (state ^ state >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
            mixed ^ mixed >> 31
        };
        let edges = EDGES.len() * EDGES.len();
        let edge = |column: usize, i: usize| {
            EDGES[[i, i / EDGES.len(), i * 7 + i / 5][column] % EDGES.len()]
        };
        let word = |column: usize, i: usize| {
            WORDS[[i, i / WORDS.len(), i * 3 + i / 7][column] % WORDS.len()]
        };
        let mut filled = |column: usize| -> (Vec<f64>, Vec<u64>) {
            let drawn: Vec<u64> = (0..random).map(|_| next()).collect();
            // Half of the random numbers lie between 1/2 and 2, where results round differently
            // most often.
            let near = |bits: u64| {
                f64::from_bits(if bits & 1 == 0 {
                    bits
                } else {
                    bits >> 11 | 0x3FE0 << 48
                })
            };
            let numbers = (0..edges)
                .map(|i| edge(column, i))
                .chain(drawn.iter().map(|&bits| near(bits)));
            (
                numbers.collect(),
                (0..edges)
                    .map(|i| word(column, i))
                    .chain(drawn.iter().copied())
                    .collect(),
            )
        };
        let (a, b, c) = (filled(0), filled(1), filled(2));
        Inputs {
            numbers: [a.0, b.0, c.0],
            words: [a.1, b.1, c.1],
        }
    }
}

/// Runs all operations on all inputs and keeps the bits of every result, by operation and lane.
struct All<'a> {
    inputs: &'a Inputs,
    table: &'a LookupTable,
    results: Vec<(&'static str, Vec<u64>)>,
    /// The index of the operation whose results are kept next.
    next: usize,
}

impl All<'_> {
    fn keep(&mut self, name: &'static str, lanes: &[u64]) {
        match self.results.get_mut(self.next) {
            Some((_, all)) => all.extend(lanes),
            None => self.results.push((name, lanes.to_vec())),
        }
        self.next += 1;
    }

    /// Keeps numbers. All NaNs count as equal, because IEEE 754 does not define their bits.
    fn numbers<L: Lanes>(&mut self, name: &'static str, lanes: L) {
        let mut to = [0.0; ROW];
        lanes.store(&mut to);
        let bits = to.map(|x| {
            if x.is_nan() {
                f64::NAN.to_bits()
            } else {
                x.to_bits()
            }
        });
        self.keep(name, &bits[..L::WIDTH]);
    }

    fn words<L: Lanes>(&mut self, name: &'static str, bits: L::Bits) {
        let mut to = [0; ROW];
        L::store_bits(bits, &mut to);
        self.keep(name, &to[..L::WIDTH]);
    }

    fn mask<L: Lanes>(&mut self, name: &'static str, mask: L::Mask) {
        let bits = L::bitmask(mask);
        assert_eq!(
            u64::from(bits) >> L::WIDTH,
            0,
            "{name}: bits beyond the lanes"
        );
        let lanes: [u64; ROW] = std::array::from_fn(|i| u64::from(bits >> i & 1));
        self.keep(name, &lanes[..L::WIDTH]);
    }
}

impl LaneProgram for All<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let Inputs { numbers, words } = self.inputs;
        for i in (0..numbers[0].len()).step_by(L::WIDTH) {
            self.next = 0;
            let [a, b, c] = [
                L::load(&numbers[0][i..]),
                L::load(&numbers[1][i..]),
                L::load(&numbers[2][i..]),
            ];
            self.numbers("add", a + b);
            self.numbers("sub", a - b);
            self.numbers("mul", a * b);
            self.numbers("div", a / b);
            self.numbers("neg", -a);
            self.numbers("add a number", a + 0.1);
            self.numbers("sub a number", a - 0.1);
            self.numbers("mul by a number", a * 0.1);
            self.numbers("splat", L::splat(-0.1));
            self.numbers("sqrt", a.sqrt());
            self.numbers("abs", a.abs());
            self.numbers("mul_add", a.mul_add(b, c));
            let (gt, lt, ge, le) = (a.gt(b), a.lt(b), a.ge(b), a.le(b));
            self.mask::<L>("gt", gt);
            self.mask::<L>("lt", lt);
            self.mask::<L>("ge", ge);
            self.mask::<L>("le", le);
            self.mask::<L>("or", L::or(gt, b.lt(c)));
            self.mask::<L>("and", L::and(gt, b.lt(c)));
            self.mask::<L>("not", L::not(gt));
            self.mask::<L>("always", L::always());
            self.mask::<L>("not_beyond", a.not_beyond(b, c, L::always()));
            self.mask::<L>("not_beyond, of some", a.not_beyond(b, c, b.lt(c)));
            self.numbers("select", L::select(gt, b, c));
            self.numbers("either", L::either(gt, b, lt, c));
            self.numbers("where_zero", a.where_zero(b, c));
            self.numbers("add_where", a.add_where(b, b.lt(c)));
            self.numbers("or_at_least", a.or_at_least(b));
            self.numbers("or_at_most", a.or_at_most(b));
            self.words::<L>("to_bits", L::select(L::always(), b, c).to_bits());
            let [p, q, r] = [
                L::load_bits(&words[0][i..]),
                L::load_bits(&words[1][i..]),
                L::load_bits(&words[2][i..]),
            ];
            self.numbers("from_bits", L::from_bits(p));
            self.numbers("from_integers", L::from_integers(p));
            self.words::<L>("splat_bits", L::splat_bits(0x0123_4567_89AB_CDEF));
            self.words::<L>("add_bits", L::add_bits(p, q));
            self.words::<L>("mul_bits", L::mul_bits(p, q));
            self.words::<L>("xor", L::xor(p, q));
            self.words::<L>("xor3", L::xor3(p, q, r));
            self.words::<L>(
                "keep_and_set",
                L::keep_and_set(p, 0x00FF_00FF_0F0F_3333, 0x8100_0000_0000_0001),
            );
            self.words::<L>("shr", L::shr::<11>(p));
            self.words::<L>("shr by 63", L::shr::<63>(p));
            self.words::<L>("shl", L::shl::<17>(p));
            self.words::<L>("shl by 63", L::shl::<63>(p));
            self.words::<L>("rotate_left", L::rotate_left::<45>(p));
            self.words::<L>("rotate_left by 1", L::rotate_left::<1>(p));
            self.words::<L>("rotate_left by 63", L::rotate_left::<63>(p));
            self.words::<L>("lookup", L::lookup(self.table, p));
        }
    }
}

/// Runs the operations on rows, whose results are not one number for each lane.
struct Moved {
    columns: Vec<[u64; ROW]>,
    scattered: Vec<[u64; ROW]>,
    compressed: Vec<u32>,
}

impl LaneProgram for Moved {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let value = |row: usize, column: usize| (100 * row + column) as f64 + 0.5;
        let mut table: Vec<Row> = (0..32)
            .map(|row| Row(std::array::from_fn(|column| value(row, column))))
            .collect();
        let order: [u32; 16] = [5, 0, 31, 7, 12, 2, 30, 11, 1, 9, 8, 3, 4, 29, 6, 10];
        for rows in order.chunks(L::WIDTH) {
            let mut padded = [0; ROW];
            padded[..L::WIDTH].copy_from_slice(rows);
            let columns = L::gather_rows(&table, &padded);
            let mut lanes = [[0; ROW]; ROW];
            for (column, entries) in columns.iter().enumerate() {
                let mut to = [0.0; ROW];
                entries.store(&mut to);
                (0..L::WIDTH).for_each(|lane| lanes[lane][column] = to[lane].to_bits());
            }
            self.columns.extend(&lanes[..L::WIDTH]);
            L::scatter_rows(columns.map(|column| column * 2.0), &mut table, &padded);
        }
        self.scattered = table.iter().map(|row| row.0.map(f64::to_bits)).collect();
        let entries: [u32; ROW] =
            std::array::from_fn(|i| 1_000_000_007_u32.wrapping_mul(i as u32 + 1));
        for lanes in 0..1 << L::WIDTH {
            let count = u32::count_ones(lanes) as usize;
            self.compressed
                .extend(&L::compress(&entries, lanes)[..count]);
            let expected: Vec<u32> = (0..L::WIDTH)
                .filter(|i| lanes >> i & 1 == 1)
                .map(|i| entries[i])
                .collect();
            assert!(self.compressed.ends_with(&expected), "lanes {lanes:b}");
        }
    }
}

/// Every kind of lanes of this processor: an instruction set, and whether its registers are paired
/// where they have four lanes.
fn lanes() -> impl Iterator<Item = (InstructionSet, bool)> {
    available()
        .into_iter()
        .flat_map(|set| [(set, false), (set, true)])
}

fn run(set: InstructionSet, is_paired: bool, program: &mut impl LaneProgram) {
    if is_paired {
        set.run_paired(program)
    } else {
        set.run(program)
    }
}

fn available() -> Vec<InstructionSet> {
    let all: Vec<InstructionSet> = InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
        .collect();
    // If the test was compiled for an instruction set, as under Miri, that set must be among the
    // tested.
    assert!(
        !cfg!(target_feature = "avx2") || all.contains(&InstructionSet::Avx2),
        "{all:?}"
    );
    eprintln!("lanes: {all:?}");
    all
}

#[test]
fn every_operation_has_the_bits_of_the_scalar_lane() {
    let inputs = Inputs::new();
    let mut table: Box<LookupTable> = vec![0; 1 << (u64::BITS - KEY_SHIFT)]
        .try_into()
        .expect("of this length");
    for word in inputs.words[0].iter() {
        table[(word >> KEY_SHIFT) as usize] = word.rotate_left(9) ^ 0x5555;
    }
    let new = || All {
        inputs: &inputs,
        table: &table,
        results: Vec::new(),
        next: 0,
    };
    let mut scalar = new();
    scalar.run::<f64>();
    assert_eq!(scalar.results.len(), 45);
    for (set, is_paired) in lanes() {
        let mut wide = new();
        run(set, is_paired, &mut wide);
        assert_eq!(wide.results.len(), scalar.results.len());
        for ((name, found), (_, expected)) in wide.results.iter().zip(&scalar.results) {
            let differs = found.iter().zip(expected).position(|(a, b)| a != b);
            assert!(
                found.len() == expected.len() && differs.is_none(),
                "{name} on {}, in pairs {is_paired}: number {differs:?} of {} is {:x?} and not {:x?}",
                set.name(),
                found.len(),
                differs.map(|i| found[i]),
                differs.map(|i| expected[i]),
            );
        }
    }
}

#[test]
fn rows_are_gathered_scattered_and_compressed_alike() {
    let new = || Moved {
        columns: Vec::new(),
        scattered: Vec::new(),
        compressed: Vec::new(),
    };
    let mut scalar = new();
    scalar.run::<f64>();
    for (set, is_paired) in lanes() {
        let mut wide = new();
        run(set, is_paired, &mut wide);
        assert_eq!(wide.columns.len(), 16);
        assert!(
            wide.columns == scalar.columns && wide.scattered == scalar.scattered,
            "{}, in pairs {is_paired}",
            set.name()
        );
    }
}

/// Gather instructions read what single loads read, whichever is used here.
#[cfg(target_arch = "x86_64")]
#[test]
fn both_ways_of_a_lookup_read_the_same_entries() {
    let cells = crate::noise::cells();
    let keys: Vec<u64> = (1..=4096u64)
        .map(|i| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) as i64 as f64).to_bits())
        .collect();
    let entries = keys.iter().map(|key| cells[(key >> KEY_SHIFT) as usize]);
    let right = entries.fold(0, u64::wrapping_add);
    for way in super::x86::ways().into_iter().flatten() {
        assert_eq!(way(cells, &keys), right);
    }
}
