//! The rows of a file in order of time, checked and repaired.

use super::clock::{Clock, ProblemAndRemedy, Start};
use super::error::DataError;
use super::query::{Name, TimeColumn, Wanted};
use super::rows::{Rows, listed};
use super::unit::{self, Unit};
use crate::numbers::short;

/// The columns that were wanted, as read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The instant of time 0, if the file has stamps.
    pub start: Option<Start>,
    /// Whether times are in seconds. If not, they are numbers in a column whose name gives no unit.
    pub in_seconds: bool,
    /// Number of rows read, including repeated ones and those without a value.
    pub rows: u64,
    /// The columns, in the order in which they were wanted.
    pub columns: Vec<DataColumn>,
    /// What was repaired.
    pub repairs: Repairs,
}

/// One column: times in ascending order, with their values.
#[derive(Clone, Debug, PartialEq)]
pub struct DataColumn {
    /// Its name in the header.
    pub name: String,
    /// Times from the earliest value of all columns that were wanted; each is later than the one
    /// before.
    pub times: Vec<f64>,
    /// Values: temperatures in degrees, displacements in metres.
    pub values: Vec<f64>,
}

/// What was repaired in a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Number of rows that came after a row with a later time, and were sorted.
    pub unsorted: u64,
    /// Number of rows that repeated the time and the value of another row, and were left out.
    pub repeated: u64,
    /// Number of stamps in an hour that occurs twice; they were understood by the order of the
    /// rows.
    pub folds: u64,
    /// Number of numbers with a decimal comma.
    pub decimal_commas: u64,
    /// For each column, the number of cells without a value, which were left out.
    pub missing: Vec<(String, u64)>,
}

impl Repairs {
    /// The repairs as sentences; none if nothing was repaired.
    pub fn sentences(&self) -> Vec<String> {
        let many = |count: u64, one: &str, more: &str| match count {
            0 => None,
            1 => Some(one.replace('#', "1")),
            _ => Some(more.replace('#', &count.to_string())),
        };
        let unsorted = "sorted # row that stood behind a later one";
        let unsorted = many(self.unsorted, unsorted, "sorted # rows that stood behind a later one");
        let repeated = "left out # row that is there twice";
        let repeated = many(self.repeated, repeated, "left out # rows that are there more than once");
        let folds = "took # stamp of an hour that was twice in the order of its row";
        let folds = many(self.folds, folds, "took # stamps of hours that were twice in the order of their rows");
        let missing = self.missing.iter().filter_map(|(name, count)| {
            let said = many(*count, "left out # cell without a value", "left out # cells without a value")?;
            Some(format!("{said} in `{name}`"))
        });
        let commas = many(self.decimal_commas, "read # decimal comma", "read # decimal commas");
        [unsorted, repeated, folds].into_iter().flatten().chain(missing).chain(commas).collect()
    }
}

/// A column while it is read: its position, its unit, and its samples so far.
struct Reading<'a> {
    wanted: &'a Wanted<'a>,
    field: usize,
    unit: Unit,
    /// Time, value, and the place of the row.
    samples: Vec<(f64, f64, u32)>,
    missing: u64,
}

/// Largest number of rows. With it and the largest file, reading takes at most 2 GB of memory. A
/// century with a row every ten minutes has 5 10^6 rows.
const MAX_ROWS: u64 = 20_000_000;

/// Largest number that a measurement may hold, as a value or as a time: far beyond any temperature,
/// displacement or date in seconds, and small enough for sums of squares.
const LARGEST_MEASURED: f64 = 1e15;

/// Whether all values are the same, or so close together that no sensor tells them apart and their
/// squares are no doubles.
pub fn is_constant(values: &[f64]) -> bool {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    high - low < 1.0 / LARGEST_MEASURED
}

/// The first sample, as its time and its value, that is not finite or is too large for a
/// measurement. A file with such a sample is refused when it is read.
pub fn absurd(times: &[f64], values: &[f64]) -> Option<(f64, f64)> {
    let is_sound = |x: f64| x.abs() <= LARGEST_MEASURED;
    let mut samples = times.iter().copied().zip(values.iter().copied());
    samples.find(|(time, value)| !(is_sound(*time) && is_sound(*value)))
}

/// Texts, in lower case, that mark a missing value; an empty cell marks one as well.
const NOTHING: [&str; 9] = ["nan", "na", "n/a", "null", "none", "-", "--", "#n/a", "missing"];

