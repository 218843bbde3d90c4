//! Densities are exact times, works are sums over steps, and spectra are plain sums over rows.

use super::measures::run;
use stickslip::dataset::{Column, Recorder};
use stickslip::engine::Run;
use stickslip::scenario::Scenario;
use stickslip::scheme::{Observer, Segment, Simulate as _};
use stickslip::stats::{BlockObserver, Densities, DensityCurve, Record, Statistic, Summary};
use stickslip::sums::Replicate;

const NOISE: &str = "temperature.noise = { intensity = 0.5, relaxation_rate = 1, diffusion = 1 }";

/// Lines of scenes for m = K = c = 1 and alpha = 0.1.
const PLAIN: &str = "friction = { static = 1.2, dynamic = 1.0 }";
const LOAD: &str = "friction = { static = 1.2, dynamic = 1.0, load = \"1 + 0.3*sin(2*x)\" }";

/// A scenario of one path over this time, of which the part from `after` on counts.
fn scene(name: &str, lines: &str, seed: u64, [after, end]: [f64; 2]) -> Scenario {
    let text = format!(
        "oscillator = {{ mass = 1, stiffness = 1, damping = 0.1, force_per_temperature = 1 }}
         initial = {{ displacement = 0, velocity = 0 }}
         temperature.harmonics = [{{ amplitude = 3, angular_frequency = 0.5 }}]
         ensemble = {{ paths = 1, seed = {seed} }}
         record = {{ energy = true, density = true }}
         time.end = {end:?}
         time.output_step = 100
         statistics.after = {after:?}
         {lines}"
    );
    Scenario::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The time below an edge.
fn below(curve: &DensityCurve, edge: f64) -> f64 {
    let bins = curve.edges.windows(2).zip(&curve.density);
    bins.filter(|(pair, _)| pair[1] <= edge)
        .map(|(pair, density)| density * (pair[1] - pair[0]))
        .sum()
}

fn densities(summary: &Summary) -> &Densities {
    summary.densities.as_ref().expect("asked for")
}

/// Keeps the motion of each path in the order in which it arrives.
struct Kept(Vec<Vec<Segment>>);

impl Observer for Kept {
    fn follows(&self) -> bool {
        true
    }

    fn segment(&mut self, lane: usize, segment: &Segment) {
        self.0[lane].push(*segment);
    }
}

/// The largest difference between the share of time below each edge and a function of the edge.
fn off(curve: &DensityCurve, share: impl Fn(f64) -> f64) -> f64 {
    let ends = curve
        .edges
        .iter()
        .map(|edge| (below(curve, *edge) - share(*edge)).abs());
    ends.fold(0.0, f64::max)
}

/// A body without a spring that friction stops: x = 6.1 t - t^2/2 and x' = 6.1 - t until t = 6.1, of
/// which the time from t = 0.37 on counts. Then it rests until t = 9.5.
#[test]
fn densities_of_a_free_flight_are_its_closed_form() {
    let text = "oscillator = { mass = 1, stiffness = 0, damping = 0, force_per_temperature = 1 }
         friction = { static = 1, dynamic = 1 }
         initial = { displacement = 0, velocity = 6.1 }
         time = { end = 9.5, output_step = 10 }
         statistics.after = 0.37
         record.density = true
         ensemble.paths = 3
         scheme.kind = \"event-driven\"";
    let summary =
        run(&Scenario::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}")));
    let found = densities(&summary);
    let counted = 9.5 - 0.37;
    let flight = |t: f64| (t.clamp(0.37, 6.1) - 0.37) / counted;
    let arrives = |x: f64| 6.1 - (6.1 * 6.1 - 2.0 * x).max(0.0).sqrt();
    let at_x = |x: f64| if x > 18.605 { 1.0 } else { flight(arrives(x)) };
    assert!(
        off(&found.displacement, at_x) < 1e-9,
        "{}",
        off(&found.displacement, at_x)
    );
    let at_v = |v: f64| flight(6.1) - flight(6.1 - v);
    assert!(
        off(&found.velocity, at_v) < 1e-9,
        "{}",
        off(&found.velocity, at_v)
    );
    assert!((found.at_rest - 3.4 / counted).abs() < 1e-9);
    for ((i, j), density) in found.joint.indexed_iter() {
        let [[a, b], [low, high]] =
            [(0, i), (1, j)].map(|(axis, k)| [0, 1].map(|n| found.joint_edges[axis][k + n]));
        let (from, to) = (arrives(a).max(6.1 - high), arrives(b).min(6.1 - low));
        let expected = (flight(to) - flight(from)).max(0.0);
        assert!(
            (density * (b - a) * (high - low) - expected).abs() < 1e-9,
            "{a} {low}: {density}, not {expected}"
        );
    }
}

/// x = 2 cos t, without friction: the time below x from any time to any other is a sum of arc cosines,
/// which turning points at edges of bins, as here at -2 and 2, do not disturb.
#[test]
fn densities_of_a_sine_are_its_closed_form() {
    let text = "oscillator = { mass = 1, stiffness = 1, damping = 0, force_per_temperature = 1 }
         friction = { static = 0, dynamic = 0 }
         initial.displacement = 2
         time = { end = 17.3, output_step = 20 }
         statistics.after = 1.234
         record.density = true
         ensemble.paths = 1
         scheme.kind = \"event-driven\"";
    let summary =
        run(&Scenario::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}")));
    let found = densities(&summary);
    // The time until t during which cos is below a share.
    let below = |share: f64, t: f64| {
        let (turns, rest) = (
            (t / std::f64::consts::TAU).floor(),
            t.rem_euclid(std::f64::consts::TAU),
        );
        let first = share.clamp(-1.0, 1.0).acos();
        let length = std::f64::consts::TAU - 2.0 * first;
        turns * length + (rest - first).clamp(0.0, length)
    };
    let quarter = 0.5 * std::f64::consts::PI;
    let at_x = |x: f64| (below(x / 2.0, 17.3) - below(x / 2.0, 1.234)) / (17.3 - 1.234);
    // x' = -2 sin t = 2 cos(t + pi/2).
    let at_v = |v: f64| {
        (below(v / 2.0, 17.3 + quarter) - below(v / 2.0, 1.234 + quarter)) / (17.3 - 1.234)
    };
    let [x, v] = [off(&found.displacement, at_x), off(&found.velocity, at_v)];
    assert!(x < 1e-9 && v < 1e-9, "{x} {v}");
}

/// From x = -3 without friction at alpha = 50 m w0, a body settles within 1/l2 = 0.01 and returns within
/// 1/l1 = 100: x = -3 (l2 e^{-l1 t} - l1 e^{-l2 t})/(l2 - l1). x' grows until 0.092 and then decays.
#[test]
fn densities_of_a_strongly_damped_return_are_its_closed_form() {
    let text = "oscillator = { mass = 1, stiffness = 1, damping = 50, force_per_temperature = 1 }
         friction = { static = 0, dynamic = 0 }
         initial.displacement = -3
         time = { end = 7.3, output_step = 10 }
         statistics.after = 0.004
         record.density = true
         ensemble.paths = 1
         scheme.kind = \"event-driven\"";
    let summary =
        run(&Scenario::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}")));
    let found = densities(&summary);
    let fast = 50.0 + 2499f64.sqrt();
    let slow = 1.0 / fast;
    let decays = |t: f64| [(-slow * t).exp(), (-fast * t).exp()];
    let x = |t: f64| {
        let [a, b] = decays(t);
        -3.0 * (fast * a - slow * b) / (fast - slow)
    };
    let v = |t: f64| {
        let [a, b] = decays(t);
        3.0 * (a - b) / (fast - slow)
    };
    let fastest = (fast / slow).ln() / (fast - slow);
    // The time between two times in which a function that is monotone there is below an edge.
    let below = |of: &dyn Fn(f64) -> f64, [from, to]: [f64; 2], edge: f64| {
        let rises = of(to) > of(from);
        let (mut low, mut high) = (from, to);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if (of(middle) < edge) == rises {
                &mut low
            } else {
                &mut high
            }) = middle;
        }
        if rises { low - from } else { to - low }
    };
    let counted = 7.3 - 0.004;
    let at_x = |edge: f64| below(&x, [0.004, 7.3], edge) / counted;
    let at_v = |edge: f64| {
        let ways = [[0.004, fastest], [fastest, 7.3]].map(|way| below(&v, way, edge));
        (ways[0] + ways[1]) / counted
    };
    let [x, v] = [off(&found.displacement, at_x), off(&found.velocity, at_v)];
    assert!(x < 1e-9 && v < 1e-9, "{x} {v}");
}

