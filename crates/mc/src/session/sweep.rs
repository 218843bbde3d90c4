//! One session of a sweep: from the start or a continuation to its table, or to the next
//! interruption.

use crate::output::dataset;
use crate::output::numbers::wrapped;
use crate::report::{self, ShownStatistics};
use crate::session::progress::Progress;
use crate::{Failure, Threads, note, print, print_data, stop_on_signals, warn};
use std::collections::BTreeMap;
use std::path::Path;
use stickslip::dataset::Dataset;
use stickslip::stats::Statistic;
use stickslip::study::sweep::{Sweep, SweepEnd, SweepQuestion, SweepSimulation};
use stickslip_files::store::{SweepFile, partial_path};

/// How a sweep is simulated and printed.
pub struct SweepSession<'a> {
    pub output: &'a Path,
    /// Whether other results may be overwritten.
    pub force: bool,
    pub threads: &'a Threads,
    /// The statistics to print; a default selection if empty.
    pub statistics: &'a [Statistic],
    pub quiet: bool,
    pub json: bool,
}

impl SweepSession<'_> {
    /// Simulates the points that are not in the file yet, finishes the file, and prints all.
    pub fn simulate(&self, question: SweepQuestion) -> Result<(), Failure> {
        let (file, known) = SweepFile::open(self.output, &question, self.force)?;
        warn_once(&question);
        let mut sweep = Sweep {
            question,
            points: known,
        };
        let Some(mut file) = file else {
            let output = self.output.display();
            note(&format!("{output} already contains this sweep"));
            return self.print(&sweep);
        };
        let (done, all) = (sweep.done(), sweep.points.len());
        if done > 0 {
            note(&format!("continuing: {done} of {all} points are done"));
        }
        if !sweep.is_complete() {
            self.points(&mut sweep, &mut file)?;
        }
        if !sweep.is_complete() {
            file.save_now(&sweep)?;
            let done = sweep.done();
            let partial = partial_path(self.output);
            note(&format!(
                "{done} of {all} points are in {}; run the same command again to continue",
                partial.display()
            ));
            return Err(Failure::Interrupted);
        }
        file.finish(&sweep)?;
        self.print(&sweep)
    }

    fn points(&self, sweep: &mut Sweep, file: &mut SweepFile) -> Result<(), Failure> {
        let used = sweep
            .question
            .points
            .iter()
            .map(|point| point.run_bytes(point.ensemble.paths, self.threads.number()));
        let threads = self
            .threads
            .ready("the largest point of this sweep", used.fold(0.0, f64::max))?;
        let stop = stop_on_signals()?;
        let left = sweep
            .points
            .iter()
            .zip(&sweep.question.points)
            .filter(|(point, _)| point.is_none());
        let paths = left.map(|(_, scenario)| scenario.ensemble.paths).sum();
        let mut progress = Progress::new(paths, self.quiet, None, None);
        let simulation = SweepSimulation {
            threads,
            stop: &stop,
            progress: &mut progress,
            blocks: None,
        };
        let ended = simulation.run(sweep, |sweep| file.save(sweep));
        progress.finish();
        ended.map_err(|end| match end {
            SweepEnd::Receiver(error) => Failure::from(error),
            SweepEnd::Overlap(_) => Failure::Run(end.to_string()),
        })
    }

    fn print(&self, sweep: &Sweep) -> Result<(), Failure> {
        let chosen = if self.statistics.is_empty() {
            ShownStatistics::First
        } else {
            ShownStatistics::These(self.statistics)
        };
        if self.json {
            print_data(&dataset::json(&Dataset::of_sweep(sweep), Some(self.output)))?;
        } else if !self.quiet {
            print(&report::text(&report::sweep(sweep, chosen, self.output)))?;
        }
        report::warnings(sweep).into_iter().for_each(warn);
        let lost = sweep
            .points
            .iter()
            .flatten()
            .filter(|point| point.completed_paths == point.diverged_paths)
            .count();
        if lost == sweep.points.len() {
            return Err(Failure::run(
                "every path of every point diverged or was given up",
                "a smaller step",
            ));
        }
        Ok(())
    }
}

/// Prints each warning once, with the number of points that it concerns.
fn warn_once(question: &SweepQuestion) {
    let mut due: BTreeMap<&str, (String, usize)> = BTreeMap::new();
    for scenario in &question.points {
        let measures_bias =
            question.with_bias && scenario.bias_plan(scenario.ensemble.paths).is_ok();
        for warning in scenario.warnings_of_run(measures_bias) {
            due.entry(warning.name())
                .or_insert_with(|| (warning.to_string(), 0))
                .1 += 1;
        }
    }
    for (text, points) in due.into_values() {
        let all = question.points.len();
        let which = if points == all {
            String::new()
        } else {
            format!(" (at {points} of {all} points, the first here)")
        };
        note(wrapped(&format!("warning{which}: {text}"), "  ").trim_end());
    }
}
