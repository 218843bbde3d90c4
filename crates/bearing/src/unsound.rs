//! Samples of a record that no study can use.

use stickslip_data::{absurd, is_constant};

/// The error in the samples of a record.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unsound {
    /// A number or its time is not finite, or too large to compute with.
    #[error(
        "the {name} at {time:?} s is {value:?}: one of them is not finite, or too large to compute with"
    )]
    Absurd {
        /// What was measured.
        name: &'static str,
        /// The time of the sample.
        time: f64,
        /// Its value.
        value: f64,
    },
    /// All values are the same.
    #[error("the {0} is the same in all samples")]
    Constant(&'static str),
}

/// The remedy for a sensor that shows only one value.
pub const SEE_SENSOR: &str = "check that it is the right column and that its sensor works";

impl Unsound {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Unsound::Absurd { .. } => "fix the sample, or remove it",
            Unsound::Constant(_) => SEE_SENSOR,
        }
    }

    /// An error if one of these samples is absurd.
    pub(super) fn absurd(name: &'static str, times: &[f64], values: &[f64]) -> Result<(), Self> {
        absurd(times, values).map_or(Ok(()), |(time, value)| {
            Err(Unsound::Absurd { name, time, value })
        })
    }

    /// An error if these values are all the same.
    pub(super) fn constant(name: &'static str, values: &[f64]) -> Result<(), Self> {
        if is_constant(values) {
            Err(Unsound::Constant(name))
        } else {
            Ok(())
        }
    }
}
