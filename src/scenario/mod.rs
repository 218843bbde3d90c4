//! A scenario: one physical question as plain data, the consistency checks of its values, and its
//! ensemble.
//!
//! ```text
//! Scenario   title, Problem, Bearing, Time, Scheme, Statistics, Ensemble, Record, Units
//! time       duration and output grid, and whether they go with a scheme's step
//! check      whether all values are consistent
//! plan       the ensemble of a scenario, and the simulations that estimate its discretisation bias
//! white      white noise as a fast Ornstein-Uhlenbeck process
//! sensor     how a sensor at the bearing sees the body
//! written    how a text spells a scenario: parameters, white noise, files of measured values
//! bridge     the parts of a scenario that a study of measurements needs: a BridgeScene
//! limits     the largest number of paths, rows, steps and periods
//! ```
//!
//! [`crate::config`] reads a scenario from a file; [`crate::advice`] derives numbers and warnings
//! from it before it is run.

#[cfg(test)]
#[path = "tests/arbitrary.rs"]
pub(crate) mod arbitrary;
#[cfg(feature = "toml")]
mod bridge;
pub(crate) mod build;
pub(crate) mod check;
mod limits;
mod plan;
mod random;
mod sensor;
pub(crate) mod time;
#[cfg(not(feature = "toml"))]
mod unwritten;
#[cfg(feature = "toml")]
mod white;
#[cfg(feature = "toml")]
mod written;

#[cfg(feature = "toml")]
pub use bridge::BridgeScene;
pub use limits::{MAX_PATHS, MAX_PERIODS, MAX_PHASE, MAX_ROWS, MAX_STEPS, MAX_TRAJECTORIES};
pub use plan::{Period, PeriodSource};
pub use sensor::SensorBearing;
pub use time::Time;
#[cfg(feature = "toml")]
pub use white::WhiteNoise;
#[cfg(feature = "toml")]
pub use written::{AsWritten, Measured, WrittenForce};

pub use crate::stats::Units;

use crate::model::Problem;
use crate::scheme::Scheme;
use crate::stats::Record;

/// The table of a measured temperature.
pub const TEMPERATURE_SERIES: &str = "temperature.series";

/// The prefix of the table of an input, before its name.
pub const INPUT: &str = "input.";

/// A scenario. Scenarios read from files are checked: every number is finite and in range. After a
/// change in memory, call [`Scenario::check`].
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The question of the scenario, one line.
    pub title: String,
    /// Oscillator, friction, temperature and x(0).
    pub model: Problem,
    /// The sensor at the bearing, if there is one.
    pub bearing: Option<SensorBearing>,
    /// Duration and output grid.
    pub time: Time,
    /// The scheme, with its step or its tolerance.
    pub scheme: Scheme,
    /// Which part of a path the statistics count.
    pub statistics: Statistics,
    /// Number of paths, seed, and whether paths are antithetic.
    pub ensemble: Ensemble,
    /// What is recorded of single paths.
    pub record: Record,
    /// Labels of the units. They appear in tables and attributes but do not affect the computation.
    pub units: Units,
    /// How the text of the scenario spells it, if it was read from a text.
    #[cfg(feature = "toml")]
    pub written: AsWritten,
}

/// Which part of a path the statistics count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// The time from which the statistics count: 0 <= after < t_end, or 0. The time before it is a
    /// burn-in, in which the motion forgets its initial state.
    pub after: f64,
    /// P, the time between the instants at which x is compared, if the scenario gives it
    /// ([`Scenario::period`]).
    pub period: Option<f64>,
}

/// Number of paths, seed, and whether paths are antithetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ensemble {
    /// Number of paths.
    pub paths: u64,
    /// Seed. Together with the number of a path it determines the noise of that path.
    pub seed: u64,
    /// Whether path 2k + 1 sees the mirror image of the noise of path 2k. Such a pair then counts
    /// as one sample in every interval.
    pub antithetic: bool,
}
