//! The file of a run, or of a part of one: blocks are simulated again.

use super::{Arguments, Checked};
use crate::inputs::results;
use crate::output::failure::Failure;
use crate::output::numbers::grouped;
use serde_json::json;
use std::collections::BTreeSet;
use std::ops::Range;
use stickslip::stats::Record;
use stickslip_files::saved::Again;
use stickslip_files::store::{self, Stored, Verified};

impl Arguments {
    /// Check a run.
    pub(super) fn run(&self, stored: &Stored) -> Result<Checked, Failure> {
        let scenario = results::scenario(&self.file.display().to_string(), stored, &[])?;
        let used = scenario.run_bytes(stored.header.paths, self.threads.number());
        let threads = self.threads.ready("this verification", used)?;
        let again = store::verify_run(&self.file, stored, &scenario, self.sample(), threads)?;
        Ok(checked(again, stored, &scenario.record))
    }
}

fn checked(again: Again, stored: &Stored, record: &Record) -> Checked {
    let Again {
        blocks,
        simulated: numbers,
        paths: again_paths,
        has_statistics,
        values,
        difference,
    } = again;
    let count = blocks.end - blocks.start;
    let simulated = match numbers.is_empty() {
        true => "nothing: the file has no rows of single paths".into(),
        false => format!(
            "{} of {} blocks, {} of {} paths: {}",
            grouped(numbers.len() as u64),
            grouped(count),
            grouped(again_paths),
            grouped(stored.completed_paths),
            listed(&numbers, &blocks)
        ),
    };
    let kinds = [
        ("paths", record.paths),
        ("events", record.events),
        ("trajectories", record.trajectories > 0),
    ];
    let kept: Vec<&str> = kinds
        .into_iter()
        .filter(|(_, is_kept)| *is_kept)
        .map(|(kind, _)| kind)
        .collect();
    let rows = match numbers.is_empty() || kept.is_empty() {
        true => String::new(),
        false => format!("the rows of {}, ", kept.join(", ")),
    };
    let statistics = if has_statistics {
        "every statistic, "
    } else {
        ""
    };
    Checked {
        simulated,
        compared: format!("{rows}{statistics}attributes, coordinates and units"),
        not_compared: (!has_statistics).then(|| {
            format!(
                "statistics and intervals against a simulation; --blocks all simulates all {} blocks",
                grouped(count)
            )
        }),
        fields: json!({
            "blocks": count,
            "blocks_checked": numbers,
            "paths": stored.completed_paths,
            "paths_checked": again_paths,
            "statistics_checked": has_statistics,
        }),
        found: Verified { values, difference },
        other_program: stored.header.program.other(),
    }
}

/// The numbers of the blocks; only the first ones if there are many.
fn listed(again: &BTreeSet<u64>, all: &Range<u64>) -> String {
    if again.len() as u64 == all.end - all.start {
        return "all".into();
    }
    let first: Vec<String> = again.iter().take(12).map(|&block| grouped(block)).collect();
    let more = if again.len() > 12 { ", ..." } else { "" };
    format!("blocks {}{more}", first.join(", "))
}
