//! Pictures. Read it through the modules of `stick_slip`.
#![deny(missing_docs)]

#[path = "../../src/figure/mod.rs"]
pub mod figure;

use stick_slip_bearing::bearing;
use stick_slip_core::{data, engine, model, numbers, scenario, scheme, stats, study, sums};
