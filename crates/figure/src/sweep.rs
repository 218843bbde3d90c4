//! Statistics as functions of a key, in one panel for each statistic. There is one curve for each
//! sweep, or for each value of a second key.

use super::axis::minus;
use super::theme::{DASHES, DOTS, LINE, Palette, THIN};
use super::trade::{MARKS, look};
use super::words::{letter, of_axis, of_statistic};
use super::{
    Absent, Axis, Colour, Label, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, range_of,
    sheet,
};
use std::path::Path;
use stickslip::stats::{Estimate, Statistic};
use stickslip::study::sweep::{self, AxisValue, AxisValues, Design, Sweep};
use stickslip_text::numbers::significant;

/// The height of a panel, which the longest title determines.
const HEIGHT: f64 = 118.0;

/// A curve of more points than this has no marks.
const MOST_MARKS: usize = 30;

/// More curves of a sweep could not be distinguished by dashes and colours, and have the colours of a
/// scale.
const MOST_CURVES: usize = 6;

/// Names of files that are longer than this in all stand upright at an axis.
const MOST_LETTERS: usize = 60;

/// The height of a scale of colours.
const SCALE: f64 = 7.0;

/// What the colours of many curves are: numbers along an axis, one for each curve of a sweep.
struct ColourScale {
    axis: Axis,
    at: Vec<f64>,
}

impl ColourScale {
    /// The scale of these sweeps, if they have many curves and vary the same keys. The colours stand
    /// for the second key or, where more keys vary, for the number of the setting.
    fn of(sweeps: &[(String, Sweep)], style: &Style) -> Option<ColourScale> {
        let design = |of: &Sweep| match &of.question.design {
            Design::Grid(axes) => axes[1..].to_vec(),
            _ => Vec::new(),
        };
        let others = design(&sweeps.first()?.1);
        let count: usize = others.iter().map(|axis| axis.values.len()).product();
        let are_alike = sweeps.iter().all(|(_, other)| design(other) == others);
        let is_scale = count > MOST_CURVES && are_alike;
        is_scale.then(|| match &others[..] {
            [axis] => ColourScale {
                axis: horizontal(axis, style),
                at: axis.values.positions(),
            },
            _ => ColourScale {
                axis: Axis::linear([-0.5, count as f64 - 0.5], "number of the setting", "").whole(),
                at: (0..count).map(|i| i as f64).collect(),
            },
        })
    }

    fn colour(&self, at: f64, palette: &Palette) -> Colour {
        match 2.0 * self.axis.place(at).clamp(0.0, 1.0) {
            low if low < 1.0 => palette.first.mixed(palette.third, low),
            high => palette.third.mixed(palette.second, high - 1.0),
        }
    }

    /// A bar with the colour of each number.
    fn panel(self, palette: &Palette) -> Panel {
        let mut at = self.at.clone();
        at.sort_by(f64::total_cmp);
        let middles = at.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let left = std::iter::once(f64::NEG_INFINITY).chain(middles);
        let upright = Axis::named([0.0, 1.0], vec![(0.0, Label::default())]);
        let mut panel = Panel::new(self.axis.clone(), upright, SCALE);
        // Each bar covers the end of the one before it, so that no hairline separates them.
        for (at, left) in at.iter().zip(left) {
            panel.bar([left, 0.0], [f64::INFINITY, 1.0], self.colour(*at, palette));
        }
        panel.is_scale = true;
        panel
    }
}

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
        return Err(Absent::Elsewhere("a sweep over keys"));
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
    let scale = ColourScale::of(sweeps, style);
    let curves = curves(sweeps, scale.as_ref(), palette);
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
    let entry = |curve: &Curve| LegendEntry {
        mark: Some((curve.mark, curve.stroke.colour)),
        ..LegendEntry::line(curve.stroke.clone(), curve.label.clone())
    };
    let each = match &scale {
        Some(_) if sweeps.len() == 1 => 0,
        Some(scale) => scale.at.len(),
        None => 1,
    };
    let mut legend: Vec<LegendEntry> = match each {
        0 => Vec::new(),
        each => curves.iter().step_by(each).map(entry).collect(),
    };
    panels.extend(scale.map(|scale| scale.panel(palette)));
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

/// The name of a file without its folder and its extension, if that distinguishes it from the others.
fn stem<'a>(file: &'a str, files: &[String]) -> &'a str {
    let of = |file: &'a str| Path::new(file).file_stem().and_then(|stem| stem.to_str());
    let stem = |file: &str| Path::new(file).file_stem().map(|stem| stem.to_os_string());
    let alike = files
        .iter()
        .filter(|other| stem(other) == stem(file))
        .count();
    of(file).filter(|_| alike == 1).unwrap_or(file)
}

/// The space at both ends of the horizontal axis, as a share of it, for the bars of the outermost
/// points.
const MARGIN: f64 = 0.02;

