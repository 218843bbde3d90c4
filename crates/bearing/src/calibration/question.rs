//! The question of a calibration, and why it may have no answer.

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
    /// By the paper's least-squares criterion.
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

/// The lag of steel behind the thermometer: estimated or known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Lag {
    /// It is estimated, and set to 0 unless the data clearly show a lag.
    #[default]
    Auto,
    /// It is known, in seconds.
    Known(f64),
}

/// The question of a calibration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CalibrationQuestion {
    /// How the parameters are found.
    pub method: CalibrationMethod,
    /// K_BP, if it is known; without it no force can be determined.
    pub shear_stiffness: Option<f64>,
    /// Number of starts of the least-squares search.
    pub starts: u32,
    /// The lag of steel behind the thermometer.
    pub lag: Lag,
    /// The coverage probability of the intervals.
    pub level: f64,
    /// Parameters fixed at given values instead of fitted. Those that need K_BP can be fixed only
    /// if it is known.
    pub held: Vec<Held>,
    /// The search interval of a quantity in least squares.
    pub bounds: Vec<(Quantity, [f64; 2])>,
    /// The starting point if no slips are visible.
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

    /// The same with only some quantities fitted, if any are named. The others are fixed at the
    /// values of the scenario. Fails if the scenario has no number for one of them, if K_BP is
    /// needed and missing, or if there are bounds and the method does not use them.
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

/// Why a quantity cannot be fixed or bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotHeld {
    /// The scenario has no value at which to fix it.
    #[error("{} is neither fitted nor given as a number in the scenario", .0.key())]
    NoNumber(Quantity),
    /// It can be known only together with K_BP.
    #[error("{} cannot be fixed or bounded without K_BP", .0.key())]
    TakesShearStiffness(Quantity),
    /// It applies to least squares, which were not requested.
    #[error("bounds apply to the least-squares search, which method = slips does not use")]
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
    /// No slips are visible, and no other method was requested.
    #[error("no slips are visible: too few jumps of the displacement, or too small for its noise")]
    NoSlips,
    /// No slips are visible, because the displacement follows the temperature.
    #[error(
        "no slips are visible: the displacement follows the temperature by {:.3} mm/K without jumps, and no \
         stick longer than an hour was found: the bearing moves freely, or never slips if its joint would \
         move by much more", 1e3 * .0
    )]
    MovesFreely(f64),
    /// The detected jumps are not slips of this model.
    #[error("the {jumps} jumps that were found are not the slips of a bearing: they give {}, but a bearing has {CONDITION}",
            stated(.quantity, .value))]
    NotSlips {
        /// Number of jumps.
        jumps: usize,
        /// A quantity with an unphysical value.
        quantity: Quantity,
        /// That value.
        value: f64,
    },
    /// The detected jumps are too few, or too different, to determine a bearing.
    #[error(
        "the {jumps} jumps that were found do not constrain the bearing: {impossible} of {all} \
             synthetic records like this one give impossible values; a bearing has {CONDITION}"
    )]
    Undetermined {
        /// Number of jumps.
        jumps: usize,
        /// Number of synthetic records with unphysical estimates.
        impossible: usize,
        /// Number of synthetic records.
        all: usize,
    },
    /// The interval of a friction includes zero.
    #[error(
        "the jumps that were found do not determine friction: {} is between {:.3e} and {:.3e} {}",
        quantity.symbol(), interval[0], interval[1], quantity.unit()
    )]
    NoFriction {
        /// The friction.
        quantity: Quantity,
        /// Its interval.
        interval: [f64; 2],
    },
    /// The resolution steps of the sensor may be as large as the jumps.
    #[error(
        "the resolution of the displacement is {:.3} mm, and the detected jumps are {:.3} mm: \
             slips cannot be distinguished from steps of the sensor", 1e3 * resolution, 1e3 * jump
    )]
    Coarse {
        /// The typical size of the jumps, in metres.
        jump: f64,
        /// The resolution of the readings, in metres.
        resolution: f64,
    },
    /// Least squares give no physical bearing.
    #[error("least squares give {}, but a bearing has {CONDITION}", stated(.quantity, .value))]
    NoBearing {
        /// A quantity with an unphysical value.
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
            CalibrationError::NoFriction { .. } => {
                "check the sensor for play, and the value of bearing.stiffness, without which f_s/K can be \
                 estimated; or measure for longer"
            }
            CalibrationError::MovesFreely(_) => {
                "compare this number with the free movement of the joint, beta; a bearing that moves freely \
                 has no friction that can be estimated"
            }
            CalibrationError::Undetermined { .. } | CalibrationError::NoBearing { .. } => {
                "measure for longer, until the record has tens of slips"
            }
            CalibrationError::Coarse { .. } => {
                "store the displacement with more digits, or use a sensor with a resolution of a fifth of a slip or better"
            }
            CalibrationError::NotSlips { .. } => {
                "check columns, units and K_BP; if they are right, the jumps have another cause, such as a crack that opens or a \
                 sensor that was moved"
            }
        }
    }
}

/// Default number of starts of the least-squares search.
const STARTS: u32 = 10;

/// Fewest samples of a record.
pub(super) const LEAST: usize = 200;
