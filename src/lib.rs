//! Monte Carlo simulation of an oscillator with dry friction, driven by a harmonic and noisy
//! temperature.
//!
//! A body on a spring sticks while the force on it stays below a static threshold, and slips
//! against a dynamic one. The temperature moves the rest position of the spring, and part of the
//! temperature is random. This library simulates a large ensemble of paths of such a body and
//! estimates the statistics below. Each estimate comes with a confidence interval and the bias due
//! to the time step:
//!
//! - how long the body sticks, and how these durations are distributed;
//! - how often it slips, and how many times it turns back before it sticks again (sub-phases);
//! - where it is at each time, how far it drifts, and how much work friction does.
//!
//! # An estimate
//!
//! ```
//! use stickslip::engine::Run;
//! use stickslip::scenario::Scenario;
//! use stickslip::stats::Statistic;
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
//! Your own scenario is a TOML file, such as `mc init` writes, with changes of single keys:
//!
//! ```no_run
//! # use stickslip::config::Override;
//! # use stickslip::scenario::Scenario;
//! let scenario = Scenario::read("mine.toml".as_ref(), &[Override::set("friction.static=1.3")?])?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The modules
//!
//! Each module uses only modules above it in the list.
//!
//! | module | purpose |
//! |---|---|
//! | [`memory`] | the memory that a process needs, and the memory available |
//! | [`lanes`] | several numbers in one processor register |
//! | [`model`] | oscillator, friction, temperature, and the vocabulary of phases; pure functions |
//! | [`noise`] | random streams, normal numbers, exact transitions |
//! | [`scheme`] | the schemes that turn noise into the cascade of stick and slip phases |
//! | [`sums`] | sums over paths, merged along a tree, and the intervals that follow from them |
//! | [`stats`] | statistics of the cascade with their intervals |
//! | [`ensemble`] | blocks of paths on threads, delivered in order |
//! | [`bias`] | the bias of the time step |
//! | [`scenario`] | one physical question as checked data, and its ensemble |
//! | [`config`] | scenarios as TOML, with overrides of single keys |
//! | [`advice`] | derived numbers and warnings of a scenario, before it is run |
//! | [`engine`] | a run from its scenario to its outcome |
//! | [`study`] | many runs for one question: the cost of accuracy, sweeps |
//! | [`dataset`] | results as named variables with axes and units |
//!
//! [`memory`], [`lanes`], [`sums`], [`ensemble`] and [`bias`] are internal: the other crates of this
//! repository use them, they are not in the documentation, and they may change in any release.
//!
//! # What you can add
//!
//! - A user-defined statistic over the events and states of paths: [`stats::Tally`], computed in
//!   parallel by [`engine::Run::tallied`].
//! - A user-defined force, in addition to the spring: [`model::ForceLaw`], in
//!   [`model::Problem::force`].
//! - A destination of rows and results: [`engine::Sink`].
//! - A display of the progress of a run: [`engine::Progress`].
//! - An observer of single paths: [`scheme::Observer`].
//! - A scheme: a file in `src/scheme`, and a line in its list (see DESIGN.md, "How to add").
//!
//! # Features
//!
//! - `toml`, on by default: scenarios as TOML ([`config`]), what can be said of them in advance
//!   ([`advice`]), and [`study`]. It includes `data`.
//! - `data`: logger files and records of ground motion, for scenarios that name them.
//!
//! Without them the engine is what [`prelude`] leads to: a problem that is built in Rust, runs, and
//! their results. HDF5, pictures and the command `mc` are other crates.

#[cfg(feature = "toml")]
pub mod advice;
#[doc(hidden)]
pub mod bias;
#[cfg(feature = "toml")]
pub mod config;
pub mod dataset;
pub mod engine;
#[doc(hidden)]
pub mod ensemble;
mod inputs;
#[doc(hidden)]
pub mod lanes;
#[doc(hidden)]
pub mod memory;
pub mod model;
pub mod noise;
pub mod prelude;
pub mod scenario;
pub mod scheme;
pub mod stats;
#[cfg(feature = "toml")]
pub mod study;
#[doc(hidden)]
pub mod sums;
