//! Every path asks its observer often enough whether it is still wanted, whatever its scene makes of
//! it, and a path that is given up says why.

use rustix::time::{ClockId, clock_gettime};
use std::cell::Cell;
use std::time::Duration;
use stickslip::config::Override;
use stickslip::model::Event;
use stickslip::scenario::Scenario;
use stickslip::scheme::{Instant, Observer, Simulate as _, Snapshot, Unresolved};

fn scenario(name: &str, set: &[&str]) -> Scenario {
    let text = stickslip::config::shipped(name).expect("shipped").text;
    let set: Vec<Override> = set
        .iter()
        .map(|set| Override::set(set).expect("well formed"))
        .collect();
    Scenario::parse(name, text, &set).unwrap_or_else(|e| panic!("{e}\n{set:?}"))
}

/// CPU time of this thread.
fn now() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Stops a simulation after some CPU time, and notes the longest time in which it was not asked.
struct Asked {
    until: Duration,
    last: Cell<Duration>,
    longest: Cell<Duration>,
}

impl Observer for Asked {
    fn event(&mut self, _: usize, _: Event) {}

    fn snapshot(&mut self, _: Instant, _: Snapshot<'_>) {}

    fn is_stopped(&self) -> bool {
        let now = now();
        self.longest
            .set(self.longest.get().max(now - self.last.replace(now)));
        now > self.until
    }
}

/// Scenes whose paths take minutes or never end: forces of fine structure, and bodies that swing
/// very often between two events, two samples or two rows.
const LONG: [(&str, &[&str]); 11] = [
    ("rho025", &["force.expression=\"sin(1e6*x)\""]),
    ("rho025", &["force.expression=\"sign(sin(1e15*x))\""]),
    (
        "rho025",
        &[
            "force.expression=\"sin(1e9*t)\"",
            "temperature.noise.intensity=0",
        ],
    ),
    (
        "rho025",
        &[
            "force.expression=\"sin(1e6*x)\"",
            "temperature.noise.intensity=0",
            "friction.static=0.1",
            "friction.dynamic=0",
        ],
    ),
    (
        "rho025",
        &["force.expression=\"sin(1e6*t)\"", "time.output_step=60"],
    ),
    ("rho025", &["force.expression=\"1e3*tan(1e5*x*t)\""]),
    (
        "rho025",
        &[
            "oscillator.stiffness=1e12",
            "friction.static=0",
            "friction.dynamic=0",
            "time.end=1e6",
            "time.output_step=1e5",
        ],
    ),
    (
        "rho025",
        &[
            "oscillator.stiffness=1e12",
            "temperature.noise.intensity=0",
            "friction.static=0",
            "friction.dynamic=0",
            "time.end=1e6",
            "time.output_step=1e5",
        ],
    ),
    (
        "rho025",
        &[
            "friction.static=1e-9",
            "friction.dynamic=1e-9",
            "time.end=1e5",
            "time.output_step=1e5",
        ],
    ),
    ("belt", &["time.end=1e9", "time.output_step=1e9"]),
    (
        "shaw",
        &[
            "scheme.kind=\"quasi-static\"",
            "time.end=1e9",
            "time.output_step=1e9",
        ],
    ),
];

/// The longest time is measured on a machine with other work: 0.1 s of CPU time is a thousand times
/// what the paths are to take from look to look.
#[test]
fn every_path_checks_for_a_stop_every_tenth_of_a_second() {
    for (name, set) in LONG {
        let mut all = vec!["scheme.kind=\"event-driven\""];
        all.extend(set);
        let scenario = scenario(name, &all);
        let plan = scenario.plan();
        for paths in [1, 256] {
            let start = now();
            let until = start + Duration::from_millis(200);
            let mut asked = Asked {
                until,
                last: Cell::new(now()),
                longest: Cell::default(),
            };
            plan.simulation
                .simulate(1, &(0..paths).collect::<Vec<u64>>(), &mut asked);
            let (end, longest) = (now() - start, asked.longest.get());
            println!("{name} {set:?}, {paths} paths: {end:?}, asked {longest:?} apart at most");
            assert!(
                longest < Duration::from_millis(100),
                "{name} {set:?}: {longest:?}"
            );
            assert!(end < Duration::from_millis(300), "{name} {set:?}: {end:?}");
        }
    }
}

#[test]
fn a_path_that_is_given_up_says_why() {
    let event_driven = "scheme.kind=\"event-driven\"";
    let no_noise = "temperature.noise.intensity=0";
    for (set, limit, why) in [
        (&[event_driven][..], None, None),
        (&[event_driven], Some(100), Some(Unresolved::TooLong)),
        (
            &[event_driven, no_noise],
            Some(100),
            Some(Unresolved::TooLong),
        ),
        (
            &[event_driven, "force.expression=\"sin(x)\""],
            Some(100),
            Some(Unresolved::TooLong),
        ),
        (
            &[event_driven, "force.expression=\"sqrt(x - 5.9)\""],
            None,
            Some(Unresolved::NoNumber),
        ),
        (
            &[event_driven, "force.expression=\"sqrt(x - 5.9)\"", no_noise],
            None,
            Some(Unresolved::NoNumber),
        ),
        (
            &["scheme.kind=\"quasi-static\""],
            Some(100),
            Some(Unresolved::TooLong),
        ),
    ] {
        let plan = scenario("rho025", set).plan();
        let simulation = match limit {
            Some(limit) => plan.simulation.with_work_limit(limit),
            None => plan.simulation,
        };
        assert_eq!(simulation.why_lost(1, 0, &mut ()), why, "{set:?}");
        assert_eq!(
            simulation.simulate(1, &[0], &mut ()).is_empty(),
            why.is_none(),
            "{set:?}"
        );
    }
}
