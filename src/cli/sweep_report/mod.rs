//! A sweep, for people and for machines: pure functions of what is known of its points.

mod json;
mod table;

pub use json::json;
pub use table::{remarks, table};
