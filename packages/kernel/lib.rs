//! What simulates a path: its equation, its noise, and the schemes that turn noise into the cascade
//! of stick and slip phases. Read it through the modules of `stick_slip`.
#![deny(missing_docs)]

#[path = "../../src/excerpt.rs"]
pub mod excerpt;
#[path = "../../src/lanes/mod.rs"]
pub mod lanes;
#[path = "../../src/model/mod.rs"]
pub mod model;
#[path = "../../src/noise/mod.rs"]
pub mod noise;
#[path = "../../src/numbers.rs"]
pub mod numbers;
#[path = "../../src/scheme/mod.rs"]
pub mod scheme;
