//! The cycle of a scene without noise: one path tells all, so its own numbers are reported.

use crate::ensemble::Plan;
use crate::scenario::{Period, PeriodSource, Scenario};
use crate::stats::{EventColumns, Record};

/// The longest cycle that is looked for, in periods of the forcing, or in slips without a forcing.
const LONGEST: usize = 32;

/// Two states are the same if they differ by no more than this part of the amplitude, in a scheme
/// without a step.
const SAME: f64 = 1e-6;

/// The most states at phase zero that are kept.
const STATES: usize = 64;

/// What the path of a scene without noise does in the end.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitCycle {
    /// x at the times n P, the last of them, where something periodic forces the body; x at the
    /// beginnings of the last slips elsewhere.
    pub section: Vec<f64>,
    /// Half the distance between the largest and the smallest x, in the last cycle if there is one
    /// and in all the counted time otherwise. A drift is taken off.
    pub amplitude: f64,
    /// The cycle; none if no state comes back.
    pub repeats: Option<Repeats>,
}

/// A motion that repeats itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeats {
    /// The time after which the motion repeats itself.
    pub period: f64,
    /// How many periods P of the forcing that is; none without a forcing.
    pub forcing_periods: Option<usize>,
    /// How far the body gets in that time.
    pub advance: f64,
    /// The slips and the sticks that begin in that time.
    pub slips: usize,
    /// The sticks that begin in that time.
    pub sticks: usize,
    /// The share of that time at rest.
    pub at_rest: f64,
    /// Whether half a cycle later the motion is its own mirror image.
    pub is_symmetric: bool,
}

/// An event of the path.
#[derive(Clone, Copy)]
struct PathEvent {
    time: f64,
    x: f64,
    /// The phase that begins: 0 a stick, otherwise the direction of motion.
    sign: i8,
    is_slip_start: bool,
}

impl LimitCycle {
    /// The cycle of a scenario; none if something is random in it, or if its path is lost.
    pub fn of(scenario: &Scenario) -> Option<LimitCycle> {
        let model = &scenario.model;
        let felt = model.oscillator.force_per_temperature() != 0.0;
        if felt && model.temperature.is_random() || scenario.time.end == 0.0 {
            return None;
        }
        let timeline = scenario.timeline();
        let record = Record { events: true, ..Record::NOTHING };
        let block = Plan { record, paths: 1, antithetic: false, ..scenario.plan() }.replay(0);
        let events = moments(&block.events.filter(|_| block.diverged.is_empty())?);
        let after = scenario.statistics.after;
        let counted: Vec<PathEvent> = events.iter().copied().filter(|event| event.time >= after).collect();
        let same = scenario.scheme.step().map_or(SAME, |h| SAME.max(2.0 * h / timeline.period.unwrap_or(timeline.end)));
        let drift = model.long_run_drift().unwrap_or(0.0);
        let extent = amplitude(&counted, drift);
        let forcing = scenario.period().filter(|period| period.source != PeriodSource::Share);
        let (section, found) = match forcing {
            Some(Period { length, .. }) => {
                let ends = block.totals.summary().periods.mean;
                let x0 = model.initial_displacement;
                let states = ends.iter().skip(timeline.first_period().saturating_sub(1)).map(|x| x0 + x);
                let states: Vec<f64> = states.collect();
                let advance = drift * length;
                let multiple = (1..=LONGEST).find(|n| comes_back(&states, *n, advance, same * extent));
                let end = timeline.periods() as f64 * length;
                let found = multiple.map(|n| (end - n as f64 * length, n as f64 * length, n as f64 * advance));
                (states, found.zip(multiple.map(Some)))
            }
            None => {
                let starts: Vec<PathEvent> = counted.iter().copied().filter(|event| event.is_slip_start).collect();
                let found = (1..=LONGEST).find_map(|n| autonomous(&starts, n, same, extent));
                (starts.iter().map(|event| event.x).collect(), found.map(|found| (found, None)))
            }
        };
        let repeats = found.map(|((begin, period, advance), forcing_periods)| {
            let (cycle, at_rest) = within(&events, begin, period);
            let repeats = Repeats {
                period,
                forcing_periods,
                advance,
                slips: cycle.iter().filter(|event| event.is_slip_start).count(),
                sticks: cycle.iter().filter(|event| event.sign == 0).count(),
                at_rest,
                is_symmetric: advance == 0.0 && is_symmetric(&cycle, period, same * extent),
            };
            (repeats, amplitude(&cycle, advance / period))
        });
        Some(LimitCycle {
            section: section.split_at(section.len().saturating_sub(STATES)).1.to_vec(),
            amplitude: repeats.map_or(extent, |(_, amplitude)| amplitude),
            repeats: repeats.map(|(repeats, _)| repeats),
        })
    }
}

