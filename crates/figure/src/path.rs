//! One path in the layout of the paper: x, velocity and forces over time, and force against
//! velocity, with every event of the cascade marked.
//!
//! Source: Bensoussan, Brouste, Cartiaux, Mathey and Mertz, the figure of trajectories and the
//! figure after it.

use super::panel::Beside;
use super::subject::DrawnPath;
use super::theme::{DASH_DOT, DASHES, DOTS, LINE, Palette, THIN};
use super::trace::{DrawnPhase, LabelledEvent, PathTrace, StateAt, sampled};
use super::words::{grouped, letter};
use super::{
    Absent, Axis, Colour, Label, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, range_of,
    sheet, solid,
};
use std::ops::Range;
use stickslip::model::Series;
use stickslip::model::{Drive, Problem, Sign};
use stickslip::scenario::Measured;
use stickslip::stats::Dimension;
use stickslip_data::input_unit;

/// With more events than this, the phase plane shows the longest complete slip in full and the rest
/// faintly.
const FEW: usize = 8;
/// With more events than this, velocity and forces do not share an axis.
const MOST_SHARED: usize = 32;
/// With more events than this, no lines lead from the events to the axis.
const MOST_LED: usize = 70;
/// With more events than this, no marks are drawn, because they would merge to a line.
const MOST_MARKED: usize = 150;
/// With more events than this, velocity and forces are not drawn over time, because they would fill
/// their panels.
const MOST_DRAWN: usize = 400;
/// A force whose way is more than this number of times its range would fill the phase plane.
const MOST_SWINGS: f64 = 20.0;
/// The space at both ends of the axis of time, as a share of it.
const MARGIN: f64 = 0.025;
/// Curves whose sizes differ by more than this factor do not share an axis.
const ALIKE: f64 = 8.0;
/// A slip shorter than this share of the axis of time has a panel with a time of its own.
const SHORT: f64 = 0.005;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let path = subject.path()?;
    let layout = PathLayout::of(path, style)?;
    Ok(sheet(
        &format!("Path {}: {}", path.number, path.scenario.title),
        layout.legend(),
        layout.panels(),
    ))
}

/// What is drawn, and what the panels have in common.
struct PathLayout<'a> {
    path: DrawnPath<'a>,
    trace: PathTrace,
    palette: &'static Palette,
    time_unit: String,
    length_unit: String,
    velocity_unit: String,
    force_unit: String,
    /// The friction over time.
    dry: Vec<[f64; 2]>,
    /// Whether there are too many events to draw velocity and forces over time.
    is_crowded: bool,
}

impl<'a> PathLayout<'a> {
    fn of(path: DrawnPath<'a>, style: &Style) -> Result<Self, Absent> {
        let trace = PathTrace::of(&path)?;
        let unit = |dimension: Dimension| dimension.label(&path.scenario.units);
        Ok(PathLayout {
            path,
            palette: style.palette(),
            time_unit: unit(Dimension::TIME),
            length_unit: unit(Dimension::LENGTH),
            velocity_unit: unit(Dimension::VELOCITY),
            force_unit: unit(Dimension::FORCE),
            dry: friction_force(&trace, &path.scenario.model),
            is_crowded: trace.moments.len() > MOST_DRAWN,
            trace,
        })
    }

    fn panels(&self) -> Vec<Panel> {
        let displacement = over_time(&self.trace, self.palette, self.time(), &self.length_unit);
        let mut panels = self.inputs();
        panels.push(if self.is_crowded {
            displacement
        } else {
            displacement.above_another()
        });
        if self.is_shared() {
            panels.push(self.shared());
        } else if self.has_kicks() {
            panels.extend(self.separate().into_iter().take(1).map(Panel::last));
        } else if !self.is_crowded {
            panels.extend(self.separate());
        }
        panels.extend(short_slip(
            &self.trace,
            self.palette,
            SHORT * self.duration(),
            &self.time_unit,
            &self.velocity_unit,
        ));
        if !fills_plane(&self.trace) && !self.has_kicks() {
            panels.push(self.plane());
        }
        panels
    }

