//! Every key that a scenario may hold: its table, its symbol, its meaning and its range.

use crate::scenario::MAX_PHASE;
use crate::scheme::TOLERANCES;

/// The range of numbers that a key accepts. Infinities and NaN are never accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    Any,
    Positive,
    NonNegative,
    /// A friction threshold, at least 0. It has no upper limit, because a threshold that no force
    /// reaches does not enter the computation.
    Threshold,
    /// A phase in radians that has not lost its digits.
    Phase,
    Tolerance,
}

impl Range {
    pub fn holds(self, x: f64) -> bool {
        match self {
            Range::Any => true,
            Range::Positive => x > 0.0,
            Range::NonNegative | Range::Threshold => x >= 0.0,
            Range::Phase => x.abs() <= MAX_PHASE,
            Range::Tolerance => TOLERANCES.contains(&x),
        }
    }

    /// A number within the range, used in place of one that cannot be used so that reading can go
    /// on.
    pub fn stand_in(self) -> f64 {
        match self {
            Range::Tolerance => *TOLERANCES.end(),
            _ => 1.0,
        }
    }

    pub fn words(self) -> &'static str {
        match self {
            Range::Any => "a finite number",
            Range::Positive => "a finite number above 0",
            Range::NonNegative | Range::Threshold => "a finite number, 0 or above",
            Range::Phase => "a phase from -1e13 to 1e13, beyond which it has lost its digits",
            Range::Tolerance => "a number from 1e-9 to 0.1",
        }
    }
}

/// A key that holds a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub name: &'static str,
    pub symbol: &'static str,
    pub meaning: &'static str,
    pub range: Range,
}

const fn key(name: &'static str, symbol: &'static str, meaning: &'static str, range: Range) -> Key {
    Key { name, symbol, meaning, range }
}

pub(super) const MASS: Key = key("mass", "m", "mass", Range::Positive);
pub(super) const STIFFNESS: Key = key("stiffness", "K", "stiffness of the spring", Range::Positive);
pub(super) const DAMPING: Key = key("damping", "alpha", "the damping force is 2 alpha x'", Range::NonNegative);
pub(super) const DILATATION: Key = key("dilatation", "beta", "the rest position is beta T", Range::Any);
pub(super) const STATIC: Key = key("static", "f_s", "a stick lasts while |b| <= f_s", Range::Threshold);
pub(super) const DYNAMIC: Key = key("dynamic", "f_d", "|F| in motion, at most f_s", Range::Threshold);
pub(super) const AMPLITUDE: Key = key("amplitude", "a", "amplitude of the harmonic", Range::Any);
pub(super) const ANGULAR_FREQUENCY: Key =
    key("angular_frequency", "w", "angular frequency of the forcing, not of the oscillator", Range::NonNegative);
pub(super) const PHASE: Key =
    key("phase", "phi", "phase at t = 0, in radians; whole turns may be left out", Range::Phase);
pub(super) const INTENSITY: Key = key("intensity", "rho", "weight of v in T", Range::NonNegative);
pub(super) const RELAXATION_RATE: Key = key("relaxation_rate", "theta", "dv = -theta v dt + sigma dW", Range::Positive);
pub(super) const DIFFUSION: Key = key("diffusion", "sigma", "dv = -theta v dt + sigma dW", Range::NonNegative);
pub(super) const INITIAL_NOISE: Key = key("initial", "v(0)", "start of the noise", Range::Any);
pub(super) const DISPLACEMENT: Key = key("displacement", "x0", "x(0); x'(0) = 0", Range::Any);
pub(super) const MAX_GAP: Key = key("max_gap", "", "longest time between two samples", Range::Positive);
pub(super) const BEARING_STIFFNESS: Key = key("stiffness", "K_B", "shear of the bearing under F", Range::Positive);
pub(super) const OFFSET: Key = key("offset", "z0", "what the sensor shows at x = 0", Range::Any);
pub(super) const END: Key = key("end", "t_end", "duration", Range::NonNegative);
pub(super) const STEP: Key = key("step", "h", "time step", Range::Positive);
pub(super) const OUTPUT_STEP: Key = key("output_step", "", "spacing of the output grid", Range::Positive);
pub(super) const TOLERANCE: Key =
    key("tolerance", "", "relative error that discretisation may leave", Range::Tolerance);
pub(super) const AFTER: Key = key("after", "", "statistics count from this time on", Range::NonNegative);

/// The keys that hold numbers, each with its table.
const NUMBERS: [(&str, Key); 22] = [
    ("oscillator", MASS),
    ("oscillator", STIFFNESS),
    ("oscillator", DAMPING),
    ("oscillator", DILATATION),
    ("friction", STATIC),
    ("friction", DYNAMIC),
    ("temperature.harmonics", AMPLITUDE),
    ("temperature.harmonics", ANGULAR_FREQUENCY),
    ("temperature.harmonics", PHASE),
    ("temperature.noise", INTENSITY),
    ("temperature.noise", RELAXATION_RATE),
    ("temperature.noise", DIFFUSION),
    ("temperature.noise", INITIAL_NOISE),
    ("temperature.series", MAX_GAP),
    ("initial", DISPLACEMENT),
    ("bearing", BEARING_STIFFNESS),
    ("bearing", OFFSET),
    ("time", END),
    ("time", STEP),
    ("time", OUTPUT_STEP),
    ("scheme", TOLERANCE),
    ("statistics", AFTER),
];

