//! Runs and studies on disk, in HDF5 files that netCDF-4 readers open directly. This is the only
//! module that writes HDF5.
//!
//! ```text
//! FileSink      a run that is being simulated, saved in the folder NAME.partial (log.rs)
//!   -> go_on    continues the run from the saved state, whatever ended the process
//!   -> Writer   writes the file in that folder, once, at the end; then the file gets its name
//! read          the header and the statistics of a finished file, or of an unfinished run
//! ```
//!
//! `docs/output-format.md` describes the file for its readers; [`stickslip::dataset`] defines its
//! contents.

mod errors;
mod file;
mod kinds;
mod lock;
mod log;
mod parts;
mod scale;
mod sink;
mod staging;
mod sweep;
mod system;
mod variables;
mod writer;
mod written;

pub use crate::saved::{Parts, RunQuestion, SavedError};
pub use errors::{StoreError, take_leftovers};
pub use kinds::{
    CheckedBytes, check_bytes, format, has_checksum, read, read_kind, read_path, read_sweep,
    read_trade, verify,
};
pub use lock::lock_path;
pub use parts::PartError;
pub use sink::{FileSink, Unfinished};
pub use staging::{file_of, is_unfinished_sweep, partial_path, write_together, write_whole};
pub use stickslip::dataset::{StoredRun as Stored, StoredSweep, StoredTrade};
pub use sweep::{SweepFile, sweep_bytes};
pub use system::check_space;
pub use writer::{Writer, write_dataset};
