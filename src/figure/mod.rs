//! Pictures of what was measured.

mod trade;

pub use trade::{Picture, work_precision};