/// Read the columns that are wanted. `file` and `header` are the names of the file and of its
/// columns.
pub(super) fn table(
    file: &str,
    header: &[String],
    mut rows: impl Rows,
    time: TimeColumn<'_>,
    wanted: &[Wanted<'_>],
) -> Result<Table, DataError> {
    let time_field = find(file, header, Name::Exactly(time.name))?;
    let readings = wanted.iter().map(|wanted| Reading::of(file, header, wanted));
    let mut readings = readings.collect::<Result<Vec<_>, DataError>>()?;
    let mut decimals = Decimals { commas: 0, points: 0, may_be_commas: rows.may_have_commas() };
    let mut clock = None;
    let mut count = 0;
    while rows.next()? {
        let at = |field: usize, (problem, remedy): ProblemAndRemedy| {
            let error = DataError::file(file, problem, &remedy).line(rows.line(rows.place()));
            error.cell(&header[field], rows.cell(field))
        };
        let cell = rows.cell(time_field);
        if cell.is_empty() {
            if (0..header.len()).all(|field| rows.cell(field).is_empty()) {
                continue;
            }
            return Err(at(time_field, ("has no time".into(), "give the row its time, or remove it".into())));
        }
        count += 1;
        if count > MAX_ROWS {
            let problem = format!("it has more than {MAX_ROWS} rows");
            return Err(DataError::file(file, problem, "cut it, or thin its rows out"));
        }
        let when = instant(&mut clock, &header[time_field], time.zone, cell, decimals.may_be_commas)
            .map_err(|wrong| at(time_field, wrong))?;
        for reading in &mut readings {
            reading
                .take(when, rows.cell(reading.field), rows.place(), &mut decimals)
                .map_err(|(problem, remedy)| at(reading.field, (problem.into(), remedy.into())))?;
        }
    }
    let Some(clock) = clock else {
        return Err(DataError::file(file, "it has a header and no rows".into(), "give a file with measurements"));
    };
    let mut repairs = Repairs { folds: clock.folds(), decimal_commas: decimals.commas, ..Repairs::default() };
    for reading in &mut readings {
        let name = &header[reading.field];
        let (unsorted, repeated) = in_order(reading, file, &rows, name, clock.in_seconds())?;
        repairs.unsorted = repairs.unsorted.max(unsorted);
        repairs.repeated = repairs.repeated.max(repeated);
        repairs.missing.push((name.clone(), reading.missing));
    }
    let begin = readings.iter().map(|reading| reading.samples[0].0).fold(f64::INFINITY, f64::min);
    let column = |reading: Reading<'_>| DataColumn {
        name: header[reading.field].clone(),
        times: reading.samples.iter().map(|sample| sample.0 - begin).collect(),
        values: reading.samples.iter().map(|sample| sample.1).collect(),
    };
    Ok(Table {
        start: clock.first().and_then(|first| first.after(begin)),
        in_seconds: clock.in_seconds(),
        rows: count,
        columns: readings.into_iter().map(column).collect(),
        repairs,
    })
}

/// The time of a row, from its cell in the column of times. The first cell decides what the others
/// are.
fn instant(
    clock: &mut Option<Clock>,
    column: &str,
    zone: Option<&str>,
    cell: &[u8],
    may_be_commas: bool,
) -> Result<f64, ProblemAndRemedy> {
    let clock = match clock {
        Some(clock) => clock,
        none => none.insert(Clock::new(column, zone, cell)?),
    };
    let when = clock.read(cell, |cell| number(cell, may_be_commas))?;
    if when.abs() > LARGEST_MEASURED {
        return Err(("is too large for a time".into(), "mend the cell, or give another column of times".into()));
    }
    Ok(when)
}

impl<'a> Reading<'a> {
    /// Find a column and its unit.
    fn of(file: &str, header: &[String], wanted: &'a Wanted<'a>) -> Result<Self, DataError> {
        let field = find(file, header, wanted.column)?;
        let unit = unit::of_values(wanted.quantity, &header[field], wanted.unit)
            .map_err(|(problem, remedy)| DataError::file(file, problem, &remedy))?;
        Ok(Reading { wanted, field, unit, samples: Vec::new(), missing: 0 })
    }

    /// Take the cell of a row; an error if it holds neither a value nor a mark of a missing one.
    fn take(
        &mut self,
        when: f64,
        cell: &[u8],
        place: u32,
        decimals: &mut Decimals,
    ) -> Result<(), (&'static str, &'static str)> {
        if is_missing(cell) {
            self.missing += 1;
            return Ok(());
        }
        let value = decimals.number(cell).ok_or(("is not a number", "mend the cell, or empty it"))?;
        if decimals.commas > 0 && decimals.points > 0 {
            return Err((
                "mixes decimal commas with decimal points, and its comma may mean thousands",
                "write all numbers with decimal points",
            ));
        }
        if !value.is_finite() {
            return Err(("is not finite", "mend the cell, or empty it"));
        }
        if value.abs() > LARGEST_MEASURED {
            return Err(("is too large for a measurement", "mend the cell, or empty it"));
        }
        if value < self.unit.least {
            return Err(("is below absolute zero", "empty the cell, if it marks a missing value, or mend the unit"));
        }
        self.samples.push((when, self.unit.of(value), place));
        Ok(())
    }
}

