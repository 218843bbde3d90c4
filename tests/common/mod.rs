//! Scenes and observers that several tests of the schemes use.
#![allow(dead_code, reason = "each test file uses its own part")]

#[path = "../../src/study/tests/reference.rs"]
pub mod reference;

use stickslip::config::shipped;
use stickslip::ensemble::BLOCK_SIZE;
use stickslip::model::*;
use stickslip::scenario::Scenario;
use stickslip::scheme::{
    EventDrivenSimulation, Instant, Observer, Simulate as _, Snapshot, Timeline,
};
use stickslip::stats::{BlockObserver, Record, Statistic, Summary, Totals};
use stickslip::sums::{Merge as _, Replicate};

/// The model of a shipped scenario.
pub fn shipped_model(name: &str) -> Problem {
    Scenario::parse(name, shipped(name).expect("shipped").text, &[])
        .expect("sound")
        .model
}

/// The model of the paper with forcing frequency `w` and noise of intensity `rho`; without noise if
/// `rho` is zero.
pub fn paper(w: f64, rho: f64) -> Problem {
    let mut model = shipped_model("rho025");
    model.temperature.harmonics[0].angular_frequency = w;
    model.temperature.noises[0].intensity = rho;
    model.temperature.noises.retain(|_| rho != 0.0);
    model
}

/// A timeline with an output grid and no periods.
pub fn timeline(end: f64, output_step: f64) -> Timeline {
    Timeline {
        end,
        output_step,
        period: None,
        after: 0.0,
    }
}

/// A row of the output grid: t, x, x', T, and whether the path is static.
pub type OutputRow = (f64, f64, f64, f64, bool);

/// Keeps every event and every output row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keep {
    /// The events of each lane.
    pub events: Vec<Vec<Event>>,
    /// The rows of each lane.
    pub rows: Vec<Vec<OutputRow>>,
}

impl Keep {
    pub fn lanes(lanes: usize) -> Self {
        Keep {
            events: vec![Vec::new(); lanes],
            rows: vec![Vec::new(); lanes],
        }
    }
}

impl Observer for Keep {
    fn event(&mut self, lane: usize, event: Event) {
        self.events[lane].push(event);
    }

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if let Instant::Output(_) = instant {
            for lane in 0..s.displacement.len() {
                let row = (
                    s.time,
                    s.displacement[lane],
                    s.velocity[lane],
                    s.temperature[lane],
                    s.is_static[lane],
                );
                self.rows[lane].push(row);
            }
        }
    }
}

/// The statistics of the first `paths` paths of a scheme, which is given as its function
/// `simulate`, on two threads.
pub fn summary_of<S>(model: &Problem, timeline: &Timeline, paths: u64, simulate: S) -> Summary
where
    S: Fn(&[u64], &mut BlockObserver) -> Vec<usize> + Sync,
{
    const THREADS: u64 = 2;
    let record = Record::NOTHING;
    let work = |thread: u64| {
        let mut totals = Totals::empty(model, timeline, &record);
        for block in (thread..paths.div_ceil(BLOCK_SIZE)).step_by(THREADS as usize) {
            let (first, count) = (
                block * BLOCK_SIZE,
                BLOCK_SIZE.min(paths - block * BLOCK_SIZE),
            );
            let numbers: Vec<u64> = (first..first + count).collect();
            let mut observer =
                BlockObserver::new(model, timeline, &record, &numbers, Replicate::Path);
            assert!(
                simulate(&numbers, &mut observer).is_empty(),
                "no path is given up"
            );
            totals.merge(&observer.finish(first, count, Vec::new()).totals);
        }
        totals
    };
    std::thread::scope(|scope| {
        let work = &work;
        let threads: Vec<_> = (0..THREADS)
            .map(|thread| scope.spawn(move || work(thread)))
            .collect();
        let mut totals = Totals::empty(model, timeline, &record);
        for thread in threads {
            totals.merge(&thread.join().expect("a block failed"));
        }
        totals.summary()
    })
}

/// The statistics of the event-driven scheme.
pub fn event_driven_summary(
    model: &Problem,
    timeline: &Timeline,
    tolerance: f64,
    seed: u64,
    paths: u64,
) -> Summary {
    let simulation = EventDrivenSimulation::new(model, timeline, tolerance);
    summary_of(model, timeline, paths, |numbers, observer| {
        simulation.simulate(seed, numbers, observer)
    })
}

/// A statistic and its standard error.
pub fn estimate(summary: &Summary, statistic: Statistic) -> (f64, f64) {
    let e = summary.estimate(statistic);
    (e.estimate, e.standard_error)
}
