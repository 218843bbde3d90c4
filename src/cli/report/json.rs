//! The report for programs: one JSON object.

use super::RunInfo;
use crate::cli::document::{JsonWarning, document, sha256};
use serde::ser::{Serialize, SerializeMap as _, Serializer};
use stick_slip::stats::{Estimate, Statistic, Summary, Transient};

/// The report as one JSON object. A number that does not exist is null.
pub fn json(summary: &Summary, info: &RunInfo, warnings: &[JsonWarning]) -> String {
    let (sticks, run) = (&summary.stick_durations, &info.provenance);
    let report = JsonReport {
        scenario: &info.scenario,
        title: &run.title,
        scenario_sha256: sha256(&run.scenario_text),
        units: JsonUnits {
            time: &run.units.time,
            length: &run.units.length,
            force: &run.units.force,
            temperature: &run.units.temperature,
        },
        scheme: &run.scheme,
        step: run.step,
        resolution: run.resolution,
        seed: run.seed,
        paths: run.paths,
        antithetic: run.antithetic,
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
        start: summary.transient.map(|Transient { end, sticks, slips, displacement, .. }| JsonStart {
            end,
            sticks,
            slips,
            displacement: displacement.estimate,
            displacement_error: displacement.standard_error,
            displacement_low: displacement.low,
            displacement_high: displacement.high,
        }),
        counted_periods: summary.counted_periods(),
        unsettled: summary.unsettled().map(|statistics| statistics.into_iter().map(Statistic::name).collect()),
        statistics: JsonStatistics(&summary.estimates),
        warnings,
    };
    document("run", &report)
}

#[derive(serde::Serialize)]
struct JsonReport<'a> {
    scenario: &'a str,
    title: &'a str,
    /// The hash of the resolved scenario, as `mc check` prints it and files hold it.
    scenario_sha256: String,
    units: JsonUnits<'a>,
    scheme: &'a str,
    step: Option<f64>,
    resolution: Option<f64>,
    seed: u64,
    paths: u64,
    antithetic: bool,
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
    /// What happened before the time from which on statistics count; null where they count from the
    /// beginning.
    start: Option<JsonStart>,
    counted_periods: usize,
    /// The statistics that are zero once x has settled but are significantly not zero here; null
    /// where the paths are too few to decide.
    unsettled: Option<Vec<&'static str>>,
    statistics: JsonStatistics<'a>,
    /// The warnings about the results, as printed on standard error.
    warnings: &'a [JsonWarning],
}

/// Labels of the units; empty where the scenario gives none.
#[derive(serde::Serialize)]
struct JsonUnits<'a> {
    time: &'a str,
    length: &'a str,
    force: &'a str,
    temperature: &'a str,
}

#[derive(serde::Serialize)]
struct JsonStart {
    end: f64,
    sticks: u64,
    slips: u64,
    displacement: f64,
    displacement_error: f64,
    displacement_low: f64,
    displacement_high: f64,
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
    estimate_corrected: Option<f64>,
    estimate_corrected_low: Option<f64>,
    estimate_corrected_high: Option<f64>,
}

/// Statistics by name, in the order of the table.
struct JsonStatistics<'a>(&'a [Estimate]);

impl Serialize for JsonStatistics<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for e in self.0 {
            let &Estimate { statistic, estimate, standard_error, low, high, bias } = e;
            let corrected = e.corrected();
            let entry = JsonEstimate {
                estimate,
                standard_error,
                low,
                high,
                bias: bias.map(|bias| bias.estimate),
                bias_uncertainty: bias.map(|bias| bias.uncertainty),
                bias_order: bias.and_then(|bias| bias.order),
                estimate_corrected: corrected.map(|corrected| corrected.estimate),
                estimate_corrected_low: corrected.map(|corrected| corrected.low),
                estimate_corrected_high: corrected.map(|corrected| corrected.high),
            };
            map.serialize_entry(statistic.name(), &entry)?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample::{info, set, summary};
    use super::super::table;
    use super::*;
    use stick_slip::engine::Status;
    use stick_slip::stats::Bias;

    #[test]
    fn json_has_the_names_of_the_table_and_null_for_what_is_not() {
        let mut summary = summary();
        set(&mut summary, Statistic::DriftVelocity, f64::NAN);
        set(&mut summary, Statistic::JumpMean, f64::INFINITY);
        let text = json(&summary, &info(), &[]);
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
    fn a_corrected_estimate_stands_beside_its_bias() {
        let mut summary = summary();
        summary.estimates[0].bias = Some(Bias { estimate: 0.0955, uncertainty: 0.0311, order: None });
        let value: serde_json::Value = serde_json::from_str(&json(&summary, &info(), &[])).expect("valid JSON");
        let entry = |statistic: &str, key: &str| value["statistics"][statistic][key].as_f64();
        // The correction takes off 1 - (0.0311/0.0955)^4 = 0.98875 of the bias; the ends of the
        // interval are 0.0311044 from 0.538572 - 0.0955.
        for (key, expected) in [("", 0.444146), ("_low", 0.411968), ("_high", 0.474176)] {
            let reported = entry("stick_duration_mean", &format!("estimate_corrected{key}")).expect("it has a bias");
            assert!((reported - expected).abs() < 2e-6, "{key}: {reported}");
        }
        assert_eq!(entry("jump_mean", "estimate_corrected"), None);
    }

    #[test]
    fn a_stored_run_has_no_times() {
        let stored =
            RunInfo { seconds: None, bias_seconds: None, threads: None, status: Status::Interrupted, ..info() };
        assert!(table(&summary(), &stored).contains("interrupted"));
        let value: serde_json::Value = serde_json::from_str(&json(&summary(), &stored, &[])).expect("valid JSON");
        assert!(value["seconds"].is_null() && value["ns_per_path_step"].is_null() && value["threads"].is_null());
        assert_eq!(value["status"], "interrupted");
    }
}