/// The index of a column in the header; if there is not exactly one, the error lists the names.
fn find(file: &str, header: &[String], name: Name<'_>) -> Result<usize, DataError> {
    let fields = |is: &dyn Fn(&str) -> bool| -> Vec<usize> {
        header.iter().enumerate().filter(|(_, column)| is(column)).map(|(field, _)| field).collect()
    };
    let what = name.description();
    let found = match name {
        Name::Exactly(name) => {
            let found = fields(&|column| column == name);
            let alike = || fields(&|column| column.eq_ignore_ascii_case(name));
            if found.is_empty() { alike() } else { found }
        }
        Name::Beginning(start) => fields(&|column| column.to_lowercase().starts_with(start)),
    };
    match found[..] {
        [field] => Ok(field),
        [] => {
            let (Name::Exactly(text) | Name::Beginning(text)) = name;
            let alike = |column: &&String| strsim::jaro_winkler(text, column);
            let nearest =
                header.iter().filter(|column| alike(column) > 0.8).max_by(|a, b| alike(a).total_cmp(&alike(b)));
            let hint = nearest.map_or(String::new(), |column| format!("; did you mean `{column}`?"));
            let problem = format!("no column {what}{hint}");
            let one = if header.len() == 1 { "; columns are separated by commas, semicolons or tabs" } else { "" };
            Err(DataError::file(file, problem, &format!("name one of its columns: {}{one}", listed(header))))
        }
        _ => {
            let problem = format!("{} columns are meant, because each {what}", found.len());
            Err(DataError::file(
                file,
                problem,
                &format!("give each column of the file a name of its own: {}", listed(header)),
            ))
        }
    }
}

fn is_missing(cell: &[u8]) -> bool {
    // Most cells end in a digit, and none of these texts does, so the comparison is rarely needed.
    cell.is_empty()
        || (!cell[cell.len() - 1].is_ascii_digit()
            && NOTHING.iter().any(|nothing| cell.eq_ignore_ascii_case(nothing.as_bytes())))
}

/// How the file writes decimals: the number of cells with a comma and with a point.
struct Decimals {
    may_be_commas: bool,
    commas: u64,
    points: u64,
}

impl Decimals {
    fn number(&mut self, cell: &[u8]) -> Option<f64> {
        if self.may_be_commas {
            self.commas += u64::from(cell.contains(&b','));
            self.points += u64::from(cell.contains(&b'.'));
        }
        number(cell, self.may_be_commas)
    }
}

fn number(cell: &[u8], may_be_commas: bool) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    if may_be_commas && text.contains(',') { text.replacen(',', ".", 1).parse().ok() } else { text.parse().ok() }
}

/// Sort the samples of a column, leave out repeated ones, and check for gaps. Returns how many
/// samples were out of order, and how many were repeated.
fn in_order(
    reading: &mut Reading<'_>,
    file: &str,
    rows: &impl Rows,
    name: &str,
    in_seconds: bool,
) -> Result<(u64, u64), DataError> {
    let lasting = |time: f64| match in_seconds {
        true if time >= 7200.0 => format!("{} h", short(time / 3600.0)),
        true if time >= 120.0 => format!("{} min", short(time / 60.0)),
        true => format!("{} s", short(time)),
        false => short(time),
    };
    let error = |problem: String, remedy: &str| DataError::file(file, problem, remedy);
    let line = |place: u32| rows.line(place);
    let samples = &mut reading.samples;
    let mut latest = f64::NEG_INFINITY;
    let mut unsorted = 0;
    for (time, ..) in samples.iter() {
        unsorted += u64::from(*time < latest);
        latest = latest.max(*time);
    }
    // The sort is stable, so samples of equal time stay in the order of their rows.
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let Some(pair) = samples.windows(2).find(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1) {
        let problem = format!(
            "line {} gives another value of `{name}` at the same time as line {}",
            line(pair[1].2),
            line(pair[0].2)
        );
        let remedy =
            "remove one of the two rows; if the clock was put back, say its `zone`, or write stamps with offsets";
        return Err(error(problem, remedy).line(line(pair[1].2)));
    }
    let all = samples.len();
    samples.dedup_by(|later, before| later.0 == before.0);
    let repeated = (all - samples.len()) as u64;
    if samples.len() < 2 {
        let problem =
            format!("column `{name}` has {} value{}", samples.len(), if samples.len() == 1 { "" } else { "s" });
        return Err(error(problem, "give a column with two values or more, at different times"));
    }
    let longest = reading.wanted.max_gap.unwrap_or(f64::INFINITY);
    if let Some(pair) = samples.windows(2).find(|pair| pair[1].0 - pair[0].0 > longest) {
        let gap = pair[1].0 - pair[0].0;
        let problem = format!(
            "no value of `{name}` for {}, since line {}, where at most {} are allowed",
            lasting(gap),
            line(pair[0].2),
            lasting(longest)
        );
        let remedy = "fill the gap, cut the file there, or raise `max_gap` if a straight line across it will do";
        return Err(error(problem, remedy).line(line(pair[1].2)));
    }
    Ok((unsorted, repeated))
}