    /// Whether forces are impulses, which have no size that could be drawn.
    fn has_kicks(&self) -> bool {
        let measured = &self.path.scenario.written.measured;
        let mut random = measured.iter().filter_map(|of| of.random.as_ref());
        random.any(|random| random.process.is_kicks())
    }

    /// The inputs over time, in a panel each; kicks as their impulses.
    fn inputs(&self) -> Vec<Panel> {
        let scenario = self.path.scenario;
        let panel = |(of, series): (&Measured, &Series)| {
            let random = of.random.as_ref();
            let points = match random.is_some_and(|random| random.process.is_kicks()) {
                true => impulses(series, [self.path.from, scenario.time.end]),
                false => sampled(series, [self.path.from, scenario.time.end]),
            };
            let unit = of.unit.as_deref().and_then(input_unit);
            let unit = unit.map_or(String::new(), |(si, _)| si.replace('2', "\u{b2}"));
            let values = points.iter().map(|point| point[1]);
            let axis = Axis::around(values, letter(of.input().unwrap_or_default()), &unit);
            let mut panel = Panel::new(self.time(), axis, 60.0);
            panel.level(0.0, Stroke::solid(self.palette.faint, 0.4));
            panel.line(points, Stroke::solid(self.palette.fourth, THIN));
            panel.above_another()
        };
        scenario.inputs_of_path().map(panel).collect()
    }

    fn duration(&self) -> f64 {
        self.path.scenario.time.end - self.path.from
    }

    /// The axis of time.
    fn time(&self) -> Axis {
        let (from, end) = (self.path.from, self.path.scenario.time.end);
        let margin = MARGIN * self.duration();
        Axis::linear([from - margin, end + margin], "time *t*", &self.time_unit)
    }

    /// Whether velocity and forces share an axis.
    fn is_shared(&self) -> bool {
        let size = |values: &dyn Fn(&StateAt) -> f64| {
            let sizes = self.trace.samples().map(|s| values(s).abs());
            sizes.fold(0.0, f64::max)
        };
        if self.has_kicks() {
            return false;
        }
        let ratio = size(&|s| s.velocity) / size(&|s| s.spring).max(f64::MIN_POSITIVE);
        let is_dimensionless = self.velocity_unit.is_empty() && self.force_unit.is_empty();
        is_dimensionless
            && self.trace.moments.len() <= MOST_SHARED
            && (1.0 / ALIKE..ALIKE).contains(&ratio)
    }

    /// Velocity and forces over time in one panel.
    fn shared(&self) -> Panel {
        let seen = self
            .trace
            .samples()
            .flat_map(|s| [s.velocity, s.spring])
            .chain(self.dry.iter().map(|p| p[1]));
        let axis = Axis::around(seen, "velocity *x*′(*t*), force", "");
        let mut panel = Panel::new(self.time(), axis, 104.0);
        self.forces(&mut panel);
        velocities(&self.trace, self.palette, &mut panel);
        panel
    }

    /// Velocity and forces over time, in a panel each.
    fn separate(&self) -> [Panel; 2] {
        let seen = self.trace.samples().map(|s| s.velocity);
        let axis = Axis::around(seen, "velocity *x*′(*t*)", &self.velocity_unit);
        let mut velocity = Panel::new(self.time(), axis, 76.0);
        velocities(&self.trace, self.palette, &mut velocity);
        let seen = self
            .trace
            .samples()
            .map(|s| s.spring)
            .chain(self.dry.iter().map(|p| p[1]));
        let axis = Axis::around(seen, "force", &self.force_unit);
        let mut force = Panel::new(self.time(), axis, 76.0);
        self.forces(&mut force);
        [velocity.above_another(), force]
    }

    fn spring_stroke(&self) -> Stroke {
        Stroke::solid(self.palette.faint, THIN)
    }

    fn friction_stroke(&self) -> Stroke {
        Stroke::dashed(self.palette.fourth, 0.9, &DASHES)
    }

    fn forces(&self, panel: &mut Panel) {
        panel.line(self.dry.clone(), self.friction_stroke());
        panel.line(
            self.trace.samples().map(|s| [s.time, s.spring]).collect(),
            self.spring_stroke(),
        );
    }

