//! Properties that every scheme has: the law of the temperature and its initial value, that a path
//! is a function of the scenario, the seed and its number, and that the velocity is the rate of
//! change of the displacement.
//!
//! Statistical tests have a fixed seed. Each states its null hypothesis, its sample size and its
//! false-alarm rate.

use crate::common::{Keep, paper, timeline};
use std::collections::HashSet;
use stickslip::config::shipped;
use stickslip::engine::Replay;
use stickslip::model::{Event, InitialNoise, OrnsteinUhlenbeck, Problem};
use stickslip::scenario::Scenario;
use stickslip::scheme::{
    DEFAULT_TOLERANCE, Discretisation, Instant, Kind, Observer, Parameter, Scheme, Simulate as _,
    Snapshot, Timeline,
};

/// All schemes; those that have a step get this one.
fn schemes(step: f64) -> impl Iterator<Item = Scheme> {
    Kind::ALL.iter().map(move |kind| match kind.parameter() {
        Parameter::Step => kind.with(step),
        Parameter::Tolerance { .. } => kind.with(DEFAULT_TOLERANCE),
    })
}

fn kept(scheme: Scheme, model: &Problem, timeline: &Timeline, seed: u64, paths: &[u64]) -> Keep {
    let mut keep = Keep::lanes(paths.len());
    let lost = scheme
        .simulation(model, timeline)
        .simulate(seed, paths, &mut keep);
    assert!(lost.is_empty(), "{scheme}: {lost:?}");
    keep
}

/// The noisy scene of the paper with this noise.
fn with_noise(noise: OrnsteinUhlenbeck) -> Problem {
    let mut model = paper(0.25, noise.intensity);
    model.temperature.noises = vec![noise];
    model
}

/// For each row of the output grid, the sums over paths of n, n^2 and n n', where n is T less its
/// mean and n' is n at the row before.
struct NoiseMoments {
    mean: Box<dyn Fn(f64) -> f64>,
    before: Vec<f64>,
    sums: Vec<(f64, [f64; 3])>,
}

impl Observer for NoiseMoments {
    fn event(&mut self, _: usize, _: Event) {}

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if !matches!(instant, Instant::Output(_)) {
            return;
        }
        let n: Vec<f64> = s
            .temperature
            .iter()
            .map(|t| t - (self.mean)(s.time))
            .collect();
        self.before.resize(n.len(), 0.0);
        let product = n.iter().zip(&self.before).map(|(a, b)| a * b).sum();
        self.sums.push((
            s.time,
            [n.iter().sum(), n.iter().map(|n| n * n).sum(), product],
        ));
        self.before = n;
    }
}

