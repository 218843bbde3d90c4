//! Joining the parts of a run: their sums are merged along the tree, their rows are written one
//! after the other.

use super::error::cause;
use super::log::{OwnedRows, Position};
use super::naming::parent;
use super::reader::{check_file, open};
use super::sink::is_logged;
use super::state::{self, Question, State};
use super::variable::read_variable;
use super::workshop::Workshop;
use super::{StoreError, Writer, check_space, rows};
use crate::dataset::{header, layout};
use crate::engine::{Asked, Outcome, Sink, SinkError, SoFar, Status};
use crate::ensemble::BLOCK_SIZE;
use crate::provenance::Provenance;
use crate::scenario::Scenario;
use crate::stats::{BlockResult, RunTotals};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Why parts cannot be joined.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// A file cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A file is not one part of a run; it may hold a whole run, for example.
    #[error("{}: not a part of a run, its status is `{}`\n  fix: give files of mc run --part", path.display(), status.name())]
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
    /// The parts belong to different runs, or to the same run cut into different numbers of parts.
    #[error("{}: not of the same run as {}: {difference}; give the parts of one run", path.display(), first.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// The file that it was compared with.
        first: PathBuf,
        /// Where they differ.
        difference: String,
    },
    /// Two files hold the same paths.
    #[error("{} and {}: both are part {part} of the run; leave out one of them", first.display(), second.display())]
    Repeated {
        /// The first file.
        first: PathBuf,
        /// The second file.
        second: PathBuf,
        /// Which part both of them are, such as `2/3`.
        part: String,
    },
    /// Some parts of the run were not given.
    #[error("missing: part {missing} of the run; give their files as well, or make them with `mc run --part`")]
    Missing {
        /// The missing parts, such as `1/3, 3/3`.
        missing: String,
    },
}

/// All parts of one run.
#[derive(Debug)]
pub struct Parts {
    /// The run as a whole.
    pub question: Question,
    /// The merged sums of all parts.
    pub so_far: SoFar,
    /// The files of the parts and their states, in the order of their paths.
    parts: Vec<(PathBuf, State)>,
}

impl Parts {
    /// Read the states of the parts and check that together they are one whole run. Parts that are
    /// unreadable, unfinished, repeated, missing, of another run or of another program are errors.
    pub fn open(paths: &[PathBuf]) -> Result<Parts, PartError> {
        let mut parts =
            paths.iter().map(|path| Ok((path.clone(), read_state(path)?))).collect::<Result<Vec<_>, PartError>>()?;
        let Some((first, of)) = parts.first().cloned() else {
            return Err(PartError::Missing { missing: "1/1".into() });
        };
        of.check_program(&first)?;
        let whole = |state: &State| {
            let mut question = state.question.clone();
            let of = question.asked.part.take().map(|part| part.of());
            (question, of)
        };
        let (question, count) = whole(&of);
        for (path, state) in &parts {
            state.check_program(path)?;
            let (mine, cut) = whole(state);
            let difference = mine.difference_from(&question).or_else(|| {
                (cut != count)
                    .then(|| format!("it is one of {} parts, not of {}", cut.unwrap_or(1), count.unwrap_or(1)))
            });
            if let Some(difference) = difference {
                return Err(PartError::Foreign { path: path.clone(), first, difference });
            }
        }
        let number = |state: &State| state.question.asked.part.map_or(1, |part| part.number());
        parts.sort_by_key(|(_, state)| number(state));
        if let Some([(first, state), (second, _)]) = parts.windows(2).find_map(|pair| match pair {
            [a, b] if number(&a.1) == number(&b.1) => Some([a.clone(), b.clone()]),
            _ => None,
        }) {
            let part = state.question.asked.part.map_or_else(String::new, |part| part.to_string());
            return Err(PartError::Repeated { first, second, part });
        }
        let count = count.unwrap_or(1);
        let is_there = |wanted: &u64| parts.iter().any(|(_, state)| number(state) == *wanted);
        let missing: Vec<String> =
            (1..=count).filter(|wanted| !is_there(wanted)).map(|number| format!("{number}/{count}")).collect();
        if !missing.is_empty() {
            return Err(PartError::Missing { missing: missing.join(", ") });
        }
        let mut totals = RunTotals::empty(&question.scenario.model, &question.scenario.timeline());
        for (path, state) in &parts {
            let damaged = |_| StoreError::DamagedState { path: path.clone() };
            totals.merge(state.so_far.totals.clone()).map_err(damaged)?;
        }
        // What a part took is not in its file.
        Ok(Parts { question, so_far: SoFar { totals, spent: Duration::ZERO }, parts })
    }

