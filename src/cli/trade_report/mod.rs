//! The report of a trade for people: pure functions of what was measured.

mod stored;
mod table;

pub use stored::{LEGEND, stored_rows, stored_table};
pub use table::table;

use std::path::Path;
use stick_slip::scenario::Scenario;
use stick_slip::stats::{Record, Statistic};
use stick_slip::study::trade::{Standing, Trade};

/// What was asked for.
pub struct AskedPrices<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The file of the scenario.
    pub path: &'a Path,
    /// The statistic that the picture shows.
    pub shown: Option<Statistic>,
}

/// The statistics that a trade measures: those that no scenario needs to ask for.
fn measured() -> impl Iterator<Item = Statistic> {
    Statistic::asked_by(&Record::NOTHING).into_iter()
}

/// The names of the statistics that no accuracy can be asked for, with the reason that they share.
pub fn without_answer(trade: &Trade) -> Vec<(String, Standing)> {
    let reasons = [Standing::Zero, Standing::NoLimit, Standing::Absent].into_iter();
    let named = reasons.map(|reason| {
        let here = measured().filter(|statistic| trade.standing(*statistic) == reason);
        (here.map(Statistic::name).collect::<Vec<_>>().join(", "), reason)
    });
    named.filter(|(names, _)| !names.is_empty()).collect()
}

/// Half the width of a 95 % interval, in standard errors.
const INTERVAL: f64 = 1.96;
