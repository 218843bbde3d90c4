//! Inputs that each path draws, against closed forms and against plain integrators of the same
//! realisation.
//!
//! Unless said otherwise, a statistic is compared with its closed form within 4.5 standard errors,
//! estimated from independent paths: each comparison fails with a probability of 7e-6.

use crate::common::{Keep, timeline};
use stickslip::engine::Run;
use stickslip::model::{EventKind, Problem, Series};
use stickslip::scenario::Scenario;
use stickslip::scheme::{EventDriven, Instant, Observer, Scheme, Segment, Simulate as _, Snapshot};
use stickslip::stats::Statistic;
use stickslip::sums::Measurement;

/// A free body of mass 1 from rest under the input `k`.
const FREE: &str = "oscillator = { mass = 1, stiffness = 0, force_per_temperature = 1 }
    temperature.harmonics = []
    initial.displacement = 0
    force.expression = \"k\"
    scheme.kind = \"event-driven\"\n";

#[track_caller]
fn scenario(text: &str) -> Scenario {
    Scenario::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// The statistics of a run.
#[track_caller]
fn statistics<const N: usize>(text: &str, of: [Statistic; N]) -> [Measurement; N] {
    let scenario = scenario(text);
    let run = Run::of(&scenario).without_bias().simulate().expect("a run");
    of.map(|statistic| {
        let found = run[statistic];
        Measurement {
            estimate: found.estimate,
            standard_error: found.standard_error,
            low: found.low,
            high: found.high,
        }
    })
}

#[track_caller]
fn assert_is(what: &str, found: Measurement, right: f64) {
    let errors = (found.estimate - right) / found.standard_error;
    assert!(
        errors.abs() < 4.5 && found.standard_error < 0.05 * right.abs().max(0.02),
        "{what}: {} +- {} for {right}",
        found.estimate,
        found.standard_error
    );
}

/// x' of a free body under kicks J of rate lambda, against friction f = a m, is the workload of an
/// M/G/1 queue. With r = lambda E[J]/a: share of the time at rest 1 - r, mean stick 1/lambda, mean
/// slip (E[J]/a)/(1 - r), drift lambda E[J^2]/(2 a (1 - r)) (Pollaczek and Khinchine). An impulse
/// exceeds any threshold, so f_s does not matter.
#[test]
fn kicks_of_a_free_body_are_a_queue() {
    let sizes = [
        ("size = 0.8\nsizes = \"fixed\"", 0.64),
        ("size = 0.8\nsizes = \"exponential\"", 1.28),
    ];
    for f_s in [1.0, 7.5] {
        for (size, square) in sizes {
            let text = format!(
                "{FREE}friction = {{ static = {f_s}, dynamic = 1 }}\ntime.end = 600
                 statistics.after = 60\nensemble.paths = 600
                 [input.k]\nprocess = \"shot\"\nrate = 0.5\nshape = \"kick\"\n{size}"
            );
            let (lambda, mean, a) = (0.5, 0.8, 1.0);
            let r = lambda * mean / a;
            let [rest, stick, sticks, drift] = statistics(
                &text,
                [
                    Statistic::StickingFraction,
                    Statistic::StickDurationMean,
                    Statistic::SticksPerPath,
                    Statistic::DriftVelocity,
                ],
            );
            assert_is("share at rest", rest, 1.0 - r);
            assert_is("mean stick", stick, 1.0 / lambda);
            // A stick and a slip take 1/lambda + (E[J]/a)/(1 - r) together.
            let cycle = 1.0 / lambda + mean / a / (1.0 - r);
            assert_is("sticks", sticks, 540.0 / cycle);
            let drift_velocity = lambda * square / (2.0 * a * (1.0 - r));
            assert_is("drift", drift, drift_velocity);
        }
    }
}

/// Under exponential kicks of mean j, x' in motion is exponential with mean j/(1 - r): its mean, its
/// mean square and the share of paths in motion, of 6 000 paths at t = 100.
#[test]
fn the_velocity_of_the_queue_is_exponential() {
    let scenario = scenario(&format!(
        "{FREE}friction = {{ static = 1.5, dynamic = 1 }}\ntime.end = 100\ntime.output_step = 100
         [input.k]\nprocess = \"shot\"\nrate = 0.5\nsize = 0.8\nsizes = \"exponential\""
    ));
    let numbers: Vec<u64> = (0..6000).collect();
    let mut keep = Keep::lanes(numbers.len());
    let simulation = scenario
        .scheme
        .simulation(&scenario.model, &scenario.timeline());
    assert!(simulation.simulate(1, &numbers, &mut keep).is_empty());
    let ends = keep.rows.iter().map(|rows| rows[1].2);
    let (mut moving, mut all) = (Vec::new(), Vec::new());
    for v in ends {
        all.push([f64::from(u8::from(v > 0.0)), 0.0]);
        if v > 0.0 {
            moving.push([v, v * v]);
        }
    }
    let [share, _] = means(&all);
    assert_is("share in motion", share, 0.4);
    let [mean, square] = means(&moving);
    let right: f64 = 0.8 / 0.6;
    assert_is("x'", mean, right);
    assert_is("x'^2", square, 2.0 * right * right);
}

/// Null: the 95 % intervals of the queue above hold its closed forms. 24 seeds of 60 paths: of each
/// statistic at most 6 intervals miss (false alarm 2e-4), and the mean of its errors is within 4
/// standard errors of 0 (6e-5, in units of the reported standard errors).
#[test]
fn intervals_of_24_seeds_cover_the_queue() {
    let of = [
        Statistic::StickingFraction,
        Statistic::StickDurationMean,
        Statistic::SticksPerPath,
        Statistic::DriftVelocity,
    ];
    let right = [0.6, 2.0, 540.0 / (2.0 + 0.8 / 0.6), 0.5 * 1.28 / 1.2];
    let mut misses = [0; 4];
    let mut errors = [0.0; 4];
    for seed in 1..=24 {
        let text = format!(
            "{FREE}friction = {{ static = 1.5, dynamic = 1 }}\ntime.end = 600\nstatistics.after = 60
             ensemble = {{ paths = 60, seed = {seed} }}
             [input.k]\nprocess = \"shot\"\nrate = 0.5\nsize = 0.8\nsizes = \"exponential\""
        );
        for (i, found) in statistics(&text, of).into_iter().enumerate() {
            misses[i] += u32::from(!(found.low..=found.high).contains(&right[i]));
            errors[i] += (found.estimate - right[i]) / found.standard_error;
        }
    }
    println!("misses {misses:?}, errors {errors:?}");
    assert!(misses.into_iter().all(|misses| misses <= 6), "{misses:?}");
    let is_near = |sum: &f64| sum.abs() < 4.0 * 24f64.sqrt();
    assert!(errors.iter().all(is_near), "{errors:?}");
}

/// The discrete scheme sees the same kicks: on each of 20 paths, x at the end differs from that of the
/// event-driven scheme by what a step is worth, which is a tenth with a tenth of the step.
#[test]
fn every_scheme_draws_the_same_kicks() {
    let text = |scheme: &str| {
        format!(
            "{}scheme.{scheme}friction = {{ static = 1.2, dynamic = 1 }}\ntime.end = 50
             [input.k]\nprocess = \"shot\"\nrate = 0.5\nsize = 1\nsizes = \"exponential\"",
            FREE.replace("scheme.kind = \"event-driven\"\n", "")
        )
    };
    let ends = |scheme: &str| {
        let scenario = scenario(&text(scheme));
        let mut keep = Keep::lanes(20);
        let paths: Vec<u64> = (0..20).collect();
        let simulation = scenario
            .scheme
            .simulation(&scenario.model, &scenario.timeline());
        assert!(simulation.simulate(1, &paths, &mut keep).is_empty());
        let last = keep.rows.iter().map(|rows| rows.last().expect("rows").1);
        last.collect::<Vec<f64>>()
    };
    let exact = ends("kind = \"event-driven\"\n");
    let far = |step: f64| {
        let others = ends(&format!("kind = \"discrete-vi\"\ntime.step = {step}\n"));
        let squares = exact.iter().zip(&others).map(|(a, b)| (a - b).powi(2));
        (squares.sum::<f64>() / exact.len() as f64).sqrt()
    };
    let [coarse, fine] = [far(0.01), far(0.001)];
    assert!(
        coarse < 0.5 && (6.0..14.0).contains(&(coarse / fine)),
        "{coarse} {fine}"
    );
}

/// Kicks of both signs, of rate lambda to infinity and lambda E[J^2] = 2 D, are white noise: the
/// density of x' is (a/2D) exp(-a |x'|/D), so E x'^2 = 2 (D/a)^2. At a finite rate it exceeds this by
/// a share of order lambda^(-1/2).
#[test]
fn many_kicks_of_both_signs_are_white_noise() {
    let (d, lambda): (f64, f64) = (0.5, 200.0);
    let sd = (2.0 * d / lambda).sqrt();
    let text = format!(
        "{FREE}friction = {{ static = 1, dynamic = 1 }}\ntime.end = 30\nensemble.paths = 1000
         [input.k]\nprocess = \"shot\"\nrate = {lambda}\nsize = 0\nsize_sd = {sd}\nsizes = \"normal\""
    );
    let scenario = scenario(&text);
    let run = Run::of(&scenario).without_bias().simulate().expect("a run");
    let array = run.array("velocity_sd").expect("there");
    let found = array[array.len() - 1];
    let right = 2f64.sqrt() * d;
    // 4.5 standard errors of a sd of 1 000 draws of a Laplace law are 16 %, and the rate adds 3 %.
    assert!((found / right - 1.0).abs() < 0.19, "{found} for {right}");
}

/// The velocity of a free body under a telegraph force +-F with rate lambda each way and friction f =
/// f_s = f_d < F: it never sticks, |x'| is exponential with mean (F^2 - f^2)/(2 lambda f m), and the
/// force is along the motion (F + f)/(2 F) of the time. Without a law of the velocity at a time, the
/// mean is that over time: of the distance per time.
#[test]
fn a_telegraph_drives_a_free_body_as_it_should() {
    let (big, f, lambda) = (2.0, 1.0, 0.5);
    let text = format!(
        "{FREE}friction = {{ static = {f}, dynamic = {f} }}\ntime.end = 400\nstatistics.after = 100
         ensemble.paths = 400
         [input.k]\nprocess = \"telegraph\"\nlow = -{big}\nhigh = {big}\nrate_up = {lambda}"
    );
    let [sticking, sticks] = statistics(
        &text,
        [Statistic::StickingFraction, Statistic::SticksPerPath],
    );
    assert!(
        sticking.estimate < 1e-9 && sticks.estimate == 0.0,
        "{sticking:?} {sticks:?}"
    );
    let ways = each_path(&scenario(&text), 400, 100.0);
    let [way, along] = means(&ways);
    let mean = (big * big - f * f) / (2.0 * lambda * f);
    assert_is("|x'|", way, mean);
    assert_is("along the motion", along, (big + f) / (2.0 * big));
}

/// A telegraph whose force stays below f_s never moves a body at rest.
#[test]
fn a_telegraph_below_the_threshold_moves_nothing() {
    let text = format!(
        "{FREE}friction = {{ static = 1.2, dynamic = 1 }}\ntime.end = 200\nensemble.paths = 50
         [input.k]\nprocess = \"telegraph\"\nlow = -1.19\nhigh = 1.19\nrate_up = 2"
    );
    let [slips] = statistics(&text, [Statistic::SlipsPerPath]);
    assert_eq!(slips.estimate, 0.0);
}

/// Of each path, the distance per time and the share of the time in which the force of the input is
/// along the motion, from a time on.
fn each_path(scenario: &Scenario, paths: u64, after: f64) -> Vec<[f64; 2]> {
    struct Ways {
        sums: Vec<[f64; 3]>,
        inputs: Vec<Problem>,
        after: f64,
    }
    impl Observer for Ways {
        fn follows(&self) -> bool {
            true
        }
        fn realised(&mut self, _: usize, model: &Problem) {
            self.inputs.push(model.clone());
        }
        fn segment(&mut self, lane: usize, segment: &Segment) {
            let middle = segment.start + 0.5 * segment.length;
            if middle > self.after && segment.start + segment.length <= 400.0 {
                let force = self.inputs[lane]
                    .user_force(middle, 0.0, 0.0)
                    .expect("a force");
                let sums = &mut self.sums[lane];
                sums[0] += segment.way.abs();
                sums[1] += segment.length;
                if force * segment.way > 0.0 {
                    sums[2] += segment.length;
                }
            }
        }
    }
    let numbers: Vec<u64> = (0..paths).collect();
    let mut ways = Ways {
        sums: vec![[0.0; 3]; numbers.len()],
        inputs: Vec::new(),
        after,
    };
    let simulation = scenario
        .scheme
        .simulation(&scenario.model, &scenario.timeline());
    assert!(simulation.simulate(1, &numbers, &mut ways).is_empty());
    ways.sums
        .iter()
        .map(|[way, time, along]| [way / time, along / time])
        .collect()
}

/// The means over paths with their standard errors.
fn means(of: &[[f64; 2]]) -> [Measurement; 2] {
    [0, 1].map(|i| {
        let n = of.len() as f64;
        let mean = of.iter().map(|row| row[i]).sum::<f64>() / n;
        let variance = of.iter().map(|row| (row[i] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let standard_error = (variance / n).sqrt();
        Measurement {
            estimate: mean,
            standard_error,
            low: f64::NAN,
            high: f64::NAN,
        }
    })
}

/// The variance of x and x' of a linear oscillator without friction under Kanai-Tajimi noise is the
/// integral of its spectrum times that of the oscillator, here by Simpson's rule.
#[test]
fn a_linear_oscillator_filters_kanai_tajimi_noise() {
    let (w, zeta, s0) = (4.0, 0.5, 0.3);
    let (k, alpha): (f64, f64) = (9.0, 0.6);
    let text = format!(
        "oscillator = {{ mass = 1, stiffness = {k}, damping = {alpha}, force_per_temperature = 1 }}
         temperature.harmonics = []\ninitial.displacement = 0\nforce.expression = \"a\"
         friction = {{ static = 0, dynamic = 0 }}\ntime.end = 20\nensemble.paths = 4000
         scheme.kind = \"event-driven\"
         [input.a]\nprocess = \"kanai-tajimi\"\nangular_frequency = {w}\ndamping_ratio = {zeta}
         intensity = {s0}\nstep = 0.01"
    );
    let spectrum = |omega: f64| {
        let r = omega / w;
        let ground = s0 * (1.0 + 4.0 * zeta * zeta * r * r)
            / ((1.0 - r * r).powi(2) + 4.0 * zeta * zeta * r * r);
        ground / ((k - omega * omega).powi(2) + (2.0 * alpha * omega).powi(2))
    };
    let integral = |of: &dyn Fn(f64) -> f64| {
        let n = 400_000;
        let h = 400.0 / f64::from(n);
        let weight = |i| match i {
            0 => 1.0,
            i if i == n => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        2.0 * h / 3.0
            * (0..=n)
                .map(|i| weight(i) * of(h * f64::from(i)))
                .sum::<f64>()
    };
    let run = Run::of(&scenario(&text))
        .without_bias()
        .simulate()
        .expect("a run");
    for (name, right) in [
        ("displacement_sd", integral(&spectrum).sqrt()),
        ("velocity_sd", integral(&|o| o * o * spectrum(o)).sqrt()),
    ] {
        let found = run.array(name).expect("there");
        let found = found[found.len() - 1];
        // 4.5 standard errors of a sd of 4 000 normals, and 0.2 % for the lines between samples.
        let bound = 4.5 / (2.0 * 4000f64).sqrt() + 0.002;
        assert!(
            (found / right - 1.0).abs() < bound,
            "{name}: {found} for {right}"
        );
    }
}

/// Campbell's theorem: a linear body with damping under one-sided pulses has the mean lambda E[J]
/// int h and the variance lambda E[J^2] int h^2, where h is its response to an impulse; for a free
/// body with damping, x' has h = exp(-t/tau)/m. Pulses of any shape have the same mean.
#[test]
fn pulses_without_friction_obey_campbells_theorem() {
    let (lambda, size): (f64, f64) = (3.0, 0.4);
    for (shape, variance) in [
        ("shape = \"kick\"", 0.5),
        // A decay of time constant s in series with that of the body, tau = 1: 1/(2 (1 + s)).
        ("shape = \"decay\"\nduration = 0.5\nstep = 0.01", 1.0 / 3.0),
        // A rectangle of length d: (d - 1 + exp(-d))/d^2.
        (
            "shape = \"rectangle\"\nduration = 0.5",
            0.106_530_659_712_633 / 0.25,
        ),
    ] {
        let text = format!(
            "oscillator = {{ mass = 1, stiffness = 0, damping = 0.5, force_per_temperature = 1 }}
             temperature.harmonics = []\ninitial.displacement = 0\nforce.expression = \"k\"
             friction = {{ static = 0, dynamic = 0 }}\ntime.end = 20\nensemble.paths = 4000
             scheme.kind = \"event-driven\"
             [input.k]\nprocess = \"shot\"\nrate = {lambda}\nsize = {size}\nsizes = \"exponential\"\n{shape}"
        );
        let run = Run::of(&scenario(&text))
            .without_bias()
            .simulate()
            .expect("a run");
        let last = |name: &str| {
            let array = run.array(name).expect("there");
            array[array.len() - 1]
        };
        let [mean, sd] = [last("velocity_mean"), last("velocity_sd")];
        let right = [
            lambda * size,
            (lambda * 2.0 * size * size * variance).sqrt(),
        ];
        let error = right[1] / 4000f64.sqrt();
        assert!(
            (mean - right[0]).abs() < 4.5 * error,
            "{shape}: {mean} for {}",
            right[0]
        );
        // The kurtosis is below 4, so the error of the sd is below sd/sqrt(1.3 n).
        let share = 4.5 / (1.3 * 4000f64).sqrt();
        assert!(
            (sd / right[1] - 1.0).abs() < share,
            "{shape}: {sd} for {}",
            right[1]
        );
    }
}

/// Every process with friction, damping and a spring, event by event, against a plain integrator of
/// the same realisation with steps of 2e-5: linear, with a cubic spring, and kicks with both.
#[test]
fn every_process_moves_the_body_as_a_plain_integrator_does() {
    let spectrum = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/physics/spectrum.csv");
    for process in [
        "process = \"telegraph\"\nlow = -1.5\nhigh = 2\nrate_up = 0.7\nrate_down = 0.4",
        "process = \"shot\"\nrate = 0.8\nsize = 2\nsizes = \"exponential\"\nshape = \"rectangle\"\nduration = 1.1",
        "process = \"shot\"\nrate = 0.8\nsize = 2\nsizes = \"normal\"\nsize_sd = 1\nshape = \"decay\"\nduration = 0.9\nstep = 0.02",
        "process = \"shot\"\nrate = 0.8\nsize = 0.3\nsizes = \"normal\"\nsize_sd = 1.5",
        "process = \"kanai-tajimi\"\nangular_frequency = 3\ndamping_ratio = 0.4\nintensity = 0.2\nstep = 0.05",
        "process = \"kanai-tajimi\"\nangular_frequency = 3\ndamping_ratio = 0.4\nintensity = 0.6\nstep = 0.05\nenvelope = \"min(1, t/4)*exp(-max(0, t - 12)/5)\"",
        "process = \"ornstein-uhlenbeck\"\nintensity = 2\nrelaxation_rate = 0.6\nstep = 0.05",
        &format!("process = \"spectrum\"\nfile = \"{spectrum}\"\nstep = 0.05"),
    ] {
        for cubic in [0.0, 0.15] {
            let force = match cubic {
                0.0 => "k".to_string(),
                cubic => format!("k - {cubic}*x^3"),
            };
            let text = format!(
                "oscillator = {{ mass = 1, stiffness = 0.8, damping = 0.1, force_per_temperature = 1 }}
                 temperature.harmonics = []\ninitial.displacement = 0\nforce.expression = \"{force}\"
                 friction = {{ static = 1.2, dynamic = 1 }}\ntime.end = 20\ntime.output_step = 0.5
                 scheme.kind = \"event-driven\"\n[input.k]\n{process}"
            );
            let scenario = scenario(&text);
            let mut keep = Keep::lanes(3);
            let simulation = scenario
                .scheme
                .simulation(&scenario.model, &scenario.timeline());
            assert!(simulation.simulate(5, &[0, 1, 2], &mut keep).is_empty());
            let mut slips = 0;
            for path in 0..3 {
                let input = scenario.model.random[0].realised(5, path, 20.0, None);
                let rows = plain(&input, cubic);
                for (row, [x, v]) in keep.rows[path as usize].iter().zip(&rows) {
                    let is_near = (row.1 - x).abs() < 2e-3 && (row.2 - v).abs() < 2e-3;
                    assert!(is_near, "{process}\n{force}, path {path}: {row:?} {x} {v}");
                }
                let events = keep.events[path as usize].iter();
                slips += events
                    .filter(|event| event.kind != EventKind::StickEntered)
                    .count();
            }
            assert!(slips > 9, "{process}: {slips} slips");
        }
    }
}

/// x and x' every 0.5 up to 20, by a plain integrator of x'' = k(t) - 0.8 x - c x^3 - 0.2 x' -
/// friction. A step takes the impulse of k in it, which is known from its samples.
fn plain(input: &Series, cubic: f64) -> Vec<[f64; 2]> {
    let (h, [f_s, f_d]) = (2e-5, [1.2, 1.0]);
    let (times, values) = (input.times(), input.values());
    // The integral of k up to a time in this piece.
    let mut before = vec![0.0];
    for i in 1..times.len() {
        let area = 0.5 * (values[i - 1] + values[i]) * (times[i] - times[i - 1]);
        before.push(before[i - 1] + area);
    }
    let mut piece = 0;
    let mut integral = |t: f64| {
        while piece + 2 < times.len() && times[piece + 1] <= t {
            piece += 1;
        }
        let after = t - times[piece];
        before[piece] + after * 0.5 * (values[piece] + input.on(piece, t))
    };
    let (mut x, mut v) = (0.0, 0.0f64);
    let mut rows = vec![[x, v]];
    let mut so_far = 0.0;
    for i in 1..=1_000_000u64 {
        let until = integral(i as f64 * h);
        let force = (until - so_far) / h - 0.8 * x - cubic * x * x * x - 0.2 * v;
        so_far = until;
        if v != 0.0 || force.abs() > f_s {
            let direction = if v == 0.0 { force.signum() } else { v.signum() };
            let mut next = v + h * (force - direction * f_d);
            // A kick against the motion turns it; friction alone stops it.
            if next * direction <= 0.0 {
                next +=
                    2.0 * direction * f_d * h * f64::from(u8::from(force * direction < -2.0 * f_s));
                let is_turned = force * direction < -2.0 * f_s && next * direction < 0.0;
                next = if is_turned { next } else { 0.0 };
            }
            x += 0.5 * h * (v + next);
            v = next;
        }
        if i % 25_000 == 0 {
            rows.push([x, v]);
        }
    }
    rows
}

/// Over 4 000 realisations, the mean, the variance and the covariance of the values at two times,
/// and mean and variance at t = 0, agree with the closed forms within 4.5 standard errors each (false
/// alarms, 7e-6): of a telegraph with unequal rates, of Ornstein-Uhlenbeck and Kanai-Tajimi noise, of
/// rectangles and decays, and of a spectrum, whose covariance is the sum of its lines.
#[test]
fn realisations_have_the_moments_of_their_law() {
    let spectrum = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/physics/spectrum.csv");
    let lag: f64 = 0.5;
    // Trapezoids of the rows of the file.
    let rows = [
        (0.05, 0.5 * 0.025),
        (0.1, 2.0 * 0.05),
        (0.15, 4.0 * 0.05),
        (0.2, 5.0 * 0.05),
        (0.25, 4.0 * 0.05),
        (0.3, 3.0 * 0.075),
        (0.4, 1.5 * 0.1),
        (0.5, 0.6 * 0.1),
        (0.6, 0.2 * 0.05),
    ];
    let line = |lag: f64| {
        let lines = rows.map(|(f, power)| power * (std::f64::consts::TAU * f * lag).cos());
        lines.iter().sum::<f64>()
    };
    // Shares of 1.5 and 3 per time: 2/3 of the time at -1, 1/3 at 2.
    let share = (1.5 / 4.5) * (3.0 / 4.5) * 9.0;
    let decays = 2.0 * 2.0 * 0.49 / (2.0 * 0.8);
    // Kanai-Tajimi with w = 4, zeta = 0.5 and S0 = 0.3: the integral of the spectrum.
    let ground = |lag: f64| {
        let at = |i: u32| {
            let omega = 1e-3 * (f64::from(i) + 0.5);
            let r = (omega / 4.0).powi(2);
            (1.0 + r) / ((1.0 - r).powi(2) + r) * (omega * lag).cos()
        };
        2.0 * 0.3 * 1e-3 * (0..2_000_000).map(at).sum::<f64>()
    };
    for (process, mean, variance, covariance) in [
        (
            "process = \"telegraph\"\nlow = -1\nhigh = 2\nrate_up = 1.5\nrate_down = 3",
            0.0,
            share,
            share * (-4.5 * lag).exp(),
        ),
        (
            "process = \"ornstein-uhlenbeck\"\nintensity = 2\nrelaxation_rate = 0.7\ndiffusion = 0.6\nstep = 0.01",
            0.0,
            4.0 * 0.36 / 1.4,
            4.0 * 0.36 / 1.4 * (-0.7 * lag).exp(),
        ),
        (
            "process = \"kanai-tajimi\"\nangular_frequency = 4\ndamping_ratio = 0.5\nintensity = 0.3\nstep = 0.01",
            0.0,
            std::f64::consts::PI * 0.3 * 4.0 * 2.0,
            ground(lag),
        ),
        (
            "process = \"shot\"\nrate = 2\nsize = 0.7\nsizes = \"exponential\"\nshape = \"rectangle\"\nduration = 1.1",
            1.4,
            2.0 * 0.98 / 1.1,
            2.0 * 0.98 * (1.1 - lag) / (1.1 * 1.1),
        ),
        (
            "process = \"shot\"\nrate = 2\nsize = 0.7\nsizes = \"exponential\"\nshape = \"decay\"\nduration = 0.8\nstep = 0.01",
            1.4,
            decays,
            decays * (-lag / 0.8).exp(),
        ),
        (
            &format!("process = \"spectrum\"\nfile = \"{spectrum}\"\nstep = 0.01"),
            0.0,
            line(0.0),
            line(lag),
        ),
    ] {
        let scenario = scenario(&format!(
            "{FREE}friction = {{ static = 1, dynamic = 1 }}\ntime.end = 12\n[input.k]\n{process}"
        ));
        let input = &scenario.model.random[0];
        let values = (0..4000).map(|path| {
            let series = input.realised(11, path, 12.0, None);
            [series.at(11.0), series.at(11.0 + lag), series.at(0.0)]
        });
        let values: Vec<[f64; 3]> = values.collect();
        let near = |what: &str, of: &dyn Fn(&[f64; 3]) -> f64, right: f64| {
            let rows: Vec<[f64; 2]> = values.iter().map(|pair| [of(pair), 0.0]).collect();
            let found = means(&rows)[0];
            let errors = (found.estimate - right) / found.standard_error;
            assert!(
                errors.abs() < 4.5,
                "{process}: {what} {found:?} for {right}"
            );
        };
        near("mean", &|pair| pair[0], mean);
        if !process.contains("shot") {
            // Pulses begin at t = 0; the others are stationary from there on.
            near("mean at t = 0", &|pair| pair[2], mean);
            near(
                "variance at t = 0",
                &|pair| (pair[2] - mean).powi(2),
                variance,
            );
        }
        near("variance", &|pair| (pair[0] - mean).powi(2), variance);
        near(
            "covariance",
            &|pair| (pair[0] - mean) * (pair[1] - mean),
            covariance,
        );
        let moments = input.process.moments().expect("known");
        assert!(
            (moments.mean - mean).abs() < 1e-12,
            "{process}: {moments:?}"
        );
        assert!(
            (moments.sd.powi(2) / variance - 1.0).abs() < 1e-9,
            "{process}: {moments:?}"
        );
    }
}

/// Path n takes column n of a file, and with `reuse` begins again after the last; without it, fewer
/// columns than paths are an error. The text of the scenario describes the same file, and the samples
/// that a file of results holds are enough.
#[test]
fn a_file_has_a_realisation_for_each_path() {
    let file = concat!(env!("CARGO_TARGET_TMPDIR"), "/realisations.csv");
    std::fs::write(file, "time,one,two,three\n0,1,2,3\n5,4,-5,6\n20,0,0,0.5\n").expect("a file");
    let text = |keys: &str| {
        format!(
            "{FREE}friction = {{ static = 1, dynamic = 1 }}\ntime.end = 20\n{keys}
             [input.k]\nprocess = \"realisations\"\nfile = \"{file}\""
        )
    };
    let three = scenario(&text("ensemble.paths = 3"));
    let five = text("ensemble.paths = 5");
    let reused = scenario(&format!("{five}\nreuse = true"));
    let columns = [[1.0, 4.0, 0.0], [2.0, -5.0, 0.0], [3.0, 6.0, 0.5]];
    for (scenario, paths) in [(&three, 3), (&reused, 5)] {
        let again = self::scenario(&scenario.to_toml());
        let text = scenario.to_toml().replace("realisations.csv", "gone.csv");
        let stored = Scenario::parse_stored("test", &text, &[], &scenario.samples());
        let stored = stored.expect("the samples are in the file");
        for of in [scenario, &again, &stored] {
            for path in 0..paths {
                let series = of.model.random[0].realised(1, path, 20.0, None);
                assert_eq!(series.times(), [0.0, 5.0, 20.0]);
                assert_eq!(series.values(), columns[path as usize % 3]);
            }
        }
    }
    let error = Scenario::parse("test", &five, &[])
        .expect_err("too few")
        .to_string();
    assert!(error.contains("3 realisations, fewer than"), "{error}");
    let holes = file.replace(".csv", "-holes.csv");
    std::fs::write(&holes, "time,one,two\n0,1,2\n5,4,\n20,0,0\n").expect("a file");
    let error = Scenario::parse(
        "test",
        &text("ensemble.paths = 2").replace(file, &holes),
        &[],
    );
    let error = error.expect_err("a hole").to_string();
    assert!(error.contains("`two`"), "{error}");
}

/// A realisation is a function of seed, path, name and time: not of the end, of other inputs or of
/// what else is in the scenario.
#[test]
fn a_realisation_depends_on_nothing_else() {
    let of = |text: &str, end: f64| -> Series {
        let both = ["\"k\"", "\"k + other\""][usize::from(text.contains("other"))];
        let body = FREE.replace("\"k\"", both);
        let scenario = scenario(&format!(
            "{body}friction = {{ static = 1, dynamic = 1 }}\ntime.end = {end}\n{text}"
        ));
        let input = scenario
            .model
            .random
            .iter()
            .find(|input| input.name == "input.k");
        input.expect("there").realised(3, 4, end, None)
    };
    for process in [
        "process = \"telegraph\"\nrate_up = 0.7",
        "process = \"shot\"\nrate = 0.8\nsize = 2\nshape = \"rectangle\"\nduration = 0.4",
        "process = \"kanai-tajimi\"\nangular_frequency = 3\ndamping_ratio = 0.4\nintensity = 0.2\nstep = 0.05",
        "process = \"ornstein-uhlenbeck\"\nintensity = 2\nstep = 0.05",
    ] {
        let alone = of(&format!("[input.k]\n{process}"), 30.0);
        let long = of(&format!("[input.k]\n{process}"), 60.0);
        let other = "[input.other]\nprocess = \"telegraph\"\nrate_up = 1";
        let beside = of(&format!("[input.k]\n{process}\n{other}"), 30.0);
        for t in (0..300).map(|i| 0.1 * f64::from(i)) {
            assert_eq!(alone.at(t).to_bits(), beside.at(t).to_bits(), "{process}");
            assert!((alone.at(t) - long.at(t)).abs() < 1e-9, "{process} at {t}");
        }
    }
}

/// Seed, path and name each change a realisation; an envelope multiplies its samples.
#[test]
fn seed_path_and_name_select_a_realisation() {
    for process in [
        "process = \"telegraph\"\nrate_up = 0.7",
        "process = \"shot\"\nrate = 0.8\nsize = 2\nshape = \"rectangle\"\nduration = 0.4",
        "process = \"ornstein-uhlenbeck\"\nintensity = 2\nstep = 0.05",
    ] {
        let text = format!(
            "{}friction = {{ static = 1, dynamic = 1 }}\ntime.end = 30\n[input.k]\n{process}\n[input.l]\n{process}",
            FREE.replace("\"k\"", "\"k + l\"")
        );
        let scenario = scenario(&text);
        let of = |input: usize, seed, path| {
            let series = scenario.model.random[input].realised(seed, path, 30.0, None);
            (0..300)
                .map(|i| series.at(0.1 * f64::from(i)))
                .collect::<Vec<f64>>()
        };
        let first = of(0, 1, 0);
        assert_eq!(first, of(0, 1, 0), "{process}");
        for (what, other) in [
            ("path", of(0, 1, 1)),
            ("seed", of(0, 2, 0)),
            ("name", of(1, 1, 0)),
        ] {
            assert_ne!(first, other, "{process}: {what}");
        }
    }
    let of = |envelope: &str| {
        let scenario = scenario(&format!(
            "{FREE}friction = {{ static = 1, dynamic = 1 }}\ntime.end = 30\n[input.k]
             process = \"ornstein-uhlenbeck\"\nintensity = 2\nstep = 0.05\n{envelope}"
        ));
        scenario.model.random[0].realised(1, 0, 30.0, None)
    };
    let (plain, shaped) = (of(""), of("envelope = \"t*exp(-t/5)\""));
    for (t, (value, shaped)) in plain
        .times()
        .iter()
        .zip(plain.values().iter().zip(shaped.values()))
    {
        let right = value * t * (-t / 5.0).exp();
        assert!(
            (shaped - right).abs() <= 1e-12 * right.abs(),
            "{t}: {shaped} {right}"
        );
    }
}

/// For a scheme with a step, kicks are their mean over the step in which they lie: the impulse of
/// each step is that of the pulses of a scheme without one.
#[test]
fn a_kick_is_the_mean_over_its_step() {
    let scenario = scenario(&format!(
        "{FREE}friction = {{ static = 1, dynamic = 1 }}\ntime.end = 50\n[input.k]
         process = \"shot\"\nrate = 0.8\nsize = 2\nsizes = \"exponential\""
    ));
    let input = &scenario.model.random[0];
    let step = 0.1;
    let (exact, means) = (
        input.realised(1, 0, 50.0, None),
        input.realised(1, 0, 50.0, Some(step)),
    );
    let mut found = vec![0.0; means.times().len()];
    for i in 1..exact.times().len() {
        let [from, to] = [exact.times()[i - 1], exact.times()[i]];
        let mean = 0.5 * (exact.values()[i - 1] + exact.values()[i]);
        if mean != 0.0 && from < 50.0 {
            found[(from / step) as usize] += mean * (to - from);
        }
    }
    for (n, (impulse, mean)) in found.iter().zip(means.values()).enumerate() {
        assert!(
            (impulse - mean * step).abs() < 1e-5,
            "{n}: {impulse} {mean}"
        );
    }
    assert!(found.iter().filter(|impulse| **impulse > 0.0).count() > 20);
}

/// Kicks and a telegraph beside noise: the means and standard deviations of x at the end of
/// event-driven paths agree with those of `corrected-vi` with steps of 1e-3, within 4.5 standard
/// errors and the step.
#[test]
fn random_inputs_act_beside_noise_in_every_scheme() {
    for input in [
        "process = \"shot\"\nrate = 0.4\nsize = 1.5\nsizes = \"exponential\"",
        "process = \"telegraph\"\nlow = -1.5\nhigh = 2\nrate_up = 0.7",
    ] {
        let ends = |scheme: &str| {
            let text = format!(
                "oscillator = {{ mass = 1, stiffness = 0.5, damping = 0.1, force_per_temperature = 1 }}
                 friction = {{ static = 1.2, dynamic = 1 }}\ninitial.displacement = 0
                 temperature.noise = {{ intensity = 0.6 }}\ntemperature.harmonics = []
                 force.expression = \"k\"\ntime.end = 12\nensemble.paths = 1500\n{scheme}
                 [input.k]\n{input}"
            );
            let run = Run::of(&scenario(&text))
                .without_bias()
                .simulate()
                .expect("a run");
            [Statistic::DisplacementEndMean, Statistic::DisplacementEndSd].map(|of| run[of])
        };
        let exact = ends("scheme.kind = \"event-driven\"");
        let steps = ends("scheme.kind = \"corrected-vi\"\ntime.step = 1e-3");
        for (a, b) in exact.iter().zip(&steps) {
            let error = a.standard_error.hypot(b.standard_error);
            assert!(
                (a.estimate - b.estimate).abs() < 4.5 * error + 0.01,
                "{input}: {a:?} {b:?}"
            );
            assert!(error < 0.1, "{a:?}");
        }
    }
}

/// With a step, without one, in lanes of a block and alone, the path is the same.
#[test]
fn a_path_is_the_same_alone_and_in_a_block() {
    let text = format!(
        "{FREE}friction = {{ static = 1.2, dynamic = 1 }}\ntime.end = 20
         [temperature.noise]\nintensity = 0.3\n[input.k]\nprocess = \"telegraph\"\nlow = -2\nhigh = 2\nrate_up = 0.5"
    );
    let scenario = scenario(&text);
    let simulation =
        Scheme::from(EventDriven::default()).simulation(&scenario.model, &timeline(20.0, 1.0));
    let mut all = Keep::lanes(12);
    simulation.simulate(1, &(0..12).collect::<Vec<_>>(), &mut all);
    let mut alone = Keep::lanes(1);
    simulation.simulate(1, &[7], &mut alone);
    assert!(alone.rows[0].len() == 21 && alone.events[0].len() > 4);
    assert_eq!(
        (&all.rows[7], &all.events[7]),
        (&alone.rows[0], &alone.events[0])
    );
}

/// A run may be stopped at any moment, also in the last path: nothing is then reported of an incomplete
/// one, and nothing fails.
#[test]
fn paths_with_random_inputs_may_be_stopped_at_any_moment() {
    struct Stops {
        asked: std::cell::Cell<u64>,
        after: u64,
        ends: u64,
    }
    impl Observer for Stops {
        fn snapshot(&mut self, _: Instant, _: Snapshot<'_>) {
            self.ends += 1;
        }
        fn is_stopped(&self) -> bool {
            self.asked.set(self.asked.get() + 1);
            self.asked.get() > self.after
        }
    }
    let text = format!(
        "{}friction = {{ static = 1.2, dynamic = 1 }}\ntime.end = 20\ntime.step = 0.01
         [input.k]\nprocess = \"telegraph\"\nlow = -2\nhigh = 2\nrate_up = 0.5",
        FREE.replace("event-driven", "discrete-vi")
    );
    let scenario = scenario(&text);
    let simulation = scenario
        .scheme
        .simulation(&scenario.model, &scenario.timeline());
    let run = |after: u64| {
        let mut stops = Stops {
            asked: 0.into(),
            after,
            ends: 0,
        };
        simulation.simulate(1, &[0, 1, 2], &mut stops);
        (stops.ends, stops.asked.get())
    };
    let (all, asked) = run(u64::MAX);
    assert!(all > 100 && asked > 100, "{all} {asked}");
    for after in 0..asked {
        assert_eq!(run(after).0, 0, "stopped after {after} of {asked}");
    }
}
