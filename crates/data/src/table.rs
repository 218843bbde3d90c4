//! The rows of a file in order of time, checked and repaired.

use super::clock::{Clock, Start};
use super::column::{Column, DataColumn, NOT_REPAIRED, SampleSource, other_header, sorted};
use super::decimals::{Decimals, THOUSANDS};
use super::error::{DataError, ProblemAndRemedy, quoted};
use super::header::Header;
use super::labels::Labels;
use super::marks::Marks;
use super::orders::Orders;
use super::parts::{self, Parts};
use super::query::{DateOrder, Layout, Wanted};
use super::repairs::Repairs;
use super::rows::{CsvRows, OR_SKIP, TOO_NARROW};
use super::stamp::{is_time_of_day, needs_order};
use super::unit;
use std::borrow::Cow;

/// The columns that were wanted, as read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The instant of t = 0, if the file has stamps.
    pub start: Option<Start>,
    /// The number in the first row of the time column; 0 for stamps.
    pub begin: f64,
    /// Whether times are in seconds. If not, they are numbers in a column whose name gives no unit.
    pub in_seconds: bool,
    /// Number of rows read, including repeated ones and those without a value.
    pub rows: u64,
    /// The name of the column of times; for dates and times of day in two columns, both names,
    /// separated by a comma.
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
    if let Some(line) = rows.too_narrow() {
        let (problem, remedy) = TOO_NARROW;
        return Err(DataError::file(file, problem, remedy)
            .line(line)
            .cell(&reading.time_name, b"###"));
    }
    loop {
        let taken = match rows.next() {
            Ok(false) => return reading.finished(&rows),
            Ok(true) => reading.take(&rows),
            Err(uneven) => Err(uneven),
        };
        if let Err(error) = taken {
            reading.leave_out(error, &mut rows)?;
        }
    }
}

