//! A bridge's bearing that sticks: from two columns of measurements to friction, wear and forecast.
//! Nothing here makes a run of many paths, and the engine does not depend on this crate.
//!
//! ```text
//! calibration  friction, stiffness and dilatation from measured temperatures and displacements,
//!              and synthetic measurements from known values
//! weather      harmonics and one or two noise processes fitted to a measured temperature
//! forecast     displacements, forces and slips of coming years, from a calibration and a weather
//! linear       small systems of linear equations
//! moments      mean, variance and correlation of samples
//! unsound      samples that no study can use
//! warning      all warnings, in one table
//! ```

#![deny(missing_docs)]

pub mod calibration;
pub mod forecast;
mod linear;
mod moments;
mod unsound;
mod warning;
pub mod weather;

pub use unsound::Unsound;
pub use warning::{WARNINGS, WarningKind};
