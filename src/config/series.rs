//! The samples of `[temperature.series]`, from the file that it names or from where they are
//! stored.

use super::error::Fault;
use super::fields::Fields;
use super::keys;
use super::source::{GivenSamples, Sources};
use crate::data::{ColumnQuantity, ColumnSource, DataError, DateOrder, Layout, Origin, Table, Wanted};
use crate::model::Series;
use crate::scenario::Measured;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The longest time between two samples, in seconds, if a scenario gives none: six hours.
const DEFAULT_MAX_GAP: f64 = 21_600.0;

/// The labels of `units.time` that mean seconds.
const SECONDS: [&str; 5] = ["", "s", "sec", "second", "seconds"];

/// Read `[temperature.series]`, if it is there.
pub(super) fn series(sources: &Sources<'_>, root: &Fields<'_>) -> Result<Option<(Arc<Series>, Measured)>, Box<Fault>> {
    if let Some(GivenSamples::Given(samples)) = sources.samples {
        return Ok(Some((samples.clone(), in_memory())));
    }
    let Some(table) = root.table("temperature").table_if_present("series") else { return Ok(None) };
    let ColumnSource { file, column, unit, layout } = source(&table, None);
    let mut measured = Measured {
        file: file.unwrap_or_default(),
        value: column.unwrap_or_default(),
        unit,
        layout,
        max_gap: table.span_if_present(keys::MAX_GAP),
        // If the samples are read from a file, this is overwritten with their first stamp.
        start: table.line_if_present(keys::START),
        repairs: Vec::new(),
    };
    let place = table.place_of("file");
    if measured.file.is_empty() {
        let remedy = "add `file = \"t.csv\"`: a CSV file with a column of times and one of temperatures";
        return Err(table.missing_text(keys::FILE, remedy));
    }
    let hash = table.line_or(keys::HASH, "");
    let is_override = sources.is_override(place);
    let series = match sources.samples {
        Some(GivenSamples::Stored(stored)) if !is_override => stored.clone(),
        _ => Arc::new(read(sources, root, &table, &mut measured)?),
    };
    let found = format!("{:016x}", series.fingerprint());
    if !hash.is_empty() && !is_override && hash != found {
        let problem =
            format!("the samples are others than those of `temperature.series.hash` = \"{hash}\" (now {found})");
        let remedy = "give the file as it was, or remove the line `hash` to take it as it is";
        return Err(sources.fault(table.place_of("hash"), problem, remedy));
    }
    Ok(Some((series, measured)))
}

/// Where values are measured, as a table says; what it does not say of the layout is as in another
/// place, if there is one.
pub(super) fn source(table: &Fields<'_>, other: Option<&ColumnSource>) -> ColumnSource {
    let given = Layout {
        time: table.line_if_present(keys::SERIES_TIME),
        zone: table.line_if_present(keys::ZONE),
        dates: table.word(keys::DATES, &DateOrder::WORDS.map(|(word, _)| word)).and_then(DateOrder::from_word),
        skip: table.whole_if_present(keys::SKIP, 0..=1_000_000),
        decimal: table.word(keys::DECIMAL, &[".", ","]).and_then(|mark| mark.chars().next()),
        missing: table.marks(keys::MISSING),
        outliers: table.whole_if_present(keys::OUTLIERS, 1..=1_000_000),
        averaged: table.span_if_present(keys::AVERAGED).map(|seconds| seconds as u64),
        ..Layout::default()
    };
    ColumnSource {
        file: table.line_if_present(keys::FILE),
        column: table.line_if_present(keys::VALUE),
        unit: table.line_if_present(keys::UNIT),
        layout: other.map_or(given.clone(), |other| given.over(&other.layout)),
    }
}

/// The description of samples that come from memory and not from a file.
fn in_memory() -> Measured {
    Measured {
        file: "memory".into(),
        value: "temperature".into(),
        unit: None,
        layout: Layout::timed("time"),
        max_gap: None,
        start: None,
        repairs: Vec::new(),
    }
}

/// Read the samples from the file, and complete their description.
fn read(
    sources: &Sources<'_>,
    root: &Fields<'_>,
    table: &Fields<'_>,
    measured: &mut Measured,
) -> Result<Series, Box<Fault>> {
    let fault = |problem: String, remedy: String| {
        let fault = sources.fault(table.place_of("file"), problem, remedy);
        fault.of("temperature.series.file").value(format!("\"{}\"", measured.file))
    };
    let column = Some(measured.value.as_str()).filter(|name| !name.is_empty());
    let wanted = Wanted::of(ColumnQuantity::Temperature, column, measured.unit.as_deref());
    let columns = |max_gap: Option<f64>| -> Result<Table, DataError> {
        let wanted = [Wanted { max_gap, ..wanted }];
        match sources.data(&measured.file).filter(|_| !sources.is_override(table.place_of("file"))) {
            Some(text) => Origin::Text(&measured.file, text).read(&measured.layout, &wanted),
            None => Origin::File(&sources.path_of(&measured.file)).read(&measured.layout, &wanted),
        }
    };
    let cannot = |error: DataError| {
        let remedy = error.remedy.clone();
        let reported = DataError { remedy: String::new(), ..error }.to_string();
        fault(format!("cannot be used: {}", reported.lines().next().unwrap_or_default()), remedy)
    };
    let mut max_gap = measured.max_gap;
    let mut found = columns(max_gap).map_err(cannot)?;
    if max_gap.is_none() && found.in_seconds {
        // It is known only now that times are in seconds. The file is read again with the default
        // limit, so that a longer gap is an error with its line.
        max_gap = Some(DEFAULT_MAX_GAP);
        found = columns(max_gap).map_err(cannot)?;
    }
    let unit = root.table("units").line_or(keys::TIME_LABEL, "");
    if found.in_seconds && !SECONDS.contains(&unit.as_str()) {
        let problem = format!("has times in seconds, and `units.time` is \"{unit}\"");
        return Err(fault(problem, "write the whole scenario in seconds, and `time = \"s\"` under [units]".into()));
    }
    let Table { start, time, columns, repairs, .. } = found;
    let Some(column) = columns.into_iter().next() else {
        return Err(fault("has no column of temperatures".into(), "name one as `value`".into()));
    };
    let series = Series::new(column.times, column.values).map_err(|e| fault(e.to_string(), "mend the file".into()))?;
    *measured = Measured {
        value: column.name,
        layout: Layout { time: Some(time), ..measured.layout.clone() },
        max_gap,
        start: start.map(|start| start.to_string()),
        repairs: repairs.sentences(),
        ..measured.clone()
    };
    Ok(series)
}

impl Sources<'_> {
    /// The path of a file that the scenario or an override names, relative to the folder of the
    /// scenario.
    pub fn path_of(&self, file: &str) -> PathBuf {
        Path::new(self.name).parent().unwrap_or(Path::new("")).join(file)
    }
}
