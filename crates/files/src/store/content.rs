//! What a file holds, whatever its kind.

use super::StoreError;
use super::reader::{check_file, check_seal, open, read, read_kind, unfinished};
use crate::dataset::calibration::{self, CALIBRATION_FORMAT};
use crate::dataset::header::FORMAT;
use crate::dataset::sweep::{self, SWEEP_FORMAT};
use crate::dataset::trade::{self, TRADE_FORMAT};
use crate::dataset::{
    StoredCalibration, StoredRun as Stored, StoredSweep, StoredTrade, read_attribute,
};
use std::path::Path;

/// From one list: the kinds of files, with the format of each, and the readers of their contents.
macro_rules! kinds {
    ($($(#[$doc:meta])* $Kind:ident: $format:ident, $read:ident -> $Content:ident $(= $of:path)?;)+) => {
        /// What a file of this program holds.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum FileKind {
            $($(#[$doc])* $Kind,)+
        }

        const FORMATS: &[(&str, FileKind)] = &[$(($format.0, FileKind::$Kind),)+];

        /// The content of a file of any kind.
        #[derive(Debug)]
        pub enum Content {
            $($(#[$doc])* $Kind(Box<$Content>),)+
        }

        $($(
            /// Read such a file. A file of another kind, of another format, or a damaged one, is an
            /// error.
            pub fn $read(path: &Path) -> Result<$Content, StoreError> {
                read_kind(path, $format, |file| $of(file))
            }
        )?)+

        impl FileKind {
            /// Read a file of this kind.
            pub(super) fn read(self, path: &Path) -> Result<Content, StoreError> {
                match self {
                    $(FileKind::$Kind => Ok(Content::$Kind(Box::new($read(path)?))),)+
                }
            }
        }
    };
}

kinds! {
    /// The ensemble of a run.
    Run: FORMAT, read -> Stored;
    /// A trade: the price of accuracy for each scheme.
    Trade: TRADE_FORMAT, read_trade -> StoredTrade = trade::read;
    /// A sweep: statistics as functions of keys of the scenario.
    Sweep: SWEEP_FORMAT, read_sweep -> StoredSweep = sweep::read;
    /// A calibration: parameters fitted to a measurement.
    Calibration: CALIBRATION_FORMAT, read_calibration -> StoredCalibration = calibration::read;
}

/// Check that there is a finished file of this name: every byte is that of its seal, and it can be
/// read. Whether a file without a seal was changed cannot be known.
pub(super) fn check_finished(target: &Path) -> Result<(), StoreError> {
    check_file(target)?;
    check_seal(target, u64::MAX)?;
    let kind = kind(target)?.ok_or_else(|| StoreError::NotHdf5 {
        path: target.to_owned(),
    })?;
    kind.read(target).map(drop)
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
    let format: String = read_attribute(&open(path)?, "format_name").unwrap_or_default();
    let known = FORMATS.iter().find(|(name, _)| *name == format);
    known
        .map(|(_, kind)| Some(*kind))
        .ok_or_else(|| StoreError::Foreign {
            path: path.to_owned(),
        })
}

/// The content of a file of any kind. A file that is none of these is read as a run, whose reader
/// says what is wrong with it.
pub fn content(path: &Path) -> Result<Content, StoreError> {
    kind(path)
        .ok()
        .flatten()
        .unwrap_or(FileKind::Run)
        .read(path)
}

impl Content {
    /// The program that wrote the file, if it was another one.
    pub fn other_program(&self) -> Option<String> {
        match self {
            Content::Run(run) => run.header.program.other(),
            Content::Trade(trade) => trade.other_program.clone(),
            Content::Sweep(sweep) => sweep.other_program.clone(),
            Content::Calibration(calibration) => calibration.other_program.clone(),
        }
    }

    /// The text of the scenario, and whether the file also holds the measured values that the text
    /// names.
    pub fn scenario(&self) -> (String, bool) {
        match self {
            Content::Run(run) => (
                run.header.scenario_text.clone(),
                !run.header.samples.is_empty(),
            ),
            Content::Trade(stored) => (
                stored.scenario.to_toml(),
                !stored.scenario.measured.is_empty(),
            ),
            Content::Sweep(stored) => {
                let scenario = &stored.sweep.question.scenario;
                (scenario.to_toml(), !scenario.measured.is_empty())
            }
            Content::Calibration(calibration) => (calibration.scenario_text.clone(), false),
        }
    }
}
