//! MeasuredFiles bearings: calibration, weather, forecast of future years, and synthetic measurements.

use crate::dataset::to_python;
use crate::errors;
use crate::run::Variables;
use crate::studies::ThreadCount;
use crate::watched::{Callback, abandoned_on_interrupt};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict as _, PyDict};
use std::path::{Path, PathBuf};
use stickslip::config::{self, Override, ScenarioError};
use stickslip::scenario::{BridgeScene, Scenario as Checked};
use stickslip_bearing::calibration::{
    Air, Calibration, CalibrationError, CalibrationMethod, CalibrationQuestion, Imperfections, Lag,
    MeasuredRecord, NotHeld, Quantity, Response, calibrate as calibrated, twin as made, values,
};
use stickslip_bearing::dataset::{self, StoredCalibration};
use stickslip_bearing::forecast::{BearingForecast, ForecastError, ForecastQuestion as Asked};
use stickslip_bearing::weather::{Cycle, Process, WeatherFit, fit, usual};
use stickslip_data::{
    BearingData, ColumnQuantity, ColumnSource, DataError, DateOrder, Layout, Origin, Start,
    Wording, remedy,
};

/// A scenario from Python: its name in messages, its text (none if the name is that of a file), and
/// overrides as pairs of a key and a value in TOML.
type Given = (String, Option<String>, Vec<(String, String)>);

/// The bearing of a scenario, the name of the scenario, and its overrides.
fn read(
    py: Python<'_>,
    (name, text, overrides): Given,
) -> PyResult<(BridgeScene, String, Vec<Override>)> {
    let parsed = || -> Result<_, ScenarioError> {
        let laid =
            |(key, value): &(String, String)| Override::flag(&format!("set {key} ="), key, value);
        let overrides: Vec<_> = overrides.iter().map(laid).collect();
        let (name, text) = match &text {
            Some(text) => (name.clone(), text.clone()),
            None => config::text_of(Path::new(&name))?,
        };
        Ok((
            BridgeScene::parse(&name, &text, &overrides)?,
            name,
            overrides,
        ))
    };
    parsed().map_err(|error| errors::of_scenario(py, &error))
}

/// A measurement from Python. It is a file with this name, or a text that has this name in
/// messages. Or it is arrays of times and temperatures, then of times and displacements, in seconds,
/// degrees and metres, which are repaired already. The column of displacements may have a name.
#[derive(FromPyObject)]
pub struct MeasuredFiles<'py> {
    name: String,
    text: Option<String>,
    arrays: Option<Vec<PyReadonlyArray1<'py, f64>>>,
    displacement: Option<String>,
    layout: LaidOut,
    /// Those of the arrays, which Python has reported.
    repairs: Vec<String>,
}

/// A `stickslip.Layout`.
#[derive(FromPyObject)]
pub struct LaidOut {
    temperature: Option<String>,
    temperature_file: Option<PathBuf>,
    temperature_unit: Option<String>,
    displacement_unit: Option<String>,
    time: Option<String>,
    zone: Option<String>,
    dates: Option<String>,
    skip: Option<u64>,
    skip_bad: bool,
    missing: Vec<String>,
    outliers: Option<u64>,
    decimal: Option<String>,
    averaged: Option<f64>,
    of_temperatures: Option<Py<PyAny>>,
}

impl LaidOut {
    /// The layout of the temperatures, if it is another one.
    fn of_temperatures(&self, py: Python<'_>) -> PyResult<Option<LaidOut>> {
        self.of_temperatures
            .as_ref()
            .map(|other| other.extract(py))
            .transpose()
    }

    fn over(&self, py: Python<'_>, other: &Layout) -> PyResult<Layout> {
        let order = |word: &String| {
            let unknown = || {
                errors::of_argument(
                    py,
                    "dates",
                    word,
                    "must be an order of year, month and day",
                    "write ymd, dmy or mdy",
                )
            };
            DateOrder::from_word(word).ok_or_else(unknown)
        };
        let mark = |text: &String| match text.as_str() {
            "." => Ok('.'),
            "," => Ok(','),
            _ => Err(errors::of_argument(
                py,
                "decimal",
                text,
                "must be a decimal separator",
                "write \".\" or \",\"",
            )),
        };
        let layout = Layout {
            time: self.time.clone(),
            zone: self.zone.clone(),
            dates: self.dates.as_ref().map(order).transpose()?,
            skip: self.skip,
            skip_bad: self.skip_bad,
            missing: self.missing.clone(),
            is_of_other_file: false,
            outliers: self.outliers,
            decimal: self.decimal.as_ref().map(mark).transpose()?,
            averaged: self.averaged.map(|seconds| seconds as u64),
            step: None,
            wording: Wording::Argument,
        };
        Ok(layout.over(other))
    }
}

