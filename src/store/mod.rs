//! The ensemble on disk: HDF5 that netCDF-4 readers open as it is. The only home of HDF5.
//!
//! ```text
//! Writer::create   NAME.partial, with the header and the coordinates
//!   -> append      rows of single paths, block by block; what the file claims is always on disk
//!     -> finish    statistics, bands, histograms; then NAME.partial becomes NAME in one step
//! read             the header and the statistics of a finished file
//! ```
//!
//! `docs/output-format.md` describes the file for its readers; `layout.rs` is the same list for the code.

mod error;
mod growing;
mod header;
mod layout;
mod reader;
mod scale;
mod sink;
mod space;
mod summary;
mod sweep;
mod trade;
mod variable;
mod writer;

pub use error::StoreError;
pub use header::{FORMAT_NAME, FORMAT_VERSION};
pub use reader::{FileKind, Stored, kind, read};
pub use sink::FileSink;
pub use space::check_space;
pub use sweep::{SWEEP_FORMAT_NAME, SWEEP_FORMAT_VERSION, StoredSweep, SweepFile, read_sweep, sweep_bytes};
pub use trade::{TRADE_FORMAT_NAME, read_prices, write_trade};
pub use writer::{Rows, Writer, discard_partial, partial_path};
