//! Joining the parts of a run: their states are checked against each other, their sums are merged
//! along the tree, and their rows are compared with the checksum of those that were simulated.

use super::SavedError;
use super::rows::Position;
use super::state::{RunQuestion, State, of_bytes, to_bytes};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;
use stickslip::dataset::layout::Variable;
use stickslip::dataset::{Dataset, ElementType, Source};
use stickslip::engine::{Asked, Moment, Sink, SinkError, SoFar};
use stickslip::ensemble::BLOCK_SIZE;
use stickslip::scenario::Scenario;
use stickslip::stats::column::{Columns as _, values_of};
use stickslip::stats::{
    BlockResult, BlockRows, EVENT_COUNT, EventColumns, PathColumns, Record, RunTotals,
    TrajectoryRows,
};

/// Why parts cannot be joined.
#[derive(Debug, thiserror::Error)]
pub enum PartsError {
    /// The saved data of a part cannot be used.
    #[error(transparent)]
    Saved(#[from] SavedError),
    /// The parts belong to different runs, or to the same run cut into different numbers of parts.
    #[error("{}: not of the same run as {}: {difference}; use parts of the same run", path.display(), first.display())]
    Foreign {
        /// The part.
        path: PathBuf,
        /// The part that it was compared with.
        first: PathBuf,
        /// Where they differ.
        difference: String,
    },
    /// Two parts hold the same paths.
    #[error("{} and {}: both are part {part} of the run; remove one of them", first.display(), second.display())]
    Repeated {
        /// The first one.
        first: PathBuf,
        /// The second one.
        second: PathBuf,
        /// Which part both of them are, such as `2/3`.
        part: String,
    },
    /// Some parts of the run were not given.
    #[error("missing: part {missing} of the run; add them, or simulate them")]
    Missing {
        /// The missing parts, such as `1/3, 3/3`.
        missing: String,
    },
    /// The rows of a part are not those that were simulated.
    #[error("{}: {cause}; use the unmodified part", path.display())]
    Rows {
        /// The part.
        path: PathBuf,
        /// What is wrong with them.
        cause: String,
    },
}

/// All parts of one run.
#[derive(Debug)]
pub struct Parts {
    /// The run as a whole.
    pub question: RunQuestion,
    /// The merged sums of all parts.
    pub so_far: SoFar,
    /// The names of the parts and their states, in the order of their paths.
    pub(crate) parts: Vec<(PathBuf, State)>,
}

/// The run to which a part belongs, and into how many parts it is cut.
fn whole(state: &State) -> (RunQuestion, Option<u64>) {
    let mut question = state.question.clone();
    let count = question.asked.part.take().map(|part| part.of());
    (question, count)
}

fn number(state: &State) -> u64 {
    state.question.asked.part.map_or(1, |part| part.number())
}

/// Check that each part is finished and of the same run as the first one.
fn check_same_run(parts: &[(PathBuf, State)]) -> Result<(), PartsError> {
    let (first, of) = &parts[0];
    of.check_program(first)?;
    let (question, count) = whole(of);
    for (path, state) in parts {
        state.check_program(path)?;
        let asked = &state.question.asked;
        if asked.part.is_none() || state.paths() != asked.own_paths() {
            return Err(SavedError::Damaged { path: path.clone() }.into());
        }
        let (mine, cut) = whole(state);
        let difference = mine.difference_from(&question).or_else(|| {
            (cut != count).then(|| {
                format!(
                    "it is one of {} parts, not {}",
                    cut.unwrap_or(1),
                    count.unwrap_or(1)
                )
            })
        });
        if let Some(difference) = difference {
            return Err(PartsError::Foreign {
                path: path.clone(),
                first: first.clone(),
                difference,
            });
        }
    }
    Ok(())
}

/// Check that each part is present once. Parts are in the order of their numbers.
fn check_complete(parts: &[(PathBuf, State)], count: u64) -> Result<(), PartsError> {
    let twice = parts
        .windows(2)
        .find(|pair| number(&pair[0].1) == number(&pair[1].1));
    if let Some([(first, state), (second, _)]) = twice {
        let part = state.question.asked.part;
        return Err(PartsError::Repeated {
            first: first.clone(),
            second: second.clone(),
            part: part.map_or_else(String::new, |part| part.to_string()),
        });
    }
    let is_there = |wanted: &u64| parts.iter().any(|(_, state)| number(state) == *wanted);
    let missing: Vec<String> = (1..=count)
        .filter(|wanted| !is_there(wanted))
        .map(|number| format!("{number}/{count}"))
        .collect();
    if missing.is_empty() {
        Ok(())
    } else {
        Err(PartsError::Missing {
            missing: missing.join(", "),
        })
    }
}

impl Parts {
    /// Check that these states of parts, each with its name, form one whole run. Parts that are
    /// unreadable, unfinished, repeated, missing, of another run or of another program are errors.
    pub fn of_bytes(
        parts: impl IntoIterator<Item = (PathBuf, Vec<u8>)>,
    ) -> Result<Parts, PartsError> {
        let read =
            |(name, bytes): (PathBuf, Vec<u8>)| of_bytes(&bytes, &name).map(|state| (name, state));
        Parts::of(parts.into_iter().map(read).collect::<Result<_, _>>()?)
    }

