//! What is asked of a record, and why there may be no answer.

use super::bearing::Bearing;
use super::hold::Held;
use super::motion::Motion;
use super::quantity::Quantity;
use super::samples::Record;
use crate::scenario::BridgeScene;

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

impl Question {
    /// What is asked of the record of a bearing, where nothing more is said: everything is fitted
    /// by both methods.
    pub fn of(scene: &BridgeScene, record: &Record) -> Self {
        let first = record.temperatures.first().copied().unwrap_or(0.0);
        Question {
            method: Method::Both,
            shear_stiffness: scene.shear_stiffness,
            starts: 10,
            lag: Lag::Auto,
            level: 0.9,
            held: Vec::new(),
            bounds: Vec::new(),
            guess: Bearing::of(scene, first).response().motion,
        }
    }

    /// The same where only some quantities are fitted, if any are named: the others are held at
    /// what the scenario says.
    pub fn fitting(self, fitted: &[Quantity], scene: &BridgeScene) -> Result<Self, NotHeld> {
        let is_held = |quantity: &Quantity| !fitted.is_empty() && !fitted.contains(quantity);
        let held = Quantity::FITTED.into_iter().filter(is_held).map(|quantity| {
            let value = match quantity {
                Quantity::Stiffness => Some(scene.stiffness),
                Quantity::Dilatation => Some(scene.dilatation),
                Quantity::Static => Some(scene.f_s),
                Quantity::Dynamic => Some(scene.f_d),
                Quantity::Offset => Some(scene.offset),
                _ => scene.displacement,
            };
            Ok((quantity, value.ok_or(NotHeld::NoNumber(quantity))?))
        });
        let held: Vec<Held> = held.collect::<Result<_, _>>()?;
        let mut told =
            held.iter().map(|(quantity, _)| *quantity).chain(self.bounds.iter().map(|(quantity, _)| *quantity));
        match told.find(|quantity| quantity.needs_shear_stiffness() && scene.shear_stiffness.is_none()) {
            Some(quantity) => Err(NotHeld::TakesShearStiffness(quantity)),
            None => Ok(Question { held, ..self }),
        }
    }
}

/// Why a quantity cannot be held or bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotHeld {
    /// The scenario does not say what it is to be held at.
    #[error("{} is left out of what is fitted, and is not a number in the scenario", .0.key())]
    NoNumber(Quantity),
    /// It is known only together with K_BP.
    #[error("{} cannot be held or bounded, because it takes K_BP to know it", .0.key())]
    TakesShearStiffness(Quantity),
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

impl CalibrationError {
    /// What to measure or look at.
    pub fn remedy(&self) -> &'static str {
        match self {
            CalibrationError::TooShort(_) => "measure for longer: weeks at least, with tens of slips",
            CalibrationError::Constant(_) => "see that it is the right column, and that its sensor works",
            CalibrationError::NoSlips => "measure for longer, until tens of slips are in the record",
        }
    }
}

/// Fewer samples than this are no record.
pub(super) const LEAST: usize = 200;
