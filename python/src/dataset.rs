//! Conversion of data sets of the engine to NumPy arrays, which take over the memory with the
//! values, and back.

use numpy::{Element, IntoPyArray as _, PyArrayDyn, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyList, PyString, PyTuple};
use stickslip::dataset::{Attribute, Column, Dataset, Entry};

/// Converts a data set to its attributes, and for each variable its name, dimensions, values and
/// attributes.
pub fn to_python<'py>(
    py: Python<'py>,
    mut dataset: Dataset,
) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyList>)> {
    let shapes: Vec<Vec<usize>> = dataset
        .entries
        .iter()
        .map(|entry| dataset.shape(entry))
        .collect();
    let variables = PyList::empty(py);
    for (entry, shape) in std::mem::take(&mut dataset.entries).into_iter().zip(shapes) {
        let axes = PyTuple::new(py, &entry.axes)?;
        variables.append((
            entry.name,
            axes,
            array(py, entry.column, &shape)?,
            attributes(py, &entry.attributes)?,
        ))?;
    }
    Ok((attributes(py, &dataset.attributes)?, variables))
}

/// The values as an array of this shape. Numbers are not copied.
fn array<'py>(py: Python<'py>, column: Column, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    Ok(match column {
        Column::F64(values) => values.into_pyarray(py).reshape(shape)?.into_any(),
        Column::U64(values) => values.into_pyarray(py).reshape(shape)?.into_any(),
        Column::U32(values) => values.into_pyarray(py).reshape(shape)?.into_any(),
        Column::I8(values) => values.into_pyarray(py).reshape(shape)?.into_any(),
        Column::U8(values) => values.into_pyarray(py).reshape(shape)?.into_any(),
        Column::Text(names) => py
            .import("numpy")?
            .call_method1("array", (names,))?
            .call_method1("reshape", (PyTuple::new(py, shape)?,))?,
    })
}

/// The attributes, with the types that a reader of the file would see.
fn attributes<'py>(
    py: Python<'py>,
    attributes: &[(String, Attribute)],
) -> PyResult<Bound<'py, PyDict>> {
    let numpy = py.import("numpy")?;
    let dictionary = PyDict::new(py);
    for (name, value) in attributes {
        match value {
            Attribute::Text(text) => dictionary.set_item(name, text)?,
            Attribute::Real(number) => {
                dictionary.set_item(name, numpy.call_method1("float64", (*number,))?)?
            }
            Attribute::Count(number) => {
                dictionary.set_item(name, numpy.call_method1("uint64", (*number,))?)?
            }
            Attribute::Flags(values) => {
                dictionary.set_item(name, values.clone().into_pyarray(py))?
            }
        }
    }
    Ok(dictionary)
}

/// A data set from Python: attributes, and for each variable its name, dimensions, values and
/// attributes.
pub type Handed<'py> = (
    Bound<'py, PyDict>,
    Vec<(String, Vec<String>, Bound<'py, PyAny>, Bound<'py, PyDict>)>,
);

/// Converts a data set from Python to one of the engine. Values of types that the engine does not
/// know are left out.
pub fn from_python((attributes, variables): Handed<'_>) -> PyResult<Dataset> {
    let entry =
        |(name, axes, values, own): (String, Vec<String>, Bound<'_, PyAny>, Bound<'_, PyDict>)| {
            let Some(column) = column(&values)? else {
                return Ok(None);
            };
            Ok(Some(Entry {
                name,
                axes,
                attributes: read_attributes(&own)?,
                column,
            }))
        };
    let entries = variables
        .into_iter()
        .filter_map(|variable| entry(variable).transpose())
        .collect::<PyResult<_>>()?;
    Ok(Dataset::of(read_attributes(&attributes)?, entries))
}

fn numbers<T: Element + Copy>(values: &Bound<'_, PyAny>) -> Option<Vec<T>> {
    let array = values.cast::<PyArrayDyn<T>>().ok()?;
    Some(array.readonly().as_array().iter().copied().collect())
}

fn column(values: &Bound<'_, PyAny>) -> PyResult<Option<Column>> {
    let number = numbers(values).map(Column::F64);
    let number = number
        .or_else(|| numbers(values).map(Column::U64))
        .or_else(|| numbers(values).map(Column::U32));
    let number = number
        .or_else(|| numbers(values).map(Column::I8))
        .or_else(|| numbers(values).map(Column::U8));
    match number {
        Some(column) => Ok(Some(column)),
        None => Ok(values
            .call_method0("ravel")?
            .call_method0("tolist")?
            .extract()
            .map(Column::Text)
            .ok()),
    }
}

fn read_attributes(attributes: &Bound<'_, PyDict>) -> PyResult<Vec<(String, Attribute)>> {
    let mut read = Vec::new();
    for (name, value) in attributes {
        let value = if value.is_instance_of::<PyString>() {
            Attribute::Text(value.extract()?)
        } else if value.is_instance_of::<PyFloat>() {
            Attribute::Real(value.extract()?)
        } else if let Some(flags) = numbers(&value) {
            Attribute::Flags(flags)
        } else if let Ok(count) = value.extract() {
            Attribute::Count(count)
        } else {
            continue;
        };
        read.push((name.extract()?, value));
    }
    Ok(read)
}