    /// The same for states that have been read.
    pub(crate) fn of(mut parts: Vec<(PathBuf, State)>) -> Result<Parts, PartsError> {
        let Some((_, first)) = parts.first() else {
            return Err(PartsError::Missing {
                missing: "1/1".into(),
            });
        };
        check_same_run(&parts)?;
        let (question, count) = whole(first);
        parts.sort_by_key(|(_, state)| number(state));
        check_complete(&parts, count.unwrap_or(1))?;
        let mut totals = RunTotals::empty(
            &question.scenario.model,
            &question.scenario.timeline(),
            &question.scenario.record,
        );
        for (path, state) in &parts {
            let damaged = |_| SavedError::Damaged { path: path.clone() };
            totals.merge(state.so_far.totals.clone()).map_err(damaged)?;
        }
        // The time that a part took is not in its file.
        Ok(Parts {
            question,
            so_far: SoFar {
                totals,
                spent: Duration::ZERO,
            },
            parts,
        })
    }

    /// The names of the parts, in the order of their paths.
    pub fn names(&self) -> impl Iterator<Item = &Path> {
        self.parts.iter().map(|(path, _)| path.as_path())
    }

    /// Check that the rows in the data set of a part, counted in the order of paths, are those that
    /// were simulated.
    pub fn check_rows(&self, part: usize, dataset: &Dataset) -> Result<(), PartsError> {
        let Some((path, state)) = self.parts.get(part) else {
            return Ok(());
        };
        let wrong = |cause: String| PartsError::Rows {
            path: path.clone(),
            cause,
        };
        each_block(state, dataset, |_| Ok(()), wrong)
    }
}

/// Read the rows of a part block by block, and compare them with the checksum of those that were
/// simulated. `wrong` turns a problem into an error.
pub(crate) fn each_block<E>(
    state: &State,
    from: &dyn Source,
    mut visit: impl FnMut(&BlockRows) -> Result<(), E>,
    wrong: impl Fn(String) -> E,
) -> Result<(), E> {
    let RunQuestion {
        scenario: Scenario { record, .. },
        asked,
        ..
    } = &state.question;
    if *record == Record::NOTHING {
        return Ok(());
    }
    let origin = asked.blocks().start * BLOCK_SIZE;
    let (mut position, mut bytes, mut event) = (Position::default(), Vec::new(), 0);
    for block in asked.blocks() {
        let (first_path, end) = (
            block * BLOCK_SIZE,
            ((block + 1) * BLOCK_SIZE).min(asked.paths),
        );
        let place = (first_path - origin) as usize..(end - origin) as usize;
        let mut owned = BlockRows {
            first_path,
            paths: end - first_path,
            ..BlockRows::default()
        };
        if record.paths {
            owned.path_columns = Some(
                PathColumns::read(|variable, kind| from.rows(variable.name, kind, &place))
                    .map_err(&wrong)?,
            );
        }
        if record.events {
            let (found, next) = events(from, &place, event).map_err(&wrong)?;
            (owned.events, event) = (Some(found), next);
        }
        if first_path < record.trajectories {
            let kept = place.start..(record.trajectories.min(end) - origin) as usize;
            owned.trajectories = Some(
                TrajectoryRows::read(|variable, kind| from.rows(variable.name, kind, &kept))
                    .map_err(&wrong)?,
            );
        }
        bytes.clear();
        position = position.after(&owned, &mut bytes);
        visit(&owned)?;
    }
    if state.rows == position {
        Ok(())
    } else {
        Err(wrong(
            "its rows differ from those that were written".to_string(),
        ))
    }
}

/// Read the events of some paths. `first` is the row of their first event; the row after their last
/// event is returned with them.
fn events(
    from: &dyn Source,
    rows: &Range<usize>,
    first: usize,
) -> Result<(EventColumns, usize), String> {
    let count: Vec<u32> = values_of(
        &EVENT_COUNT,
        from.rows(EVENT_COUNT.name, ElementType::U32, rows)?,
    )?;
    let next = first + count.iter().map(|&count| count as usize).sum::<usize>();
    if next == first {
        return Ok((
            EventColumns {
                count,
                ..EventColumns::default()
            },
            next,
        ));
    }
    let rows_of = |variable: &Variable| {
        if variable.axes == EVENT_COUNT.axes {
            rows.clone()
        } else {
            first..next
        }
    };
    let events =
        EventColumns::read(|variable, kind| from.rows(variable.name, kind, &rows_of(variable)))?;
    Ok((events, next))
}

/// A sink that makes the state of a part of a run: the bytes by which it is joined to the others.
/// The file of the same part has the same bytes.
#[derive(Debug, Default)]
pub struct PartRecorder {
    question: Option<RunQuestion>,
    rows: Position,
    bytes: Vec<u8>,
    state: Option<Vec<u8>>,
}

impl PartRecorder {
    /// The state; none for a run that is not a part.
    pub fn into_state(self) -> Option<Vec<u8>> {
        self.state
    }
}

impl Sink for PartRecorder {
    fn begin(&mut self, scenario: &Scenario, asked: &Asked) -> Result<(), SinkError> {
        let question = || RunQuestion {
            scenario: scenario.clone(),
            asked: asked.clone(),
            note: String::new(),
        };
        self.question = asked.part.map(|_| question());
        Ok(())
    }

    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
        if self
            .question
            .as_ref()
            .is_some_and(|question| question.scenario.record != Record::NOTHING)
        {
            self.bytes.clear();
            self.rows = self.rows.after(&block.rows, &mut self.bytes);
        }
        Ok(())
    }

    fn save(&mut self, moment: &Moment<'_>) -> Result<(), SinkError> {
        if let Some(question) = self.question.as_ref().filter(|_| moment.is_last) {
            // The time spent is left out, so that equal parts have equal bytes.
            self.state = Some(to_bytes(
                question,
                &moment.state(),
                Duration::ZERO,
                self.rows,
            ));
        }
        Ok(())
    }
}