    /// A sink that writes the file of the whole run to `target`, once the merged sums are handed to
    /// it.
    pub fn sink(&self, target: &Path, force: bool) -> impl Sink + '_ {
        Merge { parts: &self.parts, question: &self.question, target: target.to_owned(), force, workshop: None }
    }

    /// The files of the parts, in the order of their paths.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.parts.iter().map(|(path, _)| path.as_path())
    }
}

/// Read the state of a part from its file.
fn read_state(path: &Path) -> Result<State, PartError> {
    let read = || -> Result<(Status, Option<Vec<u8>>), StoreError> {
        check_file(path)?;
        let file = open(path)?;
        if header::format_version(&file).is_none() {
            return Err(StoreError::Foreign { path: path.to_owned() });
        }
        let damaged = |error: hdf5::Error| StoreError::Damaged { path: path.to_owned(), cause: cause(&error) };
        let (status, _) = header::read_progress(&file).map_err(damaged)?;
        let is_there = file.link_exists(layout::PART_STATE.name);
        let state = is_there.then(|| read_variable(&file, &layout::PART_STATE));
        Ok((status, state.transpose().map_err(damaged)?))
    };
    match read() {
        Ok((Status::Part, Some(bytes))) => {
            let state = state::of_bytes(&bytes, path)?;
            let is_whole = state.paths() == state.question.asked.own_paths() && state.question.asked.part.is_some();
            if is_whole { Ok(state) } else { Err(StoreError::DamagedState { path: path.to_owned() }.into()) }
        }
        Ok((status, _)) => Err(PartError::NotAPart { path: path.to_owned(), status }),
        Err(_) if super::reader::unfinished(path).is_some() => Err(PartError::Unfinished { path: path.to_owned() }),
        Err(error) => Err(error.into()),
    }
}

/// The sink of a run that is joined from parts. It copies the rows of the parts when the run is
/// finished.
struct Merge<'a> {
    parts: &'a [(PathBuf, State)],
    question: &'a Question,
    target: PathBuf,
    force: bool,
    workshop: Option<Workshop>,
}

impl Sink for Merge<'_> {
    fn begin(&mut self, scenario: &Scenario, _: &Asked) -> Result<(), SinkError> {
        check_space(&parent(&self.target), scenario.derived().output_bytes as u64)?;
        self.workshop = Some(Workshop::open(&self.target, self.force)?);
        Ok(())
    }

    /// No block is simulated, so there is nothing to write here.
    fn block(&mut self, _: &BlockResult) -> Result<(), SinkError> {
        Ok(())
    }

    fn finish(&mut self, outcome: &Outcome) -> Result<(), SinkError> {
        let Some(workshop) = self.workshop.take() else { return Ok(()) };
        if outcome.status == Status::Interrupted {
            return Ok(());
        }
        let Question { scenario, asked, .. } = self.question;
        let header = Provenance { paths: asked.paths, ..Provenance::of(scenario) };
        let mut writer = Writer::within(workshop, &header, &scenario.record)?;
        for (path, state) in self.parts.iter().filter(|_| is_logged(&scenario.record)) {
            copy_rows(path, state, &mut writer)?;
        }
        Ok(writer.finish(&outcome.summary, outcome.status)?)
    }
}

/// Copy the rows of a part to the new file, and compare their checksum with that of the log they
/// were written from.
fn copy_rows(path: &Path, state: &State, writer: &mut Writer) -> Result<(), StoreError> {
    let damaged = |cause: String| StoreError::Damaged { path: path.to_owned(), cause };
    let unread = |error: hdf5::Error| damaged(cause(&error));
    let file = open(path)?;
    let Question { scenario: Scenario { record, .. }, asked, .. } = &state.question;
    let origin = asked.blocks().start * BLOCK_SIZE;
    let (mut position, mut bytes, mut event) = (Position::default(), Vec::new(), 0);
    for block in asked.blocks() {
        let (first_path, end) = (block * BLOCK_SIZE, ((block + 1) * BLOCK_SIZE).min(asked.paths));
        let place = (first_path - origin) as usize..(end - origin) as usize;
        let mut owned = OwnedRows { first_path, paths: end - first_path, ..OwnedRows::default() };
        if record.paths {
            owned.path_columns = Some(rows::paths(&file, &place).map_err(unread)?);
        }
        if record.events {
            let (events, next) = rows::events(&file, &place, event).map_err(unread)?;
            (owned.events, event) = (Some(events), next);
        }
        if first_path < record.trajectories {
            let kept = place.start..(record.trajectories.min(end) - origin) as usize;
            owned.trajectories = Some(rows::trajectories(&file, &kept).map_err(unread)?);
        }
        bytes.clear();
        position = position.after(&owned.rows(), &mut bytes);
        writer.append_rows(owned.rows())?;
    }
    if state.logs == [position] { Ok(()) } else { Err(damaged("its rows are not those that were written".into())) }
}
