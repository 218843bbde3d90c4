//! Scenarios: a text or a file with overrides and measured values, checked by the parser of the
//! command.

use crate::errors;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;
use std::sync::Arc;
use stickslip::advice::DerivedQuantity;
use stickslip::config::{self, Override, ScenarioError, Shipped};
use stickslip::model::{
    InputProcess, NamedSeries, OwnProcess, RandomInput, RandomProcess, Realisations, Rng, Series,
};
use stickslip::scenario::Scenario as Checked;

/// A checked scenario, and what it was read from.
#[pyclass(frozen)]
pub struct Scenario {
    pub checked: Checked,
    source: Source,
}

/// A text with overrides, and the measured values that belong to it, each by its table. The flag is
/// true if they are those that the text refers to, as in stored results, and false if they replace
/// them.
#[derive(Clone)]
struct Source {
    name: String,
    text: String,
    overrides: Vec<Override>,
    samples: Vec<NamedSeries>,
    drawn: Vec<RandomInput>,
    are_stored: bool,
    /// The shipped scenario that the text is, if it was not read from a file.
    shipped: Option<&'static Shipped>,
}

impl Source {
    fn parse(&self, more: &[Override]) -> Result<Checked, ScenarioError> {
        let Source {
            name,
            text,
            overrides,
            samples,
            drawn,
            are_stored,
            shipped,
        } = self;
        let overrides = [overrides, more].concat();
        match shipped {
            Some(shipped) if samples.is_empty() && drawn.is_empty() => shipped.parse(&overrides),
            _ if *are_stored => Checked::parse_stored(name, text, &overrides, samples),
            _ => Checked::parse_drawn(name, text, &overrides, samples, drawn),
        }
    }
}

impl Scenario {
    /// The scenario after further overrides.
    pub fn with(&self, more: &[Override]) -> Result<Checked, ScenarioError> {
        self.source.parse(more)
    }

    /// Another checked scenario with the same source.
    pub fn replaced(&self, checked: Checked) -> Scenario {
        Scenario {
            checked,
            source: self.source.clone(),
        }
    }
}

#[pymethods]
impl Scenario {
    /// The title: what the scenario asks, in one line.
    #[getter]
    fn title(&self) -> &str {
        &self.checked.title
    }

    /// The number of paths.
    #[getter]
    fn paths(&self) -> u64 {
        self.checked.ensemble.paths
    }

    /// The label of the unit of time.
    #[getter]
    fn time_unit(&self) -> &str {
        &self.checked.units.time
    }

    /// The whole scenario as TOML, with every default written out.
    #[getter]
    fn toml(&self) -> String {
        self.checked.to_toml()
    }

    /// The number at a dotted key; None if there is no such number.
    fn number_at(&self, key: &str) -> Option<f64> {
        self.checked.number_at(key)
    }

    /// The numbers that follow from the scenario, by name.
    fn derived<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dictionary = PyDict::new(py);
        for (name, _, quantity) in self.checked.derived().quantities() {
            match quantity {
                DerivedQuantity::Unknown => dictionary.set_item(name, py.None())?,
                DerivedQuantity::Real(number) => dictionary.set_item(name, number)?,
                DerivedQuantity::Count(number) => dictionary.set_item(name, number)?,
                DerivedQuantity::Reals(numbers) => dictionary.set_item(name, numbers)?,
            }
        }
        Ok(dictionary)
    }

    /// Name and sentence of each warning. With `measures_bias`, warnings that only estimate the
    /// bias that the run measures are left out.
    #[pyo3(signature = (measures_bias = false))]
    fn warnings(&self, measures_bias: bool) -> Vec<(&'static str, String)> {
        let measures = measures_bias && self.checked.bias_plan(self.checked.ensemble.paths).is_ok();
        let due = self.checked.warnings_of_run(measures);
        due.iter()
            .map(|warning| (warning.name(), warning.to_string()))
            .collect()
    }
}

/// An override: what messages call it, with its value behind; its key, and the value as TOML.
pub type Laid = (String, String, String);

/// The overrides that Python gives.
pub fn laid(given: &[Laid]) -> Vec<Override> {
    let read = |(shown, key, value): &Laid| Override::flag(shown, key, value);
    given.iter().map(read).collect()
}

