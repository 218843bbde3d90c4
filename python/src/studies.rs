//! Many runs, one question: the choice for an accuracy, sweeps, the trade, calibration.

use crate::dataset::to_python;
use crate::errors;
use crate::run::Variables;
use crate::scenario::Scenario;
use crate::watched::{Told, watched};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::convert::Infallible;
use std::path::Path;
use std::time::Duration;
use stick_slip::config::{self, BridgeScene, Override, symbol_and_meaning};
use stick_slip::data::{self, Name, TimeColumn, Wanted};
use stick_slip::dataset::Dataset;
use stick_slip::stats::Statistic;
use stick_slip::study::accuracy::{Accuracy, Promise};
use stick_slip::study::calibration::{Held, Lag, Method, Motion, Quantity, Question, Record, calibrate as calibrated};
use stick_slip::study::sweep::{Axis, Design, Question as Asked, Seeds, Setting, Simulation, Sweep};
use stick_slip::study::trade::{Limits, measure_within};

fn threads(threads: Option<usize>) -> usize {
    threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from)).max(1)
}

/// The statistic of a name.
pub fn statistic(py: Python<'_>, name: &str) -> PyResult<Statistic> {
    let remedy = "write one of stickslip.STATISTICS";
    Statistic::from_name(name)
        .ok_or_else(|| errors::of_argument(py, "statistic", name, "there is no such statistic", remedy))
}

/// The scenario with scheme, step or tolerance, and paths for a relative error; and what is promised.
#[pyfunction]
#[pyo3(signature = (scenario, target, statistics, max_time, workers))]
pub fn choose(
    py: Python<'_>,
    scenario: &Scenario,
    target: f64,
    statistics: Vec<String>,
    max_time: Option<f64>,
    workers: Option<usize>,
) -> PyResult<(Scenario, String)> {
    let named = statistics.iter().map(|name| statistic(py, name)).collect::<PyResult<Vec<_>>>()?;
    let max_time = max_time.map(Duration::from_secs_f64);
    let accuracy = Accuracy { target, named: &named, max_time, threads: threads(workers) };
    let (chosen, is_interrupted) = watched(py, None, |watch| {
        accuracy.choose(&scenario.checked, Limits { stop: Some(&watch.stop), ..Limits::default() })
    })?;
    if is_interrupted {
        return Err(PyKeyboardInterrupt::new_err("interrupted while choosing how to run it"));
    }
    let remedy = "ask for less, give more time, or name fewer statistics; trade() says more";
    let (decision, _) = chosen.map_err(|error| errors::of_run(py, &format!("accuracy: {error}"), remedy))?;
    let promise: Promise = decision.promise();
    Ok((scenario.replaced(decision.scenario), promise.to_string()))
}

/// Statistics as functions of keys: `vary` as `mc sweep --vary` takes it, or elasticities of some keys.
#[pyfunction]
#[pyo3(signature = (scenario, *, vary, zip, elasticity, relative_step, independent, bias, workers, progress))]
#[expect(clippy::too_many_arguments, reason = "they are keywords of one Python function")]
pub fn sweep<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    vary: Vec<String>,
    zip: bool,
    elasticity: Vec<String>,
    relative_step: f64,
    independent: bool,
    bias: bool,
    workers: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Variables<'py>, bool)> {
    let design = if elasticity.is_empty() {
        let symbol = |key: &str| symbol_and_meaning(key).map(|(symbol, _)| symbol.to_string());
        let remedy = "give {key: values}, where values are numbers, \"START:STOP:COUNT\" or \"log:START:STOP:COUNT\"";
        let axis = |text: &String| {
            Axis::parse(text, symbol).map_err(|error| errors::of_argument(py, "vary", text, &error.to_string(), remedy))
        };
        let axes = vary.iter().map(axis).collect::<PyResult<Vec<_>>>()?;
        let remedy = "give other names, as many values where they are zipped, or fewer";
        let refused = |error: stick_slip::study::sweep::DesignError| {
            errors::of_argument(py, "vary", &vary.join(", "), &error.to_string(), remedy)
        };
        Design::of(axes, zip).map_err(refused)?
    } else {
        star(py, scenario, elasticity, relative_step)?
    };
    let laid = |Setting { key, value }: &Setting| {
        // Counts and seeds are whole numbers.
        let is_whole = value.fract() == 0.0 && value.abs() < 1e15;
        let value = if is_whole { format!("{value:.0}") } else { format!("{value:?}") };
        Override::flag(&format!("{key}, swept to"), key, &value)
    };
    let point = |i: usize| {
        let own: Vec<Override> = design.settings(i).iter().map(laid).collect();
        scenario.with(&own).map_err(|error| errors::of_scenario(py, &error))
    };
    let points = (0..design.points()).map(point).collect::<PyResult<Vec<_>>>()?;
    let seeds = if independent { Seeds::Independent } else { Seeds::Common };
    let mut swept = Sweep::new(Asked::new(scenario.checked.clone(), design, points, seeds, bias));
    let (ended, is_interrupted) = watched(py, progress.as_ref(), |watch| {
        let simulation = Simulation { threads: threads(workers), stop: &watch.stop, progress: &mut Told(watch) };
        simulation.run(&mut swept, |_| Ok::<(), Infallible>(()))
    })?;
    ended.map_err(|error| errors::of_run(py, &error.to_string(), "report it"))?;
    if swept.done() == 0 {
        return Err(PyKeyboardInterrupt::new_err("interrupted before the first point was done"));
    }
    Ok((to_python(py, Dataset::of_sweep(&swept))?, is_interrupted))
}

