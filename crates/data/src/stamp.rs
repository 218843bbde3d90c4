//! A date and a time of day, as loggers and spreadsheets write them.

use super::query::DateOrder;
use jiff::civil::{Date, DateTime, Time};
use jiff::fmt::temporal::DateTimeParser;
use jiff::tz::Offset;
use jiff::{SignedDuration, Span, Timestamp};

pub(super) static PARSER: DateTimeParser = DateTimeParser::new();

/// A date and a time of day, with the offset from UTC if the text gives one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stamp {
    pub local: DateTime,
    pub offset: Option<Offset>,
    /// Added to `local`, for times such as 24:00 that no calendar contains.
    pub later: SignedDuration,
}

impl Stamp {
    fn at(local: DateTime) -> Self {
        Stamp {
            local,
            offset: None,
            later: SignedDuration::ZERO,
        }
    }
}

/// Three numbers of a date, in the order of the text.
struct Numbers {
    parts: [i16; 3],
    /// Whether the first of them is a year of four digits, or whether the month is a word.
    order: Option<DateOrder>,
    /// Whether the year, at the end, has two digits.
    is_short: bool,
}

/// Read a stamp. A date whose year is not first is read in this order; without an order it is not a
/// stamp.
pub(super) fn stamp(text: &str, order: Option<DateOrder>) -> Option<Stamp> {
    let text = text.trim();
    // Most files write dates as ISO 8601 does, and this reader is fast.
    if is_iso(text)
        && !has_zone(text)
        && let Ok(local) = PARSER.parse_datetime(text)
    {
        return Some(Stamp::at(local));
    }
    if let Some(stamp) = compact(text) {
        return Some(stamp);
    }
    let (date, rest) = date(text)?;
    let of = |order: DateOrder| {
        let [a, b, c] = date.parts;
        let (year, month, day) = match order {
            DateOrder::YearMonthDay => (a, b, c),
            DateOrder::DayMonthYear => (c, b, a),
            DateOrder::MonthDayYear => (c, a, b),
        };
        let is_first = order == DateOrder::YearMonthDay;
        let year = if (date.is_short || is_first && date.order.is_none()) && year < 100 {
            whole_year(year)
        } else {
            year
        };
        Date::new(year, i8::try_from(month).ok()?, i8::try_from(day).ok()?).ok()
    };
    let day = of(date.order.or(order)?)?;
    let (time, later, rest) = time_of_day(rest)?;
    let offset = if rest.trim().is_empty() {
        None
    } else {
        Some(offset(rest.trim())?)
    };
    Some(Stamp {
        local: day.to_datetime(time),
        offset,
        later,
    })
}

/// The year of two digits, as POSIX understands it.
pub(super) fn whole_year(short: i16) -> i16 {
    if short < 69 {
        2000 + short
    } else {
        1900 + short
    }
}

/// Whether a text has the form of ISO 8601 or RFC 9557 without a leap second, which their reader
/// counts as the second before it.
fn is_iso(text: &str) -> bool {
    let bytes = text.as_bytes();
    bytes.len() >= 10 && bytes[4] == b'-' && bytes[7] == b'-' && !text.contains(":60")
}

/// The instant that a text with a zone or an offset names, as ISO 8601 or RFC 9557 write it.
pub(super) fn instant(text: &str) -> Option<Timestamp> {
    Some(text)
        .filter(|text| is_iso(text) && has_zone(text))
        .and_then(|text| PARSER.parse_timestamp(text).ok())
}

/// After the ten characters of the date, `Z`, `+` or `-` gives the zone.
fn has_zone(text: &str) -> bool {
    text.bytes()
        .skip(10)
        .any(|byte| matches!(byte, b'Z' | b'z' | b'+' | b'-'))
}