/// The key that a dotted name stands for, if it holds a number. The index of a harmonic is ignored.
pub(super) fn number(dotted: &str) -> Option<Key> {
    let is_name = |segment: &&str| !segment.bytes().all(|byte| byte.is_ascii_digit());
    let plain = dotted.split('.').map(str::trim).filter(is_name).collect::<Vec<_>>().join(".");
    let (table, name) = plain.rsplit_once('.')?;
    NUMBERS.iter().find(|(home, key)| *home == table && key.name == name).map(|(_, key)| *key)
}

/// The tables and the keys of each, in the order in which a resolved scenario is written.
pub(super) const TABLES: [(&str, &[&str]); 15] = [
    (
        "",
        &[
            "title",
            "oscillator",
            "friction",
            "temperature",
            "initial",
            "bearing",
            "time",
            "scheme",
            "statistics",
            "ensemble",
            "record",
            "units",
        ],
    ),
    ("oscillator", &["mass", "stiffness", "damping", "dilatation"]),
    ("friction", &["static", "dynamic"]),
    ("temperature", &["harmonics", "series", "noise"]),
    ("temperature.harmonics", &["amplitude", "angular_frequency", "phase"]),
    ("temperature.series", &["file", "time", "value", "zone", "max_gap", "start", "hash"]),
    ("temperature.noise", &["intensity", "relaxation_rate", "diffusion", "initial", "pinned"]),
    ("initial", &["displacement"]),
    ("bearing", &["stiffness", "offset"]),
    ("time", &["end", "step", "output_step"]),
    ("scheme", &["kind", "tolerance"]),
    ("statistics", &["after"]),
    ("ensemble", &["paths", "seed", "antithetic"]),
    ("record", &["paths", "events", "trajectories"]),
    ("units", &["time", "length", "force", "temperature"]),
];

/// The keys of a table.
pub(super) fn of_table(table: &str) -> &'static [&'static str] {
    TABLES.iter().find(|(name, _)| *name == table).map_or(&[], |(_, keys)| keys)
}

/// Other names that users write for a key: the symbols of the paper and common synonyms.
const SYNONYMS: [(&str, &str); 32] = [
    ("m", "oscillator.mass"),
    ("k", "oscillator.stiffness"),
    ("alpha", "oscillator.damping"),
    ("beta", "oscillator.dilatation"),
    ("dilation", "oscillator.dilatation"),
    ("f_s", "friction.static"),
    ("fs", "friction.static"),
    ("f_d", "friction.dynamic"),
    ("fd", "friction.dynamic"),
    ("kinetic", "friction.dynamic"),
    ("a", "temperature.harmonics.amplitude"),
    ("w", "temperature.harmonics.angular_frequency"),
    ("omega", "temperature.harmonics.angular_frequency"),
    ("frequency", "temperature.harmonics.angular_frequency"),
    ("phi", "temperature.harmonics.phase"),
    ("rho", "temperature.noise.intensity"),
    ("theta", "temperature.noise.relaxation_rate"),
    ("sigma", "temperature.noise.diffusion"),
    ("v0", "temperature.noise.initial"),
    ("x0", "initial.displacement"),
    ("z0", "bearing.offset"),
    ("k_bp", "bearing.stiffness"),
    ("csv", "temperature.series.file"),
    ("t_end", "time.end"),
    ("until", "time.end"),
    ("h", "time.step"),
    ("dt", "time.step"),
    ("burn_in", "statistics.after"),
    ("burnin", "statistics.after"),
    ("warmup", "statistics.after"),
    ("n", "ensemble.paths"),
    ("epsilon", "scheme.tolerance"),
];

/// The likeness (1 for equal words) from which a key is suggested. It is lower within a table than
/// across tables, where two words are more often alike by chance.
const ALIKE_WITHIN: f64 = 0.75;
const ALIKE_ACROSS: f64 = 0.85;

/// The key that `key` in `table` probably stands for; dotted if it belongs to another table.
pub(super) fn suggestion(table: &str, key: &str) -> Option<String> {
    let word = key.to_lowercase();
    let dotted = |home: &str, name: &str| if home.is_empty() { name.to_string() } else { format!("{home}.{name}") };
    let within = || most_alike(&word, of_table(table), ALIKE_WITHIN).map(|(_, name)| name.to_string());
    let synonym = || {
        let (home, name) = SYNONYMS.iter().find(|(synonym, _)| *synonym == word)?.1.rsplit_once('.')?;
        Some(if home == table { name.to_string() } else { dotted(home, name) })
    };
    let across = || {
        TABLES
            .iter()
            .filter_map(|(home, names)| Some((most_alike(&word, names, ALIKE_ACROSS)?, *home)))
            .max_by(|a, b| a.0.0.total_cmp(&b.0.0))
            .map(|((_, name), home)| dotted(home, name))
    };
    // A key of exactly this name in one other table.
    let elsewhere = || {
        let mut homes = TABLES.iter().filter(|(home, names)| *home != table && names.contains(&word.as_str()));
        homes.next().filter(|_| homes.next().is_none()).map(|(home, _)| dotted(home, &word))
    };
    synonym().or_else(elsewhere).or_else(within).or_else(across)
}

/// The name most like a word, if one is alike enough. Likeness to a part of a name, such as
/// `frequency`, counts nearly in full.
fn most_alike(word: &str, names: &[&'static str], enough: f64) -> Option<(f64, &'static str)> {
    names
        .iter()
        .map(|name| {
            let parts = name.split('_').map(|part| 0.95 * strsim::jaro_winkler(word, part));
            (parts.fold(strsim::jaro_winkler(word, name), f64::max), *name)
        })
        .filter(|(likeness, _)| *likeness >= enough)
        .max_by(|a, b| a.0.total_cmp(&b.0))
}
