//! The sink that writes a run to a file.

use super::kinds::check_finished;
use super::log::{self, Log, read_state};
use super::staging::{self, Partial, ROWS, STATE, Staging, lock, next_save, partial_path};
use super::system::parent;
use super::{StoreError, Writer, check_space};
use crate::saved::{RunQuestion, State, to_bytes};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use stickslip::engine::{Asked, Moment, Outcome, Sink, SinkError, SoFar, Status};
use stickslip::scenario::Scenario;
use stickslip::stats::{BlockResult, Record};

/// Writes a run to a file, which gets its name only when the run is over.
///
/// Until then the run is saved from time to time in the folder `NAME.partial`. A run that was
/// killed or interrupted is continued from there ([`FileSink::go_on`]) and gives the same file.
///
/// ```
/// use stickslip::engine::Run;
/// use stickslip::scenario::Scenario;
/// use stickslip_files::store::{self, FileSink};
///
/// let folder = tempfile::tempdir()?;
/// let target = folder.path().join("shaw.h5");
/// let scenario = Scenario::shipped("shaw")?;
/// Run::of(&scenario).into_sink(&mut FileSink::new(&target, false)).simulate()?;
/// assert_eq!(store::read(&target)?.completed_paths, scenario.ensemble.paths);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FileSink {
    target: PathBuf,
    force: bool,
    note: String,
    ends: bool,
    open: Option<Open>,
}

/// The parts of a sink that exist while a run is being saved.
#[derive(Debug)]
struct Open {
    staging: Staging,
    question: RunQuestion,
    log: Log,
    /// When the run is to be saved next.
    due: Instant,
}

/// An unfinished run that can be continued.
#[derive(Debug)]
pub struct Unfinished {
    /// What the run is.
    pub question: RunQuestion,
    /// The sums of the paths that are done, and the time spent on them.
    pub so_far: SoFar,
    /// The sink that continues to save the run.
    pub sink: FileSink,
}

impl FileSink {
    /// A sink that writes to `target`. With `force`, an existing file of this name is replaced, and
    /// leftovers of an unfinished run to it are removed.
    pub fn new(target: &Path, force: bool) -> Self {
        FileSink {
            target: target.to_owned(),
            force,
            note: String::new(),
            ends: false,
            open: None,
        }
    }

    /// Keep this text with the saved run, for the program that continues it.
    pub fn with_note(self, note: String) -> Self {
        FileSink { note, ..self }
    }

    /// Write the file even if the run is interrupted; it then contains the finished paths.
    pub fn ending(self) -> Self {
        FileSink { ends: true, ..self }
    }

    /// Continue the run that is saved in `NAME.partial`, where `target` is `NAME`. Returns `None`
    /// if the run was finished: the file exists and is intact, and a leftover folder is removed.
    ///
    /// It is an error if there is nothing to continue, if the file or the saved state is damaged,
    /// or if another program began the run. So is a file of the target's name that has appeared,
    /// unless `force` lets it be replaced.
    pub fn go_on(target: &Path, force: bool) -> Result<Option<Unfinished>, StoreError> {
        let partial = partial_path(target);
        let is_there = target.symlink_metadata().is_ok();
        let nothing = || StoreError::NothingToResume {
            target: target.to_owned(),
            partial: partial.clone(),
        };
        let is_ours = |left| !matches!(left, Partial::Nothing | Partial::Foreign);
        if !is_there && !is_ours(staging::unfinished(target)) {
            return Err(nothing());
        }
        // A leftover lock file of a killed process is removed together with this lock.
        let lock = lock(target)?;
        match staging::unfinished(target) {
            Partial::Run if is_there && !force => {
                let target = target.to_owned();
                return Err(StoreError::Appeared { partial, target });
            }
            Partial::Run => {}
            Partial::Sweep => {
                let target = target.to_owned();
                return Err(StoreError::LeftOver { partial, target });
            }
            // The run was finished; at most its folder remains to be removed.
            left if is_there => {
                check_finished(target)?;
                if is_ours(left) {
                    staging::clear(target)?;
                }
                return Ok(None);
            }
            Partial::Empty => {
                staging::clear(target)?;
                return Err(nothing());
            }
            _ => return Err(nothing()),
        }
        let mut staging = Staging::enter(target, force, lock)?;
        let path = staging.path(STATE);
        let state = read_state(&path)?;
        state.check_program(&path)?;
        staging.saved_paths = state.paths();
        let State {
            question,
            so_far,
            rows,
            ..
        } = state;
        // Damage is reported before anything is simulated.
        let path = staging.path(ROWS);
        log::read(&path, rows, |_| Ok(()))?;
        let log = Log::go_on(&path, rows).map_err(|error| staging.failed(&error))?;
        let open = Open {
            staging,
            question: question.clone(),
            log,
            due: Instant::now(),
        };
        let sink = FileSink {
            open: Some(open),
            ..FileSink::new(target, force)
        };
        Ok(Some(Unfinished {
            question,
            so_far,
            sink,
        }))
    }

