//! `mc resume`: continues a run or a sweep that was interrupted or killed.

use crate::inputs::files;
use crate::output::numbers::grouped;
use crate::session::cost;
use crate::session::run::{Leaves, RunOptions, Session};
use crate::session::sweep::SweepSession;
use crate::{Failure, note, stop_on_signals};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use stickslip_files::store::{self, FileSink, StoreError, Unfinished};

/// Arguments of `mc resume`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/resume.txt"))]
pub struct Arguments {
    /// Output file of the run or sweep, or the FILE.partial that it left
    file: PathBuf,
    /// Do not continue: write a file with the finished paths; its status is `interrupted`
    #[arg(long)]
    end: bool,
    /// Replace an existing file of this name
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    options: RunOptions,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let output = store::file_of(&self.file);
        if store::is_unfinished_sweep(&output) {
            return self.sweep(&output);
        }
        if output.is_file() {
            files::look(&output);
        }
        let Some(Unfinished {
            question,
            so_far,
            sink,
        }) = FileSink::go_on(&output, self.force)?
        else {
            note(&format!(
                "{} is finished; nothing to resume",
                output.display()
            ));
            return Ok(());
        };
        let (scenario, asked) = (&question.scenario, &question.asked);
        cost::check_memory(scenario, asked.own_paths(), self.options.threads())?;
        let stop = stop_on_signals()?;
        stop.store(self.end, Ordering::Relaxed);
        if !self.options.quiet {
            let (done, all) = (grouped(sink.saved_paths()), grouped(asked.own_paths()));
            note(&format!("continuing: {done} of {all} paths are done"));
        }
        let accuracy_goal = question.note.parse().ok();
        let (leaves, mut sink) = if self.end {
            (Leaves::File, sink.ending())
        } else {
            (Leaves::Run, sink)
        };
        let session = Session::of(&self.options, scenario, &output, &stop);
        Session {
            accuracy_goal,
            leaves,
            ..session
        }
        .simulate(asked.clone(), Some(so_far), &mut sink)
    }

    /// Continues a sweep, whose definition is in the file of its points.
    fn sweep(&self, output: &Path) -> Result<(), Failure> {
        let partial = store::partial_path(output);
        if self.end || self.options.watch.is_some() {
            let partial = partial.display();
            let problem = format!("{partial} is a sweep, which does not support --end or --watch");
            return Err(Failure::usage(
                problem,
                format!("remove them; the finished points are in {partial}"),
            ));
        }
        if output.symlink_metadata().is_ok() && !self.force {
            return Err(StoreError::Appeared {
                partial,
                target: output.to_owned(),
            }
            .into());
        }
        let question = files::read(&partial, store::read_sweep)?.sweep.question;
        let RunOptions { quiet, json, .. } = self.options;
        SweepSession {
            output,
            force: self.force,
            threads: &self.options.threads,
            statistics: &[],
            quiet,
            json,
        }
        .simulate(question)
    }
}
