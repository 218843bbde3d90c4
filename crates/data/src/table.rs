//! The rows of a file in order of time, checked and repaired.

use super::clock::{Clock, Start};
use super::column::{Column, DataColumn, NOT_REPAIRED, SampleSource, sorted};
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
    let mut reading = TableReading::new(file, header, &mut rows, layout, wanted)?;
    rows.rewind();
    while rows.next()? {
        reading.take(&rows)?;
    }
    reading.finished(&rows)
}

/// A table while its rows are read.
struct TableReading<'a> {
    file: &'a str,
    header: &'a Header,
    layout: &'a Layout,
    time_name: String,
    columns: Vec<Column<'a>>,
    marks: Marks,
    /// The order of day, month and year that the dates tell, with the reason.
    told: Option<(DateOrder, &'static str)>,
    decimals: Decimals,
    /// The error of the first cell that may have either separator of thousands.
    undecided: Option<DataError>,
    /// None above the first row with a time.
    clock: Option<Clock>,
    /// The unit of the times in the rows of units.
    unit_below: Option<String>,
    /// Another column that has a time of day in the first row.
    time_elsewhere: Option<usize>,
    rows: u64,
    unit_rows: u64,
}

impl<'a> TableReading<'a> {
    fn new(
        file: &'a str,
        header: &'a Header,
        rows: &mut CsvRows<'_>,
        layout: &'a Layout,
        wanted: &'a [Wanted<'a>],
    ) -> Result<Self, DataError> {
        let names = &header.names;
        let time_names: Vec<&str> = header
            .times
            .iter()
            .map(|field| names[*field].as_str())
            .collect();
        let columns = wanted
            .iter()
            .zip(&header.values)
            .map(|(wanted, field)| Column::of(&names[*field], wanted))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|(problem, remedy)| DataError::file(file, problem, remedy))?;
        let told = if layout.dates.is_none() {
            told_order(rows, header)?
        } else {
            None
        };
        Ok(TableReading {
            file,
            header,
            layout,
            time_name: time_names.join(","),
            columns,
            marks: Marks::of(layout),
            told,
            decimals: Decimals::of(layout, rows.commas_are_decimal()),
            undecided: None,
            clock: None,
            unit_below: None,
            time_elsewhere: None,
            rows: 0,
            unit_rows: 0,
        })
    }

    /// Take the current row.
    fn take(&mut self, rows: &CsvRows<'_>) -> Result<(), DataError> {
        let cell = time_cell(rows, self.header);
        if self.clock.is_none()
            && self.unit_rows < MOST_UNIT_ROWS
            && is_row_of_units(rows, self.header, &cell)
        {
            return self.take_units(rows, &cell);
        }
        if cell.is_empty() {
            if (0..self.header.names.len()).all(|field| rows.cell(field).is_empty()) {
                return Ok(());
            }
            let wrong = (
                "has no time".into(),
                "give the row a time, or remove it".into(),
            );
            return Err(self
                .header
                .wrong(self.file, rows, self.header.times[0], wrong));
        }
        self.rows += 1;
        if self.rows > MAX_ROWS {
            let problem = format!("it has more than {MAX_ROWS} rows");
            let remedy = "split it, or keep fewer rows";
            return Err(DataError::file(self.file, problem, remedy));
        }
        let when = self.time(rows, &cell)?;
        self.take_values(rows, when)
    }

    fn take_units(&mut self, rows: &CsvRows<'_>, time: &str) -> Result<(), DataError> {
        self.unit_rows += 1;
        if self.unit_below.is_none() && unit::time(time).is_some() {
            self.unit_below = Some(time.to_string());
        }
        for (column, field) in self.columns.iter_mut().zip(&self.header.values) {
            column
                .take_unit(&String::from_utf8_lossy(rows.cell(*field)))
                .map_err(|wrong| self.header.wrong(self.file, rows, *field, wrong))?;
        }
        Ok(())
    }

    /// The time of a row. The first one decides on the clock and the units.
    fn time(&mut self, rows: &CsvRows<'_>, cell: &str) -> Result<f64, DataError> {
        let TableReading {
            file,
            header,
            layout,
            ..
        } = *self;
        let mut errors = Vec::new();
        if self.clock.is_none() {
            let settled = self
                .columns
                .iter_mut()
                .filter_map(|column| column.settle_unit(layout.wording).err());
            errors.extend(settled.map(|(problem, remedy)| DataError::file(file, problem, remedy)));
            let elsewhere = |field: &usize| {
                !header.times.contains(field)
                    && is_time_of_day(&String::from_utf8_lossy(rows.cell(*field)))
            };
            self.time_elsewhere = (0..header.names.len())
                .find(elsewhere)
                .filter(|_| !cell.contains(':'));
        }
        let order = layout.dates.or(self.told.map(|(order, _)| order));
        let unit = self.unit_below.as_deref();
        let known = match &mut self.clock {
            Some(clock) => Ok(clock),
            none => {
                Clock::new(&self.time_name, unit, layout, order, cell).map(|new| none.insert(new))
            }
        };
        let when = known
            .and_then(|clock| clock.read(cell))
            .map_err(|wrong| errors.push(header.wrong(file, rows, header.times[0], wrong)))
            .unwrap_or_default();
        DataError::of_all(errors).map_or(Ok(when), Err)
    }

    fn take_values(&mut self, rows: &CsvRows<'_>, when: f64) -> Result<(), DataError> {
        let wording = self.layout.wording;
        for (column, field) in self.columns.iter_mut().zip(&self.header.values) {
            let cell = rows.cell(*field);
            let is_strict = column.is_strict();
            let wrong = |(problem, remedy): (&str, &str)| {
                let mark = wording.option("missing", &quoted(cell));
                let decimal = wording.option("decimal", ",");
                let remedy = if is_strict && remedy.contains("MARK") {
                    NOT_REPAIRED
                } else {
                    remedy
                };
                let remedy = remedy.replace("MARK", &mark).replace("DECIMAL", &decimal);
                self.header
                    .wrong(self.file, rows, *field, (problem.into(), remedy))
            };
            if self.marks.is_word(cell) {
                column.miss().map_err(wrong)?;
                continue;
            }
            let value = self.decimals.number(cell).map_err(wrong)?;
            if self.undecided.is_none() && !self.decimals.are_known() {
                self.undecided = Some(wrong(THOUSANDS));
            }
            column
                .take(when, value, rows.place(), &self.marks)
                .map_err(wrong)?;
        }
        Ok(())
    }

    /// The table, once all rows are taken.
    fn finished(mut self, rows: &CsvRows<'_>) -> Result<Table, DataError> {
        let file = self.file;
        let Some(clock) = self.clock.take() else {
            let problem = "it has a header but no rows";
            return Err(DataError::file(
                file,
                problem,
                "give a file with measurements",
            ));
        };
        if let Some(error) = self.undecided.take().filter(|_| !self.decimals.are_known()) {
            return Err(error);
        }
        if clock.is_disordered() {
            let problem = "two of five rows are out of order";
            let remedy = format!(
                "check whether its dates are {}, and sort its rows",
                self.layout.wording.option("dates", "ymd, dmy or mdy")
            );
            return Err(DataError::file(file, problem, remedy));
        }
        let mut repairs = self.repairs(&clock);
        let source = SampleSource {
            file,
            layout: self.layout,
            twice: &self.remedy_for_two_values(),
            line: &|place| rows.line(place),
            in_seconds: clock.in_seconds(),
        };
        let mut begin = f64::INFINITY;
        for column in &mut self.columns {
            sorted(column, &mut repairs, &source)?;
            begin = begin.min(column.samples[0].0);
        }
        Ok(Table {
            start: clock.first().and_then(|first| first.after(begin)),
            begin: clock.begin(),
            in_seconds: clock.in_seconds(),
            rows: self.rows,
            time: self.time_name,
            columns: self
                .columns
                .into_iter()
                .map(|column| column.finished(begin))
                .collect(),
            repairs,
        })
    }

    /// What was repaired in the rows, without their order and single columns.
    fn repairs(&self, clock: &Clock) -> Repairs {
        Repairs {
            skipped: self.header.skipped,
            unit_rows: self.unit_rows,
            folds: clock.folds,
            decimal_commas: self.decimals.commas(),
            order: self
                .told
                .map(|(order, why)| format!("{}, {why}", order.word())),
            zone: clock.other_zone.clone(),
            ..Repairs::default()
        }
    }

    /// What to do about two values at one time.
    fn remedy_for_two_values(&self) -> String {
        let wording = self.layout.wording;
        if let Some(field) = self.time_elsewhere {
            let name = &self.header.names[field];
            let both = wording.option("time", &format!("{},{name}", self.time_name));
            format!("if the time of day is in `{name}`, name both columns: {both}")
        } else {
            let zone = wording.option("zone", "Europe/Paris");
            format!(
                "keep the right one of the two; if the clock was set back, give its zone, e.g. {zone}, or \
                    write stamps with offsets"
            )
        }
    }
}

impl Header {
    /// The error of a cell of the current row.
    fn wrong(
        &self,
        file: &str,
        rows: &CsvRows<'_>,
        field: usize,
        (problem, remedy): ProblemAndRemedy,
    ) -> DataError {
        DataError::file(file, problem, remedy)
            .line(rows.line(rows.place()))
            .cell(&self.names[field], rows.cell(field))
    }
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
