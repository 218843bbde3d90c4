//! Records with a constant time between their samples: those of ground acceleration in the format
//! AT2 of the PEER database, and plain files of values, whose step the scenario gives.

use super::column::{AS_IT_IS, DataColumn, LARGEST_MEASURED, NOT_REPAIRED, is_too_close};
use super::error::DataError;
use super::marks;
use super::query::{Layout, Name, Wanted};
use super::repairs::{ColumnRepairs, Repairs};
use super::table::Table;
use super::unit::{self, ColumnQuantity, InputUnit};

/// Lines before the values of an AT2 file. The last gives the number of values and the time between
/// them; the one before gives their unit.
const HEADER: usize = 4;

/// How a record is sampled, according to its header or the scenario.
struct Sampling<'a> {
    file: &'a str,
    /// Lines before the values.
    skipped: usize,
    unit: InputUnit,
    /// The time between samples in this unit.
    step: f64,
    time: InputUnit,
    /// The number of values, if it is known.
    count: Option<usize>,
    /// The column, counted from 1, if not all numbers are values.
    column: Option<usize>,
}

/// The record in a text, if an input is wanted and either the fourth line has the AT2 format or the
/// layout gives the step.
pub(super) fn record(
    file: &str,
    text: &[u8],
    layout: &Layout,
    wanted: &[Wanted<'_>],
) -> Option<Result<Table, DataError>> {
    let [
        wanted @ Wanted {
            quantity: ColumnQuantity::Input,
            ..
        },
    ] = wanted
    else {
        return None;
    };
    let text = String::from_utf8_lossy(text);
    let with_header = match text.lines().take(HEADER).collect::<Vec<_>>()[..] {
        [_, _, third, fourth] if layout.skip.is_none() => at2(
            file,
            third,
            &fourth.to_uppercase().replace(" =", "="),
            wanted,
        ),
        _ => None,
    };
    let sampling = match (with_header, layout.step) {
        (Some(_), Some(_)) => {
            let problem = "the header of an AT2 record gives the time between its values";
            wrong(file, HEADER, problem.into(), "remove `step`")
        }
        (Some(sampling), None) => sampling,
        (None, step) => stepped(file, step?, layout, wanted),
    };
    Some(sampling.and_then(|sampling| sampling.table(&text)))
}

fn wrong<T>(file: &str, line: usize, problem: String, remedy: &str) -> Result<T, DataError> {
    Err(DataError::file(file, problem, remedy).line(line as u64))
}

/// The header of an AT2 file, if it is one: `NPTS= 4000, DT= .0050 SEC,`, or in the older form,
/// `4000 0.0050 NPTS, DT`.
fn at2<'a>(
    file: &'a str,
    third: &str,
    fourth: &str,
    wanted: &Wanted<'_>,
) -> Option<Result<Sampling<'a>, DataError>> {
    let words =
        |text: &str| -> Vec<String> { text.split_whitespace().map(str::to_string).collect() };
    let after = |key: &str| {
        Some(words(
            fourth.split_once(key)?.1.trim_start().split(',').next()?,
        ))
    };
    let older = words(&fourth.replace(',', " "));
    let (count, step) = match (after("NPTS="), after("DT=")) {
        (Some(count), Some(step)) => (count, step),
        _ => match &older[..] {
            [count, step, npts, dt, ..] if npts == "NPTS" && dt == "DT" => {
                (vec![count.clone()], vec![step.clone()])
            }
            _ => return None,
        },
    };
    let count = count
        .first()
        .and_then(|count| count.parse().ok())
        .filter(|count| *count >= 2);
    let number = step
        .first()
        .and_then(|step| step.parse().ok())
        .filter(|step: &f64| *step > 0.0 && step.is_finite());
    let time = step.get(1).map_or(Some(InputUnit::AS_GIVEN), |name| {
        unit::time(name.trim_matches(['.', ';', '(', ')']))
    });
    let read = || {
        let (Some(count), Some(step), Some(time)) = (count, number, time) else {
            let problem = format!("is not the header of a record: `{}`", fourth.trim());
            return wrong(
                file,
                HEADER,
                problem,
                "write e.g. `NPTS=  4000, DT=   .0050 SEC,`",
            );
        };
        let unit = unit_of(file, wanted, said(third))?;
        Ok(Sampling {
            file,
            skipped: HEADER,
            unit,
            step,
            time,
            count: Some(count),
            column: None,
        })
    };
    Some(read())
}

