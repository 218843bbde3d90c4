//! A time in several columns, such as a date and an hour, or a year, a month, a day and an hour, as
//! one stamp.

use super::error::ProblemAndRemedy;
use super::rows::OR_SKIP;
use super::stamp::whole_year;
use jiff::Span;
use jiff::civil::Date;
use std::borrow::Cow;

/// What one of several columns of a time contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Year,
    Month,
    Day,
    DayOfYear,
    Hour,
    /// As in 1330.
    HourMinute,
    Minute,
    Second,
    /// A date, a time of day or an hour, depending on its cells.
    Text,
}

/// Names of such columns, in lower case.
const NAMES: [(Part, &[&str]); 8] = [
    (Part::Year, &["year", "yr", "yyyy", "yy", "jahr"]),
    (Part::Month, &["month", "mon", "mo", "mm", "monat"]),
    (Part::Day, &["day", "dy", "dd", "tag"]),
    (
        Part::DayOfYear,
        &[
            "doy",
            "day of year",
            "day_of_year",
            "dayofyear",
            "jday",
            "julian day",
        ],
    ),
    (Part::Hour, &["hour", "hours", "hr", "hh", "h", "stunde"]),
    (Part::HourMinute, &["hhmm", "hour_min"]),
    (Part::Minute, &["minute", "minutes", "min", "mi", "mn"]),
    (Part::Second, &["second", "seconds", "sec", "ss", "s"]),
];

/// The columns of a time, in order.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    parts: Vec<Part>,
    /// Whether a number in a column without a known name is an hour, rather than a time as in 1330.
    in_hours: bool,
}

impl Parts {
    /// The parts, inferred from the names of the columns.
    pub fn of(names: &[&str]) -> Self {
        let mut parts: Vec<Part> = Vec::new();
        for name in names {
            let lower = name.trim().to_lowercase();
            let named = |(_, words): &&(Part, &[&str])| words.contains(&&*lower);
            let part = NAMES
                .iter()
                .find(named)
                .map_or(Part::Text, |(part, _)| *part);
            // Files of buoys call minutes mm, after hours.
            let is_minute = part == Part::Month && parts.contains(&Part::Hour);
            parts.push(if is_minute { Part::Minute } else { part });
        }
        let has = |part| parts.contains(&part);
        if has(Part::Year) && !has(Part::Month) {
            let days = parts.iter_mut().filter(|part| **part == Part::Day);
            days.for_each(|day| *day = Part::DayOfYear);
        }
        Parts {
            parts,
            in_hours: true,
        }
    }

    /// The columns of a year, a month and a day or a day of the year, and of a time of day, if they
    /// have usual names.
    pub fn usual(names: &[String]) -> Option<Vec<usize>> {
        let named = |wanted: Part| {
            let (_, words) = NAMES.iter().find(|(part, _)| *part == wanted)?;
            names
                .iter()
                .position(|name| words.contains(&&*name.to_lowercase()))
        };
        let year = named(Part::Year)?;
        let day = match (named(Part::Month), named(Part::Day), named(Part::DayOfYear)) {
            (_, _, Some(day)) => vec![day],
            (Some(month), Some(day), None) => vec![month, day],
            _ => return None,
        };
        let time = || {
            names
                .iter()
                .position(|name| name.eq_ignore_ascii_case("time"))
        };
        let hour = named(Part::Hour)
            .or_else(|| named(Part::HourMinute))
            .or_else(time);
        let rest = [Part::Minute, Part::Second].into_iter().filter_map(named);
        let rest = rest.filter(|_| hour.is_some());
        Some(
            [year]
                .into_iter()
                .chain(day)
                .chain(hour)
                .chain(rest)
                .collect(),
        )
    }

    /// Whether this is the name of a part of a time, in lower case.
    pub fn is_part(name: &str) -> bool {
        NAMES.iter().any(|(_, words)| words.contains(&name))
    }

    /// Whether this is the name of a column of hours.
    pub fn is_hour(name: &str) -> bool {
        let lower = name.trim().to_lowercase();
        let is_hour = |(part, _): &&(Part, _)| matches!(part, Part::Hour | Part::HourMinute);
        NAMES
            .iter()
            .filter(is_hour)
            .any(|(_, words)| words.contains(&&*lower))
    }

