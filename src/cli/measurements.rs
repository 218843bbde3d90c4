//! Reads the measured columns of a bearing that flags and a scenario name.

use super::numbers::parse_share_in;
use super::overrides::Settings;
use super::{Failure, Threads, note};
use std::path::{Path, PathBuf};
use stick_slip::bearing::calibration::MeasuredRecord;
use stick_slip::config::{Override, ScenarioError, input_files};
use stick_slip::data::{BearingData, ColumnSource, DataError, Origin, Wording};
use stick_slip::scenario::BridgeScene;

/// What flags say of measured temperatures, and of how a file is laid out, as far as it does not say
/// so itself: they are keys of a scenario under names of their own.
#[derive(Debug, clap::Args)]
pub struct MeasuredFlags {
    /// The column of temperatures [default: the one whose name begins with `temperature`]
    #[arg(long, value_name = "COLUMN")]
    temperature: Option<String>,
    /// The unit of temperatures, if the file does not say it: degC, K, degF or degR
    #[arg(long, value_name = "U")]
    temperature_unit: Option<String>,
    /// The column of times, or those of dates and times of day, or years, days of the year and hours,
    /// with commas between them [default: those with usual names, such as time or Date/Time]
    #[arg(long, value_name = "COLUMN[,COLUMN]")]
    time: Option<String>,
    /// The time zone of times, where neither they nor their column name one, e.g. UTC or Europe/Paris
    #[arg(long, value_name = "ZONE", allow_hyphen_values = true)]
    zone: Option<String>,
    /// The order of year, month and day in dates [default: the year first, or the order in which
    /// all of them are dates and the rows in order]
    #[arg(long, value_name = "ymd|dmy|mdy")]
    dates: Option<String>,
    /// Number of lines before the names of the columns [default: up to the first line with the
    /// names that are wanted]
    #[arg(long, value_name = "N")]
    skip: Option<String>,
    /// Numbers and words that mark a missing value, besides the usual ones
    #[arg(long, value_name = "MARK,MARK", value_delimiter = ',', allow_hyphen_values = true)]
    missing: Vec<String>,
    /// Leave out values that differ from those around them by more than so many standard
    /// deviations of such differences, e.g. 8 [default: none is left out]
    #[arg(long, value_name = "N")]
    outliers: Option<String>,
    /// The decimal mark of numbers [default: what all of them together tell]
    #[arg(long, value_name = "MARK")]
    decimal: Option<String>,
    /// The time before its stamp over which each value is a mean, e.g. 10min, or 0 for instantaneous
    /// values [default: what the name of its column says, e.g. Air_Avg]
    #[arg(long, value_name = "TIME")]
    averaged: Option<String>,
}

/// The same for a file of temperatures that is laid out otherwise than that of the displacements.
#[derive(Debug, clap::Args)]
struct TemperatureLayoutFlags {
    /// The column of times in the file of temperatures [default: as --time]
    #[arg(long, value_name = "COLUMN[,COLUMN]", requires = "temperature_file")]
    temperature_time: Option<String>,
    /// The time zone in the file of temperatures [default: as --zone]
    #[arg(long, value_name = "ZONE", allow_hyphen_values = true, requires = "temperature_file")]
    temperature_zone: Option<String>,
    /// The order of dates in the file of temperatures [default: as --dates]
    #[arg(long, value_name = "ymd|dmy|mdy", requires = "temperature_file")]
    temperature_dates: Option<String>,
    /// Number of lines before the names of the columns in that file [default: as --skip]
    #[arg(long, value_name = "N", requires = "temperature_file")]
    temperature_skip: Option<String>,
    /// Marks of missing values in the file of temperatures [default: as --missing]
    #[arg(
        long,
        value_name = "MARK,MARK",
        value_delimiter = ',',
        allow_hyphen_values = true,
        requires = "temperature_file"
    )]
    temperature_missing: Vec<String>,
    /// The same for temperatures alone [default: as --averaged]
    #[arg(long, value_name = "TIME")]
    temperature_averaged: Option<String>,
}

impl MeasuredFlags {
    /// What they say of the series of these quantities.
    pub fn overrides(&self, of: &[&str]) -> Vec<Override> {
        let MeasuredFlags { time, zone, dates, skip, missing, outliers, decimal, averaged, .. } = self;
        let missing = marks(missing);
        let layout = [
            ("time", time),
            ("zone", zone),
            ("dates", dates),
            ("skip", skip),
            ("missing", &missing),
            ("outliers", outliers),
            ("decimal", decimal),
        ];
        let of_file = of.iter().flat_map(|of| layout.into_iter().filter_map(|(key, value)| given(of, key, key, value)));
        // What the temperature says of this holds for the displacement as well.
        let mean = given("temperature", "averaged", "averaged", averaged);
        let column = given("temperature", "temperature", "value", &self.temperature);
        let unit = given("temperature", "temperature-unit", "unit", &self.temperature_unit);
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
        let flag = |(key, value): (&str, _)| given("temperature", &format!("temperature-{key}"), key, value);
        layout.into_iter().filter_map(flag).collect()
    }
}

