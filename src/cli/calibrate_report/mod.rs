//! What `mc calibrate` prints, for people and for programs.

mod json;
mod table;

pub use json::json;
pub use table::{quantities, sources, table};
