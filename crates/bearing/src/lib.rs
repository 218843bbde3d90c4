//! A bridge bearing with dry friction: from two columns of measurements to friction, wear and
//! forecast. It does not use the ensembles of the engine. It is a plug-in: neither the engine nor
//! the crates for files, figures and reports depend on it, and the command line lists its kinds of
//! results.
//!
//! ```text
//! calibration  friction, stiffness and dilatation from measured temperatures and displacements,
//!              and synthetic measurements from known values
//! weather      harmonics and one or two noise processes fitted to a measured temperature
//! forecast     displacements, forces and slips of future years, from a calibration and a weather
//! dataset      a calibration, a forecast and a synthetic record as data sets
//! figures      figures of a calibration and a forecast
//! report       tables and sentences about them
//! linear       small systems of linear equations
//! moments      mean, variance and correlation of samples
//! unsound      samples that no study can use
//! warning      all warnings, in one table
//! ```

pub mod calibration;
pub mod dataset;
pub mod figures;
pub mod forecast;
mod linear;
mod moments;
pub mod report;
mod unsound;
mod warning;
pub mod weather;

pub use unsound::Unsound;
pub use warning::{WARNINGS, WarningKind};
