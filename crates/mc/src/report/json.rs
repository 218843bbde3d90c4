//! A run for programs, as one JSON object. A number that does not exist is null.

use super::RunInfo;
use crate::output::document::{document, named, sha256};
use serde_json::{Map, Value, json};
use stickslip::scenario::Units;
use stickslip::stats::{Estimate, LimitCycle, Statistic, Summary, Transient};

/// A run. Each warning is a name and a sentence.
pub fn of_run(summary: &Summary, info: &RunInfo, warnings: &[(String, String)]) -> String {
    let (sticks, run) = (&summary.stick_durations, &info.provenance);
    let Units {
        time,
        length,
        force,
        temperature,
    } = &run.units;
    let unsettled = summary.unsettled().map(|unsettled| {
        unsettled
            .into_iter()
            .map(Statistic::name)
            .collect::<Vec<_>>()
    });
    let statistics = summary
        .reported()
        .map(|e| (e.statistic.name().to_string(), estimate(e)));
    let report = json!({
        "scenario": info.scenario,
        "title": run.title,
        // The hash of the resolved scenario, as `mc check` prints it and files hold it.
        "scenario_sha256": sha256(&run.scenario_text),
        // Labels, empty where the scenario gives none.
        "units": { "time": time, "length": length, "force": force, "temperature": temperature },
        "scheme": run.scheme,
        "step": run.step,
        "resolution": run.resolution,
        "seed": run.seed,
        "paths": run.paths,
        "antithetic": run.antithetic,
        "completed_paths": summary.completed_paths,
        "diverged_paths": summary.diverged.len(),
        "diverged": summary.diverged,
        "status": info.status.name(),
        "ended_by": info.ended_by,
        "threads": info.threads,
        "seconds": info.seconds,
        "bias_seconds": info.bias_seconds,
        "no_bias": info.no_bias,
        "ns_per_path_step": info.ns_per_path_step(summary.completed_paths),
        "us_per_path": info.us_per_path(summary.completed_paths),
        "file": info.file,
        "sticks": {
            "completed": sticks.completed,
            "censored": sticks.censored,
            "first_completed": summary.first_sticks.completed,
            "first_censored": summary.first_sticks.censored,
        },
        // What happened before the counted time; null if everything is counted.
        "start": summary.transient.map(start),
        // The long-term motion, if nothing is random.
        "cycle": summary.cycle.as_ref().map(cycle),
        "counted_periods": summary.counted_periods(),
        // The statistics that vanish once x has settled but differ significantly from zero here;
        // null if there are too few paths to decide.
        "unsettled": unsettled,
        "statistics": statistics.collect::<Map<_, _>>(),
        "warnings": named(warnings),
    });
    document("run", report)
}

fn cycle(cycle: &LimitCycle) -> Value {
    let repeats = cycle.repeats.as_ref().map(|repeats| {
        json!({
            "period": repeats.period,
            "forcing_periods": repeats.forcing_periods,
            "advance": repeats.advance,
            "slips": repeats.slips,
            "sticks": repeats.sticks,
            "at_rest": repeats.at_rest,
            "is_symmetric": repeats.is_symmetric,
        })
    });
    json!({ "amplitude": cycle.amplitude, "repeats": repeats, "section": cycle.section })
}

fn start(
    Transient {
        end,
        sticks,
        slips,
        displacement,
        ..
    }: Transient,
) -> Value {
    json!({
        "end": end,
        "sticks": sticks,
        "slips": slips,
        "displacement": displacement.estimate,
        "displacement_error": displacement.standard_error,
        "displacement_low": displacement.low,
        "displacement_high": displacement.high,
    })
}