/// The numbers of the date at the beginning of a text, and the text after it.
fn date(text: &str) -> Option<(Numbers, &str)> {
    let (first, rest) = digits(text)?;
    if first.len() == 8 && !rest.starts_with(['-', '/', '.']) {
        let parts = [
            first[..4].parse().ok()?,
            first[4..6].parse().ok()?,
            first[6..].parse().ok()?,
        ];
        return Some((
            Numbers {
                parts,
                order: Some(DateOrder::YearMonthDay),
                is_short: false,
            },
            rest,
        ));
    }
    let separator = rest.chars().next().filter(|c| "-/. ".contains(*c))?;
    let (second, word, rest) = match digits(&rest[1..]) {
        Some((second, rest)) => (second.parse().ok()?, false, rest.strip_prefix(separator)?),
        None => {
            // As in `01. Jan. 2023`.
            let rest = rest[1..].trim_start();
            let end = rest.find(|c: char| !c.is_alphabetic())?;
            let between = ['.', ' ', separator];
            (
                month(&rest[..end])?,
                true,
                rest[end..].trim_start_matches(between),
            )
        }
    };
    if separator == ' ' && !word {
        return None;
    }
    let (third, rest) = digits(rest)?;
    let parts = [first.parse().ok()?, second, third.parse().ok()?];
    let order = match (first.len(), third.len(), word) {
        (4, 1 | 2, _) => Some(DateOrder::YearMonthDay),
        (1 | 2, 2 | 4, true) => Some(DateOrder::DayMonthYear),
        (1 | 2, 2 | 4, false) => None,
        _ => return None,
    };
    Some((
        Numbers {
            parts,
            order,
            is_short: third.len() == 2 && first.len() != 4,
        },
        rest,
    ))
}

/// The month that a word stands for, in English, German, French, Spanish or Italian, from its first
/// letters.
fn month(word: &str) -> Option<i16> {
    const MONTHS: [&str; 12] = [
        "jan ene gen",
        "feb fév fev",
        "mar mär mrz",
        "apr avr abr",
        "may mai mag",
        "jun juin giu",
        "jul juil lug",
        "aug aoû ago",
        "sep set",
        "oct okt ott",
        "nov",
        "dec dez déc dic",
    ];
    let lower = word.to_lowercase();
    let is_month = |begins: &&str| begins.split(' ').any(|begin| lower.starts_with(begin));
    let place = MONTHS.iter().position(is_month)?;
    Some(place as i16 + 1)
}

fn digits(text: &str) -> Option<(&str, &str)> {
    let end = text
        .find(|c: char| !c.is_ascii_digit())
        .unwrap_or(text.len());
    (end > 0 && end <= 9).then(|| text.split_at(end))
}

/// The time of day, what to add to it, and the text after it. An empty text is midnight.
fn time_of_day(text: &str) -> Option<(Time, SignedDuration, &str)> {
    let text = text
        .strip_prefix(['T', 't', ','])
        .unwrap_or(text)
        .trim_start();
    if text.is_empty() || !text.starts_with(|c: char| c.is_ascii_digit()) {
        return Some((Time::midnight(), SignedDuration::ZERO, text));
    }
    let (hours, mut rest) = digits(text)?;
    let (mut hour, minute): (i8, i8);
    let (mut second, mut nanos) = (0, 0);
    if hours.len() == 4 {
        (hour, minute) = (hours[..2].parse().ok()?, hours[2..].parse().ok()?);
    } else if hours.len() == 6 {
        (hour, minute) = (hours[..2].parse().ok()?, hours[2..4].parse().ok()?);
        second = hours[4..].parse().ok()?;
    } else if hours.len() <= 2 {
        hour = hours.parse().ok()?;
        rest = rest.strip_prefix([':', '.'])?;
        let (minutes, after) = digits(rest).filter(|(minutes, _)| minutes.len() == 2)?;
        (minute, rest) = (minutes.parse().ok()?, after);
        if let Some((seconds, after)) = rest
            .strip_prefix([':', '.'])
            .and_then(digits)
            .filter(|(s, _)| s.len() == 2)
        {
            (second, rest) = (seconds.parse().ok()?, after);
            if let Some((fraction, after)) = rest.strip_prefix(['.', ',']).and_then(digits) {
                nanos = format!("{fraction:0<9}")[..9].parse().ok()?;
                rest = after;
            }
        }
    } else {
        return None;
    }
    let word: String = rest
        .trim_start()
        .chars()
        .take_while(|c| c.is_ascii_alphabetic() || *c == '.')
        .collect();
    let half = word.replace('.', "").to_lowercase();
    if ["a", "am", "p", "pm"].contains(&half.as_str()) {
        if !(1..=12).contains(&hour) {
            return None;
        }
        hour = hour % 12 + if half.starts_with('p') { 12 } else { 0 };
        rest = &rest.trim_start()[word.len()..];
    }
    let mut later = SignedDuration::ZERO;
    if hour == 24 && minute == 0 && second == 0 && nanos == 0 {
        (hour, later) = (0, SignedDuration::from_hours(24));
    } else if second == 60 && minute == 59 {
        // Leap seconds are not in the calendar. They are placed between their neighbours.
        (second, later) = (59, SignedDuration::from_millis(500));
    }
    Some((Time::new(hour, minute, second, nanos).ok()?, later, rest))
}

