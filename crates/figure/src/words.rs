//! The names of keys and numbers at an axis.

use super::kit::Label;
use super::{LegendEntry, Palette, Style};
use stickslip::scenario::Scenario;
use stickslip::stats::Statistic;
use stickslip::study::sweep::{SweepAxis, table_of_file};
use stickslip::sums::Ends;
use stickslip_text::numbers;

/// The names of Greek letters that people give to quantities, each before its letter.
const GREEK: &str = "alpha α beta β gamma γ delta δ epsilon ε zeta ζ kappa κ lambda λ mu μ omega ω phi φ rho ρ sigma σ tau τ theta θ";

/// A symbol as it is printed: rho becomes its Greek letter, f_s and x0 get an index, and anything
/// else stays as it is.
pub fn letter(name: &str) -> Label {
    let mut greek = GREEK.split(' ').skip_while(|word| *word != name).skip(1);
    if let Some(letter) = greek.next().filter(|_| name.is_ascii()) {
        return format!("*{letter}*").into();
    }
    let mut letters = name.chars();
    let (first, rest) = (letters.next(), letters.as_str());
    let index = rest.strip_prefix('_').unwrap_or(rest);
    let is_short = index.len() <= 3 && index.chars().all(|c| c.is_ascii_alphanumeric());
    match first {
        Some(first) if first.is_alphabetic() && index.is_empty() => format!("*{first}*").into(),
        Some(first) if first.is_alphabetic() && is_short => format!("*{first}*_{{{index}}}").into(),
        _ => Label::verbatim(name),
    }
}

/// A dotted key in words, e.g. "static friction" or "intensity of the noise".
fn key_words(key: &str) -> String {
    let words: Vec<String> = key.split('.').map(|word| word.replace('_', " ")).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["friction", name] => format!("{name} friction"),
        ["temperature", "noise", .., name] => format!("{name} of the noise"),
        ["temperature", "harmonics", .., name] => format!("{name} of the forcing"),
        ["temperature", name] => format!("{name} of the temperature"),
        ["input", name, "file"] => format!("file of {name}"),
        ["bearing", name] => format!("{name} of the bearing"),
        ["initial", name] => format!("initial {name}"),
        [.., name] => name.to_string(),
        [] => String::new(),
    }
}

/// A statistic in words.
pub fn of_statistic(statistic: Statistic, style: &Style) -> Label {
    Label::verbatim(
        style
            .words(&[statistic.name()])
            .unwrap_or(statistic.words()),
    )
}

/// A dotted key in words.
pub fn of_key(key: &str, style: &Style) -> Label {
    style
        .words(&[key])
        .map_or_else(|| Label::verbatim(&key_words(key)), Label::verbatim)
}

/// The key of an axis in words with its symbol, e.g. "intensity of the noise ρ".
pub fn of_axis(axis: &SweepAxis, style: &Style) -> Label {
    let SweepAxis { name, key, .. } = axis;
    if let Some(words) = style.words(&[name, key]) {
        return Label::verbatim(words);
    }
    let words = key_words(key);
    match *name == words || *name == key.replace('.', "_") {
        true => letter(&words),
        // Files have no symbol, so a name is given in place of the words.
        false if table_of_file(key).is_some() => Label::verbatim(name),
        false => Label::verbatim(&format!("{words} ")).and(letter(name)),
    }
}

/// Caveats about numbers of a run: their bias, and whether the counts and durations of sticks and
/// slips, if included, have a limit.
pub fn caveats(scenario: &Scenario, are_counts: bool) -> Vec<LegendEntry> {
    let friction = &scenario.model.friction;
    let is_equal = friction.static_force <= friction.dynamic_force;
    let has_no_limit = scenario.resolution().is_some()
        || is_equal && scenario.scheme.step().is_some() && scenario.model.is_random();
    let bias = scenario.scheme.step();
    let bias = bias.map(|h| format!("including the bias of the step {h}"));
    let limit = (are_counts && has_no_limit)
        .then(|| "without a limit, because *f*_{s} = *f*_{d} under noise".to_string());
    bias.into_iter()
        .chain(limit)
        .map(LegendEntry::words)
        .collect()
}

/// The entry of the area between the ends of intervals, if any of them is known.
pub fn intervals(of: &Ends, palette: &Palette) -> Option<LegendEntry> {
    let is_known = of.low.iter().zip(&of.high).any(|(low, high)| low < high);
    is_known.then(|| LegendEntry::area(palette.narrow, "95 % interval"))
}

/// A whole number in groups of three digits, which a line break does not separate.
pub fn grouped(n: u64) -> String {
    numbers::grouped(n).replace(' ', "\u{a0}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::scheme::EventDriven;

    #[test]
    fn keys_become_words() {
        for (key, words) in [
            ("friction.static", "static friction"),
            (
                "temperature.noise.0.relaxation_rate",
                "relaxation rate of the noise",
            ),
            (
                "temperature.harmonics.0.angular_frequency",
                "angular frequency of the forcing",
            ),
            ("oscillator.mass", "mass"),
            ("parameters.mu", "mu"),
        ] {
            assert_eq!(key_words(key), words);
        }
    }

    #[test]
    fn a_missing_limit_is_stated_beside_counts() {
        let stated = |name: &str, scheme: Option<EventDriven>| {
            let mut scenario = Scenario::shipped(name).expect("shipped");
            if let Some(scheme) = scheme {
                scenario = scenario.with_scheme(scheme).expect("suits");
            }
            [false, true].map(|counts| caveats(&scenario, counts).len())
        };
        let exact = Some(EventDriven { tolerance: 1e-3 });
        assert_eq!(stated("rho025", None), [1, 1]);
        assert_eq!(stated("rho025", exact), [0, 0]);
        assert_eq!(stated("equal-friction", None), [1, 2]);
        assert_eq!(stated("equal-friction", exact), [0, 1]);
    }

    #[test]
    fn numbers_are_grouped() {
        assert_eq!(
            [7, 1234, 1_234_567].map(grouped),
            ["7", "1\u{a0}234", "1\u{a0}234\u{a0}567"]
        );
    }
}
