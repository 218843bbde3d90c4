//! A data set as one JSON object, in the form that `xarray.Dataset.from_dict` reads.

use crate::output::document::{document, named};
use serde_json::{Map, Value, json};
use std::path::Path;
use stickslip::dataset::{Attribute, Column, Dataset, Entry};

/// The data set of this file, written or to be written. Numbers that are not finite are null.
pub fn json(dataset: &Dataset, file: Option<&Path>) -> String {
    document("data set", object(dataset, file))
}

/// The same for a data set without a file, with the warnings about it, each with its name.
pub fn json_with(dataset: &Dataset, warnings: &[(String, String)]) -> String {
    let mut object = object(dataset, None);
    object["warnings"] = named(warnings);
    document("data set", object)
}

fn object(dataset: &Dataset, file: Option<&Path>) -> Value {
    let is_coordinate = |entry: &&Entry| entry.axes == [entry.name.as_str()];
    let (coordinates, others): (Vec<&Entry>, Vec<&Entry>) =
        dataset.entries.iter().partition(is_coordinate);
    let all = |entries: Vec<&Entry>| -> Map<String, Value> {
        entries
            .into_iter()
            .map(|entry| (entry.name.clone(), variable(dataset, entry)))
            .collect()
    };
    json!({
        "file": file.map(|file| file.display().to_string()),
        "attrs": attributes(&dataset.attributes),
        "coords": all(coordinates),
        "data_vars": all(others),
    })
}

fn variable(dataset: &Dataset, entry: &Entry) -> Value {
    let values = match &entry.column {
        Column::F64(values) => json!(values),
        Column::U64(values) => json!(values),
        Column::U32(values) => json!(values),
        Column::I8(values) => json!(values),
        Column::U8(values) => json!(values),
        Column::Text(values) => json!(values),
    };
    let Value::Array(values) = values else {
        return Value::Null;
    };
    let data = nested(&mut values.into_iter(), &dataset.shape(entry));
    json!({ "dims": entry.axes, "attrs": attributes(&entry.attributes), "data": data })
}

/// Values, the last axis fastest, as arrays of arrays.
fn nested(values: &mut impl Iterator<Item = Value>, shape: &[usize]) -> Value {
    match shape {
        [] => values.next().unwrap_or_default(),
        [length, inner @ ..] => (0..*length).map(|_| nested(values, inner)).collect(),
    }
}

fn attributes(of: &[(String, Attribute)]) -> Map<String, Value> {
    let value = |attribute: &Attribute| match attribute {
        Attribute::Text(text) => json!(text),
        Attribute::Real(number) => json!(number),
        Attribute::Count(number) => json!(number),
        Attribute::Flags(numbers) => json!(numbers),
    };
    of.iter()
        .map(|(name, attribute)| (name.clone(), value(attribute)))
        .collect()
}
