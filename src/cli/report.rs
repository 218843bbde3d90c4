//! What a run came to, for people and for machines: pure functions of a summary.

use super::numbers::{Digits, duration, grouped, significant};
use serde::ser::{Serialize, SerializeMap as _, Serializer};
use std::fmt::Write as _;
use stick_slip::scenario::Units;
use stick_slip::stats::{Dimension, Estimate, Statistic, Summary};
use stick_slip::store::Status;

/// What is known about a run besides its summary.
#[derive(Clone, Debug)]
pub struct RunInfo {
    /// What the scenario is called: its file for a run, its title for a stored one.
    pub scenario: String,
    /// What the scenario asks.
    pub title: String,
    /// Name of the scheme.
    pub scheme: String,
    /// h, for time-stepping schemes.
    pub step: Option<f64>,
    /// Seed of the ensemble.
    pub seed: u64,
    /// Paths asked for.
    pub paths: u64,
    /// Threads, if this process ran it.
    pub threads: Option<usize>,
    /// Wall-clock time, if known.
    pub seconds: Option<f64>,
    /// Steps of one path, for time-stepping schemes.
    pub steps_per_path: Option<u64>,
    /// Where the results are.
    pub file: String,
    /// Whether every path was simulated.
    pub status: Status,
    /// Labels of the units.
    pub units: Units,
}

impl RunInfo {
    /// Wall-clock nanoseconds per step of one path, all threads together.
    fn ns_per_path_step(&self, completed_paths: u64) -> Option<f64> {
        let path_steps = completed_paths as f64 * self.steps_per_path? as f64;
        (path_steps > 0.0).then_some(self.seconds? * 1e9 / path_steps)
    }

    /// Wall-clock microseconds per path, all threads together.
    fn us_per_path(&self, completed_paths: u64) -> Option<f64> {
        (completed_paths > 0).then_some(self.seconds? * 1e6 / completed_paths as f64)
    }
}

/// Most numbers of diverged paths listed in a table; the file holds them all.
const LISTED_PATHS: usize = 10;

/// The table for people.
pub fn table(summary: &Summary, info: &RunInfo) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{}", info.title);
    let step = info.step.map_or(String::new(), |h| format!(", step {h:?}"));
    let paths = grouped(info.paths);
    let _ = writeln!(text, "{}{step}, seed {}, {paths} paths\n", info.scheme, info.seed);
    text.push_str(&statistics_table(summary, &info.units));
    text.push('\n');
    for (label, line) in remarks(summary, info) {
        let _ = writeln!(text, "{label:<8}{line}");
    }
    text
}