impl MeasuredFiles<'_> {
    fn origin(&self) -> Origin<'_> {
        match &self.text {
            Some(text) => Origin::Text(&self.name, text),
            None => Origin::File(Path::new(&self.name)),
        }
    }

    fn arrays(&self) -> Option<Vec<Vec<f64>>> {
        Some(
            self.arrays
                .as_ref()?
                .iter()
                .map(|array| array.as_array().to_vec())
                .collect(),
        )
    }

    fn wrong(&self, py: Python<'_>, error: &DataError) -> PyErr {
        errors::of_argument(py, "data", &self.name, error, &error.remedy)
    }

    /// The column of temperatures, as far as the arguments or a scenario name it.
    fn temperature_column(&self, scenario: &ColumnSource) -> ColumnSource {
        ColumnSource {
            column: self
                .layout
                .temperature
                .clone()
                .or_else(|| scenario.column.clone()),
            unit: self
                .layout
                .temperature_unit
                .clone()
                .or_else(|| scenario.unit.clone()),
            ..ColumnSource::default()
        }
    }

    /// The measurement in the columns that a scenario names, and what was repaired in it.
    fn record(
        &self,
        py: Python<'_>,
        scene: &BridgeScene,
    ) -> PyResult<(MeasuredRecord, Vec<String>)> {
        let of_temperatures = self.layout.of_temperatures(py)?;
        if let Some([times, temperatures, when, readings]) = self.arrays().as_deref() {
            let all = self.layout.averaged;
            let of_air = of_temperatures.and_then(|layout| layout.averaged);
            let averaged = [of_air.or(all), all].map(Option::unwrap_or_default);
            let mut record =
                MeasuredRecord::of_means([times, temperatures], [when, readings], averaged);
            record.repairs = self.repairs.clone();
            return Ok((record, Vec::new()));
        }
        let (air, sensor) = (&scene.temperature_source, &scene.displacement_source);
        let displacement = ColumnSource {
            file: None,
            column: self.displacement.clone().or_else(|| sensor.column.clone()),
            unit: self
                .layout
                .displacement_unit
                .clone()
                .or_else(|| sensor.unit.clone()),
            layout: self.layout.over(py, &sensor.layout)?,
        };
        let layout = self.layout.over(py, &air.layout)?;
        let temperature = ColumnSource {
            layout: match of_temperatures {
                Some(other) => other.over(py, &layout)?,
                None => layout,
            },
            ..self.temperature_column(air)
        };
        let temperatures = self.layout.temperature_file.as_deref().map(Origin::File);
        let pair = BearingData::read(self.origin(), temperatures, &temperature, &displacement);
        let measured = pair.map_err(|error| self.wrong(py, &error))?;
        Ok((MeasuredRecord::from(&measured), measured.repairs))
    }
}

/// Times, values, and what was repaired.
type Repaired<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Vec<String>,
);

/// Times and values of a measurement in memory, repaired as those of a file are, and what was
/// repaired. `quantity` is temperature or displacement.
#[pyfunction]
pub fn repaired<'py>(
    py: Python<'py>,
    argument: &str,
    quantity: &str,
    times: PyReadonlyArray1<'py, f64>,
    values: PyReadonlyArray1<'py, f64>,
    outliers: Option<u64>,
) -> PyResult<Repaired<'py>> {
    let quantities = [
        ColumnQuantity::Temperature,
        ColumnQuantity::Displacement,
        ColumnQuantity::Input,
    ];
    let quantity = quantities
        .into_iter()
        .find(|known| known.word() == quantity)
        .unwrap_or(quantities[0]);
    let (times, values) = (times.as_array().to_vec(), values.as_array().to_vec());
    let layout = Layout {
        outliers,
        ..Layout::default()
    };
    let (mut columns, repairs) = stickslip_data::arrays(&[(quantity, &times, &values)], &layout)
        .map_err(|error| errors::of_argument(py, argument, "the samples", &error, &error.remedy))?;
    let column = columns.swap_remove(0);
    let said = repairs.of_file(argument);
    Ok((
        PyArray1::from_vec(py, column.times),
        PyArray1::from_vec(py, column.values),
        said,
    ))
}

fn warnings(calibration: &Calibration) -> impl Iterator<Item = String> {
    calibration.warnings.iter().map(ToString::to_string)
}

