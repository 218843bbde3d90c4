//! What a run came to, for people and for machines: pure functions of a summary.

use super::numbers::{Digits, duration, grouped, significant};
use serde::ser::{Serialize, SerializeMap as _, Serializer};
use std::fmt::Write as _;
use stick_slip::scenario::Units;
use stick_slip::stats::{Bias, Dimension, Estimate, Statistic, Summary};
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
    /// The shortest slip the scheme resolves, where its results depend on that.
    pub resolution: Option<f64>,
    /// Seed of the ensemble.
    pub seed: u64,
    /// Paths asked for.
    pub paths: u64,
    /// Threads, if this process ran it.
    pub threads: Option<usize>,
    /// Wall-clock time, if known.
    pub seconds: Option<f64>,
    /// How much of it went into the bias of the step.
    pub bias_seconds: Option<f64>,
    /// Why the bias is not known, unless nobody asked.
    pub no_bias: Option<String>,
    /// Steps of one path, for time-stepping schemes.
    pub steps_per_path: Option<u64>,
    /// Where the results are.
    pub file: String,
    /// Whether every path was simulated.
    pub status: Status,
    /// What ended the run before its last path, if it was asked to end.
    pub ended_by: Option<String>,
    /// Labels of the units.
    pub units: Units,
}

impl RunInfo {
    /// What became of a path that is in no statistic. A step can be unstable; a scheme without one gives up, where a path takes more work
    /// than it may or meets a number that is not finite.
    fn loss(&self) -> &'static str {
        if self.step.is_some() { "diverged" } else { "given up" }
    }

    /// Wall-clock time of the ensemble itself.
    fn ensemble_seconds(&self) -> Option<f64> {
        Some(self.seconds? - self.bias_seconds?)
    }

    /// Wall-clock nanoseconds per step of one path, all threads together.
    fn ns_per_path_step(&self, completed_paths: u64) -> Option<f64> {
        let path_steps = completed_paths as f64 * self.steps_per_path? as f64;
        (path_steps > 0.0).then_some(self.ensemble_seconds()? * 1e9 / path_steps)
    }

    /// Wall-clock microseconds per path, all threads together.
    fn us_per_path(&self, completed_paths: u64) -> Option<f64> {
        (completed_paths > 0).then_some(self.ensemble_seconds()? * 1e6 / completed_paths as f64)
    }
}

/// Most numbers of lost paths listed in a table; the file holds them all.
const LISTED_PATHS: usize = 10;

