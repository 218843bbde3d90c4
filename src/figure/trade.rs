//! What accuracy costs: the CPU time of the cheapest run that reaches a target, for every scheme,
//! on logarithmic axes.

use super::theme::LINE;
use super::{
    Absent, Axis, Colour, Drawing, Figure, Label, LegendEntry, Mark, Panel, Stroke, Style, Subject, range_of, sheet,
};
use crate::scheme::Kind;

/// The figure.
pub const FIGURE: Figure =
    Figure { name: "trade", shows: "the error that CPU time buys, scheme by scheme", draws: draw };

/// CPU seconds of a year. Runs that take longer are not drawn.
const YEAR: f64 = 3.2e7;

fn draw(subject: &Subject, style: &Style) -> Result<Drawing, Absent> {
    let prices = subject.trade()?;
    let is_drawn = |point: &&[f64; 2]| point[0] > 0.0 && point[0] < YEAR;
    let curves: Vec<(Kind, Vec<[f64; 2]>)> =
        prices.curves.iter().map(|(kind, points)| (*kind, points.iter().filter(is_drawn).copied().collect())).collect();
    let points = || curves.iter().flat_map(|(_, points)| points);
    if points().next().is_none() {
        return Err(Absent::Nothing("no scheme was found to reach any target for this statistic"));
    }
    let palette = style.palette();
    let [cheapest, dearest] = range_of(points().map(|point| point[0]));
    let [finest, coarsest] = range_of(points().map(|point| point[1]));
    let seconds = Axis::log([cheapest / 2.0, dearest * 2.0], Label::new("CPU time on one thread"), "s");
    let error = format!("relative RMSE, {}", prices.statistic.words());
    let mut panel = Panel::new(seconds, Axis::log([finest / 1.5, coarsest * 1.5], Label::new(&error), ""), 150.0);
    let mut legend = Vec::new();
    for (kind, points) in curves.iter().filter(|(_, points)| !points.is_empty()) {
        let (stroke, mark) = look(*kind);
        panel.line(points.clone(), stroke.clone());
        points.iter().for_each(|point| panel.mark(*point, mark, stroke.colour));
        legend.push(LegendEntry { mark: Some((mark, stroke.colour)), ..LegendEntry::line(stroke, kind.name()) });
    }
    for decade in (-8..8).map(|n| 10f64.powi(n)) {
        panel.level(decade, Stroke::solid(palette.grid, 0.4));
    }
    Ok(sheet(style, &format!("What accuracy costs: {}", prices.title), &legend, &[panel]))
}

/// The marks of curves that are shown together.
pub(super) const MARKS: [Mark; 4] = [Mark::Disc, Mark::Square, Mark::Triangle, Mark::Diamond];

/// The look of a scheme. Its colour, its dashes and its marks each distinguish it from the other
/// schemes.
pub(super) fn look(kind: Kind) -> (Stroke, Mark) {
    let look = kind.look();
    let rgb = u32::from_str_radix(look.colour.trim_start_matches('#'), 16).unwrap_or(0);
    let dash: Vec<f64> =
        look.dash.split_whitespace().filter_map(|length| length.parse::<f64>().ok()).map(|l| 0.6 * l).collect();
    let place = Kind::ALL.iter().position(|other| *other == kind).unwrap_or(0);
    (Stroke::dashed(Colour::hex(rgb), LINE, &dash), MARKS[place % 4])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schemes_are_told_apart_without_colour() {
        for (i, one) in Kind::ALL.iter().enumerate() {
            for other in &Kind::ALL[..i] {
                let ((a, mark), (b, other_mark)) = (look(*one), look(*other));
                assert!(a.dash != b.dash && mark != other_mark && a.colour != b.colour, "{one:?} {other:?}");
            }
        }
    }
}