    fn plane(&self) -> Panel {
        let model = &self.path.scenario.model;
        // With a load there is no level of its own.
        let friction = if model.has_load() {
            0.0
        } else {
            model.friction.static_force
        };
        let plane = phase_plane(
            &self.trace,
            self.palette,
            friction,
            &self.velocity_unit,
            (format!("force {}", self.force_name()), &self.force_unit),
        );
        match in_full(&self.trace).len() < self.trace.pieces.len() {
            true => plane.keyed([LegendEntry::words(
                "longest completed slip bold, others thin",
            )]),
            false => plane,
        }
    }

    fn force_name(&self) -> &'static str {
        let model = &self.path.scenario.model;
        match (&model.force, model.oscillator.drive) {
            (Some(_), _) => "*b*",
            (None, Drive::Dilatation(_)) => "*K*(*βT* − *x*)",
            (None, Drive::Force(_)) if model.oscillator.stiffness == 0.0 => "*cT*",
            (None, Drive::Force(_)) => "*cT* − *Kx*",
        }
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let (trace, palette) = (&self.trace, self.palette);
        let mut sticks = trace.sticks();
        let stick = sticks
            .any(|[begin, end]| begin < end)
            .then(|| LegendEntry::line(Stroke::dashed(palette.ink, LINE, &DASH_DOT), "stick"));
        let mut legend: Vec<LegendEntry> = stick.into_iter().collect();
        let names = (1..)
            .zip(["slip", "2nd sub-phase", "3rd and later"])
            .take(trace.most_sub_phases());
        legend.extend(
            names.map(|(k, name)| LegendEntry::line(solid(of_sub_phase(k, palette)), name)),
        );
        if !self.is_crowded && !self.has_kicks() {
            legend.push(LegendEntry::line(self.spring_stroke(), self.force_name()));
            legend.push(LegendEntry::line(self.friction_stroke(), "friction *F*"));
        }
        if trace.moments.len() > MOST_MARKED {
            let done = if self.is_crowded {
                "for velocity and forces"
            } else {
                "to be marked"
            };
            let words = format!(
                "{} events, too close {done}",
                grouped(trace.moments.len() as u64)
            );
            legend.push(LegendEntry::words(words));
        }
        legend
    }
}

/// A line from impulse to impulse, along zero and up to each.
fn impulses(series: &Series, [from, end]: [f64; 2]) -> Vec<[f64; 2]> {
    let (times, values) = (series.times(), series.values());
    let mut points = vec![[from, 0.0]];
    let (mut begin, mut sum) = (from, 0.0);
    for i in 1..times.len() {
        let area = 0.5 * (values[i - 1] + values[i]) * (times[i] - times[i - 1]);
        if sum == 0.0 {
            begin = times[i - 1];
        }
        sum += area;
        if values[i] == 0.0 && sum != 0.0 {
            if (from..end).contains(&begin) {
                points.extend([[begin, 0.0], [begin, sum], [begin, 0.0]]);
            }
            sum = 0.0;
        }
    }
    points.push([end, 0.0]);
    points
}

/// The colour of sub-phase k of a slip.
fn of_sub_phase(k: usize, palette: &Palette) -> Colour {
    match k {
        1 => palette.first,
        2 => palette.second,
        _ => palette.third,
    }
}

fn stroke(piece: &DrawnPhase, palette: &Palette) -> Stroke {
    match piece.slip {
        None => Stroke::dashed(palette.ink, LINE, &DASH_DOT),
        Some((k, _)) => solid(of_sub_phase(k, palette)),
    }
}

