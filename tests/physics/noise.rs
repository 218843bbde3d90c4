//! The random numbers: the generator is the documented one, streams are independent, and normals
//! are normal.
//!
//! Every statistical test states its null hypothesis, sample size and false-alarm rate. Seeds are
//! fixed, so a test always passes or always fails.

use rand_xoshiro::Xoshiro256Plus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use stickslip::lanes::InstructionSet;
use stickslip::noise::{AddressedDraws, LaneStreams, Stream, standard_normal};

#[test]
fn a_stream_is_xoshiro256_plus_from_its_state() {
    for (seed, path) in [(1, 0), (1, 1), (u64::MAX, 1 << 40)] {
        let mut ours = Stream::new(seed, path);
        let bytes: Vec<u8> = ours
            .state()
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .collect();
        let mut theirs = Xoshiro256Plus::from_seed(bytes.try_into().expect("32 bytes"));
        for _ in 0..1000 {
            assert_eq!(ours.next_u64(), theirs.next_u64());
        }
    }
}

/// The values are fixed here, so that a change of the generator, of its seeding or of the normals
/// cannot go unnoticed: it would alter every result.
#[test]
fn the_first_values_never_change() {
    let mut stream = Stream::new(1, 4711);
    let draws: Vec<u64> = (0..3).map(|_| stream.next_u64()).collect();
    assert_eq!(draws, PINNED_DRAWS);
    let pair = Stream::new(1, 4711).normal_pair();
    assert_eq!(
        pair,
        [draws[0], draws[0].rotate_right(32)].map(standard_normal)
    );
    assert_eq!(
        draws
            .iter()
            .map(|&d| standard_normal(d).to_bits())
            .collect::<Vec<_>>(),
        PINNED_NORMALS
    );
}

const PINNED_DRAWS: [u64; 3] = [
    15416075624907741186,
    9508115752145081868,
    11747578446230996153,
];
const PINNED_NORMALS: [u64; 3] = [
    13830346988445976151,
    13809110395695062451,
    13823349025215307354,
];

/// `steps` normals of each of the paths `first..first + lanes`, as `[step][lane]`.
fn normals(set: InstructionSet, seed: u64, first: u64, lanes: usize, steps: usize) -> Vec<f64> {
    let paths: Vec<u64> = (first..first + lanes as u64).collect();
    LaneStreams::new(seed, &paths, lanes).normals(steps, set)
}

/// The lanes draw the same numbers however the drawing is divided into calls, even if a pair of
/// normals is divided.
#[test]
fn lanes_draw_what_streams_draw_on_every_instruction_set() {
    let lanes = 16;
    let paths: Vec<u64> = (1000..1000 + lanes as u64).collect();
    for set in InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
    {
        let mut streams = LaneStreams::new(5, &paths, lanes);
        let all: Vec<f64> = [1, 4, 7, 3000]
            .into_iter()
            .flat_map(|steps| streams.normals(steps, set))
            .collect();
        for (lane, &path) in paths.iter().enumerate() {
            let mut stream = Stream::new(5, path);
            let pairs = std::iter::repeat_with(|| stream.normal_pair()).flatten();
            for (step, (row, normal)) in all.chunks(lanes).zip(pairs).enumerate() {
                assert_eq!(
                    row[lane].to_bits(),
                    normal.to_bits(),
                    "{} {lane} {step}",
                    set.name()
                );
            }
        }
    }
}

