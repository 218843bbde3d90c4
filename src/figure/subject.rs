//! What a picture is of, and what a figure is.

use super::kit::Scene;
use super::theme::Style;
use crate::scenario::Scenario;
use crate::stats::{Statistic, Summary};
use crate::study::calibration::Calibration;
use crate::study::sweep::Sweep;
use crate::study::trade::Prices;

/// What a picture is of.
#[derive(Clone, Copy, Debug)]
pub enum Subject<'a> {
    /// A scenario that need not have been run: one of its paths can be drawn.
    Scenario {
        /// Which.
        scenario: &'a Scenario,
        /// Number of the path.
        path: u64,
    },
    /// A run.
    Run {
        /// What was run.
        scenario: &'a Scenario,
        /// What came out.
        summary: &'a Summary,
        /// Number of the path that is drawn.
        path: u64,
    },
    /// What accuracy costs.
    Trade(&'a Prices),
    /// Statistics as functions of keys.
    Sweep {
        /// Sweeps over one key, each with the name of its file.
        sweeps: &'a [(String, &'a Sweep)],
        /// The statistics that are drawn; some, if there is none.
        statistics: &'a [Statistic],
    },
    /// Parameters from a measurement.
    Calibration {
        /// What it is about, in a line.
        title: &'a str,
        /// The result.
        calibration: &'a Calibration,
    },
}

/// Sweeps with the names of their files, and statistics.
type Sweeps<'a> = (&'a [(String, &'a Sweep)], &'a [Statistic]);

impl<'a> Subject<'a> {
    /// The scenario and the path of it that can be drawn.
    pub(super) fn path(&self) -> Result<(&'a Scenario, u64), Absent> {
        match self {
            Subject::Scenario { scenario, path } | Subject::Run { scenario, path, .. } => Ok((scenario, *path)),
            Subject::Trade(_) | Subject::Sweep { .. } | Subject::Calibration { .. } => {
                Err(Absent::Elsewhere("a scenario or a file of `mc run`"))
            }
        }
    }

    /// The run and what it was of.
    pub(super) fn run(&self) -> Result<(&'a Scenario, &'a Summary), Absent> {
        match self {
            Subject::Run { scenario, summary, .. } => Ok((scenario, summary)),
            _ => Err(Absent::Elsewhere("a file of `mc run`")),
        }
    }

    /// The sweeps.
    pub(super) fn sweeps(&self) -> Result<Sweeps<'a>, Absent> {
        match self {
            Subject::Sweep { sweeps, statistics } => Ok((sweeps, statistics)),
            _ => Err(Absent::Elsewhere("a file of `mc sweep`")),
        }
    }

    /// The calibration and what it is about.
    pub(super) fn calibration(&self) -> Result<(&'a str, &'a Calibration), Absent> {
        match self {
            Subject::Calibration { title, calibration } => Ok((title, calibration)),
            _ => Err(Absent::Elsewhere("a file of `mc calibrate`")),
        }
    }

    /// The trade.
    pub(super) fn trade(&self) -> Result<&'a Prices, Absent> {
        match self {
            Subject::Trade(prices) => Ok(prices),
            _ => Err(Absent::Elsewhere("a file of `mc trade`")),
        }
    }
}

/// Why there is no such figure of a subject.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Absent {
    /// It is a figure of something else.
    #[error("it is drawn from {0}")]
    Elsewhere(&'static str),
    /// There is nothing to draw.
    #[error("{0}")]
    Nothing(&'static str),
    /// The path was lost.
    #[error("path {0} was lost: it diverged or was given up")]
    Lost(u64),
}

/// A kind of figure.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    /// How it is drawn.
    pub(super) draws: fn(&Subject, &Style) -> Result<Scene, Absent>,
}

impl Figure {
    /// Draw it.
    pub fn draw(&self, subject: &Subject, style: &Style) -> Result<Scene, Absent> {
        (self.draws)(subject, style)
    }
}