    /// Inspect a row before rows are read: a number that is not an hour shows that times of day are
    /// written as in 1330.
    pub fn look(&mut self, cells: &[Cow<'_, str>]) {
        for (part, cell) in self.parts.iter().zip(cells) {
            let number = cell.parse::<f64>().ok().filter(|_| *part == Part::Text);
            self.in_hours &= number.is_none_or(|number| !(25.0..2400.5).contains(&number));
        }
    }

    /// The stamp in the cells of a row, as ISO 8601 writes it if the cells are numbers. Cells that
    /// do not fit together are joined unchanged.
    pub fn stamp(&self, cells: &[Cow<'_, str>]) -> String {
        let joined = || cells.join(" ").trim().to_string();
        self.calendar(cells).unwrap_or_else(joined)
    }

    /// Whether the cells of a row fit together.
    pub fn is_stamp(&self, cells: &[Cow<'_, str>]) -> bool {
        self.calendar(cells).is_some()
    }

    fn calendar(&self, cells: &[Cow<'_, str>]) -> Option<String> {
        let parts = self.told(cells);
        let (mut date, mut time) = (String::new(), String::new());
        let mut year = None;
        let mut seconds = None;
        for (part, cell) in parts.iter().zip(cells) {
            let number = || cell.parse::<f64>().ok().filter(|number| *number >= 0.0);
            let mut add = |more: f64| seconds = Some(seconds.unwrap_or(0.0) + more);
            match part {
                Part::Text if date.is_empty() => date = cell.to_string(),
                Part::Text => time = format!("{time} {cell}"),
                Part::Year => {
                    let number: i16 = cell.parse().ok()?;
                    year = Some(if number < 100 {
                        whole_year(number)
                    } else {
                        number
                    });
                    date = format!("{:04}", year?);
                }
                Part::Month | Part::Day => date = format!("{date}-{:02}", number()? as u8),
                Part::DayOfYear => {
                    let begin = Date::new(year?, 1, 1).ok()?;
                    let day = number()
                        .filter(|day| (1.0..f64::from(begin.days_in_year()) + 1.0).contains(day))?;
                    let later = Span::new().days(day as i64 - 1);
                    date = begin.checked_add(later).ok()?.to_string();
                    if day.fract() > 0.0 {
                        add(86_400.0 * day.fract());
                    }
                }
                Part::Hour => add(3600.0 * number().filter(|hours| *hours <= 24.0)?),
                Part::HourMinute => {
                    let time = number()?;
                    add(3600.0 * (time / 100.0).floor() + 60.0 * (time % 100.0));
                }
                Part::Minute => add(60.0 * number()?),
                Part::Second => add(number()?),
            }
        }
        let milliseconds = (1e3 * seconds.unwrap_or(0.0)).round() as u64;
        let (minutes, rest) = (milliseconds / 60_000, milliseconds % 60_000);
        Some(match seconds {
            None => format!("{date}{time}").trim().to_string(),
            Some(_) => format!(
                "{date} {:02}:{:02}:{:02}.{:03}",
                minutes / 60,
                minutes % 60,
                rest / 1000,
                rest % 1000
            ),
        })
    }

    /// The parts. Columns without known names are identified by their places and cells.
    fn told(&self, cells: &[Cow<'_, str>]) -> Vec<Part> {
        let mut parts = self.parts.clone();
        let is_year = |cell: &str| cell.len() == 4 && cell.parse::<u16>().is_ok();
        if parts[0] == Part::Text && is_year(&cells[0]) && parts.len() > 1 {
            let days: &[Part] = match parts.len() {
                2 | 3 => &[Part::Year, Part::DayOfYear],
                _ => &[Part::Year, Part::Month, Part::Day],
            };
            let rest = [Part::Text, Part::Minute, Part::Second];
            parts = days
                .iter()
                .chain(&rest)
                .take(parts.len())
                .copied()
                .collect();
        }
        // 13.30 is half past one, as with a colon.
        let is_time = |cell: &str| {
            cell.split_once('.')
                .is_some_and(|(_, minutes)| minutes.len() == 2)
        };
        for (part, cell) in parts.iter_mut().zip(cells).skip(1) {
            if *part == Part::Text && cell.parse::<f64>().is_ok() && !is_time(cell) {
                *part = match self.in_hours {
                    true => Part::Hour,
                    false => Part::HourMinute,
                };
            }
        }
        parts
    }
}

/// What is wrong with cells that do not fit together.
pub(super) fn no_stamp() -> ProblemAndRemedy {
    let remedy = format!(
        "correct the line, or rename the columns by what they hold: year, month, day, doy, hour, hhmm, minute, \
            second{OR_SKIP}"
    );
    ("is not a date and a time".into(), remedy)
}
