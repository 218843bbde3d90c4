//! The numbers of a report, as JSON that can be embedded in a page.

use super::RunInfo;
use crate::cli::report;
use serde_json::{Map, Value, json};
use stick_slip::stats::{Dimension, Estimate, Histogram, Summary};
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
        lines.join("; ").replace("+-", "\u{b1}")
    };
    let labels = json!({
        "time": name("time t", Dimension::TIME),
        "displacement": name("displacement x(t)", Dimension::LENGTH),
        "duration": name("stick duration D", Dimension::TIME),
        "period": name("mean of x(nP) \u{2212} x(0)", Dimension::LENGTH),
    });
    let about = [
        ("labels", labels),
        ("sticks", remark("sticks").into()),
        ("drift", remark("drift").into()),
        ("statistics", statistics(summary, info)),
    ];
    let about = about.map(|(name, value)| (name.to_string(), value));
    let data: Map<String, Value> = about.into_iter().chain(charts(summary)).collect();
    // `<` is escaped, so that no text of the file can end the element that holds this JSON or begin
    // a comment in it.
    Value::from(data).to_string().replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

fn statistics(summary: &Summary, info: &RunInfo) -> Value {
    let all: Vec<&Estimate> = summary.reported().collect();
    let unit = |e: &Estimate| e.statistic.dimension().label(&info.provenance.units);
    let column = |of: fn(&Estimate) -> f64| json!(all.iter().map(|e| of(e)).collect::<Vec<_>>());
    // Columns are arrays of pairs, because an array keeps its order and the members of an object do
    // not.
    json!([
        ["statistic", all.iter().map(|e| e.statistic.name()).collect::<Vec<_>>()],
        ["unit", all.iter().map(|e| unit(e)).collect::<Vec<_>>()],
        ["estimate", column(|e| e.estimate)],
        ["standard_error", column(|e| e.standard_error)],
        ["low", column(|e| e.low)],
        ["high", column(|e| e.high)],
        ["bias", column(|e| e.bias.map_or(f64::NAN, |bias| bias.estimate))],
        ["bias_uncertainty", column(|e| e.bias.map_or(f64::NAN, |bias| bias.uncertainty))],
    ])
}

/// The charts that the run has numbers for, as columns.
fn charts(summary: &Summary) -> Map<String, Value> {
    let Summary { bands, stick_durations: sticks, sub_phases, periods, .. } = summary;
    let mut charts = Map::new();
    let mut put = |name: &str, columns: Value| drop(charts.insert(name.into(), columns));
    if bands.time.len() > 1 {
        let quantile = |level: usize| bands.displacement.quantiles.row(level).to_vec();
        let fan = json!([
            ["time", bands.time],
            ["displacement_mean", bands.displacement.mean],
            ["displacement_q05", quantile(0)],
            ["displacement_q25", quantile(1)],
            ["displacement_q50", quantile(2)],
            ["displacement_q75", quantile(3)],
            ["displacement_q95", quantile(4)],
        ]);
        let Ends { low, high } = &bands.static_probability_ends;
        let share = json!([
            ["time", bands.time],
            ["static_probability", bands.static_probability],
            ["static_probability_low", low],
            ["static_probability_high", high],
        ]);
        put("fan", fan);
        put("static", share);
    }
    if sticks.completed > 0 && sticks.histogram.edges.len() > 1 {
        let Histogram { edges, counts, .. } = &sticks.histogram;
        // The bins below the shortest stick are empty, so the curve begins at the first bin that is
        // not.
        let first = counts.iter().position(|count| *count > 0).unwrap_or(0);
        let survival = json!([
            ["duration", &edges[first + 1..]],
            ["lower", &edges[first..edges.len() - 1]],
            ["count", &counts[first..]],
            ["survival", &sticks.survival[first..]],
            ["survival_low", &sticks.survival_ends.low[first..]],
            ["survival_high", &sticks.survival_ends.high[first..]],
        ]);
        put("survival", survival);
        put("step", json!(sticks.step));
    }
    if let Some(last) = sub_phases.counts.iter().rposition(|count| *count > 0) {
        let ends: Vec<[f64; 2]> = (0..=last).map(|i| sub_phases.share_ends.at(i)).collect();
        let shares = json!([
            ["k", (1..=last + 1).collect::<Vec<_>>()],
            ["count", &sub_phases.counts[..=last]],
            ["share", &sub_phases.shares[..=last]],
            ["share_low", ends.iter().map(|ends| ends[0]).collect::<Vec<_>>()],
            ["share_high", ends.iter().map(|ends| ends[1]).collect::<Vec<_>>()],
        ]);
        put("sub_phases", shares);
    }
    if !periods.time.is_empty() {
        let Ends { low, high } = &periods.mean_ends;
        let mean = json!([
            ["time", periods.time],
            ["mean", periods.mean],
            ["mean_low", low],
            ["mean_high", high],
            ["variance", periods.variance],
        ]);
        put("periods", mean);
    }
    charts
}
