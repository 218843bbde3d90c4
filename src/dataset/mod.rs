//! The data sets of the program, each described once: names, axes, units, attributes and values.
//! Nothing here depends on a file format.
//!
//! ```text
//! layout          every variable of a run: name, axes, unit, meaning (sweep_layout: of a sweep)
//! run, trade, sweep   the contents of each kind of data set; other crates add further kinds
//! walk            for runs and fits, one walk writes the contents or reads them back
//!   -> Dataset       in memory, which is written to a file or compared with one
//!   <- Source        a file, or memory
//! Recorder        the sink that makes a run a data set in memory
//! ```
//!
//! `docs/output-format.md` describes the data sets for their readers.

mod form;
mod memory;
mod recorder;
mod summary;
#[cfg(feature = "toml")]
mod sweep_layout;
mod walk;

// The crate of the files reads and writes by these.
#[doc(hidden)]
pub mod header;
// The tables of variables say what their constants are.
#[allow(missing_docs)]
#[doc(hidden)]
pub mod layout;
#[doc(hidden)]
pub mod rows;
#[doc(hidden)]
pub mod run;
#[doc(hidden)]
pub mod series;
#[cfg(feature = "toml")]
#[doc(hidden)]
pub mod sweep;
#[cfg(feature = "toml")]
#[doc(hidden)]
pub mod trade;

pub use crate::stats::column::{Column, ColumnView, Element, ElementType};
pub use form::{Attribute, AttributeValue, Source, columns_of, counted, read_other_program, texts};
#[doc(hidden)]
pub use form::{attributes_of, read_attribute, read_or_empty, read_sized, read_variable};
pub use header::{FORMAT as RUN_FORMAT, FORMAT_VERSION, Format, walk_origin, write_origin};
pub use memory::{Dataset, Entry};
pub use recorder::Recorder;
pub use run::{NoVariable, StoredRun};
#[cfg(feature = "toml")]
pub use sweep::{SWEEP_FORMAT, StoredSweep};
#[cfg(feature = "toml")]
pub use trade::{StoredTrade, TRADE_FORMAT};
pub use walk::{Walk, Walked};
