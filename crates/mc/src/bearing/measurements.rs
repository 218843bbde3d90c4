//! Reads the measured columns of a bearing that flags and a scenario name.

use crate::arguments::overrides::Settings;
use crate::output::numbers::parse_share_in;
use crate::{Failure, Threads, note};
use std::path::{Path, PathBuf};
use stickslip::config::{Override, ScenarioError, input_files};
use stickslip::scenario::BridgeScene;
use stickslip_bearing::calibration::MeasuredRecord;
use stickslip_data::{BearingData, ColumnSource, DataError, Origin, Wording};

/// Flags about measured temperatures and the layout of their file. Each sets a key of a scenario.
#[derive(Debug, clap::Args)]
pub struct MeasuredFlags {
    /// Column of temperatures [default: the one whose name begins with `temperature`]
    #[arg(long, value_name = "COLUMN")]
    temperature: Option<String>,
    /// Unit of the temperatures, if the file does not give it: degC, K, degF or degR
    #[arg(long, value_name = "U")]
    temperature_unit: Option<String>,
    /// Column of times, or several columns separated by commas: date and hour, or year, month, day
    /// and hour [default: columns with usual names, such as time or Date/Time]
    #[arg(long, value_name = "COLUMN[,COLUMN]")]
    time: Option<String>,
    /// Time zone, if neither the times nor their column give one, e.g. UTC or Europe/Paris
    #[arg(long, value_name = "ZONE", allow_hyphen_values = true)]
    zone: Option<String>,
    /// Order of year, month and day in dates [default: year first, or the order in which all dates
    /// are valid and the rows sorted]
    #[arg(long, value_name = "ymd|dmy|mdy")]
    dates: Option<String>,
    /// Number of lines before the header [default: up to the first line with the required names]
    #[arg(long, value_name = "N")]
    skip: Option<String>,
    /// A number or word that marks a missing value, in addition to the usual ones; repeatable
    #[arg(long, value_name = "MARK", allow_hyphen_values = true, value_parser = mark)]
    missing: Vec<String>,
    /// Leave out lines that cannot be read, such as a footer, and report how many
    #[arg(long)]
    skip_bad: bool,
    /// Leave out values that differ from their neighbours by more than this many standard
    /// deviations of such differences, e.g. 8 [default: none]
    #[arg(long, value_name = "N")]
    outliers: Option<String>,
    /// Decimal separator [default: inferred from all numbers]
    #[arg(long, value_name = "MARK")]
    decimal: Option<String>,
    /// Averaging time of each value, ending at its stamp, e.g. 10min, or 0 for instantaneous values
    /// [default: from the name of the column, e.g. Air_Avg]
    #[arg(long, value_name = "TIME")]
    averaged: Option<String>,
}

/// The same for a file of temperatures whose layout differs from that of the displacements.
#[derive(Debug, clap::Args)]
struct TemperatureLayoutFlags {
    /// Column of times in the temperature file [default: that of --time if it exists there,
    /// otherwise usual names]
    #[arg(long, value_name = "COLUMN[,COLUMN]", requires = "temperature_file")]
    temperature_time: Option<String>,
    /// Time zone of the temperature file [default: as --zone]
    #[arg(
        long,
        value_name = "ZONE",
        allow_hyphen_values = true,
        requires = "temperature_file"
    )]
    temperature_zone: Option<String>,
    /// Order of dates in the temperature file [default: that of --dates if all dates are valid in
    /// it]
    #[arg(long, value_name = "ymd|dmy|mdy", requires = "temperature_file")]
    temperature_dates: Option<String>,
    /// Number of lines before the header of that file [default: as --skip]
    #[arg(long, value_name = "N", requires = "temperature_file")]
    temperature_skip: Option<String>,
    /// A mark of missing values in the temperature file; repeatable [default: as --missing]
    #[arg(
        long,
        value_name = "MARK",
        allow_hyphen_values = true,
        value_parser = mark,
        requires = "temperature_file"
    )]
    temperature_missing: Vec<String>,
    /// Averaging time of the temperatures [default: as --averaged]
    #[arg(long, value_name = "TIME")]
    temperature_averaged: Option<String>,
}