/// Null hypothesis: the two normals of one draw are independent. Sample size: 2^24 pairs. The joint
/// counts of 16 x 16 cells of equal probability are chi-square with 255 degrees of freedom and are
/// tested at 1e-5. The correlations of the values, of their squares, and of each with the square of
/// the other must be below 5 standard deviations. Where one normal is beyond 3 sigma, where the
/// halves of a draw might overlap, the variance of the other must be 1 within 5 standard
/// deviations. False-alarm rate: below 2e-5. A rotation by 8 bits instead of 32 gives a correlation
/// of 34 standard deviations.
#[test]
fn the_two_normals_of_a_draw_are_independent() {
    let (lanes, pairs) = (256, 1 << 16);
    let z = normals(InstructionSet::detect(), 21, 0, lanes, 2 * pairs);
    let cell =
        |z: f64| ((0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2) * 16.0) as usize).min(15);
    let mut counts = [0u64; 256];
    let mut moments = [0.0; 4];
    let (mut beyond, mut beside) = (0.0, 0.0);
    for rows in z.chunks(2 * lanes) {
        for (&a, &b) in rows[..lanes].iter().zip(&rows[lanes..]) {
            counts[16 * cell(a) + cell(b)] += 1;
            let (aa, bb) = (
                (a * a - 1.0) / f64::sqrt(2.0),
                (b * b - 1.0) / f64::sqrt(2.0),
            );
            for (moment, product) in moments.iter_mut().zip([a * b, aa * bb, aa * b, a * bb]) {
                *moment += product;
            }
            for (one, other) in [(a, b), (b, a)] {
                if one.abs() > 3.0 {
                    beyond += 1.0;
                    beside += other * other - 1.0;
                }
            }
        }
    }
    let n = (lanes * pairs) as f64;
    let chi: f64 = counts
        .iter()
        .map(|&count| (count as f64 - n / 256.0).powi(2) / (n / 256.0))
        .sum();
    let p = 1.0 - ChiSquared::new(255.0).expect("255 > 0").cdf(chi);
    assert!(p > 1e-5, "chi-square {chi} over 256 cells, p = {p}");
    for moment in moments {
        assert!((moment / n).abs() < 5.0 / n.sqrt(), "{moments:?} of {n}");
    }
    assert!(
        beyond > 80_000.0 && (beside / beyond).abs() < 5.0 * f64::sqrt(2.0 / beyond),
        "{beside} of {beyond}"
    );
}

/// Null hypothesis: the states of neighbouring paths, and of neighbouring seeds, are independent
/// uniform words, so that in a pair of words each of 64 bits differs with probability 1/2. Sample
/// size: 2^16 pairs, so that the count of each bit has a standard deviation of 128. Bound: 6
/// standard deviations. False-alarm rate: below 4e-6 for all 1536 counts together. The seeds
/// `seed + i`, or increments of one linear congruential generator, fail by hundreds of standard
/// deviations.
#[test]
fn neighbouring_paths_and_seeds_share_no_bit_of_state() {
    let pairs = 1u64 << 16;
    for neighbour in [(0, 1), (0, 2), (0, 64), (1, 0), (1 << 63, 0), (1, 1)] {
        let mut differ = [[0i64; 64]; 4];
        for path in 0..pairs {
            let (a, b) = (
                Stream::new(17, path).state(),
                Stream::new(17 ^ neighbour.0, path + neighbour.1).state(),
            );
            for (word, counts) in differ.iter_mut().enumerate() {
                for (bit, count) in counts.iter_mut().enumerate() {
                    *count += ((a[word] ^ b[word]) >> bit & 1) as i64;
                }
            }
        }
        for count in differ.iter().flatten() {
            assert!(
                (count - pairs as i64 / 2).abs() < 6 * 128,
                "{neighbour:?}: {count}"
            );
        }
    }
}

/// Null hypothesis: normals of different paths at the same step, of a path and its neighbour one
/// step later, and of one path at small lags are uncorrelated, so that n r^2 is chi-square with one
/// degree of freedom. Their squares are tested too, to find a dependence of the sizes. Sample size:
/// n = 4e6 products for each of 25 correlations. Bound: 5 standard deviations. False-alarm rate:
/// below 2e-5.
#[test]
fn normals_are_uncorrelated_across_paths_and_along_them() {
    let (lanes, steps) = (2048, 2048);
    let z = normals(InstructionSet::detect(), 3, 0, lanes, steps);
    let at = |step: usize, lane: usize| z[step * lanes + lane];
    let mut pairs: Vec<(usize, usize)> = vec![
        (0, 1),
        (0, 2),
        (0, 3),
        (0, 8),
        (0, 32),
        (0, 256),
        (1, 1),
        (1, 0),
        (2, 0),
        (3, 0),
        (7, 0),
        (64, 0),
    ];
    pairs.push((17, 5));
    for (lag, shift) in pairs {
        let (mut sum, mut squares, mut n) = (0.0, 0.0, 0.0);
        for step in 0..steps - lag {
            for lane in 0..lanes - shift {
                let (a, b) = (at(step, lane), at(step + lag, lane + shift));
                sum += a * b;
                squares += (a * a - 1.0) * (b * b - 1.0) / 2.0;
                n += 1.0;
            }
        }
        for correlation in [sum / n, squares / n] {
            assert!(
                correlation.abs() < 5.0 / f64::sqrt(n),
                "lag {lag}, shift {shift}: {correlation} of sd {}",
                1.0 / f64::sqrt(n)
            );
        }
    }
}