/// The table for people.
pub fn table(summary: &Summary, info: &RunInfo) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{}", info.title);
    let step = info.step.map_or(String::new(), |h| format!(", step {h:?}"));
    let paths = grouped(if info.status == Status::Ended { summary.completed_paths } else { info.paths });
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
    let has_bias = summary.has_bias();
    let labels: Vec<String> = summary.estimates.iter().map(|e| unit(e.statistic.dimension(), units)).collect();
    let has_unit = labels.iter().any(|label| !label.is_empty());
    let mut headings = vec!["statistic", "estimate", "std. error", "95 % interval", ""];
    if has_bias {
        headings.extend(["bias", "+-", "order"]);
    }
    let mut rows: Vec<Vec<String>> = vec![headings.iter().map(|heading| heading.to_string()).collect()];
    let mut notes = vec![if has_unit { "unit".to_string() } else { String::new() }];
    for (e, label) in summary.estimates.iter().zip(labels) {
        let digits = Digits::of(e.estimate, e.standard_error);
        let known = e.low.is_finite() && e.high.is_finite();
        let mut row = vec![e.statistic.name().to_string(), digits.show(e.estimate), digits.show(e.standard_error)];
        row.extend(if known { [e.low, e.high].map(|x| digits.show(x)) } else { ["none".into(), String::new()] });
        if has_bias {
            row.extend(bias_cells(e.bias));
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

/// A bias, its uncertainty and its order, to two digits of the uncertainty; `none` where it is not known.
fn bias_cells(bias: Option<Bias>) -> [String; 3] {
    let Some(Bias { estimate, uncertainty, order }) = bias else {
        return ["none".into(), String::new(), String::new()];
    };
    let digits = Digits::of(estimate, uncertainty);
    [digits.show(estimate), digits.show(uncertainty), order.map_or("none".into(), |order| format!("{order:.1}"))]
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
        _ if valid == 0 => "every path diverged or was given up",
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
    if summary.has_bias() {
        let what =
            "of the step: estimate less its value without one, +- at 95 %, and the power of the step it goes with";
        remarks.push(("bias", what.into()));
    } else if let Some(reason) = &info.no_bias {
        remarks.push(("bias", format!("not estimated: {reason}")));
    }
    let mut paths = format!("{} of {} completed", grouped(summary.completed_paths), grouped(info.paths));
    match info.status {
        Status::Complete => {}
        Status::Ended => {
            let reason = info.ended_by.as_deref().unwrap_or("request");
            paths = format!("{} completed; ended by {reason}", grouped(summary.completed_paths));
        }
        Status::Interrupted => paths.push_str(": the run was interrupted"),
        Status::Running => paths.push_str(": the run is not finished"),
    }
    remarks.push(("paths", paths));
    if let Some(line) = lost(summary, info) {
        remarks.push((info.loss(), format!(" {line}")));
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
        if let Some(seconds) = info.bias_seconds.filter(|_| summary.has_bias()) {
            let _ = write!(line, "; the bias took {} s of it", significant(seconds, 2));
        }
        remarks.push(("time", line));
    }
    remarks.push(("file", info.file.clone()));
    remarks
}

/// How many paths diverged or were given up, and the first of their numbers; none if none did.
pub fn lost(summary: &Summary, info: &RunInfo) -> Option<String> {
    let n = summary.diverged.len();
    let numbers: Vec<String> = summary.diverged.iter().take(LISTED_PATHS).map(u64::to_string).collect();
    let more = if n > LISTED_PATHS { ", ..." } else { "" };
    let paths = if n == 1 { "path" } else { "paths" };
    (n > 0).then(|| {
        let loss = info.loss();
        format!("{} {paths} {loss}, in no statistic: number {}{more}", grouped(n as u64), numbers.join(", "))
    })
}

/// In how many statistics the bias of the step is beyond doubt and larger than the statistical interval shows, and what to do; none if in
/// none.
pub fn dominating_bias(summary: &Summary) -> Option<String> {
    let excess = |e: &Estimate| e.bias.map_or(0.0, |bias| bias.estimate.abs() / e.reach());
    let dominates = |e: &&Estimate| e.bias.is_some_and(|b| b.estimate.abs() > b.uncertainty) && excess(e) > 1.0;
    let dominated: Vec<&Estimate> = summary.estimates.iter().filter(dominates).collect();
    // not by how far the interval is exceeded: that of a median, which is a multiple of the step, has next to no width
    let certainty = |e: &Estimate| e.bias.map_or(0.0, |bias| bias.estimate.abs() / bias.uncertainty);
    let surest = dominated.iter().max_by(|a, b| certainty(a).total_cmp(&certainty(b)))?;
    let [bias, uncertainty, _] = bias_cells(surest.bias);
    Some(format!(
        "the step moves {} of {} statistics by more than their intervals show, most surely {}, whose bias is {bias} +- \
         {uncertainty} and whose interval is +- {}. A smaller `--step` lowers it, more paths do not; `--scheme event-driven` \
         has no step",
        dominated.len(),
        summary.estimates.len(),
        surest.statistic.name(),
        significant(surest.reach(), 2)
    ))
}

/// The label of what a number is measured in; empty where it has none.
pub fn unit(dimension: Dimension, units: &Units) -> String {
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
        resolution: info.resolution,
        seed: info.seed,
        paths: info.paths,
        completed_paths: summary.completed_paths,
        diverged_paths: summary.diverged.len(),
        diverged: &summary.diverged,
        status: info.status.name(),
        ended_by: info.ended_by.as_deref(),
        threads: info.threads,
        seconds: info.seconds,
        bias_seconds: info.bias_seconds,
        no_bias: info.no_bias.as_deref(),
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
    resolution: Option<f64>,
    seed: u64,
    paths: u64,
    completed_paths: u64,
    diverged_paths: usize,
    diverged: &'a [u64],
    status: &'static str,
    ended_by: Option<&'a str>,
    threads: Option<usize>,
    seconds: Option<f64>,
    bias_seconds: Option<f64>,
    no_bias: Option<&'a str>,
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
    bias_uncertainty: Option<f64>,
    bias_order: Option<f64>,
}

/// Statistics by name, in the order of the table.
struct JsonStatistics<'a>(&'a [Estimate]);

impl Serialize for JsonStatistics<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for &Estimate { statistic, estimate, standard_error, low, high, bias } in self.0 {
            let entry = JsonEstimate {
                estimate,
                standard_error,
                low,
                high,
                bias: bias.map(|bias| bias.estimate),
                bias_uncertainty: bias.map(|bias| bias.uncertainty),
                bias_order: bias.and_then(|bias| bias.order),
            };
            map.serialize_entry(statistic.name(), &entry)?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;
    use stick_slip::stats::{Band, Bands, Histogram, PeriodMoments, QUANTILE_LEVELS, StickDurations, SubPhaseCounts};

    /// An ensemble like that of `rho025`, with made-up standard errors.
    fn summary() -> Summary {
        let band = || Band { mean: vec![0.0], sd: vec![0.0], quantiles: Array2::zeros((QUANTILE_LEVELS.len(), 1)) };
        let estimates = Statistic::ALL.map(|statistic| {
            let (estimate, standard_error) = match statistic {
                Statistic::StickDurationMean => (0.538572, 0.000266),
                Statistic::SticksPerPath => (14.1226, 0.0073),
                Statistic::DisplacementEndMean => (-4.2316, 0.016),
                _ => (1.0, 0.01),
            };
            let (low, high) = (estimate - 1.96 * standard_error, estimate + 1.96 * standard_error);
            Estimate { statistic, estimate, standard_error, low, high, bias: None }
        });
        Summary {
            completed_paths: 10_000,
            diverged: vec![],
            estimates: estimates.to_vec(),
            stick_durations: StickDurations {
                step: None,
                completed: 141_226,
                censored: 812,
                first_completed: 10_000,
                first_censored: 0,
                histogram: Histogram { edges: vec![0.0, 1.0], counts: vec![141_226] },
                censored_counts: vec![812],
                survival: vec![0.0],
                quantiles: vec![0.5; QUANTILE_LEVELS.len()],
            },
            sub_phases: SubPhaseCounts { counts: vec![100_000, 42_000], censored: 9_000 },
            periods: PeriodMoments { time: vec![25.1, 50.3], mean: vec![0.0; 2], variance: vec![1.0; 2] },
            bands: Bands {
                time: vec![0.0],
                displacement: band(),
                velocity: band(),
                temperature: band(),
                static_probability: vec![1.0],
            },
        }
    }

    fn info() -> RunInfo {
        RunInfo {
            scenario: "scenarios/rho025.toml".into(),
            title: "Noisy temperature".into(),
            scheme: "discrete-vi".into(),
            step: Some(0.01),
            resolution: None,
            seed: 1,
            paths: 10_000,
            threads: Some(2),
            seconds: Some(0.6),
            bias_seconds: Some(0.0),
            no_bias: None,
            steps_per_path: Some(6_000),
            file: "rho025.h5".into(),
            status: Status::Complete,
            ended_by: None,
            units: Units::default(),
        }
    }

    fn set(summary: &mut Summary, statistic: Statistic, estimate: f64) {
        for e in summary.estimates.iter_mut().filter(|e| e.statistic == statistic) {
            *e = Estimate { estimate, standard_error: f64::NAN, low: f64::NAN, high: f64::NAN, ..*e };
        }
    }

    fn row<'a>(table: &'a str, name: &str) -> &'a str {
        table.lines().find(|line| line.split(' ').next() == Some(name)).unwrap_or_else(|| panic!("{name}:\n{table}"))
    }

    #[test]
    fn the_table_shows_every_statistic_to_two_digits_of_its_error() {
        let table = table(&summary(), &info());
        for statistic in Statistic::ALL {
            row(&table, statistic.name());
        }
        let cells: Vec<&str> = row(&table, "stick_duration_mean").split_whitespace().collect();
        assert_eq!(cells, ["stick_duration_mean", "0.53857", "0.00027", "0.53805", "0.53909"]);
        let ends: Vec<usize> = table.lines().skip(3).take(17).map(|line| line.trim_end().len()).collect();
        assert!(ends[1..].iter().all(|end| *end == ends[1]), "the columns are aligned:\n{table}");
        assert!(!table.contains("bias") && !table.contains("diverged"), "{table}");
    }

    #[test]
    fn the_table_says_how_long_and_where() {
        let table = table(&summary(), &info());
        assert!(table.contains("0.60 s on 2 threads, 60 us per path, 10 ns per path-step"), "{table}");
        assert!(table.contains("rho025.h5") && table.contains("812 still running at the end (censored)"), "{table}");
    }

    #[test]
    fn known_bias_gets_a_column() {
        let mut summary = summary();
        summary.estimates[0].bias = Some(Bias { estimate: 0.0955, uncertainty: 0.0311, order: Some(0.58) });
        let table = table(&summary, &info());
        let cells = |name| row(&table, name).split_whitespace().skip(5).map(str::to_string).collect::<Vec<_>>();
        assert_eq!(cells("stick_duration_mean"), ["0.096", "0.031", "0.6"]);
        assert_eq!(cells("sticks_per_path"), ["none"]);
        assert!(table.lines().take(20).all(|line| line.chars().count() <= 120), "{table}");
    }

    #[test]
    fn a_bias_beyond_the_interval_is_told_with_the_surest_statistic() {
        let bias = |estimate, uncertainty| Some(Bias { estimate, uncertainty, order: None });
        let mut summary = summary();
        assert_eq!(dominating_bias(&summary), None);
        // Half-widths of the intervals: 0.00052, 0.0143, 0.0314.
        summary.estimates[0].bias = bias(0.0005, 0.0001);
        assert_eq!(dominating_bias(&summary), None, "within the interval");
        summary.estimates[0].bias = bias(0.0955, 0.1);
        assert_eq!(dominating_bias(&summary), None, "in doubt");
        summary.estimates[0].bias = bias(0.0955, 0.0311);
        summary.estimates[1].bias = bias(0.5, 0.1);
        let line = dominating_bias(&summary).expect("two are dominated");
        assert!(
            line.contains("2 of 16") && line.contains("stick_duration_sd") && line.contains("0.50 +- 0.10"),
            "{line}"
        );
    }

    #[test]
    fn units_get_a_column_where_they_have_labels() {
        let (time, length, force) = ("s".to_string(), "m".to_string(), "N".to_string());
        let units = Units { time, length, force, temperature: String::new() };
        let table = table(&summary(), &RunInfo { units, ..info() });
        let unit = |name| row(&table, name).rsplit("  ").next().unwrap_or_default();
        assert_eq!(unit("stick_duration_mean"), "s");
        assert_eq!(unit("drift_velocity"), "m/s");
        assert_eq!(unit("diffusion_coefficient"), "m^2/s");
        assert_eq!(unit("friction_work_mean"), "N m");
    }

    #[test]
    fn a_number_that_does_not_exist_says_why() {
        let mut summary = summary();
        summary.stick_durations.completed = 0;
        summary.stick_durations.first_completed = 0;
        summary.sub_phases.counts = vec![];
        summary.periods.time.truncate(1);
        for (statistic, reason) in [
            (Statistic::StickDurationMean, "no stick ended"),
            (Statistic::FirstStickDurationMean, "no first stick ended"),
            (Statistic::SubPhasesMean, "no slip was completed"),
            (Statistic::JumpAbsMean, "no slip was completed"),
            (Statistic::DriftVelocity, "needs two whole forcing periods"),
        ] {
            set(&mut summary, statistic, f64::NAN);
            let table = table(&summary, &info());
            let row = row(&table, statistic.name());
            assert!(row.contains("none") && row.contains(reason), "{row}");
        }
    }

    #[test]
    fn one_path_has_estimates_without_intervals() {
        let mut summary = summary();
        summary.completed_paths = 1;
        set(&mut summary, Statistic::SticksPerPath, 4.0);
        let table = table(&summary, &info());
        let row = row(&table, "sticks_per_path");
        assert!(row.contains("4.000000") && row.contains("an interval needs two paths"), "{row}");
    }

    #[test]
    fn diverged_paths_are_counted_and_named() {
        let mut summary = summary();
        summary.diverged = (0..12).map(|i| 4711 + i).collect();
        let table = table(&summary, &info());
        assert!(table.contains("12 paths diverged, in no statistic: number 4711, 4712"), "{table}");
        assert!(table.contains("4720, ...") && !table.contains("4721"), "{table}");
        summary.diverged = (0..10_000).collect();
        set(&mut summary, Statistic::DisplacementEndMean, f64::NAN);
        assert!(super::table(&summary, &info()).contains("every path diverged"));
        let without_step = RunInfo { step: None, ..info() };
        let table = super::table(&summary, &without_step);
        assert!(
            table.contains("10 000 paths given up, in no statistic") && !table.contains("paths diverged"),
            "{table}"
        );
    }

    #[test]
    fn json_has_the_names_of_the_table_and_null_for_what_is_not() {
        let mut summary = summary();
        set(&mut summary, Statistic::DriftVelocity, f64::NAN);
        set(&mut summary, Statistic::JumpMean, f64::INFINITY);
        let text = json(&summary, &info());
        let value: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
        for key in ["scenario", "scheme", "step", "seed", "paths", "completed_paths", "diverged_paths", "threads"] {
            assert!(!value[key].is_null(), "{key}");
        }
        assert_eq!(value["seconds"], 0.6);
        assert_eq!((value["us_per_path"].as_f64(), value["file"].as_str()), (Some(60.0), Some("rho025.h5")));
        assert!((value["ns_per_path_step"].as_f64().unwrap_or(0.0) - 10.0).abs() < 1e-9);
        let statistics = value["statistics"].as_object().expect("an object");
        assert_eq!(statistics.len(), Statistic::ALL.len());
        assert_eq!(statistics["stick_duration_mean"]["estimate"], 0.538572);
        for name in ["drift_velocity", "jump_mean"] {
            for key in ["estimate", "standard_error", "low", "high", "bias"] {
                assert!(statistics[name].get(key).is_some_and(serde_json::Value::is_null), "{name}.{key}");
            }
        }
        let place = |name: &str| text.find(&format!("\"{name}\"")).expect("every name");
        assert!(Statistic::ALL.windows(2).all(|pair| place(pair[0].name()) < place(pair[1].name())), "in order");
    }

    #[test]
    fn a_stored_run_has_no_times() {
        let stored =
            RunInfo { seconds: None, bias_seconds: None, threads: None, status: Status::Interrupted, ..info() };
        assert!(table(&summary(), &stored).contains("interrupted"));
        let value: serde_json::Value = serde_json::from_str(&json(&summary(), &stored)).expect("valid JSON");
        assert!(value["seconds"].is_null() && value["ns_per_path_step"].is_null() && value["threads"].is_null());
        assert_eq!(value["status"], "interrupted");
    }
}
