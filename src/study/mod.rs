//! Studies that take more than one run.
//!
//! ```text
//! trade        what each accuracy costs with each scheme, and the cheapest run for a target
//! accuracy     the scheme, its step or tolerance, and the number of paths for a target
//! sweep        statistics as functions of keys, with accurate differences from common seeds
//! path_cost    the CPU time of a path on this machine
//! ```

pub mod accuracy;
mod clock;
pub mod path_cost;
pub mod sweep;
pub mod trade;