/// Reads and checks a scenario: the file with this name, or `text`, which has this name in
/// messages. `samples` are measured values, each by its table. With `are_stored`, they are those that
/// the text refers to, as in stored results; otherwise they replace them. `drawn` are realisations:
/// their table, their times, and an array with a row a path, or a function of a generator and the
/// times.
#[pyfunction]
#[pyo3(signature = (name, text, overrides, samples = Vec::new(), are_stored = false, drawn = Vec::new()))]
pub fn parse(
    py: Python<'_>,
    name: &str,
    text: Option<&str>,
    overrides: Vec<Laid>,
    samples: Vec<(String, PyReadonlyArray1<'_, f64>, PyReadonlyArray1<'_, f64>)>,
    are_stored: bool,
    drawn: Vec<(String, PyReadonlyArray1<'_, f64>, Bound<'_, PyAny>)>,
) -> PyResult<Scenario> {
    let wrong = |error: ScenarioError| errors::of_scenario(py, &error);
    let overrides = laid(&overrides);
    let shipped =
        text.and_then(|text| config::shipped(name).filter(|shipped| shipped.text == text));
    let (name, text) = match text {
        Some(text) => (name.to_string(), text.to_string()),
        None => config::text_of(Path::new(name)).map_err(wrong)?,
    };
    let series =
        |(name, times, values): (String, PyReadonlyArray1<'_, f64>, PyReadonlyArray1<'_, f64>)| {
            let series = Series::new(times.as_array().to_vec(), values.as_array().to_vec())
                .map_err(|error| {
                    let remedy = "give finite values at ascending times, at least two of them";
                    errors::of_argument(py, &name, "the samples", error, remedy)
                })?;
            Ok(NamedSeries {
                name,
                series: series.into(),
            })
        };
    let samples = samples.into_iter().map(series).collect::<PyResult<_>>()?;
    let drawn = drawn
        .into_iter()
        .map(|(name, times, values)| own_input(py, name, times.as_array().to_vec(), &values))
        .collect::<PyResult<_>>()?;
    let source = Source {
        name,
        text,
        overrides,
        samples,
        drawn,
        are_stored,
        shipped,
    };
    let checked = errors::guarded(py, || source.parse(&[]).map_err(wrong))?;
    Ok(Scenario { checked, source })
}

/// An input whose realisations are given, or drawn by a function.
fn own_input(
    py: Python<'_>,
    name: String,
    times: Vec<f64>,
    values: &Bound<'_, PyAny>,
) -> PyResult<RandomInput> {
    let own: Arc<dyn InputProcess> = match values.extract::<PyReadonlyArray2<'_, f64>>() {
        Ok(values) => {
            let values = values.as_array().iter().copied().collect();
            let realisations = Realisations::new(times, values).map_err(|error| {
                let remedy =
                    "give finite values of shape (paths, time) at times that ascend from 0";
                errors::of_argument(py, &name, "the realisations", error, remedy)
            })?;
            Arc::new(realisations)
        }
        Err(_) => Arc::new(DrawnByPython {
            times,
            draw: values.clone().unbind(),
        }),
    };
    Ok(RandomInput {
        name,
        process: RandomProcess::Own(OwnProcess(own)),
        step: 1.0,
        envelope: None,
    })
}

/// A function of Python that draws the values of a path.
#[derive(Debug)]
struct DrawnByPython {
    times: Vec<f64>,
    draw: Py<PyAny>,
}

impl InputProcess for DrawnByPython {
    /// Without valid values, the path is lost, and the error is printed.
    fn draw(&self, path: u64, random: &mut dyn Rng, _: f64) -> Series {
        let drawn = Python::attach(|py| -> PyResult<Series> {
            let numpy = py.import("numpy")?;
            let seed = random.next_u64();
            let generator = numpy
                .getattr("random")?
                .call_method1("default_rng", (seed,))?;
            let times = PyArray1::from_slice(py, &self.times);
            let values = self.draw.call1(py, (generator, times))?;
            let values = numpy.call_method1("asarray", (values, "float64"))?;
            let values = values
                .extract::<PyReadonlyArray1<'_, f64>>()?
                .as_array()
                .to_vec();
            Series::new(self.times.clone(), values)
                .map_err(|error| PyValueError::new_err(format!("path {path}: {error}")))
        });
        drawn.unwrap_or_else(|error| {
            Python::attach(|py| error.write_unraisable(py, None));
            Series::unknown()
        })
    }
}

/// The key of a scenario that a word probably stands for, and its meaning.
#[pyfunction]
pub fn key_meant(word: &str) -> Option<(String, String)> {
    config::key_meant(word)
}

/// The argument, of those with these names, that a word probably stands for.
#[pyfunction]
pub fn option_meant(word: &str, names: Vec<String>) -> Option<String> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    config::option_meant(word, &names).map(str::to_string)
}

/// The text of the shipped scenario with this name; None if there is no such scenario.
#[pyfunction]
pub fn shipped(name: &str) -> Option<&'static str> {
    config::shipped(name).map(|shipped| shipped.text)
}
