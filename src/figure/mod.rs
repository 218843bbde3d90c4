//! Pictures, drawn from what a file says, or from a path that the same code simulates again.
//!
//! ```text
//! Subject     what a picture is of: a scenario, the summary of a run, the prices of a trade, sweeps, a calibration
//!   -> FIGURES    one file each: what it takes from its subject, and how it lays it out
//!        Axis, Panel   numbers to places; curves, bands, bars, marks, notes that never overlap
//!        sheet         a legend above, panels in line below each other
//!   -> Scene      a picture as data (kit)
//!        page          all figures of a subject on one sheet
//!   -> svg, png, pdf
//! ```
//!
//! A figure more is a file with a `FIGURE` in it, and its name in [`FIGURES`].

mod axis;
mod calibration;
mod drift;
mod fan;
mod hysteresis;
mod kit;
mod overview;
mod page;
mod panel;
mod path;
mod residuals;
mod sheet;
mod sticks;
mod sub_phases;
mod subject;
mod sweep;
mod theme;
mod tornado;
mod trade;
mod words;

pub use kit::{Scene, pdf, png, svg};
pub use page::page;
pub use subject::{Absent, Figure, Subject};
pub use theme::{COLUMN, Style, Theme};
pub use words::words;

/// Every figure, in the order in which a page shows them.
pub const FIGURES: &[Figure] = &[
    path::FIGURE,
    fan::FIGURE,
    sticks::FIGURE,
    sub_phases::FIGURE,
    drift::FIGURE,
    trade::FIGURE,
    sweep::FIGURE,
    tornado::FIGURE,
    calibration::FIGURE,
    hysteresis::FIGURE,
    residuals::FIGURE,
    overview::FIGURE,
];

/// The figure of this name.
pub fn named(name: &str) -> Option<&'static Figure> {
    FIGURES.iter().find(|figure| figure.name == name)
}
