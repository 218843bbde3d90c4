//! Where the explicit step diverges and where it does not: the prediction, the warning, and the
//! simulation, with the event-driven scheme for comparison.
//!
//! **Without damping.** A step multiplies the distance from the centre of a half-cycle by sqrt(1 +
//! c^2), c = w0 h, and turns it by atan c. A half-cycle multiplies by G = (1 + c^2)^{pi/(2 atan
//! c)}, about centres eps f_d/K. From one turning point to the next
//!
//! ```text
//! A' = G A - (G + 1) f_d/K,   unchanged at A* = coth(ln G/2) f_d/K = A_c (1 + pi^2 c^2/48 + ...),
//! A_c = 4 f_d/(pi w0 h K),
//! ```
//!
//! so A_c is the limit up to a relative O(c^2), and A_n - A* = G^n (A_0 - A*). Turning points lie
//! on the grid of steps, which also moves each of them by a relative O(c^2). Over the 2/(pi c)
//! half-cycles in which a distance from A* grows by a factor e, that is O(c).

use super::common::Keep;
use std::f64::consts::PI;
use stickslip::advice::{Class, Warning};
use stickslip::config::Override;
use stickslip::model::{Event, EventKind};
use stickslip::noise::AddressedDraws;
use stickslip::scenario::Scenario;
use stickslip::scheme::Simulate as _;
use stickslip::stats::Summary;

/// A body with equal friction that is released at x0, without forcing.
struct Free {
    mass: f64,
    stiffness: f64,
    damping: f64,
    friction: f64,
    start: f64,
    step: f64,
    steps: f64,
}

impl Free {
    fn scenario(&self, scheme: &str) -> Scenario {
        let Free {
            mass,
            stiffness,
            damping,
            friction,
            start,
            step,
            steps,
        } = *self;
        let text = format!(
            "[oscillator]\nmass = {mass:e}\nstiffness = {stiffness:e}\ndamping = {damping:e}\ndilatation = 1\n\
             [friction]\nstatic = {friction:e}\ndynamic = {friction:e}\n[initial]\ndisplacement = {start:e}\n\
             [time]\nend = {:e}\nstep = {step:e}\noutput_step = {:e}\n[ensemble]\npaths = 1\n",
            steps * step,
            steps * step
        );
        let scheme = Override::flag("--scheme", "scheme.kind", scheme);
        Scenario::parse("free.toml", &text, &[scheme]).unwrap_or_else(|e| panic!("{e}\n{text}"))
    }

