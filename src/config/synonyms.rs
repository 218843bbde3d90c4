//! What users write for an option or a key that has another name here.
//!
//! One table serves the keys of scenarios, the options of a command and the arguments of functions,
//! because users bring the words of similar tools to all three.

use super::keys::{self, Key, TABLES};
use super::symbol_and_meaning;

/// The options that set one key of a scenario. An argument of a function has the same name.
pub const OPTIONS: [(&str, &str); 6] = [
    ("paths", "ensemble.paths"),
    ("seed", "ensemble.seed"),
    ("scheme", "scheme.kind"),
    ("tolerance", "scheme.tolerance"),
    ("step", "time.step"),
    ("until", "time.end"),
];

/// A dotted key, or an option that sets none, with other words for it in lower case, and what to
/// write behind it if its value differs from that of the words.
pub(super) type Row = (&'static str, &'static [&'static str], &'static str);

pub(super) const ROWS: [Row; 26] = [
    ("oscillator.dilatation", &["dilation"], ""),
    ("oscillator.force_per_temperature", &["gain"], ""),
    ("friction.static", &["fs"], ""),
    ("friction.dynamic", &["fd", "kinetic"], ""),
    ("temperature.trend", &["belt", "slope", "speed"], ""),
    ("temperature.offset", &["constant"], ""),
    ("temperature.harmonics.angular_frequency", &["omega"], ""),
    (
        "temperature.harmonics.angular_frequency",
        &["frequency"],
        " = 2 pi frequency",
    ),
    (
        "temperature.harmonics.angular_frequency",
        &["period"],
        " = 2 pi / period",
    ),
    ("temperature.series.file", &["csv", "path", "filename"], ""),
    (
        "temperature.series.zone",
        &["timezone", "time_zone", "tz"],
        "",
    ),
    ("temperature.noise.initial", &["v0"], ""),
    ("bearing.stiffness", &["k_bp"], ""),
    ("force.expression", &["g", "formula"], ""),
    (
        "force.expression",
        &["scale", "factor"],
        " with the factor in it",
    ),
    ("time.step", &["dt", "timestep", "time_step"], ""),
    (
        "time.end",
        &["until", "duration", "t_end", "t_max", "tmax", "stop"],
        "",
    ),
    ("statistics.after", &["burn_in", "burnin", "warmup"], ""),
    (
        "ensemble.paths",
        &["n", "p", "particles", "samples", "realizations"],
        "",
    ),
    ("scheme.tolerance", &["epsilon", "rtol", "tol"], ""),
    ("scheme.kind", &["method", "solver", "integrator"], ""),
    (
        "threads",
        &[
            "cores",
            "cpus",
            "jobs",
            "j",
            "workers",
            "processes",
            "nproc",
        ],
        "",
    ),
    ("from", &["template", "example"], ""),
    ("output", &["out", "outfile", "o"], ""),
    ("json", &["format"], ""),
    ("only", &["kind", "figure", "panel"], ""),
];

/// The similarity (1 for equal words) from which a name is suggested. It is lower within a table
/// of keys than elsewhere, where words are more often similar by chance.
const ALIKE_WITHIN: f64 = 0.75;
const ALIKE: f64 = 0.85;

/// The row that has this word.
fn row(word: &str) -> Option<&'static Row> {
    ROWS.iter().find(|(_, words, _)| words.contains(&word))
}

