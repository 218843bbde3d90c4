//! A force as the user wrote it.

use crate::model::{Expression, Oscillator};

/// A user-defined force as a scenario states it.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenForce {
    /// The expression, with its parameters.
    pub expression: Expression,
    /// The body as it is written, if the force is linear: the model then has the force in its
    /// stiffness and its damping.
    pub without: Option<Oscillator>,
}
