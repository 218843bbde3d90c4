//! What simulates a body with dry friction: its equation, its noise, and the schemes that turn
//! noise into the cascade of stick and slip phases. Read it through the modules of `stick_slip`.
#![deny(missing_docs)]

pub mod excerpt;
pub mod lanes;
pub mod model;
pub mod noise;
pub mod numbers;
pub mod scheme;
