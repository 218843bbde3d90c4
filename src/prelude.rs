//! What most programs need, to be imported at once.

pub use crate::engine::{Outcome, Run, RunError};
pub use crate::model::{
    Force, ForceLaw, Friction, Harmonic, InputProcess, OrnsteinUhlenbeck, Problem, Realisations,
    Rng, Series, Temperature,
};
pub use crate::scenario::Scenario;
pub use crate::scheme::{CorrectedVi, DiscreteVi, EventDriven, QuasiStatic, Scheme};
pub use crate::stats::{Estimate, Record, Statistic};