/// The noise acts on the body, and the body does not act on the noise. So in every scheme, however
/// a path sticks, slips, turns and is cut into steps, T less its harmonics is rho times the
/// Ornstein-Uhlenbeck process v, for which
///
/// ```text
/// E v = e^{-theta t} v(0),   Var v = (sigma^2/2 theta)(1 - e^{-2 theta t}),
/// Cov(v(s), v(t)) = e^{-theta (t - s)} Var v(s),
/// ```
///
/// or Var v = sigma^2/2 theta at every t after a stationary start.
///
/// Null hypothesis: these moments, on ten rows 0.7 apart, the first at t = 0, in four schemes and
/// from either start. Slips last 3 and more, so most rows lie in one. Sample size: 2e4 paths, so
/// that a variance is known to 1 %. False-alarm rate: 1e-4 for each of 240 comparisons, which are
/// made at 3.9 standard errors. If the noise stood still while the body slips, or if v(0) shared a
/// random number with the first increment, the moments would be off by tens of standard errors.
#[test]
fn the_temperature_is_the_same_process_in_every_scheme() {
    let (rho, theta, sigma, lag, paths) = (0.25, 0.5, 1.0, 0.7, 20_000u64);
    let stationary: f64 = rho * rho * sigma * sigma / (2.0 * theta);
    let numbers: Vec<u64> = (0..paths).collect();
    let line = timeline(9.0 * lag, lag);
    for scheme in schemes(0.05) {
        for initial in [InitialNoise::At(2.0), InitialNoise::Stationary] {
            let model = with_noise(OrnsteinUhlenbeck {
                intensity: rho,
                relaxation_rate: theta,
                diffusion: sigma,
                initial,
            });
            let start = if let InitialNoise::At(v) = initial {
                rho * v
            } else {
                0.0
            };
            let mean = Box::new(move |t: f64| (0.25 * t).cos() + start * (-theta * t).exp());
            let mut moments = NoiseMoments {
                mean,
                before: Vec::new(),
                sums: Vec::new(),
            };
            assert!(
                scheme
                    .simulation(&model, &line)
                    .simulate(11, &numbers, &mut moments)
                    .is_empty()
            );
            assert_eq!(moments.sums.len(), 10);
            let variance = |t: f64| match initial {
                InitialNoise::Stationary => stationary,
                InitialNoise::At(_) => -stationary * (-2.0 * theta * t).exp_m1(),
            };
            for (row, &(t, sums)) in moments.sums.iter().enumerate() {
                let (var, before) = (variance(t), if row == 0 { 0.0 } else { variance(t - lag) });
                let covariance = before * (-theta * lag).exp();
                let sds = [
                    var.sqrt(),
                    2f64.sqrt() * var,
                    (var * before + covariance * covariance).sqrt(),
                ];
                for ((what, sum), (want, sd)) in ["mean", "variance", "covariance"]
                    .into_iter()
                    .zip(sums)
                    .zip([0.0, var, covariance].into_iter().zip(sds))
                {
                    let (got, error) = (sum / paths as f64, sd / (paths as f64).sqrt());
                    // At the first row nothing fluctuates yet, and T differs from its mean by
                    // rounding.
                    let is_so = (got - want).abs() <= 3.9 * error + 1e-14;
                    assert!(
                        is_so,
                        "{scheme}, {initial:?}, t = {t}, {what}: {got}, not {want} +- {error}"
                    );
                }
            }
        }
    }
}

/// T(0) is the sum of the harmonics at 0 and of rho v(0), to rounding, and it acts on the body: b
/// at the first event of a start outside the stick band is K (beta T(0) - x0).
#[test]
fn every_scheme_starts_from_rho_times_the_noise_it_is_given() {
    let initial = InitialNoise::At(2.0);
    let noise = OrnsteinUhlenbeck {
        intensity: 0.3,
        relaxation_rate: 1.0,
        diffusion: 1.0,
        initial,
    };
    let mut model = with_noise(noise);
    model.oscillator.stiffness = 3.0;
    let temperature = 1.0 + 0.3 * 2.0;
    for scheme in schemes(0.01) {
        let keep = kept(scheme, &model, &timeline(1.0, 1.0), 1, &[0, 1]);
        for (events, rows) in keep.events.iter().zip(&keep.rows) {
            assert!(
                (rows[0].3 - temperature).abs() < 1e-14,
                "{scheme}: {rows:?}"
            );
            let b = 3.0 * (6.0 * temperature - 6.0);
            assert!(
                events[0].time == 0.0 && (events[0].force - b).abs() < 1e-12,
                "{scheme}: {:?}",
                events[0]
            );
        }
    }
}