/// The first panel: x over time. A line leads from each event to the axis, where the event is named.
fn over_time(trace: &PathTrace, palette: &Palette, time: Axis, unit: &str) -> Panel {
    let [low, high] = range_of(trace.samples().map(|s| s.displacement));
    // Where x is far from zero, the events are marked at the lower edge instead of at zero.
    let base = if low - 1.5 * (high - low) > 0.0 || high + 1.5 * (high - low) < 0.0 {
        low - 0.3 * (high - low)
    } else {
        0.0
    };
    let room = 0.1 * (high - low);
    let axis = Axis::around(
        [low - room, high + room, base],
        "displacement *x*(*t*)",
        unit,
    );
    let mut panel = Panel::new(time, axis, 108.0);
    panel.level(base, Stroke::solid(palette.faint, 0.4));
    if trace.moments.len() <= MOST_LED {
        for moment in &trace.moments {
            let t = moment.at.time;
            panel.line(
                vec![[t, base], [t, moment.at.displacement]],
                Stroke::dashed(palette.faint, THIN, &DOTS),
            );
        }
    }
    draw_pieces(
        &trace.pieces,
        |s| [s.time, s.displacement],
        palette,
        &mut panel,
    );
    mark_events(trace, |_| base, palette, &mut panel);
    if trace.moments.len() > MOST_MARKED {
        return panel;
    }
    // The events with most space around them are named first, so that as many as possible have a
    // name.
    let mut moments: Vec<(f64, &LabelledEvent)> = trace
        .moments
        .iter()
        .map(|moment| (trace.distance(moment), moment))
        .collect();
    moments.sort_by(|one, other| other.0.total_cmp(&one.0));
    for (_, moment) in moments {
        let places: &[Beside] = if moment.at.displacement >= base {
            &UNDER
        } else {
            &OVER
        };
        panel.note([moment.at.time, base], &moment.name, places);
    }
    panel
}

const UNDER: [Beside; 6] = [[0, 1], [1, 1], [-1, 1], [0, -1], [1, -1], [-1, -1]];
const OVER: [Beside; 6] = [[0, -1], [1, -1], [-1, -1], [0, 1], [1, 1], [-1, 1]];
const SIDES: [Beside; 6] = [[1, 0], [-1, 0], [1, -1], [1, 1], [-1, -1], [-1, 1]];

impl LabelledEvent {
    fn mark(&self) -> Mark {
        if self.is_turn {
            Mark::Circle
        } else {
            Mark::Disc
        }
    }
}

/// The velocity, with a mark at each event.
fn velocities(trace: &PathTrace, palette: &Palette, panel: &mut Panel) {
    panel.level(0.0, Stroke::solid(palette.faint, 0.4));
    draw_pieces(&trace.pieces, |s| [s.time, s.velocity], palette, panel);
    mark_events(trace, |at| at.velocity, palette, panel);
}

/// The pieces that the phase plane shows in full. With few events these are all pieces, else the
/// longest complete slip with the sticks before and after it.
fn in_full(trace: &PathTrace) -> Range<usize> {
    trace
        .longest_slip()
        .filter(|_| trace.moments.len() > FEW)
        .unwrap_or(0..trace.pieces.len())
}

/// Whether the force swings from end to end so often, as under white noise, that its curve would fill
/// the phase plane.
fn fills_plane(trace: &PathTrace) -> bool {
    let full = trace.pieces[in_full(trace)].iter();
    let forces: Vec<f64> = full
        .flat_map(|piece| &piece.samples)
        .map(|s| s.spring)
        .collect();
    let [low, high] = range_of(forces.iter().copied());
    let way: f64 = forces
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .sum();
    way > MOST_SWINGS * (high - low)
}

/// The velocity in the longest slip over the time since it began, if slips are so short.
fn short_slip(
    trace: &PathTrace,
    palette: &Palette,
    short: f64,
    time_unit: &str,
    velocity_unit: &str,
) -> Option<Panel> {
    let slip = trace.longest_slip()?;
    let slip = &trace.pieces[slip.start + 1..slip.end - 1];
    let [begin, end] = [slip.first()?.begin(), slip.last()?.end()];
    if !(0.0 < end - begin && end - begin < short) {
        return None;
    }
    let began = trace
        .moments
        .iter()
        .find(|moment| moment.at.time == begin)?;
    let title = Label::from("time in the longest slip, *t* − ").and(&began.name);
    let time = Axis::around([0.0, end - begin], title, time_unit);
    let seen = slip
        .iter()
        .flat_map(|piece| &piece.samples)
        .map(|s| s.velocity);
    let mut panel = Panel::new(
        time,
        Axis::around(seen, "velocity *x*′", velocity_unit),
        60.0,
    );
    panel.level(0.0, Stroke::solid(palette.faint, 0.4));
    draw_pieces(slip, |s| [s.time - begin, s.velocity], palette, &mut panel);
    Some(panel)
}

