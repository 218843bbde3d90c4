//! The file of a calibration: the measured record, the slips found in it, and the fitted model.

use super::StoreError;
use super::at_once::write_at_once;
use super::reader::{check_file, check_version, damaged, open};
use crate::dataset::calibration::{CALIBRATION_FORMAT_NAME, CALIBRATION_FORMAT_VERSION, units};
use crate::dataset::header::parse_version;
use crate::dataset::{self, StoredCalibration, read_attribute};
use std::path::Path;

/// Write a calibration to `target`. Like every file it is made in the folder `NAME.partial`. With
/// `force`, an existing file of this name is replaced.
pub fn write_calibration(target: &Path, calibration: &StoredCalibration, force: bool) -> Result<(), StoreError> {
    write_at_once(target, units(), force, |place| dataset::calibration::write(place, calibration))
}

/// Read the file of a calibration. A file that is not one, is newer than this program or is damaged
/// is an error.
pub fn read_calibration(path: &Path) -> Result<StoredCalibration, StoreError> {
    check_file(path)?;
    let file = open(path)?;
    if read_attribute::<_, String>(&file, "format_name").ok().as_deref() != Some(CALIBRATION_FORMAT_NAME) {
        return Err(StoreError::Foreign { path: path.to_owned() });
    }
    let version: String = read_attribute(&file, "format_version").map_err(damaged(path))?;
    check_version(path, parse_version(&version).unwrap_or((u32::MAX, 0)), CALIBRATION_FORMAT_VERSION)?;
    dataset::calibration::read(&file).map_err(damaged(path))
}