/// The word for the unit in the third line, such as `IN UNITS OF G. FILTER POINTS: ...` or
/// `IN CM/SEC/SEC`.
fn said(third: &str) -> Option<&str> {
    let upper = third.to_ascii_uppercase();
    let at = ["UNITS OF ", "UNITS: ", " IN "]
        .iter()
        .find_map(|key| Some(upper.find(key)? + key.len()));
    let word = third[at?..].split_whitespace().next()?;
    Some(word.trim_matches(['.', ',', ';', ':', '(', ')', '[', ']']))
}

/// The unit of the values: the given one, or that of the header. PEER writes records in g.
fn unit_of(file: &str, wanted: &Wanted<'_>, said: Option<&str>) -> Result<InputUnit, DataError> {
    let name = wanted.unit.or(said).unwrap_or("G");
    let wrong = |problem, remedy: &str| wrong(file, HEADER - 1, problem, remedy);
    let Some(unit) = wanted.quantity.unit(name) else {
        let units = wanted.quantity.units();
        return wrong(
            format!("has the unknown unit `{name}`"),
            &format!("give the unit of the values as `unit`: {units}"),
        );
    };
    match said.filter(|said| wanted.quantity.unit(said).is_some_and(|said| said != unit)) {
        Some(said) => wrong(
            format!("the header gives the unit `{said}`, but `unit` = \"{name}\""),
            "remove `unit`, or correct the header",
        ),
        None => Ok(unit),
    }
}

/// Values whose step the scenario gives, in seconds.
fn stepped<'a>(
    file: &'a str,
    step: f64,
    layout: &Layout,
    wanted: &Wanted<'_>,
) -> Result<Sampling<'a>, DataError> {
    let column = match wanted.column {
        Name::Beginning(_) | Name::Every => None,
        Name::Exactly(name) => match name.parse().ok().filter(|number| *number >= 1) {
            Some(number) => Some(number),
            None => {
                let problem =
                    format!("with `step`, a column is given by its number, not as `{name}`");
                return Err(DataError::file(
                    file,
                    problem,
                    "give a number, such as `column = 2`, or leave it out",
                ));
            }
        },
    };
    let unit = match wanted.unit {
        Some(_) => unit_of(file, wanted, None)?,
        None => InputUnit::AS_GIVEN,
    };
    let skipped = layout.skip.unwrap_or(0) as usize;
    Ok(Sampling {
        file,
        skipped,
        unit,
        step,
        time: InputUnit::AS_GIVEN,
        count: None,
        column,
    })
}

