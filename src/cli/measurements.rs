//! Reads the measured columns of a bearing that a scenario names.

use super::{Failure, note, results};
use std::path::{Path, PathBuf};
use stick_slip::bearing::calibration::MeasuredRecord;
use stick_slip::data::{BearingData, DataError, Origin, Repairs, TimeColumn, Wanted};
use stick_slip::scenario::BridgeScene;

/// The column of times that a scenario names, and its time zone.
pub fn time(scene: &BridgeScene) -> TimeColumn<'_> {
    TimeColumn { name: &scene.time, zone: scene.zone.as_deref() }
}

/// Says on standard error what was repaired in a file.
pub fn note_repairs(path: &Path, repairs: &Repairs) {
    for sentence in repairs.sentences() {
        note(&format!("{}: {sentence}", path.display()));
    }
}

/// The files and columns with the measurements of a bearing.
#[derive(Debug, clap::Args)]
pub struct Source {
    /// The measurement, a CSV file with times, temperatures and displacements
    #[arg(value_name = "DATA.csv")]
    pub data: PathBuf,
    /// The temperatures, if they are in a file of their own
    #[arg(long, value_name = "FILE.csv")]
    temperature: Option<PathBuf>,
    /// The column of displacements [default: the one whose name begins with `displacement`]
    #[arg(long, value_name = "COLUMN")]
    displacement: Option<String>,
    /// The unit of displacements, if the name of their column does not say it: m, cm, mm or um
    #[arg(long, value_name = "U")]
    unit: Option<String>,
}

impl Source {
    /// All files that a study of these measurements is made from: they, a scenario, and the
    /// temperatures that it names.
    pub fn inputs(&self, scenario: &Path, scene: &BridgeScene) -> Vec<PathBuf> {
        let named = results::with_series(scenario, scene.file.as_deref());
        std::iter::once(&self.data).chain(&self.temperature).cloned().chain(named).collect()
    }

    /// Reads temperatures and displacements. Repairs are noted on standard error.
    pub fn record(&self, scene: &BridgeScene) -> Result<MeasuredRecord, Failure> {
        let wanted = [
            Wanted::temperature(scene.value.as_deref()),
            Wanted::displacement(self.displacement.as_deref(), self.unit.as_deref()),
        ];
        let temperatures = self.temperature.as_deref().map(Origin::File);
        let BearingData { temperature, displacement, repairs } =
            BearingData::read(Origin::File(&self.data), temperatures, time(scene), wanted)?;
        repairs.iter().for_each(|sentence| note(sentence));
        Ok(MeasuredRecord::of([&temperature.times, &temperature.values], [&displacement.times, &displacement.values]))
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Failure::Refused(error.to_string())
    }
}
