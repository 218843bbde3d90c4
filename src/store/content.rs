//! What a file holds, whatever its kind.

use super::reader::{check_file, open, unfinished};
use super::{StoreError, read, read_calibration, read_sweep, read_trade};
use crate::dataset::calibration::CALIBRATION_FORMAT_NAME;
use crate::dataset::header::FORMAT_NAME;
use crate::dataset::sweep::SWEEP_FORMAT_NAME;
use crate::dataset::trade::TRADE_FORMAT_NAME;
use crate::dataset::{StoredCalibration, StoredRun as Stored, StoredSweep, StoredTrade, read_attribute};
use std::path::Path;

/// From one list: the kinds of files, with the name of the format of each, and their contents.
macro_rules! kinds {
    ($($(#[$doc:meta])* $ElementType:ident: $format:ident, $read:ident -> $Content:ident;)+) => {
        /// What a file of this program holds.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum FileKind {
            $($(#[$doc])* $ElementType,)+
        }

        const FORMATS: &[(&str, FileKind)] = &[$(($format, FileKind::$ElementType),)+];

        /// The content of a file of any kind.
        #[derive(Debug)]
        pub enum Content {
            $($(#[$doc])* $ElementType(Box<$Content>),)+
        }

        impl FileKind {
            /// Read a file of this kind.
            pub(super) fn read(self, path: &Path) -> Result<Content, StoreError> {
                match self {
                    $(FileKind::$ElementType => Ok(Content::$ElementType(Box::new($read(path)?))),)+
                }
            }
        }
    };
}

kinds! {
    /// The ensemble of a run.
    Run: FORMAT_NAME, read -> Stored;
    /// A trade: the price of accuracy for each scheme.
    Trade: TRADE_FORMAT_NAME, read_trade -> StoredTrade;
    /// A sweep: statistics as functions of keys of the scenario.
    Sweep: SWEEP_FORMAT_NAME, read_sweep -> StoredSweep;
    /// A calibration: parameters fitted to a measurement.
    Calibration: CALIBRATION_FORMAT_NAME, read_calibration -> StoredCalibration;
}

/// What kind of file this is; `None` if it cannot be opened or is not an HDF5 file. An HDF5 file of
/// another program is an error, and so is a damaged one.
pub fn kind(path: &Path) -> Result<Option<FileKind>, StoreError> {
    if unfinished(path).is_some() {
        return Ok(Some(FileKind::Run));
    }
    match check_file(path) {
        Err(StoreError::NotHdf5 { .. } | StoreError::NotOpened { .. }) => return Ok(None),
        other => other?,
    };
    let format = read_attribute::<_, String>(&open(path)?, "format_name").unwrap_or_default();
    let known = FORMATS.iter().find(|(name, _)| *name == format);
    known.map(|(_, kind)| Some(*kind)).ok_or_else(|| StoreError::Foreign { path: path.to_owned() })
}

/// The content of a file of any kind. A file that is none of these is read as a run, whose reader
/// says what is wrong with it.
pub fn content(path: &Path) -> Result<Content, StoreError> {
    kind(path).ok().flatten().unwrap_or(FileKind::Run).read(path)
}

impl Content {
    /// The text of the scenario, and whether the file also holds the measured temperature that the
    /// text names.
    pub fn scenario(&self) -> (String, bool) {
        match self {
            Content::Run(run) => (run.header.scenario_text.clone(), run.header.series.is_some()),
            Content::Trade(stored) => (stored.scenario.to_toml(), stored.scenario.measured.is_some()),
            Content::Sweep(sweep) => (sweep.scenario_text.clone(), sweep.series.is_some()),
            Content::Calibration(calibration) => (calibration.scenario_text.clone(), false),
        }
    }
}
