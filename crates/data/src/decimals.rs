//! Whether commas are decimal marks or thousands separators.

use super::query::Layout;
use super::rows::TOO_NARROW;

/// How the numbers of a file are written, inferred from those read so far.
pub(super) struct Decimals {
    /// The decimal mark, if the layout gives it.
    given: Option<char>,
    /// Whether commas separate columns, so that they occur only in quoted cells.
    separates: bool,
    /// Whether commas are known to be decimal, because columns are separated otherwise or because a
    /// comma in some number cannot separate thousands.
    are_decimal: bool,
    /// Number of numbers with a comma and with a point.
    commas: u64,
    points: u64,
}

/// What is wrong with a cell, and the remedy.
type Wrong = (&'static str, &'static str);

const NO_NUMBER: Wrong = (
    "is not a number",
    "correct the cell; if it marks a missing value, give MARK{or skip}",
);

/// Several numbers in one cell, as in the files of NOAA.
const FIELDS: Wrong = (
    "has a leading zero before its comma: it may be a value and a quality code",
    "split the column at the comma, and give the unit of the first part; NOAA's +0120,1 is 12.0 degC in \
     `0.1degC`, and +9999 marks a missing value",
);

/// The problem of one number with a decimal comma and another with a point.
const MIXED: Wrong = (
    "mixes decimal commas and points, and its comma may separate thousands",
    "write all numbers with decimal points, or give the decimal separator: POINT if commas separate thousands, \
     COMMA if points do",
);

/// The problem of numbers with a comma that all have three digits after it.
pub(super) const THOUSANDS: Wrong = (
    "is ambiguous: the comma before three digits may separate decimals or thousands, here and in all other values",
    "write the numbers of the file with decimal points, or give the decimal separator: POINT if commas separate \
     thousands, COMMA if they separate decimals",
);

/// The problems of numbers whose marks show that one of them separates thousands.
const COMMAS_GROUP: Wrong = (
    "has commas between thousands",
    "write the numbers of the file without them, or give the decimal separator, POINT",
);
const POINTS_GROUP: Wrong = (
    "has points between thousands",
    "write the numbers of the file without them, or give the decimal separator, COMMA",
);

/// What is wrong with a text that is not a number, unless its thousands are separated by the other
/// mark.
fn no_number(text: &str) -> Wrong {
    let is = |mark| grouped(text, mark).is_some_and(f64::is_finite);
    match (is('.'), is(',')) {
        (true, false) if text.contains(',') => COMMAS_GROUP,
        (false, true) if text.contains('.') => POINTS_GROUP,
        _ if text.bytes().all(|byte| byte == b'#') => TOO_NARROW,
        _ => NO_NUMBER,
    }
}

impl Decimals {
    /// A reader for a file in which a comma may separate columns, or can only be decimal.
    pub fn of(layout: &Layout, are_decimal: bool) -> Self {
        Decimals {
            given: layout.decimal,
            separates: !are_decimal,
            are_decimal,
            commas: 0,
            points: 0,
        }
    }

    /// Whether the commas that were read are known to be decimal.
    pub fn are_known(&self) -> bool {
        self.are_decimal || self.commas == 0
    }

    /// How many decimal commas were read.
    pub fn commas(&self) -> u64 {
        self.commas
    }

    /// The number in a cell; what is wrong and the remedy if there is none.
    pub fn number(&mut self, cell: &[u8]) -> Result<f64, Wrong> {
        let text = std::str::from_utf8(cell).map_err(|_| NO_NUMBER)?;
        let digits = text.trim_start_matches(['+', '-']);
        if let Some(mark) = self.given {
            self.commas += u64::from(mark == ',' && text.contains(','));
            self.are_decimal = true;
            return grouped(text, mark).ok_or_else(|| no_number(text));
        }
        if let Some((whole, _)) = digits.split_once(',').filter(|_| self.separates)
            && whole.len() > 1
            && whole.starts_with('0')
            && whole.bytes().all(|byte| byte.is_ascii_digit())
        {
            return Err(FIELDS);
        }
        let Some((whole, decimals)) = text.split_once(',') else {
            self.points += u64::from(text.contains('.'));
            return if self.commas > 0 && text.contains('.') {
                Err(MIXED)
            } else {
                text.parse().map_err(|_| no_number(text))
            };
        };
        if decimals.contains([',', '.']) || whole.contains('.') {
            return Err(no_number(text));
        }
        let value = format!("{whole}.{decimals}")
            .parse()
            .map_err(|_| NO_NUMBER)?;
        let thousands = digits.find(',').unwrap_or(0);
        self.are_decimal |=
            decimals.len() != 3 || !(1..=3).contains(&thousands) || digits.starts_with('0');
        self.commas += 1;
        if self.points > 0 {
            Err(MIXED)
        } else {
            Ok(value)
        }
    }
}

/// A number with this decimal mark, and the other one between thousands.
fn grouped(text: &str, mark: char) -> Option<f64> {
    let other = if mark == ',' { '.' } else { ',' };
    let (whole, decimals) = text.split_once(mark).unwrap_or((text, ""));
    let is_group =
        |group: &str| group.len() == 3 && group.bytes().all(|byte| byte.is_ascii_digit());
    let is_whole = whole.split(other).skip(1).all(is_group) && !decimals.contains(other);
    let plain = whole.replace(other, "");
    let plain = if decimals.is_empty() {
        plain
    } else {
        format!("{plain}.{decimals}")
    };
    plain.parse().ok().filter(|_| is_whole)
}
