//! The limit cycle of a scenario without noise, computed from its single path.

use crate::ensemble::PathMotion;
use crate::model::{Event, EventKind, Phase};
use crate::scenario::{Period, PeriodSource, Scenario};
use crate::scheme::{Segment, Simulate as _, Timeline};
use crate::stats::{BlockObserver, LimitCycle, Record, Repeats, Totals};
use crate::sums::Replicate;

/// The longest cycle searched for, in periods of the forcing, or in slips without a forcing.
const LONGEST: usize = 32;

/// Two states are the same if they differ by no more than this part of the amplitude, in a scheme
/// without a step.
const SAME: f64 = 1e-6;

impl LimitCycle {
    /// The cycle of a scenario; none if something is random in it, or if its path is lost.
    pub fn of(scenario: &Scenario) -> Option<LimitCycle> {
        let model = &scenario.model;
        let felt = model.oscillator.force_per_temperature() != 0.0;
        let is_random = felt && model.temperature.is_random() || !model.random.is_empty();
        if is_random || scenario.time.end == 0.0 {
            return None;
        }
        let motion = CountedMotion::of(scenario)?;
        let (section, found) = match motion.forcing {
            Some(Period { length, .. }) => motion.forced_cycle(length),
            None => motion.autonomous_cycle(),
        };
        let repeats = found.map(|found| motion.repeats(found));
        let drift = repeats.map_or(motion.drift, |repeats| repeats.advance / repeats.period);
        let amplitude = found.map_or(motion.extent, |found| {
            let span = [found.begin, found.begin + found.period];
            motion.path.amplitude(span, found.advance / found.period)
        });
        let (_, last) = section.split_at(section.len().saturating_sub(LimitCycle::STATES));
        Some(LimitCycle {
            section: last.iter().map(|(time, x)| x - drift * time).collect(),
            amplitude,
            repeats,
        })
    }
}

/// Times, and x at them.
type Section = Vec<(f64, f64)>;

/// The properties of a cycle that follow from its recurring states.
#[derive(Clone, Copy)]
struct FoundCycle {
    begin: f64,
    period: f64,
    advance: f64,
    forcing_periods: Option<usize>,
}

/// The single path of a scenario without noise, in the counted time.
struct CountedMotion<'a> {
    scenario: &'a Scenario,
    timeline: Timeline,
    path: PathMotion,
    totals: Totals,
    forcing: Option<Period>,
    /// The counted events.
    events: Vec<Event>,
    /// Two states are the same if they differ by no more than this part of the amplitude.
    same: f64,
    /// Whether no further slip begins, and no periodic forcing acts on the body.
    has_ended: bool,
    /// The drift that follows from the model alone.
    known_drift: Option<f64>,
    drift: f64,
    /// Half the range of x minus its drift.
    extent: f64,
}

impl<'a> CountedMotion<'a> {
    /// The motion of a scenario; none if its path is lost.
    fn of(scenario: &'a Scenario) -> Option<Self> {
        let model = &scenario.model;
        let timeline = scenario.timeline();
        let plan = scenario.plan();
        let mut both = (
            BlockObserver::new(model, &timeline, &Record::NOTHING, &[0], Replicate::Path),
            PathMotion::default(),
        );
        let lost = plan.simulation.simulate(plan.seed, &[0], &mut both);
        if !lost.is_empty() {
            return None;
        }
        let (block, path) = (both.0.finish(0, 1, Vec::new()), both.1);
        let after = scenario.statistics.after;
        let is_counted = |event: &Event| event.time >= after;
        let events: Vec<Event> = path.events.iter().copied().filter(is_counted).collect();
        let forcing = scenario
            .period()
            .filter(|period| period.source != PeriodSource::Share);
        // Without further slips the body rests, or its sliding approaches a steady state.
        let middle = 0.5 * (after + timeline.end);
        let is_late = |event: &Event| is_slip_start(event) && event.time > middle;
        let has_ended = forcing.is_none() && !events.iter().any(is_late);
        let from = if has_ended { middle } else { after };
        let known_drift = model.long_run_drift();
        let drift = known_drift.unwrap_or_else(|| path.drift([from, timeline.end]));
        let extent = path.amplitude([from, timeline.end], drift);
        let is_steady = has_ended && extent <= SAME * drift.abs() * (timeline.end - from);
        Some(CountedMotion {
            scenario,
            same: scenario.scheme.step().map_or(SAME, |h| {
                SAME.max(2.0 * h / timeline.period.unwrap_or(timeline.end))
            }),
            timeline,
            path,
            totals: block.totals,
            forcing,
            events,
            has_ended,
            known_drift,
            drift,
            extent: if is_steady { 0.0 } else { extent },
        })
    }

