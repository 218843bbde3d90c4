//! What is asked of a record, and why there may be no answer.

use super::bearing::Response;
use super::motion::Motion;
use super::possible::CONDITION;
use super::quantity::{Held, Quantity};
use super::samples::MeasuredRecord;
use crate::Unsound;
use stickslip::scenario::BridgeScene;

/// How the parameters are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CalibrationMethod {
    /// From the slips alone.
    #[default]
    Slips,
    /// By the paper's least squares.
    Err,
    /// From the slips, and by the least squares for comparison.
    Both,
}

impl CalibrationMethod {
    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            CalibrationMethod::Slips => "slips",
            CalibrationMethod::Err => "criterion",
            CalibrationMethod::Both => "both",
        }
    }

    /// The method with this name; `err` is an earlier name of the criterion.
    pub fn from_name(name: &str) -> Option<Self> {
        let name = if name == "err" { "criterion" } else { name };
        [
            CalibrationMethod::Slips,
            CalibrationMethod::Err,
            CalibrationMethod::Both,
        ]
        .into_iter()
        .find(|method| method.name() == name)
    }
}

/// What is known of the lag of steel behind the thermometer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Lag {
    /// It is not known. It is estimated, and taken to be 0 unless the data clearly show a lag.
    #[default]
    Auto,
    /// It is known, in seconds.
    Known(f64),
}

/// What is asked of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CalibrationQuestion {
    /// How the parameters are found.
    pub method: CalibrationMethod,
    /// K_BP, if it is known; without it no force can be determined.
    pub shear_stiffness: Option<f64>,
    /// Number of starts of the least squares.
    pub starts: u32,
    /// The lag of steel behind the thermometer.
    pub lag: Lag,
    /// The coverage probability of the intervals.
    pub level: f64,
    /// Parameters that are held at given values instead of fitted. Those that need K_BP can be held
    /// only if it is known.
    pub held: Vec<Held>,
    /// The interval in which the least squares searches a quantity.
    pub bounds: Vec<(Quantity, [f64; 2])>,
    /// Where the search begins if no slips are visible.
    pub guess: Motion,
}

impl CalibrationQuestion {
    /// The default question for a bearing: all parameters are fitted, from the slips.
    pub fn of(scene: &BridgeScene, record: &MeasuredRecord) -> Self {
        let first = record.temperatures.first().copied().unwrap_or(0.0);
        CalibrationQuestion {
            method: CalibrationMethod::Slips,
            shear_stiffness: scene.shear_stiffness,
            starts: STARTS,
            lag: Lag::Auto,
            level: 0.9,
            held: Vec::new(),
            bounds: Vec::new(),
            guess: Response::of(scene, first).motion,
        }
    }

    /// The same with only some quantities fitted, if any are named. The others are held at the
    /// values of the scenario. Fails if the scenario has no number for one of them, if K_BP is needed
    /// and missing, or if there are bounds and the method does not use them.
    pub fn fitting(self, fitted: &[Quantity], scene: &BridgeScene) -> Result<Self, NotHeld> {
        if self.method == CalibrationMethod::Slips && !self.bounds.is_empty() {
            return Err(NotHeld::UnusedBounds);
        }
        let is_held = |quantity: &Quantity| !fitted.is_empty() && !fitted.contains(quantity);
        let held = Quantity::FITTED
            .into_iter()
            .filter(is_held)
            .map(|quantity| {
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
        let mut named = held
            .iter()
            .map(|(quantity, _)| *quantity)
            .chain(self.bounds.iter().map(|(quantity, _)| *quantity));
        match named
            .find(|quantity| quantity.needs_shear_stiffness() && scene.shear_stiffness.is_none())
        {
            Some(quantity) => Err(NotHeld::TakesShearStiffness(quantity)),
            None => Ok(CalibrationQuestion { held, ..self }),
        }
    }
}

/// Why a quantity cannot be held or bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotHeld {
    /// The scenario has no value at which to hold it.
    #[error("{} is not fitted, and is not a number in the scenario", .0.key())]
    NoNumber(Quantity),
    /// It can be known only together with K_BP.
    #[error("{} cannot be held or bounded without K_BP", .0.key())]
    TakesShearStiffness(Quantity),
    /// It is for the least squares, which were not asked for.
    #[error("bounds are for the least squares, and method = slips does not use them")]
    UnusedBounds,
}

/// Why a record cannot be calibrated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// The record has too few samples.
    #[error("need at least {LEAST} samples with a displacement and a temperature, got {0}")]
    TooShort(usize),
    /// The temperature or the displacement cannot be used.
    #[error(transparent)]
    Unsound(#[from] Unsound),
    /// No slips are visible, and no other method was asked for.
    #[error("no slips are visible: too few jumps of the displacement, or too small for its noise")]
    NoSlips,
    /// The jumps that were found are not slips of this model.
    #[error("the {jumps} jumps that were found are not the slips of a bearing: they give {}, and a bearing has {CONDITION}",
            stated(.quantity, .value))]
    NotSlips {
        /// Number of jumps.
        jumps: usize,
        /// A quantity that they give a value that no bearing can have.
        quantity: Quantity,
        /// That value.
        value: f64,
    },
    /// The jumps that were found are too few, or too different, to determine a bearing.
    #[error(
        "the {jumps} jumps that were found do not constrain the bearing: {impossible} of {all} synthetic records like this one \
             give impossible values, and a bearing has {CONDITION}"
    )]
    Undetermined {
        /// Number of jumps.
        jumps: usize,
        /// Number of synthetic records from which no bearing was found.
        impossible: usize,
        /// Number of synthetic records.
        all: usize,
    },
    /// The sensor shows steps that may be as large as jumps.
    #[error(
        "the displacement has a resolution of {:.3} mm, and the jumps that were found are of {:.3} mm: slips cannot be distinguished \
             from steps of the sensor", 1e3 * resolution, 1e3 * jump
    )]
    Coarse {
        /// The usual size of the jumps, in metres.
        jump: f64,
        /// The resolution of the readings, in metres.
        resolution: f64,
    },
    /// The least squares find no bearing.
    #[error("the least squares give {}, and a bearing has {CONDITION}", stated(.quantity, .value))]
    NoBearing {
        /// A quantity that they give a value that no bearing can have.
        quantity: Quantity,
        /// That value.
        value: f64,
    },
}

/// A quantity with its value and its unit.
fn stated(quantity: &Quantity, value: &f64) -> String {
    format!("{} = {value:.3e} {}", quantity.symbol(), quantity.unit())
        .trim_end_matches(" 1")
        .to_string()
}

impl CalibrationError {
    /// What the user can do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            CalibrationError::TooShort(_) => {
                "measure for longer: weeks at least, with tens of slips"
            }
            CalibrationError::Unsound(error) => error.remedy(),
            CalibrationError::NoSlips => {
                "measure for longer, until the record has tens of slips; the method `criterion` needs none, but is less accurate"
            }
            CalibrationError::Undetermined { .. } | CalibrationError::NoBearing { .. } => {
                "measure for longer, until the record has tens of slips"
            }
            CalibrationError::Coarse { .. } => {
                "store the displacement with more digits, or take a sensor whose resolution is a fifth of a slip or better"
            }
            CalibrationError::NotSlips { .. } => {
                "check columns, units and K_BP; if they are right, the jumps have another cause, such as a crack that opens or a \
                 sensor that was moved"
            }
        }
    }
}

/// Number of starts of the least squares, if no other is asked for.
const STARTS: u32 = 10;

/// Fewest samples of a record.
pub(super) const LEAST: usize = 200;