/// The parameters of a bearing with these keys.
fn quantities(py: Python<'_>, keys: &[String]) -> PyResult<Vec<Quantity>> {
    let unknown = |key: &String| {
        let known = Quantity::FITTED.map(Quantity::key).join(", ");
        errors::of_argument(
            py,
            "fit or bounds",
            key,
            "it is not a parameter of a bearing",
            &format!("use one or more of {known}"),
        )
    };
    keys.iter()
        .map(|key| Quantity::fitted(key).ok_or_else(|| unknown(key)))
        .collect()
}

fn not_held(py: Python<'_>, error: NotHeld) -> PyErr {
    let (value, remedy) = match error {
        NotHeld::NoNumber(quantity) => {
            (quantity.key(), "fit it too, or give it a value with `set`")
        }
        NotHeld::TakesShearStiffness(quantity) => (
            quantity.key(),
            "give bearing.stiffness, in the scenario or with `set`",
        ),
        NotHeld::UnusedBounds => ("bounds", "use method=\"criterion\" or method=\"both\""),
    };
    errors::of_argument(py, "fit or bounds", value, error, remedy)
}

/// Estimates friction, stiffness and dilatation of a bearing from its measured temperature and
/// displacement. Returns the data set and warnings.
#[pyfunction]
pub fn calibrate<'py>(
    py: Python<'py>,
    scenario: Given,
    measured: MeasuredFiles<'py>,
    method: &str,
    fit: Vec<String>,
    bounds: Vec<(String, f64, f64)>,
    starts: u32,
    lag: Option<f64>,
    interval: f64,
    threads: ThreadCount,
    progress: Callback,
) -> PyResult<(Variables<'py>, Vec<String>)> {
    let (scene, ..) = read(py, scenario)?;
    let (record, mut remarks) = measured.record(py, &scene)?;
    let no_method = || {
        errors::of_argument(
            py,
            "method",
            method,
            "unknown method",
            "write slips, criterion or both",
        )
    };
    let fitted = quantities(py, &fit)?;
    let (keys, ranges): (Vec<_>, Vec<_>) = bounds
        .into_iter()
        .map(|(key, low, high)| (key, [low, high]))
        .unzip();
    let question = CalibrationQuestion {
        bounds: quantities(py, &keys)?.into_iter().zip(ranges).collect(),
        method: CalibrationMethod::from_name(method).ok_or_else(no_method)?,
        starts,
        lag: lag.map_or(Lag::Auto, Lag::Known),
        level: interval,
        ..CalibrationQuestion::of(&scene, &record)
    };
    let question = question
        .fitting(&fitted, &scene)
        .map_err(|error| not_held(py, error))?;
    let mark = record.mark.clone();
    let calibration = abandoned_on_interrupt(py, &progress, move |watch| {
        watch.begins("calibrating the bearing");
        calibrated(&record, &question, threads.0, &watch.stop)
    })?;
    let failed = |error: CalibrationError| {
        errors::of_run(py, &error, &remedy(mark.as_deref(), error.remedy()))
    };
    let calibration = calibration.map_err(failed)?;
    remarks.extend(warnings(&calibration));
    let stored = StoredCalibration::of(&scene.title, &scene.text, calibration);
    Ok((to_python(py, stored.dataset())?, remarks))
}

/// Simulates future years of a bearing that is calibrated from its slips, under the weather of the
/// same measurement. Returns the data set and warnings.
#[pyfunction]
pub fn forecast<'py>(
    py: Python<'py>,
    scenario: Given,
    measured: MeasuredFiles<'py>,
    draws: u64,
    years: u64,
    seed: u64,
    interval: f64,
    share: f64,
    processes: usize,
    threads: ThreadCount,
    progress: Callback,
) -> PyResult<(Variables<'py>, Vec<String>)> {
    let (scene, ..) = read(py, scenario)?;
    let (record, mut remarks) = measured.record(py, &scene)?;
    let asked = Asked {
        draws,
        years,
        seed,
        level: interval,
        share,
    };
    let (title, text) = (scene.title.clone(), scene.text.clone());
    let mark = record.mark.clone();
    let ended = abandoned_on_interrupt(py, &progress, move |watch| {
        let begins = |what: &str| watch.begins(what);
        BearingForecast::of(
            &scene,
            &record,
            &asked,
            processes,
            threads.0,
            &watch.stop,
            &begins,
        )
    })?;
    let failed =
        |error: ForecastError| errors::of_run(py, &error, &remedy(mark.as_deref(), error.remedy()));
    let outcome = ended.map_err(failed)?;
    let outcome = outcome.ok_or_else(|| PyKeyboardInterrupt::new_err(()))?;
    remarks.extend(outcome.warnings().into_iter().map(|(_, text)| text));
    Ok((
        to_python(py, dataset::forecast(&title, &text, &outcome))?,
        remarks,
    ))
}

