//! The file of a calibration: the measured record, the slips found in it, and the fitted model.

use super::StoreError;
use super::at_once::write_at_once;
use super::reader::read_kind;
use crate::dataset::calibration::{CALIBRATION_FORMAT_NAME, CALIBRATION_FORMAT_VERSION, units};
use crate::dataset::{self, StoredCalibration};
use std::path::Path;

/// Write a calibration to `target`. Like every file it is made in the folder `NAME.partial`. With
/// `force`, an existing file of this name is replaced.
pub fn write_calibration(target: &Path, calibration: &StoredCalibration, force: bool) -> Result<(), StoreError> {
    write_at_once(target, units(), force, |place| dataset::calibration::write(place, calibration))
}

/// Read the file of a calibration. A file that is not one, has another format or is damaged is an
/// error.
pub fn read_calibration(path: &Path) -> Result<StoredCalibration, StoreError> {
    let format = (CALIBRATION_FORMAT_NAME, CALIBRATION_FORMAT_VERSION);
    read_kind(path, format, |path| StoreError::Foreign { path }, dataset::calibration::read)
}