impl Sampling<'_> {
    /// The record with these values.
    fn table(&self, text: &str) -> Result<Table, DataError> {
        let Sampling {
            file,
            unit,
            step,
            time,
            ..
        } = self;
        let cells = self.cells(text)?;
        if let Some(count) = self.count.filter(|count| *count != cells.len()) {
            let problem = format!(
                "has {} values, but its header says NPTS = {count}",
                cells.len()
            );
            return wrong(
                file,
                HEADER,
                problem,
                "use the complete file; values of an input are not repaired or left out",
            );
        }
        if cells.len() < 2 {
            let problem = format!("it has {} values; a record needs at least two", cells.len());
            return Err(DataError::file(file, problem, "give a file of numbers"));
        }
        if is_too_close(time.of(*step), 0.0) {
            let problem = format!(
                "a time of {} s between samples is too short",
                time.of(*step)
            );
            return Err(DataError::file(
                file,
                problem,
                "give the step of the record in seconds",
            ));
        }
        let assumed_unit = (*unit == InputUnit::AS_GIVEN).then_some(AS_IT_IS);
        let odd = marks::likely("value", cells.iter().copied());
        let said = ColumnRepairs {
            name: "value".into(),
            odd,
            assumed_unit,
            ..ColumnRepairs::default()
        };
        let times = (0..cells.len()).map(|i| time.of(i as f64 * step)).collect();
        let values = cells.iter().map(|cell| unit.of(cell.0)).collect();
        let name = self
            .column
            .map_or_else(String::new, |column| column.to_string());
        let column = DataColumn {
            name,
            times,
            values,
            averaged: 0.0,
            mark: None,
            unit: unit.name,
        };
        let repairs = Repairs {
            columns: vec![said],
            ..Repairs::default()
        };
        let (rows, columns) = (cells.len() as u64, vec![column]);
        Ok(Table {
            start: None,
            begin: 0.0,
            in_seconds: true,
            rows,
            time: String::new(),
            columns,
            repairs,
        })
    }

    /// The numbers of the record, each with its line.
    fn cells(&self, text: &str) -> Result<Vec<(f64, u64)>, DataError> {
        let mut found: Vec<(f64, u64)> = Vec::new();
        for (i, line) in text
            .lines()
            .enumerate()
            .skip(self.skipped)
            .filter(|(_, line)| !line.starts_with('#'))
        {
            let words = line
                .split([' ', '\t', ',', ';'])
                .flat_map(numbers)
                .filter(|word| !word.is_empty());
            let words: Vec<&str> = words.collect();
            let of_column = self
                .column
                .map(|column| words.get(column - 1..column).unwrap_or(&[""]));
            for word in of_column.filter(|_| !words.is_empty()).unwrap_or(&words) {
                match word
                    .parse()
                    .ok()
                    .filter(|value: &f64| value.abs() <= LARGEST_MEASURED)
                {
                    Some(value) => found.push((value, i as u64 + 1)),
                    None => {
                        return wrong(
                            self.file,
                            i + 1,
                            format!("`{word}` is not a number"),
                            NOT_REPAIRED,
                        );
                    }
                }
            }
        }
        let lines: Vec<_> = found.chunk_by(|one, next| one.1 == next.1).collect();
        let is_table = self.count.is_none() && self.column.is_none() && self.has_times(&lines);
        if is_table {
            let problem = format!(
                "has {} numbers in each line, but `step` is for values without times",
                lines[0].len()
            );
            let remedy = "remove `step` and name both columns, `time = 1` and `column = 2`, or keep it and name \
                          the column of values";
            return wrong(self.file, lines[0][0].1 as usize, problem, remedy);
        }
        Ok(found)
    }

    /// Whether lines of equal length seem to hold times and values: two numbers, or first numbers
    /// that differ by about the step.
    fn has_times(&self, lines: &[&[(f64, u64)]]) -> bool {
        let is_step = |pair: &[&[(f64, u64)]]| {
            (pair[1][0].0 - pair[0][0].0 - self.step).abs() < 0.5 * self.step
        };
        let width = lines.first().map_or(0, |line| line.len());
        width > 1
            && lines.len() > 1
            && lines.iter().all(|line| line.len() == width)
            && (width == 2 || lines.windows(2).all(is_step))
    }
}

/// Another format of ground-motion records, recognised by its first line.
pub(super) fn other_format(text: &[u8]) -> Option<&'static str> {
    let first = String::from_utf8_lossy(text.split(|byte| *byte == b'\n').next()?);
    let formats = [
        ("Origin Time", "K-NET and KiK-net"),
        ("EVENT_NAME:", "ESM"),
        ("(Format v01", "COSMOS"),
    ];
    formats
        .into_iter()
        .find(|(mark, _)| first.contains(mark))
        .map(|(_, format)| format)
}

/// The numbers in a word, possibly without blanks between them, as Fortran writes them in columns
/// of a fixed width: `-.1234E-02-.5678E-03`.
fn numbers(word: &str) -> impl Iterator<Item = &str> {
    let bytes = word.as_bytes();
    let begins = move |i: &usize| {
        matches!(bytes[*i], b'+' | b'-')
            && !matches!(bytes[i - 1], b'e' | b'E')
            && bytes[..*i].contains(&b'.')
    };
    let starts = std::iter::once(0)
        .chain((1..word.len()).filter(begins))
        .collect::<Vec<_>>();
    let ends = starts
        .iter()
        .skip(1)
        .copied()
        .chain([word.len()])
        .collect::<Vec<_>>();
    starts
        .into_iter()
        .zip(ends)
        .map(move |(start, end)| &word[start..end])
}
