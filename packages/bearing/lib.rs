//! The bearing of a bridge. Read it through the modules of `stick_slip`.
#![deny(missing_docs)]

#[path = "../../src/bearing/mod.rs"]
pub mod bearing;

use stick_slip_core::{data, ensemble, model, noise, numbers, scenario};
