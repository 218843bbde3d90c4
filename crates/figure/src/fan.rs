//! Quantile bands of x over time, and the probability of a stick on the same axis of time.

use super::theme::{DASHES, LINE, Palette};
use super::words::{caveats, intervals};
use super::{
    Absent, Axis, LegendEntry, Panel, Sheet, Stroke, Style, Subject, range_of, sheet, solid,
};
use stickslip::stats::{Bands, Dimension, QUANTILE_LEVELS};

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let bands = &summary.bands;
    let (time, x) = (&bands.time, &bands.displacement);
    if time.len() < 2 || x.mean.iter().all(|mean| mean.is_nan()) {
        return Err(Absent::Nothing(
            "the output grid has fewer than two rows, or every path was lost",
        ));
    }
    let palette = style.palette();
    let [time_unit, length_unit] =
        [Dimension::TIME, Dimension::LENGTH].map(|d| d.label(&scenario.units));
    let time_axis = || Axis::linear([time[0], time[time.len() - 1]], "time *t*", &time_unit);

    let seen = widest(bands).into_iter().chain(x.mean.iter().copied());
    let mut fan = Panel::new(
        time_axis(),
        Axis::around(seen, "displacement *x*(*t*)", &length_unit),
        112.0,
    );
    quantiles(bands, palette, &mut fan);
    let mean = Stroke::dashed(palette.second, LINE, &DASHES);
    let key = match summary.completed_paths {
        // The quantiles of one path are itself.
        1 => vec![LegendEntry::line(
            solid(palette.first),
            "the one path, at the rows of the output grid",
        )],
        _ => {
            fan.line(along(time, &x.mean), mean.clone());
            vec![
                LegendEntry::line(solid(palette.first), "median"),
                LegendEntry::line(mean, "mean"),
                LegendEntry::area(palette.narrow, "25–75 %"),
                LegendEntry::area(palette.wide, "5–95 % of the paths"),
            ]
        }
    };

    let ends = &bands.static_probability_ends;
    let [_, top] = range_of(ends.high.iter().chain(&bands.static_probability).copied());
    let top = if top > 0.0 { top } else { 1.0 };
    let mut share = Panel::new(time_axis(), Axis::from_zero(top, "*P*(stick)", ""), 62.0);
    share.band(held(between(time, &ends.low, &ends.high)), palette.narrow);
    share.line(
        held(along(time, &bands.static_probability)),
        solid(palette.first),
    );
    let curve = LegendEntry::line(solid(palette.first), "fraction of paths in a stick");
    let share = share.keyed(std::iter::once(curve).chain(intervals(ends, palette)));
    Ok(sheet(
        &format!("Displacement of the paths: {}", scenario.title),
        caveats(scenario, false),
        [fan.above_another().keyed(key), share],
    ))
}

/// The points of a curve that keeps each value until the next.
fn held<const N: usize>(points: Vec<[f64; N]>) -> Vec<[f64; N]> {
    let corner = |pair: &[[f64; N]]| {
        let mut corner = pair[0];
        corner[0] = pair[1][0];
        [pair[0], corner]
    };
    let last = points.last().copied();
    points.windows(2).flat_map(corner).chain(last).collect()
}

/// The lowest and the highest quantile of x at each time.
pub(super) fn widest(bands: &Bands) -> Vec<f64> {
    let rows = &bands.displacement.quantiles;
    rows.row(0)
        .iter()
        .chain(rows.row(QUANTILE_LEVELS.len() - 1))
        .copied()
        .collect()
}

/// Draws the quantiles of x: two bands and the median.
pub(super) fn quantiles(bands: &Bands, palette: &Palette, panel: &mut Panel) {
    debug_assert_eq!(QUANTILE_LEVELS, [0.05, 0.25, 0.5, 0.75, 0.95]);
    let row = |level: usize| bands.displacement.quantiles.row(level).to_vec();
    panel.band(between(&bands.time, &row(0), &row(4)), palette.wide);
    panel.band(between(&bands.time, &row(1), &row(3)), palette.narrow);
    panel.line(along(&bands.time, &row(2)), solid(palette.first));
}

/// The points of a curve.
pub(super) fn along(x: &[f64], y: &[f64]) -> Vec<[f64; 2]> {
    x.iter().zip(y).map(|(x, y)| [*x, *y]).collect()
}

/// The area between two curves, as points (x, low, high).
pub(super) fn between(x: &[f64], low: &[f64], high: &[f64]) -> Vec<[f64; 3]> {
    x.iter()
        .zip(low.iter().zip(high))
        .map(|(x, (low, high))| [*x, *low, *high])
        .collect()
}