impl MeasuredFlags {
    /// These flags as changes of the series of these quantities.
    pub fn overrides(&self, of: &[&str]) -> Vec<Override> {
        let MeasuredFlags {
            time,
            zone,
            dates,
            skip,
            missing,
            skip_bad,
            outliers,
            decimal,
            averaged,
            ..
        } = self;
        let missing = marks(missing);
        let skip_bad = skip_bad.then(|| "true".to_string());
        let layout = [
            ("time", time),
            ("zone", zone),
            ("dates", dates),
            ("skip", skip),
            ("missing", &missing),
            ("skip_bad", &skip_bad),
            ("outliers", outliers),
            ("decimal", decimal),
        ];
        let of_file = of.iter().flat_map(|of| {
            layout
                .into_iter()
                .filter_map(|(key, value)| given(of, key, key, value))
        });
        // A flag for the temperature also applies to the displacement.
        let mean = given("temperature", "averaged", "averaged", averaged);
        let column = given("temperature", "temperature", "value", &self.temperature);
        let unit = given(
            "temperature",
            "temperature-unit",
            "unit",
            &self.temperature_unit,
        );
        of_file.chain(mean).chain(column).chain(unit).collect()
    }
}

impl TemperatureLayoutFlags {
    fn overrides(&self) -> Vec<Override> {
        let missing = marks(&self.temperature_missing);
        let layout = [
            ("time", &self.temperature_time),
            ("zone", &self.temperature_zone),
            ("dates", &self.temperature_dates),
            ("skip", &self.temperature_skip),
            ("missing", &missing),
            ("averaged", &self.temperature_averaged),
        ];
        let flag = |(key, value): (&str, _)| {
            given("temperature", &format!("temperature-{key}"), key, value)
        };
        layout.into_iter().filter_map(flag).collect()
    }
}

/// Marks of missing values as TOML.
fn marks(marks: &[String]) -> Option<String> {
    (!marks.is_empty()).then(|| format!("{marks:?}"))
}

/// One mark. A comma in it is a decimal mark.
fn mark(text: &str) -> Result<String, String> {
    let is_list = text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_err();
    match is_list {
        true => Err("write --missing once for each mark".into()),
        false => Ok(text.to_string()),
    }
}

/// A flag as a change of a key of the series of a quantity.
fn given(quantity: &str, flag: &str, key: &str, value: &Option<String>) -> Option<Override> {
    let (value, flag, dotted) = (
        value.as_ref()?,
        format!("--{flag}"),
        format!("{quantity}.series.{key}"),
    );
    // A column may be named 1, and so may its unit; a duration is a number or a text.
    let is_number = ["skip", "outliers", "averaged"].contains(&key) && value.parse::<f64>().is_ok();
    Some(match is_number || ["missing", "skip_bad"].contains(&key) {
        true => Override::flag(&flag, &dotted, value),
        false => Override::text(&flag, &dotted, value),
    })
}

/// The columns and the layout of the files with the measurements of a bearing.
#[derive(Debug, clap::Args)]
pub struct Source {
    /// Scenario (TOML file): stiffness K_BP, names of the columns, and starting values
    scenario: PathBuf,
    /// Measurement, a CSV file with times, temperatures and displacements [default: the files under
    /// displacement.series and temperature.series of the scenario]
    #[arg(value_name = "DATA.csv")]
    data: Option<PathBuf>,
    /// Separate file of temperatures
    #[arg(long, value_name = "FILE.csv", requires = "data")]
    temperature_file: Option<PathBuf>,
    /// Column of displacements [default: the one whose name begins with `displacement`]
    #[arg(long, value_name = "COLUMN")]
    displacement: Option<String>,
    /// Unit of the displacements, if the file does not give it: m, cm, mm or um
    #[arg(long, value_name = "U")]
    displacement_unit: Option<String>,
    /// What the displacement sensor and its bracket show of their own expansion, in metres per kelvin,
    /// e.g. 5e-6; it is subtracted
    #[arg(long, value_name = "M/K", allow_hyphen_values = true, default_value_t = 0.0, value_parser = expansion)]
    sensor_expansion: f64,
    #[command(flatten)]
    flags: MeasuredFlags,
    #[command(flatten)]
    of_temperatures: TemperatureLayoutFlags,
    /// Confidence level of the intervals
    #[arg(long, value_name = "P", default_value_t = 0.9, value_parser = level)]
    pub interval: f64,
    #[command(flatten)]
    set: Settings,
    #[command(flatten)]
    pub threads: Threads,
}

fn level(text: &str) -> Result<f64, String> {
    parse_share_in(
        text,
        &(0.5..=0.999),
        "write a probability from 0.5 to 0.999",
    )
}

