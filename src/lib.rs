//! Monte Carlo of an oscillator with dry friction, driven by a harmonic and noisy temperature.
#![deny(missing_docs)]

pub mod advice;
pub mod bias;
pub mod config;
pub mod ensemble;
pub mod lanes;
pub mod model;
pub mod multilevel;
pub mod noise;
pub mod numbers;
pub mod scenario;
pub mod scheme;
pub mod stats;
pub mod store;
pub mod trade;