/// Every bit of the number of a path changes the path: 65 numbers, of which 64 differ from the
/// first in one bit each, give 65 different T at the end, and each path is the same as when it is
/// simulated alone. The same holds for 65 seeds.
#[test]
fn every_bit_of_path_number_and_seed_counts() {
    let number = 5u64;
    let neighbours: Vec<u64> = std::iter::once(number)
        .chain((0..64).map(|bit| number ^ (1 << bit)))
        .collect();
    let noise = OrnsteinUhlenbeck {
        intensity: 0.25,
        relaxation_rate: 1.0,
        diffusion: 1.0,
        initial: InitialNoise::Stationary,
    };
    let (model, line) = (with_noise(noise), timeline(5.0, 5.0));
    for scheme in schemes(0.05) {
        let together = kept(scheme, &model, &line, 9, &neighbours);
        let ends: HashSet<u64> = together
            .rows
            .iter()
            .map(|rows| rows[1].3.to_bits())
            .collect();
        assert_eq!(
            ends.len(),
            neighbours.len(),
            "{scheme}: two paths are the same"
        );
        for (lane, &path) in neighbours.iter().enumerate() {
            let alone = kept(scheme, &model, &line, 9, &[path]);
            assert_eq!(
                (&alone.rows[0], &alone.events[0]),
                (&together.rows[lane], &together.events[lane]),
                "{scheme} {path}"
            );
        }
        let seeds = neighbours.iter().map(|&seed| {
            kept(scheme, &model, &line, seed, &[number]).rows[0][1]
                .3
                .to_bits()
        });
        assert_eq!(
            seeds.collect::<HashSet<u64>>().len(),
            neighbours.len(),
            "{scheme}: two seeds are the same"
        );
    }
}

/// A replay uses all 64 bits of the number of a path, and reports that number.
#[test]
fn path_numbers_beyond_32_bits_are_other_paths() {
    let scenario =
        Scenario::parse("rho025", shipped("rho025").expect("shipped").text, &[]).expect("sound");
    let mut ends = HashSet::new();
    for path in [7, (1 << 16) + 7, (1 << 32) + 7, (1 << 48) + 7] {
        let block = Replay::of(&scenario, path).block;
        assert_eq!((block.rows.first_path, block.rows.paths), (path, 1));
        assert_eq!(block.rows.trajectories.expect("kept").path, [path]);
        ends.insert(block.rows.path_columns.expect("kept").displacement_end[0].to_bits());
    }
    assert_eq!(ends.len(), 4);
}

/// x' is the rate of change of x in every scheme, in a scene whose natural frequency is 2. For rows
/// 2d apart in one sub-phase, (x(t + d) - x(t - d))/2d equals x'(t) up to d times the change of the
/// force over the mass, which here is below 2 % of the greatest velocity in the scheme. While the
/// body sticks, both are zero.
#[test]
fn the_velocity_is_the_rate_of_the_displacement_in_every_scheme() {
    let (d, end) = (0.002, 20.0);
    for rho in [0.0, 0.25] {
        let mut model = paper(0.25, rho);
        model.oscillator.mass = 0.25;
        for scheme in schemes(d) {
            let keep = kept(scheme, &model, &timeline(end, d), 3, &[0, 1, 2]);
            let fastest = keep
                .rows
                .iter()
                .flatten()
                .map(|row| row.2.abs())
                .fold(0.0, f64::max);
            let (mut slides, mut rests) = (0, 0);
            for (events, rows) in keep.events.iter().zip(&keep.rows) {
                for three in rows.windows(3) {
                    let ((from, at), to) = ((three[0], three[1]), three[2]);
                    if events
                        .iter()
                        .any(|event| event.time >= from.0 - d && event.time <= to.0 + d)
                    {
                        continue;
                    }
                    let rate = (to.1 - from.1) / (to.0 - from.0);
                    assert!(
                        (rate - at.2).abs() <= 0.02 * fastest,
                        "{scheme}, t = {}: {rate} {}",
                        at.0,
                        at.2
                    );
                    assert!(!at.4 || (rate == 0.0 && at.2 == 0.0), "{scheme}: {at:?}");
                    *(if at.4 { &mut rests } else { &mut slides }) += 1;
                }
            }
            assert!(slides > 1000 && rests > 100, "{scheme}: {slides} {rests}");
            // In the quasi-static scheme the body swings by (f_s - f_d)/K about its equilibrium, at
            // w0.
            if scheme.discretisation() == Discretisation::Approximation {
                assert!((fastest / 0.4 - 1.0).abs() < 1e-4, "{fastest}");
            }
        }
    }
}
