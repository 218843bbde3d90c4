//! The order of day, month and year, inferred from all dates of a column.

use super::query::DateOrder;
use super::stamp::stamp;
use jiff::civil::{Date, DateTime};

/// How the dates of a column look in one order.
#[derive(Clone, Copy, Debug)]
struct OrderFit {
    order: DateOrder,
    /// Whether each of them is a date.
    is_possible: bool,
    last: Option<DateTime>,
    /// Number of dates that are later than the one before, and of those that are earlier.
    up: u64,
    down: u64,
    /// The seconds from each date to the next, without their signs.
    path: f64,
}

/// The dates of a column in every order.
#[derive(Clone, Debug)]
pub(super) struct Orders {
    readings: [OrderFit; 3],
    /// Whether two orders make different dates of the same text.
    differ: bool,
}

/// An order that makes the path from date to date longer than another one by this factor is wrong.
const DETOUR: f64 = 10.0;

impl Orders {
    /// The orders before the first date.
    pub fn new() -> Self {
        let of = |(_, order)| OrderFit {
            order,
            is_possible: true,
            last: None,
            up: 0,
            down: 0,
            path: 0.0,
        };
        Orders {
            readings: DateOrder::WORDS.map(of),
            differ: false,
        }
    }

    /// Take the next text of the column. A text that is not a date in any order is ignored.
    pub fn take(&mut self, text: &str) {
        let dates = self
            .readings
            .map(|reading| stamp(text, Some(reading.order)).map(|stamp| stamp.local));
        if dates.iter().all(Option::is_none) {
            return;
        }
        for (reading, date) in self.readings.iter_mut().zip(dates) {
            reading.is_possible &= date.is_some();
            if let (Some(last), Some(date)) = (reading.last, date) {
                reading.up += u64::from(date > last);
                reading.down += u64::from(date < last);
                reading.path += date.duration_since(last).as_secs_f64().abs();
            }
            reading.last = date;
        }
        let mut possible = self
            .readings
            .iter()
            .filter(|reading| reading.is_possible)
            .map(|reading| reading.last);
        let first = possible.next();
        self.differ |= possible.any(|date| Some(date) != first);
    }

    /// Whether all dates are dates in this order.
    pub fn is_possible(&self, order: DateOrder) -> bool {
        let mut possible = self.readings.iter().filter(|reading| reading.is_possible);
        possible.any(|reading| reading.order == order)
    }

    /// The order, and the reason for it; `None` if several are equally likely. Of several possible
    /// orders it is the one with the fewest rows out of order. If years have two digits and may be
    /// first or last, the path from row to row is also far longer in one of the two orders.
    pub fn told(&self) -> Option<(DateOrder, &'static str)> {
        let possible: Vec<&OrderFit> = self
            .readings
            .iter()
            .filter(|reading| reading.is_possible)
            .collect();
        if let [only] = possible[..] {
            return Some((only.order, "the only order in which all are valid dates"));
        }
        let disorder = |reading: &OrderFit| reading.up.min(reading.down);
        let least = possible.iter().map(|reading| disorder(reading)).min()?;
        let mut likely: Vec<&OrderFit> = possible
            .into_iter()
            .filter(|reading| disorder(reading) == least)
            .collect();
        if likely
            .iter()
            .any(|reading| reading.order == DateOrder::YearMonthDay)
        {
            let shortest = likely
                .iter()
                .map(|reading| reading.path)
                .fold(f64::INFINITY, f64::min);
            likely.retain(|reading| reading.path < DETOUR * shortest || reading.path == shortest);
        }
        match likely[..] {
            [one] => Some((one.order, "the order in which the rows are sorted by time")),
            [one, ..] if !self.differ => Some((one.order, "where the order does not matter")),
            _ => None,
        }
    }
}

/// How dates follow each other.
#[derive(Clone, Copy, Default)]
struct Path {
    /// Number of dates that are earlier than the one before, and the days from each to the next.
    down: u64,
    days: i64,
}

impl Path {
    fn of(dates: impl Iterator<Item = Date>) -> Path {
        let mut path = Path::default();
        let mut last = None;
        for date in dates {
            if let Some(last) = last.replace(date) {
                let days = i64::from((date - last).get_days());
                path.down += u64::from(days < 0);
                path.days += days.abs();
            }
        }
        path
    }
}

/// Whether a spreadsheet has exchanged day and month where the day is at most 12, so that exchanging
/// them back puts the dates in order.
pub(super) fn are_exchanged(dates: &[Date]) -> bool {
    let back = |date: &Date| Date::new(date.year(), date.day(), date.month()).unwrap_or(*date);
    let found = Path::of(dates.iter().copied());
    let exchanged = Path::of(dates.iter().map(back));
    10 * exchanged.down <= found.down && exchanged.days < found.days && found.down > 0
}