/// Null hypothesis: a sample is standard normal. Tested are a chi-square over 64 cells of equal
/// probability, the tails beyond 3, 4 and 5 sigma, and the moments. False-alarm rate: about 1e-5
/// for each test. The samples are the first normals of many paths (across streams) and the normals
/// of a few paths (along streams).
fn assert_normal(sample: impl Iterator<Item = f64>) {
    let (mut cells, mut n) = ([0u64; 64], 0u64);
    let mut beyond = [0u64; 6];
    let (mut mean, mut square, mut fourth) = (0.0, 0.0, 0.0);
    for z in sample {
        // libm's erfc is accurate to its last digit, that of statrs only to 1e-10.
        let p = 0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2);
        cells[((p * 64.0) as usize).min(63)] += 1;
        for (sigma, count) in beyond.iter_mut().enumerate() {
            *count += u64::from(z.abs() > sigma as f64);
        }
        (mean, square, fourth) = (mean + z, square + z * z, fourth + z.powi(4));
        n += 1;
    }
    let total = n as f64;
    let chi: f64 = cells
        .iter()
        .map(|&c| (c as f64 - total / 64.0).powi(2) / (total / 64.0))
        .sum();
    let p = 1.0 - ChiSquared::new(63.0).expect("63 > 0").cdf(chi);
    assert!(p > 1e-5, "chi-square {chi} over 64 cells, p = {p}");
    for (sigma, &count) in beyond.iter().enumerate().skip(3) {
        let expected = total * libm::erfc(sigma as f64 * std::f64::consts::FRAC_1_SQRT_2);
        // The counts follow Poisson's law: 4.5 standard deviations are allowed, and one count more
        // where few are expected.
        assert!(
            (count as f64 - expected).abs() < 4.5 * expected.sqrt() + 1.0,
            "{sigma} sigma: {count} of {expected}"
        );
    }
    assert!((mean / total).abs() < 4.5 / total.sqrt());
    assert!((square / total - 1.0).abs() < 4.5 * (2.0 / total).sqrt());
    assert!((fourth / total - 3.0).abs() < 4.5 * (96.0 / total).sqrt());
}

#[test]
fn normals_are_normal_across_streams() {
    assert_normal((0..4_000_000).map(|path| Stream::new(11, path).normal()));
}

#[test]
fn normals_are_normal_along_streams() {
    assert_normal(normals(InstructionSet::detect(), 12, 0, 64, 1 << 17).into_iter());
}

/// The output function of SplitMix64 with a key between its two rounds, from the published
/// constants. With the key 0 it is SplitMix64 itself, whose first outputs from the seed 0 are well
/// known.
fn keyed(z: u64, key: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9) ^ key;
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A number with an address is that of the documented generator, wherever the cursor was before.
/// The values are fixed, because a change would alter every result.
#[test]
fn an_addressed_number_is_a_function_of_its_address() {
    const GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;
    assert_eq!(
        [1, 2].map(|i| keyed(GAMMA.wrapping_mul(i), 0)),
        [0xE220_A839_7B1D_CDAF, 0x6E78_9E6A_A1B9_65F4]
    );
    let word = |seed: u64, path: u64, i: u64| {
        let origin = keyed(seed.wrapping_add((i + 1).wrapping_mul(GAMMA)), 0);
        keyed(origin.wrapping_add((path + 1).wrapping_mul(GAMMA)), 0)
    };
    for (seed, path, cell, place) in [
        (1, 0, 0, 0),
        (7, 4711, 3, 5),
        (u64::MAX, 1 << 40, (1 << 31) - 1, 1 << 20),
    ] {
        let (origin, key) = (word(seed, path, 4), word(seed, path, 5));
        let expected = |i: u64| {
            keyed(
                origin.wrapping_add(((cell << 32) + place + i).wrapping_mul(GAMMA)),
                key,
            )
        };
        let mut draws = AddressedDraws::new(seed, path).at(9, 9).at(cell, place);
        assert_eq!(
            [draws.next_u64(), draws.next_u64(), draws.next_u64()],
            [expected(0), expected(1), expected(2)]
        );
    }
}

