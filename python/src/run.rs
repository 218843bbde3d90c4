//! A run, a part of a run, the parts joined, and one path of a run again, as data sets in memory.

use crate::dataset::{Handed, from_python, to_python};
use crate::errors;
use crate::own::{KeptRun, OwnEstimate};
use crate::scenario::{Laid, Scenario, laid};
use crate::studies::{ThreadCount, enough_memory};
use crate::watched::{Callback, abandoned_on_interrupt, watched};
use numpy::{PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use stickslip::dataset::{Dataset, Recorder};
use stickslip::engine::{
    Asked, EndedBy, MOST_PATHS, MissedGoal, Outcome, Part, Progress as _, Replay, Run, RunError,
};
use stickslip::ensemble::ThreadsError;
use stickslip::scenario::Scenario as Checked;
use stickslip::stats::Goal;
use stickslip_files::saved::{PartRecorder, Parts, PartsError};

/// The attributes and the variables of a data set.
pub type Variables<'py> = (Bound<'py, PyDict>, Bound<'py, PyList>);

/// The results of a run: its data set, warnings, the user-defined statistics, and its state
/// if it is a part.
type Ran<'py> = (
    Variables<'py>,
    Vec<String>,
    Vec<OwnEstimate>,
    Option<Vec<u8>>,
);

/// Simulates a scenario. With goals, the number of paths is limited only if `is_bounded`.
#[pyfunction]
pub fn run<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    goals: Vec<String>,
    is_bounded: bool,
    max_time: Option<f64>,
    part: Option<&str>,
    bias: bool,
    threads: ThreadCount,
    progress: Callback,
    own: Vec<Py<PyAny>>,
) -> PyResult<Ran<'py>> {
    let scenario = &scenario.checked;
    let goal = |text: &String| {
        let remedy = "write NAME < 0.5% or NAME < 0.01, where NAME is one of stickslip.STATISTICS";
        text.parse::<Goal>()
            .map_err(|error| errors::of_argument(py, "until", text, &error, remedy))
    };
    let goals = goals.iter().map(goal).collect::<PyResult<Vec<_>>>()?;
    let is_open = !goals.is_empty() && !is_bounded;
    let paths = if is_open {
        MOST_PATHS
    } else {
        scenario.ensemble.paths
    };
    enough_memory(py, scenario, paths, threads)?;
    let asked = Asked {
        paths,
        part: part
            .map(|text| cut(py, text, scenario, &goals, max_time))
            .transpose()?,
        goals,
        max_time: max_time.map(Duration::from_secs_f64),
        with_bias: bias,
    };
    let (mut kept, mut part) = (KeptRun::new(scenario, &own), PartRecorder::default());
    // User-defined statistics need events, even if the data set is not to contain them.
    let watched_scenario = kept.watched(scenario);
    let (outcome, is_interrupted) = watched(py, &progress, |watch| {
        let mut reported = watch.paths(scenario.ensemble.paths);
        let run = Run::of(&watched_scenario).asked(asked).threads(threads.0);
        run.stopped_by(&watch.stop)
            .with_progress(&mut reported)
            .into_sink(&mut kept)
            .into_sink(&mut part)
            .simulate()
    })?;
    let outcome = outcome.map_err(|error| of_run(py, error))?;
    let remarks = remarks(py, scenario, &outcome, is_interrupted)?;
    let KeptRun { recorder, own, .. } = kept;
    Ok((
        to_python(py, recorder.into_dataset())?,
        remarks,
        own.estimates(),
        part.into_state(),
    ))
}

/// Joins the parts of a run, given the name, the data set and the state of each, with the checks of
/// `mc merge`. The bias of the step is estimated here.
#[pyfunction]
pub fn merge<'py>(
    py: Python<'py>,
    parts: Vec<(String, Handed<'py>, Vec<u8>)>,
    bias: bool,
    threads: ThreadCount,
    progress: Callback,
) -> PyResult<(Variables<'py>, Vec<String>)> {
    let refused = |error: PartsError| {
        let remedy = "give all parts of one run, as run() returned them";
        errors::of_argument(py, "parts", "these", error, remedy)
    };
    let states = parts
        .iter()
        .map(|(name, _, state)| (PathBuf::from(name), state.clone()));
    let whole = Parts::of_bytes(states).map_err(refused)?;
    let mut given: HashMap<String, Handed> = parts
        .into_iter()
        .map(|(name, dataset, _)| (name, dataset))
        .collect();
    let mut datasets = Vec::new();
    for (number, name) in whole.names().enumerate() {
        let Some(handed) = name.to_str().and_then(|name| given.remove(name)) else {
            continue;
        };
        let dataset = from_python(handed)?;
        whole.check_rows(number, &dataset).map_err(refused)?;
        datasets.push(dataset);
    }
    let scenario = &whole.question.scenario;
    let asked = Asked {
        with_bias: bias,
        ..whole.question.asked.clone()
    };
    let mut recorder = Recorder::default();
    let (outcome, is_interrupted) = watched(py, &progress, |watch| {
        let mut reported = watch.paths(scenario.ensemble.paths);
        reported.paths(scenario.ensemble.paths, scenario.ensemble.paths);
        let run = Run::of(scenario).asked(asked).threads(threads.0);
        run.stopped_by(&watch.stop)
            .with_progress(&mut reported)
            .into_sink(&mut recorder)
            .go_on(whole.so_far.clone())
    })?;
    let outcome = outcome.map_err(|error| of_run(py, error))?;
    let remarks = remarks(py, scenario, &outcome, is_interrupted)?;
    let mut dataset = recorder.into_dataset();
    for part in &datasets {
        dataset.append_rows(part).map_err(|cause| {
            refused(PartsError::Rows {
                path: "a part".into(),
                cause,
            })
        })?;
    }
    Ok((to_python(py, dataset)?, remarks))
}

