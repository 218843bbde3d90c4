//! The cascade without diffusion: closed forms between events, events as first roots, and no time
//! step at all.
//!
//! - Slip: [`ForcedOscillator::slip`] gives x, x', b at any time; the sub-phase ends at the first
//!   zero of eps x'.
//! - Stick: b(t) is a sum of exponentials; the phase ends at the first zero of f_s - b or f_s + b.
//!
//! A trend is a straight line. A measured temperature is one between samples, with a kink at each
//! sample. So a phase is divided at the samples, and continues on the next line from the same
//! displacement, velocity and force.
//!
//! Both kinds of zeros are bracketed by bounds of the second derivative ([`first_root`]), so none
//! is missed, and are found to rounding. Nothing is random, so one path is computed and reported
//! for every lane.

use super::super::work::{Resolved, Unresolved, WITHOUT_NOISE, WorkLeft, work_limit};
use super::dense_output::{FollowedSlip, Kinematics, Knots};
use super::exact_time::ExactTime;
use super::first_root::{Jet, first_root, safe_step};
use super::path_segment::{End, PathSegment, PathSegments};
use crate::model::{
    Complex, Event, EventKind, ForcedOscillator, InitialNoise, Phase, Problem, Series, Sign,
    SlipFlow, can_be_computed_with,
};
use crate::scheme::columns::Seen;
use crate::scheme::{Segment, Timeline};

/// The noiseless scheme for one scene.
#[derive(Clone, Debug)]
pub struct Noiseless {
    pub model: Problem,
    pub timeline: Timeline,
    body: ForcedOscillator,
    /// 1/max(w0, |z_j|): the time over which one bound of the second derivative is used.
    span: f64,
    knots: Knots,
    /// Whether the temperature jumps at samples.
    has_jumps: bool,
    /// The number of evaluations that the path may make.
    pub work_limit: u64,
}

/// The signs of b at the two thresholds.
const SIDES: [f64; 2] = [1.0, -1.0];

/// One phase of the path, or the part of a phase that lies between two samples, at which the
/// temperature has a kink.
type ClosedSegment = PathSegment<SegmentStart, ()>;

/// The motion at the start of a segment.
pub struct SegmentStart {
    displacement: f64,
    /// x' at the start. It is zero except after a sample inside a slip.
    velocity: f64,
    /// b at the start.
    force: f64,
    /// P_j at the start.
    terms: Vec<Complex>,
    /// The slope of K beta T/m between the samples.
    line: f64,
}

impl Noiseless {
    /// The scheme for a scene without noise, with sigma = 0 (then v relaxes from its initial value)
    /// or with noise that is too weak to change the motion (then the mean of v relaxes).
    pub fn new(model: &Problem, timeline: &Timeline) -> Self {
        let noise_start = match model.temperature.effective_noise().map(|n| n.initial) {
            Some(InitialNoise::At(v)) => v,
            // The mean of the stationary law.
            Some(InitialNoise::Stationary) | None => 0.0,
        };
        let body = ForcedOscillator::new(model, noise_start);
        let rates = body.terms.iter().map(|t| t.rate.abs());
        let steady_rate = rates.fold(0.0, f64::max);
        let fastest = steady_rate.max(model.oscillator.natural_frequency());
        // A body without a spring under a constant force has no time scale except that of the run.
        let span = match (fastest > 0.0, timeline.end > 0.0) {
            (true, _) => 1.0 / fastest,
            (false, true) => timeline.end,
            (false, false) => 1.0,
        }
        .min(body.bounded_for());
        let steady_rate = steady_rate.max(1.0 / body.bounded_for());
        Noiseless {
            model: model.clone(),
            timeline: *timeline,
            body,
            span,
            knots: Knots::new(&model.oscillator, steady_rate),
            has_jumps: (model.temperature.series.as_ref()).is_some_and(|series| series.has_jumps()),
            work_limit: work_limit(WITHOUT_NOISE),
        }
    }

    /// The motion of a sub-phase.
    fn flow<'a>(&'a self, segment: &'a ClosedSegment, direction: Sign) -> SlipFlow<'a> {
        let dynamic_force = self.model.friction.dynamic_force;
        let SegmentStart {
            velocity,
            force,
            ref terms,
            line,
            ..
        } = segment.from;
        self.body
            .slip((terms, line), velocity, force, direction, dynamic_force)
    }

    fn series(&self) -> Option<&Series> {
        self.model.temperature.series.as_deref()
    }

