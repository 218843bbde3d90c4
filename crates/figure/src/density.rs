//! The densities of x\u{2032} on a linear and on a logarithmic axis, of x, and of both as cells of
//! the phase plane.

use super::axis::written;
use super::steps::{self, DensityBin};
use super::theme::Palette;
use super::words::{caveats, intervals};
use super::{Absent, Axis, Label, LegendEntry, Panel, Sheet, Style, Subject, range_of, sheet};
use ndarray::Array2;
use stickslip::stats::{Densities, DensityCurve, Dimension};

/// The fractions of the time in motion in the areas of highest density.
const HELD: [f64; 2] = [0.94, 0.5];

/// Ends of intervals below this share of the smallest density are not drawn.
const LOWEST: f64 = 0.1;

/// The fraction of it within the axes.
const SEEN: f64 = 0.99;

/// Each cell of the file is drawn as this number of cells along each axis, between whose middles
/// densities are interpolated.
const FINER: usize = 4;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (scenario, summary) = subject.run()?;
    let Some(densities) = &summary.densities else {
        return Err(Absent::Nothing(
            "the run has no densities: set record.density = true",
        ));
    };
    if densities.velocity.density.len() < 2 || densities.displacement.density.len() < 2 {
        return Err(Absent::Nothing(
            "the body does not move at the times of the output grid",
        ));
    }
    let palette = style.palette();
    let unit = |time: i32, length: i32| {
        Dimension {
            time,
            length,
            ..Dimension::ONE
        }
        .label(&scenario.units)
    };
    let axes = [
        ("displacement *x*", unit(0, 1)),
        ("velocity *x*\u{2032}", unit(-1, 1)),
    ];
    let velocity = |is_log| {
        let title = ("density of *x*\u{2032}", unit(1, -1));
        marginal(&densities.velocity, &axes[1], title, is_log, palette)
    };
    let title = ("density of *x*", unit(0, -1));
    let displacement = marginal(&densities.displacement, &axes[0], title, style.log, palette);
    let moving = written(100.0 * (1.0 - densities.at_rest), 3);
    let mut legend = vec![
        LegendEntry::words(
            Label::from("*x*\u{2032} in motion, ")
                .and(moving)
                .and(" % of the time"),
        ),
        steps::entry("density", palette),
    ];
    legend.extend(intervals(&densities.velocity.ends, palette));
    legend.extend(caveats(scenario, false));
    let panels = [
        velocity(false).above_another(),
        velocity(true),
        displacement,
        plane(densities, &axes, palette),
    ];
    Ok(sheet(
        &format!("Densities: {}", scenario.title),
        legend,
        panels,
    ))
}

