//! Which cells hold no value: marks that loggers and file formats use, and numbers far from all
//! others.

use super::query::Layout;

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

/// Numbers that loggers, sensors and file formats put in place of a value. One of them counts as a
/// mark only where it lies far from all other values.
const NUMBERS: [f64; 30] = [
    // 85 and -127 are what a DS18B20 shows before its first conversion and when it is unplugged.
    85.0, -127.0, 99.9, -99.9, 99.99, -99.99, 99.0, -99.0, 999.0, -999.0, 999.9, -999.9, 999.99, -999.99, 9999.0,
    -9999.0, 9999.9, -9999.9, 99_999.0, -99_999.0, 99_999.9, -99_999.9, 7999.0, -7999.0, 6999.0, -6999.0, 8888.0,
    -8888.0, 32_767.0, -32_768.0,
];

/// Numbers that only a file format writes: the usual fill values of netCDF and others. They are
/// marks wherever they stand.
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

/// The marks of one file.
pub(super) struct Marks {
    words: Vec<String>,
    numbers: Vec<f64>,
}

impl Marks {
    /// The marks that a layout gives, besides the usual ones.
    pub fn of(layout: &Layout) -> Self {
        let words = layout.missing.iter().map(|mark| mark.trim().to_lowercase()).collect();
        let numbers = layout.missing.iter().filter_map(|mark| mark.trim().parse().ok()).collect();
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
                || WORDS.iter().any(|word| cell.eq_ignore_ascii_case(word.as_bytes())));
        is_usual || self.words.iter().any(|word| cell.eq_ignore_ascii_case(word.as_bytes()))
    }

    /// Whether a number marks a missing value, whatever the others are.
    pub fn is_number(&self, value: f64) -> bool {
        let is = |mark: &f64| (value - mark).abs() <= 1e-6 * mark.abs();
        self.numbers.iter().any(is) || value.abs() > 1e15 && FILLS.iter().any(is)
    }
}

/// Whether a number may mark a missing value, if it is far from the others.
pub(super) fn is_suspect(value: f64) -> bool {
    // Values with more decimals than any mark are the rule, and need no search.
    let hundredths = 100.0 * value;
    hundredths == hundredths.round() && NUMBERS.contains(&value)
}

/// A mark is at least this share of the range of the other values away from them.
const MARK_APART: f64 = 0.5;

/// Other numbers are no measurements if they are this many ranges of the other values away, and not
/// more than this share of all.
const APART: f64 = 100.0;
const FEW: f64 = 0.05;

/// Fewest values that tell what is far.
const LEAST: usize = 20;

/// Which values are marks or stand far apart from all others.
pub(super) fn apart(values: &[f64]) -> Vec<bool> {
    let mut found: Vec<bool> = values.iter().map(|value| is_suspect(*value)).collect();
    let others = values.iter().zip(&found).filter(|(_, suspect)| !**suspect).map(|(value, _)| *value);
    let (low, high) = others.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if high > low {
        // The values on the far side are not known to be measurements, so each mark is compared
        // with those that are none.
        let ends = without_far([low, high], values, &found);
        let is_far = |value: f64| {
            value - ends[1] > MARK_APART * (ends[1] - ends[0]) || ends[0] - value > MARK_APART * (ends[1] - ends[0])
        };
        for (value, found) in values.iter().zip(&mut found) {
            *found = (*found || values.len() >= LEAST && !(ends[0]..=ends[1]).contains(value)) && is_far(*value);
        }
    } else {
        found.iter_mut().for_each(|found| *found = false);
    }
    found
}

/// The lowest and the highest value, without the few at either end that stand far apart.
fn without_far(ends: [f64; 2], values: &[f64], suspects: &[bool]) -> [f64; 2] {
    let mut sorted: Vec<f64> =
        values.iter().zip(suspects).filter(|(_, suspect)| !**suspect).map(|(value, _)| *value).collect();
    if sorted.len() < LEAST {
        return ends;
    }
    sorted.sort_by(f64::total_cmp);
    let few = (FEW * sorted.len() as f64) as usize;
    let (mut first, mut last) = (0, sorted.len() - 1);
    let is_apart = |gap: f64, range: f64| range > 0.0 && gap > APART * range;
    for end in (last - few..last).rev() {
        if is_apart(sorted[end + 1] - sorted[end], sorted[end] - sorted[few]) {
            last = end;
        }
    }
    for start in 1..=few {
        if is_apart(sorted[start] - sorted[start - 1], sorted[last] - sorted[start]) {
            first = start;
        }
    }
    [sorted[first], sorted[last]]
}
