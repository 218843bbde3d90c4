//! The line of a CSV file that names its columns, and which of them are wanted.

use super::error::DataError;
use super::parts::Parts;
use super::query::{Layout, Name, Wanted};
use super::rows::{CsvRows, line_at, listed, separator};
use super::stamp::{is_time_of_day, needs_order, stamp};
use super::unit::{self, ColumnQuantity};
use std::cmp::Reverse;

/// The columns that are wanted, by their places in the row of names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// The names of all columns.
    pub names: Vec<String>,
    /// The column of times, or those of dates and of times of day.
    pub times: Vec<usize>,
    /// The columns of values, in the order in which they were wanted.
    pub values: Vec<usize>,
    /// The cells of a row of units above it; empty if there is none.
    pub units_above: Vec<String>,
    /// Number of lines before it, other than comments, that are not measurements.
    pub skipped: u64,
}

impl Header {
    /// Whether the name of a column is that of a time or of a part of one.
    pub fn is_of_time(&self, field: usize) -> bool {
        let name = self.names[field].to_lowercase();
        let begins = |words: &[&str]| words.iter().any(|word| name.starts_with(word));
        Parts::is_part(&name) || begins(&TIME) || begins(&DATE)
    }
}

/// The number of lines in which the names of the columns are searched for.
const LOOKED_THROUGH: usize = 200;

/// A line that may name the columns.
struct Line {
    /// Where its cells begin.
    offset: usize,
    /// Its number, from 1.
    number: u64,
    separator: u8,
    is_comment: bool,
    names: Vec<String>,
}

/// A file at the row below the names of its columns.
pub(super) type Opened<'a> = (CsvRows<'a>, Header);

/// A file whose columns were not found: the error, and the file with the columns that were found or
/// are likely, if there is one for each.
pub(super) struct NotFound<'a> {
    pub error: DataError,
    pub likely: Option<Opened<'a>>,
}

impl From<DataError> for Box<NotFound<'_>> {
    fn from(error: DataError) -> Self {
        Box::new(NotFound {
            error,
            likely: None,
        })
    }
}

/// Open a file at the row below the names of its columns. That is the first line in which every
/// wanted column can be found, or the line after those that are to be skipped.
pub(super) fn open<'a>(
    file: &'a str,
    bytes: &'a [u8],
    layout: &Layout,
    wanted: &[Wanted<'_>],
) -> Result<Opened<'a>, Box<NotFound<'a>>> {
    let lines = lines(file, bytes, layout.skip);
    let Some(first) = lines.iter().find(|line| !line.is_comment).or(lines.first()) else {
        let problem = if layout.skip.is_some() && !bytes.is_empty() {
            "it has no header"
        } else {
            "it is empty"
        };
        let remedy = "give a CSV file whose first line names its columns";
        return Err(DataError::file(file, problem, remedy).into());
    };
    let of_line = |line: &Line| sought(file, &lines, line, layout).columns(wanted);
    let opened = |line: &Line, (times, values): (Vec<usize>, Vec<usize>)| {
        let skipped = lines
            .iter()
            .take_while(|other| other.number < line.number)
            .filter(|other| !other.is_comment);
        let header = Header {
            names: line.names.clone(),
            times,
            units_above: units_above(&lines, line, &values, wanted),
            values,
            skipped: skipped.count() as u64,
        };
        let mut rows = CsvRows::at(file, bytes, line.offset, line.separator, true);
        rows.texts();
        let last = header.times.iter().chain(&header.values).max();
        let least = last.map_or(0, |last| last + 1);
        (rows.below(least), header)
    };
    if let Some((line, found)) = naming(&lines, |line| of_line(line).ok()) {
        return Ok(opened(line, found));
    }
    if let Some((line, header)) = numbered(file, &lines, first, layout, wanted) {
        let rows = CsvRows::at(file, bytes, line.offset, line.separator, true);
        return Ok((rows.numbered(header.names.len()), header));
    }
    let best = likeliest(file, &lines, layout, wanted)
        .filter(|best| best.number == first.number || best.is_comment || !is_data(&first.names));
    let Some(best) = best else {
        return Err(unnamed(file, &first.names, layout, wanted)
            .line(first.number)
            .into());
    };
    let error = of_line(best).err();
    let error = error.unwrap_or_else(|| DataError::file(file, "it has no header", "add one"));
    let error = if best.number == first.number {
        error
    } else {
        error.line(best.number)
    };
    let likely = sought(file, &lines, best, layout).likely(wanted);
    let likely = likely.map(|found| opened(best, found));
    Err(Box::new(NotFound { error, likely }))
}

