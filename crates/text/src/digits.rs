//! Numbers with sensible digits.

use super::numbers::significant;

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
    fn a_time_has_the_unit_that_suits_it() {
        assert_eq!(
            [0.42, 230.0, 9300.0].map(duration),
            ["0.42 s", "3 min 50 s", "2 h 35 min"]
        );
        let times = [60e-6, 0.25, 39_600.0, 12.0 * 86_400.0];
        assert_eq!(times.map(time), ["60 us", "250 ms", "11 h", "12 d"]);
    }
}
