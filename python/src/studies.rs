//! Studies of many runs: the choice for an accuracy, sweeps, trades.

use crate::dataset::to_python;
use crate::errors;
use crate::own::{OwnEstimate, OwnStatistics};
use crate::run::Variables;
use crate::scenario::Scenario;
use crate::watched::{Callback, watched};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::time::Duration;
use stickslip::config::{Override, symbol_and_meaning};
use stickslip::dataset::Dataset;
use stickslip::ensemble::{MOST_THREADS, check_threads};
use stickslip::memory::{Need, Short};
use stickslip::scenario::Scenario as Checked;
use stickslip::stats::{BlockResult, Statistic};
use stickslip::study::accuracy::{Accuracy, AccuracyGoal};
use stickslip::study::sweep::{
    Design, DesignError, RELATIVE_STEPS, Seeds, Setting, StarError, Sweep, SweepAxis,
    SweepQuestion, SweepSimulation,
};
use stickslip::study::trade::{Limits, measure_within};

/// The number of threads of a call: the given one, or one for each core. The system starts so many.
#[derive(Clone, Copy)]
pub struct ThreadCount(pub usize);

impl<'py> FromPyObject<'_, 'py> for ThreadCount {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let cores = || {
            std::thread::available_parallelism()
                .map_or(1, usize::from)
                .min(MOST_THREADS)
        };
        let wrong = |problem: String| {
            errors::of_argument(given.py(), "threads", given.to_string(), problem, REMEDY)
        };
        let number = match given.is_none() {
            true => cores(),
            false => given
                .extract()
                .map_err(|_| wrong("must be a number of threads".into()))?,
        };
        check_threads(number).map_err(|error| wrong(error.to_string()))?;
        Ok(ThreadCount(number))
    }
}

const REMEDY: &str = "give 1 to 1024, or None for one per core; the results do not depend on it";

/// Refuses a run of so many paths for which there is too little memory.
pub fn enough_memory(
    py: Python<'_>,
    scenario: &Checked,
    paths: u64,
    ThreadCount(threads): ThreadCount,
) -> PyResult<()> {
    let need = Need {
        bytes: scenario.run_bytes(paths, threads),
        threads,
    };
    need.check().map_err(|Short { needed, free, limit }| {
        let megabytes = |bytes: f64| (bytes / 1e6).round();
        let (needed, free) = (megabytes(needed), megabytes(free));
        let problem =
            format!("the run needs about {needed} MB of memory on {threads} threads, but {limit} leaves {free} MB");
        errors::of_run(py, &problem, "use fewer threads, a larger time.output_step, or record less per path")
    })
}

/// The statistic with this name.
pub fn statistic(py: Python<'_>, name: &str) -> PyResult<Statistic> {
    let remedy = "write one of stickslip.STATISTICS";
    Statistic::from_name(name)
        .ok_or_else(|| errors::of_argument(py, "statistic", name, "unknown statistic", remedy))
}

/// The scenario with scheme, step or tolerance, and paths chosen for a relative error; and that
/// choice as text.
#[pyfunction]
pub fn choose(
    py: Python<'_>,
    scenario: &Scenario,
    accuracy: f64,
    statistic: Vec<String>,
    max_time: Option<f64>,
    threads: ThreadCount,
    progress: Callback,
) -> PyResult<(Scenario, String)> {
    let named = statistic
        .iter()
        .map(|name| self::statistic(py, name))
        .collect::<PyResult<Vec<_>>>()?;
    let max_time = max_time.map(Duration::from_secs_f64);
    let accuracy = Accuracy {
        target: accuracy,
        named: &named,
        max_time,
        threads: threads.0,
    };
    let (chosen, is_interrupted) = watched(py, &progress, |watch| {
        let begins = |what: &str| watch.begins(&format!("pilot run: {what}"));
        accuracy.choose(
            &scenario.checked,
            Limits {
                stop: Some(&watch.stop),
                begins: Some(&begins),
                ..Limits::default()
            },
        )
    })?;
    if is_interrupted {
        return Err(PyKeyboardInterrupt::new_err(
            "interrupted during the pilot run",
        ));
    }
    let remedy = "use a larger error, more time, or fewer statistics; trade() gives details";
    let (decision, _) =
        chosen.map_err(|error| errors::of_run(py, format!("accuracy: {error}"), remedy))?;
    let accuracy_goal: AccuracyGoal = decision.accuracy_goal();
    Ok((
        scenario.replaced(decision.scenario),
        accuracy_goal.to_string(),
    ))
}

