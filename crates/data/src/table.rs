//! The rows of a file in order of time, checked and repaired.

use super::clock::{Clock, Start};
use super::column::{Column, DataColumn, NOT_REPAIRED, sorted};
use super::decimals::{Decimals, THOUSANDS};
use super::error::{DataError, ProblemAndRemedy, quoted};
use super::header::Header;
use super::marks::Marks;
use super::orders::Orders;
use super::query::{DateOrder, Layout, Wanted};
use super::repairs::Repairs;
use super::rows::CsvRows;
use super::stamp::{is_time_of_day, needs_order};
use super::unit;
use std::borrow::Cow;

/// The columns that were wanted, as read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The instant of time 0, if the file has stamps.
    pub start: Option<Start>,
    /// The number that the column of times has in its first row; 0 for stamps.
    pub begin: f64,
    /// Whether times are in seconds. If not, they are numbers in a column whose name gives no unit.
    pub in_seconds: bool,
    /// Number of rows read, including repeated ones and those without a value.
    pub rows: u64,
    /// The name of the column of times; for dates and times of day in two columns, both with a
    /// comma between them.
    pub time: String,
    /// The columns, in the order in which they were wanted.
    pub columns: Vec<DataColumn>,
    /// What was repaired.
    pub repairs: Repairs,
}

/// Largest number of rows. With it and the largest file, reading takes at most 2 GB of memory. A
/// century with a row every ten minutes has 5 10^6 rows.
const MAX_ROWS: u64 = 20_000_000;

/// Most rows below the names of the columns that hold units, kinds of means and the like.
const MOST_UNIT_ROWS: u64 = 3;

