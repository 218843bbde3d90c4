//! The library as other programs use it: ensembles, statistics, the bias, runs, sweeps, and the
//! writer and the reader of files.
//!
//! No test here starts a process, because HDF5 opens files such that a child process inherits them
//! with their locks, and some tests write files.

#[path = "../common/mod.rs"]
mod common;
#[path = "../synthetic/mod.rs"]
mod synthetic;

mod antithetic;
mod bias;
mod bias_coverage;
mod cuts;
mod engine;
mod ensemble;
mod interval_coverage;
mod multilevel;
mod rare_events;
mod store;
mod sweep;
