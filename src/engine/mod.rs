//! A run, from a scenario to its outcome: started, ended early if its goals are reached or its time
//! is up, and summarised. The engine reads and writes no files, prints nothing, and does not depend
//! on TOML.
//!
//! ```text
//! Run::of(&scenario)            what to simulate; then, optionally:
//!     .until(goals)             end when standard errors are small enough         (Goal)
//!     .within(time)             end when the time is up
//!     .stopped_by(&flag)        end when the caller sets a flag
//!     .with_progress(&mut p)    report the progress of the run                    (Progress)
//!     .into_sink(&mut sink)     pass on every finished block, and the outcome     (Sink)
//!     .simulate()               simulate the blocks, sum them along a binary tree, and estimate
//!                               the bias of the step
//!     .go_on(so_far)            the same for the rest of a run that was saved
//!   -> Outcome                  statistics with biases, why the run ended, how long it took
//! Replay::of(&scenario, path)   simulate one path of the run alone
//! ```

mod alarm;
mod asked;
mod course;
mod cycle;
mod ending;
mod error;
mod outcome;
mod progress;
mod provenance;
mod replay;
mod run;
mod sink;

pub use asked::{Asked, NoPart, Part};
pub use ending::{EndedBy, Hopeless, MOST_PATHS, MissedGoal};
pub use error::RunError;
pub use outcome::{BiasReport, Outcome, Status};
pub use progress::Progress;
pub use provenance::{PROGRAM_VERSION, Program, Provenance, built_from, commit};
pub use replay::{Replay, ReplayRows};
pub use run::{Run, SoFar};
pub use sink::{Memory, Moment, Sink, SinkError};
