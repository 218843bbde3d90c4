//! A force as the user wrote it.

use crate::model::{Expression, Oscillator};

/// A user-defined force as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenForce {
    /// The expression, with its parameters.
    pub expression: Expression,
    /// The body as written, if the force is linear: the force is then part of the stiffness and
    /// damping of the model.
    pub without: Option<Oscillator>,
}