/// The first row of a file without names, whose columns are identified by their numbers.
fn numbered<'l>(
    file: &str,
    lines: &'l [Line],
    first: &Line,
    layout: &Layout,
    wanted: &[Wanted<'_>],
) -> Option<(&'l Line, Header)> {
    let width = lines.last()?.names.len();
    let names: Vec<String> = (1..=width).map(|number| number.to_string()).collect();
    let is_row = |line: &&Line| !line.is_comment && line.names.len() == width;
    let line = lines.iter().find(is_row)?;
    let sought = Sought {
        file,
        names: &names,
        below: &[],
        layout,
    };
    let (times, values) = sought.columns(wanted).ok()?;
    let header = Header {
        names,
        times,
        values,
        units_above: Vec::new(),
        skipped: line.number.saturating_sub(first.number),
    };
    Some((line, header))
}

/// The cells of the line above the names, if one of them is the unit of a wanted column.
fn units_above(
    lines: &[Line],
    line: &Line,
    values: &[usize],
    wanted: &[Wanted<'_>],
) -> Vec<String> {
    let above = lines.iter().rfind(|above| above.number < line.number);
    let is_unit = |cells: &&Vec<String>| {
        let mut columns = values.iter().zip(wanted);
        cells.len() == line.names.len()
            && columns.any(|(field, wanted)| unit::is_unit(wanted.quantity, &cells[*field]))
    };
    let units = above.map(|above| &above.names).filter(is_unit);
    units.cloned().unwrap_or_default()
}

/// The line that names the columns, which are those `of` it.
fn naming<T>(lines: &[Line], of: impl Fn(&Line) -> Option<T>) -> Option<(&Line, T)> {
    let named = |line| Some((line, of(line)?));
    let in_text = lines.iter().filter(|line| !line.is_comment).find_map(named);
    // A comment names the columns only if the rows below it have as many cells.
    let in_comment = || {
        let last = lines.iter().rev().find(|line| !line.is_comment)?;
        lines
            .iter()
            .filter(|line| line.is_comment && line.names.len() == last.names.len())
            .find_map(named)
    };
    in_text.or_else(in_comment)
}

/// The error of a file without names of columns. It proposes the column of dates, one of hours
/// after it, and the first other number, if possible one with decimals.
fn unnamed(file: &str, cells: &[String], layout: &Layout, wanted: &[Wanted<'_>]) -> DataError {
    let quantity = wanted
        .first()
        .map_or(ColumnQuantity::Temperature, |one| one.quantity);
    let date = cells.iter().position(|cell| is_date(cell)).unwrap_or(0);
    let is_hour = |cell: &String| cell.parse::<u8>().is_ok_and(|hour| hour <= 24);
    let last = date + usize::from(cells.len() > 2 && cells.get(date + 1).is_some_and(is_hour));
    let decimal = cells
        .iter()
        .skip(last + 1)
        .position(|cell| cell.contains('.'));
    let time: Vec<String> = (date..=last).map(|field| (field + 1).to_string()).collect();
    let time = layout.wording.option("time", &time.join(","));
    let value = (last + 2 + decimal.unwrap_or(0)).to_string();
    let value = layout.wording.column(quantity, &value);
    let remedy = format!(
        "put a line such as `time_s,temperature_degC` before it, or select the columns by number, e.g. \
            {time} and {value}"
    );
    let problem = "its first line contains numbers or dates, not the names of the columns";
    DataError::file(file, problem, remedy)
}

/// Whether a line holds measurements: each of its cells is a number, a date or empty.
fn is_data(cells: &[String]) -> bool {
    cells.iter().all(|cell| cell.is_empty() || is_datum(cell))
}

fn is_datum(cell: &str) -> bool {
    cell.replace(',', ".").parse::<f64>().is_ok() || is_date(cell) || is_time_of_day(cell)
}

fn is_date(cell: &str) -> bool {
    stamp(cell, None).is_some() || needs_order(cell)
}

/// The columns that are sought in a line.
fn sought<'a>(file: &'a str, lines: &'a [Line], line: &'a Line, layout: &'a Layout) -> Sought<'a> {
    Sought {
        file,
        names: &line.names,
        below: below(lines, line),
        layout,
    }
}

/// The lines below another one that may hold units, down to the first measurements.
fn below<'l>(lines: &'l [Line], line: &Line) -> &'l [Line] {
    let first = lines.iter().position(|other| other.number > line.number);
    let rest = &lines[first.unwrap_or(lines.len())..];
    let last = rest.iter().position(|line| is_data(&line.names));
    &rest[..last.map_or(rest.len(), |last| last + 1).min(4)]
}