    /// The states at the ends of the periods of the forcing, and the cycle in which they recur.
    fn forced_cycle(&self, length: f64) -> (Section, Option<FoundCycle>) {
        let x0 = self.scenario.model.initial_displacement;
        let first = self.timeline.first_period();
        let ends = self.totals.summary().periods.mean;
        let counted = ends.iter().skip(first.saturating_sub(1));
        let states: Vec<f64> = counted.map(|x| x0 + x).collect();
        let near = self.same * self.extent;
        let way = |n: usize| match self.known_drift {
            Some(drift) => Some(n as f64 * drift * length),
            None => advance(&states, n).map(|way| if way.abs() <= near { 0.0 } else { way }),
        };
        let is_back = |n: &usize| way(*n).is_some_and(|way| comes_back(&states, *n, way, near));
        let end = self.timeline.periods() as f64 * length;
        let found = (1..=LONGEST).find(is_back).map(|n| FoundCycle {
            begin: end - n as f64 * length,
            period: n as f64 * length,
            advance: way(n).unwrap_or_default(),
            forcing_periods: Some(n),
        });
        let times = (first..).map(|n| n as f64 * length);
        (times.zip(states).collect(), found)
    }

    /// The states at the beginnings of slips, and the cycle in which they recur.
    fn autonomous_cycle(&self) -> (Section, Option<FoundCycle>) {
        let is_start = |event: &Event| is_slip_start(event) && !self.has_ended;
        let starts: Vec<Event> = self.events.iter().copied().filter(is_start).collect();
        let found = (1..=LONGEST).find_map(|n| autonomous(&starts, n, self.same, self.extent));
        let states = starts.iter().map(|event| (event.time, event.displacement));
        (states.collect(), found)
    }

    fn repeats(&self, found: FoundCycle) -> Repeats {
        let FoundCycle {
            begin,
            period,
            advance,
            forcing_periods,
        } = found;
        let (cycle, at_rest) = within(&self.path.events, begin, period);
        let is_stick = |event: &&Event| event.kind == EventKind::StickEntered;
        Repeats {
            period,
            forcing_periods,
            advance,
            slips: cycle.iter().filter(|event| is_slip_start(event)).count(),
            sticks: cycle.iter().filter(is_stick).count(),
            at_rest,
            is_symmetric: advance == 0.0 && is_symmetric(&cycle, period, self.same * self.extent),
        }
    }
}

fn is_slip_start(event: &Event) -> bool {
    matches!(event.kind, EventKind::SlipStarted(_))
}

/// Subintervals of a segment in which a zero of x' - drift is searched for: a quintic has up to
/// four.
const PLACES: u32 = 8;

/// Halvings until such a zero has all its digits.
const HALVINGS: usize = 52;

/// Steps until the slope of a strip has all its digits; each leaves two thirds of a range.
const THIRDS: usize = 100;

impl PathMotion {
    /// The drift between two times, if not known otherwise: the slope of the narrowest strip that
    /// contains x, if it is less than half as wide as the range of x; 0 otherwise. A steady or
    /// periodic motion has that slope.
    fn drift(&self, [from, to]: [f64; 2]) -> f64 {
        let inside = || {
            self.segments
                .iter()
                .filter(|segment| segment.start >= from && segment.end() <= to)
        };
        let at = |segment: &Segment, place: u32| {
            let part = f64::from(place) / f64::from(PLACES);
            [
                segment.start + part * segment.length,
                segment.displacement + segment.at(part)[0],
            ]
        };
        let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        // The upper and the lower side of the convex hull, which alone determine the width of a
        // strip.
        let mut hull: Vec<[f64; 2]> = Vec::new();
        for side in [1.0, -1.0] {
            let first = hull.len();
            for next in
                inside().flat_map(|segment| (0..=PLACES).map(move |place| at(segment, place)))
            {
                while hull.len() >= first + 2
                    && side * turn(hull[hull.len() - 2], hull[hull.len() - 1], next) >= 0.0
                {
                    hull.pop();
                }
                hull.push(next);
            }
        }
        let width = |slope: f64| {
            let ends = hull.iter().map(|[time, x]| x - slope * time);
            let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                [a.min(x), b.max(x)]
            });
            high - low
        };
        // The width is convex in the slope, and least at the slope of an edge.
        let slopes = hull
            .windows(2)
            .map(|edge| ((edge[1][1] - edge[0][1]) / (edge[1][0] - edge[0][0])).abs());
        let steepest = slopes.filter(|slope| slope.is_finite()).fold(0.0, f64::max);
        let [mut low, mut high] = [-steepest, steepest];
        for _ in 0..THIRDS {
            let [first, second] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
            if width(first) < width(second) {
                high = second
            } else {
                low = first
            }
        }
        let slope = 0.5 * (low + high);
        if 2.0 * width(slope) < width(0.0) {
            slope
        } else {
            0.0
        }
    }

    /// Half the range of x - drift t between two times. It is largest and smallest at events, or
    /// inside a segment where x' is the drift.
    fn amplitude(&self, [from, to]: [f64; 2], drift: f64) -> f64 {
        let is_inside = |time: f64| time >= from && time <= to;
        let events = self.events.iter().filter(|event| is_inside(event.time));
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let mut reach = |time: f64, x: f64| {
            range = [
                range[0].min(x - drift * time),
                range[1].max(x - drift * time),
            ]
        };
        events.for_each(|event| reach(event.time, event.displacement));
        for segment in self
            .segments
            .iter()
            .filter(|segment| is_inside(segment.start) && is_inside(segment.end()))
        {
            let at = |part: f64| segment.at(part)[1] - drift;
            let mut reach_at = |part: f64| {
                reach(
                    segment.start + part * segment.length,
                    segment.displacement + segment.at(part)[0],
                );
            };
            reach_at(1.0);
            for place in 0..PLACES {
                let [mut low, mut high] =
                    [place, place + 1].map(|place| f64::from(place) / f64::from(PLACES));
                let rises = at(low) < 0.0;
                if (at(high) < 0.0) != rises {
                    for _ in 0..HALVINGS {
                        let middle = 0.5 * (low + high);
                        if (at(middle) < 0.0) == rises {
                            low = middle
                        } else {
                            high = middle
                        }
                    }
                    reach_at(low);
                }
            }
        }
        if range[0] <= range[1] {
            (range[1] - range[0]) / 2.0
        } else {
            0.0
        }
    }
}

