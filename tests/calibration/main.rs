//! Calibrations of synthetic twins, whose truth is known.
//!
//! The twins of these tests are made by `study::calibration::twin`; that of `examples/bridge` was
//! made by another program.

mod accuracy;
mod bridge;
mod flaws;
mod forecast;
mod limits;