/// The title of an axis and its unit.
type Titled = (&'static str, String);

/// The density of one variable.
fn marginal(
    curve: &DensityCurve,
    (variable, variable_unit): &Titled,
    (title, unit): Titled,
    is_log: bool,
    palette: &Palette,
) -> Panel {
    let ends = [curve.edges[0], curve.edges[curve.edges.len() - 1]];
    let horizontal = Axis::linear(ends, *variable, variable_unit);
    // A log axis holds the densities and their intervals, except for those that reach down to zero.
    let [least, _] = range_of(
        curve
            .density
            .iter()
            .copied()
            .filter(|density| *density > 0.0),
    );
    let lows = curve.ends.low.iter().filter(|low| **low > LOWEST * least);
    let shares = curve.density.iter().chain(&curve.ends.high).chain(lows);
    let (vertical, floor) = Axis::of_shares(shares.copied(), title, &unit, is_log);
    let mut panel = Panel::new(horizontal, vertical, 66.0);
    let bin = |(i, density): (usize, &f64)| {
        let ends = if *density > 0.0 {
            curve.ends.at(i)
        } else {
            [0.0; 2]
        };
        ([curve.edges[i], curve.edges[i + 1]], *density, ends)
    };
    let steps: Vec<DensityBin> = curve.density.iter().enumerate().map(bin).collect();
    steps::draw(&steps, floor, palette, &mut panel);
    panel
}

/// The density of both variables, with the areas that hold most of the time.
fn plane(densities: &Densities, [x, y]: &[Titled; 2], palette: &Palette) -> Panel {
    let [rows, columns] = &densities.joint_edges;
    let ends = [rows, columns].map(|edges| [edges[0], edges[edges.len() - 1]]);
    let cells = finer(&densities.joint);
    let seen: Vec<[f64; 2]> = above(&cells, level(&cells, SEEN), ends).concat();
    let seen = |k: usize| range_of(seen.iter().map(|corner| corner[k]));
    let mut plane = Panel::new(
        Axis::around(seen(0), x.0, &x.1),
        Axis::around(seen(1), y.0, &y.1),
        96.0,
    );
    let areas = HELD.into_iter().zip([palette.wide, palette.narrow]);
    for (held, fill) in areas.clone() {
        plane.bars(above(&cells, level(&cells, held), ends), fill);
    }
    let words = |held: f64| format!("{} % of the time in motion", 100.0 * held);
    plane.keyed(areas.map(|(held, fill)| LegendEntry::area(fill, words(held))))
}

/// The density in smaller cells, by linear interpolation between the middles of the cells of the
/// file.
fn finer(joint: &Array2<f64>) -> Array2<f64> {
    let at = |i: usize, n: usize| {
        let place = ((i as f64 + 0.5) / FINER as f64 - 0.5).clamp(0.0, n as f64 - 1.0);
        let first = (place as usize).min(n.saturating_sub(2));
        (first, (first + 1).min(n - 1), place - first as f64)
    };
    let (n, m) = joint.dim();
    Array2::from_shape_fn((n * FINER, m * FINER), |(i, j)| {
        let ((a, b, s), (c, d, t)) = (at(i, n), at(j, m));
        (1.0 - s) * ((1.0 - t) * joint[[a, c]] + t * joint[[a, d]])
            + s * ((1.0 - t) * joint[[b, c]] + t * joint[[b, d]])
    })
}

/// The density above which the cells hold this share of the whole.
fn level(cells: &Array2<f64>, held: f64) -> f64 {
    let mut sorted: Vec<f64> = cells.iter().copied().collect();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let mut missing = held * sorted.iter().sum::<f64>();
    let reached = sorted.into_iter().find(|density| {
        missing -= density;
        missing <= 0.0
    });
    reached.unwrap_or(f64::INFINITY)
}

/// Rectangles over the cells that reach a level: one for each run of neighbours along the second
/// axis.
fn above(cells: &Array2<f64>, level: f64, [x, y]: [[f64; 2]; 2]) -> Vec<[[f64; 2]; 2]> {
    let (n, m) = cells.dim();
    let place =
        |[low, high]: [f64; 2], i: usize, n: usize| low + (high - low) * i as f64 / n as f64;
    let mut out = Vec::new();
    for (i, row) in cells.outer_iter().enumerate() {
        let mut begun = None;
        for j in 0..=m {
            let is_reached = j < m && row[j] >= level;
            if is_reached {
                begun.get_or_insert(j);
            } else if let Some(first) = begun.take() {
                out.push([
                    [place(x, i, n), place(y, first, m)],
                    [place(x, i + 1, n), place(y, j, m)],
                ]);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The time in the areas of a normal law in two dimensions is known: a share p of it lies within
    /// r of the middle, where r^2 = -2 ln(1 - p).
    #[test]
    fn the_areas_hold_the_time_that_they_are_named_by() {
        let edge = |i: usize| -5.0 + 10.0 * i as f64 / 64.0;
        let square = |i: usize| (0.5 * (edge(i) + edge(i + 1))).powi(2);
        let cells = finer(&Array2::from_shape_fn((64, 64), |(i, j)| {
            (-0.5 * (square(i) + square(j))).exp()
        }));
        for held in HELD {
            let area: f64 = above(&cells, level(&cells, held), [[-5.0, 5.0]; 2])
                .iter()
                .map(|[from, to]| (to[0] - from[0]) * (to[1] - from[1]))
                .sum();
            let expected = std::f64::consts::PI * -2.0 * (1.0 - held).ln();
            assert!(
                (area / expected - 1.0).abs() < 0.02,
                "{held}: {area} instead of {expected}"
            );
        }
    }
}
