//! Two noises at once, compared with results that do not depend on how the scheme adds them.
//!
//! False-alarm rate: each of 25 comparisons is made at 4.5 standard errors, which a normal number
//! exceeds once in 150 000 times. Sample sizes are with each test; seeds are fixed.

use crate::common::{Keep, paper};
use rand_distr::{Distribution as _, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng as _;
use stickslip::model::{Drive, EventKind, Friction, InitialNoise, OrnsteinUhlenbeck, Problem};
use stickslip::scheme::{
    DEFAULT_TOLERANCE, DrivenOscillator, EventDrivenSimulation, HarmonicResponse,
    QuasiStaticSimulation, Simulate, Timeline,
};

const FALSE_ALARM: f64 = 4.5;

fn noise(relaxation_rate: f64, diffusion: f64, initial: InitialNoise) -> OrnsteinUhlenbeck {
    OrnsteinUhlenbeck {
        intensity: 1.0,
        relaxation_rate,
        diffusion,
        initial,
    }
}

fn timeline(end: f64, output_step: f64) -> Timeline {
    Timeline {
        end,
        output_step,
        period: None,
        after: 0.0,
    }
}

fn assert_near(name: &str, got: f64, want: f64, error: f64) {
    let z = (got - want) / error;
    println!("{name}: {got:.6} for {want:.6} ({z:+.1})");
    assert!(
        z.abs() <= FALSE_ALARM,
        "{name}: {got} for {want} +- {error}"
    );
}

/// Null hypothesis: without friction the model is linear, so the mean and the covariance of (x, x')
/// are sums over the effects of each noise alone, each of which is one exact transition over the
/// whole time. T is stationary noise around the harmonic. Sample size: 60 000 paths, whose end is
/// inside a cell.
#[test]
fn without_friction_the_effects_of_two_noises_add_up() {
    let (end, paths) = (8.037, 60_000);
    let mut model = paper(0.25, 1.0);
    model.friction = Friction {
        static_force: 0.0,
        dynamic_force: 0.0,
    };
    model.oscillator.damping = 0.1;
    let [fast, slow] = [
        noise(1.5, 0.3, InitialNoise::At(0.0)),
        noise(0.06, 0.1, InitialNoise::At(0.0)),
    ];
    model.temperature.noises = vec![fast, slow];
    let scheme = EventDrivenSimulation::new(&model, &timeline(end, 1.0), DEFAULT_TOLERANCE);
    let mut ends = Vec::new();
    for first in (0..paths).step_by(250) {
        let numbers: Vec<u64> = (first..first + 250).collect();
        let mut kept = End::default();
        assert!(scheme.simulate(5, &numbers, &mut kept).is_empty());
        ends.extend(kept.0);
    }
    let mut response = [HarmonicResponse {
        x: (0.0, 0.0),
        v: (0.0, 0.0),
        turn: (1.0, 0.0),
    }];
    let laws = [fast, slow].map(|noise| {
        DrivenOscillator::new(
            1.0,
            0.1,
            1.0,
            noise.relaxation_rate,
            6.0 * noise.diffusion,
            &[0.25],
        )
        .transition(end, &mut response)
    });
    let mean_x = 6.0 * laws[0].x[0] + 6.0 * response[0].x.0;
    let mean_v = 6.0 * laws[0].v[0] + 6.0 * response[0].v.0;
    let [vv, vx, xx] = [3, 4, 5].map(|i| laws[0].covariance[i] + laws[1].covariance[i]);
    let tt: f64 = [fast, slow]
        .iter()
        .map(|n| n.stationary_sd().powi(2) * -libm::expm1(-2.0 * n.relaxation_rate * end))
        .sum();
    let mean_t = (0.25 * end).cos();
    let n = paths as f64;
    let mean = |f: &dyn Fn(f64, f64, f64) -> f64| {
        ends.iter()
            .map(|&(x, v, t)| f(x - mean_x, v - mean_v, t - mean_t))
            .sum::<f64>()
            / n
    };
    let root = n.sqrt();
    assert_near("mean x", mean(&|x, _, _| x), 0.0, xx.sqrt() / root);
    assert_near("mean v", mean(&|_, v, _| v), 0.0, vv.sqrt() / root);
    assert_near("mean T", mean(&|_, _, t| t), 0.0, tt.sqrt() / root);
    assert_near("var x", mean(&|x, _, _| x * x), xx, 2f64.sqrt() * xx / root);
    assert_near("var v", mean(&|_, v, _| v * v), vv, 2f64.sqrt() * vv / root);
    assert_near("var T", mean(&|_, _, t| t * t), tt, 2f64.sqrt() * tt / root);
    assert_near(
        "cov",
        mean(&|x, v, _| x * v),
        vx,
        (xx * vv + vx * vx).sqrt() / root,
    );
}

/// Keeps x, x' and T at the end.
#[derive(Default)]
struct End(Vec<(f64, f64, f64)>);

impl stickslip::scheme::Observer for End {
    fn event(&mut self, _: usize, _: stickslip::model::Event) {}
    fn snapshot(
        &mut self,
        instant: stickslip::scheme::Instant,
        s: stickslip::scheme::Snapshot<'_>,
    ) {
        if instant == stickslip::scheme::Instant::End {
            self.0.extend(
                (0..s.displacement.len())
                    .map(|i| (s.displacement[i], s.velocity[i], s.temperature[i])),
            );
        }
    }
}

/// A body without harmonics, with K beta = 1 and f_s = 1.
fn still(fast: OrnsteinUhlenbeck, slow: OrnsteinUhlenbeck) -> Problem {
    let mut model = paper(0.25, 1.0);
    model.oscillator.drive = Drive::Dilatation(1.0);
    model.friction = Friction {
        static_force: 1.0,
        dynamic_force: 0.9,
    };
    model.temperature.harmonics.clear();
    model.temperature.noises = vec![fast, slow];
    model.initial_displacement = 0.0;
    model
}

/// Null hypothesis: the time at which n1 + n2 first leaves [-1, 1], up to `end`, has the same law
/// in the scheme and in a loop of small steps. The thresholds of the loop are moved by 0.5826 s
/// sqrt(step), which corrects for crossings between steps (Broadie, Glasserman and Kou,
/// Mathematical Finance 7, 1997). One noise has a correlation time of hours and one of days; both
/// are stationary. Sample size: 10 000 paths of each.
#[test]
fn the_sum_leaves_the_stick_band_when_small_steps_say() {
    let (paths, end, step) = (10_000, 60.0, 2e-3);
    let [fast, slow] =
        [(2.0, 0.55), (0.07, 0.12)].map(|(theta, s)| noise(theta, s, InitialNoise::Stationary));
    let model = still(fast, slow);
    let line = timeline(end, 60.0);

    let mut normals = {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(20);
        move || -> f64 { StandardNormal.sample(&mut random) }
    };
    let moves = [fast, slow].map(|n| {
        let decay = (-n.relaxation_rate * step).exp();
        (decay, n.stationary_sd() * (1.0 - decay * decay).sqrt())
    });
    let band = 1.0 - 0.5826 * fast.diffusion.hypot(slow.diffusion) * step.sqrt();
    let expected: Vec<f64> = (0..paths)
        .map(|_| {
            let mut n = [fast, slow].map(|n| n.stationary_sd() * normals());
            let mut steps = 0;
            // At the start no step lies behind, so the threshold is not moved.
            while (n[0] + n[1]).abs() < if steps == 0 { 1.0 } else { band }
                && f64::from(steps) * step < end
            {
                n = [
                    moves[0].0 * n[0] + moves[0].1 * normals(),
                    moves[1].0 * n[1] + moves[1].1 * normals(),
                ];
                steps += 1;
            }
            f64::from(steps) * step
        })
        .collect();

    let event_driven = EventDrivenSimulation::new(&model, &line, DEFAULT_TOLERANCE);
    let quasi_static = QuasiStaticSimulation::new(&model, &line, DEFAULT_TOLERANCE);
    let found = [
        first_exits(&event_driven, end, paths),
        first_exits(&quasi_static, end, paths),
    ];
    for (name, found) in ["event-driven", "quasi-static"].into_iter().zip(&found) {
        for (law, f) in laws() {
            let (a, b) = (moments(found, f), moments(&expected, f));
            assert_near(&format!("{name}, {law}"), a.0, b.0, a.1.hypot(b.1));
        }
    }
}

/// A function of the time whose mean is compared, with its name.
type Law = (&'static str, fn(f64) -> f64);

fn laws() -> [Law; 5] {
    [
        ("mean", |t| t),
        ("left at once", |t| f64::from(u8::from(t == 0.0))),
        ("left by 1", |t| f64::from(u8::from(t < 1.0))),
        ("left by 5", |t| f64::from(u8::from(t < 5.0))),
        ("left by 20", |t| f64::from(u8::from(t < 20.0))),
    ]
}

fn moments(values: &[f64], f: impl Fn(f64) -> f64) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().map(|&t| f(t)).sum::<f64>() / n;
    let variance = values.iter().map(|&t| (f(t) - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

fn first_exits(scheme: &impl Simulate, end: f64, paths: u64) -> Vec<f64> {
    let mut all = Vec::new();
    for first in (0..paths).step_by(250) {
        let numbers: Vec<u64> = (first..first + 250).collect();
        let mut kept = Keep::lanes(250);
        assert!(scheme.simulate(9, &numbers, &mut kept).is_empty());
        all.extend(
            kept.events
                .iter()
                .map(|events| events.first().map_or(end, |event| event.time)),
        );
    }
    all
}

/// Null hypothesis: two noises of the same relaxation rate are one noise whose variance is the sum
/// of both, in the scene of the paper. Sample size: 8000 paths on either side.
#[test]
fn two_noises_of_one_memory_are_one() {
    let one = paper(0.25, 0.25);
    let mut two = one.clone();
    two.temperature.noises = [0.15, 0.2]
        .map(|intensity| OrnsteinUhlenbeck {
            intensity,
            ..one.temperature.noises[0]
        })
        .to_vec();
    let [one, two] = [one, two].map(|model| {
        let scheme = EventDrivenSimulation::new(&model, &timeline(60.0, 60.0), DEFAULT_TOLERANCE);
        let mut sticks = Vec::new();
        for first in (0..8000).step_by(250) {
            let numbers: Vec<u64> = (first..first + 250).collect();
            let mut kept = Keep::lanes(250);
            assert!(scheme.simulate(3, &numbers, &mut kept).is_empty());
            for (events, rows) in kept.events.iter().zip(&kept.rows) {
                let entered = events
                    .iter()
                    .filter(|event| event.kind == EventKind::StickEntered)
                    .count();
                let first = events.first().map_or(60.0, |event| event.time);
                sticks.push([entered as f64, first, rows[rows.len() - 1].1]);
            }
        }
        sticks
    });
    for (i, name) in ["sticks a path", "first stick", "x(60)"]
        .into_iter()
        .enumerate()
    {
        let column =
            |all: &[[f64; 3]]| moments(&all.iter().map(|path| path[i]).collect::<Vec<_>>(), |x| x);
        let (a, b) = (column(&one), column(&two));
        assert_near(name, b.0, a.0, a.1.hypot(b.1));
    }
}
