//! Statistics as functions of a key, in one panel for each statistic. There is one curve for each
//! sweep, or for each value of a second key.

use super::axis::minus;
use super::theme::{DASHES, DOTS, LINE, Palette};
use super::trade::{MARKS, look};
use super::words::{letter, of_axis, of_statistic};
use super::{
    Absent, Axis, Colour, Label, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, range_of,
    sheet,
};
use stickslip::stats::{Estimate, Statistic};
use stickslip::study::sweep::{self, AxisValue, AxisValues, Design, Sweep};
use stickslip_text::numbers::significant;

/// The height of a panel, which the longest title determines.
const HEIGHT: f64 = 118.0;

/// A curve of more points than this has no marks.
const MOST_MARKS: usize = 30;

/// The most curves of a sweep; more could not be distinguished.
const MOST_CURVES: usize = 6;

/// Names of files that are longer than this in all have no room at an axis.
const MOST_LETTERS: usize = 60;

/// The points of one sweep along its first axis, at one value of each other axis.
struct Curve<'a> {
    sweep: &'a Sweep,
    label: Label,
    stroke: Stroke,
    mark: Mark,
    /// The numbers of the points, in the order of the values of the first axis.
    points: Vec<usize>,
}

impl Curve<'_> {
    /// The values of the key and the estimates there, in their order.
    fn estimates(&self, statistic: Statistic) -> Vec<(f64, Estimate)> {
        let values = self.sweep.question.design.axes()[0].values.positions();
        let point = |(x, p): (f64, &usize)| {
            Some((
                x,
                *self.sweep.points[*p]
                    .as_ref()?
                    .estimates
                    .get(statistic.index())?,
            ))
        };
        let mut known: Vec<(f64, Estimate)> = values
            .into_iter()
            .zip(&self.points)
            .filter_map(point)
            .collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        known
    }
}

/// An estimate less the bias of its step, where that is certain.
fn without_step(e: &Estimate) -> Option<f64> {
    e.corrected()
        .filter(|_| e.bias.is_some_and(|bias| bias.weight() > 0.0))
        .map(|corrected| corrected.estimate)
}

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (sweeps, statistics) = subject.sweeps()?;
    let Some(first) = sweeps
        .first()
        .map(|(_, sweep)| sweep)
        .filter(|sweep| !sweep.question.design.axes().is_empty())
    else {
        return Err(Absent::Elsewhere("a sweep over axes (--vary)"));
    };
    let axis = &first.question.design.axes()[0];
    let has_same_axis = |(_, other): &(String, Sweep)| {
        other
            .question
            .design
            .axes()
            .first()
            .is_some_and(|other| other.key == axis.key)
    };
    if !sweeps.iter().all(has_same_axis) {
        return Err(Absent::Nothing("the sweeps must vary the same key first"));
    }
    let palette = style.palette();
    let curves = curves(sweeps, palette);
    let mut panels = Vec::new();
    let mut has_corrected = false;
    for (n, &statistic) in statistics.iter().enumerate() {
        let (panel, is_corrected) = panel(statistic, axis, &curves, style)?;
        has_corrected |= is_corrected;
        panels.push(if n + 1 < statistics.len() {
            panel.above_another()
        } else {
            panel
        });
    }
    let mut legend: Vec<LegendEntry> = (curves.iter())
        .map(|curve| LegendEntry {
            mark: Some((curve.mark, curve.stroke.colour)),
            ..LegendEntry::line(curve.stroke.clone(), curve.label.clone())
        })
        .collect();
    if has_corrected {
        legend.push(LegendEntry::mark(
            Mark::Circle,
            palette.ink,
            "corrected for the bias of the step",
        ));
    } else if sweeps
        .iter()
        .any(|(_, sweep)| sweep.question.scenario.scheme.step().is_some())
    {
        legend.push(LegendEntry::words("including the bias of the step"));
    }
    Ok(sheet(
        &format!("Sweep: {}", first.question.scenario.title),
        legend,
        panels,
    ))
}

/// The panel of a statistic, and whether it shows corrected estimates.
fn panel(
    statistic: Statistic,
    axis: &sweep::SweepAxis,
    curves: &[Curve],
    style: &Style,
) -> Result<(Panel, bool), Absent> {
    let drawn: Vec<Vec<(f64, Estimate)>> = curves
        .iter()
        .map(|curve| curve.estimates(statistic))
        .collect();
    let vertical = vertical(statistic, curves, &drawn, style)?;
    let mut panel = Panel::new(horizontal(axis, style), vertical, HEIGHT);
    let mut has_corrected = false;
    for (curve, points) in curves.iter().zip(&drawn) {
        let colour = curve.stroke.colour;
        // A line through files would suggest values between them.
        if let AxisValues::Numbers(_) = axis.values {
            panel.line(
                points.iter().map(|(x, e)| [*x, e.estimate]).collect(),
                curve.stroke.clone(),
            );
        }
        for (x, e) in points {
            panel.interval(*x, [e.low, e.high], colour);
            if let Some(y) = without_step(e) {
                panel.mark([*x, y], Mark::Circle, colour);
                has_corrected = true;
            }
            if points.len() <= MOST_MARKS {
                panel.mark([*x, e.estimate], curve.mark, colour);
            }
        }
    }
    Ok((panel, has_corrected))
}

