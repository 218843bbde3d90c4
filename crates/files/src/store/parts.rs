//! Joining the files of the parts of a run: their rows are written one after the other.

use super::kinds::{damaged, open, read_kind};
use super::staging::Staging;
use super::system::parent;
use super::{StoreError, Writer, check_space};
use crate::saved::{Parts, PartsError, State, each_block, of_bytes};
use std::path::{Path, PathBuf};
use stickslip::dataset::header::FORMAT;
use stickslip::dataset::{header, layout, read_variable};
use stickslip::engine::{Asked, Outcome, Sink, SinkError, Status};
use stickslip::scenario::Scenario;

/// Why the files of parts cannot be joined.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// A file cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The parts do not belong together.
    #[error(transparent)]
    Parts(#[from] PartsError),
    /// A file is not a part of a run; it may contain a whole run, for example.
    #[error("{}: not a part of a run (status `{}`)\n  fix: give files of mc run --part", path.display(), status.name())]
    NotAPart {
        /// The file.
        path: PathBuf,
        /// How the run ended.
        status: Status,
    },
    /// A part is not finished yet.
    #[error("{}: this part is not finished; continue it with `mc resume {}`", path.display(), path.display())]
    Unfinished {
        /// The file that the part was to become.
        path: PathBuf,
    },
}

impl Parts {
    /// Read the states of the parts from their files, and check them against each other.
    pub fn open(paths: &[PathBuf]) -> Result<Parts, PartError> {
        let read = |path: &PathBuf| read_state(path).map(|state| (path.clone(), state));
        Ok(Parts::of(
            paths.iter().map(read).collect::<Result<_, _>>()?,
        )?)
    }

    /// A sink that writes the file of the whole run to `target`, once it receives the merged sums.
    pub fn sink(&self, target: &Path, force: bool) -> impl Sink + '_ {
        PartsSink {
            parts: self,
            target: target.to_owned(),
            force,
            staging: None,
        }
    }
}

/// Read the state of a part from its file.
fn read_state(path: &Path) -> Result<State, PartError> {
    let read = || {
        read_kind(path, FORMAT, |file| {
            let (status, _) = header::read_progress(file)?;
            let is_there = file.has(layout::PART_STATE.name);
            let state = is_there
                .then(|| read_variable::<u8>(file, &layout::PART_STATE))
                .transpose()?;
            Ok((status, state))
        })
    };
    match read() {
        Ok((Status::Part, Some(bytes))) => Ok(of_bytes(&bytes, path).map_err(StoreError::from)?),
        Ok((status, _)) => Err(PartError::NotAPart {
            path: path.to_owned(),
            status,
        }),
        Err(_) if super::kinds::unfinished_run(path).is_some() => Err(PartError::Unfinished {
            path: path.to_owned(),
        }),
        Err(error) => Err(error.into()),
    }
}

/// The sink of a run that is joined from parts. It copies the rows of the parts when the run is
/// finished.
struct PartsSink<'a> {
    parts: &'a Parts,
    target: PathBuf,
    force: bool,
    staging: Option<Staging>,
}

impl Sink for PartsSink<'_> {
    fn begin(&mut self, scenario: &Scenario, _: &Asked) -> Result<(), SinkError> {
        check_space(
            &parent(&self.target),
            scenario.derived().output_bytes as u64,
        )?;
        self.staging = Some(Staging::open(&self.target, self.force)?);
        Ok(())
    }

    /// No block is simulated, so there is nothing to write here.
    fn finish(&mut self, outcome: &Outcome) -> Result<(), SinkError> {
        let Some(staging) = self.staging.take() else {
            return Ok(());
        };
        if outcome.status == Status::Interrupted {
            return Ok(());
        }
        let Parts {
            question, parts, ..
        } = self.parts;
        Ok(Writer::assemble(
            staging,
            question,
            outcome,
            None,
            |writer| {
                parts
                    .iter()
                    .try_for_each(|(path, state)| copy_rows(path, state, writer))
            },
        )?)
    }
}

/// Copy the rows of a part to the new file.
fn copy_rows(path: &Path, state: &State, writer: &mut Writer) -> Result<(), StoreError> {
    each_block(
        state,
        &open(path)?,
        |rows| writer.append(rows),
        damaged(path),
    )
}
