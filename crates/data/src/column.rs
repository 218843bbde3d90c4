//! The samples of one column: checked, sorted and repaired.

use super::error::{DataError, ProblemAndRemedy};
use super::marks::{self, Marks};
use super::outliers::{median, odd, spikes};
use super::query::{Layout, Wanted, Wording};
use super::repairs::{ColumnRepairs, Repairs};
use super::rows::OR_SKIP;
use super::unit::{self, ColumnQuantity, InputUnit};
use stickslip_text::numbers::short;

/// One column: times in ascending order, with their values.
#[derive(Clone, Debug, PartialEq)]
pub struct DataColumn {
    /// Its name in the header.
    pub name: String,
    /// Times from the earliest value of all columns that were wanted; each is later than the one
    /// before.
    pub times: Vec<f64>,
    /// Values: temperatures in degrees, displacements in metres, inputs in SI units.
    pub values: Vec<f64>,
    /// The unit of an input in the file; empty if not given.
    pub unit: &'static str,
    /// The averaging time of each value, ending at its time; 0 for instantaneous values.
    pub averaged: f64,
    /// The option that leaves out the outlier that was kept, if there is one.
    pub mark: Option<String>,
}

/// Largest number that a measurement may hold, as a value or as a time: far beyond any temperature,
/// displacement or date in seconds, and small enough for sums of squares.
pub(super) const LARGEST_MEASURED: f64 = 1e15;

/// Whether all values are equal, or too close for any sensor to distinguish and for their squares
/// to be represented.
pub fn is_constant(values: &[f64]) -> bool {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
    high - low < 1.0 / LARGEST_MEASURED
}

/// What to do if a column cannot be used: leave out its outlier with this option, or the other
/// remedy.
pub fn remedy(mark: Option<&str>, otherwise: &str) -> String {
    match mark {
        Some(mark) => format!("leave out its outliers with {mark}, or {otherwise}"),
        None => otherwise.into(),
    }
}

/// The first sample, as its time and its value, that is not finite or is too large for a
/// measurement. A file with such a sample is refused when it is read.
pub fn absurd(times: &[f64], values: &[f64]) -> Option<(f64, f64)> {
    let is_sound = |x: f64| x.abs() <= LARGEST_MEASURED;
    let mut samples = times.iter().copied().zip(values.iter().copied());
    samples.find(|(time, value)| !(is_sound(*time) && is_sound(*value)))
}

/// Parts of messages about an input without a unit, and about an invalid cell of an input.
pub(super) const AS_IT_IS: &str =
    "SI units (no unit given; `unit = \"g\"` converts, `unit = \"none\"` confirms)";
pub(super) const NOT_REPAIRED: &str =
    "correct the cell; values of an input are not repaired or left out";

/// A column being read: its unit, and its samples so far.
pub(super) struct Column<'a> {
    name: String,
    wanted: &'a Wanted<'a>,
    /// The unit, if it is known.
    unit: Option<InputUnit>,
    /// The unit that the first header gives, also if another one was given.
    stated: Option<InputUnit>,
    /// The unit of the cells, if a second header has changed it.
    changed: Option<InputUnit>,
    /// Time, value in the unit, and the place of the row.
    pub samples: Vec<(f64, f64, u32)>,
    averaged: f64,
    mark: Option<String>,
    said: ColumnRepairs,
}

/// Absolute zero in the unit in which its number is lowest, degrees Fahrenheit.
const COLDEST: f64 = -459.67;

impl<'a> Column<'a> {
    /// A column with the given unit, or that in its name.
    pub fn of(name: &str, wanted: &'a Wanted<'a>) -> Result<Self, ProblemAndRemedy> {
        let named = unit::of_name(wanted.quantity, name);
        let unit = match wanted.unit {
            Some(given) => Some(wanted.quantity.unit(given).ok_or_else(|| {
                (
                    format!("unknown unit `{given}`"),
                    format!("give {}", wanted.quantity.units()),
                )
            })?),
            None => named.clone()?,
        };
        if let (Some(given), Ok(Some(_))) = (wanted.unit, &named)
            && named != Ok(unit)
        {
            return Err((
                format!("the name of column `{name}` contradicts the unit `{given}`"),
                "remove the unit, or correct the name".into(),
            ));
        }
        let said = ColumnRepairs {
            name: name.to_string(),
            ..ColumnRepairs::default()
        };
        Ok(Column {
            name: name.to_string(),
            wanted,
            unit,
            stated: named.unwrap_or_default(),
            changed: None,
            samples: Vec::new(),
            averaged: 0.0,
            mark: None,
            said,
        })
    }