/// The option, of those that exist, that another word for it or for its key probably means.
///
/// ```
/// use stickslip::config::option_meant;
///
/// let options = ["paths", "max-time", "force"];
/// assert_eq!(["particles", "max_tmie", "format"].map(|word| option_meant(word, &options)), [Some("paths"), Some("max-time"), None]);
/// ```
pub fn option_meant<'o>(word: &str, options: &[&'o str]) -> Option<&'o str> {
    let plain = |name: &str| name.to_lowercase().replace('-', "_");
    let word = plain(word);
    let called = |name: &str| options.iter().copied().find(|option| plain(option) == name);
    let of_name = |name: &str| {
        let of_series = name.split_once(".series.").map_or(name, |(_, last)| last);
        let of_key = OPTIONS.iter().find(|(_, key)| *key == name);
        called(of_key.map_or(of_series, |(option, _)| option))
    };
    let alike = || {
        let likeness = |option: &&'o str| strsim::jaro_winkler(&word, &plain(option));
        let near = options.iter().filter(|option| likeness(option) > ALIKE);
        near.max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
            .copied()
    };
    let by_row = row(&word).and_then(|(name, ..)| of_name(name));
    let by_key = || of_name(&key_meant(&word)?.0);
    by_row.or_else(alike).or_else(by_key)
}

/// The key of a scenario probably meant by a word, such as its symbol, and its meaning, which is
/// empty if its value is not a number.
///
/// ```
/// use stickslip::config::key_meant;
///
/// let (key, meaning) = key_meant("rho").expect("a symbol");
/// assert_eq!((key.as_str(), meaning.as_str()), ("temperature.noise.intensity", "rho, weight of v in T"));
/// ```
pub fn key_meant(word: &str) -> Option<(String, String)> {
    let (key, note) = suggestion("", word)?;
    let key = key.replace(".harmonics.", ".harmonics.0.");
    let is_known = key.contains('.') || super::keys().iter().any(|known| known.key == key);
    let (symbol, meaning) = symbol_and_meaning(&key).unwrap_or_default();
    let parts = [symbol, meaning, note.trim()].into_iter();
    let meaning = parts.filter(|part| !part.is_empty()).collect::<Vec<_>>();
    is_known.then(|| (key, meaning.join(", ")))
}

/// The key probably meant by `word` in `table`, dotted if it belongs to another table; and what to
/// write behind it if the values differ.
pub(super) fn suggestion(table: &str, word: &str) -> Option<(String, &'static str)> {
    let word = word.to_lowercase();
    let from_here = |home: &str, name: &str| match home {
        _ if home == table || home.is_empty() => name.to_string(),
        home => format!("{home}.{name}"),
    };
    let dotted = |(name, _, note): &Row| {
        let (home, last) = name.rsplit_once('.')?;
        let is_here = !table.is_empty() && keys::of_table(table).contains(&last);
        Some((from_here(if is_here { table } else { home }, last), *note))
    };
    let row = row(&word).and_then(dotted);
    if let Some(here) = row.clone().filter(|(name, _)| !name.contains('.')) {
        return Some(here);
    }
    let all = || {
        let of_table = |(home, keys): &(&'static str, &'static [Key])| {
            let home = *home;
            keys.iter().map(move |key| (home, key))
        };
        TABLES.iter().flat_map(of_table)
    };
    let is_symbol =
        |(_, key): &(&str, &Key)| !word.is_empty() && key.symbol.eq_ignore_ascii_case(&word);
    let mut elsewhere = all().filter(|(home, key)| *home != table && key.name == word);
    let alone = elsewhere.next().filter(|_| elsewhere.next().is_none());
    if let Some((home, key)) = all().find(is_symbol).or(alone) {
        return Some((from_here(home, key.name), ""));
    }
    let alike = || {
        let ranked = all().filter_map(|(home, key)| {
            let (is_here, likeness) = (home == table, likeness(&word, key.name));
            let least = if is_here { ALIKE_WITHIN } else { ALIKE };
            (likeness >= least).then_some(((is_here, likeness), (home, key)))
        });
        let best = ranked.max_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        best.map(|(_, (home, key))| (from_here(home, key.name), ""))
    };
    row.or_else(alike)
}

/// The similarity of a word and a name, from 0 to 1. Similarity to a part of a name, such as
/// `frequency`, counts nearly in full.
fn likeness(word: &str, name: &str) -> f64 {
    let parts = name
        .split('_')
        .map(|part| 0.95 * strsim::jaro_winkler(word, part));
    parts.fold(strsim::jaro_winkler(word, name), f64::max)
}
