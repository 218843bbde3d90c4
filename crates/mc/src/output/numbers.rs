//! Formats numbers and sentences for people, and reads durations and shares.

use crate::output::terminal::columns;
use std::ops::RangeBounds;
use std::time::Duration;
pub use stickslip_text::numbers::{Digits, bytes, duration, grouped, percent, significant, time};

/// A number of things with its noun: 1 path, 10 000 paths.
pub fn counted(n: u64, thing: &str) -> String {
    format!("{} {thing}{}", grouped(n), if n == 1 { "" } else { "s" })
}

/// A list of names, shortened if there are many.
pub fn some_of(names: &[&str]) -> String {
    match names {
        [first, second, third, _, _, ..] => {
            format!("{first}, {second}, {third} and {} more", names.len() - 3)
        }
        _ => names.join(", "),
    }
}

/// Reads a duration: 90, 90s, 15m, 1.5h, 4h50m, 1d 2h. A number without a unit is in seconds.
pub fn parse_duration(text: &str) -> Result<Duration, String> {
    let seconds = text
        .trim()
        .parse()
        .ok()
        .or_else(|| stickslip_data::seconds(text));
    let duration = seconds
        .filter(|seconds| *seconds > 0.0)
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    duration
        .ok_or_else(|| "must be a positive duration, such as 90, 90s, 15m, 2h or 4h50m".to_string())
}

/// Reads a finite number in a range; otherwise `wrong` says what to write.
pub fn parse_number_in(
    text: &str,
    range: &impl RangeBounds<f64>,
    wrong: &str,
) -> Result<f64, String> {
    let number = text
        .trim()
        .parse::<f64>()
        .ok()
        .filter(|x| x.is_finite() && range.contains(x));
    number.ok_or_else(|| wrong.to_string())
}

/// Reads a share, as a number or as a percentage: 0.05 or 5%.
fn parse_share(text: &str) -> Option<f64> {
    let text = text.trim();
    match text.strip_suffix('%') {
        Some(percent) => Some(percent.trim_end().parse::<f64>().ok()? / 100.0),
        None => text.parse().ok(),
    }
}

/// Reads a share in a range; otherwise `wrong` says what to write.
pub fn parse_share_in(
    text: &str,
    range: &impl RangeBounds<f64>,
    wrong: &str,
) -> Result<f64, String> {
    parse_share(text)
        .filter(|share| range.contains(share))
        .ok_or_else(|| wrong.to_string())
}

/// The longest line of prose, in characters.
const LINE: usize = 100;
/// The shortest length of a line, even on a narrower terminal.
const SHORTEST: usize = 40;

/// A sentence broken into lines no wider than the terminal. Every line but the first begins with
/// `indent`.
pub fn wrapped(sentence: &str, indent: &str) -> String {
    broken(
        sentence,
        indent,
        columns().map_or(LINE, |columns| columns.clamp(SHORTEST, LINE)),
    )
}

/// Like [`wrapped`], but with the width of the terminal, or 80 columns without one.
pub fn fitted(sentence: &str, indent: &str) -> String {
    broken(sentence, indent, columns().unwrap_or(80).max(SHORTEST))
}

fn broken(sentence: &str, indent: &str, most: usize) -> String {
    let mut text = String::new();
    let mut line = String::new();
    for word in sentence.split_inclusive(' ') {
        if line.chars().count() + word.trim_end().chars().count() > most {
            text.push_str(line.trim_end());
            text.push('\n');
            line = indent.to_string();
        }
        line.push_str(word);
    }
    text + line.trim_end() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_they_are_typed() {
        let read = |text| parse_duration(text).ok().map(|time| time.as_secs_f64());
        for (text, seconds) in [
            ("90", 90.0),
            ("1.5s", 1.5),
            ("15m", 900.0),
            ("4h50m", 17_400.0),
            (" 1d 2h 0m 3s ", 93_603.0),
            ("1e-3", 1e-3),
        ] {
            assert_eq!(read(text), Some(seconds), "{text}");
        }
        for text in [
            "", "0", "-5", "-5m", "50m4h", "4h4h", "4h50", "h", "4x", "1m\u{b5}", "nan", "1e400s",
            "inf",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    #[test]
    fn numbers_read_plainly() {
        assert_eq!(significant(0.125, 6), "0.125");
        assert_eq!(significant(f64::INFINITY, 3), "infinite");
        assert_eq!(significant(1.5e-9, 3), "1.5e-9");
        assert_eq!(grouped(60_000_000), "60 000 000");
        assert_eq!(grouped(12), "12");
        assert_eq!(
            [0, 1, 10_000].map(|n| counted(n, "path")),
            ["0 paths", "1 path", "10 000 paths"]
        );
        assert_eq!(broken("one two three", "  ", 8), "one two\n  three\n");
        assert_eq!(bytes(1_234_567.0), "1.23 MB");
        assert_eq!(duration(200.0), "3 min 20 s");
    }
}
