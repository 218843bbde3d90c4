//! `mc merge`: joins the parts of a run.

use crate::arguments::extension::writable_hdf5;
use crate::inputs::files;
use crate::session::cost;
use crate::session::run::{Leaves, RunOptions, Session};
use crate::{Failure, stop_on_signals};
use std::path::PathBuf;
use stickslip_files::store::{PartError, Parts, StoreError};

/// Arguments of `mc merge`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/merge.txt"))]
pub struct Arguments {
    /// The files of all parts, in any order
    #[arg(required = true, value_name = "FILE")]
    parts: Vec<PathBuf>,
    /// Output file
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Overwrite the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    options: RunOptions,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        writable_hdf5(
            &self.output,
            self.force,
            self.parts.iter().map(PathBuf::as_path),
        )?;
        self.parts.iter().for_each(|part| files::look(part));
        let parts = Parts::open(&self.parts)?;
        let (scenario, asked) = (&parts.question.scenario, parts.question.asked.clone());
        cost::check_memory(scenario, asked.paths, self.options.threads())?;
        let stop = stop_on_signals()?;
        let mut file = parts.sink(&self.output, self.force);
        let session = Session::of(&self.options, scenario, &self.output, &stop);
        Session {
            leaves: Leaves::Nothing,
            ..session
        }
        .simulate(asked, Some(parts.so_far.clone()), &mut file)
    }
}

impl From<PartError> for Failure {
    fn from(error: PartError) -> Self {
        match error {
            PartError::Store(StoreError::Foreign { path }) => {
                crate::inputs::files::explained(&path.clone(), StoreError::Foreign { path })
            }
            PartError::Store(error) => error.into(),
            error => Failure::Refused(error.to_string()),
        }
    }
}
