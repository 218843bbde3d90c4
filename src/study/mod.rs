//! Questions that take more than one run.
//!
//! ```text
//! trade        what each accuracy costs with each scheme, and the cheapest run for a target
//! calibration  friction, stiffness and dilatation from measured temperatures and displacements
//! forecast     displacements, forces and slips of coming years, from a calibration and a weather
//! weather      harmonics and one or two noise processes fitted to a measured temperature
//! accuracy     the scheme, its step or tolerance, and the number of paths for a target
//! sweep        statistics as functions of keys, with accurate differences from common seeds
//! pace         the CPU time of a path on this machine
//! ```

pub mod accuracy;
pub mod calibration;
mod clock;
pub mod forecast;
mod linear;
pub mod pace;
pub mod sweep;
pub mod trade;
pub mod weather;