/// Abbreviations of time zones that have one meaning, with their hours ahead of UTC. Others, such as
/// CST, IST and BST, have several.
const ZONES: [(&str, i8); 18] = [
    ("WET", 0),
    ("CET", 1),
    ("MEZ", 1),
    ("WEST", 1),
    ("CEST", 2),
    ("MESZ", 2),
    ("EET", 2),
    ("EEST", 3),
    ("EST", -5),
    ("EDT", -4),
    ("CDT", -5),
    ("MST", -7),
    ("MDT", -6),
    ("PST", -8),
    ("PDT", -7),
    ("JST", 9),
    ("AEST", 10),
    ("AEDT", 11),
];

/// The offset from UTC of the zone with this abbreviation, in capitals.
pub(super) fn abbreviated(zone: &str) -> Option<Offset> {
    let (_, hours) = ZONES.iter().find(|(name, _)| *name == zone)?;
    Some(Offset::constant(*hours))
}

/// The unknown abbreviation of a zone after a date and a time of day.
pub(super) fn unknown_zone(text: &str) -> Option<&str> {
    let (before, word) = text.trim().rsplit_once(' ')?;
    let is_word = word.len() >= 2 && word.chars().all(char::is_alphabetic);
    let is_date = stamp(before, None).is_some() || needs_order(before);
    Some(word).filter(|_| is_word && before.contains(':') && is_date)
}

/// The offset from UTC that a text gives: `Z`, `UTC`, `GMT`, `CET`, `+01:00`, `+0100`, `UTC+1`.
pub(super) fn offset(text: &str) -> Option<Offset> {
    let upper = text.to_uppercase();
    if let Some(offset) = abbreviated(&upper) {
        return Some(offset);
    }
    let rest = ["UTC", "GMT", "Z"]
        .iter()
        .find_map(|name| upper.strip_prefix(name));
    match rest {
        Some("") => return Some(Offset::UTC),
        None if !upper.starts_with(['+', '-', '\u{2212}']) => return None,
        _ => {}
    }
    let rest = rest.unwrap_or(&upper);
    let sign = if rest.starts_with('+') { 1 } else { -1 };
    let numbers = rest.strip_prefix(['+', '-', '\u{2212}'])?;
    let (hours, minutes) = match numbers.split_once(':') {
        Some((hours, minutes)) => (hours, minutes),
        None if numbers.len() == 4 => numbers.split_at(2),
        None => (numbers, "0"),
    };
    let number = |text: &str| {
        Some(text)
            .filter(|text| !text.is_empty() && text.len() <= 2)?
            .parse::<i32>()
            .ok()
    };
    Offset::from_seconds(
        sign * (3600 * number(hours)? + 60 * number(minutes).filter(|minutes| *minutes < 60)?),
    )
    .ok()
}