    /// Take the unit from a row of units.
    pub fn take_unit(&mut self, cell: &str) -> Result<(), ProblemAndRemedy> {
        let inside = cell
            .trim()
            .trim_start_matches(['[', '('])
            .trim_end_matches([']', ')']);
        let quantity = self.wanted.quantity;
        match quantity.unit(inside) {
            Some(unit) if self.samples.is_empty() => {
                self.stated = Some(unit);
                self.adopt(unit)
            }
            Some(unit)
                if unit::of_name(quantity, &self.name).is_ok_and(|named| named.is_some()) =>
            {
                self.adopt(unit)
            }
            Some(unit) => self.change(unit),
            None if self.wanted.unit.is_some() => Ok(()),
            None if self.is_strict() && unit::is_claim(inside) => {
                let remedy = unit::unknown_unit(quantity, &self.name, inside).1;
                Err(("is an unknown unit".into(), remedy))
            }
            None if !self.is_strict() && unit::has_factor(quantity, inside) => {
                Err(unit::factor(quantity, "the unit"))
            }
            None => Ok(()),
        }
    }

    /// Take the name that a header below the first gives, with its unit.
    pub fn take_name(&mut self, name: &str) -> Result<(), ProblemAndRemedy> {
        if name == self.name {
            self.changed = None;
            return Ok(());
        }
        match unit::of_name(self.wanted.quantity, name)? {
            Some(unit) => self.change(unit),
            None => Err(other_header()),
        }
    }

    /// Take the unit of the cells below a header other than the first.
    fn change(&mut self, unit: InputUnit) -> Result<(), ProblemAndRemedy> {
        let is_fixed = self.wanted.unit.is_some() || self.is_strict();
        let is_same = self.stated.or(self.unit) == Some(unit);
        if (is_fixed || self.unit.is_none()) && !is_same {
            return Err((
                "is another unit than that of the first header".into(),
                "split the file at this line, convert one of the parts, and join them again".into(),
            ));
        }
        self.changed = Some(unit).filter(|_| !is_same);
        Ok(())
    }

    /// Take the unit that a row of units or a cell gives.
    fn adopt(&mut self, unit: InputUnit) -> Result<(), ProblemAndRemedy> {
        let known = self.changed.or(self.unit);
        let is_late = known.is_none() && !self.samples.is_empty();
        let is_given = self.wanted.unit.is_some() && !self.is_strict();
        if !is_given && (is_late || known.is_some_and(|known| unit != known)) {
            return Err((
                "has a different unit from its column".into(),
                format!("give the same unit in the name and in all cells{OR_SKIP}"),
            ));
        }
        self.unit = self.unit.or(Some(unit));
        Ok(())
    }