    fn w0(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// The events and the last row of the path, and the summary of an ensemble of it.
    fn path(&self, scheme: &str) -> (Vec<Event>, (f64, f64), Summary) {
        let plan = self.scenario(scheme).plan();
        let mut keep = Keep::lanes(1);
        plan.simulation.simulate(1, &[0], &mut keep);
        let last = keep.rows[0][keep.rows[0].len() - 1];
        (keep.events.remove(0), (last.1, last.2), plan.run(1))
    }
}

fn turns(events: &[Event]) -> Vec<f64> {
    events
        .iter()
        .filter(|e| matches!(e.kind, EventKind::SubPhaseBoundary(_)))
        .map(|e| e.displacement.abs())
        .collect()
}

fn foretold(scenario: &Scenario) -> bool {
    let grows = |w: &Warning| w.class() == Class::Growth;
    scenario.warnings().iter().any(grows)
}

/// (m, K, c = w0 h, relative distance of the two starts from A_c).
const UNDAMPED: [(f64, f64, f64, f64); 6] = [
    (1.0, 1.0, 0.01, 0.02),
    (1.0, 1.0, 0.05, 0.05),
    (1.0, 1.0, 0.2, 0.2),
    (4.0, 0.25, 0.01, 0.02),
    (1e-6, 1e6, 0.01, 0.02),
    (1e5, 1.888e8, 0.004, 0.01),
];

#[test]
fn amplitudes_grow_above_the_critical_one_as_predicted() {
    for (mass, stiffness, c, near) in UNDAMPED {
        let (w0, friction) = ((stiffness / mass).sqrt(), 0.3 * stiffness);
        let step = c / w0;
        let critical = 4.0 * friction / (PI * c * stiffness);
        for side in [1.0 - near, 1.0 + near] {
            let start = side * critical;
            let free = Free {
                mass,
                stiffness,
                damping: 0.0,
                friction,
                start,
                step,
                steps: (20.0 / (c * c)).ceil(),
            };
            assert_eq!(
                foretold(&free.scenario("discrete-vi")),
                side > 1.0,
                "{mass} {stiffness} {c} {side}"
            );
            let (events, (x, v), summary) = free.path("discrete-vi");

            // A_n - A* = G^n (A_0 - A*), over the time in which the distance grows by a factor e.
            let growth = PI * c.mul_add(c, 1.0).ln() / (2.0 * c.atan());
            let rest = friction / stiffness / (0.5 * growth).tanh();
            let n = (1.0 / growth).ceil() as usize;
            let predicted = rest + (growth * n as f64).exp() * (start - rest);
            let found = turns(&events)[n - 1];
            println!(
                "m {mass:e} K {stiffness:e} c {c}: A_0/A_c {side}, A_{n}/A_c {} predicted {}",
                found / critical,
                predicted / critical
            );
            assert!(
                (found - predicted).abs() < 0.5 * c * critical,
                "{mass} {stiffness} {c} {side}: {found} {predicted}"
            );

            assert_eq!(
                summary.diverged.len(),
                usize::from(side > 1.0),
                "{mass} {stiffness} {c} {side}"
            );
            if side < 1.0 {
                assert!(
                    v == 0.0 && x.abs() <= friction / stiffness,
                    "at rest in the band: {x} {v}"
                );
            }
        }
    }
}

#[test]
fn the_event_driven_scheme_loses_two_f_d_over_k_a_half_cycle() {
    // Coulomb's result: turning point n is at t = n pi/w0 and |x| = x0 - 2 n f_d/K, up to rounding
    // in the digits of x0.
    for (mass, stiffness, c, near) in UNDAMPED {
        let friction = 0.3 * stiffness;
        let start = (1.0 + near) * 4.0 * friction / (PI * c * stiffness);
        let step = c / (stiffness / mass).sqrt();
        let free = Free {
            mass,
            stiffness,
            damping: 0.0,
            friction,
            start,
            step,
            steps: (20.0 / (c * c)).ceil(),
        };
        assert!(!foretold(&free.scenario("event-driven")));
        let (events, (x, v), summary) = free.path("event-driven");
        let turns: Vec<&Event> = events
            .iter()
            .filter(|e| matches!(e.kind, EventKind::SubPhaseBoundary(_)))
            .collect();
        let lost = 2.0 * friction / stiffness;
        // The body turns while |b| = K |x| > f_s = K lost/2.
        let expected = ((start - 0.5 * lost) / lost).ceil() as usize - 1;
        assert_eq!(turns.len(), expected, "{mass} {stiffness} {c}");
        for (n, turn) in (1..).zip(&turns) {
            let n = f64::from(n);
            assert!(
                (turn.displacement.abs() - (start - n * lost)).abs() < 1e-14 * (n + 10.0) * start
            );
            assert!(
                (turn.time * free.w0() / (n * PI) - 1.0).abs() < 1e-11,
                "{n}: {}",
                turn.time
            );
        }
        assert!(v == 0.0 && x.abs() <= 0.5 * lost && summary.diverged.is_empty());
    }
}

/// (m, K, alpha): underdamped, critically damped and overdamped.
const DAMPED: [(f64, f64, f64); 6] = [
    (1.0, 1.0, 0.1),
    (1.0, 1.0, 0.5),
    (2.0, 8.0, 1.0),
    (1.0, 1.0, 1.0),
    (1.0, 1.0, 3.0),
    (1e5, 1.888e8, 1e7),
];

#[test]
fn the_damped_step_grows_beyond_its_limit_and_not_before() {
    // The limits are h = 2 alpha/K (underdamped) and h = 2/|lambda_max| (overdamped). 5 % below
    // them a body that starts at 1e4 f/K comes to rest, 5 % above them it overflows.
    for (mass, stiffness, damping) in DAMPED {
        let (w0, gamma) = ((stiffness / mass).sqrt(), damping / mass);
        let lambda = gamma + (gamma * gamma - w0 * w0).max(0.0).sqrt();
        let limit = if gamma < w0 {
            2.0 * damping / stiffness
        } else {
            2.0 / lambda
        };
        for side in [0.95, 1.05] {
            // So many steps suffice for the slow growth of weak damping, and do not underflow an
            // overdamped creep.
            let steps = if gamma < w0 { 40_000.0 } else { 300.0 };
            let step = side * limit;
            let (friction, start) = (1e-4 * stiffness, 1.0);
            let free = Free {
                mass,
                stiffness,
                damping,
                friction,
                start,
                step,
                steps,
            };
            assert_eq!(
                foretold(&free.scenario("discrete-vi")),
                side > 1.0,
                "{mass} {stiffness} {damping} {side}"
            );
            let (_, (x, v), summary) = free.path("discrete-vi");
            println!(
                "m {mass:e} K {stiffness:e} alpha {damping:e}: h {side} limits, x = {x:.3e}, lost {}",
                summary.diverged.len()
            );
            assert_eq!(
                summary.diverged.len(),
                usize::from(side > 1.0),
                "{mass} {stiffness} {damping} {side}"
            );
            if side < 1.0 {
                // An overdamped slip creeps towards f_d/K and need not end.
                assert!(
                    x.abs() <= 1.001 * friction / stiffness && v.abs() <= 1e-6 * w0 * start,
                    "{x} {v}"
                );
            }

            // The event-driven scheme has no step: it gives the exact damped motion about f_d/K, at
            // its first turning point or at a given time.
            let (events, _, summary) = free.path("event-driven");
            assert!(summary.diverged.is_empty());
            assert!(!foretold(&free.scenario("event-driven")));
            let centre = friction / stiffness;
            if gamma < w0 {
                let decrement = (-gamma * PI / (w0 * w0 - gamma * gamma).sqrt()).exp();
                let (mut amplitude, turns) = (start, turns(&events));
                assert!(turns.len() > 1);
                for turn in turns {
                    amplitude = (amplitude - centre) * decrement - centre;
                    assert!(
                        (turn - amplitude).abs() < 1e-13,
                        "{mass} {stiffness} {damping}: {turn} {amplitude}"
                    );
                }
            } else {
                assert!(
                    turns(&events).is_empty(),
                    "an overdamped body does not turn"
                );
            }
        }
    }
}

/// Everything that can be measured, in scenes whose step is too long: force, step and seed are drawn
/// (seed 51). A block is observed until its end, whatever becomes of its paths, and they are then
/// left out of every number: so no state of theirs, however far or none, is in the way.
#[test]
fn paths_that_diverge_are_counted_whatever_is_measured() {
    let text = stickslip::config::shipped("rho025").expect("shipped").text;
    let forces = [
        "-0.1*x^3",
        "-x^5",
        "exp(x)",
        "-0.2*xdot^3",
        "x*xdot",
        "-exp(x) + exp(-x)",
        "0",
    ];
    let measures = ["density", "laws", "energy", "spectrum", "events", "paths"]
        .map(|key| format!("record.{key}=true"));
    let (mut draws, mut diverged, mut measured) = (AddressedDraws::new(51, 0), 0, 0);
    let mut one_of = |count: usize| (draws.uniform() * count as f64) as usize;
    for round in 0..60 {
        let (force, step) = (
            forces[one_of(forces.len())],
            ["0.02", "0.1", "0.2", "0.4"][one_of(4)],
        );
        let scheme = ["discrete-vi", "corrected-vi"][one_of(2)];
        let mut set = vec![
            format!("force.expression=\"{force}\""),
            format!("time.step={step}"),
            format!("scheme.kind=\"{scheme}\""),
            format!("ensemble.seed={round}"),
            "time.end=200".to_string(),
            "time.output_step=20".to_string(),
            "ensemble.paths=64".to_string(),
            "record.trajectories=3".to_string(),
        ];
        set.extend(measures.clone());
        let overrides: Vec<Override> = set
            .iter()
            .map(|set| Override::set(set).expect("well formed"))
            .collect();
        // `corrected-vi` refuses steps at which its correction would be as large as the gap.
        let Ok(scenario) = Scenario::parse("rho025", text, &overrides) else {
            continue;
        };
        measured += 1;
        let summary = scenario.plan().run(1);
        assert_eq!(summary.completed_paths, 64, "{set:?}");
        diverged += summary.diverged.len();
    }
    println!(
        "{diverged} of {} paths diverged, in {measured} scenes",
        measured * 64
    );
    assert!(
        measured > 30 && (500..measured * 64 - 500).contains(&diverged),
        "{diverged} in {measured}"
    );
}
