//! The column of times: stamps with their time zones, dates as numbers, or plain numbers.

use super::column::LARGEST_MEASURED;
use super::error::ProblemAndRemedy;
use super::orders::are_exchanged;
use super::query::{DateOrder, Layout, Wording};
use super::rows::{OR_SKIP, TOO_NARROW};
use super::stamp::{self, PARSER, Stamp};
use super::unit::{self, InputUnit};
use jiff::civil::DateTime;
use jiff::tz::{AmbiguousOffset, TimeZone};
use jiff::{SignedDuration, Timestamp};
use std::fmt;

/// An instant, such as the one from which the times of a table count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start(Timestamp);

impl Start {
    /// Read an RFC 3339 stamp; `None` for any other text.
    pub fn parse(stamp: &str) -> Option<Self> {
        PARSER.parse_timestamp(stamp).ok().map(Start)
    }

    /// Read a date, with or without a time of day and a zone, as people write
    /// it. Without a zone it is UTC.
    pub fn of_calendar(text: &str) -> Option<Self> {
        let stamp = stamp::stamp(text, None)?;
        let zone = stamp.offset.map_or(TimeZone::UTC, TimeZone::fixed);
        let zoned = stamp.local.to_zoned_datetime(zone).ok()?;
        zoned.timestamp().checked_add(stamp.later).ok().map(Start)
    }

    /// Seconds from `earlier` to this instant.
    pub fn since(&self, earlier: &Start) -> f64 {
        self.0.duration_since(earlier.0).as_secs_f64()
    }

