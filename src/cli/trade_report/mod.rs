//! The report of a trade, for people and for programs: pure functions of what was measured.

mod json;
mod stored;
mod table;

pub use json::json;
pub use stored::{stored_json, stored_table};
pub use table::table;

use std::path::Path;
use std::time::Duration;
use stick_slip::scenario::Scenario;
use stick_slip::stats::Statistic;

/// What was asked for.
pub struct Asked<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The file of the scenario.
    pub path: &'a Path,
    /// The statistic that the picture shows.
    pub shown: Option<Statistic>,
    /// The time that the measurement may take.
    pub budget: Duration,
    /// The number of threads that measured.
    pub threads: usize,
}

/// Half the width of a 95 % interval, in standard errors.
const INTERVAL: f64 = 1.96;
