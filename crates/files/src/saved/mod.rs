//! The saved state of a run as bytes: its progress, and the data for joining its parts. Whether
//! these bytes are in files or in memory does not matter here.
//!
//! ```text
//! Question      what a run is asked to do
//! State         the question, the sums so far, and how much of the rows is valid
//! PartRecorder  a sink that makes the state of a part
//! Parts         the states of all parts, checked against each other
//! rerun         simulates the scenario of a run again, to be compared with the run
//! ```

mod again;
pub mod checksum;
mod error;
mod parts;
mod rows;
mod state;

pub use again::{Difference, Verified, again_in_memory, rerun};
pub use error::SavedError;
pub use parts::{PartRecorder, Parts, PartsError};
pub use state::RunQuestion;

#[cfg(all(test, feature = "store"))]
pub(crate) use rows::write_rows;
#[cfg(feature = "store")]
pub(crate) use {
    again::{Against, compare},
    parts::each_block,
    rows::{Position, read_rows},
    state::{MAGIC, State, first_difference, lines, of_bytes, to_bytes},
};
