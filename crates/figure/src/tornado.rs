//! The effect of each key on a statistic: elasticities as bars with their intervals, the largest at
//! the top.

use super::theme::THIN;
use super::words::{caveats, of_key, of_statistic};
use super::{Absent, Axis, LegendEntry, Panel, Sheet, Stroke, Style, Subject, sheet};
use stickslip::study::sweep::Design;

/// Half the height of a bar, as a share of the space for it.
const HALF: f64 = 0.36;

/// The space for a bar, in points.
const BAR: f64 = 15.0;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (sweeps, statistics) = subject.sweeps()?;
    let Some((sweep, keys)) = sweeps
        .first()
        .and_then(|(_, sweep)| match &sweep.question.design {
            Design::Star { keys, .. } => Some((sweep, keys)),
            Design::Grid(_) | Design::Zip(_) => None,
        })
    else {
        return Err(Absent::Elsewhere("a sweep of elasticities"));
    };
    let palette = style.palette();
    let mut panels = Vec::new();
    for statistic in statistics {
        let elasticity = |key: usize| {
            sweep
                .elasticity(key, statistic)
                .map(|paired| paired.measurement)
        };
        let mut bars: Vec<_> = (0..keys.len())
            .filter_map(|key| Some((key, elasticity(key)?)))
            .collect();
        bars.retain(|(_, m)| m.estimate.is_finite());
        if bars.is_empty() {
            return Err(Absent::Nothing(
                "the statistic does not exist, or may be zero: it has no elasticities",
            ));
        }
        bars.sort_by(|a, b| a.1.estimate.abs().total_cmp(&b.1.estimate.abs()));
        let ends = bars.iter().flat_map(|(_, m)| [m.estimate, m.low, m.high]);
        let across = Axis::around(ends.chain([0.0]), "elasticity", "");
        let places = bars
            .iter()
            .enumerate()
            .map(|(i, (key, _))| (i as f64, of_key(&keys[*key].0, style)));
        let [bottom, top] = [-0.6, bars.len() as f64 - 0.4];
        let upwards = Axis::named([bottom, top], places.collect());
        let mut panel = Panel::new(across, upwards, BAR * bars.len() as f64);
        for (i, (_, m)) in bars.iter().enumerate() {
            let at = i as f64;
            panel.bar([0.0, at - HALF], [m.estimate, at + HALF], palette.narrow);
            panel.interval_across(at, [m.low, m.high], palette.ink);
        }
        panel.line(
            vec![[0.0, bottom], [0.0, top]],
            Stroke::solid(palette.faint, THIN),
        );
        panels.push(panel.keyed([LegendEntry::words(of_statistic(statistic, style))]));
    }
    let mut legend = caveats(&sweep.question.scenario, true);
    legend.push(LegendEntry::area(
        palette.narrow,
        "elasticity of a statistic, with its 95 % interval",
    ));
    Ok(sheet(
        &format!("Elasticities: {}", sweep.question.scenario.title),
        legend,
        panels,
    ))
}
