//! Ensembles made by hand, whose statistics are known without the code under test.

use super::deterministic::Deterministic;
use super::{BlockObserver, BlockResult, Estimate, PassageLevels, Record, Statistic, Summary};
use crate::model::{Drive, Event, EventKind, Friction, Oscillator, Problem, Sign, Temperature};
use crate::scheme::{Instant, Observer, Snapshot, Timeline};
use crate::sums::Replicate;

impl Record {
    /// Everything is kept of one path, and everything is measured.
    pub(crate) fn everything() -> Record {
        let levels = PassageLevels::of(&[1.0]);
        let (laws, density, spectrum, energy) = (true, true, true, true);
        Record {
            paths: true,
            events: true,
            trajectories: 1,
            laws,
            density,
            spectrum,
            energy,
            levels,
        }
    }
}

impl Deterministic {
    /// Nothing is deterministic.
    pub const NOTHING: Deterministic = Deterministic {
        everything: false,
        start: false,
        first_stick: false,
        never_sticks: false,
        frictionless: false,
        drift: None,
    };
}

/// f_d = 2, x0 = 6, and no forcing. The tests prescribe the events themselves.
pub fn model() -> Problem {
    Problem {
        oscillator: Oscillator {
            mass: 1.0,
            stiffness: 1.0,
            damping: 0.0,
            drive: Drive::Dilatation(1.0),
        },
        friction: Friction {
            static_force: 3.0,
            dynamic_force: 2.0,
        },
        temperature: Temperature::default(),
        force: None,
        random: Vec::new(),
        initial_displacement: 6.0,
        initial_velocity: 0.0,
    }
}

pub fn slip(time: f64, displacement: f64) -> Event {
    Event {
        kind: EventKind::SlipStarted(Sign::Positive),
        time,
        displacement,
        force: 3.0,
    }
}

pub fn turn(time: f64, displacement: f64) -> Event {
    Event {
        kind: EventKind::SubPhaseBoundary(Sign::Negative),
        time,
        displacement,
        force: -3.5,
    }
}

pub fn stick(time: f64, displacement: f64) -> Event {
    Event {
        kind: EventKind::StickEntered,
        time,
        displacement,
        force: 0.5,
    }
}

/// A path, given by its events and x(t_end).
pub struct Path {
    pub events: Vec<Event>,
    pub end: f64,
}

/// The result of an observer of a block of such paths, with numbers from `first` on. `rows` (of the
/// output grid) and `periods` hold x of every path. x' is taken to be -x, and T to be x^2.
pub fn observe(
    timeline: &Timeline,
    record: &Record,
    first: u64,
    paths: &[Path],
    rows: &[Vec<f64>],
    periods: &[Vec<f64>],
) -> BlockResult {
    let numbers: Vec<u64> = (first..first + paths.len() as u64).collect();
    let mut observer = BlockObserver::new(&model(), timeline, record, &numbers, Replicate::Path);
    for (lane, path) in paths.iter().enumerate() {
        path.events
            .iter()
            .for_each(|&event| observer.event(lane, event));
    }
    let mut show = |instant, time, x: &[f64]| {
        let velocity: Vec<f64> = x.iter().map(|x| -x).collect();
        let temperature: Vec<f64> = x.iter().map(|x| x * x).collect();
        let is_static: Vec<bool> = x.iter().map(|&x| x == 6.0).collect();
        let (velocity, temperature, is_static) = (&velocity[..], &temperature[..], &is_static[..]);
        observer.snapshot(
            instant,
            Snapshot {
                time,
                displacement: x,
                velocity,
                temperature,
                is_static,
            },
        );
    };
    rows.iter()
        .enumerate()
        .for_each(|(k, x)| show(Instant::Output(k), k as f64 * timeline.output_step, x));
    let period = timeline.period.unwrap_or(0.0);
    (1..)
        .zip(periods)
        .for_each(|(n, x)| show(Instant::Period(n), n as f64 * period, x));
    show(
        Instant::End,
        timeline.end,
        &paths.iter().map(|p| p.end).collect::<Vec<_>>(),
    );
    observer.finish(first, paths.len() as u64, Vec::new())
}

pub fn estimate(summary: &Summary, statistic: Statistic) -> Estimate {
    *summary.estimate(statistic)
}
