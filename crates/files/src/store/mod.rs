//! Runs and studies on disk, in HDF5 files that netCDF-4 readers open directly. This is the only
//! module that writes HDF5.
//!
//! ```text
//! FileSink      a run that is being simulated, saved in the folder NAME.partial (state.rs, log.rs)
//!   -> go_on    continues the run from what was saved, after whatever ended the process
//!   -> Writer   writes the file in that folder, once, at the end; then the file gets its name
//! read          the header and the statistics of a finished file, or of an unfinished run
//! ```
//!
//! `docs/output-format.md` describes the file for its readers; [`crate::dataset`] defines its
//! contents.

mod at_once;
mod content;
mod error;
mod failure;
mod folder;
mod found;
mod growing;
mod leftovers;
mod lock;
mod log;
mod naming;
mod own;
mod parts;
mod read_back;
mod reader;
mod rows;
mod scale;
mod sink;
mod space;
mod staged_file;
mod staging;
mod state;
mod sweep;
mod variable;
mod verify;
mod writer;

pub use crate::dataset::{StoredRun as Stored, StoredSweep, StoredTrade};
pub use crate::saved::{Parts, RunQuestion, SavedError};
pub use at_once::write_dataset;
pub use content::{format, read_sweep, read_trade};
pub use error::StoreError;
pub use folder::{file_of, partial_path};
pub use found::is_unfinished_sweep;
pub use leftovers::take_leftovers;
pub use lock::lock_path;
pub use parts::PartError;
pub use reader::{is_sealed, read, read_kind};
pub use rows::read_path;
pub use sink::{FileSink, Unfinished};
pub use space::check_space;
pub use staging::{write_together, write_whole};
pub use sweep::{SweepFile, sweep_bytes};
pub use verify::{Sealed, check_bytes, verify};
pub use writer::Writer;
