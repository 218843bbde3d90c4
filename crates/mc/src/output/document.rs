//! The members that identify every JSON object of the program.

use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use stickslip::engine::{PROGRAM_VERSION, commit};

/// The schema version, one for all objects together (docs/commands.md). It increases when a key
/// changes its meaning or is removed, but not when a key is added.
pub const SCHEMA_VERSION: u32 = 1;

/// Warnings as JSON, each with a name that programs can compare.
pub fn named(warnings: &[(String, String)]) -> Value {
    warnings
        .iter()
        .map(|(name, text)| json!({ "name": name, "text": text }))
        .collect()
}

/// One object of this kind as text that ends with a line break. Numbers that are not finite are
/// null.
pub fn document(kind: &str, body: Value) -> String {
    let program = json!({ "name": "mc", "version": PROGRAM_VERSION, "commit": commit() });
    let begin = json!({ "document": kind, "schema_version": SCHEMA_VERSION, "program": program });
    format!("{:#}\n", joined(begin, body))
}

/// The members of one object, followed by those of another.
pub fn joined(mut object: Value, more: Value) -> Value {
    if let (Value::Object(members), Value::Object(more)) = (&mut object, more) {
        members.extend(more);
    }
    object
}

/// The SHA-256 of a text in hexadecimal digits, as `sha256sum` prints it.
pub fn sha256(text: &str) -> String {
    Sha256::digest(text.as_bytes())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hash of "abc" in FIPS 180-4.
    #[test]
    fn the_hash_is_that_of_sha256sum() {
        let known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256("abc"), known);
    }

    #[test]
    fn an_object_says_what_it_is_before_what_it_holds() {
        let text = document("sample", json!({ "answer": 42.0, "nothing": f64::NAN }));
        let value: Value = serde_json::from_str(&text).expect("valid JSON");
        assert!(
            text.starts_with("{\n  \"document\": \"sample\",\n  \"schema_version\": 1,"),
            "{text}"
        );
        assert_eq!(value["program"]["version"], PROGRAM_VERSION);
        assert_eq!(
            (&value["answer"], &value["nothing"]),
            (&42.0.into(), &Value::Null)
        );
    }
}