    /// The line from a time on, that of the trend and that between two samples: the slope of K beta
    /// T/m, the duration until the next sample or t_end, and whether a sample ends it.
    fn line(&self, start: ExactTime) -> (f64, f64, bool) {
        let left = start.until(self.timeline.end);
        let gain = self.model.oscillator.force_per_temperature() / self.model.oscillator.mass;
        let trend = self.model.temperature.trend;
        let Some(series) = self.series() else {
            return (gain * trend, left, false);
        };
        let mut piece = series.piece(start.value());
        // `start` has more digits than the double that found the piece, so it may lie in a later
        // one.
        while piece + 2 < series.times().len() && start.until(series.times()[piece + 1]) <= 0.0 {
            piece += 1;
        }
        let until = if piece + 2 < series.times().len() {
            start.until(series.times()[piece + 1])
        } else {
            left
        };
        (
            gain * (series.slope(piece) + trend),
            until.min(left),
            until < left,
        )
    }

    fn terms_at(&self, t: ExactTime) -> Vec<Complex> {
        self.body.terms.iter().map(|term| t.phased(term)).collect()
    }

    /// The exit from a static phase that begins at a time and a displacement; none if it does not
    /// end before t_end.
    pub fn stick_exit(
        &self,
        start: ExactTime,
        displacement: f64,
        work: &mut WorkLeft,
    ) -> Resolved<Option<Event>> {
        let terms = self.terms_at(start);
        let force = self.force_at_rest(start, &terms, displacement);
        let mut segment = self.stick(start, displacement, force, terms, work)?;
        loop {
            match segment.end {
                None => return Ok(None),
                Some((_, End::Event(event))) => return Ok(Some(event)),
                Some(cut) => segment = self.next(&segment, cut, work)?,
            }
        }
    }

    /// b for x' = 0.
    fn force_at_rest(&self, time: ExactTime, terms: &[Complex], displacement: f64) -> f64 {
        let body = &self.model.oscillator;
        let measured = self.model.temperature.measured(time.value());
        body.mass * terms.iter().map(|p| p.re).sum::<f64>()
            + body.force_at_rest(measured, displacement)
    }

    /// A static phase and its exit, the first time at which |b| > f_s.
    fn stick(
        &self,
        start: ExactTime,
        displacement: f64,
        force: f64,
        terms: Vec<Complex>,
        work: &mut WorkLeft,
    ) -> Resolved<ClosedSegment> {
        let (f_s, m) = (self.model.friction.static_force, self.model.oscillator.mass);
        let (line, horizon, is_cut) = self.line(start);
        let never = self.never_exits(displacement, f_s);
        let exit = if force.abs() > f_s {
            Some((0.0, force))
        } else if never {
            None
        } else {
            let bend = m * self.body.forcing_curvature;
            let distances = |r: f64| {
                let [increment, slope, _] = self
                    .body
                    .forcing_increment((&terms, line), r)
                    .map(|derivative| derivative * m);
                SIDES.map(|side| Jet {
                    value: (f_s - side * force) - side * increment,
                    slope: -side * slope,
                    bend,
                    bend_growth: 0.0,
                    holds_for: f64::INFINITY,
                })
            };
            let root = first_root(
                distances,
                self.inside(distances(0.0)),
                horizon,
                self.span,
                work,
            )?;
            root.map(|(r, side)| (r, SIDES[side] * f_s))
        };
        let end = exit.filter(|&(r, _)| r <= horizon).map(|(r, force)| {
            let kind = EventKind::SlipStarted(Sign::of(force));
            (
                r,
                End::Event(Event {
                    kind,
                    time: start.after(r).value(),
                    displacement,
                    force,
                }),
            )
        });
        let cut = (is_cut && !never).then_some((horizon, End::Cut(())));
        let from = SegmentStart {
            displacement,
            velocity: 0.0,
            force,
            terms,
            line,
        };
        Ok(ClosedSegment {
            start,
            phase: Phase::Static,
            from,
            end: end.or(cut),
        })
    }

    /// Whether |K (beta T - x)| <= f_s for all phases of the forcing.
    fn never_exits(&self, displacement: f64, f_s: f64) -> bool {
        let Problem {
            oscillator,
            temperature,
            ..
        } = &self.model;
        let line = temperature.offset.abs() + temperature.trend.abs() * self.timeline.end;
        let measured = line + self.series().map_or(0.0, |series| series.bound());
        oscillator.mass * self.body.forcing_size()
            + oscillator.force_bound(measured, displacement.abs())
            <= f_s
    }