/// What is wrong with the first row of a file, or with its layout as far as that row needs it.
pub(super) fn problem(
    file: &str,
    header: &Header,
    mut rows: CsvRows<'_>,
    layout: &Layout,
    wanted: &[Wanted<'_>],
) -> Option<DataError> {
    let mut reading = TableReading::new(file, header, &mut rows, layout, wanted).ok()?;
    rows.rewind();
    while reading.rows == 0 && rows.next().ok()? {
        if let Err(error) = reading.take(&rows) {
            return Some(error.with_remedy(OR_SKIP, ""));
        }
    }
    None
}

/// Longest cell that is proposed as a mark of a missing value.
const LONGEST_MARK: usize = 20;

/// If more lines than this, and more than one in ten, are bad, the layout is wrong.
const MOST_BAD: u64 = 10;

/// A table being read.
struct TableReading<'a> {
    file: &'a str,
    header: &'a Header,
    layout: &'a Layout,
    time_name: String,
    columns: Vec<Column<'a>>,
    marks: Marks,
    parts: Parts,
    /// The order of day, month and year inferred from the dates, with the reason.
    told: Option<(DateOrder, &'static str)>,
    decimals: Decimals,
    /// The error of the first cell whose comma or point is ambiguous.
    undecided: Option<DataError>,
    /// None before the first row with a time.
    clock: Option<Clock>,
    /// The unit of the times in the rows of units.
    unit_below: Option<String>,
    /// Another column that has a time of day in the first row.
    time_elsewhere: Option<usize>,
    /// The columns that may distinguish several series.
    labels: Labels,
    rows: u64,
    unit_rows: u64,
    /// How many of the next rows may hold units.
    units_left: u64,
    repeated_headers: u64,
    /// Whether the current row is a header or a row of units that cannot be taken.
    is_bad_header: bool,
    /// Number of lines that were left out, with the error of the first.
    bad: Option<(u64, DataError)>,
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
        let column = |(wanted, field): (&'a Wanted<'a>, &usize)| {
            let mut column = Column::of(&names[*field], wanted)?;
            let above = header.units_above.get(*field);
            above.map_or(Ok(()), |unit| column.take_unit(unit))?;
            Ok(column)
        };
        // One that wants every column stands for them all.
        let columns = wanted
            .iter()
            .cycle()
            .zip(&header.values)
            .map(column)
            .collect::<Result<Vec<_>, _>>()
            .map_err(|(problem, remedy)| DataError::file(file, problem, remedy))?;
        let (parts, told) = survey(rows, header, layout);
        Ok(TableReading {
            file,
            header,
            layout,
            time_name: header.time_name(),
            columns,
            marks: Marks::of(layout),
            parts,
            told,
            decimals: Decimals::of(layout, rows.commas_are_decimal()),
            undecided: None,
            clock: None,
            unit_below: None,
            time_elsewhere: None,
            labels: Labels::of(header),
            rows: 0,
            unit_rows: 0,
            units_left: MOST_UNIT_ROWS,
            repeated_headers: 0,
            is_bad_header: false,
            bad: None,
        })
    }

    /// Take the current row.
    fn take(&mut self, rows: &CsvRows<'_>) -> Result<(), DataError> {
        if self.header.is_repeated(rows) {
            return self.take_header(rows);
        }
        let cell = time_cell(rows, self.header, &self.parts);
        if self.units_left > 0 && is_row_of_units(rows, self.header, &cell) {
            self.units_left -= 1;
            return self.take_units(rows, &cell);
        }
        if cell.is_empty() {
            if (0..self.header.names.len()).all(|field| rows.cell(field).is_empty()) {
                return Ok(());
            }
            let remedy = format!("give the line a time, or remove it{OR_SKIP}");
            return Err(wrong_time(
                self.file,
                self.header,
                rows,
                ("has no time".into(), remedy),
            ));
        }
        if self.rows == MAX_ROWS {
            let problem = format!("it has more than {MAX_ROWS} rows");
            let remedy = "split it, or keep fewer rows";
            return Err(DataError::file(self.file, problem, remedy));
        }
        let when = self.time(rows, &cell)?;
        self.take_values(rows, when)?;
        self.labels.take(rows);
        self.units_left = 0;
        self.rows += 1;
        Ok(())
    }

    /// Take a header below the first. Without its units the rows below it would be misread, so it is
    /// never left out as a bad line.
    fn take_header(&mut self, rows: &CsvRows<'_>) -> Result<(), DataError> {
        self.repeated_headers += 1;
        self.units_left = MOST_UNIT_ROWS;
        self.is_bad_header = true;
        let wrong_at = |field, wrong| self.header.wrong(self.file, rows, field, wrong);
        for field in &self.header.times {
            if !self.header.is_named(rows, *field) {
                return Err(wrong_at(*field, other_header()));
            }
        }
        for (column, field) in self.columns.iter_mut().zip(&self.header.values) {
            let name = String::from_utf8_lossy(rows.cell(*field));
            let taken = column.take_name(&name);
            taken.map_err(|wrong| self.header.wrong(self.file, rows, *field, wrong))?;
        }
        self.is_bad_header = false;
        Ok(())
    }

    /// Leave out the current row if bad lines may be left out; otherwise return its error.
    fn leave_out(&mut self, error: DataError, rows: &mut CsvRows<'_>) -> Result<(), DataError> {
        let is_strict = self.columns.iter().any(Column::is_strict);
        let skip = match is_strict {
            true => String::new(),
            false => format!(
                ", or leave out bad lines with {}",
                self.layout.wording.skip_bad()
            ),
        };
        let error = error.with_remedy(OR_SKIP, &skip);
        if is_strict || !self.layout.skip_bad || self.is_bad_header {
            return Err(error);
        }
        let place = rows.place();
        self.columns
            .iter_mut()
            .for_each(|column| column.take_back(place));
        if self.rows == 0 {
            self.clock = None;
        }
        self.bad.get_or_insert((0, error)).0 += 1;
        rows.leave_out_line();
        Ok(())
    }

    fn take_units(&mut self, rows: &CsvRows<'_>, time: &str) -> Result<(), DataError> {
        self.unit_rows += 1;
        self.is_bad_header = true;
        if self.unit_below.is_none() && unit::time(time).is_some() {
            self.unit_below = Some(time.to_string());
        }
        for (column, field) in self.columns.iter_mut().zip(&self.header.values) {
            column
                .take_unit(&String::from_utf8_lossy(rows.cell(*field)))
                .map_err(|wrong| self.header.wrong(self.file, rows, *field, wrong))?;
        }
        self.is_bad_header = false;
        Ok(())
    }

    /// The time of a row. The first one determines the clock and the units.
    fn time(&mut self, rows: &CsvRows<'_>, cell: &str) -> Result<f64, DataError> {
        let TableReading {
            file,
            header,
            layout,
            ..
        } = *self;
        let mut errors = Vec::new();
        if self.clock.is_none() {
            for (column, field) in self.columns.iter_mut().zip(&header.values) {
                let wrong = |wrong| header.wrong(file, rows, *field, wrong);
                column.without_unit(rows.cell(*field)).map_err(wrong)?;
            }
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
        let told = self.told.map(|(order, _)| order);
        let order = match layout.is_of_other_file {
            true => told.or(layout.dates),
            false => layout.dates.or(told),
        };
        let unit = self.unit_below.as_deref();
        let known = match &mut self.clock {
            Some(clock) => Ok(clock),
            none => {
                Clock::new(&self.time_name, unit, layout, order, cell).map(|new| none.insert(new))
            }
        };
        let when = known
            .and_then(|clock| clock.read(cell))
            .map_err(|wrong| {
                let wrong = match self.parts.is_stamp(&time_cells(rows, header)) {
                    false if header.times.len() > 1 => parts::no_stamp(),
                    _ => wrong,
                };
                errors.push(wrong_time(file, header, rows, wrong));
            })
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
                let [comma, point] = [",", "."].map(|mark| wording.option("decimal", mark));
                let remedy = match remedy.contains("MARK") {
                    true if is_strict => NOT_REPAIRED,
                    true if cell.len() > LONGEST_MARK => "correct the cell{or skip}",
                    _ => remedy,
                };
                let remedy = remedy.replace("MARK", &mark);
                let remedy = remedy.replace("COMMA", &comma).replace("POINT", &point);
                self.header
                    .wrong(self.file, rows, *field, (problem.into(), remedy))
            };
            if self.marks.is_word(cell) {
                column.miss().map_err(wrong)?;
                continue;
            }
            let number = column
                .without_unit(cell)
                .map_err(|wrong| self.header.wrong(self.file, rows, *field, wrong))?;
            let value = self.decimals.number(number).map_err(wrong)?;
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
        if let Some((bad, error)) = &self.bad
            && (*bad >= self.rows || *bad > MOST_BAD.max(self.rows / 10))
        {
            return Err(error.clone());
        }
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
        self.check_order(&clock)?;
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

    /// Check that the rows belong to one series, and that their dates were not misread.
    fn check_order(&self, clock: &Clock) -> Result<(), DataError> {
        let wrong = |problem: &str, remedy: &str| Err(DataError::file(self.file, problem, remedy));
        let samples = self
            .columns
            .first()
            .map_or(&[][..], |column| &column.samples);
        if let Some((field, cells)) = self.labels.separating(samples, clock.in_seconds()) {
            let name = &self.header.names[field];
            let problem = format!(
                "its rows belong to several series, which column `{name}` distinguishes: {cells}"
            );
            return wrong(
                &problem,
                "write the rows of one of them to a file of its own",
            );
        }
        if clock.is_exchanged(samples.iter().map(|sample| sample.0)) {
            return wrong(
                "its rows are in order only if day and month are exchanged in all dates whose day is at most 12; a \
                    spreadsheet has probably exchanged them",
                "export the file again without opening it in a spreadsheet, or exchange them back",
            );
        }
        if clock.is_disordered() {
            let orders = self.layout.wording.option("dates", "ymd, dmy or mdy");
            let remedy = format!("check whether its dates are {orders}, and sort its rows");
            return wrong("two in five rows are out of order", &remedy);
        }
        Ok(())
    }

    /// What was repaired in the rows, without their order and single columns.
    fn repairs(&self, clock: &Clock) -> Repairs {
        Repairs {
            skipped: self.header.skipped,
            unit_rows: self.unit_rows,
            repeated_headers: self.repeated_headers,
            bad: self
                .bad
                .as_ref()
                .map(|(count, first)| (*count, first.line.unwrap_or(0))),
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
    /// The names of the columns of times.
    fn time_names(&self) -> Vec<&str> {
        self.times
            .iter()
            .map(|field| &*self.names[*field])
            .collect()
    }

    fn time_name(&self) -> String {
        self.time_names().join(",")
    }

    /// Whether the current row has this name in this column, whatever its case.
    fn is_named(&self, rows: &CsvRows<'_>, field: usize) -> bool {
        rows.cell(field)
            .eq_ignore_ascii_case(self.names[field].as_bytes())
    }

    /// Whether the current row names columns, as in joined files: one of its cells is the name of a
    /// column of times, which is not a number.
    fn is_repeated(&self, rows: &CsvRows<'_>) -> bool {
        if rows
            .cell(self.times[0])
            .first()
            .is_some_and(u8::is_ascii_digit)
        {
            return false;
        }
        let mut times = self.times.iter().map(|field| &*self.names[*field]);
        times.any(|name| {
            let is_there = |field| rows.cell(field).eq_ignore_ascii_case(name.as_bytes());
            name.parse::<f64>().is_err() && (0..self.names.len()).any(is_there)
        })
    }

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

/// The time cell of the current row; for several columns, the stamp that they form.
fn time_cell<'r>(rows: &'r CsvRows<'_>, header: &Header, parts: &Parts) -> Cow<'r, str> {
    match header.times[..] {
        [field] => String::from_utf8_lossy(rows.cell(field)),
        _ => Cow::Owned(parts.stamp(&time_cells(rows, header))),
    }
}

fn time_cells<'r>(rows: &'r CsvRows<'_>, header: &Header) -> Vec<Cow<'r, str>> {
    let cells = header.times.iter().map(|field| rows.cell(*field));
    cells.map(String::from_utf8_lossy).collect()
}

/// The error of the time of the current row.
fn wrong_time(
    file: &str,
    header: &Header,
    rows: &CsvRows<'_>,
    (problem, remedy): ProblemAndRemedy,
) -> DataError {
    DataError::file(file, problem, remedy)
        .line(rows.line(rows.place()))
        .cell(
            &header.time_name(),
            time_cells(rows, header).join(",").as_bytes(),
        )
}

/// Whether a row below the names holds units, kinds of means or a format of dates: its time is not
/// a time, and no wanted cell is a number.
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

/// What all rows together determine: how the parts of a time are written, and the order of day,
/// month and year, with the reason, if the dates need one that is not given.
fn survey(
    rows: &mut CsvRows<'_>,
    header: &Header,
    layout: &Layout,
) -> (Parts, Option<(DateOrder, &'static str)>) {
    let mut parts = Parts::of(&header.time_names());
    let is_whole = header.times.len() == 1;
    let is_told = layout.dates.is_some() && !layout.is_of_other_file;
    let (mut orders, mut looked, mut is_needed) = (Orders::new(), 0, false);
    loop {
        match rows.next() {
            Ok(true) => {}
            Ok(false) => break,
            Err(_) => {
                rows.leave_out_line();
                continue;
            }
        }
        if !is_whole {
            parts.look(&time_cells(rows, header));
        }
        let cell = time_cell(rows, header, &parts);
        is_needed |= needs_order(&cell);
        looked += 1;
        // If the first dates need no order, none is inferred.
        if (!is_needed || is_told) && looked > MOST_UNIT_ROWS && is_whole {
            break;
        }
        orders.take(&cell);
    }
    let fits = layout.dates.is_some_and(|given| orders.is_possible(given));
    let told = orders.told().filter(|_| is_needed && !is_told && !fits);
    (parts, told)
}