/// Whether a text is a date whose order of day, month and year must be known.
pub(super) fn needs_order(text: &str) -> bool {
    stamp(text, None).is_none()
        && DateOrder::WORDS
            .iter()
            .any(|(_, order)| stamp(text, Some(*order)).is_some())
}

/// The form of a date: the number of digits at its beginning (one counts as two), the character
/// after them, and whether a year of four digits is last. Two forms in one column may mean two
/// orders. `None` for a text that begins with no number.
pub(super) fn form(text: &str) -> Option<(usize, Option<char>, bool)> {
    let text = text.trim();
    let first = text.bytes().take_while(u8::is_ascii_digit).count();
    let rest = &text[first..];
    let sign = rest.chars().next().filter(|sign| "-/.".contains(*sign));
    let is_long = |sign| {
        let last = rest.split(sign).nth(2).and_then(digits);
        last.is_some_and(|(last, _)| last.len() == 4)
    };
    (first > 0).then_some((first.max(2), sign, first <= 2 && sign.is_some_and(is_long)))
}

/// Whether a text is a time of day without a date, such as 13:10.
pub(super) fn is_time_of_day(text: &str) -> bool {
    let text = text.trim();
    text.contains(':')
        && text.len() <= 12
        && time_of_day(text).is_some_and(|(.., rest)| rest.trim().is_empty())
}

/// A whole number that is a date with 8 to 14 digits: 20250101, 2025010123, 202501012300 or
/// 20250101230000, from 1900 to 2099.
pub(super) fn compact(text: &str) -> Option<Stamp> {
    let is_number = text.bytes().all(|byte| byte.is_ascii_digit());
    if !is_number
        || !matches!(text.len(), 8 | 10 | 12 | 14)
        || !(text.starts_with("19") || text.starts_with("20"))
    {
        return None;
    }
    let number = |at: usize| {
        text.get(at..at + 2)
            .map_or(Some(0), |digits| digits.parse::<i8>().ok())
    };
    let day = Date::new(text[..4].parse().ok()?, number(4)?, number(6)?).ok()?;
    let (hour, minute, second) = (number(8)?, number(10)?, number(12)?);
    let (hour, later) = if (hour, minute, second) == (24, 0, 0) {
        (0, 24)
    } else {
        (hour, 0)
    };
    let local = day.to_datetime(Time::new(hour, minute, second, 0).ok()?);
    Some(Stamp {
        later: SignedDuration::from_hours(later),
        ..Stamp::at(local)
    })
}

/// The days between 1954 and 2119, since 1970.
const CALENDAR_DAYS: std::ops::Range<f64> = -5_569.0..54_431.0;

/// Counts of days that programs write as dates, with the number of 1970.
const DAY_COUNTS: [(&str, f64); 3] = [
    ("a spreadsheet date", 25_569.0),
    ("a MATLAB date number", 719_529.0),
    ("a Julian date", 2_440_587.5),
];

/// The kind of day count that a number may be, and its days since 1970, from 1954 to 2119.
pub(super) fn day_count(number: f64) -> Option<(&'static str, f64)> {
    let counts = DAY_COUNTS.iter().map(|(name, zero)| (*name, number - zero));
    counts
        .into_iter()
        .find(|(_, days)| CALENDAR_DAYS.contains(days))
}

/// The date this many days after the beginning of 1970, to a millisecond.
pub(super) fn day(days: f64) -> Option<Stamp> {
    let milliseconds = (days * 86_400_000.0).round() as i64;
    let local = Date::new(1970, 1, 1).ok()?.to_datetime(Time::midnight());
    let local = local
        .checked_add(Span::new().try_milliseconds(milliseconds).ok()?)
        .ok()?;
    Some(Stamp::at(local))
}