/// A statistic with its interval, the bias of the step, and both corrected for it.
fn estimate(e: &Estimate) -> Value {
    let corrected = e.corrected();
    json!({
        "estimate": e.estimate,
        "standard_error": e.standard_error,
        "low": e.low,
        "high": e.high,
        "bias": e.bias.map(|bias| bias.estimate),
        "bias_uncertainty": e.bias.map(|bias| bias.uncertainty),
        "bias_order": e.bias.and_then(|bias| bias.order),
        "estimate_corrected": corrected.map(|corrected| corrected.estimate),
        "estimate_corrected_low": corrected.map(|corrected| corrected.low),
        "estimate_corrected_high": corrected.map(|corrected| corrected.high),
    })
}

#[cfg(test)]
mod tests {
    use super::super::sample_tests::table;
    use super::super::sample_tests::{info, set, summary};
    use super::*;
    use stickslip::engine::Status;
    use stickslip::stats::Bias;

    #[test]
    fn json_has_the_names_of_the_table_and_null_for_what_is_not() {
        let mut summary = summary();
        set(&mut summary, Statistic::DriftVelocity, f64::NAN);
        set(&mut summary, Statistic::JumpMean, f64::INFINITY);
        let text = of_run(&summary, &info(), &[]);
        let value: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
        for key in [
            "scenario",
            "scheme",
            "step",
            "seed",
            "paths",
            "completed_paths",
            "diverged_paths",
            "threads",
        ] {
            assert!(!value[key].is_null(), "{key}");
        }
        assert_eq!(value["seconds"], 0.6);
        assert_eq!(
            (value["us_per_path"].as_f64(), value["file"].as_str()),
            (Some(60.0), Some("rho025.h5"))
        );
        assert!((value["ns_per_path_step"].as_f64().unwrap_or(0.0) - 10.0).abs() < 1e-9);
        let statistics = value["statistics"].as_object().expect("an object");
        assert_eq!(statistics.len(), summary.asked.len());
        assert_eq!(statistics["stick_duration_mean"]["estimate"], 0.538572);
        for name in ["drift_velocity", "jump_mean"] {
            for key in ["estimate", "standard_error", "low", "high", "bias"] {
                assert!(
                    statistics[name]
                        .get(key)
                        .is_some_and(serde_json::Value::is_null),
                    "{name}.{key}"
                );
            }
        }
        let place = |name: &str| text.find(&format!("\"{name}\"")).expect("every name");
        assert!(
            summary
                .asked
                .windows(2)
                .all(|pair| place(pair[0].name()) < place(pair[1].name())),
            "in order"
        );
    }

    #[test]
    fn a_corrected_estimate_stands_beside_its_bias() {
        let mut summary = summary();
        summary.estimates[0].bias = Some(Bias {
            estimate: 0.0955,
            uncertainty: 0.0311,
            order: None,
        });
        let value: serde_json::Value =
            serde_json::from_str(&of_run(&summary, &info(), &[])).expect("valid JSON");
        let entry = |statistic: &str, key: &str| value["statistics"][statistic][key].as_f64();
        // The correction takes off 1 - (0.0311/0.0955)^4 = 0.98875 of the bias; the ends of the
        // interval are 0.0311044 from 0.538572 - 0.0955.
        for (key, expected) in [("", 0.444146), ("_low", 0.411968), ("_high", 0.474176)] {
            let reported = entry("stick_duration_mean", &format!("estimate_corrected{key}"))
                .expect("it has a bias");
            assert!((reported - expected).abs() < 2e-6, "{key}: {reported}");
        }
        assert_eq!(entry("jump_mean", "estimate_corrected"), None);
    }

    #[test]
    fn a_stored_run_has_no_times() {
        let stored = RunInfo {
            seconds: None,
            bias_seconds: None,
            threads: None,
            status: Status::Interrupted,
            ..info()
        };
        assert!(table(&summary(), &stored).contains("interrupted"));
        let value: serde_json::Value =
            serde_json::from_str(&of_run(&summary(), &stored, &[])).expect("valid JSON");
        assert!(
            value["seconds"].is_null()
                && value["ns_per_path_step"].is_null()
                && value["threads"].is_null()
        );
        assert_eq!(value["status"], "interrupted");
    }
}