    /// A time until which b stays in the band, for a stick that may begin exactly on a
    /// threshold. It is zero unless b moves inwards from there. Where the slope is zero too,
    /// rounding hides which way b moves, so the search starts a little later.
    fn inside(&self, distances: [Jet; 2]) -> f64 {
        let stays = |g: &Jet| match g.slope {
            _ if g.value > 0.0 => safe_step(g.value, g.slope, g.bend),
            slope if slope < 0.0 => 0.0,
            slope if slope > 0.0 => safe_step(0.0, slope, g.bend),
            // b stays on the threshold, which holds the body.
            _ if g.bend == 0.0 => f64::INFINITY,
            _ => self.indeterminate_start(),
        };
        if distances.iter().all(|g| g.value > 0.0) {
            0.0
        } else {
            stays(&distances[0]).min(stays(&distances[1]))
        }
    }

    /// A sub-phase and its end, the first time after its start at which eps x' = 0.
    fn slip(
        &self,
        start: ExactTime,
        displacement: f64,
        (velocity, force): (f64, f64),
        terms: Vec<Complex>,
        direction: Sign,
        work: &mut WorkLeft,
    ) -> Resolved<ClosedSegment> {
        let (line, horizon, is_cut) = self.line(start);
        let (friction, mass) = (self.model.friction, self.model.oscillator.mass);
        let eps = direction.value();
        let flow = self.body.slip(
            (&terms, line),
            velocity,
            force,
            direction,
            friction.dynamic_force,
        );
        let jet = |r: f64| {
            let state = flow.at(r);
            let (bend, bend_growth) = flow.jerk_bound(&state);
            let (value, slope) = (eps * state.velocity, eps * state.acceleration);
            [Jet {
                value,
                slope,
                bend,
                bend_growth,
                holds_for: self.body.bounded_for(),
            }]
        };
        let earliest = if velocity == 0.0 {
            self.departure(&flow, eps)
        } else {
            0.0
        };
        let root = first_root(jet, earliest, horizon, self.span, work)?;
        let runs_away = root.is_none() && {
            let state = flow.at(horizon);
            !can_be_computed_with(&[
                (displacement + state.displacement).abs(),
                state.velocity.abs(),
            ])
        };
        if runs_away {
            return Err(Unresolved::NoNumber);
        }
        let end = root.filter(|&(r, _)| r <= horizon).map(|(r, _)| {
            let state = flow.at(r);
            let displacement = displacement + state.displacement;
            let force = eps * friction.dynamic_force + mass * state.acceleration;
            let kind = EventKind::at_rest(force.abs() <= friction.static_force, force);
            (
                r,
                End::Event(Event {
                    kind,
                    time: start.after(r).value(),
                    displacement,
                    force,
                }),
            )
        });
        let end = end.or(is_cut.then_some((horizon, End::Cut(()))));
        let from = SegmentStart {
            displacement,
            velocity,
            force,
            terms,
            line,
        };
        Ok(ClosedSegment {
            start,
            phase: Phase::Slip(direction),
            from,
            end,
        })
    }

    /// A time before which eps x' cannot return to zero.
    ///
    /// Let g = eps x', so g(0) = 0 and g'(0) = a >= 0. With |g''| <= M over the span, g > 0 below
    /// 2a/M. Where f_s = f_d, a = 0 and g rises by the jerk j = g''(0) > 0. With |g'''| <= N, g > 0
    /// below 3 j / N.
    fn departure(&self, flow: &SlipFlow<'_>, eps: f64) -> f64 {
        let state = flow.at(0.0);
        let (bend, growth) = flow.jerk_bound(&state);
        let bend = bend + growth * self.span;
        let by_acceleration = safe_step(0.0, eps * flow.start_acceleration, bend);
        let by_jerk = 3.0 * eps * state.jerk / flow.snap_bound(bend);
        by_acceleration
            .max(by_jerk)
            .min(self.span)
            .max(self.indeterminate_start())
    }

    /// The shortest time that is resolved after the start of a phase at which value and slope of
    /// the function that is searched vanish. A function of size 1 whose value and slope vanish
    /// stays below its own rounding error for longer than this: a cubic reaches eps at eps^{1/3} =
    /// 6e-6 of its time scale. A hundredth of that time is used.
    fn indeterminate_start(&self) -> f64 {
        1e-2 * f64::EPSILON.cbrt() * self.span
    }
}

impl PathSegments for Noiseless {
    type Motion = SegmentStart;
    type Cut = ();

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    fn work_limit(&self) -> u64 {
        self.work_limit
    }