    /// The date in UTC, and the time of day in UTC as a fraction of a day.
    pub fn date(&self) -> (jiff::civil::Date, f64) {
        let there = self.0.to_zoned_datetime(TimeZone::UTC);
        (
            there.date(),
            there
                .time()
                .duration_since(jiff::civil::Time::midnight())
                .as_secs_f64()
                / 86_400.0,
        )
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

/// What the cells of a time column contain.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Numbers. They are converted to seconds if their unit is known.
    Numbers { unit: Option<InputUnit> },
    /// Dates.
    Stamps,
    /// Counts since 1970 in UTC, with this many per second.
    Epoch(f64),
    /// Days counted by a program, with the name of the count.
    Days(&'static str),
}

/// Reads the cells of the time column one after the other and gives seconds.
pub(super) struct Clock {
    kind: Kind,
    zone: Option<TimeZone>,
    order: Option<DateOrder>,
    wording: Wording,
    /// The first number, or the first and the latest instant.
    origin: Option<f64>,
    first: Option<Timestamp>,
    previous: Option<Timestamp>,
    /// The form of the first stamp.
    form: Option<(usize, Option<char>, bool)>,
    /// Number of instants that are later than the one before, and of those that are earlier.
    up: u64,
    down: u64,
    /// The zone in the name of the column, if a different one was given.
    pub other_zone: Option<String>,
    /// Number of stamps in an hour that occurs twice because clocks were set back.
    pub folds: u64,
}

fn wrong<T>(problem: impl Into<String>, remedy: impl Into<String>) -> Result<T, ProblemAndRemedy> {
    Err((problem.into(), remedy.into()))
}

/// Numbers that are probably dates, even without a zone, as days since 1970: from 2000 to 2051.
const LIKELY_DAYS: std::ops::Range<f64> = 10_957.0..29_584.0;

/// The fraction of rows out of order above which dates are considered misread, in files with more
/// rows than this.
const MOST_DISORDER: f64 = 0.4;
const FEWEST_STEPS: u64 = 10;

/// The counts per second, if a number is a time from 1999 to 2100 in seconds, milliseconds,
/// microseconds or nanoseconds since 1970.
fn per_second_since_epoch(number: f64) -> Option<f64> {
    [1.0, 1e3, 1e6, 1e9]
        .into_iter()
        .find(|per_second| (9.4e8..4.1e9).contains(&(number / per_second)))
}

impl Clock {
    /// A reader for a column with this name, or this unit below its name, and this first cell.
    pub fn new(
        column: &str,
        unit_below: Option<&str>,
        layout: &Layout,
        order: Option<DateOrder>,
        first: &str,
    ) -> Result<Self, ProblemAndRemedy> {
        let unit = unit::of_time(column).or_else(|| unit_below.and_then(unit::time));
        let kind = kind(column, unit, layout, first)?;
        let given = match &layout.zone {
            Some(name) => match PARSER.parse_time_zone(name) {
                Ok(zone) => Some(zone),
                Err(_) => {
                    let remedy = "give an IANA name such as \"Europe/Paris\", \"UTC\", or an offset such as \"+01:00\"";
                    return wrong(
                        format!("cannot be read: unknown time zone \"{name}\""),
                        remedy,
                    );
                }
            },
            None => None,
        };
        // Like the zone in a stamp, the zone in the column's name takes precedence over a given
        // one, which may be for another file. An abbreviation may stand for a zone with summer time.
        let named = offset_in(column);
        let differs = |zone: &&TimeZone| given.as_ref().is_some_and(|given| given != *zone);
        let other_zone = named
            .as_ref()
            .filter(differs)
            .and_then(|zone| zone.to_fixed_offset().ok());
        Ok(Clock {
            kind,
            zone: named.or(given).or_else(|| zone_in(column)),
            order,
            wording: layout.wording,
            origin: None,
            first: None,
            previous: None,
            form: None,
            up: 0,
            down: 0,
            other_zone: other_zone.map(|offset| offset.to_string()),
            folds: 0,
        })
    }

    /// Whether too many rows are out of order, so that their dates must have been misread.
    pub fn is_disordered(&self) -> bool {
        let steps = self.up + self.down;
        steps >= FEWEST_STEPS && self.up.min(self.down) as f64 >= MOST_DISORDER * steps as f64
    }

    /// Whether a spreadsheet has exchanged day and month in the dates of these times, given in the
    /// order of their rows.
    pub fn is_exchanged(&self, times: impl Iterator<Item = f64>) -> bool {
        if self.kind != Kind::Stamps || self.down == 0 {
            return false;
        }
        let zone = self.zone.clone().unwrap_or(TimeZone::UTC);
        let date = |time| {
            let instant = self.first()?.after(time)?.0;
            Some(instant.to_zoned_datetime(zone.clone()).date())
        };
        are_exchanged(&times.filter_map(date).collect::<Vec<_>>())
    }

    /// Whether times are in seconds. Numbers in a column whose name gives no unit keep their
    /// unknown unit.
    pub fn in_seconds(&self) -> bool {
        self.kind != Kind::Numbers { unit: None }
    }

    /// The instant from which times count, if the cells are dates.
    pub fn first(&self) -> Option<Start> {
        self.first.map(Start)
    }

    /// The number in the first cell; 0 for dates.
    pub fn begin(&self) -> f64 {
        self.origin.filter(|_| self.first.is_none()).unwrap_or(0.0)
    }

    /// The time of a cell since the first cell.
    pub fn read(&mut self, cell: &str) -> Result<f64, ProblemAndRemedy> {
        let when = self.time(cell)?;
        if when.abs() > LARGEST_MEASURED {
            return wrong(
                "is too large for a time",
                "correct the cell, or choose another time column",
            );
        }
        Ok(when)
    }

    fn time(&mut self, cell: &str) -> Result<f64, ProblemAndRemedy> {
        let as_before = |what: &str| {
            (
                format!("is not {what}, unlike the times before it"),
                format!("correct the line{OR_SKIP}"),
            )
        };
        let number = || number(cell).filter(|time| time.is_finite());
        if self.kind == Kind::Stamps && !self.is_in_form(cell) {
            return wrong(
                "has a different date format from the dates above it",
                "write all dates of the column in one format",
            );
        }
        let stamp = match self.kind {
            Kind::Numbers { unit } => {
                let time = number().ok_or_else(|| as_before("a number"))?;
                let since = time - *self.origin.get_or_insert(time);
                return Ok(unit.map_or(since, |unit| unit.of(since)));
            }
            Kind::Epoch(per_second) => {
                let time = number().ok_or_else(|| as_before("a number"))?;
                let origin = *self.origin.get_or_insert(time);
                if self.first.is_none() {
                    let since_1970 =
                        SignedDuration::try_from_secs_f64(time / per_second).unwrap_or_default();
                    self.first = Timestamp::UNIX_EPOCH.checked_add(since_1970).ok();
                }
                return Ok((time - origin) / per_second);
            }
            Kind::Days(name) => number()
                .and_then(stamp::day_count)
                .filter(|(same, _)| *same == name)
                .and_then(|(_, days)| stamp::day(days))
                .ok_or_else(|| as_before(name))?,
            Kind::Stamps => match stamp::instant(cell) {
                Some(instant) => return Ok(self.since_first(instant)),
                None => match stamp::stamp(cell, self.order) {
                    Some(stamp) => stamp,
                    None => return self.no_stamp(cell),
                },
            },
        };
        let (instant, is_fold) = self.instant(&stamp)?;
        self.folds += u64::from(is_fold);
        Ok(self.since_first(instant))
    }

    /// Whether a stamp has the form of the first one.
    fn is_in_form(&mut self, cell: &str) -> bool {
        let Some(form) = stamp::form(cell) else {
            return true;
        };
        form == *self.form.get_or_insert(form)
    }

    /// Why a cell is not a stamp.
    fn no_stamp(&self, cell: &str) -> Result<f64, ProblemAndRemedy> {
        if let Some(zone) = stamp::unknown_zone(cell) {
            let example = self.wording.option("zone", "Europe/Paris");
            return wrong(
                format!("ends with `{zone}`, a time zone that is unknown or has several meanings"),
                format!("write an offset such as +01:00 instead, or remove it and give {example}"),
            );
        }
        match self.order {
            _ if cell.bytes().all(|byte| byte == b'#') => wrong(TOO_NARROW.0, TOO_NARROW.1),
            _ if stamp::is_time_of_day(cell) => wrong(
                "is a time of day without a date",
                format!(
                    "name the columns of both, e.g. {}",
                    self.wording.option("time", "Date,Time")
                ),
            ),
            None if stamp::needs_order(cell) => wrong(
                "is ambiguous: day and month may be exchanged, in this date and all others",
                format!(
                    "give the order, {} or {}{}{}",
                    self.wording.option("dates", "dmy"),
                    self.wording.option("dates", "mdy"),
                    if stamp::stamp(cell, Some(DateOrder::YearMonthDay)).is_some() {
                        format!(" or {}", self.wording.option("dates", "ymd"))
                    } else {
                        String::new()
                    },
                    if self.zone.is_none() {
                        format!(
                            ", and the zone, e.g. {}",
                            self.wording.option("zone", "UTC")
                        )
                    } else {
                        String::new()
                    }
                ),
            ),
            _ => wrong(
                "is not a known time format",
                format!(
                    "write stamps as 2015-08-13T00:10:00Z or 2015-08-13 00:10, or numbers in a column such as \
                        `time_s`; a column is selected by {}{OR_SKIP}",
                    self.wording.option("time", "NAME")
                ),
            ),
        }
    }

    fn since_first(&mut self, instant: Timestamp) -> f64 {
        if let Some(previous) = self.previous.replace(instant) {
            self.up += u64::from(instant > previous);
            self.down += u64::from(instant < previous);
        }
        let since = instant.duration_since(*self.first.get_or_insert(instant));
        since.as_secs() as f64 + f64::from(since.subsec_nanos()) / 1e9
    }

    /// The instant of a stamp, and whether it is in an hour that occurs twice.
    fn instant(&self, stamp: &Stamp) -> Result<(Timestamp, bool), ProblemAndRemedy> {
        let (instant, is_fold) = match (stamp.offset, &self.zone) {
            (Some(offset), _) => (offset.to_timestamp(stamp.local).map_err(beyond)?, false),
            (None, Some(zone)) => in_zone(stamp.local, zone, self.previous, self.wording)?,
            (None, None) => {
                return wrong(
                    format!("is the date {} without a zone", stamp.local),
                    zone_remedy(self.wording),
                );
            }
        };
        Ok((instant.checked_add(stamp.later).map_err(beyond)?, is_fold))
    }
}

/// What the cells of a column contain, inferred from the first.
fn kind(
    column: &str,
    unit: Option<InputUnit>,
    layout: &Layout,
    first: &str,
) -> Result<Kind, ProblemAndRemedy> {
    let Some(number) = number(first) else {
        return Ok(Kind::Stamps);
    };
    let compact = stamp::compact(first);
    if let Some(unit) = unit {
        if let Some(stamp) = compact.filter(|_| first.len() > 8 && unit.of(1.0) >= 1.0) {
            let problem = format!(
                "looks like the date {}, but the name of its column gives a unit of time",
                stamp.local
            );
            return wrong(
                problem,
                format!(
                    "take the unit out of the name, e.g. `{}`",
                    without_unit(column)
                ),
            );
        }
        if layout.zone.is_some() {
            return wrong(
                "is a plain number, but a time zone applies only to dates",
                "remove the zone",
            );
        }
        return Ok(Kind::Numbers { unit: Some(unit) });
    }
    if compact.is_some() {
        return Ok(Kind::Stamps);
    }
    if let Some(per_second) = per_second_since_epoch(number) {
        return Ok(Kind::Epoch(per_second));
    }
    let count =
        stamp::day_count(number).and_then(|(name, days)| Some((name, days, stamp::day(days)?)));
    match (layout.zone.is_some(), count) {
        (true, Some((name, ..))) => Ok(Kind::Days(name)),
        (true, None) => wrong(
            "is a plain number, but a time zone applies only to dates",
            format!(
                "remove the zone, or choose a column of dates, e.g. {}",
                layout.wording.option("time", "Date")
            ),
        ),
        (false, Some((name, days, stamp))) if LIKELY_DAYS.contains(&days) => wrong(
            format!("may be {name}, {}, or a plain number", stamp.local),
            format!(
                "for a date, give its time zone: {}; for a number, add the unit to the name of the column, \
                    e.g. `{column}_s`",
                layout.wording.option("zone", "UTC")
            ),
        ),
        _ => Ok(Kind::Numbers { unit: None }),
    }
}

fn without_unit(column: &str) -> &str {
    column
        .split(['_', '[', '(', ' '])
        .next()
        .filter(|name| !name.is_empty())
        .unwrap_or("time")
}

/// What to do about dates without a zone.
fn zone_remedy(wording: Wording) -> String {
    let [utc, paris] = ["UTC", "Europe/Paris"].map(|zone| wording.option("zone", zone));
    let alone = match wording {
        Wording::TemperatureFlag => {
            "; if the other file has another zone, `--temperature-zone` for this one"
        }
        _ => "",
    };
    format!("give the time zone of the clock: {utc}, {paris} or an offset such as +01:00{alone}")
}

/// The zone that the name of a column gives: an offset, or an abbreviation as in `Time (CET)`.
fn zone_in(column: &str) -> Option<TimeZone> {
    let words = column.split(|c: char| !c.is_alphanumeric());
    let mut zones = words.filter_map(stamp::abbreviated);
    let only = zones.next().filter(|_| zones.next().is_none());
    offset_in(column).or_else(|| only.map(TimeZone::fixed))
}

/// The offset that the name of a column gives: `Date Time, GMT-05:00`, `Date Time, GMT -0700`, `Time
/// (UTC)`, `time_utc`.
fn offset_in(column: &str) -> Option<TimeZone> {
    let upper = column.to_uppercase();
    let at = ["UTC", "GMT"]
        .iter()
        .filter_map(|name| upper.rfind(name))
        .max()?;
    let (name, behind) = upper[at..].split_at(3);
    let behind = if behind.trim_start().starts_with(['+', '-', '\u{2212}']) {
        behind.trim_start()
    } else {
        behind
    };
    let is_part = |c: &char| c.is_ascii_alphanumeric() || "+-:\u{2212}".contains(*c);
    let text: String = name
        .chars()
        .chain(behind.chars().take_while(is_part))
        .collect();
    stamp::offset(text.trim_end_matches([':', '-', '+'])).map(TimeZone::fixed)
}

fn number(cell: &str) -> Option<f64> {
    if cell.contains(',') {
        cell.replacen(',', ".", 1).parse().ok()
    } else {
        cell.parse().ok()
    }
}

fn beyond(_: jiff::Error) -> ProblemAndRemedy {
    ("is outside the calendar".into(), "correct the line".into())
}

/// The instant of a local time. A time that the clocks skipped is an error. A time that occurred
/// twice is taken as the first of its two instants that is later than the row before.
fn in_zone(
    local: DateTime,
    zone: &TimeZone,
    previous: Option<Timestamp>,
    wording: Wording,
) -> Result<(Timestamp, bool), ProblemAndRemedy> {
    let found = zone.to_ambiguous_timestamp(local);
    let fixed = || wording.option("zone", "+01:00");
    match found.offset() {
        AmbiguousOffset::Unambiguous { .. } => found
            .unambiguous()
            .map(|stamp| (stamp, false))
            .map_err(beyond),
        AmbiguousOffset::Gap { .. } => wrong(
            "does not exist in this zone: the clocks skipped that hour",
            format!(
                "if the logger keeps one time all year, give its zone, e.g. {}",
                fixed()
            ),
        ),
        AmbiguousOffset::Fold { .. } => {
            let both = [
                found.earlier().map_err(beyond)?,
                found.later().map_err(beyond)?,
            ];
            match both
                .into_iter()
                .find(|stamp| previous.is_none_or(|previous| *stamp > previous))
            {
                Some(stamp) => Ok((stamp, true)),
                None => wrong(
                    "occurred twice in this zone when the clocks were set back, and both times are before the \
                        row above",
                    format!(
                        "sort the rows, write stamps with their offset, or give the zone that the logger \
                            keeps all year, e.g. {}",
                        fixed()
                    ),
                ),
            }
        }
    }
}