    /// The number in a cell such as `12.0 degC`, whose unit is taken; all of another cell.
    pub fn without_unit<'c>(&mut self, cell: &'c [u8]) -> Result<&'c [u8], ProblemAndRemedy> {
        let digits = cell
            .iter()
            .rposition(u8::is_ascii_digit)
            .map_or(0, |last| last + 1);
        if self.is_strict() || digits == 0 || digits == cell.len() {
            return Ok(cell);
        }
        let (number, rest) = cell.split_at(digits);
        let unit = std::str::from_utf8(rest)
            .ok()
            .and_then(|rest| self.wanted.quantity.unit(rest.trim()));
        match unit {
            Some(unit) => self.adopt(unit).map(|()| number),
            None => Ok(cell),
        }
    }

    /// Take back the samples of the row at this place.
    pub fn take_back(&mut self, place: u32) {
        while self.samples.pop_if(|sample| sample.2 == place).is_some() {}
    }

    /// Decide on the unit before the first value.
    pub fn settle_unit(&mut self, wording: Wording) -> Result<(), ProblemAndRemedy> {
        match self.wanted.quantity {
            _ if self.unit.is_some() => Ok(()),
            ColumnQuantity::Input => {
                self.said.assumed_unit = Some(AS_IT_IS);
                Ok(())
            }
            ColumnQuantity::Temperature => {
                self.said.assumed_unit = Some("degrees Celsius or kelvin (no unit given)");
                Ok(())
            }
            ColumnQuantity::Displacement => Err((
                format!("the name of column `{}` gives no unit", self.name),
                format!(
                    "give the unit, {}, e.g. {}, or rename the column, e.g. to `{}_mm`",
                    self.wanted.quantity.units(),
                    wording.unit(self.wanted.quantity, "mm"),
                    self.name
                ),
            )),
        }
    }

    /// Whether no repairs are allowed.
    pub fn is_strict(&self) -> bool {
        self.wanted.quantity == ColumnQuantity::Input
    }

    /// Count a cell without a value.
    pub fn miss(&mut self) -> Result<(), (&'static str, &'static str)> {
        if self.is_strict() {
            return Err(("is not a number", NOT_REPAIRED));
        }
        self.said.missing += 1;
        Ok(())
    }

    /// Take the value of a row, unless it marks a missing one.
    pub fn take(
        &mut self,
        when: f64,
        value: f64,
        place: u32,
        marks: &Marks,
    ) -> Result<(), (&'static str, &'static str)> {
        if marks.is_number(value) {
            return self.miss();
        }
        if !value.is_finite() {
            return Err((
                "is not finite",
                "correct the cell; if it marks a missing value, give MARK",
            ));
        }
        if value.abs() > LARGEST_MEASURED {
            return Err((
                "is too large for a measurement",
                "correct the cell; if it marks a missing value, give MARK",
            ));
        }
        let unit = self.changed.or(self.unit);
        let least = unit.map_or(f64::INFINITY, |unit| unit.least);
        if self.wanted.quantity == ColumnQuantity::Temperature && value < COLDEST.min(least) {
            self.said.cold += 1;
            return Ok(());
        }
        if unit.is_some() && value < least {
            return Err((
                "is below absolute zero",
                "correct the unit; if it marks a missing value, give MARK",
            ));
        }
        let value = match (&self.unit, &self.changed) {
            (Some(unit), Some(changed)) => unit.cell_of(changed, value),
            _ => value,
        };
        self.samples.push((when, value, place));
        Ok(())
    }

    /// Determine the averaging time of the values.
    fn look_for_means(&mut self, in_seconds: bool) {
        if let Some(seconds) = self.wanted.averaged {
            self.averaged = seconds as f64;
        } else if in_seconds && is_of_means(&self.name) {
            let steps = self.samples.windows(2).map(|pair| pair[1].0 - pair[0].0);
            self.averaged = median(&mut steps.collect::<Vec<f64>>());
            self.said.averaged = Some(lasting(self.averaged, true));
        }
    }

    /// Leave out the samples beyond the outlier limit of the layout; without a limit, note an
    /// outlier.
    fn look_for_outliers(&mut self, layout: &Layout, line: &dyn Fn(u32) -> u64) {
        let values: Vec<f64> = self.samples.iter().map(|sample| sample.1).collect();
        if let Some(far) = layout.outliers {
            let mut flags = spikes(&values, far).into_iter();
            self.samples.retain(|_| !flags.next().unwrap_or_default());
            self.said.outliers = (values.len() - self.samples.len()) as u64;
        } else if let Some((value, count)) = odd(&values) {
            let first = self
                .samples
                .iter()
                .find(|sample| sample.1 == value)
                .map_or(0, |sample| line(sample.2));
            let name = &self.name;
            let more = if count > 1 {
                format!(" and {} others", count - 1)
            } else {
                String::new()
            };
            let mark = layout.wording.option("missing", &value.to_string());
            let outliers = layout.wording.option("outliers", "8");
            self.said.odd = Some(format!(
                "kept the outlier `{name}` = {value} in line {first}{more}; {mark} or {outliers} leaves out \
                 invalid values"
            ));
            self.mark = Some(mark);
        }
    }

    /// The column, with times from this one on.
    pub fn finished(self, begin: f64) -> DataColumn {
        let unit = self.unit.unwrap_or(InputUnit::AS_GIVEN);
        DataColumn {
            name: self.name,
            times: self.samples.iter().map(|sample| sample.0 - begin).collect(),
            values: self
                .samples
                .iter()
                .map(|sample| unit.of(sample.1))
                .collect(),
            averaged: self.averaged,
            mark: self.mark,
            unit: unit.name,
        }
    }
}

/// The error of a second header that does not fit the first.
pub(super) fn other_header() -> ProblemAndRemedy {
    (
        "begins a second header, with other columns than the first".into(),
        "split the file at this line, and join the parts after giving them the same columns".into(),
    )
}

