//! Monte Carlo of an oscillator with dry friction that is driven by a harmonic and noisy
//! temperature.
//!
//! A body on a spring sticks while the force on it stays below a static threshold, and slips
//! against a dynamic one. The temperature moves the rest position of the spring, and part of it is
//! random. This library simulates very many paths of such a body and answers, each with an interval
//! and with the error that its own time step makes:
//!
//! - how long the body sticks, and with which distribution;
//! - how often it slips, and how many times it turns back before it sticks again (sub-phases);
//! - where it is at each time, how far it drifts, and how much work friction does.
//!
//! # An estimate
//!
//! ```
//! use stick_slip::engine::Run;
//! use stick_slip::scenario::Scenario;
//! use stick_slip::stats::Statistic;
//!
//! let mut scenario = Scenario::shipped("rho025")?;
//! scenario.ensemble.paths = 1_000;
//! let outcome = Run::of(&scenario).simulate()?;
//! let mean = outcome.summary.estimate(Statistic::StickDurationMean);
//! println!("mean stick duration {:.3}, 95 % interval [{:.3}, {:.3}]", mean.estimate, mean.low, mean.high);
//! if let Some(bias) = mean.bias {
//!     println!("of which the time step makes {:.3} +- {:.3}", bias.estimate, bias.uncertainty);
//! }
//! # assert!(mean.bias.is_some_and(|bias| bias.estimate > 0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The rooms
//!
//! From the ground up; each knows only those above it in this list.
//!
//! | room | what it is for |
//! |---|---|
//! | [`model`] | oscillator, friction, temperature, and the vocabulary of phases; pure functions |
//! | [`lanes`] | several numbers in one register |
//! | [`noise`] | random streams, normals, exact transitions |
//! | [`scheme`] | how noise becomes the cascade of stick and slip phases |
//! | [`stats`] | statistics of the cascade, summed along one tree, with intervals |
//! | [`ensemble`] | blocks of paths on threads, delivered in order |
//! | [`bias`] | the error that the time step makes |
//! | [`data`] | measured data: columns of a CSV file, checked and repaired |
//! | [`scenario`] | one physical question: checked data, and the ensemble that it asks for |
//! | [`engine`] | a run from scenario to outcome |
//! | [`study`] | many runs, one question: what accuracy costs, how to run a scene for a target |
//! | [`provenance`] | what a file says about where its numbers come from |
//! | [`dataset`] | the data of a run, a trade, a sweep or a calibration: variables, dimensions, units |
//! | `store` | the same as files (feature `store`) |
//! | `ranks` | one run in several processes, by MPI (feature `mpi`) |
//! | `figure` | pictures (feature `figure`) |
//!
//! # Where to plug in
//!
//! - A statistic of your own over the events and states of paths: [`stats::Tally`], folded in
//!   parallel by [`engine::Run::tallied`].
//! - A place for rows and results: [`engine::Sink`].
//! - Somebody to tell how far a run is: [`engine::Progress`].
//! - Something that watches single paths: [`scheme::Observer`].
//! - A scheme: a file in `src/scheme`, and a line in its list (see DESIGN.md, "How to add").
//!
//! # Features
//!
//! `store` writes and reads HDF5 files and needs the HDF5 library, `figure` draws, and `cli` is the
//! command `mc` and includes both. All are on by default. Without them the library needs neither
//! HDF5 nor a C compiler.
#![deny(missing_docs)]

pub mod advice;
pub mod bias;
pub mod config;
pub mod data;
pub mod dataset;
pub mod engine;
pub mod ensemble;
#[cfg(feature = "figure")]
pub mod figure;
pub mod lanes;
pub mod model;
pub mod noise;
pub mod numbers;
pub mod provenance;
#[cfg(feature = "mpi")]
pub mod ranks;
pub mod scenario;
pub mod scheme;
pub mod stats;
#[cfg(feature = "store")]
pub mod store;
pub mod study;