/// Read the columns that are wanted. `file` is the name of the file.
pub(super) fn table(
    file: &str,
    header: &Header,
    mut rows: CsvRows<'_>,
    layout: &Layout,
    wanted: &[Wanted<'_>],
) -> Result<Table, DataError> {
    let names = &header.names;
    let time_name = header
        .times
        .iter()
        .map(|field| names[*field].as_str())
        .collect::<Vec<_>>()
        .join(",");
    let columns = wanted
        .iter()
        .zip(&header.values)
        .map(|(wanted, field)| Column::of(&names[*field], wanted));
    let mut columns = columns
        .collect::<Result<Vec<_>, _>>()
        .map_err(|(problem, remedy)| DataError::file(file, problem, remedy))?;
    let marks = Marks::of(layout);
    let told = if layout.dates.is_none() {
        told_order(&mut rows, header)?
    } else {
        None
    };
    rows.rewind();
    let order = layout.dates.or(told.map(|(order, _)| order));
    let mut decimals = Decimals::of(layout, rows.commas_are_decimal());
    let mut undecided = None;
    let mut clock: Option<Clock> = None;
    let mut unit_below = None;
    let mut time_elsewhere = None;
    let (mut count, mut unit_rows) = (0, 0);
    while rows.next()? {
        let at = |field: usize, (problem, remedy): ProblemAndRemedy| {
            let error = DataError::file(file, problem, remedy).line(rows.line(rows.place()));
            error.cell(&names[field], rows.cell(field))
        };
        let cell = time_cell(&rows, header);
        if clock.is_none() && unit_rows < MOST_UNIT_ROWS && is_row_of_units(&rows, header, &cell) {
            unit_rows += 1;
            unit_below = unit_below
                .or_else(|| Some(cell.to_string()).filter(|cell| unit::time(cell).is_some()));
            for (column, field) in columns.iter_mut().zip(&header.values) {
                column
                    .take_unit(&String::from_utf8_lossy(rows.cell(*field)))
                    .map_err(|wrong| at(*field, wrong))?;
            }
            continue;
        }
        if cell.is_empty() {
            if (0..names.len()).all(|field| rows.cell(field).is_empty()) {
                continue;
            }
            return Err(at(
                header.times[0],
                (
                    "has no time".into(),
                    "give the row a time, or remove it".into(),
                ),
            ));
        }
        count += 1;
        if count > MAX_ROWS {
            let problem = format!("it has more than {MAX_ROWS} rows");
            return Err(DataError::file(
                file,
                problem,
                "split it, or keep fewer rows",
            ));
        }
        let mut errors = Vec::new();
        if clock.is_none() {
            let settled = columns
                .iter_mut()
                .filter_map(|column| column.settle_unit(layout.wording).err());
            errors.extend(settled.map(|(problem, remedy)| DataError::file(file, problem, remedy)));
            let elsewhere = |field: &usize| {
                !header.times.contains(field)
                    && is_time_of_day(&String::from_utf8_lossy(rows.cell(*field)))
            };
            time_elsewhere = (0..names.len())
                .find(elsewhere)
                .filter(|_| !cell.contains(':'));
        }
        let known = match &mut clock {
            Some(clock) => Ok(clock),
            none => Clock::new(&time_name, unit_below.as_deref(), layout, order, &cell)
                .map(|new| none.insert(new)),
        };
        let when = known.and_then(|clock| clock.read(&cell));
        let when = when
            .map_err(|wrong| errors.push(at(header.times[0], wrong)))
            .unwrap_or_default();
        if let Some(error) = DataError::of_all(errors) {
            return Err(error);
        }
        for (column, field) in columns.iter_mut().zip(&header.values) {
            let cell = rows.cell(*field);
            let is_strict = column.is_strict();
            let wrong = |(problem, remedy): (&str, &str)| {
                let mark = layout.wording.option("missing", &quoted(cell));
                let decimal = layout.wording.option("decimal", ",");
                let remedy = if is_strict && remedy.contains("MARK") {
                    NOT_REPAIRED
                } else {
                    remedy
                };
                at(
                    *field,
                    (
                        problem.into(),
                        remedy.replace("MARK", &mark).replace("DECIMAL", &decimal),
                    ),
                )
            };
            if marks.is_word(cell) {
                column.miss().map_err(wrong)?;
                continue;
            }
            let value = decimals.number(cell).map_err(wrong)?;
            if undecided.is_none() && !decimals.are_known() {
                undecided = Some(wrong(THOUSANDS));
            }
            column
                .take(when, value, rows.place(), &marks)
                .map_err(wrong)?;
        }
    }
    let Some(clock) = clock else {
        return Err(DataError::file(
            file,
            "it has a header but no rows",
            "give a file with measurements",
        ));
    };
    if let Some(error) = undecided.filter(|_| !decimals.are_known()) {
        return Err(error);
    }
    if clock.is_disordered() {
        let problem = "two of five rows are out of order";
        let remedy = format!(
            "check whether its dates are {}, and sort its rows",
            layout.wording.option("dates", "ymd, dmy or mdy")
        );
        return Err(DataError::file(file, problem, remedy));
    }
    let mut repairs = Repairs {
        skipped: header.skipped,
        unit_rows,
        folds: clock.folds,
        decimal_commas: decimals.commas(),
        order: told.map(|(order, why)| format!("{}, {why}", order.word())),
        zone: clock.other_zone.clone(),
        ..Repairs::default()
    };
    let twice = match time_elsewhere {
        Some(field) => {
            let both = layout
                .wording
                .option("time", &format!("{time_name},{}", names[field]));
            format!(
                "if the time of day is in `{}`, name both columns: {both}",
                names[field]
            )
        }
        None => {
            let zone = layout.wording.option("zone", "Europe/Paris");
            format!(
                "keep the right one of the two; if the clock was set back, give its zone, e.g. {zone}, or \
                    write stamps with offsets"
            )
        }
    };
    let mut begin = f64::INFINITY;
    for column in &mut columns {
        sorted(
            column,
            &mut repairs,
            file,
            layout,
            &twice,
            &|place| rows.line(place),
            clock.in_seconds(),
        )?;
        begin = begin.min(column.samples[0].0);
    }
    Ok(Table {
        start: clock.first().and_then(|first| first.after(begin)),
        begin: clock.begin(),
        in_seconds: clock.in_seconds(),
        rows: count,
        time: time_name,
        columns: columns
            .into_iter()
            .map(|column| column.finished(begin))
            .collect(),
        repairs,
    })
}

/// The cell of the times of the current row; of dates and times of day, both with a blank between.
fn time_cell<'r>(rows: &'r CsvRows<'_>, header: &Header) -> Cow<'r, str> {
    let text = |field: usize| String::from_utf8_lossy(rows.cell(field));
    match header.times[..] {
        [field] => text(field),
        _ => Cow::Owned(
            header
                .times
                .iter()
                .map(|field| text(*field))
                .collect::<Vec<_>>()
                .join(" ")
                .trim()
                .to_string(),
        ),
    }
}

/// Whether a row below the names holds units, kinds of means or a format of dates: its time is no
/// time, and no wanted cell is a number.
fn is_row_of_units(rows: &CsvRows<'_>, header: &Header, time: &str) -> bool {
    let is_number = |cell: &[u8]| {
        std::str::from_utf8(cell).is_ok_and(|text| {
            text.replace(',', ".")
                .parse::<f64>()
                .is_ok_and(f64::is_finite)
        })
    };
    let has_word = std::iter::once(time.as_bytes())
        .chain(header.values.iter().map(|field| rows.cell(*field)))
        .any(|cell| !cell.is_empty());
    has_word
        && time.bytes().filter(u8::is_ascii_digit).count() < 2
        && !is_number(time.as_bytes())
        && !header
            .values
            .iter()
            .any(|field| is_number(rows.cell(*field)))
}

/// The order of day, month and year, if the dates need one and tell it, with the reason.
fn told_order(
    rows: &mut CsvRows<'_>,
    header: &Header,
) -> Result<Option<(DateOrder, &'static str)>, DataError> {
    let mut orders = Orders::new();
    let mut looked = 0;
    let mut is_needed = false;
    while rows.next()? {
        let cell = time_cell(rows, header);
        is_needed |= needs_order(&cell);
        looked += 1;
        // Dates that need no order say so at once, below the rows of units.
        if !is_needed && looked > MOST_UNIT_ROWS {
            return Ok(None);
        }
        orders.take(&cell);
    }
    Ok(orders.told().filter(|_| is_needed))
}
