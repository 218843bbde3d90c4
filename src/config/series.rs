//! The samples of `[temperature.series]` and of `[input]`, from the file that a table names or from
//! where they are stored.

use super::error::Diagnostic;
use super::fields::Fields;
use super::keys::{self, Key};
use super::random;
use super::source::{MeasuredFrom, Place, Sources};
use super::tree::SECONDS;
use crate::model::{OwnProcess, RandomInput, RandomProcess, Realisations, Series};
use crate::scenario::{INPUT, Measured, TEMPERATURE_SERIES};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stickslip_data::{
    ColumnQuantity, ColumnSource, DataColumn, DataError, DateOrder, Layout, Name, Origin, Table,
    Wanted, input_unit,
};

/// The longest time between two temperatures, in seconds, if a scenario gives none: six hours.
const DEFAULT_MAX_GAP: f64 = 21_600.0;

/// Read `[temperature.series]`, if it is there.
pub(super) fn temperature(
    sources: &Sources<'_>,
    root: &Fields<'_>,
) -> Result<Option<Measured>, Box<Diagnostic>> {
    let place = root.table("temperature").table_if_present("series");
    let reader = Reader {
        sources,
        root,
        name: TEMPERATURE_SERIES.into(),
        quantity: ColumnQuantity::Temperature,
    };
    match (reader.given(), place) {
        (Some(given), _) => Ok(Some(given)),
        (None, Some(table)) => reader.measured(&table).map(Some),
        (None, None) => Ok(None),
    }
}

/// Read the tables of `[input]`, each with its place. `others` are measured as well.
pub(super) fn inputs(
    sources: &Sources<'_>,
    root: &Fields<'_>,
    others: &[Measured],
) -> Vec<(Measured, Option<Place>)> {
    let reader = |name: String| Reader {
        sources,
        root,
        name,
        quantity: ColumnQuantity::Input,
    };
    let mut found: Vec<(Measured, Option<Place>)> = Vec::new();
    for (name, table) in root.named_tables(keys::INPUT.name) {
        let reader = reader(format!("{INPUT}{name}"));
        let read = reader.given().map_or_else(|| reader.measured(&table), Ok);
        let measured = sources
            .or_report(read)
            .unwrap_or_else(|| reader.in_memory(Arc::new(Series::nothing())));
        let starts = others.iter().chain(found.iter().map(|(other, _)| other));
        let start_of = |of: &Measured| of.start.clone().filter(|_| of.start != measured.start);
        let other = starts
            .filter(|_| measured.start.is_some())
            .find_map(|of| Some((start_of(of)?, &of.table)));
        if let (Some((other, table_of)), Some(start)) = (other, &measured.start) {
            let problem = format!(
                "begins at {start}, but `{table_of}` begins at {other}; both must begin at t = 0"
            );
            sources.report(
                sources
                    .diagnostic(table.place, problem, "cut the files to a common start")
                    .of(&reader.name),
            );
        }
        found.push((measured, table.place));
    }
    if let MeasuredFrom::Given(given, random) = sources.measured_from {
        let names = given.iter().map(|given| &given.name);
        let names = names.chain(random.iter().map(|random| &random.name));
        let is_new = |name: &&String| {
            name.starts_with(INPUT) && found.iter().all(|(other, _)| other.table != **name)
        };
        let new: Vec<&String> = names.filter(is_new).collect();
        let given = new
            .into_iter()
            .filter_map(|name| Some((reader(name.clone()).given()?, None)));
        found.extend(given.collect::<Vec<_>>());
    }
    found
}

/// The source of measured values according to a table; missing keys of the layout are taken from
/// another table, if there is one.
pub(super) fn source(table: &Fields<'_>, value: Key, other: Option<&ColumnSource>) -> ColumnSource {
    let given = Layout {
        time: table.column_if_present(keys::SERIES_TIME),
        zone: table.line_if_present(keys::ZONE),
        dates: table
            .word(keys::DATES, &DateOrder::WORDS.map(|(word, _)| word))
            .and_then(DateOrder::from_word),
        skip: table.whole_if_present(keys::SKIP, 0..=1_000_000),
        decimal: table
            .word(keys::DECIMAL, &[".", ","])
            .and_then(|mark| mark.chars().next()),
        missing: table.marks(keys::MISSING),
        skip_bad: table.flag_or(keys::SKIP_BAD, false),
        outliers: table.whole_if_present(keys::OUTLIERS, 1..=1_000_000),
        averaged: table
            .span_if_present(keys::AVERAGED)
            .map(|seconds| seconds as u64),
        step: table.number_if_present(keys::SAMPLE_STEP),
        ..Layout::default()
    };
    ColumnSource {
        file: table.line_if_present(keys::FILE),
        column: table.column_if_present(value),
        unit: table.line_if_present(keys::UNIT),
        layout: other.map_or(given.clone(), |other| given.over(&other.layout)),
    }
}

