//! The column of times: stamps with their time zones, or numbers.

use super::unit::{self, Unit};
use jiff::civil::DateTime;
use jiff::fmt::temporal::DateTimeParser;
use jiff::tz::{AmbiguousOffset, TimeZone};
use jiff::{SignedDuration, Timestamp};
use std::fmt;

static PARSER: DateTimeParser = DateTimeParser::new();

/// An instant, such as the one from which the times of a table count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start(Timestamp);

impl Start {
    /// Read an RFC 3339 stamp; `None` if the text is none.
    pub fn parse(stamp: &str) -> Option<Self> {
        PARSER.parse_timestamp(stamp).ok().map(Start)
    }

    /// Read a date, with or without a time of day and a zone, as it appears in the units of a time
    /// in a CF file. Without a zone it is UTC.
    #[cfg(feature = "store")]
    pub(super) fn of_calendar(text: &str) -> Option<Self> {
        let text = text.trim().trim_end_matches(" UTC");
        let utc = |time: DateTime| time.to_zoned(TimeZone::UTC).ok().map(|zoned| Start(zoned.timestamp()));
        Start::parse(text).or_else(|| PARSER.parse_datetime(text).ok().and_then(utc))
    }

    /// Seconds from `earlier` to this instant.
    pub fn since(&self, earlier: &Start) -> f64 {
        self.0.duration_since(earlier.0).as_secs_f64()
    }

    /// The instant `seconds` later; `None` beyond the range of the calendar.
    pub fn after(&self, seconds: f64) -> Option<Self> {
        let later = SignedDuration::try_from_secs_f64(seconds).ok()?;
        self.0.checked_add(later).ok().map(Start)
    }
}

/// Prints the RFC 3339 stamp in UTC.
impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Reads the cells of the time column one after the other and gives seconds.
pub(super) enum Clock {
    /// The cells are numbers. They are converted to seconds if the name of the column gives a unit.
    Numbers { unit: Option<Unit>, first: Option<f64> },
    /// The cells are stamps.
    Stamps { zone: Option<TimeZone>, first: Option<Timestamp>, previous: Option<Timestamp>, folds: u64 },
}

/// What is wrong with a time, and the remedy.
pub(super) type ProblemAndRemedy = (String, String);

fn wrong<T>(problem: impl Into<String>, remedy: impl Into<String>) -> Result<T, ProblemAndRemedy> {
    Err((problem.into(), remedy.into()))
}

impl Clock {
    /// A reader for a column with this name, this zone for stamps without one, and this first cell.
    pub fn new(column: &str, zone: Option<&str>, first: &[u8]) -> Result<Self, ProblemAndRemedy> {
        let number = std::str::from_utf8(first).is_ok_and(|text| text.replace(',', ".").parse::<f64>().is_ok());
        if number {
            return Ok(Clock::Numbers { unit: unit::of_time(column), first: None });
        }
        let zone = match zone {
            None => None,
            Some(name) => match PARSER.parse_time_zone(name) {
                Ok(zone) => Some(zone),
                Err(_) => {
                    let remedy = "give an IANA name such as \"Europe/Paris\", \"UTC\", or an offset such as \"+01:00\"";
                    return wrong(format!("cannot be read, because no time zone is called \"{name}\""), remedy);
                }
            },
        };
        Ok(Clock::Stamps { zone, first: None, previous: None, folds: 0 })
    }

    /// Whether times are in seconds. Numbers in a column whose name gives no unit stay in their
    /// own, unknown unit.
    pub fn in_seconds(&self) -> bool {
        !matches!(self, Clock::Numbers { unit: None, .. })
    }

    /// The instant from which times count, if the cells are stamps.
    pub fn first(&self) -> Option<Start> {
        match self {
            Clock::Stamps { first, .. } => first.map(Start),
            Clock::Numbers { .. } => None,
        }
    }

    /// Number of stamps that fell in an hour which occurs twice, when clocks are put back.
    pub fn folds(&self) -> u64 {
        match self {
            Clock::Stamps { folds, .. } => *folds,
            Clock::Numbers { .. } => 0,
        }
    }

    /// The time of a cell since the first cell.
    pub fn read(&mut self, cell: &[u8], number: impl Fn(&[u8]) -> Option<f64>) -> Result<f64, ProblemAndRemedy> {
        match self {
            Clock::Numbers { unit, first } => {
                let Some(time) = number(cell).filter(|time| time.is_finite()) else {
                    return wrong("is not a number, as the times before it are", "mend the row");
                };
                let since = time - *first.get_or_insert(time);
                Ok(unit.map_or(since, |unit| unit.of(since)))
            }
            Clock::Stamps { zone, first, previous, folds } => {
                let (stamp, fold) = instant(cell, zone.as_ref(), *previous)?;
                *folds += u64::from(fold);
                *previous = Some(stamp);
                let since = stamp.duration_since(*first.get_or_insert(stamp));
                Ok(since.as_secs() as f64 + f64::from(since.subsec_nanos()) / 1e9)
            }
        }
    }
}

/// The instant of a stamp, and whether it fell in an hour which occurs twice.
fn instant(
    cell: &[u8],
    zone: Option<&TimeZone>,
    previous: Option<Timestamp>,
) -> Result<(Timestamp, bool), ProblemAndRemedy> {
    // Behind the ten characters of the date, `Z`, `+` or `-` gives the zone.
    if cell.iter().skip(10).any(|byte| matches!(byte, b'Z' | b'z' | b'+' | b'-')) {
        return PARSER.parse_timestamp(cell).map(|stamp| (stamp, false)).or_else(|_| not_a_stamp());
    }
    let local = PARSER.parse_datetime(cell).or_else(|_| not_a_stamp())?;
    let Some(zone) = zone else {
        let remedy = "say in which zone the clock ran: `zone = \"UTC\"`, \"Europe/Paris\" or \"+01:00\"";
        return wrong("is a stamp without a zone", remedy);
    };
    in_zone(local, zone, previous)
}

/// The instant of a local time. A time that the clocks skipped is an error. A time that occurred
/// twice is taken as the first of its two instants that is later than the row before.
fn in_zone(
    local: DateTime,
    zone: &TimeZone,
    previous: Option<Timestamp>,
) -> Result<(Timestamp, bool), ProblemAndRemedy> {
    let found = zone.to_ambiguous_timestamp(local);
    let beyond = |_| ("is beyond the calendar".to_string(), "mend the row".to_string());
    match found.offset() {
        AmbiguousOffset::Unambiguous { .. } => found.unambiguous().map(|stamp| (stamp, false)).map_err(beyond),
        AmbiguousOffset::Gap { .. } => wrong(
            "never was in this zone, whose clocks skipped that hour",
            "if the logger keeps one time the whole year, say which: `zone = \"UTC\"` or an offset such as \"+01:00\"",
        ),
        AmbiguousOffset::Fold { .. } => {
            let both = [found.earlier().map_err(beyond)?, found.later().map_err(beyond)?];
            match both.into_iter().find(|stamp| previous.is_none_or(|previous| *stamp > previous)) {
                Some(stamp) => Ok((stamp, true)),
                None => wrong(
                    "was twice in this zone, whose clocks were put back, and both times lie before the row above",
                    "sort the rows, write stamps with their offset, or say the zone that the logger keeps the whole year",
                ),
            }
        }
    }
}

fn not_a_stamp<T>() -> Result<T, ProblemAndRemedy> {
    wrong(
        "is no time that can be read",
        "write stamps as 2015-08-13T00:10:00Z or 2015-08-13 00:10, year first, or numbers in a column such as `time_s`",
    )
}