/// The largest expansion of a sensor, in metres per kelvin: that of ten metres of aluminium is half of it.
const MOST_EXPANSION: f64 = 5e-4;

fn expansion(text: &str) -> Result<f64, String> {
    let problem =
        format!("write metres per kelvin, from -{MOST_EXPANSION} to {MOST_EXPANSION}, e.g. 5e-6");
    let expansion = text
        .parse()
        .ok()
        .filter(|per_kelvin: &f64| per_kelvin.abs() <= MOST_EXPANSION);
    expansion.ok_or(problem)
}

impl Source {
    /// The file named in messages.
    pub fn shown(&self) -> &Path {
        self.data.as_deref().unwrap_or(Path::new("the measurement"))
    }

    /// The part of the scenario that a study of measurements needs, with the flags about their
    /// files. The layout of the temperatures may differ from that of the displacements.
    pub fn scene(&self) -> Result<BridgeScene, ScenarioError> {
        let mut all = self.set.list()?;
        all.extend(self.flags.overrides(&["temperature", "displacement"]));
        all.extend(given(
            "displacement",
            "displacement",
            "value",
            &self.displacement,
        ));
        all.extend(given(
            "displacement",
            "displacement-unit",
            "unit",
            &self.displacement_unit,
        ));
        let mut scene = BridgeScene::read(&self.scenario, &all)?;
        all.extend(self.of_temperatures.overrides());
        scene.temperature_source = BridgeScene::read(&self.scenario, &all)?.temperature_source;
        // The stored text includes the changes.
        let changes = self
            .set
            .list()?
            .iter()
            .map(|change| format!("{CHANGED}{change}\n"))
            .collect::<String>();
        scene.text = if changes.is_empty() {
            scene.text
        } else {
            format!("{}\n{changes}", scene.text)
        };
        scene.displacement_source.layout.wording = Wording::Flag;
        scene.temperature_source.layout.wording = Wording::TemperatureFlag;
        Ok(scene)
    }

    /// All input files of a study of these measurements, including the scenario and the files that
    /// it names.
    pub fn inputs(&self) -> Result<Vec<PathBuf>, ScenarioError> {
        let named = input_files(&self.scenario, &self.set.list()?);
        Ok(self
            .data
            .iter()
            .chain(&self.temperature_file)
            .cloned()
            .chain(named)
            .collect())
    }

    /// Reads temperatures and displacements. Repairs are noted on standard error.
    pub fn record(&self, scene: &BridgeScene) -> Result<MeasuredRecord, Failure> {
        let (displacement, temperature) = (&scene.displacement_source, &scene.temperature_source);
        let (data, temperatures) = match &self.data {
            Some(data) => (data.clone(), self.temperature_file.clone()),
            None => files_of(&self.scenario, displacement, temperature)?,
        };
        let origin = temperatures.as_deref().map(Origin::File);
        let measured = BearingData::read(Origin::File(&data), origin, temperature, displacement)?;
        measured.repairs.iter().for_each(|sentence| note(sentence));
        Ok(MeasuredRecord::from(&measured).without_expansion(self.sensor_expansion))
    }
}

/// Prefix of the lines of a stored scenario that contain changes of it.
const CHANGED: &str = "# changed by ";

/// The scenario of a study of measurements from its stored text.
pub fn scene_again(name: &str, text: &str) -> Result<BridgeScene, ScenarioError> {
    let changes = text
        .lines()
        .filter_map(|line| line.strip_prefix(CHANGED)?.strip_prefix("--set "));
    BridgeScene::parse(
        name,
        text,
        &changes.map(Override::set).collect::<Result<Vec<_>, _>>()?,
    )
}

/// The files that a scenario names: that of the displacements, and that of the temperatures if it
/// is a different one.
fn files_of(
    scenario: &Path,
    displacement: &ColumnSource,
    temperature: &ColumnSource,
) -> Result<(PathBuf, Option<PathBuf>), Failure> {
    let path = |source: &ColumnSource| source.file.as_ref().map(PathBuf::from);
    let Some(data) = path(displacement).or_else(|| path(temperature)) else {
        let problem = format!(
            "no measurement given, and {} names none",
            scenario.display()
        );
        let remedy = "give DATA.csv, or write `file = \"data.csv\"` under [displacement.series], and under [temperature.series] if the \
                      temperatures are in another file";
        return Err(Failure::usage(problem, remedy));
    };
    let other = path(temperature).filter(|file| *file != data);
    Ok((data, other))
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Failure::Refused(error.to_string())
    }
}
