//! The data sets that the program makes, each described once: names, axes, units, attributes and values. It knows no format.
//!
//! ```text
//! layout          every variable of a run: name, axes, unit, meaning      (sweep_layout: of a sweep)
//! run, trade, sweep, calibration, forecast, twin   what goes where, written and, where it is read back, read side by side
//!   -> Destination   a file, or memory
//!   <- Source        the same
//! Dataset         in memory
//! Recorder        the sink of a run that ends as one
//! ```
//!
//! `docs/output-format.md` describes them for their readers.
// What only files have, such as the state of a part, is described here as well.
#![cfg_attr(not(feature = "store"), allow(dead_code))]

pub(crate) mod calibration;
mod forecast;
mod form;
pub(crate) mod header;
pub(crate) mod layout;
mod memory;
mod recorder;
pub(crate) mod rows;
pub(crate) mod run;
pub(crate) mod series;
pub(crate) mod summary;
pub(crate) mod sweep;
pub(crate) mod sweep_layout;
pub(crate) mod trade;
mod twin;

pub use calibration::StoredCalibration;
pub use form::{Attribute, Column};
pub(crate) use form::{
    Destination, Element, Kind, Source, Values, read_count, read_or_empty, read_real, read_real_if_present,
    read_scalar, read_text, read_text_if_present, read_text_of, read_variable, texts,
};
pub use header::FORMAT_VERSION;
pub use memory::{Dataset, Entry};
pub use recorder::Recorder;
pub use rows::Rows;
pub use sweep::StoredSweep;
pub use trade::{Cheapest, CheapestRun};