/// A step of a scheme with a step is its state, held for the step: densities are those of the rows at
/// all steps, and works are sums of the forces at the start of each step times its way.
#[test]
fn densities_and_works_are_those_of_the_steps() {
    for scheme in ["discrete-vi", "corrected-vi"] {
        let lines = format!(
            "{}\n{NOISE}\nscheme.kind = {scheme:?}\ntime.step = 0.01",
            LOAD
        );
        let mut scenario = scene(scheme, &lines, 4, [5.0, 20.0]);
        (scenario.time.output_step, scenario.record.trajectories) = (0.01, 1);
        let (summary, column) = recorded(&scenario);
        let (x, v, held) = (column("displacement"), column("velocity"), 500..2000);
        let resting: Vec<bool> = column("static").iter().map(|is| *is > 0.0).collect();
        let found = densities(&summary);
        let count =
            |of: &dyn Fn(usize) -> bool| held.clone().filter(|n| of(*n)).count() as f64 / 1500.0;
        let at_x = off(&found.displacement, |edge| count(&|n| x[n] < edge));
        let at_v = off(&found.velocity, |edge| {
            count(&|n| !resting[n] && v[n] < edge)
        });
        assert!(at_x < 1e-9 && at_v < 1e-9, "{scheme}: {at_x} {at_v}");
        assert!(
            (found.at_rest - count(&|n| resting[n])).abs() < 1e-9,
            "{scheme}"
        );
        let temperature = column("temperature");
        let sum = |force: &dyn Fn(usize) -> f64| {
            held.clone()
                .map(|n| force(n) * (x[n + 1] - x[n]))
                .sum::<f64>()
        };
        for (statistic, expected) in [
            (Statistic::TemperatureWorkMean, sum(&|n| temperature[n])),
            (Statistic::DampingWorkMean, sum(&|n| 0.2 * v[n])),
            (
                Statistic::FrictionWorkMean,
                sum(&|n| (x[n + 1] - x[n]).signum() * (1.0 + 0.3 * (2.0 * x[n]).sin())),
            ),
        ] {
            let found = summary.estimate(statistic).estimate;
            assert!(
                (found / expected - 1.0).abs() < 1e-12,
                "{scheme}: {found} {expected}, {}",
                statistic.name()
            );
        }
    }
}

