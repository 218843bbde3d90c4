//! A time axis with dates, if the dates of a record are known.

use jiff::Span;
use jiff::civil::Date;
use stickslip_data::Start;
use stickslip_figure::{Axis, Label};

/// The maximum number of dates on an axis.
const MOST: f64 = 5.0;

/// An axis over these days since the start of a record.
pub fn time(days: [f64; 2], start: Option<Start>) -> Axis {
    let dates = start.map_or_else(Vec::new, |start| dates(days, start));
    match dates.len() {
        0 | 1 => Axis::linear(days, "time *t*", "d"),
        _ => Axis::named(
            days,
            dates
                .into_iter()
                .map(|(day, date)| (day, Label::verbatim(&date)))
                .collect(),
        ),
    }
}

/// Dates at about equal distances, each with its day since the start.
fn dates(days: [f64; 2], start: Start) -> Vec<(f64, String)> {
    let (first, time) = start.date();
    let length = days[1] - days[0];
    let long = [1, 2, 3, 6, 12, 24, 60, 120]
        .into_iter()
        .find(|months| length / (30.4 * f64::from(*months)) <= MOST);
    let short = [1, 2, 5, 10]
        .into_iter()
        .find(|step| length / f64::from(*step) <= MOST);
    let step = match short {
        Some(step) => Span::new().days(step),
        None => Span::new().months(long.unwrap_or(240)),
    };
    let of = |date: Date| (date - first).get_days();
    let begin = Date::new(first.year(), 1, 1).unwrap_or(first);
    let all = std::iter::successors(Some(begin), |date| date.checked_add(step).ok());
    let placed = all.map(|date| (f64::from(of(date)) - time, date));
    let shown = placed
        .skip_while(|(day, _)| *day < days[0])
        .take_while(|(day, _)| *day <= days[1]);
    let name = |date: Date| match short {
        Some(_) => date.to_string(),
        None => date.strftime("%Y-%m").to_string(),
    };
    shown.map(|(day, date)| (day, name(date))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(days: [f64; 2], start: &str) -> Vec<String> {
        let dates = dates(days, Start::parse(start).expect("a stamp"));
        dates
            .into_iter()
            .map(|(day, date)| format!("{day} {date}"))
            .collect()
    }

    /// A day of the year has its number less one, and what the start is later than midnight.
    #[test]
    fn dates_stand_where_they_are() {
        assert_eq!(
            shown([0.0, 366.0], "2023-11-15T12:00:00Z"),
            [
                "46.5 2024-01",
                "137.5 2024-04",
                "228.5 2024-07",
                "320.5 2024-10"
            ]
        );
        let days = [
            "31 2024-03-03",
            "33 2024-03-05",
            "35 2024-03-07",
            "37 2024-03-09",
            "39 2024-03-11",
        ];
        assert_eq!(shown([30.0, 40.0], "2024-02-01T00:00:00Z"), days);
        assert!(shown([0.0, 0.5], "2024-02-01T01:00:00Z").is_empty());
    }
}