/// Where the samples of a column come from, and how they are read.
pub(super) struct SampleSource<'a> {
    pub file: &'a str,
    pub layout: &'a Layout,
    /// The remedy for two values at one time.
    pub twice: &'a str,
    /// The line of a row.
    pub line: &'a dyn Fn(u32) -> u64,
    pub in_seconds: bool,
}

impl SampleSource<'_> {
    /// An error at the row in this place.
    fn error(&self, place: u32, problem: String, remedy: &str) -> DataError {
        DataError::file(self.file, problem, remedy).line((self.line)(place))
    }
}

/// Sort a column, leave out repeated samples, look for outliers, and check for gaps.
pub(super) fn sorted(
    column: &mut Column<'_>,
    repairs: &mut Repairs,
    source: &SampleSource<'_>,
) -> Result<(), DataError> {
    let line = source.line;
    if column.is_strict() {
        column.check_order(source)?;
    }
    repairs.unsorted = repairs.unsorted.max(column.sort());
    if !column.is_strict() {
        repairs.repeated = repairs.repeated.max(column.leave_out_repeated(source)?);
    }
    column.check_strays(source)?;
    column.check_spacing(source)?;
    if column.is_strict() {
        let values = column.samples.iter().map(|of| (of.1, line(of.2)));
        column.said.odd = marks::likely(&column.name, values);
    } else {
        column.look_for_outliers(source.layout, line);
    }
    column.check_count(source.file)?;
    if !column.is_strict() {
        column.look_for_means(source.in_seconds);
    }
    column.check_gaps(source)?;
    repairs.columns.push(std::mem::take(&mut column.said));
    Ok(())
}