/// The fields of `stickslip.Weather`, which are described there.
fn weather<'py>(
    py: Python<'py>,
    fit: &WeatherFit,
    start: Option<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let temperature = fit.temperature();
    let cycle = |c: &Cycle| {
        [
            ("period", c.period),
            ("amplitude", c.amplitude),
            ("phase", c.phase),
            ("standard_error", c.error),
        ]
        .into_py_dict(py)
    };
    let process = |p: &Process| {
        let rate = [
            ("relaxation_rate", p.relaxation_rate),
            ("relaxation_rate_relative_error", p.rate_error),
        ];
        [("sd", p.sd), ("sd_relative_error", p.sd_error)]
            .into_iter()
            .chain(rate)
            .into_py_dict(py)
    };
    let harmonics = temperature.harmonics.iter().map(|wave| {
        [
            ("amplitude", wave.amplitude),
            ("angular_frequency", wave.angular_frequency),
            ("phase", wave.phase),
        ]
        .into_py_dict(py)
    });
    let noises = temperature.effective_noises().map(|noise| {
        let numbers = [
            ("intensity", noise.intensity),
            ("relaxation_rate", noise.relaxation_rate),
        ];
        let numbers = numbers
            .into_iter()
            .chain([("diffusion", noise.diffusion)])
            .into_py_dict(py)?;
        numbers.set_item("initial", "stationary")?;
        Ok(numbers)
    });
    let tables = PyDict::new(py);
    tables.set_item("harmonics", harmonics.collect::<PyResult<Vec<_>>>()?)?;
    tables.set_item("noise", noises.collect::<PyResult<Vec<_>>>()?)?;
    let (mean, error) = fit.mean();
    let fields = PyDict::new(py);
    fields.set_item("samples", fit.samples)?;
    fields.set_item("duration", fit.duration)?;
    fields.set_item("mean", vec![mean, error])?;
    fields.set_item(
        "harmonics",
        fit.cycles()
            .iter()
            .map(cycle)
            .collect::<PyResult<Vec<_>>>()?,
    )?;
    fields.set_item(
        "processes",
        fit.processes()
            .iter()
            .map(process)
            .collect::<PyResult<Vec<_>>>()?,
    )?;
    fields.set_item("sensor_sd", fit.white)?;
    fields.set_item("smoothing", fit.smoothing().map(|(tau, _)| tau))?;
    fields.set_item("log_likelihood", fit.log_likelihood)?;
    fields.set_item("start", start)?;
    fields.set_item("toml", config::temperature_part(&temperature))?;
    fields.set_item("temperature", tables)?;
    Ok(fields)
}

/// Fits harmonics with these periods, in seconds, or with those of a year and a day that the samples
/// resolve, and one or two Ornstein-Uhlenbeck processes.
#[pyfunction]
pub fn fit_temperature<'py>(
    py: Python<'py>,
    measured: MeasuredFiles<'py>,
    processes: usize,
    periods: Option<Vec<f64>>,
    progress: Callback,
) -> PyResult<(Bound<'py, PyDict>, Vec<String>)> {
    let (times, temperatures, averaged, start, mut remarks) = match measured.arrays() {
        Some(mut arrays) => {
            let (values, times) = (
                arrays.pop().unwrap_or_default(),
                arrays.pop().unwrap_or_default(),
            );
            (
                times,
                values,
                measured.layout.averaged.unwrap_or_default(),
                None,
                Vec::new(),
            )
        }
        None => {
            let layout = measured.layout.over(py, &Layout::default())?;
            let source = ColumnSource {
                layout,
                ..measured.temperature_column(&ColumnSource::default())
            };
            let read = source.read(measured.origin(), ColumnQuantity::Temperature);
            let (column, start, repairs) = read.map_err(|error| measured.wrong(py, &error))?;
            let start = start.and_then(|start| start.after(-0.5 * column.averaged));
            (
                column.times,
                column.values,
                column.averaged,
                start.map(|start| start.to_string()),
                repairs,
            )
        }
    };
    let periods = periods.unwrap_or_else(|| {
        let (periods, said) = usual(&times);
        remarks.extend(said);
        periods
    });
    let found = abandoned_on_interrupt(py, &progress, move |watch| {
        watch.begins("fitting the temperature model");
        fit(&times, &temperatures, &periods, processes, averaged)
    })?;
    let fit = found.map_err(|error| errors::of_run(py, error, error.remedy()))?;
    let remarks = remarks.into_iter().chain(fit.warnings()).collect();
    Ok((weather(py, &fit, start)?, remarks))
}

