//! The file of a trade: the measurements at every rung, and the predictions for every target.

use super::StoreError;
use super::at_once::write_at_once;
use super::reader::read_kind;
use crate::dataset::trade::{TRADE_FORMAT_NAME, TRADE_FORMAT_VERSION};
use crate::dataset::{StoredTrade, trade};
use crate::engine::Provenance;
use crate::study::trade::Trade;
use std::path::Path;

/// Write a trade to `target`. Like every file it is made in the folder `NAME.partial`. With
/// `force`, an existing file of this name is replaced.
pub fn write_trade(target: &Path, header: &Provenance, trade: &Trade, force: bool) -> Result<(), StoreError> {
    write_at_once(target, header.units.clone(), force, |place| trade::write(place, header, trade))
}

/// Read a trade from its file. A file that is not one, has another format or is damaged is an error.
pub fn read_trade(path: &Path) -> Result<StoredTrade, StoreError> {
    let format = (TRADE_FORMAT_NAME, TRADE_FORMAT_VERSION);
    read_kind(path, format, |path| StoreError::Foreign { path }, trade::read)
}
