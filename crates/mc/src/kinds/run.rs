//! Runs as results: how the commands show, draw and verify them.

use super::{Again, AnyResult, Kind, Shown, StoredResult, page, pictures};
use crate::arguments::threads::Threads;
use crate::commands::plot;
use crate::inputs::{files, results};
use crate::output::failure::{Failure, note};
use crate::output::numbers::grouped;
use crate::report::{self, Report, RunInfo, ShownStatistics};
use crate::session::progress::Progress;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use stickslip::dataset::RUN_FORMAT;
use stickslip::scenario::Scenario;
use stickslip_figure::{Drawing, DrawnPath, Subject};
use stickslip_files::saved::rerun;
use stickslip_files::store::{self, CheckedBytes, Stored};

/// The ensemble of a run.
pub const RUN: Kind = Kind {
    name: "a run",
    format: RUN_FORMAT,
    is_resumable: true,
    read: |path| Ok(Box::new(store::read(path)?)),
    figures: stickslip_figure::RUN,
};

/// Whether a file contains a run, or no results at all.
pub fn is_run(path: &Path) -> bool {
    files::read(path, super::of).map_or(true, |kind| {
        kind.is_none_or(|kind| kind.format == RUN.format)
    })
}

impl AnyResult for Stored {
    fn report(&self, file: &Path, shown: &Shown) -> Result<Report, Failure> {
        let scenario = results::scenario("scenario", self, &[]).ok();
        if let Some(scenario) = scenario.as_ref().filter(|_| shown.is_text) {
            results::warn(scenario, self.summary.has_bias(), true);
        }
        note_unfinished(self);
        let info = info(file, self, scenario.as_ref());
        Ok(report::run(&self.summary, &info, shown.chosen, shown.notes))
    }

    fn json(&self, file: &Path) -> Result<String, Failure> {
        let scenario = results::scenario("scenario", self, &[]).ok();
        if let Some(scenario) = &scenario {
            results::warn(scenario, self.summary.has_bias(), false);
        }
        note_unfinished(self);
        let warnings = results::warnings(&self.summary, scenario.as_ref());
        let info = info(file, self, scenario.as_ref());
        Ok(report::json::of_run(&self.summary, &info, &warnings))
    }

    fn page(&self, file: &Path) -> Result<String, Failure> {
        let mut page = page(file, &self.header.scenario_text);
        let scenario = results::scenario("scenario", self, &[]).ok();
        let info = info(file, self, scenario.as_ref());
        let summary = &self.summary;
        if let Some(scenario) = &scenario {
            let path = DrawnPath {
                scenario,
                number: 0,
                from: 0.0,
            };
            let subject = Subject::Run {
                scenario,
                summary,
                path,
            };
            // Its panels are in the other figures.
            page.pictures = pictures(RUN.figures, &subject, "overview");
        }
        page.words.push(("Intervals", INTERVALS.into()));
        let citation = report::citation(self).join(" ");
        page.words.push(("How to cite", citation));
        page.report = report::run(summary, &info, ShownStatistics::All, true);
        // The warnings say these.
        page.report
            .remarks
            .retain(|(label, _)| !["drift", "few"].contains(label));
        page.warnings = results::warnings(summary, scenario.as_ref())
            .into_iter()
            .map(|(_, text)| text)
            .collect();
        Ok(page.html())
    }
}

impl StoredResult for Stored {
    fn scenario(&self) -> (String, bool) {
        let header = &self.header;
        (header.scenario_text.clone(), !header.samples.is_empty())
    }

    fn other_program(&self) -> Option<String> {
        self.header.program.other()
    }

    fn draw(&self, asked: &plot::Arguments) -> Result<Drawing, Failure> {
        results::check_path(self, asked.path)?;
        let name = asked.subject.display().to_string();
        let scenario = results::scenario(&name, self, &[])?;
        let shorter = results::scenario(&name, self, &asked.window())?;
        asked.draw(&Subject::Run {
            scenario: &scenario,
            summary: &self.summary,
            path: asked.drawn(&shorter)?,
        })
    }

    fn again(
        &self,
        file: &Path,
        threads: &Threads,
        checked: CheckedBytes,
    ) -> Result<Again, Failure> {
        let name = file.display().to_string();
        if let Some(part) = self.part {
            return Err(Failure::usage(
                format!("{name}: part {part} of a run cannot be simulated again"),
                "merge the parts and verify the run",
            ));
        }
        let scenario = results::scenario(&name, self, &[])?;
        // All rows are in memory, together with the largest variable of the file.
        let used =
            scenario.run_bytes(self.header.paths, threads.number()) + 2.0 * checked.bytes as f64;
        let threads = threads.ready("this verification", used)?;
        let mut progress = Progress::new(self.completed_paths, false, None, None);
        let again = rerun(
            self,
            &scenario,
            threads,
            &AtomicBool::new(false),
            &mut progress,
        );
        progress.finish();
        let again = again?;
        Ok(Again {
            simulated: format!("{} paths", grouped(self.completed_paths)),
            compared: "rows of paths, statistics, attributes, coordinates and units",
            found: store::verify(file, &again)?,
        })
    }
}

/// The text below the statistics of a run.
const INTERVALS: &str = "Intervals are 95 % confidence intervals, with paths as independent units. Bias is \
                         the effect of the time step on the estimate; the corrected estimate is shown where \
                         the bias exceeds its uncertainty. The single path is number 0.";

fn note_unfinished(stored: &Stored) {
    if let Some(unfinished) = &stored.unfinished {
        note(&format!(
            "this run is not finished; continue it with: mc resume {}",
            unfinished.display()
        ));
    }
}

/// The facts about a run other than its statistics.
pub fn info(file: &Path, stored: &Stored, scenario: Option<&Scenario>) -> RunInfo {
    let Stored {
        header,
        status,
        part,
        ended_by,
        ..
    } = stored;
    RunInfo {
        scenario: header.title.clone(),
        provenance: header.clone(),
        part: *part,
        threads: None,
        seconds: None,
        bias_seconds: None,
        no_bias: scenario
            .and_then(|scenario| scenario.bias_plan(stored.summary.completed_paths).err())
            .map(|reason| reason.to_string()),
        period: scenario.and_then(Scenario::period),
        is_free: scenario.is_some_and(|scenario| scenario.model.oscillator.stiffness == 0.0),
        steps_per_path: None,
        file: file.display().to_string(),
        status: *status,
        ended_by: ended_by.clone(),
    }
}