/// The part of a segment between two places of it during which x (0) or x' (1) is below an edge: places
/// 1/100 apart, and halvings between two of them on different sides.
fn part_below(segment: &Segment, variable: usize, edge: f64, [from, to]: [f64; 2]) -> f64 {
    let is_below =
        |part: f64| [segment.displacement, 0.0][variable] + segment.at(part)[variable] < edge;
    let (mut sum, mut left, mut was_below) = (0.0, from, is_below(from));
    for i in 1..=100 {
        let right = from + (to - from) * f64::from(i) / 100.0;
        let now_below = is_below(right);
        let (mut low, mut high) = (left, right);
        while was_below != now_below && high - low > 1e-12 {
            let middle = 0.5 * (low + high);
            *(if is_below(middle) == was_below {
                &mut low
            } else {
                &mut high
            }) = middle;
        }
        sum += match (was_below, now_below) {
            (true, true) => right - left,
            (true, false) => low - left,
            (false, true) => right - low,
            (false, false) => 0.0,
        };
        (left, was_below) = (right, now_below);
    }
    sum
}

/// Under noise, the time below each edge is that of the motion between the events of the same paths,
/// found by halving; so is the time in rows and columns of the joint density.
#[test]
fn densities_under_noise_are_times_of_the_same_motion() {
    let lines = format!("{}\n{NOISE}\nscheme.kind = \"event-driven\"", LOAD);
    let scenario = scene("noise", &lines, 4, [6.7081, 20.037]);
    let (timeline, paths) = (scenario.timeline(), [0, 1, 2, 3]);
    let record = Record {
        density: true,
        ..Record::NOTHING
    };
    let block = BlockObserver::new(&scenario.model, &timeline, &record, &paths, Replicate::Path);
    let mut both = (Kept(vec![Vec::new(); 4]), block);
    assert!(
        scenario
            .scheme
            .simulation(&scenario.model, &timeline)
            .simulate(4, &paths, &mut both)
            .is_empty()
    );
    let summary = both.1.finish(0, 4, Vec::new()).totals.summary();
    let found = densities(&summary);
    let segments: Vec<&Segment> = both.0.0.iter().flatten().collect();
    let expected = |variable: usize, edge: f64| -> f64 {
        let times = segments.iter().map(|segment| {
            let part = |time: f64| ((time - segment.start) / segment.length).clamp(0.0, 1.0);
            let [from, to] = [timeline.after, timeline.end].map(part);
            if from < to {
                segment.length * part_below(segment, variable, edge, [from, to])
            } else {
                0.0
            }
        });
        times.sum::<f64>() / (4.0 * timeline.counted())
    };
    let at_v = off(&found.velocity, |edge| expected(1, edge));
    assert!(at_v < 1e-9, "{at_v}");
    let [rows, columns] = &found.joint_edges;
    let area = (rows[1] - rows[0]) * (columns[1] - columns[0]);
    for (variable, edges) in [rows, columns].into_iter().enumerate() {
        for (k, edge) in edges.iter().enumerate() {
            let cells = found
                .joint
                .indexed_iter()
                .filter(|(cell, _)| [cell.0, cell.1][variable] < k);
            let off =
                cells.map(|(_, density)| density * area).sum::<f64>() - expected(variable, *edge);
            assert!(off.abs() < 1e-9, "{variable}, {edge}: {off:e}");
        }
    }
}

