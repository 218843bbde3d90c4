//! Calibrations of synthetic measurements ("twins"), whose true parameters are known.
//!
//! The measurements are made by `bearing::calibration::twin`, except that of `examples/bridge`,
//! which another program made.

mod accuracy;
mod bridge;
mod causes;
mod forecast;
mod imperfections;
mod limits;
mod loggers;
mod table;
