//! Comparing a finished file with what is computed again ([`crate::saved::Again`]). What it is
//! compared with depends on what can be repeated:
//!
//! ```text
//! run           rows of blocks that are simulated again; after all of them, every statistic
//! sweep         points that are simulated again
//! calibration   the fit to the record that is in the file
//! trade         what follows from its measurements; times cannot be measured twice
//! ```

use super::look::is_sealed;
use super::reader::{check_file, damaged, open};
use super::rows::some_rows;
use super::variable::read_attribute;
use super::{StoreError, seal};
use crate::dataset::{Attribute, ElementType, StoredCalibration, StoredRun, calibration, sweep, trade};
use crate::engine::Provenance;
use crate::saved::{Again, Against, BlocksAgain, Difference, Held, again};
use crate::scenario::Scenario;
use crate::stats::Units;
use crate::stats::column::FirstDifference;
use crate::study::sweep::Sweep;
use crate::study::trade::Trade;
use hdf5::{File, Result};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Attributes by which HDF5 and netCDF-4 attach coordinates to variables.
const OF_LIBRARY: [&str; 8] = [
    "CLASS",
    "NAME",
    "DIMENSION_LIST",
    "REFERENCE_LIST",
    "_Netcdf4Dimid",
    "_Netcdf4Coordinates",
    "_NCProperties",
    "_nc3_strict",
];

/// Number of values that are read at a time.
const PIECE: usize = 65_536;

impl Held for File {
    fn names(&self) -> Result<Vec<String>> {
        self.member_names()
    }

    fn attributes(&self, variable: Option<&str>) -> Result<BTreeMap<String, Attribute>> {
        let dataset = variable.map(|name| self.dataset(name)).transpose()?;
        let location: &hdf5::Location = match &dataset {
            Some(dataset) => dataset,
            None => self,
        };
        let own = location.attr_names()?.into_iter().filter(|name| !OF_LIBRARY.contains(&name.as_str()));
        own.filter_map(|name| Some(read_attribute(location, &name).transpose()?.map(|value| (name, value)))).collect()
    }

    fn length(&self, variable: &str) -> Result<Option<usize>> {
        let there = self.link_exists(variable).then(|| self.dataset(variable)).transpose()?;
        Ok(there.map(|dataset| dataset.shape().first().copied().unwrap_or(0)))
    }

    fn is_laid_out_anew(&self) -> bool {
        !matches!(is_sealed(Path::new(&self.filename())), Ok(true))
    }

    fn bare_difference(&self, dimension: &str, length: usize) -> Result<Option<FirstDifference>> {
        let dataset = self.dataset(dimension)?;
        // netCDF gives an unlimited dimension the length of its variables, which are compared.
        if self.is_laid_out_anew() && dataset.is_resizable() && dataset.size() == 0 {
            return Ok(None);
        }
        if dataset.size() != length {
            return Ok(Some((None, format!("one of {} values", dataset.size()), format!("one of {length}"))));
        }
        for start in (0..length).step_by(PIECE) {
            let piece = start..(start + PIECE).min(length);
            let nothing = vec![0_u32; piece.len()];
            let found = some_rows(&dataset, ElementType::U32, &piece)?.values().first_difference((&nothing).into());
            if let Some((at, stored, computed)) = found {
                return Ok(Some((at.map(|at| start + at), stored, computed)));
            }
        }
        Ok(None)
    }
}

/// Compare the file of a run with what this scenario gives.
pub fn verify_run(
    path: &Path,
    stored: &StoredRun,
    scenario: &Scenario,
    sample: BlocksAgain,
    threads: usize,
) -> std::result::Result<Again, StoreError> {
    again(&open(path)?, stored, scenario, sample, threads, &AtomicBool::new(false)).map_err(damaged(path))
}

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
pub fn verify_sweep(path: &Path, header: &Provenance, again: &Sweep) -> std::result::Result<Verified, StoreError> {
    verified(path, &header.units, |file| sweep::write(file, header, again))
}

/// Compare the file of a trade with this one.
pub fn verify_trade(path: &Path, header: &Provenance, again: &Trade) -> std::result::Result<Verified, StoreError> {
    verified(path, &header.units, |file| trade::write(file, header, again))
}

/// Compare the file of a calibration with this one.
pub fn verify_calibration(path: &Path, again: &StoredCalibration) -> std::result::Result<Verified, StoreError> {
    verified(path, &calibration::units(), |file| calibration::write(file, again))
}

fn verified(
    path: &Path,
    units: &Units,
    write: impl FnOnce(&mut Against<'_, File>) -> Result<()>,
) -> std::result::Result<Verified, StoreError> {
    let file = open(path)?;
    let mut against = Against::of(&file, units.clone());
    write(&mut against).and_then(|()| against.finish()).map_err(damaged(path))?;
    Ok(Verified { values: against.values(), difference: against.difference().cloned() })
}

/// The result of checking a file against its checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sealed {
    /// Size of the file in bytes.
    pub bytes: u64,
    /// Whether the file has a checksum, which is then right. It has none if another program has
    /// changed the file.
    pub has_checksum: bool,
}

/// Check all bytes of a file against its checksum, however large the file is. A wrong checksum is
/// an error.
pub fn check_bytes(path: &Path) -> std::result::Result<Sealed, StoreError> {
    check_file(path)?;
    let has_checksum = seal::check_all(path)?;
    let there = std::fs::metadata(path).map_err(|source| StoreError::NotOpened { path: path.to_owned(), source })?;
    Ok(Sealed { bytes: there.len(), has_checksum })
}
