//! The long-term motion without noise as a function of a key: x at phase zero of the last periods
//! (the bifurcation diagram), and the amplitude.

use super::sweep::horizontal;
use super::{
    Absent, Axis, LegendEntry, Mark, Panel, Sheet, Style, Subject, range_of, sheet, solid,
};
use stickslip::stats::{Dimension, LimitCycle};

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (sweeps, _) = subject.sweeps()?;
    let [(_, sweep)] = sweeps else {
        return Err(Absent::Elsewhere("one sweep over one key"));
    };
    if sweep.question.design.axes().len() != 1 {
        return Err(Absent::Elsewhere("a sweep over one key"));
    }
    let axis = &sweep.question.design.axes()[0];
    let points = axis.values.positions().into_iter().zip(&sweep.points);
    let cycles: Vec<(f64, &LimitCycle)> = points
        .filter_map(|(at, point)| Some((at, point.as_ref()?.cycle.as_ref()?)))
        .collect();
    if cycles.is_empty() {
        return Err(Absent::Nothing(
            "every point is random, or its paths were lost",
        ));
    }
    let palette = style.palette();
    let unit = Dimension::LENGTH.label(&sweep.question.scenario.units);
    let states = || {
        cycles
            .iter()
            .flat_map(|(at, cycle)| last(cycle).iter().map(move |x| [*at, *x]))
    };
    let mut section = Panel::new(
        horizontal(axis, style),
        Axis::around(states().map(|p| p[1]), "*x* at phase zero", &unit),
        84.0,
    );
    states().for_each(|point| section.mark(point, Mark::Disc, palette.first));
    let [_, most] = range_of(cycles.iter().map(|(_, cycle)| cycle.amplitude));
    let mut amplitude = Panel::new(
        horizontal(axis, style),
        Axis::from_zero(most, "amplitude", &unit),
        84.0,
    );
    let mut curve: Vec<[f64; 2]> = cycles
        .iter()
        .map(|(at, cycle)| [*at, cycle.amplitude])
        .collect();
    curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for point in &curve {
        amplitude.mark(*point, Mark::Disc, palette.second);
    }
    amplitude.line(curve, solid(palette.second));
    let words = "last periods of one path at each point";
    let mut legend = vec![LegendEntry::words(words)];
    if cycles.len() < sweep.points.len() {
        legend.push(LegendEntry::words("random points are left out"));
    }
    let title = format!("Section: {}", sweep.question.scenario.title);
    Ok(sheet(&title, legend, [section.above_another(), amplitude]))
}

/// The states that are drawn: those of one cycle if there is one, since the others are the same.
fn last(cycle: &LimitCycle) -> &[f64] {
    let all = cycle.section.len();
    let drawn = cycle
        .repeats
        .as_ref()
        .and_then(|repeats| repeats.forcing_periods)
        .unwrap_or(all)
        .min(all);
    &cycle.section[all - drawn..]
}
