//! What a result holds, in memory, as bytes and as HDF5. Read it through the modules of
//! `stick_slip`.
#![deny(missing_docs)]
// Some of this is used by files only.
#![cfg_attr(not(feature = "store"), allow(dead_code, unused_imports))]

#[path = "../../src/dataset/mod.rs"]
pub mod dataset;
#[cfg(feature = "saved")]
#[path = "../../src/saved/mod.rs"]
pub mod saved;
#[cfg(feature = "store")]
#[path = "../../src/store/mod.rs"]
pub mod store;

use stick_slip_bearing::bearing;
use stick_slip_core::{data, engine, ensemble, model, numbers, scenario, scheme, stats, study, sums};
