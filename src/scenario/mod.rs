//! A scenario: one physical question as plain data, its values checked together, and the ensemble
//! that answers it.
//!
//! ```text
//! Scenario   title, Model, Bearing, Time, Scheme, Statistics, Ensemble, Record, Units
//! time       duration and output grid, and whether they go with a scheme's step
//! check      whether all of it goes together
//! plan       the ensemble that answers it, and the simulations that tell the error of its step
//! measured   where a measured temperature comes from, and what a sensor shows
//! bridge     of a scenario only what a calibration needs: a BridgeScene
//! limits     how much of anything there may be
//! ```
//!
//! [`crate::config`] reads it from a file; [`crate::advice`] says what follows from it before it is
//! run.

#[cfg(test)]
pub(crate) mod arbitrary;
mod bridge;
pub(crate) mod check;
mod limits;
mod measured;
mod plan;
pub(crate) mod time;

pub use bridge::BridgeScene;
pub use limits::{MAX_PATHS, MAX_PERIODS, MAX_ROWS, MAX_STEPS, MAX_TRAJECTORIES};
pub use measured::{Bearing, Measured};
pub use time::Time;

pub use crate::stats::Units;

use crate::model::Model;
use crate::scheme::Scheme;
use crate::stats::Record;

/// A checked scenario: every number in it is finite and in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// What the scenario asks, in a line.
    pub title: String,
    /// The physics.
    pub model: Model,
    /// Where the series of the temperature comes from, if there is one.
    pub measured: Option<Measured>,
    /// Whether x(0) follows from the rest: beta E T(0), where no spring force acts.
    pub is_balanced: bool,
    /// What a sensor at the bearing shows, if there is one.
    pub bearing: Option<Bearing>,
    /// Duration and output grid.
    pub time: Time,
    /// How it is simulated.
    pub scheme: Scheme,
    /// What of a path is counted.
    pub statistics: Statistics,
    /// How many paths, from which seed.
    pub ensemble: Ensemble,
    /// What is kept of single paths.
    pub record: Record,
    /// Labels, used in tables and attributes only.
    pub units: Units,
}

/// What of a path is counted in its statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// The time from which on it is: 0 <= after < t_end, or 0. What was before is a burn-in, which
    /// lets the motion forget where it began.
    pub after: f64,
}

/// How many paths, from which seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ensemble {
    /// Number of paths.
    pub paths: u64,
    /// Seed; with the path number it determines a path.
    pub seed: u64,
    /// Whether paths 2k and 2k + 1 see the same noise and its mirror image, and the pair is the
    /// unit of every interval.
    pub antithetic: bool,
}
