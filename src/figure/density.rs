//! Where in its phase plane the body spends its time: the density of x\u{2032} on a linear and on a
//! logarithmic axis, that of x, and that of both as cells of a plane.

use super::steps::{self, DensityBin};
use super::{Absent, Axis, Figure, Label, LegendEntry, Panel, Sheet, Style, Subject, range_of, sheet, solid};
use crate::stats::{DensityCurve, Dimension};

/// The figure.
pub const FIGURE: Figure =
    Figure { name: "density", shows: "where in the phase plane the body spends its time", draws: draw };

/// Levels of the joint density, as parts of its largest value, from the outermost on.
const LEVELS: [f64; 6] = [0.003, 0.01, 0.03, 0.1, 0.3, 0.6];

fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let Some(densities) = &summary.densities else {
        return Err(Absent::Nothing("the run has no densities: set record.density = true"));
    };
    if densities.velocity.density.len() < 2 || densities.displacement.density.len() < 2 {
        return Err(Absent::Nothing("the body does not move at the times of the output grid"));
    }
    let palette = style.palette();
    let unit = |time: i32, length: i32| Dimension { time, length, ..Dimension::ONE }.label(&scenario.units);
    let axis_of = |curve: &DensityCurve, title: &str, unit: &str| {
        Axis::linear([curve.edges[0], curve.edges[curve.edges.len() - 1]], Label::new(title), unit)
    };
    let panel = |curve: &DensityCurve, horizontal: Axis, title: &str, unit: &str, is_log: bool| {
        let [_, most] = range_of(curve.density.iter().copied());
        let [least, _] = range_of(curve.density.iter().copied().filter(|density| *density > 0.0));
        let vertical = match is_log {
            true => Axis::log_around([least, most], Label::new(title), unit),
            false => Axis::from_zero(most, Label::new(title), unit),
        };
        let floor = if is_log { least / 10.0 } else { 0.0 };
        let mut panel = Panel::new(horizontal, vertical, 66.0);
        let bin = |(i, density): (usize, &f64)| {
            let ends = if *density > 0.0 { curve.ends.at(i) } else { [0.0; 2] };
            ([curve.edges[i], curve.edges[i + 1]], *density, ends)
        };
        let steps: Vec<DensityBin> = curve.density.iter().enumerate().map(bin).collect();
        steps::draw(&steps, floor, palette, &mut panel);
        panel
    };
    let velocity = |is_log| {
        let horizontal = axis_of(&densities.velocity, "velocity *x*\u{2032}", &unit(-1, 1));
        panel(&densities.velocity, horizontal, "density of *x*\u{2032}", &unit(1, -1), is_log)
    };
    let horizontal = axis_of(&densities.displacement, "displacement *x*", &unit(0, 1));
    let displacement = panel(&densities.displacement, horizontal, "density of *x*", &unit(0, -1), style.log);
    let [rows, columns] = &densities.joint_edges;
    let ends = |edges: &[f64]| [edges[0], edges[edges.len() - 1]];
    let mut plane = Panel::new(
        Axis::linear(ends(rows), Label::new("displacement *x*"), &unit(0, 1)),
        Axis::linear(ends(columns), Label::new("velocity *x*\u{2032}"), &unit(-1, 1)),
        96.0,
    );
    let [_, most] = range_of(densities.joint.iter().copied());
    // From the outermost level on, each over the one before it.
    for (n, level) in LEVELS.iter().enumerate() {
        let reached = densities.joint.indexed_iter().filter(|(_, density)| **density >= level * most);
        let cell = |((i, j), _): ((usize, usize), &f64)| [[rows[i], columns[j]], [rows[i + 1], columns[j + 1]]];
        let share = (n + 1) as f64 / LEVELS.len() as f64;
        plane.bars(reached.map(cell).collect(), palette.background.mixed(palette.first, share));
    }
    let rest = crate::numbers::significant(100.0 * densities.at_rest, 3);
    let legend = [
        LegendEntry::words(Label::verbatim(&format!("in motion; at rest {rest} % of the time"))),
        LegendEntry::line(solid(palette.first), "density"),
        LegendEntry::area(palette.narrow, "95 % interval"),
    ];
    let levels = LegendEntry::words(Label::verbatim("0.3, 1, 3, 10, 30 and 60 % of the highest density"));
    let panels = [velocity(false).above_another(), velocity(true), displacement, plane.keyed([levels])];
    Ok(sheet(&format!("Densities: {}", scenario.title), legend, panels))
}