/// Reads one table.
struct Reader<'a> {
    sources: &'a Sources<'a>,
    root: &'a Fields<'a>,
    /// The dotted name of the table.
    name: String,
    quantity: ColumnQuantity,
}

impl Reader<'_> {
    fn is_input(&self) -> bool {
        self.quantity == ColumnQuantity::Input
    }

    /// The default name of a column: the quantity, or the input.
    fn word(&self) -> &str {
        self.name
            .strip_prefix(INPUT)
            .unwrap_or(self.quantity.word())
    }

    /// Values that replace those of the table, if any.
    fn given(&self) -> Option<Measured> {
        let MeasuredFrom::Given(given, random) = self.sources.measured_from else {
            return None;
        };
        if let Some(given) = given.iter().find(|given| given.name == self.name) {
            return Some(self.in_memory(given.series.clone()));
        }
        let random = random.iter().find(|random| random.name == self.name)?;
        Some(self.drawn(random.clone()))
    }

    /// The description of values that each path draws.
    fn drawn(&self, random: RandomInput) -> Measured {
        Measured {
            random: Some(random),
            ..self.in_memory(Arc::new(Series::nothing()))
        }
    }

    /// Read the process of the table.
    fn process(&self, table: &Fields<'_>) -> Result<Measured, Box<Diagnostic>> {
        let parameters = self.root.numbers(keys::PARAMETERS).into_iter();
        let parameters: Vec<_> = parameters.map(|(name, value, _)| (name, value)).collect();
        let process = random::process_of(table);
        let has_file = [random::SPECTRUM, Realisations::OF_FILE]
            .map(Some)
            .contains(&process);
        let measured = match has_file {
            true => self.file_of(table)?,
            false => self.in_memory(Arc::new(Series::nothing())),
        };
        let file = has_file.then_some(&measured);
        let random = random::random_input(self.sources, table, &self.name, file, &parameters);
        // An invalid process was reported.
        Ok(Measured { random, ..measured })
    }

    /// The description of values that come from memory and not from a file.
    fn in_memory(&self, series: Arc<Series>) -> Measured {
        Measured {
            table: self.name.clone(),
            series,
            file: "memory".into(),
            value: self.word().into(),
            unit: None,
            begin: 0.0,
            layout: Layout::timed("time"),
            max_gap: None,
            start: None,
            is_held: false,
            repairs: Vec::new(),
            random: None,
        }
    }

    /// Read the table.
    fn measured(&self, table: &Fields<'_>) -> Result<Measured, Box<Diagnostic>> {
        match random::is_process(table) {
            true => self.process(table),
            false => self.file_of(table),
        }
    }

    /// Read the values in the file that the table names.
    fn file_of(&self, table: &Fields<'_>) -> Result<Measured, Box<Diagnostic>> {
        let sources = self.sources;
        let (value, example) = match self.is_input() {
            true => (
                keys::COLUMN,
                "add `file = \"quake.csv\"`: a CSV file with columns of times and of values, or AT2",
            ),
            false => (
                keys::VALUE,
                "add `file = \"t.csv\"`: a CSV file with a column of times and one of temperatures",
            ),
        };
        let ColumnSource {
            file,
            mut column,
            unit,
            mut layout,
        } = source(table, value, None);
        let process = random::process_of(table);
        if process.is_some() {
            // A step is that of the samples, not one of the file.
            layout.step = None;
        }
        if process == Some(random::SPECTRUM) {
            layout.time.get_or_insert("frequency".into());
            column.get_or_insert("density".into());
        }
        let mut measured = Measured {
            file: file.unwrap_or_default(),
            value: column.unwrap_or_default(),
            unit,
            layout,
            max_gap: if self.is_input() {
                None
            } else {
                table.span_if_present(keys::MAX_GAP)
            },
            is_held: self.is_input()
                && table.word(keys::INTERPOLATION, &["linear", "constant"]) == Some("constant"),
            // If the samples are read from a file, this is overwritten with their first stamp.
            start: table.line_if_present(keys::START),
            ..self.in_memory(Arc::new(Series::nothing()))
        };
        let place = table.place_of("file");
        if measured.file.is_empty() {
            return Err(table.missing_text(keys::FILE, example));
        }
        let hash = table.line_or(keys::HASH, "");
        let is_override = sources.is_override(place);
        // The files that a sweep sets are stored under the key and the file.
        let stored_name = match is_override {
            true => format!("{}.file={}", self.name, measured.file),
            false => self.name.clone(),
        };
        let stored = match sources.measured_from {
            MeasuredFrom::Stored(stored) => stored.iter().find(|stored| stored.name == stored_name),
            _ => None,
        };
        match stored {
            Some(stored) => measured.series = stored.series.clone(),
            None => self.read(table, &mut measured)?,
        }
        if process == Some(Realisations::OF_FILE) {
            let is_reused = table.flag_or(keys::REUSE, false);
            let all = Realisations::unpacked(&measured.series, is_reused);
            let damaged = |_| {
                let problem = "holds no realisations";
                self.sources
                    .diagnostic(place, problem, "give the file of the run")
            };
            measured.random = Some(RandomInput {
                name: self.name.clone(),
                process: RandomProcess::Own(OwnProcess(Arc::new(all.map_err(damaged)?))),
                step: 1.0,
                envelope: None,
            });
        }
        let found = format!("{:016x}", measured.series.fingerprint());
        if !hash.is_empty() && !is_override && hash != found {
            let problem = format!(
                "the samples differ from those of `{}.hash` = \"{hash}\" (hash now {found})",
                self.name
            );
            let remedy = "restore the file, or remove `hash` to accept the new samples";
            return Err(sources.diagnostic(table.place_of("hash"), problem, remedy));
        }
        Ok(measured)
    }

    /// Read the samples from the file, and complete their description.
    fn read(&self, table: &Fields<'_>, measured: &mut Measured) -> Result<(), Box<Diagnostic>> {
        let place = table.place_of("file");
        let file = measured.file.clone();
        let diagnostic = |(problem, remedy): Wrong| {
            let diagnostic = self.sources.diagnostic(place, problem, remedy);
            diagnostic
                .of(&format!("{}.file", self.name))
                .value(format!("\"{file}\""))
        };
        let is_every = random::process_of(table) == Some(Realisations::OF_FILE);
        let found = self.table(place, measured, is_every).map_err(diagnostic)?;
        self.check_seconds(&found).map_err(diagnostic)?;
        let Table {
            start,
            begin,
            time,
            columns,
            mut repairs,
            ..
        } = found;
        // What was repaired in one of many columns is said of the first alone.
        repairs.columns.truncate(1);
        let packed = match is_every {
            true => Some(packed(&columns).map_err(diagnostic)?),
            false => None,
        };
        let Some(column) = columns.into_iter().next() else {
            return Err(diagnostic((
                format!("has no {} column", self.quantity.word()),
                "name one".into(),
            )));
        };
        self.check_unit(column.unit).map_err(diagnostic)?;
        let series = match measured.is_held {
            true => Series::held(&column.times, &column.values),
            false => Series::with_jumps(column.times, column.values),
        };
        let series = series.map_err(|e| diagnostic((e.to_string(), "fix the file".into())))?;
        let series = match random::process_of(table) {
            Some(random::SPECTRUM) => from_zero(&series, begin),
            _ => packed.unwrap_or(series),
        };
        *measured = Measured {
            series: Arc::new(series),
            value: column.name,
            unit: if self.is_input() {
                Some(column.unit.into()).filter(|unit: &String| !unit.is_empty())
            } else {
                measured.unit.clone()
            },
            begin,
            layout: Layout {
                time: Some(time).filter(|name| !name.is_empty()),
                ..measured.layout.clone()
            },
            start: start.map(|start| start.to_string()),
            repairs: repairs.sentences(),
            ..measured.clone()
        };
        Ok(())
    }

    /// The table in the file, with every column if so, and the limit of its gaps if it is the
    /// default.
    fn table(
        &self,
        place: Option<Place>,
        measured: &mut Measured,
        is_every: bool,
    ) -> Result<Table, Wrong> {
        let sources = self.sources;
        let text = sources
            .data(&measured.file)
            .filter(|_| !sources.is_override(place));
        let path = sources.path_of(&measured.file, place);
        // Where the path of a missing file is sought.
        let missing = match sources.is_override(place) {
            _ if text.is_some() || path.exists() => None,
            true => Some("give the path of a file, relative to the current directory"),
            false => Some("give the path of a file, relative to the folder of the scenario"),
        };
        let columns = |measured: &Measured| {
            let column = Some(measured.value.as_str()).filter(|name| !name.is_empty());
            let wanted =
                Wanted::called(self.quantity, column, self.word(), measured.unit.as_deref());
            let column = match is_every {
                true => Name::Every,
                false => wanted.column,
            };
            let wanted = [Wanted {
                max_gap: measured.max_gap,
                column,
                ..wanted
            }];
            match text {
                Some(text) => Origin::Text(&measured.file, text).read(&measured.layout, &wanted),
                None => Origin::File(&path).read(&measured.layout, &wanted),
            }
            .map_err(|error| unusable(error, missing))
        };
        let found = columns(measured)?;
        if measured.max_gap.is_some() || !found.in_seconds || self.is_input() {
            return Ok(found);
        }
        // Only now are times known to be in seconds. The file is read again with the default limit,
        // so that a longer gap is reported with its line.
        measured.max_gap = Some(DEFAULT_MAX_GAP);
        columns(measured)
    }

    fn label(&self, key: Key) -> String {
        self.root.table("units").line_or(key, "")
    }

    /// Times in seconds need a scenario in seconds.
    fn check_seconds(&self, found: &Table) -> Result<(), Wrong> {
        let unit = self.label(keys::TIME_LABEL);
        if !found.in_seconds || SECONDS.contains(&unit.as_str()) {
            return Ok(());
        }
        Err((
            format!("has times in seconds, but `units.time` is \"{unit}\""),
            "write the whole scenario in seconds, and `time = \"s\"` under [units]".into(),
        ))
    }

    /// Inputs converted to SI units need a scenario in SI units.
    fn check_unit(&self, unit: &str) -> Result<(), Wrong> {
        let Some((si, _)) = input_unit(unit).filter(|(si, _)| !si.is_empty()) else {
            return Ok(());
        };
        let (key, base) = if si == "N" {
            (keys::FORCE_LABEL, "N")
        } else {
            (keys::LENGTH_LABEL, "m")
        };
        let unit = self.label(key);
        if ["", base].contains(&unit.as_str()) {
            return Ok(());
        }
        Err((
            format!(
                "is converted to {si}, but `units.{}` is \"{unit}\"",
                key.name
            ),
            format!(
                "write the whole scenario in SI units, and `{} = \"{base}\"` under [units]",
                key.name
            ),
        ))
    }
}

