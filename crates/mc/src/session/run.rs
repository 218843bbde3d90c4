//! One session of a run, from a start or a continuation to the next end: simulates, then prints the
//! results with their precision.

use crate::arguments::accuracy;
use crate::inputs::results;
use crate::output::numbers::time;
use crate::report::{self, RunInfo, ShownStatistics};
use crate::session::cost;
use crate::session::ending;
use crate::session::progress::Progress;
use crate::{Failure, Threads, note, print, print_data};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use stickslip::engine::{Asked, EndedBy, Outcome, Run, RunError, Sink, SoFar, Status};
use stickslip::ensemble::{BLOCK_SIZE, Flaw};
use stickslip::model::Problem;
use stickslip::scenario::Scenario;
use stickslip::scheme::Unresolved;
use stickslip::stats::Statistic;
use stickslip::study::accuracy::AccuracyGoal;
use stickslip_files::store;

/// Options that do not affect the results.
#[derive(Debug, clap::Args)]
pub struct RunOptions {
    /// Show the running estimate of this statistic and its relative error [default: the statistic
    /// of --until or --accuracy]
    #[arg(long, value_name = "NAME", value_parser = crate::arguments::completion::STATISTIC, hide_possible_values = true)]
    pub watch: Option<Statistic>,
    #[command(flatten)]
    pub threads: Threads,
    /// Print nothing but warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Print only one JSON object to standard output
    #[arg(long)]
    pub json: bool,
}

impl RunOptions {
    /// The number of threads to use.
    pub fn threads(&self) -> usize {
        self.threads.number()
    }
}

/// One session of a run: its scenario, its output, and its options.
pub struct Session<'a> {
    pub options: &'a RunOptions,
    /// The name of the scenario.
    pub name: String,
    pub scenario: &'a Scenario,
    pub output: &'a Path,
    /// The accuracy for which `--accuracy` chose the run.
    pub accuracy_goal: Option<AccuracyGoal>,
    pub stop: &'a AtomicBool,
    /// What remains of the run if it is interrupted.
    pub leaves: Leaves,
}

/// What remains of an interrupted run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaves {
    /// A run that can be continued.
    Run,
    /// A file of results of the paths that are done.
    File,
    /// Nothing: the command must be given again.
    Nothing,
}

impl<'a> Session<'a> {
    /// A session under the title of the scenario, without `--accuracy`, which leaves a run.
    pub fn of(
        options: &'a RunOptions,
        scenario: &'a Scenario,
        output: &'a Path,
        stop: &'a AtomicBool,
    ) -> Self {
        let name = scenario.title.clone();
        Session {
            options,
            name,
            scenario,
            output,
            accuracy_goal: None,
            stop,
            leaves: Leaves::Run,
        }
    }

