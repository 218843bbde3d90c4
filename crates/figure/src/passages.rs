//! First passages: the share of paths that have stayed closer to their start than a distance, over
//! time.

use super::fan::{along, between};
use super::sweep::numbered;
use super::words::{caveats, intervals};
use super::{Absent, Axis, LegendEntry, Panel, Sheet, Style, Subject, sheet};
use stickslip::stats::Dimension;
use stickslip::sums::Ends;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let extremes = summary.extremes.as_ref();
    let passages = extremes.map_or(&[][..], |extremes| &extremes.passages);
    if passages.is_empty() {
        return Err(Absent::Nothing(
            "the run has no first passages: set statistics.levels",
        ));
    }
    let palette = style.palette();
    let [time_unit, length_unit] =
        [Dimension::TIME, Dimension::LENGTH].map(|d| d.label(&scenario.units));
    let time = &summary.bands.time;
    let shares = passages.iter().flat_map(|of| of.survival.iter().copied());
    let title = "fraction of paths still closer";
    let (vertical, _) = Axis::of_shares(shares.chain([1.0]), title, "", style.log);
    let horizontal = Axis::linear([0.0, scenario.time.end], "time *t*", &time_unit);
    let mut panel = Panel::new(horizontal, vertical, 112.0);
    let mut legend = caveats(scenario, false);
    for (i, of) in passages.iter().enumerate() {
        let Ends { low, high } = &of.survival_ends;
        panel.band(between(time, low, high), palette.wide);
        let stroke = numbered(i, palette);
        panel.line(along(time, &of.survival), stroke.clone());
        let distance = stickslip_text::numbers::significant(of.level, 4);
        let label = format!("closer than {distance} {length_unit}");
        legend.push(LegendEntry::line(stroke, label.trim_end()));
    }
    let interval = intervals(&passages[0].survival_ends, palette);
    legend.extend(interval.map(|_| LegendEntry::area(palette.wide, "95 % interval")));
    Ok(sheet(
        &format!("First passages: {}", scenario.title),
        legend,
        [panel],
    ))
}
