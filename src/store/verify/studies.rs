//! The files of studies against what was computed again.

use super::Difference;
use super::against::Against;
use crate::dataset::{self, StoredCalibration, sweep, trade};
use crate::engine::Provenance;
use crate::stats::Units;
use crate::store::StoreError;
use crate::store::reader::damaged;
use crate::study::sweep::Sweep;
use crate::study::trade::Trade;
use std::path::Path;

/// What the comparison of a whole data set came to.
#[derive(Clone, Debug)]
pub struct Verified {
    /// Number of values and texts that were compared.
    pub values: u64,
    /// The first difference, if there is one.
    pub difference: Option<Difference>,
}

/// Compare the file of a sweep with this one. Points that are not simulated again are those of the
/// file.
pub fn verify_sweep(path: &Path, header: &Provenance, again: &Sweep) -> Result<Verified, StoreError> {
    verified(path, &header.units, |file| sweep::write(file, header, again))
}

/// Compare the file of a trade with this one.
pub fn verify_trade(path: &Path, header: &Provenance, again: &Trade) -> Result<Verified, StoreError> {
    verified(path, &header.units, |file| trade::write(file, header, again))
}

/// Compare the file of a calibration with this one.
pub fn verify_calibration(path: &Path, again: &StoredCalibration) -> Result<Verified, StoreError> {
    verified(path, &dataset::calibration::units(), |file| dataset::calibration::write(file, again))
}

fn verified(
    path: &Path,
    units: &Units,
    write: impl FnOnce(&mut Against) -> hdf5::Result<()>,
) -> Result<Verified, StoreError> {
    let mut file = Against::open(path, units.clone())?;
    write(&mut file).and_then(|()| file.finish()).map_err(damaged(path))?;
    Ok(Verified { values: file.values(), difference: file.difference().cloned() })
}