    /// Simulates a run from its beginning, or continues it after an earlier session.
    pub fn simulate(
        &self,
        asked: Asked,
        so_far: Option<SoFar>,
        file: &mut dyn Sink,
    ) -> Result<(), Failure> {
        let of_goal = || asked.goals.first().map(|goal| goal.statistic);
        let of_accuracy_goal = || {
            self.accuracy_goal
                .map(|accuracy_goal| accuracy_goal.decisive)
        };
        let watched = self
            .options
            .watch
            .or_else(of_goal)
            .or_else(of_accuracy_goal);
        let plan = (asked.plan(self.scenario), asked.blocks().start * BLOCK_SIZE);
        let mut progress =
            Progress::new(asked.own_paths(), self.options.quiet, watched, Some(plan));
        let run = Run::of(self.scenario)
            .asked(asked)
            .threads(self.options.threads())
            .stopped_by(self.stop)
            .with_progress(&mut progress)
            .into_sink(file);
        let ended = match so_far {
            Some(so_far) => run.go_on(so_far),
            None => run.simulate(),
        };
        progress.finish();
        match ended {
            Ok(outcome) => self.report(&outcome),
            Err(RunError::Sink { error, outcome }) => {
                // The file could not be written, so at least print the results in memory.
                if let Some(outcome) = outcome.filter(|outcome| outcome.summary.completed_paths > 0)
                    && let Err(unprinted) = self.print(&outcome)
                {
                    unprinted.report();
                }
                Err(RunError::Sink {
                    error,
                    outcome: None,
                }
                .into())
            }
            Err(RunError::Flaw { flaw, outcome }) => {
                if outcome.summary.completed_paths == 0 {
                    return Err(flaw.into());
                }
                let info = self.print(&outcome)?;
                let kept = match self.leaves {
                    Leaves::Run => {
                        format!(
                            "the paths before it are saved; print them with mc show {}",
                            self.output.display()
                        )
                    }
                    Leaves::File => format!("the paths before it are in {}", info.file),
                    Leaves::Nothing => "nothing was written".to_string(),
                };
                Err(Failure::run(format!("{flaw}\n  {kept}"), Flaw::REMEDY))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Prints the results, and returns a failure if the run did not reach its aim.
    fn report(&self, outcome: &Outcome) -> Result<(), Failure> {
        if outcome.summary.completed_paths == 0 {
            if self.is_unfinished(outcome) {
                note("interrupted before the first paths were done: nothing was written");
                return Err(Failure::Interrupted);
            }
            let first = BLOCK_SIZE.min(outcome.paths);
            let takes = cost::measured_cpu_seconds(self.scenario, first);
            let takes = takes.map_or_else(String::new, |seconds| {
                format!(", which take about {} on a thread", time(seconds))
            });
            let problem = format!(
                "the time limit was reached before the first {first} paths were done{takes}; nothing was \
                 written, because results consist of whole blocks of {BLOCK_SIZE} paths"
            );
            let remedy = "use a longer --max-time, or a larger step or tolerance; mc check estimates the time";
            return Err(Failure::run(problem, remedy));
        }
        let info = self.print(outcome)?;
        if outcome.status == Status::Interrupted && self.leaves != Leaves::File {
            note(&match self.leaves {
                Leaves::Run => format!(
                    "interrupted; continue it with: mc resume {}",
                    self.output.display()
                ),
                _ => "interrupted: nothing was written; run the same command again".to_string(),
            });
            return Err(Failure::Interrupted);
        }
        let reason = match &outcome.ended_by {
            Some(EndedBy::Hopeless(reason)) => ending::hopeless(reason),
            _ if outcome.is_all_lost() => self.all_lost(outcome),
            _ => return Ok(()),
        };
        Err(Failure::Run(format!(
            "{reason}\n  the results so far are in {}",
            info.file
        )))
    }

    /// Whether the run was interrupted and can be continued.
    fn is_unfinished(&self, outcome: &Outcome) -> bool {
        outcome.status == Status::Interrupted && self.leaves == Leaves::Run
    }

    fn print(&self, outcome: &Outcome) -> Result<RunInfo, Failure> {
        let (summary, info) = (&outcome.summary, self.info(outcome));
        let (json, quiet) = (self.options.json, self.options.quiet);
        if json {
            print_data(&report::json::of_run(
                summary,
                &info,
                &results::warnings(summary, Some(self.scenario)),
            ))?;
        } else if !quiet {
            print(&report::text(&report::run(
                summary,
                &info,
                ShownStatistics::First,
                false,
            )))?;
        }
        // The table has these lines as remarks.
        let found = report::found(summary).into_iter().map(|(_, text)| text);
        let remarks = report::lost(summary, &info)
            .into_iter()
            .chain(found)
            .filter(|_| json || quiet);
        let missed = outcome
            .missed
            .iter()
            .map(|missed| ending::missed(missed, missed.paths_needed()));
        let broken = self
            .accuracy_goal
            .and_then(|accuracy_goal| accuracy::missed(&accuracy_goal, summary.completed_paths));
        for line in remarks.chain(missed).chain(broken) {
            note(&format!("warning: {line}"));
        }
        Ok(info)
    }

    fn info(&self, outcome: &Outcome) -> RunInfo {
        let Session {
            scenario, output, ..
        } = self;
        let saved = store::partial_path(output);
        let file = if self.is_unfinished(outcome) {
            saved.as_path()
        } else {
            output
        };
        RunInfo {
            scenario: self.name.clone(),
            provenance: Asked::paths(outcome.paths).provenance(scenario),
            part: outcome.part,
            threads: Some(outcome.threads),
            seconds: Some(outcome.seconds),
            bias_seconds: Some(outcome.bias.seconds),
            no_bias: outcome
                .bias
                .absence
                .as_ref()
                .map(|reason| reason.to_string()),
            period: scenario.period(),
            is_free: scenario.model.oscillator.stiffness == 0.0,
            steps_per_path: scenario.steps(),
            // A folder or file may have been deleted in the meantime.
            file: if file.exists() {
                file.display().to_string()
            } else {
                RunInfo::NO_FILE.into()
            },
            status: outcome.status,
            ended_by: outcome.ended_by.as_ref().map(EndedBy::to_string),
        }
    }

    /// The message where every path was lost.
    fn all_lost(&self, outcome: &Outcome) -> String {
        let Problem {
            force, oscillator, ..
        } = &self.scenario.model;
        let first = outcome.summary.diverged.first();
        let why = first.and_then(|path| self.scenario.plan().why_lost(*path, self.stop));
        let is_resolved = why
            .as_ref()
            .is_none_or(|given_up| given_up.why == Unresolved::NoNumber);
        let cause = match force {
            _ if !is_resolved => "",
            Some(force) if force.sides().is_some() => {
                ". A possible cause is a negative `friction.load`; use `max(.., 0)`"
            }
            Some(_) => {
                ". A possible cause is `force.expression`: it may be undefined at the position of the body, \
                 or drive it without bound"
            }
            None if oscillator.damping < 0.0 => {
                ". A possible cause is the negative damping, under which the motion can grow without bound"
            }
            None => "",
        };
        let lost = match &why {
            None => "every path diverged, so there are no statistics".to_string(),
            Some(why) => {
                format!("every path was given up, so there are no statistics; of the first, {why}")
            }
        };
        let remedy = match why.map(|given_up| given_up.why) {
            None if cause.is_empty() => {
                "use a smaller step, or --scheme corrected-vi or event-driven; mc check prints the largest \
                    stable step"
            }
            None => {
                "follow the warnings of mc check; try a smaller step to see whether the step is the cause"
            }
            Some(Unresolved::TooLong) => {
                "use a shorter --until, or --scheme discrete-vi, whose cost is its number of steps"
            }
            Some(_) => "follow the warnings of mc check, or use a shorter --until",
        };
        format!("{lost}{cause}\n  fix: {remedy}")
    }
}