/// The horizontal axis. It is logarithmic if the values are evenly spaced in their logarithms.
pub(super) fn horizontal(axis: &sweep::SweepAxis, style: &Style) -> Axis {
    let title = of_axis(axis, style);
    let values = match &axis.values {
        AxisValues::Numbers(numbers) => numbers,
        AxisValues::Files(files) => {
            let names: Vec<&str> = files.iter().map(|file| stem(file, files)).collect();
            let is_long = names.iter().map(|name| name.len()).sum::<usize>() > MOST_LETTERS;
            let names = names.into_iter().enumerate();
            let names = names.map(|(i, name)| (i as f64, Label::verbatim(name)));
            let axis = Axis::named([-0.5, files.len() as f64 - 0.5], names.collect());
            return if is_long { axis.upright(title) } else { axis };
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

fn curves<'a>(
    sweeps: &'a [(String, Sweep)],
    scale: Option<&ColourScale>,
    palette: &Palette,
) -> Vec<Curve<'a>> {
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
        for k in 0..others {
            let points: Vec<usize> = (0..length).map(|i| i * others + k).collect();
            let (stroke, mark) = match scale {
                Some(scale) => {
                    let colour = scale.colour(scale.at[k], palette);
                    (
                        Stroke {
                            colour,
                            width: THIN,
                            ..numbered(i, palette)
                        },
                        MARKS[i % 4],
                    )
                }
                None if others == 1 && are_distinct => look(kinds[i]),
                None => (numbered(curves.len(), palette), MARKS[curves.len() % 4]),
            };
            let at = design.settings(points[0]);
            let has_values = others > 1 && scale.is_none();
            let axes = design.axes().iter().zip(&at).skip(1).filter(|_| has_values);
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;
    use std::sync::atomic::AtomicBool;
    use stickslip::config::Override;
    use stickslip::scenario::Scenario;
    use stickslip::study::sweep::{Seeds, SweepAxis, SweepQuestion, SweepSimulation};

    /// A sweep of a body without noise over these axes.
    fn swept(axes: &[&str]) -> Sweep {
        let axes = axes.iter().map(|axis| SweepAxis::parse(axis, |_| None));
        let design = Design::of(axes.collect::<Result<_, _>>().expect("axes"), false);
        let design = design.expect("a design");
        let of = |set: &[String]| {
            let set = set
                .iter()
                .map(|set| Override::set(set).expect("well formed"));
            let shaw = include_str!("../../../scenarios/shaw.toml");
            let set: Vec<Override> = set.collect();
            Scenario::parse("shaw", shaw, &set).expect("sound")
        };
        let base = [
            "scheme.kind=event-driven".to_string(),
            "time.end=30".to_string(),
        ];
        let point = |i: usize| {
            let own = design.settings(i).into_iter();
            let own = own.map(|setting| format!("{}={}", setting.key, setting.value));
            of(&base.iter().cloned().chain(own).collect::<Vec<_>>())
        };
        let points = (0..design.points()).map(point).collect();
        let question = SweepQuestion::new(of(&base), design, points, Seeds::Common, false);
        let mut sweep = Sweep::new(question);
        let simulation = SweepSimulation {
            threads: 1,
            stop: &AtomicBool::new(false),
            progress: &mut (),
            blocks: None,
        };
        let ended = simulation.run(&mut sweep, |_| Ok::<_, Infallible>(()));
        ended.expect("nobody fails");
        sweep
    }

    /// Of nine values of a second key, and of nine settings of two more keys, there are nine curves
    /// in nine colours and a scale, which a panel by itself has, too. Few curves have a legend.
    #[test]
    fn every_value_of_further_keys_is_drawn() {
        let first = "friction.dynamic=0.9,1.0";
        let second = "friction.static=1.1:1.9:9";
        let third = "oscillator.mass=0.8,1.0,1.2";
        let fourth = "friction.static=1.1:1.5:3";
        for (axes, count, is_scale) in [
            (vec![first, second], 9, true),
            (vec![first, third, fourth], 9, true),
            (vec![first, third], 3, false),
        ] {
            let sweeps = [(String::new(), swept(&axes))];
            let style = Style::default();
            let scale = ColourScale::of(&sweeps, &style);
            assert_eq!(scale.is_some(), is_scale, "{axes:?}");
            let drawn = curves(&sweeps, scale.as_ref(), style.palette());
            let mut points: Vec<usize> = drawn.iter().flat_map(|of| of.points.clone()).collect();
            points.sort_unstable();
            assert_eq!(points, (0..2 * count).collect::<Vec<_>>(), "{axes:?}");
            let colours: std::collections::HashSet<_> =
                drawn.iter().map(|of| of.stroke.colour.0).collect();
            assert_eq!(colours.len(), count, "{axes:?}");
            let subject = Subject::Sweep {
                sweeps: &sweeps,
                statistics: &[Statistic::DisplacementEndMean],
            };
            let sheet = draw(&subject, &style).expect("drawn");
            assert_eq!(sheet.panel_count(), 1);
            assert_eq!(sheet.frames() > HEIGHT, is_scale);
            let alone = sheet.only('A').expect("there is one");
            assert_eq!(alone.frames() > HEIGHT, is_scale);
        }
    }

    #[test]
    fn names_of_files_stand_upright_where_they_are_long() {
        let files = |folder: &str| -> Vec<String> {
            (0..12)
                .map(|i| format!("{folder}/RSN90{i}_NORTHR.AT2"))
                .collect()
        };
        let axis = |files: Vec<String>| SweepAxis {
            name: "record".into(),
            key: "input.ag.file".into(),
            values: AxisValues::Files(files),
        };
        let style = Style::default();
        let ticks = |files| horizontal(&axis(files), &style).ticks(200.0, 26.0);
        let names = |files| ticks(files).into_iter().filter_map(|tick| tick.label);
        let drawn: Vec<String> = names(files("a")).map(|name| name.words()).collect();
        assert_eq!((drawn.len(), drawn[3].as_str()), (12, "RSN903_NORTHR"));
        let long = horizontal(&axis(files("a")), &style);
        assert!(long.upright_length().is_some_and(|length| length > 4.0));
        assert_eq!(
            horizontal(&axis(files("a")[..3].to_vec()), &style).upright_length(),
            None
        );
        // The same name in two folders keeps its folder.
        let both = [files("a"), files("b")].concat();
        assert!(names(both).all(|name| name.words().contains('/')));
    }
}