/// The distance between the last state and the one n before it.
fn advance(states: &[f64], n: usize) -> Option<f64> {
    let last = states.len().checked_sub(1)?;
    Some(states[last] - states[last.checked_sub(n)?])
}

/// Whether the last n states equal the n states before them up to the advance, twice in a row.
fn comes_back(states: &[f64], n: usize, advance: f64, same: f64) -> bool {
    let count = states.len();
    count > 2 * n
        && (count - 2 * n..count).all(|k| {
            k < n
                || (states[k] - states[k - n] - n as f64 * advance).abs()
                    <= same.max(f64::EPSILON * states[k].abs())
        })
}

/// Start, duration and advance of the last n slips, if the n slips before them have the same
/// durations and advances, one by one.
fn autonomous(starts: &[Event], n: usize, same: f64, extent: f64) -> Option<FoundCycle> {
    let last = starts.len().checked_sub(1).filter(|last| *last >= 2 * n)?;
    let (period, advance) = (
        starts[last].time - starts[last - n].time,
        starts[last].displacement - starts[last - n].displacement,
    );
    let is_same = |k: usize| {
        let (time, x) = (
            starts[k].time - starts[k - n].time,
            starts[k].displacement - starts[k - n].displacement,
        );
        (time - period).abs() <= same * period
            && (x - advance).abs() <= same * extent.max(advance.abs())
    };
    (last - n..last).all(is_same).then_some(FoundCycle {
        begin: starts[last - n].time,
        period,
        advance,
        forcing_periods: None,
    })
}

/// The events from `begin` on for a time `period`, and the share of that time at rest.
fn within(events: &[Event], begin: f64, period: f64) -> (Vec<Event>, f64) {
    let is_inside = |time: f64| time >= begin && time < begin + period;
    let cycle: Vec<Event> = events
        .iter()
        .copied()
        .filter(|event| is_inside(event.time))
        .collect();
    let rests = |event: &Event| event.kind.phase() == Phase::Static;
    let mut is_at_rest = events
        .iter()
        .rev()
        .find(|event| event.time < begin)
        .is_none_or(rests);
    let (mut since, mut rest) = (begin, 0.0);
    for event in &cycle {
        rest += if is_at_rest { event.time - since } else { 0.0 };
        (since, is_at_rest) = (event.time, rests(event));
    }
    rest += if is_at_rest {
        begin + period - since
    } else {
        0.0
    };
    (cycle, rest / period)
}

/// Whether each event has its mirror image half a period later.
fn is_symmetric(cycle: &[Event], period: f64, same: f64) -> bool {
    let half = cycle.len() / 2;
    let (first, second) = cycle.split_at(half);
    let centre = first
        .first()
        .zip(second.first())
        .map(|(a, b)| a.displacement + b.displacement);
    let Some(centre) = centre else { return false };
    cycle.len().is_multiple_of(2)
        && first.iter().zip(second).all(|(a, b)| {
            sign(a) == -sign(b)
                && (b.time - a.time - period / 2.0).abs() <= SAME.max(same) * period
                && (a.displacement + b.displacement - centre).abs() <= 2.0 * same
        })
}

/// The direction of the phase that begins; 0 for a stick.
fn sign(event: &Event) -> f64 {
    match event.kind.phase() {
        Phase::Static => 0.0,
        Phase::Slip(direction) => direction.value(),
    }
}
