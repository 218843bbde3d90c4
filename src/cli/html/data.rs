//! The numbers of a report, as JSON that can be embedded in a page.

use super::RunInfo;
use crate::cli::report;
use serde_json::{Map, Value, json};
use stick_slip::stats::{Dimension, Summary};
use stick_slip::store::Stored;
use stick_slip::sums::Ends;

/// The numbers of a run. Those that are not finite are null.
pub(super) fn json(stored: &Stored, info: &RunInfo) -> String {
    let summary = &stored.summary;
    let unit = |dimension: Dimension| Some(dimension.label(&info.provenance.units)).filter(|unit| !unit.is_empty());
    let name = |text: &str, dimension| unit(dimension).map_or(text.to_string(), |unit| format!("{text} ({unit})"));
    let remarks = report::remarks(summary, info);
    let remark = |of: &str| {
        let lines: Vec<&str> = remarks.iter().filter(|(term, _)| *term == of).map(|(_, line)| line.as_str()).collect();
        lines.join("; ")
    };
    let labels = json!({
        "time": name("time t", Dimension::TIME),
        "displacement": name("displacement x(t)", Dimension::LENGTH),
        "duration": name("stick duration D", Dimension::TIME),
        "period": name("mean of x(nP) \u{2212} x(0)", Dimension::LENGTH),
    });
    let mut data = Map::new();
    data.insert("labels".into(), labels);
    data.insert("sticks".into(), remark("sticks").into());
    data.insert("drift".into(), remark("drift").into());
    data.insert("statistics".into(), statistics(summary, info));
    charts(summary, &mut data);
    // `<` is escaped, so that no text of the file can end the element that holds this JSON or begin
    // a comment in it.
    Value::from(data).to_string().replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

fn statistics(summary: &Summary, info: &RunInfo) -> Value {
    let column = |of: &dyn Fn(&stick_slip::stats::Estimate) -> f64| {
        numbers(&summary.estimates.iter().map(of).collect::<Vec<_>>())
    };
    let names: Vec<&str> = summary.estimates.iter().map(|e| e.statistic.name()).collect();
    let units: Vec<String> =
        summary.estimates.iter().map(|e| e.statistic.dimension().label(&info.provenance.units)).collect();
    columns([
        ("statistic", names.into()),
        ("unit", units.into()),
        ("estimate", column(&|e| e.estimate)),
        ("standard_error", column(&|e| e.standard_error)),
        ("low", column(&|e| e.low)),
        ("high", column(&|e| e.high)),
        ("bias", column(&|e| e.bias.map_or(f64::NAN, |bias| bias.estimate))),
        ("bias_uncertainty", column(&|e| e.bias.map_or(f64::NAN, |bias| bias.uncertainty))),
    ])
}

fn charts(summary: &Summary, data: &mut Map<String, Value>) {
    let mut put = |name: &str, value: Value| drop(data.insert(name.into(), value));
    let bands = &summary.bands;
    if bands.time.len() > 1 {
        let quantile = |level: usize| numbers(&bands.displacement.quantiles.row(level).to_vec());
        let fan = columns([
            ("time", numbers(&bands.time)),
            ("displacement_mean", numbers(&bands.displacement.mean)),
            ("displacement_q05", quantile(0)),
            ("displacement_q25", quantile(1)),
            ("displacement_q50", quantile(2)),
            ("displacement_q75", quantile(3)),
            ("displacement_q95", quantile(4)),
        ]);
        put("fan", fan);
        let [low, high] = ends(&bands.static_probability_ends);
        let share = numbers(&bands.static_probability);
        put(
            "static",
            columns([
                ("time", numbers(&bands.time)),
                ("static_probability", share),
                ("static_probability_low", low),
                ("static_probability_high", high),
            ]),
        );
    }
    let sticks = &summary.stick_durations;
    if sticks.completed > 0 && sticks.histogram.edges.len() > 1 {
        let edges = &sticks.histogram.edges;
        // The bins below the shortest stick are empty, so the curve begins at the first bin that is
        // not.
        let first = sticks.histogram.counts.iter().position(|count| *count > 0).unwrap_or(0);
        let survival = columns([
            ("duration", numbers(&edges[first + 1..])),
            ("lower", numbers(&edges[first..edges.len() - 1])),
            ("count", sticks.histogram.counts[first..].to_vec().into()),
            ("survival", numbers(&sticks.survival[first..])),
            ("survival_low", numbers(&sticks.survival_ends.low[first..])),
            ("survival_high", numbers(&sticks.survival_ends.high[first..])),
        ]);
        put("survival", survival);
        put("step", sticks.step.map_or(Value::Null, Value::from));
    }
    let counts = &summary.sub_phases;
    if let Some(last) = counts.counts.iter().rposition(|count| *count > 0) {
        let [low, high] = ends(&counts.share_ends);
        let cut = |values: Value| Value::from(values.as_array().map_or(Vec::new(), |all| all[..=last].to_vec()));
        let k: Vec<usize> = (1..=last + 1).collect();
        let shares = columns([
            ("k", k.into()),
            ("count", counts.counts[..=last].to_vec().into()),
            ("share", numbers(&counts.shares[..=last])),
            ("share_low", cut(low)),
            ("share_high", cut(high)),
        ]);
        put("sub_phases", shares);
    }
    let periods = &summary.periods;
    if !periods.time.is_empty() {
        let [low, high] = ends(&periods.mean_ends);
        let mean = columns([
            ("time", numbers(&periods.time)),
            ("mean", numbers(&periods.mean)),
            ("mean_low", low),
            ("mean_high", high),
            ("variance", numbers(&periods.variance)),
        ]);
        put("periods", mean);
    }
}

fn columns<const N: usize>(columns: [(&str, Value); N]) -> Value {
    // The columns are an array of pairs, because an array keeps its order and the members of an
    // object do not.
    columns.into_iter().map(|(name, values)| json!([name, values])).collect()
}

fn ends(ends: &Ends) -> [Value; 2] {
    [numbers(&ends.low), numbers(&ends.high)]
}

fn numbers(values: &[f64]) -> Value {
    values.iter().map(|value| if value.is_finite() { json!(value) } else { Value::Null }).collect()
}