/// A run of a scenario, and the rows of its paths, one path after the other.
fn recorded(scenario: &Scenario) -> (Summary, impl Fn(&str) -> Vec<f64>) {
    let mut recorder = Recorder::default();
    let outcome = Run::of(scenario)
        .without_bias()
        .into_sink(&mut recorder)
        .simulate()
        .expect("no sink fails");
    let dataset = recorder.into_dataset();
    let column = move |name: &str| match &dataset
        .entry(&format!("trajectory_{name}"))
        .expect("recorded")
        .column
    {
        Column::F64(values) => values.clone(),
        Column::I8(values) => values.iter().map(|value| f64::from(*value)).collect(),
        other => panic!("{other:?}"),
    };
    (outcome.summary, column)
}

/// The definitions of autocovariance and spectrum, summed row by row, at lags up to half a segment and
/// at frequencies up to the highest.
#[test]
fn autocovariance_and_spectrum_are_plain_sums_over_the_rows() {
    let paths = 6;
    let lines = format!("{}\n{NOISE}\nscheme.kind = \"event-driven\"", PLAIN);
    let mut scenario = scene("spectrum", &lines, 5, [10.1, 310.0]);
    (
        scenario.ensemble.paths,
        scenario.time.output_step,
        scenario.record.trajectories,
    ) = (paths as u64, 0.2, paths as u64);
    scenario.record = Record {
        spectrum: true,
        energy: false,
        density: false,
        ..scenario.record
    };
    let (summary, column) = recorded(&scenario);
    let (rows, first) = (1551, 51);
    // The counted rows are in two segments of L = 1000 that overlap by half.
    let length = 1000;
    let spectrum = summary.spectrum.as_ref().expect("asked for");
    assert_eq!((spectrum.segments, spectrum.lag.len()), (2, length / 2));
    let taper: Vec<f64> = (0..length)
        .map(|n| 0.5 - 0.5 * (std::f64::consts::TAU * (n as f64 + 0.5) / length as f64).cos())
        .collect();
    for (values, found) in [
        (column("displacement"), &spectrum.displacement),
        (column("velocity"), &spectrum.velocity),
    ] {
        let at = |path: usize, row: usize| values[path * rows + row];
        let mean: Vec<f64> = (0..rows)
            .map(|row| (0..paths).map(|p| at(p, row)).sum::<f64>() / paths as f64)
            .collect();
        let mut segments = Vec::new();
        for path in 0..paths {
            for start in [first, first + length / 2] {
                let tapered =
                    (0..length).map(|n| taper[n] * (at(path, start + n) - mean[start + n]));
                segments.push(tapered.collect::<Vec<f64>>());
            }
        }
        let weight = 2.0 * (paths as f64 - 1.0);
        let product =
            |a: &[f64], lag: usize| a.iter().zip(&a[lag..]).map(|(a, b)| a * b).sum::<f64>();
        let variance = found.autocovariance[0];
        for lag in [0, 1, length / 4, length / 2 - 1] {
            let sum: f64 = segments.iter().map(|segment| product(segment, lag)).sum();
            let expected = sum / weight / product(&taper, lag);
            let off = (found.autocovariance[lag] - expected).abs() / variance;
            assert!(
                off < 1e-12,
                "lag {lag}: {} {expected}",
                found.autocovariance[lag]
            );
        }
        for k in [0, 1, 37, spectrum.frequency.len() - 1] {
            let turn = spectrum.frequency[k] * 0.2;
            let power = |segment: &Vec<f64>| {
                let part = |wave: fn(f64) -> f64| -> f64 {
                    segment
                        .iter()
                        .enumerate()
                        .map(|(n, y)| y * wave(turn * n as f64))
                        .sum()
                };
                part(f64::cos).powi(2) + part(f64::sin).powi(2)
            };
            let expected =
                0.2 * segments.iter().map(power).sum::<f64>() / weight / product(&taper, 0);
            let off = (found.spectrum[k] - expected).abs() / (found.spectrum[k] + 1e-12 * variance);
            assert!(
                off < 1e-9,
                "frequency {k}: {} {expected}",
                found.spectrum[k]
            );
        }
    }
}
