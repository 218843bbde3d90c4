//! Marks of missing values: words, fill values of file formats, and the marks of a layout. All
//! other numbers are values.

use super::query::Layout;
use super::repairs::many;

/// Words, in lower case, that mark a missing value; an empty cell and dashes mark one as well.
const WORDS: [&str; 13] = [
    "nan",
    "na",
    "n/a",
    "n.a.",
    "null",
    "none",
    "#n/a",
    "missing",
    "not av.",
    "not available",
    "no data",
    "nodata",
    "-nan",
];

/// Numbers that only file formats write: the usual fill values of netCDF and others. They always
/// mark a missing value.
const FILLS: [f64; 9] = [
    9.969_209_968_386_869e36,
    1e20,
    -1e20,
    1e30,
    -1e30,
    -1e34,
    1e35,
    3.402_823_466_385_288_6e38,
    -3.402_823_466_385_288_6e38,
];

/// Numbers that many files use, with either sign, for a missing value. They may also be values.
const NINES: [f64; 4] = [999.0, 9_999.0, 99_999.0, 999_999.0];

/// A warning about values, given with their lines, that may be marks but are used as values.
pub(super) fn likely(name: &str, values: impl Iterator<Item = (f64, u64)>) -> Option<String> {
    let mut found = values.filter(|(value, _)| NINES.contains(&value.abs()));
    let (value, line) = found.next()?;
    let more = many(found.count() as u64, ", and # other{s}").unwrap_or_default();
    Some(format!(
        "kept `{name}` = {value} in line {line}, which often marks a missing value{more}"
    ))
}

/// The marks of one file.
pub(super) struct Marks {
    words: Vec<String>,
    numbers: Vec<f64>,
}

impl Marks {
    /// The marks of a layout, in addition to the usual ones.
    pub fn of(layout: &Layout) -> Self {
        let words = layout
            .missing
            .iter()
            .map(|mark| mark.trim().to_lowercase())
            .collect();
        let numbers = layout
            .missing
            .iter()
            .filter_map(|mark| mark.trim().replace(',', ".").parse().ok())
            .collect();
        Marks { words, numbers }
    }

    /// Whether a cell marks a missing value, whatever the other cells are.
    pub fn is_word(&self, cell: &[u8]) -> bool {
        if cell.is_empty() {
            return true;
        }
        // Most cells end in a digit, and none of the usual words does.
        let is_usual = !cell[cell.len() - 1].is_ascii_digit()
            && (cell.iter().all(|byte| *byte == b'-')
                || WORDS
                    .iter()
                    .any(|word| cell.eq_ignore_ascii_case(word.as_bytes())));
        is_usual
            || self
                .words
                .iter()
                .any(|word| cell.eq_ignore_ascii_case(word.as_bytes()))
    }

    /// Whether a number marks a missing value, whatever the others are.
    pub fn is_number(&self, value: f64) -> bool {
        let is = |mark: &f64| (value - mark).abs() <= 1e-6 * mark.abs();
        self.numbers.iter().any(is) || value.abs() > 1e15 && FILLS.iter().any(is)
    }
}