/// The line that most likely names the columns, though not all that are wanted: the one with most
/// of them, otherwise one without numbers and dates that has the same number of cells as the last
/// line. A line with a single cell above rows with several is a note.
fn likeliest<'l>(
    file: &str,
    lines: &'l [Line],
    layout: &Layout,
    wanted: &[Wanted<'_>],
) -> Option<&'l Line> {
    let width = lines.last()?.names.len();
    let found = |line: &Line| {
        let sought = sought(file, lines, line, layout);
        wanted
            .iter()
            .filter(|one| sought.value(one).is_ok())
            .count()
            + usize::from(sought.times().is_ok())
    };
    let is_named = |line: &&Line| {
        (line.names.len() > 1 || width == 1)
            && (!line.is_comment || line.names.len() == width)
            && !line.names.iter().any(|name| is_datum(name))
    };
    let rank = |line: &&Line| {
        let is_text = !line.is_comment;
        (
            found(line),
            line.names.len() == width,
            is_text,
            Reverse(line.number),
        )
    };
    lines.iter().filter(is_named).max_by_key(rank)
}

/// The first lines of a file with their cells, without a line such as `sep=;`, which says the
/// separator. Of a file whose first lines are to be skipped, only the line after them, with the
/// comments before it.
fn lines(file: &str, bytes: &[u8], skip: Option<u64>) -> Vec<Line> {
    let mut found = Vec::new();
    let (mut at, mut number, mut given) = (0, 0, None);
    while at < bytes.len() && found.len() < LOOKED_THROUGH {
        let length = bytes[at..]
            .iter()
            .position(|byte| *byte == b'\n')
            .unwrap_or(bytes.len() - at);
        let text = bytes[at..at + length].trim_ascii();
        number += 1;
        let hashes = text.iter().take_while(|byte| **byte == b'#').count();
        let offset = at
            + bytes[at..]
                .iter()
                .position(|byte| *byte != b' ')
                .unwrap_or(0)
            + hashes;
        at += length + 1;
        if let [b's' | b'S', b'e' | b'E', b'p' | b'P', b'=', separator] = text {
            given = Some(*separator);
            continue;
        }
        if text.len() == hashes || skip.is_some_and(|lines| number <= lines) {
            continue;
        }
        let separator = given.unwrap_or_else(|| separator(text));
        let names = CsvRows::at(file, bytes, offset, separator, false)
            .texts()
            .unwrap_or_default();
        let names = match found.last() {
            Some(above) => in_two_lines(above, names),
            None => names,
        };
        found.push(Line {
            offset,
            number: line_at(bytes, offset),
            separator,
            is_comment: hashes > 0,
            names,
        });
        if skip.is_some() && hashes == 0 {
            break;
        }
    }
    found
}

/// Names of columns in two lines, where a word in the upper line distinguishes columns of the same
/// name, as in `Temp` above `Out` and `Hi` above `Temp`.
fn in_two_lines(above: &Line, names: Vec<String>) -> Vec<String> {
    let is_twice =
        |name: &String| !name.is_empty() && names.iter().filter(|other| *other == name).count() > 1;
    let is_below = above.names.len() == names.len()
        && above.names.iter().any(String::is_empty)
        && !is_data(&above.names);
    if !is_below || !names.iter().any(is_twice) || names.iter().any(|name| is_datum(name)) {
        return names;
    }
    let both = above.names.iter().zip(&names);
    both.map(|(above, name)| format!("{above} {name}").trim().to_string())
        .collect()
}

/// Names of columns that hold date and time, those that hold a time, and those that hold a date, as
/// loggers and spreadsheets write them in lower case.
const DATE_AND_TIME: [&str; 7] = [
    "timestamp",
    "time stamp",
    "datetime",
    "date time",
    "date/time",
    "date_time",
    "date-time",
];
const TIME: [&str; 5] = ["time", "zeit", "uhrzeit", "tid", "heure"];
const DATE: [&str; 4] = ["date", "datum", "dato", "yyyymmdd"];

