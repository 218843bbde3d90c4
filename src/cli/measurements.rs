//! Reads the measured columns of a bearing that flags and a scenario name.

use super::{Failure, note};
use std::path::{Path, PathBuf};
use stick_slip::bearing::calibration::MeasuredRecord;
use stick_slip::config::{Override, input_files};
use stick_slip::data::{BearingData, ColumnSource, DataError, DateOrder, Layout, Origin, Repairs, Wording};
use stick_slip::scenario::BridgeScene;

/// Says on standard error what was repaired in a file.
pub fn note_repairs(path: &Path, repairs: &Repairs) {
    for sentence in repairs.sentences() {
        note(&format!("{}: {sentence}", path.display()));
    }
}

/// How a file is laid out, as far as it does not say so itself.
#[derive(Debug, clap::Args)]
pub struct LayoutFlags {
    /// The column of times, or those of dates and times of day, or years, days of the year and hours,
    /// with commas between them [default: those with usual names, such as time or Date/Time]
    #[arg(long, value_name = "COLUMN[,COLUMN]")]
    time: Option<String>,
    /// The time zone of times, where neither they nor their column name one, e.g. UTC or Europe/Paris
    #[arg(long, value_name = "ZONE", allow_hyphen_values = true)]
    zone: Option<String>,
    /// The order of year, month and day in dates [default: the year first, or the order in which
    /// all of them are dates and the rows in order]
    #[arg(long, value_name = "ymd|dmy|mdy", value_parser = dates)]
    dates: Option<DateOrder>,
    /// Number of lines before the names of the columns [default: up to the first line with the
    /// names that are wanted]
    #[arg(long, value_name = "N")]
    skip: Option<u64>,
    /// Numbers and words that mark a missing value, besides the usual ones
    #[arg(long, value_name = "MARK,MARK", value_delimiter = ',', allow_hyphen_values = true)]
    missing: Vec<String>,
    /// Leave out values that differ from those around them by more than so many standard
    /// deviations of such differences, e.g. 8 [default: none is left out]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    outliers: Option<u64>,
    /// The decimal mark of numbers [default: what all of them together tell]
    #[arg(long, value_name = "MARK", value_parser = [".", ","])]
    decimal: Option<String>,
    /// The time before its stamp over which each value is a mean, e.g. 10min, or 0 for instantaneous
    /// values [default: what the name of its column says, e.g. Air_Avg]
    #[arg(long, value_name = "TIME", value_parser = averaged)]
    averaged: Option<u64>,
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
    #[arg(long, value_name = "ymd|dmy|mdy", value_parser = dates, requires = "temperature_file")]
    temperature_dates: Option<DateOrder>,
    /// Number of lines before the names of the columns in that file [default: as --skip]
    #[arg(long, value_name = "N", requires = "temperature_file")]
    temperature_skip: Option<u64>,
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
    #[arg(long, value_name = "TIME", value_parser = averaged)]
    temperature_averaged: Option<u64>,
}

impl LayoutFlags {
    /// The layout with these flags, and elsewhere as a scenario says.
    pub fn over(&self, scenario: &Layout) -> Layout {
        let LayoutFlags { time, zone, dates, skip, missing, outliers, decimal, averaged } = self;
        let (time, zone, missing) = (time.clone(), zone.clone(), missing.clone());
        let decimal = decimal.as_ref().and_then(|mark| mark.chars().next());
        let wording = Wording::Flag;
        Layout {
            time,
            zone,
            dates: *dates,
            skip: *skip,
            missing,
            outliers: *outliers,
            decimal,
            averaged: *averaged,
            wording,
        }
        .over(scenario)
    }
}