/// Draws pieces as curves through a point for each sample, in the order of time.
fn draw_pieces(
    pieces: &[DrawnPhase],
    point: impl Fn(&StateAt) -> [f64; 2],
    palette: &Palette,
    panel: &mut Panel,
) {
    for piece in pieces {
        panel.line(
            piece.samples.iter().map(&point).collect(),
            stroke(piece, palette),
        );
    }
}

/// Marks the events at this height, unless there are too many of them.
fn mark_events(
    trace: &PathTrace,
    height: impl Fn(&StateAt) -> f64,
    palette: &Palette,
    panel: &mut Panel,
) {
    for moment in trace
        .moments
        .iter()
        .filter(|_| trace.moments.len() <= MOST_MARKED)
    {
        panel.mark(
            [moment.at.time, height(&moment.at)],
            moment.mark(),
            palette.ink,
        );
    }
}

/// The friction F over time: in a stick it balances the force b, in a slip it is f_d in the
/// direction of motion.
fn friction_force(trace: &PathTrace, model: &Problem) -> Vec<[f64; 2]> {
    let dry = |sign: f64, s: &StateAt| {
        model.sliding_friction(Sign::of(sign), s.time, s.displacement, s.velocity)
    };
    let force = |piece: &DrawnPhase, s: &StateAt| {
        [
            s.time,
            piece.slip.map_or(s.spring, |(_, sign)| dry(sign, s)),
        ]
    };
    trace
        .pieces
        .iter()
        .flat_map(|piece| piece.samples.iter().map(move |s| force(piece, s)))
        .collect()
}

