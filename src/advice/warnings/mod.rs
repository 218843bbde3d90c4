//! What to know before trusting a run, in plain words.
//!
//! Each warning is a type that holds its numbers. Its condition, the function `due`, is next to the
//! sentence that it prints, and each file has the warnings of one subject. The list below makes the
//! closed set of them, and `due.rs` selects those of a scenario.

mod due;
mod file;
mod noise;
mod quasi_static;
mod question;
mod series;
mod step;

pub use file::{LargeOutput, ManyRows};
pub use noise::{
    CorrectedBias, EqualFriction, IncompleteCorrection, LargeShift, MicroSlips, StepAgainstCorridor, StickExitBias,
    Unresolved,
};
pub use quasi_static::{Creep, ForcingDuringSlip, NeverMoves};
pub use question::{FewPeriods, IdenticalPaths, ManyPeriods, NeverSlips, NoCommonPeriod, NoDilatation};
pub use series::{NoiseOverSeries, RepairedSeries};
pub use step::{AmplitudeAboveCritical, StepAgainstForcing, StepAgainstNoise, StepAgainstOscillator, StepUnstable};

use std::fmt;

/// Makes the enum of the warnings from a list of their types and names.
macro_rules! warnings {
    ($($Warning:ident = $name:literal),+ $(,)?) => {
        /// A reason why the results of a scenario may not be what they seem to be.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Warning {
            $(#[doc = concat!("[`", stringify!($Warning), "`].")] $Warning($Warning),)+
        }

        impl Warning {
            /// The names of all warnings.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// The name of the warning, for programs.
            pub fn name(&self) -> &'static str {
                match self { $(Warning::$Warning(_) => $name,)+ }
            }
        }

        /// The warning in a sentence or two, for people.
        impl fmt::Display for Warning {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self { $(Warning::$Warning(warning) => warning.fmt(f),)+ }
            }
        }

        $(impl From<$Warning> for Warning {
            fn from(warning: $Warning) -> Self {
                Warning::$Warning(warning)
            }
        })+
    };
}

warnings! {
    StepUnstable = "step-unstable",
    AmplitudeAboveCritical = "amplitude-above-critical",
    StepAgainstOscillator = "step-against-oscillator",
    StepAgainstForcing = "step-against-forcing",
    StepAgainstNoise = "step-against-noise",
    StepAgainstCorridor = "step-against-corridor",
    EqualFriction = "equal-friction",
    StickExitBias = "stick-exit-bias",
    MicroSlips = "micro-slips",
    CorrectedBias = "corrected-bias",
    LargeShift = "large-shift",
    IncompleteCorrection = "incomplete-correction",
    Unresolved = "resolution",
    ForcingDuringSlip = "forcing-during-slip",
    Creep = "creep",
    NeverMoves = "never-moves",
    NeverSlips = "never-slips",
    IdenticalPaths = "identical-paths",
    NoDilatation = "no-dilatation",
    NoiseOverSeries = "weather-twice",
    RepairedSeries = "repaired-series",
    FewPeriods = "few-periods",
    ManyPeriods = "many-periods",
    NoCommonPeriod = "no-common-period",
    ManyRows = "many-rows",
    LargeOutput = "large-output",
}