/// The date of the first sample that an argument gives; a measured temperature has its own.
fn start_date(py: Python<'_>, start: Option<&str>, is_measured: bool) -> PyResult<Option<Start>> {
    let Some(date) = start else {
        return Ok(None);
    };
    let wrong = |problem, remedy| errors::of_argument(py, "start", date, problem, remedy);
    if is_measured {
        return Err(wrong(
            "the measured temperature already has dates",
            "remove it, or remove the measured temperature",
        ));
    }
    let invalid = || {
        wrong(
            "it is not a valid date",
            "write a date such as 2024-06-01, also with a time and a zone",
        )
    };
    Start::of_calendar(date).ok_or_else(invalid).map(Some)
}

/// The measured temperature in the file that a scenario names, the date at which it begins, and what
/// was repaired in it.
fn air_in_file(
    py: Python<'_>,
    scene: &BridgeScene,
    name: &str,
    text: Option<&str>,
    file: &str,
) -> PyResult<(Air, Option<Start>, Vec<String>)> {
    let shipped = text.and_then(|text| config::shipped(name).filter(|known| known.text == text));
    let built_in = shipped.and_then(|shipped| shipped.file(file));
    let origin = built_in.map_or(Origin::File(Path::new(file)), |text| {
        Origin::Text(file, text)
    });
    let read = scene
        .temperature_source
        .read(origin, ColumnQuantity::Temperature);
    let (column, begin, repairs) = read.map_err(|error| {
        errors::of_argument(py, "scenario", origin.name(), &error, &error.remedy)
    })?;
    Ok((Air::measured(column.times, column.values), begin, repairs))
}

/// Makes synthetic measurements of a bearing with the parameters of the scenario. The temperature
/// is a measured one, in a file or in arrays of times and values, or it is simulated from harmonics
/// and noise for `duration` seconds with a sample every `every` seconds. Returns the data set and
/// remarks.
#[pyfunction]
pub fn twin<'py>(
    py: Python<'py>,
    scenario: Given,
    temperature: Option<[PyReadonlyArray1<'py, f64>; 2]>,
    seed: u64,
    noise: (f64, f64, f64),
    scatter: f64,
    lag: f64,
    resolution: f64,
    spikes: f64,
    gaps: u32,
    drift: f64,
    zero_set: Option<(f64, f64)>,
    thermometer_every: usize,
    start: Option<String>,
    duration: f64,
    every: f64,
    progress: Callback,
) -> PyResult<(Variables<'py>, Vec<String>)> {
    let text = scenario.1.clone();
    let (scene, name, overrides) = read(py, scenario)?;
    let is_measured = temperature.is_some() || scene.temperature_source.file.is_some();
    let given = start_date(py, start.as_deref(), is_measured)?;
    let (air, begin, remarks) = match (temperature, &scene.temperature_source.file) {
        (Some([times, values]), _) => {
            let [times, values] = [times, values].map(|array| array.as_array().to_vec());
            (Air::measured(times, values), None, Vec::new())
        }
        (None, Some(file)) => air_in_file(py, &scene, &name, text.as_deref(), file)?,
        (None, None) => {
            let text = text.as_deref().unwrap_or(&scene.text);
            let scenario = Checked::parse(&name, text, &overrides)
                .map_err(|error| errors::of_scenario(py, &error))?;
            let samples = (duration / every) as usize;
            let air = abandoned_on_interrupt(py, &progress, move |watch| {
                watch.begins("simulating the temperature");
                Air::drawn(&scenario.model.temperature, samples, every, seed)
            })?;
            (air, None, Vec::new())
        }
    };
    let first = air.temperatures.first().copied().unwrap_or(0.0);
    let response = Response::of(&scene, first);
    let (white, red, memory) = noise;
    let imperfections = Imperfections {
        white,
        red,
        memory,
        scatter,
        lag,
        resolution,
        spikes,
        gaps,
        drift,
        zero_set,
        thermometer_every,
    };
    let truth = values(&response, scene.shear_stiffness);
    let found = abandoned_on_interrupt(py, &progress, move |watch| {
        watch.begins("making the record");
        made(&response, &air, &imperfections, seed)
    })?;
    let start = begin
        .or(given)
        .or_else(|| Start::parse(EPOCH))
        .map_or_else(|| EPOCH.to_string(), |start| start.to_string());
    Ok((
        to_python(py, dataset::twin(&scene.title, &start, &truth, &found))?,
        remarks,
    ))
}

/// The date of the first sample, if no measurement provides one.
const EPOCH: &str = "2015-01-01T00:00:00Z";
