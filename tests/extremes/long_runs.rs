//! Runs of 1e9 steps, 1e6 forcing periods and 300 days: time, phase and energy do not drift.

use super::common::{paper, timeline};
use super::invariants::Watch;
use std::f64::consts::PI;
use stickslip::config::Override;
use stickslip::model::{Event, EventKind};
use stickslip::scenario::Scenario;
use stickslip::scheme::{
    DEFAULT_TOLERANCE, DiscreteSimulation, EventDrivenSimulation, Instant, Observer, Simulate as _,
    Snapshot,
};

/// Averages of the cascade over many periods, early and late in a run: phase of the forcing at
/// stick exits, |x| at sticks, way of a slip.
struct Orbit {
    angular_frequency: f64,
    early: (f64, f64),
    late: (f64, f64),
    sums: [Sums; 2],
    origin: f64,
    temperature: f64,
    events: u64,
}

#[derive(Clone, Copy, Default)]
struct Sums {
    slips: f64,
    sticks: f64,
    phase: f64,
    way: f64,
}

impl Orbit {
    fn new(angular_frequency: f64, end: f64) -> Self {
        let (early, late) = ((0.01 * end, 0.11 * end), (0.9 * end, end));
        Orbit {
            angular_frequency,
            early,
            late,
            sums: [Sums::default(); 2],
            origin: 0.0,
            temperature: 0.0,
            events: 0,
        }
    }

    fn means(&self) -> [(f64, f64); 2] {
        self.sums.map(|s| (s.phase / s.slips, s.way / s.sticks))
    }
}

impl Observer for Orbit {
    fn event(&mut self, _: usize, event: Event) {
        self.events += 1;
        for (sums, (from, to)) in self.sums.iter_mut().zip([self.early, self.late]) {
            if event.time < from || event.time >= to {
                continue;
            }
            match event.kind {
                EventKind::SlipStarted(_) => {
                    sums.slips += 1.0;
                    sums.phase += (self.angular_frequency * event.time).rem_euclid(PI);
                }
                EventKind::StickEntered => {
                    sums.sticks += 1.0;
                    sums.way += (event.displacement - self.origin).abs();
                }
                EventKind::SubPhaseBoundary(_) => {}
            }
        }
        self.origin = event.displacement;
    }

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if instant == Instant::End {
            self.temperature = s.temperature[0];
        }
    }
}

/// n steps of the noiseless scene with w h = 2^-9, so that the phase at the end is exactly n/512.
fn many_steps(n: u64) {
    let (w, h) = (0.25, 1.0 / 128.0);
    let end = n as f64 * h;
    let mut orbit = Orbit::new(w, end);
    let lost = DiscreteSimulation::new(&paper(w, 0.0), &timeline(end, end), h).simulate(
        1,
        &[0],
        &mut orbit,
    );
    assert!(lost.is_empty());
    let exact = (n as f64 / 512.0).cos();
    let [(early, short), (late, long)] = orbit.means();
    let halves = end * w / PI;
    println!(
        "{n} steps: T off by {:e}; exit phase {early} then {late}; way {short} then {long}",
        orbit.temperature - exact
    );
    assert!((orbit.temperature - exact).abs() < 1e-14);
    // There is one slip in each half-period, from the first to the last.
    assert!(
        (orbit.events as f64 / 2.0 - halves).abs() < 2.0,
        "{} events in {halves} half-periods",
        orbit.events
    );
    // Events are multiples of h, and their place in the period takes all values. So a mean over N
    // half-periods is accurate to about h/N.
    let bound = 20.0 * h / (0.1 * halves);
    assert!(
        (early - late).abs() < bound && (short - long).abs() < 10.0 * bound,
        "bound {bound}"
    );
}

#[test]
fn ten_million_steps_do_not_drift() {
    many_steps(10_000_000);
}

#[test]
#[ignore = "1e9 steps: some ten seconds"]
fn a_billion_steps_do_not_drift() {
    many_steps(1_000_000_000);
}

/// The periodic orbit of the noiseless scene: every event is compared with that of the first
/// periods.
struct Periodic {
    half_period: f64,
    /// Slip and stick of one half-period after the transient: phase within the half-period, |x|,
    /// |b|.
    reference: Vec<(f64, f64, f64)>,
    seen: usize,
    worst: (f64, f64, f64),
}