/// The axis of a statistic. It holds all estimates and their intervals.
fn vertical(
    statistic: Statistic,
    curves: &[Curve],
    drawn: &[Vec<(f64, Estimate)>],
    style: &Style,
) -> Result<Axis, Absent> {
    let all = || drawn.iter().flatten().map(|(_, e)| e);
    let numbers = || {
        all()
            .flat_map(|e| [e.estimate, e.low, e.high])
            .chain(all().filter_map(without_step))
    };
    let [least, most] = range_of(numbers());
    if !least.is_finite() {
        return Err(Absent::Nothing("the statistic does not exist at any point"));
    }
    let units = &curves[0].sweep.question.scenario.units;
    let unit = statistic.dimension().label(units);
    let title = of_statistic(statistic, style);
    let positive = range_of(numbers().filter(|y| *y > 0.0));
    Ok(match style.log && positive[0].is_finite() {
        true => Axis::log_around(positive, title, &unit),
        false if least >= 0.0 => Axis::from_zero(most, title, &unit),
        false => Axis::around(numbers(), title, &unit),
    })
}

/// The space at both ends of the horizontal axis, as a share of it, for the bars of the outermost
/// points.
const MARGIN: f64 = 0.02;

/// The horizontal axis. It is logarithmic if the values are evenly spaced in their logarithms.
pub(super) fn horizontal(axis: &sweep::SweepAxis, style: &Style) -> Axis {
    let title = of_axis(axis, style);
    let values = match &axis.values {
        AxisValues::Numbers(numbers) => numbers,
        AxisValues::Files(files) if files.iter().map(String::len).sum::<usize>() > MOST_LETTERS => {
            let title = Label::verbatim("number of the file");
            return Axis::linear([-0.5, files.len() as f64 - 0.5], title, "").whole();
        }
        AxisValues::Files(files) => {
            let names = files.iter().enumerate();
            let names = names.map(|(i, file)| (i as f64, Label::verbatim(file)));
            return Axis::named([-0.5, files.len() as f64 - 0.5], names.collect());
        }
    };
    let [low, high] = range_of(values.iter().copied());
    let is_even = |pair: [f64; 2]| (pair[0] - pair[1]).abs() < 1e-6 * pair[0].abs();
    let is_log = low > 0.0
        && values
            .windows(3)
            .all(|v| is_even([v[1] / v[0], v[2] / v[1]]))
        && values
            .windows(3)
            .any(|v| !is_even([v[1] - v[0], v[2] - v[1]]));
    let room = MARGIN
        * if is_log {
            (high / low).ln()
        } else {
            high - low
        };
    match is_log {
        true => Axis::log([low / room.exp(), high * room.exp()], title, ""),
        false => Axis::linear([low - room, high + room], title, ""),
    }
}

/// The stroke of the curve with this number, which distinguishes it from the others.
pub(super) fn numbered(i: usize, palette: &Palette) -> Stroke {
    let colours: [Colour; 4] = [palette.first, palette.second, palette.third, palette.fourth];
    let dashes: [&[f64]; 3] = [&[], &DASHES, &DOTS];
    Stroke::dashed(colours[i % 4], LINE, dashes[i % 3])
}

fn curves<'a>(sweeps: &'a [(String, Sweep)], palette: &Palette) -> Vec<Curve<'a>> {
    let kinds: Vec<_> = sweeps
        .iter()
        .map(|(_, sweep)| sweep.question.scenario.scheme.kind())
        .collect();
    let are_distinct = (0..kinds.len()).all(|i| !kinds[..i].contains(&kinds[i]));
    let mut curves = Vec::new();
    for (i, (file, sweep)) in sweeps.iter().enumerate() {
        let scheme = sweep.question.scenario.scheme;
        let varies_step = sweep
            .question
            .design
            .axes()
            .iter()
            .any(|axis| axis.key == "time.step");
        let name = match (are_distinct, scheme.step()) {
            (false, _) => file.clone(),
            (true, Some(h)) if !varies_step => format!("{}, step {h}", scheme.name()),
            (true, _) => scheme.name().to_string(),
        };
        let design = &sweep.question.design;
        let length = design.axes()[0].values.len();
        let others = if matches!(design, Design::Grid(_)) {
            design.points() / length
        } else {
            1
        };
        let shown = others.min(MOST_CURVES);
        for k in 0..shown {
            // The curves that are drawn are spread over the values of the other axes.
            let other = if shown > 1 {
                k * (others - 1) / (shown - 1)
            } else {
                0
            };
            let points: Vec<usize> = (0..length).map(|i| i * others + other).collect();
            let (stroke, mark) = if others == 1 && are_distinct {
                look(kinds[i])
            } else {
                (numbered(curves.len(), palette), MARKS[curves.len() % 4])
            };
            let at = design.settings(points[0]);
            let axes = design.axes().iter().zip(&at).skip(1).filter(|_| others > 1);
            let mut label = if others == 1 || sweeps.len() > 1 {
                Label::verbatim(&name)
            } else {
                Label::default()
            };
            for (n, (axis, setting)) in axes.enumerate() {
                let comma = if n > 0 || sweeps.len() > 1 { ", " } else { "" };
                label = label.and(comma).and(letter(&axis.name)).and(" = ");
                label = match &setting.value {
                    AxisValue::Number(x) => label.and(minus(&significant(*x, 4))),
                    AxisValue::File(file) => label.and(Label::verbatim(file)),
                };
            }
            curves.push(Curve {
                sweep,
                label,
                stroke,
                mark,
                points,
            });
        }
    }
    curves
}