    fn first(&self, work: &mut WorkLeft) -> Resolved<ClosedSegment> {
        let terms = self.terms_at(ExactTime::ZERO);
        let displacement = self.model.initial_displacement;
        let force = self.force_at_rest(ExactTime::ZERO, &terms, displacement);
        let velocity = self.model.initial_velocity;
        if velocity == 0.0 {
            return self.stick(ExactTime::ZERO, displacement, force, terms, work);
        }
        // A body that moves at t = 0: its first stick is empty.
        let force = force - 2.0 * self.model.oscillator.damping * velocity;
        let kind = EventKind::SlipStarted(Sign::of(velocity));
        let end = Some((
            0.0,
            End::Event(Event {
                kind,
                time: 0.0,
                displacement,
                force,
            }),
        ));
        let (start, phase, line) = (ExactTime::ZERO, Phase::Static, 0.0);
        Ok(ClosedSegment {
            start,
            phase,
            from: SegmentStart {
                displacement,
                velocity: 0.0,
                force,
                terms,
                line,
            },
            end,
        })
    }

    fn next(
        &self,
        segment: &ClosedSegment,
        (duration, end): (f64, End<()>),
        work: &mut WorkLeft,
    ) -> Resolved<ClosedSegment> {
        work.spend()?;
        let start = segment.start.after(duration);
        let terms = self.terms_at(start);
        match (end, segment.phase) {
            (End::Event(event), _) => match event.kind.phase() {
                Phase::Static => self.stick(start, event.displacement, event.force, terms, work),
                Phase::Slip(sign) => {
                    let velocity = if event.time == 0.0 {
                        self.model.initial_velocity
                    } else {
                        0.0
                    };
                    let x = event.displacement;
                    // A jump may be over by the time that the double of an event can name.
                    let after = match self.has_jumps && velocity == 0.0 {
                        true => self.force_at_rest(start, &terms, x),
                        false => event.force,
                    };
                    let is_beyond = after * event.force > event.force * event.force;
                    let force = if is_beyond { after } else { event.force };
                    self.slip(start, x, (velocity, force), terms, sign, work)
                }
            },
            (End::Cut(()), Phase::Static) => {
                let force = self.force_at_rest(start, &terms, segment.from.displacement);
                self.stick(start, segment.from.displacement, force, terms, work)
            }
            (End::Cut(()), Phase::Slip(direction)) => {
                let state = self.flow(segment, direction).at(duration);
                let friction = direction.value() * self.model.friction.dynamic_force;
                let displacement = segment.from.displacement + state.displacement;
                let body = &self.model.oscillator;
                // A jump takes less time than rounding, which would be a part of its force.
                let force = match self.has_jumps {
                    true => {
                        let damping = 2.0 * body.damping * state.velocity;
                        self.force_at_rest(start, &terms, displacement) - damping
                    }
                    false => friction + body.mass * state.acceleration,
                };
                self.slip(
                    start,
                    displacement,
                    (state.velocity, force),
                    terms,
                    direction,
                    work,
                )
            }
        }
    }

    fn segments(
        &self,
        segment: &ClosedSegment,
        duration: f64,
        report: impl FnMut(Segment),
    ) -> Resolved<()> {
        let Phase::Slip(direction) = segment.phase else {
            return Ok(());
        };
        let flow = self.flow(segment, direction);
        let motion = |after: f64| {
            let state = flow.at(after);
            Kinematics {
                after,
                displacement: state.displacement,
                velocity: state.velocity,
                acceleration: state.acceleration,
            }
        };
        let followed = FollowedSlip {
            start: segment.start,
            displacement: segment.from.displacement,
            temperature: None,
        };
        let knots = self.knots.between([0.0, duration]);
        followed.report(motion(0.0), knots, |_, after| Ok(motion(after)), report)
    }

    fn state(&self, segment: &ClosedSegment, t: f64, _: &mut WorkLeft) -> Resolved<Seen> {
        let r = segment.start.until(t).max(0.0);
        let terms = &self.body.terms;
        let gain = self.model.oscillator.force_per_temperature() / self.model.oscillator.mass;
        // With beta = 0 the terms of the body do not contain the temperature that the observer
        // sees. With samples, a segment without an end may extend over several of them.
        let temperature =
            if gain == 0.0 || self.series().is_some() || self.model.temperature.has_line() {
                self.model.temperature.mean(t)
            } else {
                let here: f64 = terms
                    .iter()
                    .zip(&segment.from.terms)
                    .map(|(term, p)| (*p * (term.rate * r).exp()).re)
                    .sum();
                here / gain
            };
        Ok(match segment.phase {
            Phase::Static => (segment.from.displacement, 0.0, temperature, true),
            Phase::Slip(direction) => {
                let state = self.flow(segment, direction).at(r);
                (
                    segment.from.displacement + state.displacement,
                    state.velocity,
                    temperature,
                    false,
                )
            }
        })
    }
}