fn moments(events: &EventColumns) -> Vec<PathEvent> {
    let EventColumns { time, displacement, sign, kind, .. } = events;
    let moment = |i: usize| PathEvent { time: time[i], x: displacement[i], sign: sign[i], is_slip_start: kind[i] == 1 };
    (0..time.len()).map(moment).collect()
}

/// Half the distance between the largest and the smallest x, less a drift.
fn amplitude(events: &[PathEvent], drift: f64) -> f64 {
    let x = events.iter().map(|event| event.x - drift * event.time);
    let (least, greatest) = x.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), x| (l.min(x), g.max(x)));
    if least <= greatest { (greatest - least) / 2.0 } else { 0.0 }
}

/// Whether the last n states are those n states before, an advance apart, twice over.
fn comes_back(states: &[f64], n: usize, advance: f64, same: f64) -> bool {
    let count = states.len();
    count > 2 * n
        && (count - 2 * n..count).all(|k| {
            k < n || (states[k] - states[k - n] - n as f64 * advance).abs() <= same.max(f64::EPSILON * states[k].abs())
        })
}

/// When the last n slips began, how long they took, and how far the body got, if the n slips before
/// them took the same time and got as far, one by one.
fn autonomous(starts: &[PathEvent], n: usize, same: f64, extent: f64) -> Option<(f64, f64, f64)> {
    let last = starts.len().checked_sub(1).filter(|last| *last >= 2 * n)?;
    let (period, advance) = (starts[last].time - starts[last - n].time, starts[last].x - starts[last - n].x);
    let is_same = |k: usize| {
        let (time, x) = (starts[k].time - starts[k - n].time, starts[k].x - starts[k - n].x);
        (time - period).abs() <= same * period && (x - advance).abs() <= same * extent.max(advance.abs())
    };
    (last - n..last).all(is_same).then_some((starts[last - n].time, period, advance))
}

/// The events from `begin` on for a time `period`, and the share of that time at rest.
fn within(events: &[PathEvent], begin: f64, period: f64) -> (Vec<PathEvent>, f64) {
    let is_inside = |time: f64| time >= begin && time < begin + period;
    let cycle: Vec<PathEvent> = events.iter().copied().filter(|event| is_inside(event.time)).collect();
    let mut is_at_rest = events.iter().rev().find(|event| event.time < begin).is_none_or(|event| event.sign == 0);
    let (mut since, mut rest) = (begin, 0.0);
    for event in &cycle {
        rest += if is_at_rest { event.time - since } else { 0.0 };
        (since, is_at_rest) = (event.time, event.sign == 0);
    }
    rest += if is_at_rest { begin + period - since } else { 0.0 };
    (cycle, rest / period)
}

/// Whether each event has its mirror image half a period later.
fn is_symmetric(cycle: &[PathEvent], period: f64, same: f64) -> bool {
    let half = cycle.len() / 2;
    let (first, second) = cycle.split_at(half);
    let Some(centre) = first.first().zip(second.first()).map(|(a, b)| a.x + b.x) else { return false };
    cycle.len().is_multiple_of(2)
        && first.iter().zip(second).all(|(a, b)| {
            a.sign == -b.sign
                && (b.time - a.time - period / 2.0).abs() <= SAME.max(same) * period
                && (a.x + b.x - centre).abs() <= 2.0 * same
        })
}
