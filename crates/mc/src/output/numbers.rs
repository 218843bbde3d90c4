//! Formats numbers and sentences for people, and reads durations and shares.

use crate::output::terminal::columns;
use std::ops::RangeBounds;
use std::time::Duration;
pub use stickslip_data::numbers::{bytes, grouped, significant};

/// A number of things with its noun: 1 path, 10 000 paths.
pub fn counted(n: u64, thing: &str) -> String {
    format!("{} {thing}{}", grouped(n), if n == 1 { "" } else { "s" })
}

/// Names in a row, or a few of them where there are many.
pub fn some_of(names: &[&str]) -> String {
    match names {
        [first, second, third, _, _, ..] => {
            format!("{first}, {second}, {third} and {} more", names.len() - 3)
        }
        _ => names.join(", "),
    }
}

/// A duration in seconds, minutes or hours: 0.42 s, 3 min 20 s, 2 h 5 min.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.2} s"),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.0} min {:.0} s", (s / 60.0).floor(), (s % 60.0).floor()),
        s => format!(
            "{:.0} h {:.0} min",
            (s / 3600.0).floor(),
            (s % 3600.0 / 60.0).floor()
        ),
    }
}

/// A duration in the unit that suits it, from us to yr.
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{} us", significant(s * 1e6, 2)),
        s if s < 1.0 => format!("{} ms", significant(s * 1e3, 2)),
        s if s < 7200.0 => duration(s),
        s if s < 86_400.0 => format!("{} h", significant(s / 3600.0, 2)),
        s if s < 86_400.0 * 1000.0 => format!("{} d", significant(s / 86_400.0, 2)),
        s => format!("{} yr", significant(s / 86_400.0 / 365.25, 2)),
    }
}

/// A share as a percentage.
pub fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 3))
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

/// Reads a finite number that lies in a range; if it does not, `wrong` says what to write.
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

/// Reads a share that lies in a range; if it does not, `wrong` says what to write.
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
/// The length that lines keep even if the terminal is narrower.
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

/// Like [`wrapped`], but as wide as the terminal, or the 80 columns of a page where there is none.
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

/// How an estimate, its standard error and the ends of its interval are printed: with a common
/// number of decimals and a common power of ten.
///
/// Two digits of the standard error determine how many digits of the estimate are shown; further
/// digits would be noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits {
    exponent: i32,
    decimals: usize,
}

/// Significant digits of a number that has no standard error.
const EXACT_DIGITS: i32 = 7;
/// Powers of ten of the numbers that are printed without an exponent.
const PLAIN: std::ops::RangeInclusive<i32> = -3..=6;

impl Digits {
    /// The format for this estimate and standard error.
    pub fn of(estimate: f64, standard_error: f64) -> Self {
        let sure = standard_error.is_finite() && standard_error > 0.0;
        let error = if sure { standard_error } else { 0.0 };
        let largest = power_of_ten(estimate.abs().max(error));
        // A double has no more than sixteen significant digits.
        let last = if sure {
            power_of_ten(error) - 1
        } else {
            largest - EXACT_DIGITS + 1
        }
        .max(largest - 15);
        let exponent = if PLAIN.contains(&largest) { 0 } else { largest };
        Digits {
            exponent,
            decimals: (exponent - last).max(0) as usize,
        }
    }

    /// A number in this format; `none` if it is not finite.
    pub fn show(self, x: f64) -> String {
        if !x.is_finite() {
            return "none".into();
        }
        // The power of ten is applied in two halves, because 10^324 or its inverse is not a double.
        let half = self.exponent / 2;
        let scaled = x / 10f64.powi(half) / 10f64.powi(self.exponent - half);
        let text = format!("{scaled:.*}", self.decimals);
        let text = match text.strip_prefix('-') {
            Some(zero) if zero.chars().all(|c| c == '0' || c == '.') => zero.to_string(),
            _ => text,
        };
        if self.exponent == 0 {
            text
        } else {
            format!("{text}e{}", self.exponent)
        }
    }
}

/// floor(log10 x); 0 for zero.
fn power_of_ten(x: f64) -> i32 {
    if x == 0.0 || !x.is_finite() {
        return 0;
    }
    format!("{x:e}")
        .split_once('e')
        .and_then(|(_, power)| power.parse().ok())
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_shows_two_digits_of_its_error() {
        let shown = |x, e| {
            let digits = Digits::of(x, e);
            (digits.show(x), digits.show(e))
        };
        assert_eq!(
            shown(0.538572, 0.000266),
            ("0.53857".into(), "0.00027".into())
        );
        assert_eq!(shown(14.1226, 0.0073), ("14.1226".into(), "0.0073".into()));
        assert_eq!(shown(-4.2316, 12.0), ("-4".into(), "12".into()));
        assert_eq!(
            shown(1.88841e8, 9.67e6),
            ("1.888e8".into(), "0.097e8".into())
        );
        assert_eq!(
            shown(3.06398e-4, 1.3427e-5),
            ("3.06e-4".into(), "0.13e-4".into())
        );
    }

    #[test]
    fn an_estimate_without_error_shows_seven_digits() {
        assert_eq!(Digits::of(2.5740044351, 0.0).show(2.5740044351), "2.574004");
        assert_eq!(Digits::of(0.0, 0.0).show(-0.0), "0.000000");
        assert_eq!(Digits::of(1.0, f64::NAN).show(f64::NAN), "none");
        assert_eq!(Digits::of(1e300, 0.0).show(1e300), "1.000000e300");
        assert_eq!(Digits::of(5e-324, 0.0).show(0.0), "0.000000e-324");
    }

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