/// Marks of missing values as TOML.
fn marks(marks: &[String]) -> Option<String> {
    (!marks.is_empty()).then(|| format!("{marks:?}"))
}

/// What a flag says of a key of the series of a quantity.
fn given(quantity: &str, flag: &str, key: &str, value: &Option<String>) -> Option<Override> {
    let (value, flag, dotted) = (value.as_ref()?, format!("--{flag}"), format!("{quantity}.series.{key}"));
    // A column may be named 1, and so may its unit; a duration is a number or a text.
    let is_number = ["skip", "outliers", "averaged"].contains(&key) && value.parse::<f64>().is_ok();
    Some(match is_number || key == "missing" {
        true => Override::flag(&flag, &dotted, value),
        false => Override::text(&flag, &dotted, value),
    })
}

/// The columns and the layout of the files with the measurements of a bearing.
#[derive(Debug, clap::Args)]
pub struct Source {
    /// The scenario, a TOML file: the stiffness K_BP, the names of the columns, and where a search
    /// begins
    scenario: PathBuf,
    /// The measurement, a CSV file with times, temperatures and displacements [default: the
    /// files of the scenario, under displacement.series and temperature.series]
    #[arg(value_name = "DATA.csv")]
    data: Option<PathBuf>,
    /// The temperatures, if they are in a file of their own
    #[arg(long, value_name = "FILE.csv", requires = "data")]
    temperature_file: Option<PathBuf>,
    /// The column of displacements [default: the one whose name begins with `displacement`]
    #[arg(long, value_name = "COLUMN")]
    displacement: Option<String>,
    /// The unit of displacements, if the file does not say it: m, cm, mm or um
    #[arg(long, value_name = "U")]
    displacement_unit: Option<String>,
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
    parse_share_in(text, &(0.5..=0.999), "write a probability from 0.5 to 0.999")
}

impl Source {
    /// The file that messages name.
    pub fn shown(&self) -> &Path {
        self.data.as_deref().unwrap_or(Path::new("the measurement"))
    }

    /// The scenario, as far as a study of measurements needs it, with what flags say of their files.
    /// The layout of the temperatures may be another one than that of the displacements.
    pub fn scene(&self) -> Result<BridgeScene, ScenarioError> {
        let mut all = self.set.list()?;
        all.extend(self.flags.overrides(&["temperature", "displacement"]));
        all.extend(given("displacement", "displacement", "value", &self.displacement));
        all.extend(given("displacement", "displacement-unit", "unit", &self.displacement_unit));
        let mut scene = BridgeScene::read(&self.scenario, &all)?;
        all.extend(self.of_temperatures.overrides());
        scene.temperature_source = BridgeScene::read(&self.scenario, &all)?.temperature_source;
        // The text that is stored holds the changes as well.
        let changes = self.set.list()?.iter().map(|change| format!("{CHANGED}{change}\n")).collect::<String>();
        scene.text = if changes.is_empty() { scene.text } else { format!("{}\n{changes}", scene.text) };
        scene.displacement_source.layout.wording = Wording::Flag;
        scene.temperature_source.layout.wording = Wording::TemperatureFlag;
        Ok(scene)
    }

    /// All files that a study of these measurements is made from: they, the scenario, and the
    /// measurements that it names.
    pub fn inputs(&self) -> Result<Vec<PathBuf>, ScenarioError> {
        let named = input_files(&self.scenario, &self.set.list()?);
        Ok(self.data.iter().chain(&self.temperature_file).cloned().chain(named).collect())
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
        Ok(MeasuredRecord::from(&measured))
    }
}

/// What a line of a stored scenario begins with that holds a change of it.
const CHANGED: &str = "# changed by ";

/// The scenario of a study of measurements from its stored text.
pub fn scene_again(name: &str, text: &str) -> Result<BridgeScene, ScenarioError> {
    let changes = text.lines().filter_map(|line| line.strip_prefix(CHANGED)?.strip_prefix("--set "));
    BridgeScene::parse(name, text, &changes.map(Override::set).collect::<Result<Vec<_>, _>>()?)
}

/// The files that a scenario names: that of the displacements, and that of the temperatures if it
/// is another one.
fn files_of(
    scenario: &Path,
    displacement: &ColumnSource,
    temperature: &ColumnSource,
) -> Result<(PathBuf, Option<PathBuf>), Failure> {
    let path = |file: &String| scenario.parent().unwrap_or(Path::new("")).join(file);
    let Some(data) = displacement.file.as_ref().or(temperature.file.as_ref()).map(path) else {
        let problem = format!("no measurement is given, and {} names none", scenario.display());
        let remedy = "give DATA.csv, or write `file = \"data.csv\"` under [displacement.series], and under [temperature.series] if the \
                      temperatures are in another file";
        return Err(Failure::usage(problem, remedy));
    };
    let other = temperature.file.as_ref().map(path).filter(|file| *file != data);
    Ok((data, other))
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Failure::Refused(error.to_string())
    }
}