fn star(py: Python<'_>, scenario: &Scenario, keys: Vec<String>, relative_step: f64) -> PyResult<Design> {
    let wrong =
        |value: &str, problem: &str, remedy: &str| errors::of_argument(py, "elasticity", value, problem, remedy);
    if !(1e-6..=0.5).contains(&relative_step) {
        let remedy = "give a share from 1e-6 to 0.5";
        let value = relative_step.to_string();
        return Err(errors::of_argument(py, "relative_step", &value, "no difference over it says something", remedy));
    }
    let mut named: Vec<(String, f64)> = Vec::new();
    for key in keys {
        match scenario.checked.number_at(&key) {
            None => return Err(wrong(&key, "the scenario has no number there", "check(scenario).toml has every key")),
            Some(0.0) => return Err(wrong(&key, "it is 0, and a share of 0 is 0", "give it a value with `set`")),
            Some(_) if named.iter().any(|(other, _)| *other == key) => {
                return Err(wrong(&key, "it is named twice", "name it once"));
            }
            Some(value) => named.push((key, value)),
        }
    }
    Ok(Design::Star { keys: named, relative_step })
}

/// What accuracy costs, measured for so many seconds.
#[pyfunction]
pub fn trade<'py>(
    py: Python<'py>,
    scenario: &Scenario,
    budget: f64,
    workers: Option<usize>,
) -> PyResult<(Variables<'py>, bool)> {
    let scenario = &scenario.checked;
    if !(1.0..=604_800.0).contains(&budget) {
        let value = budget.to_string();
        return Err(errors::of_argument(
            py,
            "budget",
            &value,
            "it is no time to measure for",
            "give 1 to 604800 seconds",
        ));
    }
    let (measured, is_interrupted) = watched(py, None, |watch| {
        let limits = Limits { stop: Some(&watch.stop), ..Limits::default() };
        measure_within(scenario, Duration::from_secs_f64(budget), threads(workers), limits)
    })?;
    let measured =
        measured.map_err(|error| errors::of_run(py, &error.to_string(), "a larger budget, or a shorter time.end"))?;
    Ok((to_python(py, Dataset::of_trade(scenario, &measured))?, is_interrupted))
}

/// Times and values of two measured quantities.
type Measured<'py> = [PyReadonlyArray1<'py, f64>; 4];

/// Friction, stiffness and dilatation of a bearing from its measured temperature and displacement: those of a CSV file, or arrays of
/// times and temperatures, times and displacements, in seconds, kelvin and metres.
#[pyfunction]
#[pyo3(signature = (name, text, overrides, file, arrays, *, method, fit, bounds, starts, lag, interval, displacement, unit, workers))]
#[expect(clippy::too_many_arguments, reason = "they are keywords of one Python function")]
pub fn calibrate<'py>(
    py: Python<'py>,
    name: &str,
    text: Option<&str>,
    overrides: Vec<(String, String)>,
    file: Option<&str>,
    arrays: Option<Measured<'py>>,
    method: &str,
    fit: Vec<String>,
    bounds: Vec<(String, f64, f64)>,
    starts: u32,
    lag: Option<f64>,
    interval: f64,
    displacement: Option<&str>,
    unit: Option<&str>,
    workers: Option<usize>,
) -> PyResult<(Variables<'py>, Vec<String>)> {
    let of_scenario = |error| errors::of_scenario(py, &error);
    let set = overrides.iter().map(|(key, value)| Override::set(&format!("{key}={value}")));
    let set = set.collect::<Result<Vec<_>, _>>().map_err(of_scenario)?;
    let (name, text) = match text {
        Some(text) => (name.to_string(), text.to_string()),
        None => config::text_of(Path::new(name)).map_err(of_scenario)?,
    };
    let scene = BridgeScene::parse(&name, &text, &set).map_err(of_scenario)?;
    let mut remarks = Vec::new();
    let record = match (file, &arrays) {
        (_, Some(arrays)) => {
            let [times, temperatures, when, readings] = arrays.each_ref().map(|array| array.as_array().to_vec());
            Record::of([&times, &temperatures], [&when, &readings])
        }
        (file, None) => read_record(py, file.unwrap_or_default(), &scene, displacement, unit, &mut remarks)?,
    };
    let quantity = |key: &str| {
        let found = FITTED.into_iter().find(|quantity| quantity.key() == key);
        let remedy = format!("write some of {}", FITTED.map(Quantity::key).join(", "));
        found.ok_or_else(|| errors::of_argument(py, "fit or bounds", key, "it is no parameter of a bearing", &remedy))
    };
    let fitted = fit.iter().map(|key| quantity(key)).collect::<PyResult<Vec<_>>>()?;
    let bounds =
        bounds.iter().map(|(key, low, high)| Ok((quantity(key)?, [*low, *high]))).collect::<PyResult<Vec<_>>>()?;
    let question = Question {
        method: Method::from_name(method).ok_or_else(|| {
            errors::of_argument(py, "method", method, "there is no such method", "write slips, err or both")
        })?,
        shear_stiffness: scene.shear_stiffness,
        starts,
        lag: lag.map_or(Lag::Auto, Lag::Known),
        level: interval,
        held: held(py, &scene, &fitted, &bounds)?,
        bounds,
        guess: guess(&scene, &record),
    };
    let (calibration, is_interrupted) =
        watched(py, None, |watch| calibrated(&record, &question, threads(workers), &watch.stop))?;
    let remedy = "measure for longer, see that the columns are right, or take method=\"err\"";
    let calibration = calibration.map_err(|error| errors::of_run(py, &error.to_string(), remedy))?;
    remarks.extend(calibration.warnings.iter().map(ToString::to_string));
    if is_interrupted {
        remarks.push("interrupted: fewer starts of the least squares than asked for".into());
    }
    Ok((to_python(py, Dataset::of_calibration(&scene.title, &scene.text, &calibration))?, remarks))
}

