//! Many runs, one question: what accuracy costs, how to run a scene for an error that is good enough, statistics as functions of
//! parameters, parameters from measurements, means by many levels.
//!
//! ```text
//! trade        every scheme over a ladder of settings: bias, variance, cost, and the cheapest for a target
//! calibration  from measured temperatures and displacements to friction, stiffness and dilatation
//! forecast     from both to what years to come bring
//! weather      from a measured temperature to harmonics and one or two processes
//! accuracy     from a target to a scheme, its step or tolerance, and a number of paths
//! sweep        statistics as functions of keys, with differences that common seeds make sharp
//! multilevel   means over paths from many coarse paths and few pairs of finer ones
//! ```

pub mod accuracy;
pub mod calibration;
mod clock;
pub mod forecast;
mod linear;
pub mod multilevel;
pub mod pace;
pub mod sweep;
pub mod trade;
pub mod weather;
