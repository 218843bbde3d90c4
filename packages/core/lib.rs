//! From a scenario to the statistics of many paths. Read it through the modules of `stick_slip`.
#![deny(missing_docs)]

#[path = "../../src/advice/mod.rs"]
pub mod advice;
#[path = "../../src/bias/mod.rs"]
pub mod bias;
#[path = "../../src/config/mod.rs"]
pub mod config;
#[path = "../../src/data/mod.rs"]
pub mod data;
#[path = "../../src/engine/mod.rs"]
pub mod engine;
#[path = "../../src/ensemble/mod.rs"]
pub mod ensemble;
#[path = "../../src/memory.rs"]
pub mod memory;
#[path = "../../src/scenario/mod.rs"]
pub mod scenario;
#[path = "../../src/stats/mod.rs"]
pub mod stats;
#[path = "../../src/study/mod.rs"]
pub mod study;
#[path = "../../src/sums/mod.rs"]
pub mod sums;

pub use stick_slip_kernel::{excerpt, lanes, model, noise, numbers, scheme};
