//! A run at a glance: one of its paths with the sticks shaded, the quantiles of all paths, and the
//! durations of sticks.

use super::trace::PathTrace;
use super::words::caveats;
use super::{Absent, Axis, LegendEntry, Panel, Sheet, Style, Subject, fan, sheet, solid, sticks};
use stickslip::stats::Dimension;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let drawn = subject.path()?;
    let path = PathTrace::of(&drawn)?;
    let curve = path.curve();
    let range = sticks::range(&summary.stick_durations).ok_or(Absent::Nothing(
        "no stick after the first of a path has ended",
    ))?;
    let palette = style.palette();
    let [time_unit, length_unit] =
        [Dimension::TIME, Dimension::LENGTH].map(|d| d.label(&scenario.units));
    let time_axis = || Axis::linear([0.0, scenario.time.end], "time *t*", &time_unit);

    let mut seen = fan::widest(&summary.bands);
    seen.extend(curve.iter().map(|point| point[1]));
    let displacement = |title: &str| Axis::around(seen.iter().copied(), title, &length_unit);

    let time_of_path = Axis::linear(
        [drawn.from, drawn.scenario.time.end],
        "time *t*",
        &time_unit,
    );
    let mut one = Panel::new(time_of_path, displacement("one path *x*(*t*)"), 84.0);
    let size = seen.iter().fold(0.0, |size, x| f64::max(size, x.abs()));
    for [begin, end] in path.sticks() {
        // The bar is higher than the panel, which clips it at its frame.
        one.bar([begin, -10.0 * size], [end, 10.0 * size], palette.wide);
    }
    one.line(curve, solid(palette.first));

    let mut all = Panel::new(time_axis(), displacement("all paths *x*(*t*)"), 84.0);
    fan::quantiles(&summary.bands, palette, &mut all);

    let sticks = &summary.stick_durations;
    let [across, upwards] = sticks::TITLES;
    let outlasting = sticks::beyond(sticks, range, [across, upwards, &time_unit], 84.0, style);

    let curve = |words: &str| LegendEntry::line(solid(palette.first), words);
    let area = LegendEntry::area;
    let all = all.keyed([
        curve("median"),
        area(palette.narrow, "25–75 %"),
        area(palette.wide, "5–95 %"),
    ]);
    let panels = [
        one.keyed([
            curve(&format!("path {}", drawn.number)),
            area(palette.wide, "stick"),
        ]),
        all,
        outlasting.keyed(
            sticks::entries(sticks, palette)
                .into_iter()
                .chain(caveats(scenario, true)),
        ),
    ];
    Ok(sheet(&format!("Overview: {}", scenario.title), [], panels).in_a_row())
}
