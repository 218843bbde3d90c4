//! What a terminal can show: its width, and bars and small curves made of letters, in Unicode or,
//! where the locale is not UTF-8, in ASCII.

use std::ffi::OsString;
use std::io::IsTerminal as _;

/// The width of standard output in columns. None if it is not a terminal but, for instance, a pipe,
/// so that what programs read does not depend on a window.
pub fn columns() -> Option<usize> {
    let out = std::io::stdout();
    let size = rustix::termios::tcgetwinsize(&out).ok().filter(|_| out.is_terminal())?;
    Some(usize::from(size.ws_col)).filter(|columns| *columns > 0)
}

/// The set of letters that bars and curves are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Letters {
    /// Block elements, in steps of an eighth of a cell.
    Unicode,
    /// ASCII, for every terminal.
    Ascii,
}

/// A cell filled from the left, from empty to seven eighths.
const EIGHTHS: [&str; 8] = ["", "▏", "▎", "▍", "▌", "▋", "▊", "▉"];
/// Heights of a cell, from the lowest to the highest.
const HEIGHTS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
const ASCII_HEIGHTS: [char; 5] = ['_', '.', '-', '=', '#'];

impl Letters {
    /// The letters for the locale of this process. The first of LC_ALL, LC_CTYPE and LANG that is
    /// set names the encoding.
    pub fn of_locale() -> Self {
        Letters::of(["LC_ALL", "LC_CTYPE", "LANG"].map(std::env::var_os))
    }

    fn of(variables: [Option<OsString>; 3]) -> Self {
        let locale = variables.into_iter().flatten().find(|value| !value.is_empty()).unwrap_or_default();
        let locale = locale.to_string_lossy().to_lowercase();
        if locale.contains("utf-8") || locale.contains("utf8") { Letters::Unicode } else { Letters::Ascii }
    }

    /// A bar for a share from 0 to 1, at most `cells` long. A share above zero has at least a mark.
    pub fn bar(self, share: f64, cells: usize) -> String {
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        match self {
            Letters::Unicode => {
                let eighths = (share * 8.0 * cells as f64).round() as usize;
                let eighths = eighths.max(usize::from(share > 0.0));
                "█".repeat(eighths / 8) + EIGHTHS[eighths % 8]
            }
            Letters::Ascii => "#".repeat(((share * cells as f64).round() as usize).max(usize::from(share > 0.0))),
        }
    }

    /// A curve with one letter for each value, scaled from the smallest to the largest of them.
    pub fn spark(self, values: &[f64]) -> String {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        let heights: &[char] = if self == Letters::Unicode { &HEIGHTS } else { &ASCII_HEIGHTS };
        let top = (heights.len() - 1) as f64;
        let height = |value: f64| if high > low { (value - low) / (high - low) * top } else { top / 2.0 };
        values
            .iter()
            .map(|&value| if value.is_finite() { heights[height(value).round() as usize] } else { ' ' })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_locale_decides() {
        let of = |values: [&str; 3]| Letters::of(values.map(|value| Some(OsString::from(value))));
        assert_eq!(of(["", "", "de_DE.UTF-8"]), Letters::Unicode);
        assert_eq!(of(["", "C.utf8", "C"]), Letters::Unicode);
        assert_eq!(of(["POSIX", "", "de_DE.UTF-8"]), Letters::Ascii, "LC_ALL goes before LANG");
        assert_eq!(Letters::of([None, None, None]), Letters::Ascii);
    }

    #[test]
    fn a_bar_is_as_long_as_its_share() {
        assert_eq!(
            [0.0, 1e-9, 0.5, 1.0, 7.0].map(|share| Letters::Ascii.bar(share, 4)),
            ["", "#", "##", "####", "####"]
        );
        assert_eq!(Letters::Unicode.bar(0.5, 4), "██");
        assert_eq!(Letters::Unicode.bar(9.0 / 32.0, 4), "█▏");
        assert_eq!(Letters::Unicode.bar(f64::NAN, 4), "");
    }

    #[test]
    fn a_small_curve_reaches_from_the_least_to_the_largest() {
        assert_eq!(Letters::Unicode.spark(&[1.0, 2.0, f64::NAN, 8.0]), "▁▂ █");
        assert_eq!(Letters::Ascii.spark(&[4.0, 0.0, 2.0]), "#_-");
        assert_eq!(Letters::Ascii.spark(&[3.0]), "-");
    }
}