    /// Number of paths that are saved.
    pub fn saved_paths(&self) -> u64 {
        self.open
            .as_ref()
            .map_or(0, |open| open.staging.saved_paths)
    }

    /// Create the folder and the log of a new run.
    fn create(&self, question: RunQuestion) -> Result<Open, StoreError> {
        let RunQuestion {
            scenario, asked, ..
        } = &question;
        // The factor is 2 because rows are written twice: to the log, and to the file.
        let share = asked.own_paths() as f64 / scenario.ensemble.paths.max(1) as f64;
        check_space(
            &parent(&self.target),
            (2.0 * share.min(1.0) * scenario.derived().output_bytes) as u64,
        )?;
        let staging = Staging::open(&self.target, self.force).map_err(|error| match error {
            StoreError::LeftOver { partial, target } => left_over(partial, target, &question),
            error => error,
        })?;
        let log = Log::create(&staging.path(ROWS)).map_err(|error| staging.failed(&error))?;
        Ok(Open {
            staging,
            question,
            log,
            due: Instant::now(),
        })
    }
}

/// The error for a folder that already contains a run: the same run, another run, or something that
/// cannot be read.
fn left_over(partial: PathBuf, target: PathBuf, question: &RunQuestion) -> StoreError {
    let Ok(state) = read_state(&partial.join(STATE)) else {
        return StoreError::LeftOver { partial, target };
    };
    let (saved_paths, paths) = (state.paths(), state.question.asked.own_paths());
    let what = match state.question.difference_from(question) {
        None => "this run".to_string(),
        Some(difference) => format!("another run ({difference})"),
    };
    StoreError::Resumable {
        partial,
        target,
        what,
        saved_paths,
        paths,
    }
}

impl Open {
    /// Write everything to the disk: first the rows, then the state, which refers to them.
    fn save(&mut self, moment: &Moment<'_>) -> Result<(), StoreError> {
        let start = Instant::now();
        self.staging.check(Some((ROWS, self.log.file())))?;
        let rows = self.log.sync();
        let rows = rows.map_err(|error| self.staging.failed(&error))?;
        let state = to_bytes(&self.question, &moment.state(), moment.spent, rows);
        self.staging.save(&state, moment.paths)?;
        self.due = next_save(start);
        Ok(())
    }

    /// Write the file of the run and give it its name.
    fn finish(self, outcome: &Outcome) -> Result<(), StoreError> {
        let Open {
            staging,
            question,
            mut log,
            ..
        } = self;
        let rows = log.sync().map_err(|error| staging.failed(&error))?;
        let [log_path, state] = [ROWS, STATE].map(|name| staging.path(name));
        // The state of a part contains a checksum of its rows, which is checked when parts are
        // merged. It does not say how long the part took, so that equal parts are equal files.
        let of_part = |_| {
            let totals = read_state(&state)?.so_far.totals.to_bytes();
            Ok::<_, StoreError>(to_bytes(&question, &totals, Duration::ZERO, rows))
        };
        let part = question.asked.part.map(of_part).transpose()?;
        Writer::assemble(staging, &question, outcome, part, |writer| {
            log::read(&log_path, rows, |block| writer.append(&block))
        })
    }
}

impl Sink for FileSink {
    fn begin(&mut self, scenario: &Scenario, asked: &Asked) -> Result<(), SinkError> {
        if self.open.is_none() {
            let question = RunQuestion {
                scenario: scenario.clone(),
                asked: asked.clone(),
                note: self.note.clone(),
            };
            self.open = Some(self.create(question)?);
        }
        Ok(())
    }

    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        if open.question.scenario.record != Record::NOTHING {
            let appended = open.log.append(&block.rows);
            appended.map_err(|error| open.staging.failed(&error))?;
        }
        Ok(())
    }

    fn save(&mut self, moment: &Moment<'_>) -> Result<(), SinkError> {
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        // A run without a finished path leaves no files, and nothing is saved twice.
        let is_new = moment.paths > open.staging.saved_paths;
        let is_due = is_new && (moment.is_last || Instant::now() >= open.due);
        if is_due {
            Ok(open.save(moment)?)
        } else {
            Ok(())
        }
    }

    fn finish(&mut self, outcome: &Outcome) -> Result<(), SinkError> {
        let Some(open) = self.open.take() else {
            return Ok(());
        };
        // An interrupted run can be continued later; a run without a finished path leaves no files.
        let is_left = outcome.status == Status::Interrupted && !self.ends
            || outcome.summary.completed_paths == 0;
        if is_left {
            Ok(())
        } else {
            Ok(open.finish(outcome)?)
        }
    }
}
