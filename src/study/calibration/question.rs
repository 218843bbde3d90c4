//! What is asked of a record, and why there may be no answer.

use super::hold::Held;
use super::motion::Motion;
use super::quantity::Quantity;

/// How the parameters are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// By slips.
    Slips,
    /// By the paper's least squares.
    Err,
    /// By slips, with the least squares beside it.
    Both,
}

impl Method {
    /// The word on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Method::Slips => "slips",
            Method::Err => "err",
            Method::Both => "both",
        }
    }

    /// The method of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Method::Slips, Method::Err, Method::Both].into_iter().find(|method| method.name() == name)
    }
}

/// What is known of the lag of steel behind the thermometer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lag {
    /// Nothing: it is estimated, and taken for 0 unless the data say otherwise.
    Auto,
    /// It is this, in seconds.
    Known(f64),
}

/// What is asked of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// How.
    pub method: Method,
    /// K_BP, if it is known; without it there are no forces.
    pub shear_stiffness: Option<f64>,
    /// How many starts the least squares has.
    pub starts: u32,
    /// The lag.
    pub lag: Lag,
    /// The probability with which an interval is to hold the truth.
    pub level: f64,
    /// What is given instead of fitted: parameters, and forces among them only if K_BP is known.
    pub held: Vec<Held>,
    /// Between which values the least squares looks for a quantity.
    pub bounds: Vec<(Quantity, [f64; 2])>,
    /// Where a search begins if no slip can be seen.
    pub guess: Motion,
}

/// Why nothing can be said.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// There is next to no record.
    #[error("{0} samples have a displacement and a temperature; a calibration takes at least {LEAST}")]
    TooShort(usize),
    /// T or z is one number.
    #[error("the {0} is the same in all samples")]
    Constant(&'static str),
    /// No slip, and nothing else was asked for.
    #[error("no slips are visible: too few jumps of the displacement, or too small for its noise")]
    NoSlips,
}

/// Fewer samples than this are no record.
pub(super) const LEAST: usize = 200;