/// Computes statistics as functions of keys, with `vary` as `mc sweep --vary` takes it, or the
/// elasticities of keys. Returns the data set, the user-defined statistics at each point, and
/// whether it was interrupted.
#[pyfunction]
pub fn sweep<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    vary: Vec<String>,
    zip: bool,
    elasticity: Vec<String>,
    relative_step: f64,
    independent: bool,
    bias: bool,
    own: Vec<Py<PyAny>>,
    threads: ThreadCount,
    progress: Callback,
) -> PyResult<(Variables<'py>, Vec<Vec<OwnEstimate>>, bool)> {
    let design = design(py, scenario, &vary, zip, elasticity, relative_step)?;
    let laid = |setting: &Setting| setting.change(&format!("{}, swept to", setting.key));
    let point = |settings: &[Setting]| {
        let own: Vec<Override> = settings.iter().map(laid).collect();
        scenario
            .with(&own)
            .map_err(|error| errors::of_scenario(py, &error))
    };
    let seeds = if independent {
        Seeds::Independent
    } else {
        Seeds::Common
    };
    let question = SweepQuestion::at_each(design, seeds, bias, point)?;
    for point in &question.points {
        enough_memory(py, point, point.ensemble.paths, threads)?;
    }
    let mut swept = Sweep::new(question);
    let points = &swept.question.points;
    let paths = points.iter().map(|point| point.ensemble.paths).sum();
    let mut owns: Vec<_> = points
        .iter()
        .map(|point| OwnStatistics::new(point, &own))
        .collect();
    let mut failure = None;
    let mut show = |point: usize, block: &BlockResult| match owns[point].show(block) {
        Ok(()) => ControlFlow::Continue(()),
        Err(error) => {
            failure = Some(error);
            ControlFlow::Break(())
        }
    };
    let (ended, is_interrupted) = watched(py, &progress, |watch| {
        let simulation = SweepSimulation {
            threads: threads.0,
            stop: &watch.stop,
            progress: &mut watch.paths(paths),
            blocks: (!own.is_empty()).then_some(&mut show),
        };
        simulation.run(&mut swept, |_| Ok::<(), Infallible>(()))
    })?;
    ended.map_err(|error| errors::of_run(py, &error, "report it"))?;
    if let Some(error) = failure {
        return Err(error);
    }
    if swept.done() == 0 {
        return Err(PyKeyboardInterrupt::new_err(
            "interrupted before the first point was done",
        ));
    }
    // A point that was interrupted has none.
    let estimates = swept
        .points
        .iter()
        .zip(&owns)
        .map(|(point, owns)| match point {
            Some(_) => owns.estimates(),
            None => vec![[f64::NAN; 4]; own.len()],
        });
    let estimates = estimates.collect();
    Ok((
        to_python(py, Dataset::of_sweep(&swept))?,
        estimates,
        is_interrupted,
    ))
}

/// What a sweep varies: keys over values, or each key of `elasticity` up and down. Refuses scenarios
/// with curves.
fn design(
    py: Python<'_>,
    scenario: &Scenario,
    vary: &[String],
    zip: bool,
    elasticity: Vec<String>,
    relative_step: f64,
) -> PyResult<Design> {
    if let Some(key) = scenario.checked.record.curve() {
        let remedy = format!("turn it off, or run each point with ss.run and {key} = true");
        return Err(errors::of_argument(
            py,
            "scenario",
            key,
            "a sweep stores statistics only, no curves",
            &remedy,
        ));
    }
    if elasticity.is_empty() {
        let symbol = |key: &str| symbol_and_meaning(key).map(|(symbol, _)| symbol.to_string());
        let remedy = "give {key: values}, where values are numbers, names of files, \"START:STOP:COUNT\" or \"log:START:STOP:COUNT\"";
        let axis = |text: &String| {
            SweepAxis::parse(text, symbol).map_err(|error| {
                // Its own remedy is for those who write the values as a text.
                let problem = error.to_string().replace(&error.remedy, remedy);
                errors::of_argument(py, "vary", text, &problem, remedy)
            })
        };
        let axes = vary.iter().map(axis).collect::<PyResult<Vec<_>>>()?;
        let remedy = "give different names, equal numbers of values with zip, or fewer values";
        let refused =
            |error: DesignError| errors::of_argument(py, "vary", vary.join(", "), &error, remedy);
        Design::of(axes, zip).map_err(refused)
    } else {
        star(py, scenario, elasticity, relative_step)
    }
}

fn star(
    py: Python<'_>,
    scenario: &Scenario,
    keys: Vec<String>,
    relative_step: f64,
) -> PyResult<Design> {
    if !RELATIVE_STEPS.contains(&relative_step) {
        let problem = "out of range";
        return Err(errors::of_argument(
            py,
            "relative_step",
            relative_step,
            problem,
            "must be between 1e-6 and 0.5",
        ));
    }
    let star = Design::star(&keys, relative_step, |key| scenario.checked.number_at(key));
    star.map_err(|(key, error)| {
        let remedy = match error {
            StarError::NoNumber => "check(scenario).toml has every key",
            StarError::Zero => "give it a value with `set`",
            StarError::Twice => "list it once",
        };
        errors::of_argument(py, "elasticity", &key, &error, remedy)
    })
}

/// Measures what accuracy costs, for `budget` seconds. Returns the data set, and whether it was
/// interrupted.
#[pyfunction]
pub fn trade<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    budget: f64,
    threads: ThreadCount,
    progress: Callback,
) -> PyResult<(Variables<'py>, bool)> {
    let scenario = &scenario.checked;
    if !(1.0..=604_800.0).contains(&budget) {
        return Err(errors::of_argument(
            py,
            "budget",
            budget,
            "must be a duration from one second to a week",
            "give 1 to 604800 seconds",
        ));
    }
    enough_memory(py, scenario, scenario.ensemble.paths, threads)?;
    let (measured, is_interrupted) = watched(py, &progress, |watch| {
        let begins = |what: &str| watch.begins(&format!("measuring for about {budget} s: {what}"));
        let limits = Limits {
            stop: Some(&watch.stop),
            begins: Some(&begins),
            ..Limits::default()
        };
        measure_within(scenario, Duration::from_secs_f64(budget), threads.0, limits)
    })?;
    let measured = measured.map_err(|error| match is_interrupted {
        true => PyKeyboardInterrupt::new_err("interrupted before there was a result"),
        false => errors::of_run(py, &error, "use a larger budget, or a shorter time.end"),
    })?;
    Ok((
        to_python(py, Dataset::of_trade(scenario, &measured))?,
        is_interrupted,
    ))
}
