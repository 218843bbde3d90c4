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
pub(crate) mod header;
pub mod layout;
mod memory;
mod recorder;
pub(crate) mod rows;
pub(crate) mod run;
pub(crate) mod series;
pub(crate) mod summary;
pub(crate) mod sweep;
pub(crate) mod sweep_layout;
pub(crate) mod trade;
mod walk;

pub use form::{Attribute, AttributeValue, Source, columns_of, counted, read_other_program, texts};
pub(crate) use form::{attributes_of, read_attribute, read_or_empty, read_sized, read_variable};
pub use header::{FORMAT as RUN_FORMAT, FORMAT_VERSION, Format, walk_origin, write_origin};
pub use memory::{Dataset, Entry};
pub use recorder::Recorder;
pub use run::StoredRun;
pub use stickslip::stats::column::Column;
pub use stickslip::stats::column::{ColumnView, Element, ElementType};
pub use sweep::{SWEEP_FORMAT, StoredSweep};
pub use trade::{StoredTrade, TRADE_FORMAT};
pub use walk::{Walk, Walked};
