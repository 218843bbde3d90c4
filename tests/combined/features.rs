//! The table of features, and a list of scenes in which every pair of features occurs.

use rand_distr::{Distribution as _, StandardUniform};
use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::SeedableRng as _;

/// A feature, and what a scene may have of it. The first is the plainest.
pub type Feature = (&'static str, &'static [&'static str]);

/// The features. Those of several kinds come first, because the list of scenes grows with the
/// product of the two largest numbers of kinds.
pub const FEATURES: [Feature; 16] = [
    (
        "force",
        &["none", "of x", "of x'", "of t", "of direction", "linear"],
    ),
    ("load", &["none", "sides", "of x", "of x'", "of t"]),
    ("noise", &["none", "one", "two", "white", "pinned"]),
    (
        "damping",
        &["none", "weak", "critical", "strong", "negative"],
    ),
    ("harmonics", &["none", "one", "two"]),
    ("line", &["none", "offset", "trend"]),
    ("series", &["none", "close", "wide"]),
    ("input", &["none", "in force", "in load"]),
    ("start", &["balanced", "outside", "moving"]),
    ("spring", &["some", "none"]),
    ("drive", &["force", "dilatation"]),
    ("friction", &["gap", "narrow", "equal"]),
    ("burn-in", &["none", "some"]),
    ("end", &["on the grid", "off the grid"]),
    ("pairs", &["none", "antithetic"]),
    ("rows", &["fine", "coarse"]),
];

/// Pairs that no scenario can have.
const FORBIDDEN: [[(&str, &str); 2]; 4] = [
    // White noise overcomes any difference between f_s and f_d at once.
    [("noise", "white"), ("friction", "gap")],
    [("noise", "white"), ("friction", "narrow")],
    // Noise is pinned to samples.
    [("noise", "pinned"), ("series", "none")],
    // The temperature moves the rest position of a spring.
    [("spring", "none"), ("drive", "dilatation")],
];

/// What a scene has of each feature, as places in the table.
pub type Choice = [usize; FEATURES.len()];

/// A feature and a kind of it, as places in the table.
type Kind = (usize, usize);

fn is_forbidden(a: Kind, b: Kind) -> bool {
    let named = |(feature, kind): Kind| (FEATURES[feature].0, FEATURES[feature].1[kind]);
    let pair = [named(a), named(b)];
    FORBIDDEN
        .iter()
        .any(|forbidden| pair == *forbidden || [pair[1], pair[0]] == *forbidden)
}

/// The pairs that no scene has yet, by both kinds.
struct Missing(Vec<[Kind; 2]>);

impl Missing {
    /// All pairs of kinds of different features that a scene may have.
    fn all() -> Self {
        let kinds =
            |feature: usize| (0..FEATURES[feature].1.len()).map(move |kind| (feature, kind));
        let mut pairs = Vec::new();
        for second in 0..FEATURES.len() {
            for first in 0..second {
                for a in kinds(first) {
                    let allowed = kinds(second).filter(|b| !is_forbidden(a, *b));
                    pairs.extend(allowed.map(|b| [a, b]));
                }
            }
        }
        Missing(pairs)
    }

    /// Whether a pair is missing, by its kinds in either order.
    fn table(&self) -> impl Fn(Kind, Kind) -> bool + use<> {
        const MOST: usize = 8;
        let place = |(feature, kind): Kind| MOST * feature + kind;
        let size = MOST * FEATURES.len();
        let mut table = vec![false; size * size];
        for [a, b] in &self.0 {
            let [a, b] = [place(*a), place(*b)];
            (table[size * a + b], table[size * b + a]) = (true, true);
        }
        move |a, b| table[size * place(a) + place(b)]
    }
}

/// Candidates for each scene, of which that with the most new pairs is taken.
const CANDIDATES: usize = 60;

/// Scenes in which every allowed pair of features occurs: a covering array, found greedily. Each
/// candidate begins with a pair that no scene has yet, and takes feature by feature, in a random
/// order, the kind that makes the most new pairs.
pub fn scenes() -> Vec<Choice> {
    let mut random = Pcg64Dxsm::seed_from_u64(1);
    let mut below = move |n: usize| {
        let uniform: f64 = StandardUniform.sample(&mut random);
        (uniform * n as f64) as usize
    };
    let mut missing = Missing::all();
    let mut scenes = Vec::new();
    while !missing.0.is_empty() {
        let is_missing = missing.table();
        let candidates = (0..CANDIDATES).map(|_| {
            let first = missing.0[below(missing.0.len())];
            candidate(first, &is_missing, &mut below)
        });
        let (best, _) = candidates.max_by_key(|(_, new)| *new).expect("candidates");
        let has = |&(feature, kind): &Kind| best[feature] == kind;
        missing.0.retain(|pair| !pair.iter().all(has));
        scenes.push(best);
    }
    scenes
}

/// A scene with this pair, and how many missing pairs it has.
fn candidate(
    first: [Kind; 2],
    is_missing: &impl Fn(Kind, Kind) -> bool,
    below: &mut impl FnMut(usize) -> usize,
) -> (Choice, usize) {
    let mut chosen: Vec<Kind> = first.to_vec();
    let mut others: Vec<usize> = (0..FEATURES.len())
        .filter(|feature| first.iter().all(|(taken, _)| taken != feature))
        .collect();
    let mut new_pairs = 1;
    while !others.is_empty() {
        let feature = others.swap_remove(below(others.len()));
        let kinds = FEATURES[feature].1.len();
        let start = below(kinds);
        let suits = |kind: Kind| chosen.iter().all(|other| !is_forbidden(kind, *other));
        let new = |kind: Kind| {
            let of = |other: &&Kind| is_missing(kind, **other);
            chosen.iter().filter(of).count()
        };
        let suitable = (0..kinds)
            .map(|i| (feature, (start + i) % kinds))
            .filter(|kind| suits(*kind));
        let best = suitable
            .max_by_key(|kind| new(*kind))
            .expect("one kind of each feature suits all others");
        new_pairs += new(best);
        chosen.push(best);
    }
    let mut choice = [0; FEATURES.len()];
    for (feature, kind) in chosen {
        choice[feature] = kind;
    }
    (choice, new_pairs)
}

#[test]
fn every_allowed_pair_of_features_is_in_a_scene() {
    let scenes = scenes();
    println!("{} scenes", scenes.len());
    assert!((30..=60).contains(&scenes.len()), "{}", scenes.len());
    let mut pairs = 0;
    for (i, (first, kinds)) in FEATURES.iter().enumerate() {
        for (j, (second, others)) in FEATURES.iter().enumerate().skip(i + 1) {
            for (k, kind) in kinds.iter().enumerate() {
                for (l, other) in others.iter().enumerate() {
                    let pair = [(*first, *kind), (*second, *other)];
                    let is_forbidden = FORBIDDEN.iter().any(|forbidden| {
                        forbidden.contains(&pair[0]) && forbidden.contains(&pair[1])
                    });
                    let is_there = scenes.iter().any(|scene| scene[i] == k && scene[j] == l);
                    assert!(is_there != is_forbidden, "{pair:?}");
                    pairs += usize::from(is_there);
                }
            }
        }
    }
    println!("{pairs} pairs");
}
