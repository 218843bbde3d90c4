//! The report of a sweep for programs: one JSON object.

use crate::cli::document::{document, estimate};
use serde_json::{Map, Value, json};
use std::path::Path;
use stick_slip::stats::Statistic;
use stick_slip::study::sweep::{Design, Paired, Point, Sweep};

/// The report as one JSON object. A number that does not exist is null.
pub fn json(sweep: &Sweep, output: &Path) -> String {
    let design = &sweep.question.design;
    let axes: Vec<Value> = (design.axes().iter())
        .map(|axis| json!({ "name": axis.name, "key": axis.key, "values": axis.values }))
        .collect();
    let points: Vec<Value> = (0..sweep.points.len()).map(|p| point(sweep, p)).collect();
    let mut object = json!({
        "scenario": sweep.question.scenario.title,
        "scheme": sweep.question.scenario.scheme.name(),
        "step": sweep.question.scenario.scheme.step(),
        "seeds": sweep.question.seeds.name(),
        "file": output.display().to_string(),
        "axes": axes,
        "points": points,
    });
    match design {
        Design::Star { keys, relative_step } => {
            object["relative_step"] = json!(relative_step);
            let of = |(k, (key, value)): (usize, &(String, f64))| json!({ "key": key, "value": value, "statistics": statistics(sweep, |s| sweep.elasticity(k, s).map(paired)) });
            object["elasticities"] = keys.iter().enumerate().map(of).collect();
        }
        Design::Grid(_) | Design::Zip(_) => object["differences"] = differences(sweep),
    }
    document("sweep", object)
}

fn point(sweep: &Sweep, p: usize) -> Value {
    let at: Map<String, Value> =
        sweep.question.design.settings(p).into_iter().map(|setting| (setting.key, json!(setting.value))).collect();
    let seed = sweep.question.points[p].ensemble.seed;
    let Some(Point { estimates, completed_paths, diverged_paths, seconds, .. }) = &sweep.points[p] else {
        return json!({ "at": at, "seed": seed, "status": "missing" });
    };
    let status = if diverged_paths < completed_paths { "complete" } else { "lost" };
    json!({
        "at": at,
        "seed": seed,
        "status": status,
        "completed_paths": completed_paths,
        "diverged_paths": diverged_paths,
        "cpu_seconds": seconds,
        "statistics": statistics(sweep, |statistic| Some(estimate(&estimates[statistic.index()]))),
    })
}

/// Statistics by name, in the order of the table.
fn statistics(sweep: &Sweep, of: impl Fn(Statistic) -> Option<Value>) -> Value {
    let asked = Statistic::asked_by(&sweep.question.scenario.record);
    let each = asked.into_iter().map(|statistic| (statistic.name().to_string(), of(statistic).into()));
    Value::Object(each.collect())
}

fn paired(Paired { measurement: m, gain }: Paired) -> Value {
    json!({
        "estimate": m.estimate, "standard_error": m.standard_error, "low": m.low, "high": m.high, "gain": gain,
    })
}

/// The differences from each point to the next one along each dimension.
fn differences(sweep: &Sweep) -> Value {
    let design = &sweep.question.design;
    let along = design.along().into_iter().enumerate().map(|(dimension, name)| {
        let pairs = (0..sweep.points.len()).filter_map(|from| Some((from, design.next(from, dimension)?)));
        let pair = |(from, to): (usize, usize)| {
            let of = |statistic| sweep.difference(from, dimension, statistic).map(paired);
            json!({ "from": from, "to": to, "statistics": statistics(sweep, of) })
        };
        json!({ "along": name, "pairs": pairs.map(pair).collect::<Vec<_>>() })
    });
    along.collect()
}
