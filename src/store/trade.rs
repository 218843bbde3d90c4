//! The file of a trade: the measurements at every rung, and the predictions for every target.

use super::StoreError;
use super::at_once::write_at_once;
use super::reader::read_from;
use crate::dataset::trade::{self, Cheapest};
use crate::dataset::{read_other_program, series};
use crate::engine::Provenance;
use crate::model::Series;
use crate::scenario::Scenario;
use crate::stats::Statistic;
use crate::study::trade::{Prices, Trade};
use std::path::Path;
use std::sync::Arc;

/// Write a trade to `target`. Like every file it is made in the folder `NAME.partial`. With
/// `force`, an existing file of this name is replaced.
pub fn write_trade(target: &Path, header: &Provenance, trade: &Trade, force: bool) -> Result<(), StoreError> {
    write_at_once(target, header.units.clone(), force, |place| trade::write(place, header, trade))
}

/// The cheapest runs that a trade has found, and the scenario that it was made with.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredTrade {
    /// The title of the scenario.
    pub title: String,
    /// The resolved scenario.
    pub scenario_text: String,
    /// The measured temperature of the scenario, if there is one.
    pub series: Option<Arc<Series>>,
    /// The program that wrote the trade, if it was another one.
    pub other_program: Option<String>,
    /// One entry for each statistic and each target, in the order of the file.
    pub cheapest: Vec<Cheapest>,
}

/// Read what a trade has found from its file.
pub fn read_trade(path: &Path) -> Result<StoredTrade, StoreError> {
    read_from(path, |file| {
        let (title, scenario_text) = trade::read_origin(file)?;
        Ok(StoredTrade {
            title,
            scenario_text,
            series: series::read(file)?,
            other_program: read_other_program(file)?,
            cheapest: trade::read_cheapest(file)?,
        })
    })
}

/// Read the measurements of a trade of this scenario, from which everything else in its file
/// follows.
pub fn read_rungs(path: &Path, scenario: &Scenario) -> Result<Trade, StoreError> {
    read_from(path, |file| trade::read(file, scenario))
}

/// Read the prices of accuracy from the file of a trade: those of `statistic`, or of the first
/// statistic that has any. A file without them is an error.
pub fn read_prices(path: &Path, statistic: Option<Statistic>) -> Result<Prices, StoreError> {
    read_from(path, |file| {
        let found = trade::find_prices(file, statistic)?;
        found.ok_or_else(|| "no statistic in it has prices".into())
    })
}
