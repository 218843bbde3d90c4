//! The results of a run, for people and for programs: pure functions of a summary.
//!
//! ```text
//! info         what a report says about a run besides its statistics
//! statistics   the rows of the table
//! remarks      the remarks below the table
//! bias         the bias of the step: its cells in the table, and the warning where it dominates
//! json         everything as JSON for programs
//! csv          statistics of several files or points, a line each
//! citation     how to cite a run
//! comparison   several files as one table, with their differences
//! ```

mod bias;
mod citation;
mod comparison;
mod csv;
mod info;
mod json;
mod remarks;
#[cfg(test)]
mod sample;
mod statistics;

pub use bias::{bias_cells, dominating_bias};
pub use citation::citation;
pub use comparison::{compared, comparison};
pub use csv::Csv;
pub use info::RunInfo;
pub use json::json;
pub use remarks::{lost, remarks, too_few, unsettled};
pub use statistics::{Chosen, rows};

use super::numbers::{counted, fitted};
use statistics::statistics;
use std::fmt::Write as _;
use stick_slip::engine::{Provenance, Status};
use stick_slip::stats::Summary;

/// The table for people: of these statistics, with all remarks or with what nobody must miss.
pub fn table(summary: &Summary, info: &RunInfo, chosen: Chosen, has_notes: bool) -> String {
    let mut text = String::new();
    let Provenance { title, scheme, step, seed, paths, antithetic, units, .. } = &info.provenance;
    let step = step.map_or(String::new(), |h| format!(", step {h:?}"));
    let paths = counted(if info.status == Status::Ended { summary.completed_paths } else { *paths }, "path");
    let pairs = if *antithetic { " in antithetic pairs" } else { "" };
    let _ = writeln!(text, "{title}\n{scheme}{step}, seed {seed}, {paths}{pairs}\n");
    text.push_str(&statistics(summary, units, chosen, info.period));
    text.push('\n');
    for (label, line) in remarks(summary, info, has_notes) {
        text.push_str(&fitted(&format!("{label:<8}{line}"), "        "));
    }
    text
}
