//! A run, from a scenario to its outcome: started, watched, ended and summed up. It knows no file,
//! no terminal and no TOML.
//!
//! ```text
//! Run::of(&scenario)      what to simulate; then, if wanted:
//!     .until(goals)         end when standard errors are small enough       (Goal)
//!     .within(time)         end when the time is up
//!     .stopped_by(&flag)    end when somebody raises a flag
//!     .with_progress(&mut progress)  say how far it has come                         (Progress)
//!     .with_crew(&crew)     simulate in several processes                   (Crew)
//!     .into_sink(&mut sink) hand over every finished block, and the outcome (Sink)
//!   -> simulate()         blocks on threads, summed along one tree, ended, the bias of the step estimated
//!   -> go_on(so_far)      the same from where an earlier sitting of the run has saved it
//!     -> Outcome          summary with biases, why it ended, how long it took
//! Replay::of(&scenario, path)   one path of it alone
//! ```

mod alarm;
mod asked;
mod crew;
mod ending;
mod error;
mod outcome;
mod progress;
mod replay;
mod run;
mod sink;

pub use asked::{Asked, NoPart, Part};
pub use crew::{Crew, Deliver, Portion, Work};
pub use ending::{EndedBy, Hopeless, MOST_PATHS, MissedGoal};
pub use error::RunError;
pub use outcome::{BiasReport, Outcome, Status};
pub use progress::Progress;
pub use replay::{Replay, Rows};
pub use run::{Run, SoFar};
pub use sink::{Memory, Moment, Sink, SinkError};
