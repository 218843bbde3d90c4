//! The subject of a picture (`Subject`), and a kind of figure (`Figure`).

use super::kit::Drawing;
use super::sheet::Sheet;
use super::theme::Style;
use super::words::{grouped, of_axis, of_statistic};
use stickslip::dataset::{Attribute, Dataset};
use stickslip::scenario::Scenario;
use stickslip::stats::{Statistic, Summary};
use stickslip::study::sweep::Sweep;
use stickslip::study::trade::CostCurves;

/// The path that is drawn.
#[derive(Clone, Copy, Debug)]
pub struct DrawnPath<'a> {
    /// Its scenario, which ends where the drawing does.
    pub scenario: &'a Scenario,
    /// Its number.
    pub number: u64,
    /// The time at which the drawing begins.
    pub from: f64,
}

/// What a picture shows.
#[derive(Clone, Copy, Debug)]
pub enum Subject<'a> {
    /// A path of a scenario that need not have been run.
    Path(DrawnPath<'a>),
    /// A run.
    Run {
        /// The scenario that was run.
        scenario: &'a Scenario,
        /// The results of the run.
        summary: &'a Summary,
        /// The path that is drawn.
        path: DrawnPath<'a>,
    },
    /// A trade: what accuracy costs.
    Trade(&'a CostCurves),
    /// Sweeps: statistics as functions of keys.
    Sweep {
        /// Sweeps over the same key, each with the name of its file.
        sweeps: &'a [(String, Sweep)],
        /// The statistics to draw. If the list is empty, a default selection is drawn.
        statistics: &'a [Statistic],
    },
    /// Another data set, whose figures know what is in it.
    Dataset(&'a Dataset),
}

/// The statistics of a sweep that are drawn unless others are named: the first two that exist and
/// are not zero everywhere.
const USUAL: [Statistic; 4] = [
    Statistic::StickDurationMean,
    Statistic::SubPhasesMultipleShare,
    Statistic::StickingFraction,
    Statistic::SlidingPathRate,
];

/// The statistics that are drawn: those that are named or, if none is, two of the usual ones.
fn named_or_usual(named: &[Statistic], sweeps: &[(String, Sweep)]) -> Vec<Statistic> {
    let is_seen = |statistic: &Statistic| {
        let points = sweeps.iter().flat_map(|(_, sweep)| &sweep.points).flatten();
        let estimates = points.filter_map(|point| point.estimates.get(statistic.index()));
        estimates
            .map(|e| e.estimate)
            .any(|x| x.is_finite() && x != 0.0)
    };
    let usual = USUAL
        .into_iter()
        .filter(is_seen)
        .take(2)
        .collect::<Vec<_>>();
    match (named, &usual[..]) {
        ([], []) => vec![USUAL[0]],
        ([], _) => usual,
        _ => named.to_vec(),
    }
}

/// Sweeps with the names of their files, and the statistics to draw.
type Sweeps<'a> = (&'a [(String, Sweep)], Vec<Statistic>);

impl<'a> Subject<'a> {
    /// A heading, and a line that says what the numbers come from.
    pub(super) fn heading(&self, style: &Style) -> (String, String) {
        let origin =
            |scenario: &Scenario| format!("{}, seed {}", scenario.scheme, scenario.ensemble.seed);
        match self {
            Subject::Path(DrawnPath {
                scenario, number, ..
            }) => (
                scenario.title.clone(),
                format!("{}, path {number}", origin(scenario)),
            ),
            Subject::Run {
                scenario,
                summary,
                path,
            } => {
                let paths = counted(summary.completed_paths);
                let number = path.number;
                (
                    scenario.title.clone(),
                    format!("{}, {paths}; path {number} is drawn", origin(scenario)),
                )
            }
            Subject::Trade(costs) => {
                let origin = format!(
                    "biases against {}, seed {}",
                    costs.reference.replace("--", ""),
                    costs.seed
                );
                (costs.title.clone(), origin.replace("scheme ", ""))
            }
            Subject::Sweep { sweeps, statistics } => {
                let all: Vec<&Scenario> = sweeps
                    .iter()
                    .map(|(_, sweep)| &sweep.question.scenario)
                    .collect();
                let Some((_, first)) = sweeps.first() else {
                    return Default::default();
                };
                let drawn: Vec<String> = named_or_usual(statistics, sweeps)
                    .iter()
                    .map(|statistic| of_statistic(*statistic, style).words())
                    .collect();
                let keys: Vec<String> = first
                    .question
                    .design
                    .axes()
                    .iter()
                    .map(|axis| of_axis(axis, style).words())
                    .collect();
                let over = match keys.is_empty() {
                    true => "Elasticities".to_string(),
                    false => format!("Sweep over {}", keys.join(" and ")),
                };
                let line = format!(
                    "{}; otherwise as in \"{}\"",
                    origin_of_sweeps(&all),
                    first.question.scenario.title
                );
                (format!("{over}: {}", drawn.join(", ")), line)
            }
            Subject::Dataset(dataset) => (text(dataset, "title").to_string(), String::new()),
        }
    }

    /// The path that is drawn.
    pub(super) fn path(&self) -> Result<DrawnPath<'a>, Absent> {
        match self {
            Subject::Path(path) | Subject::Run { path, .. } => Ok(*path),
            _ => Err(Absent::Elsewhere("a scenario or the result of a run")),
        }
    }

    /// The scenario and the results of a run.
    pub(super) fn run(&self) -> Result<(&'a Scenario, &'a Summary), Absent> {
        let Subject::Run {
            scenario, summary, ..
        } = self
        else {
            return Err(Absent::Elsewhere("the result of a run"));
        };
        Ok((scenario, summary))
    }

    /// The sweeps and the statistics to draw.
    pub(super) fn sweeps(&self) -> Result<Sweeps<'a>, Absent> {
        let Subject::Sweep { sweeps, statistics } = self else {
            return Err(Absent::Elsewhere("the result of a sweep"));
        };
        Ok((sweeps, named_or_usual(statistics, sweeps)))
    }

    /// Another data set and its title, if it has this format; `wanted` says which file has.
    pub fn dataset(
        &self,
        format: &str,
        wanted: &'static str,
    ) -> Result<(&'a str, &'a Dataset), Absent> {
        match self {
            Subject::Dataset(dataset) if text(dataset, "format_name") == format => {
                Ok((text(dataset, "title"), dataset))
            }
            _ => Err(Absent::Elsewhere(wanted)),
        }
    }

    /// The costs that a trade has found.
    pub(super) fn trade(&self) -> Result<&'a CostCurves, Absent> {
        let Subject::Trade(costs) = self else {
            return Err(Absent::Elsewhere("the result of a trade"));
        };
        Ok(costs)
    }
}