/// Null hypothesis: numbers at neighbouring addresses are independent: of one cell and the next, of
/// one place and the next, of a path and the next, of a seed and the next, and of two of these at
/// once. Tested are the correlations of the normals and of their squares. Sample size: n = 4e6
/// products for each of 12 correlations. Bound: 5 standard deviations. False-alarm rate: below
/// 1e-5. With the same key for all paths, and a counter that is the sum of path, cell and place,
/// every second correlation would be 1.
#[test]
fn numbers_at_neighbouring_addresses_are_uncorrelated() {
    let at = |seed: u64, path: u64, cell: u64, place: u64| {
        AddressedDraws::new(seed, path).at(cell, place).normal()
    };
    for (seed, path, cell, place) in [
        (0, 0, 1, 0),
        (0, 0, 0, 1),
        (0, 1, 0, 0),
        (1, 0, 0, 0),
        (0, 1, 1, 0),
        (0, 0, 1, 1),
    ] {
        let (mut sum, mut squares, mut n) = (0.0, 0.0, 0.0);
        for p in 0..4000 {
            for c in 0..1000 {
                let (a, b) = (at(3, p, c, 0), at(3 + seed, p + path, c + cell, place));
                sum += a * b;
                squares += (a * a - 1.0) * (b * b - 1.0) / 2.0;
                n += 1.0;
            }
        }
        for correlation in [sum / n, squares / n] {
            let bound = 5.0 / f64::sqrt(n);
            assert!(
                correlation.abs() < bound,
                "{:?}: {correlation}",
                (seed, path, cell, place)
            );
        }
    }
}

/// The samples are numbers of all cells of some paths at their first place, and of one cell and
/// place of many paths.
#[test]
fn addressed_normals_are_normal() {
    let path = |p: u64| AddressedDraws::new(13, p);
    assert_normal((0..40).flat_map(|p| (0..100_000).map(move |cell| path(p).at(cell, 0).normal())));
    assert_normal((0..4_000_000).map(|p| path(p).at(17, 2).normal()));
    assert_normal((0..4).flat_map(|p| {
        let mut draws = path(p).at(5, 0);
        std::iter::repeat_with(move || draws.three_normals())
            .take(300_000)
            .flatten()
    }));
}

/// The long test: 2^32 normals (4.3e9) of 2^15 paths compared with the exact tail probabilities in
/// cells of half a sigma out to 6.5 sigma, with moments, and with correlations along and across
/// lanes. It takes about a minute on one core: `cargo test --release --test physics noise:: --
/// --ignored --nocapture`.
#[test]
#[ignore = "four billion draws: a minute"]
fn four_billion_normals() {
    let (lanes, steps, blocks) = (1024, 2048, 2048u64);
    let mut cells = [0u64; 28]; // half a sigma each, both signs apart
    let (mut n, mut square, mut across, mut along) = (0.0, 0.0, 0.0, 0.0);
    for block in 0..blocks {
        let z = normals(
            InstructionSet::detect(),
            99,
            block * lanes as u64,
            lanes,
            steps,
        );
        for (i, &value) in z.iter().enumerate() {
            let cell = ((value.abs() * 2.0) as usize).min(13);
            cells[2 * cell + usize::from(value < 0.0)] += 1;
            square += value * value;
            if i >= lanes {
                along += value * z[i - lanes];
                across += value * z[i - 1];
            }
        }
        n += z.len() as f64;
    }
    let upper = |x: f64| 0.5 * libm::erfc(x * std::f64::consts::FRAC_1_SQRT_2);
    let (mut chi, mut degrees) = (0.0, -1.0);
    for (i, &count) in cells.iter().enumerate() {
        let low = (i / 2) as f64 / 2.0;
        let expected = n * (upper(low) - if i / 2 == 13 { 0.0 } else { upper(low + 0.5) });
        println!(
            "{} {low:.1} sigma and on: {count} of {expected:.2}",
            if i % 2 == 0 { '+' } else { '-' }
        );
        if expected > 5.0 {
            chi += (count as f64 - expected).powi(2) / expected;
            degrees += 1.0;
        } else {
            assert!(
                count <= 6,
                "{low} sigma: {count} where {expected} are expected"
            );
        }
    }
    let p = 1.0 - ChiSquared::new(degrees).expect("positive").cdf(chi);
    println!("{n} normals: chi-square {chi:.2} with {degrees} degrees of freedom, p = {p:.3}");
    println!(
        "variance - 1 = {:.2e} (sd {:.1e})",
        square / n - 1.0,
        (2.0 / n).sqrt()
    );
    println!(
        "correlation along {:.2e}, across {:.2e} (sd {:.1e})",
        along / n,
        across / n,
        1.0 / n.sqrt()
    );
    assert!(p > 1e-4);
    assert!((square / n - 1.0).abs() < 5.0 * (2.0 / n).sqrt());
    assert!((along / n).abs() < 5.0 / n.sqrt() && (across / n).abs() < 5.0 / n.sqrt());
}