/// The rows of statistics under their headings.
fn statistics_table(summary: &Summary, units: &Units) -> String {
    let has_bias = summary.estimates.iter().any(|e| e.bias.is_some());
    let labels: Vec<String> = summary.estimates.iter().map(|e| unit(e.statistic.dimension(), units)).collect();
    let has_unit = labels.iter().any(|label| !label.is_empty());
    let mut headings = vec!["statistic", "estimate", "std. error", "95 % interval", ""];
    if has_bias {
        headings.push("bias");
    }
    let mut rows: Vec<Vec<String>> = vec![headings.iter().map(|heading| heading.to_string()).collect()];
    let mut notes = vec![if has_unit { "unit".to_string() } else { String::new() }];
    for (e, label) in summary.estimates.iter().zip(labels) {
        let digits = Digits::of(e.estimate, e.standard_error);
        let known = e.low.is_finite() && e.high.is_finite();
        let mut row = vec![e.statistic.name().to_string(), digits.show(e.estimate), digits.show(e.standard_error)];
        row.extend(if known { [e.low, e.high].map(|x| digits.show(x)) } else { ["none".into(), String::new()] });
        if has_bias {
            row.push(e.bias.map_or(String::new(), |bias| digits.show(bias)));
        }
        notes.push(match absence(e, summary) {
            Some(reason) => [label, format!("({reason})")].join(" ").trim_start().to_string(),
            None => label,
        });
        rows.push(row);
    }
    let widths: Vec<usize> =
        (0..rows[0].len()).map(|c| rows.iter().map(|row| row[c].chars().count()).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for (row, note) in rows.iter().zip(notes) {
        let mut line = format!("{:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            let _ = write!(line, "  {cell:>width$}");
        }
        let _ = write!(line, "  {note}");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Why a number, or its interval, does not exist.
fn absence(e: &Estimate, summary: &Summary) -> Option<&'static str> {
    let valid = summary.completed_paths.saturating_sub(summary.diverged.len() as u64);
    if e.estimate.is_finite() {
        let has_interval = e.standard_error.is_finite() && e.low.is_finite() && e.high.is_finite();
        return match (has_interval, valid) {
            (true, _) => None,
            (false, 0..=1) => Some("an interval needs two paths"),
            (false, _) => Some("too little to form an interval"),
        };
    }
    let sticks = &summary.stick_durations;
    let slips: u64 = summary.sub_phases.counts.iter().sum();
    let reason = match e.statistic {
        _ if summary.completed_paths == 0 => "no path was completed",
        _ if valid == 0 => "every path diverged",
        Statistic::StickDurationMean | Statistic::StickDurationSd | Statistic::StickDurationMedian
            if sticks.completed == 0 =>
        {
            "no stick ended, the first one apart"
        }
        Statistic::StickDurationSd => "needs two sticks that ended",
        Statistic::FirstStickDurationMean if sticks.first_completed == 0 => "no first stick ended",
        Statistic::SubPhasesMean | Statistic::SubPhasesMultipleShare | Statistic::JumpMean | Statistic::JumpAbsMean
            if slips == 0 =>
        {
            "no slip was completed"
        }
        Statistic::DriftVelocity | Statistic::DiffusionCoefficient if summary.periods.time.len() < 2 => {
            "needs two whole forcing periods"
        }
        Statistic::DisplacementEndSd | Statistic::DiffusionCoefficient if valid < 2 => "needs two paths",
        Statistic::StickingFraction => "the run has no duration",
        _ => "does not exist",
    };
    Some(reason)
}

/// Everything below the table, as label and line.
fn remarks(summary: &Summary, info: &RunInfo) -> Vec<(&'static str, String)> {
    let sticks = &summary.stick_durations;
    let mut remarks = vec![(
        "sticks",
        format!(
            "{} ended, {} still running at the end (censored); of the first ones, {} ended and {} were running",
            grouped(sticks.completed),
            grouped(sticks.censored),
            grouped(sticks.first_completed),
            grouped(sticks.first_censored)
        ),
    )];
    let mut paths = format!("{} of {} completed", grouped(summary.completed_paths), grouped(info.paths));
    match info.status {
        Status::Complete => {}
        Status::Interrupted => paths.push_str(": the run was interrupted"),
        Status::Running => paths.push_str(": the run is not finished"),
    }
    remarks.push(("paths", paths));
    if let Some(line) = diverged(summary) {
        remarks.push(("diverged", format!(" {line}")));
    }
    if let Some(seconds) = info.seconds {
        let mut line = duration(seconds);
        if let Some(threads) = info.threads {
            let _ = write!(line, " on {threads} thread{}", if threads == 1 { "" } else { "s" });
        }
        if let Some(us) = info.us_per_path(summary.completed_paths) {
            let _ = write!(line, ", {} us per path", significant(us, 3));
        }
        if let Some(ns) = info.ns_per_path_step(summary.completed_paths) {
            let _ = write!(line, ", {} ns per path-step", significant(ns, 3));
        }
        remarks.push(("time", line));
    }
    remarks.push(("file", info.file.clone()));
    remarks
}

/// How many paths diverged, and the first of their numbers; none if none did.
pub fn diverged(summary: &Summary) -> Option<String> {
    let n = summary.diverged.len();
    let numbers: Vec<String> = summary.diverged.iter().take(LISTED_PATHS).map(u64::to_string).collect();
    let more = if n > LISTED_PATHS { ", ..." } else { "" };
    let paths = if n == 1 { "path" } else { "paths" };
    (n > 0).then(|| {
        format!("{} {paths} diverged, in no statistic: number {}{more}", grouped(n as u64), numbers.join(", "))
    })
}

/// The label of what a number is measured in; empty where it has none.
fn unit(dimension: Dimension, units: &Units) -> String {
    let Units { time, length, force, .. } = units;
    let over = |top: &str, bottom: &str| match (top.is_empty(), bottom.is_empty()) {
        (_, true) => top.to_string(),
        (true, false) => format!("1/{bottom}"),
        (false, false) => format!("{top}/{bottom}"),
    };
    match dimension {
        Dimension::One => String::new(),
        Dimension::Time => time.clone(),
        Dimension::Length => length.clone(),
        Dimension::Velocity => over(length, time),
        Dimension::Diffusivity if length.is_empty() => over("", time),
        Dimension::Diffusivity => over(&format!("{length}^2"), time),
        Dimension::Work => [force.as_str(), length.as_str()].join(" ").trim().to_string(),
    }
}

/// The same for machines: one JSON object; a number that does not exist is null.
pub fn json(summary: &Summary, info: &RunInfo) -> String {
    let sticks = &summary.stick_durations;
    let report = JsonReport {
        scenario: &info.scenario,
        title: &info.title,
        scheme: &info.scheme,
        step: info.step,
        seed: info.seed,
        paths: info.paths,
        completed_paths: summary.completed_paths,
        diverged_paths: summary.diverged.len(),
        diverged: &summary.diverged,
        status: match info.status {
            Status::Complete => "complete",
            Status::Interrupted => "interrupted",
            Status::Running => "running",
        },
        threads: info.threads,
        seconds: info.seconds,
        ns_per_path_step: info.ns_per_path_step(summary.completed_paths),
        us_per_path: info.us_per_path(summary.completed_paths),
        file: &info.file,
        sticks: JsonSticks {
            completed: sticks.completed,
            censored: sticks.censored,
            first_completed: sticks.first_completed,
            first_censored: sticks.first_censored,
        },
        statistics: JsonStatistics(&summary.estimates),
    };
    // Nothing in it can fail: every key is a string, and non-finite numbers become null.
    serde_json::to_string_pretty(&report).unwrap_or_default() + "\n"
}

#[derive(serde::Serialize)]
struct JsonReport<'a> {
    scenario: &'a str,
    title: &'a str,
    scheme: &'a str,
    step: Option<f64>,
    seed: u64,
    paths: u64,
    completed_paths: u64,
    diverged_paths: usize,
    diverged: &'a [u64],
    status: &'static str,
    threads: Option<usize>,
    seconds: Option<f64>,
    ns_per_path_step: Option<f64>,
    us_per_path: Option<f64>,
    file: &'a str,
    sticks: JsonSticks,
    statistics: JsonStatistics<'a>,
}

#[derive(serde::Serialize)]
struct JsonSticks {
    completed: u64,
    censored: u64,
    first_completed: u64,
    first_censored: u64,
}

#[derive(serde::Serialize)]
struct JsonEstimate {
    estimate: f64,
    standard_error: f64,
    low: f64,
    high: f64,
    bias: Option<f64>,
}

/// Statistics by name, in the order of the table.
struct JsonStatistics<'a>(&'a [Estimate]);

impl Serialize for JsonStatistics<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for &Estimate { statistic, estimate, standard_error, low, high, bias } in self.0 {
            map.serialize_entry(statistic.name(), &JsonEstimate { estimate, standard_error, low, high, bias })?;
        }
        map.end()
    }
}