/// The number of events after which the transient has died away; it decays by a factor of 8 in each
/// phase.
const TRANSIENT: usize = 100;

impl Observer for Periodic {
    fn event(&mut self, _: usize, event: Event) {
        self.seen += 1;
        if self.seen <= TRANSIENT {
            return;
        }
        let halves = ((self.seen - TRANSIENT - 1) / 2) as f64;
        let now = (
            event.time - halves * self.half_period,
            event.displacement.abs(),
            event.force.abs(),
        );
        if self.reference.len() < 2 {
            return self.reference.push(now);
        }
        let then = self.reference[(self.seen - TRANSIENT - 1) % 2];
        let off = (
            (now.0 - then.0).abs(),
            (now.1 - then.1).abs(),
            (now.2 - then.2).abs(),
        );
        self.worst = (
            self.worst.0.max(off.0),
            self.worst.1.max(off.1),
            self.worst.2.max(off.2),
        );
    }

    fn snapshot(&mut self, _: Instant, _: Snapshot<'_>) {}
}

#[test]
fn a_hundred_thousand_forcing_periods_repeat_the_first() {
    many_periods(100_000);
}

#[test]
#[ignore = "1e6 periods, 4e6 events: half a minute"]
fn a_million_forcing_periods_repeat_the_first() {
    many_periods(1_000_000);
}

fn many_periods(periods: usize) {
    let half_period = PI / 0.25;
    let end = 2.0 * periods as f64 * half_period;
    let mut orbit = Periodic {
        half_period,
        reference: Vec::new(),
        seen: 0,
        worst: (0.0, 0.0, 0.0),
    };
    let scheme =
        EventDrivenSimulation::new(&paper(0.25, 0.0), &timeline(end, end), DEFAULT_TOLERANCE);
    assert!(scheme.simulate(1, &[0], &mut orbit).is_empty());
    println!(
        "{} events; off in t by {:e}, in x by {:e}, in b by {:e}",
        orbit.seen, orbit.worst.0, orbit.worst.1, orbit.worst.2
    );
    assert_eq!(orbit.seen, 4 * periods - 1);
    // Doubles near 2.5e7 have a spacing of 3.7e-9, and the reported time and the multiple of the
    // period that is subtracted are each off by half of it.
    assert!(orbit.worst.0 <= 4e-9, "{:e}", orbit.worst.0);
    assert!(orbit.worst.1 < 1e-11 && orbit.worst.2 < 1e-12);
}

#[test]
fn three_hundred_days_of_the_viaduct_balance() {
    // Each path has 528 slips of 0.07 s. The mismatch of the energy is relative to the friction
    // work, that of the time to the 300 days.
    for scheme in ["event-driven", "quasi-static"] {
        let overrides = [
            Override::flag("--scheme", "scheme.kind", scheme),
            Override::flag("--paths", "ensemble.paths", "16"),
        ];
        let scenario = Scenario::read("scenarios/viaduct.toml".as_ref(), &overrides)
            .unwrap_or_else(|e| panic!("{e}"));
        let mut watch = Watch::new(&scenario);
        let paths: Vec<u64> = (0..16).collect();
        assert!(
            scenario
                .plan()
                .simulation
                .simulate(1, &paths, &mut watch)
                .is_empty()
        );
        let (end, f_d) = (scenario.time.end, scenario.model.friction.dynamic_force);
        let worst = |of: &dyn Fn(&super::invariants::Lane) -> f64| {
            watch.lanes.iter().map(of).fold(0.0, f64::max)
        };
        assert!(
            watch
                .lanes
                .iter()
                .all(|lane| lane.complaint.is_none() && lane.slips > 400),
            "{scheme}"
        );
        let energy = worst(&|lane| lane.energy.mismatch.abs() / (f_d * lane.travel));
        let time = worst(&|lane| (lane.stick_time + lane.slip_time - end).abs() / end);
        let slip = worst(&|lane| lane.slip_time / f64::from(lane.slips));
        println!("{scheme}: energy off by {energy:e}, time by {time:e}; {slip} s a slip");
        assert!(
            time < 1e-13 && energy < 1e-4,
            "{scheme}: {time:e} {energy:e}"
        );
        assert!((0.06..0.08).contains(&slip));
    }
}