/// An attribute of a data set that is a text; empty if there is none.
fn text<'a>(dataset: &'a Dataset, name: &str) -> &'a str {
    match dataset.attribute(name) {
        Some(Attribute::Text(text)) => text,
        _ => "",
    }
}

/// A number of paths in words.
fn counted(paths: u64) -> String {
    format!(
        "{} path{}",
        grouped(paths),
        if paths == 1 { "" } else { "s" }
    )
}

/// What sweeps have in common, or what each of them has.
fn origin_of_sweeps(all: &[&Scenario]) -> String {
    let rest = |scenario: &&Scenario| {
        format!(
            "{} at each point, seed {}",
            counted(scenario.ensemble.paths),
            scenario.ensemble.seed
        )
    };
    let rests: Vec<String> = all.iter().map(rest).collect();
    match &rests[..] {
        // The legend names the schemes of several sweeps.
        [first, _, ..] if rests.iter().all(|other| other == first) => first.clone(),
        _ => {
            let each = all
                .iter()
                .zip(&rests)
                .map(|(scenario, rest)| format!("{}, {rest}", scenario.scheme));
            each.collect::<Vec<_>>().join("; ")
        }
    }
}

/// Why a figure cannot be drawn from a subject.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Absent {
    /// The figure shows another kind of subject, which is named.
    #[error("it needs {0}")]
    Elsewhere(&'static str),
    /// The subject lacks what the figure shows; the reason is given.
    #[error("{0}")]
    Nothing(&'static str),
    /// The figure has no panel with this letter, but those that are named.
    #[error("it has no panel {0}; panels are {1}")]
    Panel(char, String),
    /// The path with this number was lost.
    #[error("path {0} was lost: it diverged or was given up")]
    Lost(u64),
}

/// A kind of figure.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Its name on the command line.
    pub name: &'static str,
    /// The function that draws it.
    pub draws: fn(&Subject, &Style) -> Result<Sheet, Absent>,
}

impl Figure {
    /// Draws the figure by itself.
    ///
    /// # Errors
    ///
    /// [`Absent`] says why this subject has no such figure.
    pub fn draw(&self, subject: &Subject, style: &Style) -> Result<Drawing, Absent> {
        Ok((self.draws)(subject, style)?.alone(style))
    }
}
