//! What a picture shows (`Subject`), and a kind of figure (`Figure`).

use super::kit::Drawing;
use super::theme::Style;
use crate::bearing::calibration::Calibration;
use crate::scenario::Scenario;
use crate::stats::{Statistic, Summary};
use crate::study::sweep::Sweep;
use crate::study::trade::Prices;

/// What a picture shows.
#[derive(Clone, Copy, Debug)]
pub enum Subject<'a> {
    /// A scenario that need not have been run: one of its paths can be drawn.
    Scenario {
        /// The scenario.
        scenario: &'a Scenario,
        /// Number of the path.
        path: u64,
    },
    /// A run.
    Run {
        /// The scenario that was run.
        scenario: &'a Scenario,
        /// The results of the run.
        summary: &'a Summary,
        /// Number of the path that is drawn.
        path: u64,
    },
    /// A trade: what accuracy costs.
    Trade(&'a Prices),
    /// Sweeps: statistics as functions of keys.
    Sweep {
        /// Sweeps over the same key, each with the name of its file.
        sweeps: &'a [(String, &'a Sweep)],
        /// The statistics to draw. If the list is empty, a default selection is drawn.
        statistics: &'a [Statistic],
    },
    /// A calibration: parameters estimated from a measurement.
    Calibration {
        /// A title in one line.
        title: &'a str,
        /// The result of the calibration.
        calibration: &'a Calibration,
    },
}

/// Sweeps with the names of their files, and the statistics to draw.
type Sweeps<'a> = (&'a [(String, &'a Sweep)], &'a [Statistic]);

impl<'a> Subject<'a> {
    /// The scenario, and the number of the path that is drawn.
    pub(super) fn path(&self) -> Result<(&'a Scenario, u64), Absent> {
        match self {
            Subject::Scenario { scenario, path } | Subject::Run { scenario, path, .. } => Ok((scenario, *path)),
            _ => Err(Absent::Elsewhere("a scenario or a file of `mc run`")),
        }
    }

    /// The scenario and the results of a run.
    pub(super) fn run(&self) -> Result<(&'a Scenario, &'a Summary), Absent> {
        let Subject::Run { scenario, summary, .. } = self else { return Err(Absent::Elsewhere("a file of `mc run`")) };
        Ok((scenario, summary))
    }

    /// The sweeps and the statistics to draw.
    pub(super) fn sweeps(&self) -> Result<Sweeps<'a>, Absent> {
        let Subject::Sweep { sweeps, statistics } = self else { return Err(Absent::Elsewhere("a file of `mc sweep`")) };
        Ok((sweeps, statistics))
    }

    /// The title and the result of a calibration.
    pub(super) fn calibration(&self) -> Result<(&'a str, &'a Calibration), Absent> {
        let Subject::Calibration { title, calibration } = self else {
            return Err(Absent::Elsewhere("a file of `mc calibrate`"));
        };
        Ok((title, calibration))
    }

    /// The costs that a trade has found.
    pub(super) fn trade(&self) -> Result<&'a Prices, Absent> {
        let Subject::Trade(prices) = self else { return Err(Absent::Elsewhere("a file of `mc trade`")) };
        Ok(prices)
    }
}

/// Why a figure cannot be drawn from a subject.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Absent {
    /// The figure shows another kind of subject, which is named.
    #[error("it is drawn from {0}")]
    Elsewhere(&'static str),
    /// The subject lacks what the figure shows; the reason is given.
    #[error("{0}")]
    Nothing(&'static str),
    /// The path with this number was lost.
    #[error("path {0} was lost: it diverged or was given up")]
    Lost(u64),
}

/// A kind of figure.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it shows, in one line.
    pub shows: &'static str,
    /// The function that draws it.
    pub(super) draws: fn(&Subject, &Style) -> Result<Drawing, Absent>,
}

impl Figure {
    /// Draws the figure.
    ///
    /// # Errors
    ///
    /// [`Absent`] says why this subject has no such figure.
    pub fn draw(&self, subject: &Subject, style: &Style) -> Result<Drawing, Absent> {
        (self.draws)(subject, style)
    }
}
