//! The report of a sweep, for people and for programs: pure functions of the points that are done.

mod json;
mod table;

pub use json::json;
pub use table::{remarks, rows, table};