/// The realisations in the columns of a file, packed.
fn packed(columns: &[DataColumn]) -> Result<Series, Wrong> {
    let times = columns.first().map_or(&[][..], |column| &column.times);
    if let Some(other) = columns.iter().find(|column| column.times != times) {
        let problem = format!("lacks values of `{}`, or repeats them", other.name);
        return Err((problem, "give a value of every column in every row".into()));
    }
    let values = columns.iter().flat_map(|column| &column.values).copied();
    Realisations::new(times.to_vec(), values.collect())
        .and_then(|all| all.packed())
        .map_err(|error| (error.to_string(), "fix the file".into()))
}

/// A spectrum whose rows begin at a frequency: zero from 0 to there.
fn from_zero(series: &Series, begin: f64) -> Series {
    let shifted = series.times().iter().map(|f| f + begin);
    let lower = [0.0, begin * (1.0 - 1e-9)];
    let lower = lower.into_iter().filter(|_| begin > 0.0);
    let frequencies = lower.clone().chain(shifted).collect();
    let densities = lower.map(|_| 0.0).chain(series.values().iter().copied());
    Series::new(frequencies, densities.collect()).unwrap_or_else(|_| series.clone())
}

/// The problem with a file, and its remedy.
type Wrong = (String, String);

/// An error of a file as that of its key; `missing` is the remedy if there is no such file.
fn unusable(error: DataError, missing: Option<&str>) -> Wrong {
    let remedy = missing.map_or_else(|| error.remedy.clone(), str::to_string);
    let reported = DataError {
        remedy: String::new(),
        ..error
    }
    .to_string();
    let problem = reported.lines().next().unwrap_or_default();
    (format!("cannot be used: {problem}"), remedy)
}

impl Sources<'_> {
    /// The path of a file that is named in this place: relative to the folder of the scenario, or,
    /// in an override, to the current directory.
    pub fn path_of(&self, file: &str, place: Option<Place>) -> PathBuf {
        if self.is_override(place) {
            return PathBuf::from(file);
        }
        Path::new(self.name)
            .parent()
            .unwrap_or(Path::new(""))
            .join(file)
    }
}
