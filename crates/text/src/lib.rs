//! Numbers with the digits that people need, and excerpts of a text, for messages and tables.

mod digits;
pub mod excerpt;
pub mod numbers;
