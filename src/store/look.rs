//! Looking through a file that nobody vouches for.

use super::read_back::sum_of;
use super::reader::{self, check_is_hdf5, damaged, open};
use super::variable::read_attribute;
use super::{StoreError, read_calibration, read_prices, read_sweep, read_trade, seal};
use crate::dataset::Kind;
use hdf5::types::VarLenUnicode;
use std::path::Path;

/// Whether a file has a checksum, right or wrong; its readers compare it. A file that another
/// program has changed has none. A file that is not an HDF5 file is an error.
pub fn is_sealed(path: &Path) -> Result<bool, StoreError> {
    check_is_hdf5(path)?;
    seal::is_there(path).map_err(|source| StoreError::NotOpened { path: path.to_owned(), source })
}

/// Read everything in a file, as its readers do and then variable by variable, and forget it.
///
/// HDF5 may crash or loop for ever while it reads a file that was changed on purpose. This function
/// is for a process that may end that way, so that another one is spared.
pub fn look_through(path: &Path) -> Result<(), StoreError> {
    // A reader that refuses the file has read as much of it as it would for a verb.
    let _ = reader::read(path);
    let _ = read_sweep(path);
    let _ = read_calibration(path);
    let _ = read_trade(path);
    let _ = read_prices(path, None);
    let file = open(path)?;
    let look = || -> hdf5::Result<()> {
        for name in file.attr_names()? {
            read_attribute(&file, &name)?;
        }
        for name in file.member_names()? {
            let Ok(dataset) = file.dataset(&name) else { continue };
            for name in dataset.attr_names()? {
                let _ = read_attribute(&dataset, &name);
            }
            let values = dataset.dtype()?;
            let kind = match () {
                () if values.is::<f64>() => Kind::F64,
                () if values.is::<u64>() => Kind::U64,
                () if values.is::<u32>() => Kind::U32,
                () if values.is::<i8>() => Kind::I8,
                () if values.is::<u8>() => Kind::U8,
                () if values.is::<VarLenUnicode>() => Kind::Text,
                () => continue,
            };
            // No reader reads more values than the file has bytes.
            if dataset.size() as u64 <= file.size() {
                sum_of(&dataset, kind)?;
            }
        }
        Ok(())
    };
    look().map_err(damaged(path))
}