/// What can be fitted or held; f_s - f_d follows.
const FITTED: [Quantity; 6] = [
    Quantity::Stiffness,
    Quantity::Dilatation,
    Quantity::Static,
    Quantity::Dynamic,
    Quantity::Offset,
    Quantity::Displacement,
];

fn read_record(
    py: Python<'_>,
    file: &str,
    scene: &BridgeScene,
    displacement: Option<&str>,
    unit: Option<&str>,
    remarks: &mut Vec<String>,
) -> PyResult<Record> {
    let temperature = scene.value.as_deref().map_or(Name::Beginning("temperature"), Name::Exactly);
    let reading = displacement.map_or(Name::Beginning("displacement"), Name::Exactly);
    let wanted = [
        Wanted { column: temperature, quantity: data::Quantity::Temperature, unit: None, max_gap: None },
        Wanted { column: reading, quantity: data::Quantity::Displacement, unit, max_gap: None },
    ];
    let time = TimeColumn { name: &scene.time, zone: scene.zone.as_deref() };
    let table = data::read(Path::new(file), time, &wanted)
        .map_err(|error| errors::of_argument(py, "data", file, &error.to_string(), &error.remedy))?;
    if !table.in_seconds {
        let problem = format!("the name of column `{}` says no unit of time", scene.time);
        let remedy = "rename it, e.g. to `time_s` or `time_h`, and name it in temperature.series.time";
        return Err(errors::of_argument(py, "data", file, &problem, remedy));
    }
    remarks.extend(table.repairs.sentences());
    let [temperature, reading] = [&table.columns[0], &table.columns[1]];
    Ok(Record::of([&temperature.times, &temperature.values], [&reading.times, &reading.values]))
}

/// What is not fitted, and what the scenario says of it.
fn held(
    py: Python<'_>,
    scene: &BridgeScene,
    fitted: &[Quantity],
    bounds: &[(Quantity, [f64; 2])],
) -> PyResult<Vec<Held>> {
    let is_held = |quantity: &Quantity| !fitted.is_empty() && !fitted.contains(quantity);
    let held = FITTED.into_iter().filter(is_held).map(|quantity| {
        let value = match quantity {
            Quantity::Stiffness => Some(scene.stiffness),
            Quantity::Dilatation => Some(scene.dilatation),
            Quantity::Static => Some(scene.f_s),
            Quantity::Dynamic => Some(scene.f_d),
            Quantity::Offset => Some(scene.offset),
            _ => scene.displacement,
        };
        let remedy = "fit it as well, or give it a value with `set`";
        let absent =
            || errors::of_argument(py, "fit", quantity.key(), "it is left out, and no number in the scenario", remedy);
        Ok((quantity, value.ok_or_else(absent)?))
    });
    let held: Vec<Held> = held.collect::<PyResult<_>>()?;
    let mut told = held.iter().map(|(quantity, _)| *quantity).chain(bounds.iter().map(|(quantity, _)| *quantity));
    match told.find(|quantity| quantity.needs_shear_stiffness()) {
        Some(quantity) if scene.shear_stiffness.is_none() => {
            let problem = "it cannot be held or bounded, because it takes K_BP to know it";
            Err(errors::of_argument(py, "fit or bounds", quantity.key(), problem, "give bearing.stiffness"))
        }
        _ => Ok(held),
    }
}

/// Where a search begins if slips do not say so.
fn guess(scene: &BridgeScene, record: &Record) -> Motion {
    let slope = scene.stiffness * scene.dilatation;
    let first = record.temperatures.first().copied().unwrap_or(0.0);
    Motion {
        reach: scene.f_s / slope,
        jump: 2.0 * (scene.f_s - scene.f_d) / slope,
        start: scene.displacement.map_or(first, |x| x / scene.dilatation),
    }
}