/// Words, and beginnings of words, for other quantities that loggers and weather services record.
const OTHERS: [&str; 16] = [
    "dew", "batt", "stat", "volt", "humid", "wind", "press", "rain", "record", "serial", "panel",
    "ptemp", "reftemp", "logger", "signal", "number",
];
const OTHER_WORDS: [&str; 8] = ["rh", "td", "id", "rn", "no", "stn", "qn", "eor"];

/// A line of names in which columns are sought.
#[derive(Clone, Copy)]
struct Sought<'a> {
    file: &'a str,
    names: &'a [String],
    /// The lines below it, down to the first measurements.
    below: &'a [Line],
    layout: &'a Layout,
}

impl Sought<'_> {
    /// The columns of times and of the values that are wanted.
    fn columns(&self, wanted: &[Wanted<'_>]) -> Result<(Vec<usize>, Vec<usize>), DataError> {
        let times = self.times();
        if let [
            Wanted {
                column: Name::Every,
                ..
            },
        ] = wanted
        {
            let times = times?;
            let values = (0..self.names.len()).filter(|field| !times.contains(field));
            return Ok((times.clone(), values.collect()));
        }
        let (found, missing): (Vec<_>, Vec<_>) = wanted
            .iter()
            .map(|one| self.value(one))
            .partition(Result::is_ok);
        let errors = times
            .as_ref()
            .err()
            .cloned()
            .into_iter()
            .chain(missing.into_iter().filter_map(Result::err));
        match DataError::of_all(errors) {
            Some(error) => Err(error),
            None => Ok((times?, found.into_iter().flatten().collect())),
        }
    }

    /// The columns whose names are like this.
    fn fields(&self, is: impl Fn(&str) -> bool) -> Vec<usize> {
        (0..self.names.len())
            .filter(|field| is(&self.names[*field]))
            .collect()
    }

    /// The columns of this name: exactly, or in other case, or followed by a unit or a note; or the
    /// column of this number.
    fn called(&self, name: &str) -> Vec<usize> {
        let found = self.fields(|column| column == name);
        if !found.is_empty() {
            return found;
        }
        let found = self.fields(|column| column.to_lowercase() == name.to_lowercase());
        if !found.is_empty() || name.is_empty() {
            return found;
        }
        let number = name.parse().ok().filter(|_| self.is_above_data());
        if let Some(number) = number {
            return (0..self.names.len())
                .filter(|field| field + 1 == number)
                .collect();
        }
        self.fields(|column| {
            column
                .strip_prefix(name)
                .is_some_and(|rest| rest.starts_with([' ', ',', '(', '[']))
        })
    }

    /// Whether this is a line of names directly above rows of as many measurements.
    fn is_above_data(&self) -> bool {
        let is_row = |line: &Line| line.names.len() == self.names.len() && is_data(&line.names);
        !self.names.iter().any(|name| is_datum(name)) && self.below.last().is_some_and(is_row)
    }

    /// The column of times, or those of dates and of times of day.
    fn times(&self) -> Result<Vec<usize>, DataError> {
        let Some(name) = &self.layout.time else {
            return self.usual_times();
        };
        let whole = self.called(name);
        let parts: Vec<(&str, Vec<usize>)> = name
            .split(',')
            .map(|part| (part.trim(), self.called(part.trim())))
            .collect();
        let is_list = matches!(parts.len(), 2..=6);
        match whole[..] {
            [field] => Ok(vec![field]),
            [] => match parts.iter().find(|(_, found)| !is_list || found.len() != 1) {
                None => Ok(parts.into_iter().flat_map(|(_, found)| found).collect()),
                Some(_) if self.layout.is_of_other_file => self.usual_times(),
                Some((part, _)) => {
                    Err(self.no_time(Name::Exactly(if is_list { part } else { name })))
                }
            },
            _ => Err(self.several(
                Name::Exactly(name),
                whole.len(),
                "give the columns different names",
            )),
        }
    }

    /// The columns of times that a file has under a usual name.
    fn usual_times(&self) -> Result<Vec<usize>, DataError> {
        let names = self.names;
        if let [field] = self.called("time")[..]
            && names[field] == "time"
        {
            return Ok(vec![field]);
        }
        if let Some(parts) = Parts::usual(names) {
            return Ok(parts);
        }
        let one_of = |words: &[&str]| self.fields(|name| words.contains(&&*name.to_lowercase()));
        let begins_with = |words: &[&str]| {
            self.fields(|name| {
                words
                    .iter()
                    .any(|word| name.to_lowercase().starts_with(word))
            })
        };
        let (time, date) = (one_of(&TIME), one_of(&DATE));
        let hour = self.fields(Parts::is_hour);
        let (both, beginning) = (begins_with(&DATE_AND_TIME), begins_with(&["time"]));
        let all = [&both, &time, &beginning, &date];
        let found = all
            .into_iter()
            .find(|found| !found.is_empty())
            .unwrap_or(&both);
        match (&found[..], &date[..], &hour[..]) {
            ([], ..) => Err(self.no_time(Name::Exactly("time"))),
            ([one], [date], _) if time == [*one] => Ok(vec![*date, *one]),
            ([one], [date], [hour, ..]) if date == one => Ok(vec![*one, *hour]),
            ([one], ..) => Ok(vec![*one]),
            _ => {
                let example = self.layout.wording.option("time", &names[found[0]]);
                let listed = listed(names);
                let remedy = format!("name one, e.g. {example}; the columns are {listed}");
                Err(self.several(Name::Beginning("time"), found.len(), remedy))
            }
        }
    }

    /// The error without a column of times. It proposes the likely ones.
    fn no_time(&self, name: Name<'_>) -> DataError {
        let names: Vec<&str> = self
            .likely_times()
            .iter()
            .map(|field| &*self.names[*field])
            .collect();
        let example = self.layout.wording.option("time", &names.join(","));
        self.none(name, &format!("name the right one, e.g. {example}"))
    }

    /// The first column of dates, with one of hours after it. Without one, it is the first with a
    /// name.
    fn likely_times(&self) -> Vec<usize> {
        let date = self.first_row().iter().position(|cell| is_date(cell));
        let is_named = |field: &usize| !self.names[*field].is_empty();
        let all = date.unwrap_or(0)..self.names.len();
        let date = all.into_iter().find(is_named);
        let is_hour =
            |field: &usize| Parts::is_hour(&self.names[*field]) && self.date_in(*field - 1);
        let hour = date
            .map(|date| date + 1)
            .filter(|field| *field < self.names.len())
            .filter(is_hour);
        date.into_iter().chain(hour).collect()
    }

    /// The cells of the first row of measurements.
    fn first_row(&self) -> &[String] {
        self.below.last().map_or(&[], |line| &line.names)
    }

    fn date_in(&self, field: usize) -> bool {
        self.first_row()
            .get(field)
            .is_some_and(|cell| is_date(cell))
    }

    /// The columns that are wanted, or the likely ones in place of those that are not found, if they
    /// hold a date and numbers.
    fn likely(&self, wanted: &[Wanted<'_>]) -> Option<(Vec<usize>, Vec<usize>)> {
        let likely_times = || {
            Some(self.likely_times())
                .filter(|times| times.first().is_some_and(|field| self.date_in(*field)))
        };
        let times = self.times().ok().or_else(likely_times)?;
        let all: Vec<usize> = (0..self.names.len())
            .filter(|field| !times.contains(field))
            .collect();
        let is_number = |field: &usize| {
            let cell = self.first_row().get(*field);
            cell.is_some_and(|cell| cell.replace(',', ".").parse::<f64>().is_ok())
        };
        let value = |one: &Wanted<'_>| {
            let found = self.value(one).ok();
            found.or_else(|| self.proposed(one.quantity, &all).filter(is_number))
        };
        let values = wanted.iter().map(value).collect::<Option<Vec<usize>>>()?;
        Some((times, values))
    }

    /// The place of a wanted column; if there is not exactly one, the error lists the names.
    fn value(&self, wanted: &Wanted<'_>) -> Result<usize, DataError> {
        let (name, names) = (wanted.column, self.names);
        let example = |among: &[usize]| {
            let proposed = self.proposed(wanted.quantity, among);
            let name = proposed.map_or("NAME", |field| &names[field]);
            self.layout.wording.column(wanted.quantity, name)
        };
        let beginning = |start: &str| {
            self.fields(|name| name.to_lowercase().starts_with(&start.to_lowercase()))
        };
        let found = match name {
            Name::Exactly(name) => self.called(name),
            Name::Beginning(start) => {
                let whole = beginning(start);
                if whole.is_empty() {
                    beginning(&start.chars().take(4).collect::<String>())
                } else {
                    whole
                }
            }
            Name::Every => Vec::new(),
        };
        match (&found[..], name) {
            ([field], _) => Ok(*field),
            ([], _) => {
                let all: Vec<usize> = (0..names.len()).collect();
                let example = example(&all);
                Err(self.none(name, &format!("name the right one, e.g. {example}")))
            }
            (all, _) => {
                let has_own_name = |field: &usize| {
                    names.iter().filter(|name| **name == names[*field]).count() == 1
                };
                let remedy = if all.iter().all(has_own_name) {
                    let which: Vec<String> =
                        all.iter().map(|field| names[*field].clone()).collect();
                    format!(
                        "name one, e.g. {}; the columns are {}",
                        example(all),
                        listed(&which)
                    )
                } else {
                    format!(
                        "give the columns of the file different names: {}",
                        listed(names)
                    )
                };
                Err(self.several(name, all.len(), remedy))
            }
        }
    }

    /// The column that most likely holds a quantity: one with a fitting unit, in its
    /// name or below, then one with a fitting name, then the first; columns of other cells than
    /// numbers, times, and other quantities of loggers and weather services are excluded.
    fn proposed(&self, quantity: ColumnQuantity, among: &[usize]) -> Option<usize> {
        let likeness = |field: &&usize| {
            let name = &self.names[**field];
            let words: Vec<String> = name
                .split(|c: char| !c.is_alphabetic())
                .filter(|word| !word.is_empty())
                .map(str::to_lowercase)
                .collect();
            let begins = |known: &[&str]| {
                let is = |word: &String| known.iter().any(|known| word.starts_with(known));
                words.iter().any(is)
            };
            let is_other = begins(&OTHERS)
                || begins(&TIME)
                || begins(&DATE)
                || begins(&DATE_AND_TIME)
                || words.iter().any(|word| OTHER_WORDS.contains(&&**word));
            let is_below = |line: &Line| {
                line.names
                    .get(**field)
                    .is_some_and(|cell| unit::is_unit(quantity, cell))
            };
            let has_unit = matches!(unit::of_name(quantity, name), Ok(Some(_)))
                || self.below.iter().any(is_below);
            let known: &[&str] = match quantity {
                ColumnQuantity::Temperature => &["temp", "tmp", "celsius", "air", "luft"],
                ColumnQuantity::Displacement => &[
                    "disp", "lvdt", "gauge", "gap", "joint", "weg", "position", "depl",
                ],
                ColumnQuantity::Input => &["acc", "force"],
            };
            let first = words
                .first()
                .is_some_and(|word| word.starts_with(&quantity.word()[..1]));
            let rank = (has_unit, begins(known), first, Reverse(**field));
            (!name.is_empty(), !is_other, rank)
        };
        let is_number = |field: &&usize| {
            let cell = self.below.last().and_then(|line| line.names.get(**field));
            cell.is_none_or(|cell| {
                let is_time = is_date(cell) || is_time_of_day(cell);
                cell.is_empty() || !is_time && cell.contains(|c: char| c.is_ascii_digit())
            })
        };
        let best = among.iter().filter(is_number).max_by_key(likeness);
        best.copied().filter(|field| !self.names[*field].is_empty())
    }

    /// The error if no column matches. The remedy is followed by the existing names.
    fn none(&self, name: Name<'_>, remedy: &str) -> DataError {
        let text = match name {
            Name::Exactly(text) | Name::Beginning(text) => text,
            Name::Every => "",
        };
        let alike = |column: &&String| strsim::jaro_winkler(text, column);
        let near = self.names.iter().filter(|column| alike(column) > 0.8);
        let nearest = near.max_by(|a, b| alike(a).total_cmp(&alike(b)));
        let hint = nearest.map_or(String::new(), |column| {
            format!("; did you mean `{column}`?")
        });
        let is_one = self.names.len() == 1;
        let separators = if is_one {
            "; columns are separated by commas, semicolons or tabs"
        } else {
            ""
        };
        let remedy = format!("{remedy}: {}{separators}", listed(self.names));
        DataError::file(
            self.file,
            format!("no column {}{hint}", name.description()),
            remedy,
        )
    }

    fn several(&self, name: Name<'_>, count: usize, remedy: impl Into<String>) -> DataError {
        DataError::file(
            self.file,
            format!("{count} columns match: each {}", name.description()),
            remedy,
        )
    }
}