/// Reads the number of a part. Refuses what only a whole run can have: goals and a time limit.
fn cut(
    py: Python<'_>,
    text: &str,
    scenario: &Checked,
    goals: &[Goal],
    max_time: Option<f64>,
) -> PyResult<Part> {
    let wrong =
        |problem: &str, remedy: &str| errors::of_argument(py, "part", text, problem, remedy);
    let part: Part = text
        .parse()
        .map_err(|_| wrong("it is not a part", "write 3/16 for the third of 16 parts"))?;
    if !goals.is_empty() || max_time.is_some() {
        let problem = "a part cannot be combined with a goal or max_time, whose end depends on all parts together";
        return Err(wrong(problem, "give the number of paths of the whole run"));
    }
    let blocks = Asked {
        part: None,
        ..Run::of(scenario).question()
    }
    .blocks()
    .end;
    if part.of() > blocks {
        let problem = format!("the run has {blocks} blocks, and each part needs at least one");
        return Err(wrong(&problem, &format!("use at most {blocks} parts")));
    }
    Ok(part)
}

/// The exception for a failed run. If a user-defined statistic raised an exception, it is
/// that exception.
fn of_run(py: Python<'_>, error: RunError) -> PyErr {
    match error {
        RunError::Sink { error, .. } => match error.downcast::<PyErr>() {
            Ok(error) => *error,
            Err(error) => errors::of_run(py, &error, "report it"),
        },
        RunError::Threads(error) => errors::of_run(py, &error, ThreadsError::REMEDY),
        RunError::Flaw { flaw, .. } => errors::of_flaw(py, &flaw),
        error => errors::of_run(py, error, "report it"),
    }
}

/// The warnings about an outcome. An outcome without paths is an exception instead.
fn remarks(
    py: Python<'_>,
    scenario: &Checked,
    outcome: &Outcome,
    is_interrupted: bool,
) -> PyResult<Vec<String>> {
    let paths = outcome.summary.completed_paths;
    if paths == 0 {
        return Err(match is_interrupted {
            true => PyKeyboardInterrupt::new_err("interrupted before the first paths were done"),
            false => {
                let remedy = "use a longer max_time, or a larger step or tolerance";
                errors::of_run(
                    py,
                    "the time limit was reached before the first paths were done",
                    remedy,
                )
            }
        });
    }
    let mut remarks = Vec::new();
    if is_interrupted {
        remarks.push(format!(
            "interrupted after {paths} paths; the statistics include only these"
        ));
    }
    if outcome.is_all_lost() {
        let first = outcome.summary.diverged.first();
        let why = first.and_then(|path| scenario.plan().why_lost(*path, &AtomicBool::new(false)));
        let why = why.map_or_else(
            || "use a smaller step".to_string(),
            |why| format!("of the first, {why}"),
        );
        remarks.push(format!(
            "every path diverged or was given up, so there are no statistics: {why}"
        ));
    }
    if let Some(reason @ EndedBy::Hopeless(_)) = &outcome.ended_by {
        remarks.push(format!("the goal is out of reach: {reason}"));
    }
    let missed = |missed: &MissedGoal| {
        format!(
            "{} is not reached after {} paths",
            missed.goal, missed.paths
        )
    };
    remarks.extend(outcome.missed.iter().map(missed));
    Ok(remarks)
}

/// Simulates one path of the ensemble of a scenario again, with its events and the finest
/// trajectory that its scheme has.
#[pyfunction]
pub fn replay<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    path: u64,
    progress: Callback,
) -> PyResult<Variables<'py>> {
    let scenario = scenario.checked.clone();
    let paths = scenario.ensemble.paths;
    if path >= paths {
        let remedy = format!("give a number from 0 to {}", paths.saturating_sub(1));
        return Err(errors::of_argument(
            py,
            "path",
            path,
            format!("the ensemble has {paths} paths"),
            &remedy,
        ));
    }
    let dataset = abandoned_on_interrupt(py, &progress, move |watch| {
        watch.begins("simulating the path");
        Dataset::of_replay(&Replay::of(&scenario, path))
    })?;
    to_python(py, dataset)
}

/// x and x' of path number `path` after further overrides, at these times: two rows.
#[pyfunction]
pub fn motion<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    overrides: Vec<Laid>,
    times: PyReadonlyArray1<'_, f64>,
    path: u64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let checked = scenario
        .with(&laid(&overrides))
        .map_err(|error| errors::of_scenario(py, &error))?;
    let times = times.as_array().to_vec();
    let end = checked.time.end;
    if let Some(outside) = times.iter().find(|time| !(0.0..=end).contains(*time)) {
        return Err(errors::of_argument(
            py,
            "times",
            outside,
            format!("must be between 0 and {end}"),
            "give times of the run, or a later `time.end`",
        ));
    }
    let states = errors::guarded(py, || {
        py.detach(|| Run::of(&checked).motion(path, &times))
            .map_err(|error| {
                let remedy = "change the numbers, or use a smaller step or tolerance";
                errors::of_run(py, error, remedy)
            })
    })?;
    let rows = [0, 1].map(|i| states.iter().map(|state| state[i]).collect());
    Ok(PyArray2::from_vec2(py, &rows)?)
}
