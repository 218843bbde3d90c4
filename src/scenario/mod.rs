//! A scenario: one physical question as plain data, the consistency checks of its values, and its
//! ensemble.
//!
//! ```text
//! Scenario   title, Model, Bearing, Time, Scheme, Statistics, Ensemble, Record, Units
//! time       duration and output grid, and whether they go with a scheme's step
//! check      whether all values are consistent
//! plan       the ensemble of a scenario, and the simulations that estimate its discretisation bias
//! written    a force as the user wrote it
//! measured   measured temperatures and inputs with where they come from, and how a sensor sees the body
//! bridge     the parts of a scenario that a study of measurements needs: a BridgeScene
//! limits     the largest number of paths, rows, steps and periods
//! ```
//!
//! [`crate::config`] reads a scenario from a file; [`crate::advice`] derives numbers and warnings
//! from it before it is run.

#[cfg(test)]
#[path = "tests/arbitrary.rs"]
pub(crate) mod arbitrary;
mod bridge;
pub(crate) mod check;
mod limits;
mod measured;
mod plan;
pub(crate) mod time;
mod white;
mod written;

pub use bridge::BridgeScene;
pub use limits::{MAX_PATHS, MAX_PERIODS, MAX_PHASE, MAX_ROWS, MAX_STEPS, MAX_TRAJECTORIES};
pub use measured::{INPUT, Measured, SensorBearing, TEMPERATURE_SERIES};
pub use plan::{Period, PeriodSource};
pub use time::Time;
pub use white::WhiteNoise;
pub use written::WrittenForce;

pub use crate::stats::Units;

use crate::model::Model;
use crate::scheme::Scheme;
use crate::stats::Record;

/// A scenario. Scenarios read from files are checked: every number is finite and in range. After a
/// change in memory, call [`Scenario::check`].
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The question of the scenario, one line.
    pub title: String,
    /// Oscillator, friction, temperature and x(0).
    pub model: Model,
    /// The measured temperature, if there is one, and then the inputs.
    pub measured: Vec<Measured>,
    /// The parameters with their values, which expressions contain and numbers name.
    pub parameters: Vec<(String, f64)>,
    /// The numbers that are written as the name of a parameter: the dotted key, and the name.
    pub named: Vec<(String, String)>,
    /// Whether x(0) is given as "balanced": it is then beta E T(0), at zero spring force.
    pub is_balanced: bool,
    /// White noise, if the scenario has it; the model contains a fast noise instead.
    pub white_noise: Option<WhiteNoise>,
    /// The user-defined force as written, if there is one. A linear one is in the stiffness and the
    /// damping of the model.
    pub written_force: Option<WrittenForce>,
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