impl Column<'_> {
    /// Check that no sample is earlier than the one in the row before. Two at one time are a jump.
    fn check_order(&self, source: &SampleSource<'_>) -> Result<(), DataError> {
        let samples = &self.samples;
        let is_wrong = |i: &usize| {
            let [before, here] = [samples[i - 1].0, samples[*i].0];
            here < before || here == before && (*i == 1 || samples[i - 2].0 == here)
        };
        let Some(wrong) = (1..samples.len()).find(is_wrong) else {
            return Ok(());
        };
        let [before, here] = [samples[wrong - 1], samples[wrong]];
        let line = (source.line)(before.2);
        let problem = match here.0 < before.0 {
            true => format!("the time of this row is before that of line {line}"),
            false if wrong == 1 => "two values at the first time".to_string(),
            false => format!(
                "a third value of `{}` at the time of line {line}",
                self.name
            ),
        };
        let remedy = "sort the rows, one for each time, or two where the input jumps; rows of an input are \
                      not sorted or left out";
        Err(source.error(here.2, problem, remedy))
    }

    /// Sort the samples by time, and count those that were out of order.
    fn sort(&mut self) -> u64 {
        let mut latest = f64::NEG_INFINITY;
        let mut unsorted = 0;
        for (time, ..) in &self.samples {
            unsorted += u64::from(*time < latest);
            latest = latest.max(*time);
        }
        // The sort is stable, so samples of equal time stay in the order of their rows.
        self.samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        unsorted
    }

    /// Leave out and count repeated samples. Two values at one time are an error.
    fn leave_out_repeated(&mut self, source: &SampleSource<'_>) -> Result<u64, DataError> {
        let samples = &mut self.samples;
        if let Some([first, second]) = samples
            .windows(2)
            .find(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1)
        {
            let problem = format!(
                "line {} gives another value of `{}` at the same time as line {}",
                (source.line)(second.2),
                self.name,
                (source.line)(first.2)
            );
            return Err(source.error(second.2, problem, source.twice));
        }
        let all = samples.len();
        samples.dedup_by(|later, before| later.0 == before.0);
        Ok((all - samples.len()) as u64)
    }

    /// Check that few samples lie between others that are far away in the file, as those of two
    /// interleaved series do. Rows that are late by a few lines, and files joined in any order, are
    /// merely sorted.
    fn check_strays(&self, source: &SampleSource<'_>) -> Result<(), DataError> {
        let places = || self.samples.iter().map(|sample| sample.2);
        let (Some(first), Some(last)) = (places().min(), places().max()) else {
            return Ok(());
        };
        let count = self.samples.len();
        let far = LATE * f64::from(last - first) / count as f64;
        let is_far = |a: &(_, _, u32), b: &(_, _, u32)| f64::from(a.2.abs_diff(b.2)) > far;
        let is_stray = |of: &&[(f64, f64, u32)]| is_far(&of[0], &of[1]) && is_far(&of[1], &of[2]);
        let mut strays = self.samples.windows(3).filter(is_stray);
        let Some(stray) = strays.next() else {
            return Ok(());
        };
        let more = strays.count();
        if more < FEW.max(count / 1000) {
            return Ok(());
        }
        let line = |i: usize| (source.line)(stray[i].2);
        let problem = format!(
            "{} rows lie between rows from elsewhere in the file, e.g. line {} between lines {} and {} in time",
            more + 1,
            line(1),
            line(0),
            line(2)
        );
        let remedy =
            "keep the rows of one series; if a clock was set back, correct the times after it";
        Err(DataError::file(source.file, problem, remedy))
    }

    /// Check that no two samples are too close in time.
    fn check_spacing(&self, source: &SampleSource<'_>) -> Result<(), DataError> {
        let samples = &self.samples;
        let lasts = samples.last().map_or(0.0, |last| last.0 - samples[0].0);
        let mut pairs = samples.windows(2);
        let is_jump = |apart: f64| apart == 0.0 && self.is_strict();
        let is_wrong = |pair: &&[(f64, f64, u32)]| {
            let apart = pair[1].0 - pair[0].0;
            is_too_close(apart, lasts) && !is_jump(apart)
        };
        let Some([before, here]) = pairs.find(is_wrong) else {
            return Ok(());
        };
        let problem = format!(
            "the time from line {} to this one is {}, too short compared with the record, {}",
            (source.line)(before.2),
            lasting(here.0 - before.0, source.in_seconds),
            lasting(lasts, source.in_seconds)
        );
        let remedy = "remove one of the two rows, or correct its time";
        Err(source.error(here.2, problem, remedy))
    }

    /// Check that there are at least two samples.
    fn check_count(&self, file: &str) -> Result<(), DataError> {
        let count = self.samples.len();
        if count >= 2 {
            return Ok(());
        }
        let problem = format!(
            "column `{}` has {count} value{}",
            self.name,
            if count == 1 { "" } else { "s" }
        );
        let remedy = "give a column with two values or more, at different times";
        Err(DataError::file(file, problem, remedy))
    }

    /// Check that no gap is longer than permitted.
    fn check_gaps(&self, source: &SampleSource<'_>) -> Result<(), DataError> {
        let longest = self.wanted.max_gap.unwrap_or(f64::INFINITY);
        let mut pairs = self.samples.windows(2);
        let Some([before, here]) = pairs.find(|pair| pair[1].0 - pair[0].0 > longest) else {
            return Ok(());
        };
        let problem = format!(
            "no value of `{}` for {}, since line {}, longer than the permitted {}",
            self.name,
            lasting(here.0 - before.0, source.in_seconds),
            (source.line)(before.2),
            lasting(longest, source.in_seconds)
        );
        let remedy =
            "fill the gap, cut the file there, or raise `max_gap` to interpolate across it";
        Err(source.error(here.2, problem, remedy))
    }
}

/// A row is far from another one if more rows than this are between them.
const LATE: f64 = 20.0;

/// So many rows may lie between others that are far away, or one in a thousand.
const FEW: usize = 10;

/// The shortest time between two samples, as a share of the record and in all. At the end of a
/// record a double resolves 2e-16 of it.
const SHORTEST_SHARE: f64 = 1e-13;

/// Whether two samples are too close in time for a record of this length.
pub(super) fn is_too_close(apart: f64, record: f64) -> bool {
    apart < SHORTEST_SHARE * record || apart < 1.0 / LARGEST_MEASURED
}

/// Whether the name of a column says that its values are means.
fn is_of_means(name: &str) -> bool {
    let words = name.split(|c: char| !c.is_alphabetic());
    let is_mean = |word: &str| {
        let word = word.to_lowercase();
        [
            "avg", "mean", "average", "averaged", "mittel", "mw", "moyenne", "moy", "media",
            "promedio",
        ]
        .contains(&&word[..])
            || word.ends_with("mittelwert")
            || word.ends_with("mittel")
    };
    words.into_iter().any(is_mean)
}

fn lasting(time: f64, in_seconds: bool) -> String {
    match in_seconds {
        true if time >= 7200.0 => format!("{} h", short(time / 3600.0)),
        true if time >= 120.0 => format!("{} min", short(time / 60.0)),
        true => format!("{} s", short(time)),
        false => short(time),
    }
}
