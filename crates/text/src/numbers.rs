//! Numbers in the form in which people read them.

pub use super::digits::{Digits, duration, percent, time};

/// A number rounded to `digits` significant digits, with an exponent only below 1e-4 and from 1e7
/// on, and without trailing zeros. NaN is `none`, infinities are `infinite` and `-infinite`.
pub fn significant(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return if x.is_nan() {
            "none".into()
        } else if x > 0.0 {
            "infinite".into()
        } else {
            "-infinite".into()
        };
    }
    plain(rounded(x, digits), 1e7)
}

/// A number rounded to three significant digits, for a sentence.
pub fn short(x: f64) -> String {
    plain(rounded(x, 3), 1e6)
}

fn rounded(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits.saturating_sub(1))
        .parse()
        .unwrap_or(x)
}

/// The shortest decimals of a number, without an exponent from 1e-4 to below `end`.
fn plain(x: f64, end: f64) -> String {
    if x != 0.0 && !(1e-4..end).contains(&x.abs()) {
        format!("{x:e}")
    } else {
        format!("{x}")
    }
}

/// A number of bytes with three significant digits, in the largest decimal unit that is not larger
/// than it.
pub fn bytes(n: f64) -> String {
    let units = [
        (1e15, "PB"),
        (1e12, "TB"),
        (1e9, "GB"),
        (1e6, "MB"),
        (1e3, "kB"),
    ];
    match units.into_iter().find(|(unit, _)| n >= *unit) {
        Some((unit, name)) => format!("{} {name}", significant(n / unit, 3)),
        None => format!("{n:.0} B"),
    }
}

/// The number rounded to twelve significant digits, which removes rounding errors: 0.9 instead of
/// 0.8999999999999999.
pub fn tidy(x: f64) -> f64 {
    format!("{x:.11e}").parse().unwrap_or(x)
}

/// A positive number rounded up to two significant digits, for a suggestion.
pub fn round_up(x: f64) -> f64 {
    let unit = 10_f64.powi(x.log10().floor() as i32 - 1);
    rounded((x / unit - 1e-9).ceil() * unit, 2)
}

/// A whole number with its digits in groups of three: 60 000 000.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggestions_are_rounded_up_to_two_digits() {
        let up = [
            0.300_003_000_03,
            0.050_000_500_005,
            0.3,
            0.07,
            1.0,
            9.91,
            123.0,
            2.5e-7,
        ]
        .map(round_up);
        assert_eq!(up, [0.31, 0.051, 0.3, 0.07, 1.0, 10.0, 130.0, 2.5e-7]);
    }

    #[test]
    fn digits_are_kept_to_the_number_asked_for() {
        let shown = [
            (0.125, 6),
            (1234.5, 2),
            (1.5e-9, 3),
            (1e7, 3),
            (f64::NAN, 3),
            (f64::NEG_INFINITY, 3),
        ];
        let shown = shown.map(|(x, digits)| significant(x, digits));
        assert_eq!(
            shown,
            ["0.125", "1200", "1.5e-9", "1e7", "none", "-infinite"]
        );
    }

    #[test]
    fn bytes_are_shown_in_the_largest_unit_below_them() {
        assert_eq!(
            [999.0, 1000.0, 1_234_567.0, 2e15].map(bytes),
            ["999 B", "1 kB", "1.23 MB", "2 PB"]
        );
    }

    #[test]
    fn what_rounding_has_left_is_tidied_away() {
        assert_eq!([0.3 * 3.0, 1.0 / 3.0].map(tidy), [0.9, 0.333_333_333_333]);
    }
}
