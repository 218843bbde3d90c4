//! The cost of accuracy: the CPU time of the cheapest run that reaches a target, and the bias
//! against the step, for every scheme, on logarithmic axes.

use super::theme::{LINE, Palette};
use super::{
    Absent, Axis, Colour, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, range_of, sheet,
};
use stickslip::scheme::Kind;
use stickslip::study::trade::{CostCurve, CostCurves, Number};

/// CPU seconds of a year. Runs that take longer are not drawn.
const YEAR: f64 = 3.2e7;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let costs = subject.trade()?;
    let is_drawn = |point: &&[f64; 2]| point[0] > 0.0 && point[0] < YEAR;
    let curves: Vec<(&CostCurve, Vec<[f64; 2]>)> = costs
        .curves
        .iter()
        .map(|curve| {
            (
                curve,
                curve.costs.iter().filter(is_drawn).copied().collect(),
            )
        })
        .collect();
    let points = || curves.iter().flat_map(|(_, points)| points);
    if points().next().is_none() {
        return Err(Absent::Nothing(
            "no scheme reaches any target for this statistic",
        ));
    }
    let palette = style.palette();
    let seconds = Axis::log_around(
        range_of(points().map(|point| point[0])),
        "CPU time on one thread",
        "s",
    );
    let error = format!("relative RMSE, {}", costs.statistic.words());
    let errors = Axis::log_around(range_of(points().map(|point| point[1])), error, "");
    let mut panel = Panel::new(seconds, errors, 150.0);
    let mut legend = Vec::new();
    decades(palette, &mut panel);
    for (curve, points) in &curves {
        let (stroke, mark) = look(curve.scheme);
        panel.line(points.clone(), stroke.clone());
        points
            .iter()
            .for_each(|point| panel.mark(*point, mark, stroke.colour));
        if !points.is_empty() || !curve.biases.is_empty() {
            legend.push(LegendEntry {
                mark: Some((mark, stroke.colour)),
                ..LegendEntry::line(stroke, curve.scheme.name())
            });
        }
    }
    let panels = std::iter::once(panel).chain(biases(costs, style));
    Ok(sheet(
        &format!("Cost of accuracy: {}", costs.title),
        legend,
        panels.collect::<Vec<_>>(),
    ))
}

/// The bias of each scheme against its step, with the order that was seen. None if no scheme has a
/// bias that differs from zero.
fn biases(costs: &CostCurves, style: &Style) -> Option<Panel> {
    let palette = style.palette();
    let ends =
        |bias: &Number| [-1.0, 1.0].map(|side| bias.value.abs() + side * TWO_SIDED * bias.error);
    let all = || {
        costs
            .curves
            .iter()
            .flat_map(|curve| &curve.biases)
            .filter(|(_, bias)| bias.value != 0.0)
    };
    let seen = all()
        .filter(|(_, bias)| ends(bias)[0] > 0.0)
        .flat_map(|(_, bias)| {
            let [low, high] = ends(bias);
            [low.max(LEAST * bias.value.abs()), high]
        });
    let sizes = range_of(seen);
    if !sizes[0].is_finite() {
        return None;
    }
    let title = format!("relative bias, {}", costs.statistic.words());
    let steps = Axis::log_around(range_of(all().map(|(step, _)| *step)), "time step *h*", "");
    let mut panel = Panel::new(steps, Axis::log_around(sizes, title, ""), 130.0);
    decades(palette, &mut panel);
    let mut key = Vec::new();
    for curve in &costs.curves {
        let (stroke, mark) = look(curve.scheme);
        let points = || curve.biases.iter().filter(|(_, bias)| bias.value != 0.0);
        panel.line(
            points()
                .map(|(step, bias)| [*step, bias.value.abs()])
                .collect(),
            stroke.clone(),
        );
        for (step, bias) in points() {
            panel.interval(*step, ends(bias), stroke.colour);
            panel.mark([*step, bias.value.abs()], mark, stroke.colour);
        }
        if let Some(Number { value, error }) = curve.order {
            let slope = format!("slope {value:.2} \u{b1} {error:.2}");
            key.push(LegendEntry {
                mark: Some((mark, stroke.colour)),
                ..LegendEntry::line(stroke, &slope)
            });
        }
    }
    Some(panel.keyed(key))
}

/// The part of a bias down to which its interval is shown in full.
const LEAST: f64 = 0.1;

/// The 97.5 % quantile of the standard normal distribution.
const TWO_SIDED: f64 = 1.96;

/// Faint lines at powers of ten.
fn decades(palette: &Palette, panel: &mut Panel) {
    (-12..8).for_each(|n| panel.level(10f64.powi(n), Stroke::solid(palette.grid, 0.4)));
}

/// The marks of curves that are shown together.
pub(super) const MARKS: [Mark; 4] = [Mark::Disc, Mark::Square, Mark::Triangle, Mark::Diamond];

/// The look of a scheme. Its colour, its dashes and its marks each distinguish it from the other
/// schemes.
pub(super) fn look(kind: Kind) -> (Stroke, Mark) {
    let look = kind.appearance();
    let rgb = u32::from_str_radix(look.colour.trim_start_matches('#'), 16).unwrap_or(0);
    let dash: Vec<f64> = look
        .dash
        .split_whitespace()
        .filter_map(|length| length.parse::<f64>().ok())
        .map(|l| 0.6 * l)
        .collect();
    let place = Kind::ALL
        .iter()
        .position(|other| *other == kind)
        .unwrap_or(0);
    (
        Stroke::dashed(Colour::hex(rgb), LINE, &dash),
        MARKS[place % 4],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schemes_are_told_apart_without_colour() {
        for (i, one) in Kind::ALL.iter().enumerate() {
            for other in &Kind::ALL[..i] {
                let ((a, mark), (b, other_mark)) = (look(*one), look(*other));
                assert!(
                    a.dash != b.dash && mark != other_mark && a.colour != b.colour,
                    "{one:?} {other:?}"
                );
            }
        }
    }
}