/// The last panel: the force of the spring against the velocity. With many events, only the longest
/// complete slip is shown in full and the rest faintly.
fn phase_plane(
    trace: &PathTrace,
    palette: &Palette,
    friction: f64,
    velocity_unit: &str,
    (force, force_unit): (String, &str),
) -> Panel {
    // Sticks, which have the velocity zero, must not be on the edge.
    let [low, high] = range_of(trace.samples().map(|s| s.velocity));
    let room = 0.04 * (high - low);
    let x = Axis::around(
        [low - room, high + room],
        "velocity *x*′(*t*)",
        velocity_unit,
    );
    // A threshold of which the force stays far is left out.
    let [least, most] = range_of(trace.samples().map(|s| s.spring));
    let levels = [(friction, most, "*f*_{s}"), (-friction, -least, "−*f*_{s}")];
    let levels = levels
        .into_iter()
        .filter(|(_, reached, _)| friction > 0.0 && *reached > 0.5 * friction);
    let levels: Vec<(f64, &str)> = levels.map(|(level, _, name)| (level, name)).collect();
    let y = Axis::around(
        levels.iter().map(|(level, _)| *level).chain([least, most]),
        force,
        force_unit,
    );
    let mut panel = Panel::new(x, y, 124.0);
    for (level, _) in &levels {
        panel.level(*level, Stroke::dashed(palette.faint, 0.5, &DASHES));
    }
    let full = in_full(trace);
    let points = |piece: &DrawnPhase| {
        piece
            .samples
            .iter()
            .map(|s| [s.velocity, s.spring])
            .collect()
    };
    let others = trace
        .pieces
        .iter()
        .enumerate()
        .filter(|(i, _)| !full.contains(i));
    for (_, piece) in others {
        panel.line(
            points(piece),
            Stroke::solid(palette.grid.mixed(palette.faint, 0.35), 0.4),
        );
    }
    for piece in &trace.pieces[full.clone()] {
        panel.line(points(piece), stroke(piece, palette));
    }
    let times = trace.pieces[full.start].begin()..=trace.pieces[full.end - 1].end();
    let moments = || {
        trace
            .moments
            .iter()
            .filter(|moment| times.contains(&moment.at.time))
    };
    for moment in moments() {
        panel.mark(
            [moment.at.velocity, moment.at.spring],
            moment.mark(),
            palette.ink,
        );
    }
    for (level, name) in levels {
        panel.note([f64::INFINITY, level], name, &[[-1, -1], [-1, 1]]);
    }
    for moment in moments() {
        panel.note([moment.at.velocity, moment.at.spring], &moment.name, &SIDES);
    }
    panel
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::scenario::Scenario;
    use stickslip::scheme::Kind;

    fn trace(name: &str, number: u64) -> (Scenario, PathTrace) {
        let scenario = Scenario::shipped(name).expect("shipped");
        let trace = PathTrace::of(&DrawnPath {
            scenario: &scenario,
            number,
            from: 0.0,
        })
        .expect("not lost");
        (scenario, trace)
    }

    /// The events in the figure of the paper are at 0, 2.58, 13.38, 14.86 and 25.74. The last of
    /// them is one step before the velocity is zero.
    #[test]
    fn the_events_of_shaw_are_those_of_the_paper() {
        let (_, trace) = trace("shaw", 0);
        let marks: Vec<(String, String)> = trace
            .moments
            .iter()
            .take(5)
            .map(|m| (m.name.clone(), format!("{:.2}", m.at.time)))
            .collect();
        let expected = [
            ("*τ*_{0}", "0.00"),
            ("*τ*_{½}", "2.58"),
            ("*τ*_{1}", "13.38"),
            ("*τ*_{1+½}", "14.86"),
            ("*τ*_{2}", "25.75"),
        ];
        assert_eq!(
            marks,
            expected.map(|(name, time)| (name.to_string(), time.to_string()))
        );
        // The forces at these events in the phase plane.
        let forces: Vec<f64> = trace.moments[2..5].iter().map(|m| m.at.spring).collect();
        assert!(
            (forces[0] - 0.365_928).abs() < 1e-5 && (forces[1] - 1.2).abs() < 0.01,
            "{forces:?}"
        );
        assert!((trace.moments[2].at.displacement + 6.242_23).abs() < 5e-6);
        assert!((trace.moments[4].at.displacement - 6.222_28).abs() < 5e-4);
    }

    /// The pieces follow each other without a gap, x does not change in a stick, and the velocity
    /// has the direction of its sub-phase.
    #[test]
    fn a_path_is_cut_at_its_events_and_nowhere_else() {
        for (name, path) in [("shaw", 0), ("rho025", 41)] {
            let (scenario, trace) = trace(name, path);
            for pair in trace.pieces.windows(2) {
                assert_eq!(pair[0].samples.last(), pair[1].samples.first());
            }
            let last = trace
                .pieces
                .last()
                .and_then(|piece| piece.samples.last())
                .expect("it has an end");
            assert!((last.time - scenario.time.end).abs() < 1e-9);
            for piece in &trace.pieces {
                assert!(
                    piece
                        .samples
                        .windows(2)
                        .all(|pair| pair[0].time <= pair[1].time)
                );
                for s in &piece.samples {
                    match piece.slip {
                        None => assert!(
                            s.velocity == 0.0 && s.displacement == piece.samples[0].displacement
                        ),
                        Some((_, sign)) => assert!(s.velocity * sign >= 0.0, "{name} {}", s.time),
                    }
                }
            }
        }
    }

    /// A body with initial velocity v0 = 3 moves from its first sample on: nothing leads from 0 to v0
    /// at t = 0, where its first event is.
    #[test]
    fn a_body_with_initial_velocity_begins_with_it() {
        let mut shaw = Scenario::shipped("shaw").expect("shipped");
        shaw.model.initial_velocity = 3.0;
        for scheme in [
            Kind::DiscreteVi.with(0.01),
            Kind::CorrectedVi.with(0.01),
            Kind::EventDriven.with(1e-3),
        ] {
            let scenario = shaw.with_scheme(scheme).expect("suits");
            let trace = PathTrace::of(&DrawnPath {
                scenario: &scenario,
                number: 0,
                from: 0.0,
            })
            .expect("not lost");
            let begin: Vec<f64> = trace
                .samples()
                .filter(|s| s.time == 0.0)
                .map(|s| s.velocity)
                .collect();
            assert!(
                !begin.is_empty() && begin.iter().all(|v| *v == 3.0),
                "{scheme}: {begin:?}"
            );
            let first = trace.moments[0].at;
            assert_eq!(
                (first.time, first.velocity, first.spring),
                (0.0, 3.0, 0.0),
                "K (beta T - x) = 6 - 6"
            );
        }
    }

    #[test]
    fn a_path_is_drawn_from_the_time_that_was_given() {
        let (scenario, whole) = trace("shaw", 0);
        let path = DrawnPath {
            scenario: &scenario,
            number: 0,
            from: 20.0,
        };
        let late = PathTrace::of(&path).expect("not lost");
        let wanted = whole.samples().filter(|s| s.time >= 20.0);
        assert!(late.samples().eq(wanted) && late.moments.len() < whole.moments.len());
    }

    /// The figure of a noisy path in the paper has an event between two sub-phases. Here such an
    /// event has a name, too.
    #[test]
    fn a_slip_of_several_sub_phases_has_its_turns_named() {
        let (_, trace) = trace("rho025", 41);
        assert!(trace.most_sub_phases() >= 2);
        let turn = trace
            .moments
            .iter()
            .find(|m| m.is_turn)
            .expect("there is one");
        assert!(turn.name.contains("}^{1}"), "{}", turn.name);
    }

    /// In a slip the friction is f_d in the direction of motion; in a stick it is the force that
    /// holds the body.
    #[test]
    fn friction_holds_in_sticks_and_drags_in_slips() {
        let (scenario, trace) = trace("shaw", 0);
        let force = friction_force(&trace, &scenario.model);
        let samples = trace
            .pieces
            .iter()
            .flat_map(|p| p.samples.iter().map(|s| (p.slip, s.spring)));
        for ((slip, spring), [_, f]) in samples.zip(force) {
            assert!(match slip {
                None => f == spring && f.abs() < 1.2 + 0.01,
                Some((_, sign)) => f == sign,
            });
        }
    }

    /// The curve of the spring is K (beta T - x), without the damping, at every sample: at rows of the
    /// output grid and between them.
    #[test]
    fn the_spring_force_is_that_of_the_spring_alone() {
        let mut damped = Scenario::shipped("shaw").expect("shipped");
        damped.model.oscillator.damping = 0.3;
        // So few rows that the sub-phases are drawn by the motion between them.
        damped.time.output_step = 30.0;
        for (scheme, within) in [
            (Kind::DiscreteVi.with(1e-3), 0.03),
            (Kind::EventDriven.with(1e-3), 1e-3),
        ] {
            let scenario = damped.with_scheme(scheme).expect("suits");
            let trace = PathTrace::of(&DrawnPath {
                scenario: &scenario,
                number: 0,
                from: 0.0,
            })
            .expect("not lost");
            let model = &scenario.model;
            let off = |s: &StateAt| {
                let stretch = model.temperature.deterministic(s.time);
                let spring = model.oscillator.stiffness * (6.0 * stretch - s.displacement);
                (s.spring - spring).abs()
            };
            assert!(trace.samples().any(|s| s.velocity.abs() > 1.0));
            let most = trace.samples().map(off).fold(0.0, f64::max);
            assert!(most < within, "{scheme}: {most}");
        }
    }

    /// The rounding of friction and damping is not drawn as a force of a spring that is not there.
    #[test]
    fn a_body_without_a_spring_is_drawn_without_its_force() {
        let mut thrown = Scenario::shipped("shaw").expect("shipped");
        thrown.model.oscillator.stiffness = 0.0;
        thrown.model.oscillator.damping = 0.05;
        thrown.model.initial_velocity = 3.0;
        let trace = PathTrace::of(&DrawnPath {
            scenario: &thrown
                .with_scheme(Kind::EventDriven.with(1e-3))
                .expect("suits"),
            number: 0,
            from: 0.0,
        })
        .expect("not lost");
        assert!(trace.samples().any(|s| s.velocity > 1.0));
        assert!(trace.samples().all(|s| s.spring == 0.0));
    }
}
