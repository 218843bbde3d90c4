//! Results for people: each kind of result is turned into a [`Report`], and each writer can write
//! any report.
//!
//! ```text
//! run, comparison, sweep, trade   the report of each kind of result
//! remarks, info, citation         parts of that of a run
//! text, paper, html               the writers: for a terminal; CSV, Markdown and LaTeX; for a browser
//! page.html, style.css            the skeleton of a page, with {placeholders}, and its style
//! json                            a run as JSON for programs
//! ```

mod citation;
mod comparison;
pub mod html;
mod info;
pub mod json;
mod paper;
mod remarks;
mod run;
#[cfg(test)]
mod sample_tests;
mod sweep;
mod text;
mod trade;

pub use citation::citation;
pub use comparison::comparison;
pub use info::RunInfo;
pub use paper::{comma_separated, latex, markdown};
pub use remarks::{found, lost};
pub use run::{ShownStatistics, run};
pub use sweep::{paths_of_each, sweep, warnings};
pub use text::{aligned, text};
pub use trade::{costs, trade, without_answer};

pub use stickslip_report::{
    Cell, Column, FOR_PEOPLE, Format, NO_TEXT, Report, Row, TEXT, Table, columns,
};

/// Half the width of a 95 % interval of a normal distribution, in standard errors.
const INTERVAL: f64 = 1.96;

/// The columns of an estimate.
fn of_estimate() -> [Column; 4] {
    columns([
        ("estimate", "estimate"),
        ("standard_error", "std. error"),
        ("low", "95 % from"),
        ("high", "to"),
    ])
}

/// The step of a scheme that has one, to follow the name of the scheme.
fn of_step(step: Option<f64>) -> String {
    step.map_or(String::new(), |h| format!(", step {h:?}"))
}
