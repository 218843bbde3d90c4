//! Measured columns of a bearing, as a scenario names them.

use super::failure::{Failure, note};
use std::path::{Path, PathBuf};
use stick_slip::data::{DataError, Origin, Pair, Repairs, TimeColumn, Wanted};
use stick_slip::scenario::BridgeScene;
use stick_slip::study::calibration::Record;

/// The column of times of a scenario.
pub fn time(scene: &BridgeScene) -> TimeColumn<'_> {
    TimeColumn { name: &scene.time, zone: scene.zone.as_deref() }
}

/// Say what was repaired in a file.
pub fn note_repairs(path: &Path, repairs: &Repairs) {
    for sentence in repairs.sentences() {
        note(&format!("{}: {sentence}", path.display()));
    }
}

/// Where a record of a bearing is.
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
    /// The files that a result is made from.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        std::iter::once(self.data.as_path()).chain(self.temperature.as_deref())
    }

    /// The record, in the columns that a scenario names.
    pub fn record(&self, scene: &BridgeScene) -> Result<Record, Failure> {
        let wanted = [
            Wanted::temperature(scene.value.as_deref()),
            Wanted::displacement(self.displacement.as_deref(), self.unit.as_deref()),
        ];
        let temperatures = self.temperature.as_deref().map(Origin::File);
        let Pair { temperature, displacement, repairs } =
            Pair::read(Origin::File(&self.data), temperatures, time(scene), wanted)?;
        repairs.iter().for_each(|sentence| note(sentence));
        Ok(Record::of([&temperature.times, &temperature.values], [&displacement.times, &displacement.values]))
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Failure::Refused(error.to_string())
    }
}