impl TemperatureLayoutFlags {
    fn over(&self, other: &Layout) -> Layout {
        let TemperatureLayoutFlags {
            temperature_time,
            temperature_zone,
            temperature_dates,
            temperature_skip,
            temperature_missing,
            temperature_averaged,
        } = self;
        Layout {
            time: temperature_time.clone(),
            zone: temperature_zone.clone(),
            dates: *temperature_dates,
            skip: *temperature_skip,
            missing: temperature_missing.clone(),
            averaged: *temperature_averaged,
            wording: Wording::TemperatureFlag,
            ..Layout::default()
        }
        .over(other)
    }
}

fn averaged(text: &str) -> Result<u64, String> {
    let seconds = if text.trim() == "0" { Some(0.0) } else { stick_slip::data::seconds(text) };
    seconds.map(|seconds| seconds as u64).ok_or_else(|| "write a time such as 10min or 1h, or 0".to_string())
}

fn dates(word: &str) -> Result<DateOrder, String> {
    DateOrder::from_word(word).ok_or_else(|| "write ymd, dmy or mdy".to_string())
}

/// The columns and the layout of the files with the measurements of a bearing.
#[derive(Debug, clap::Args)]
pub struct Source {
    /// The measurement, a CSV file with times, temperatures and displacements [default: the
    /// files of the scenario, under displacement.series and temperature.series]
    #[arg(value_name = "DATA.csv")]
    data: Option<PathBuf>,
    /// The temperatures, if they are in a file of their own
    #[arg(long, value_name = "FILE.csv", requires = "data")]
    temperature_file: Option<PathBuf>,
    /// The column of temperatures [default: the one whose name begins with `temperature`]
    #[arg(long, value_name = "COLUMN")]
    temperature: Option<String>,
    /// The unit of temperatures, if the file does not say it: degC, K, degF or degR
    #[arg(long, value_name = "U")]
    temperature_unit: Option<String>,
    /// The column of displacements [default: the one whose name begins with `displacement`]
    #[arg(long, value_name = "COLUMN")]
    displacement: Option<String>,
    /// The unit of displacements, if the file does not say it: m, cm, mm or um
    #[arg(long, value_name = "U")]
    displacement_unit: Option<String>,
    #[command(flatten)]
    layout: LayoutFlags,
    #[command(flatten)]
    of_temperatures: TemperatureLayoutFlags,
}

impl Source {
    /// The file that messages name.
    pub fn shown(&self) -> &Path {
        self.data.as_deref().unwrap_or(Path::new("the measurement"))
    }

    /// All files that a study of these measurements is made from: they, a scenario, and the
    /// measurements that it names.
    pub fn inputs(&self, scenario: &Path, set: &[Override]) -> Vec<PathBuf> {
        self.data.iter().chain(&self.temperature_file).cloned().chain(input_files(scenario, set)).collect()
    }

    /// Reads temperatures and displacements. Repairs are noted on standard error.
    pub fn record(&self, scenario: &Path, scene: &BridgeScene) -> Result<MeasuredRecord, Failure> {
        let displacement = ColumnSource {
            file: scene.displacement_source.file.clone(),
            column: self.displacement.clone().or_else(|| scene.displacement_source.column.clone()),
            unit: self.displacement_unit.clone().or_else(|| scene.displacement_source.unit.clone()),
            layout: self.layout.over(&scene.displacement_source.layout),
        };
        let temperature = ColumnSource {
            file: scene.temperature_source.file.clone(),
            column: self.temperature.clone().or_else(|| scene.temperature_source.column.clone()),
            unit: self.temperature_unit.clone().or_else(|| scene.temperature_source.unit.clone()),
            layout: self.of_temperatures.over(&self.layout.over(&scene.temperature_source.layout)),
        };
        let (data, temperatures) = match &self.data {
            Some(data) => (data.clone(), self.temperature_file.clone()),
            None => files_of(scenario, &displacement, &temperature)?,
        };
        let origin = temperatures.as_deref().map(Origin::File);
        let measured = BearingData::read(Origin::File(&data), origin, &temperature, &displacement)?;
        measured.repairs.iter().for_each(|sentence| note(sentence));
        Ok(MeasuredRecord::from(&measured))
    }
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
