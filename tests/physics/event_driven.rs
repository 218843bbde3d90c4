//! The event-driven scheme compared with what it was not derived from.
//!
//! Exact tests compare with tables from high-precision arithmetic. Statistical tests have a fixed
//! seed; each states its null hypothesis, sample size and false-alarm rate.

// Reference numbers keep the digits that they were computed with.
#![allow(clippy::excessive_precision)]

use crate::common::{estimate, event_driven_summary, paper, reference, shipped_model};
use stickslip::model::{
    Complex, Drive, Event, EventKind, Expression, Force, Friction, Harmonic, ImpulseResponse,
    InitialNoise, OrnsteinUhlenbeck, Problem, Sign, Temperature,
};
use stickslip::scheme::{
    DEFAULT_TOLERANCE, DrivenOscillator, EventDrivenSimulation, HarmonicResponse, Instant, Kind,
    Observer, QuasiStaticSimulation, Simulate as _, SlipTransition, Snapshot, Timeline,
};
use stickslip::stats::{Record, Statistic};

fn timeline(end: f64) -> Timeline {
    Timeline {
        end,
        output_step: end.max(1.0),
        period: None,
        after: 0.0,
    }
}

/// Keeps all events of every lane, and the rows of lane 0.
#[derive(Default)]
struct Recorder {
    events: Vec<Vec<Event>>,
    /// (instant, time, displacement, velocity, temperature, is_static) of lane 0.
    rows: Vec<(Instant, f64, f64, f64, f64, bool)>,
}

impl Observer for Recorder {
    fn event(&mut self, lane: usize, event: Event) {
        self.events
            .resize(self.events.len().max(lane + 1), Vec::new());
        self.events[lane].push(event);
    }

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        self.rows.push((
            instant,
            s.time,
            s.displacement[0],
            s.velocity[0],
            s.temperature[0],
            s.is_static[0],
        ));
    }
}

fn noiseless_events(model: &Problem, end: f64) -> Vec<Event> {
    let mut recorder = Recorder::default();
    let failed = EventDrivenSimulation::new(model, &timeline(end), DEFAULT_TOLERANCE).simulate(
        0,
        &[0],
        &mut recorder,
    );
    assert!(failed.is_empty());
    recorder.events.pop().unwrap_or_default()
}

/// 0 stick entered, 1 slip started, 2 sub-phase boundary.
fn kind_number(kind: EventKind) -> u8 {
    match kind {
        EventKind::StickEntered => 0,
        EventKind::SlipStarted(_) => 1,
        EventKind::SubPhaseBoundary(_) => 2,
    }
}

/// A row of an exact table: kind, t, x, b.
type Row = (u8, f64, f64, f64);

/// Exact cascade of the noiseless scene of the paper with forcing frequency 1/4, from closed forms
/// and bisection in 40-digit arithmetic.
const QUARTER: &[Row] = &[
    (1, 2.57400443517313755, 6.0, -1.2),
    (
        0,
        13.3613220575479587,
        -6.18847247536762567,
        0.306573202338802169,
    ),
    (1, 14.9229792996515265, -6.18847247536762567, 1.2),
    (
        0,
        25.7770609413858963,
        6.17862086514394278,
        -0.256292932048306973,
    ),
    (1, 27.5011437042137581, 6.17862086514394278, -1.2),
    (
        0,
        38.3514520070005582,
        -6.17954770736860736,
        0.259161209334353553,
    ),
    (1, 40.0664069611809123, -6.17954770736860736, 1.2),
    (
        0,
        50.9170687658257681,
        6.17946256643588498,
        -0.258892576084898404,
    ),
    (1, 52.6328793178516317, 6.17946256643588498, -1.2),
    (
        0,
        63.4835086364843192,
        -6.17947040535345908,
        0.258917263570057794,
    ),
    (1, 65.1992405649667653, -6.17947040535345908, 1.2),
    (
        0,
        76.0498728744746008,
        6.17946968377528879,
        -0.258914990684342223,
    ),
    (1, 77.7656120415890556, 6.17946968377528879, -1.2),
    (
        0,
        88.6162440757836949,
        -6.17946975019836712,
        0.258915199905907928,
    ),
    (1, 90.3319825765747599, -6.17946975019836712, 1.2),
    (
        0,
        101.182614636112661,
        6.17946974408396714,
        -0.258915180646545015,
    ),
    (1, 102.898353198240447, 6.17946974408396714, -1.2),
    (
        0,
        113.748985255445441,
        -6.17946974464681207,
        0.258915182419414548,
    ),
    (1, 115.464723811927038, -6.17946974464681207, 1.2),
    (
        0,
        126.315355869346782,
        6.17946974459500087,
        -0.258915182256217728,
    ),
    (1, 128.031094426348124, 6.17946974459500087, -1.2),
    (
        0,
        138.881726483748099,
        -6.17946974459977021,
        0.258915182271240379,
    ),
];

/// The same with forcing frequency 1/2, as the paper prints it, with two sub-phases in every
/// dynamic phase.
const HALF: &[Row] = &[
    (1, 1.28700221758656877, 6.0, -1.2),
    (
        2,
        6.42517019752096936,
        -9.74381267516092767,
        3.75892610782486854,
    ),
    (
        0,
        12.2766918440973609,
        6.3410547599469783,
        -0.403880155496365832,
    ),
    (1, 13.6497355133912649, 6.3410547599469783, -1.2),
    (
        2,
        18.9313318141685687,
        -9.54628126776264921,
        3.55129604151413879,
    ),
    (
        0,
        24.9918279578736896,
        6.47694929115717113,
        -0.491835543936380579,
    ),
    (1, 26.1247483298220846, 6.47694929115717113, -1.2),
    (
        2,
        31.4751618172631567,
        -9.45419585125020538,
        3.45682727280264831,
    ),
    (
        0,
        37.6057535033426014,
        6.55690498309035501,
        -0.56344063092488804,
    ),
    (1, 38.6335801197006449, 6.55690498309035501, -1.2),
    (
        2,
        44.0288636907772373,
        -9.39608034950949943,
        3.39770660806184117,
    ),
    (
        0,
        50.1962019636948363,
        6.61038546886601577,
        -0.613984949022227328,
    ),
    (1, 51.1595612652041369, 6.61038546886601577, -1.2),
    (
        2,
        56.587068481393395,
        -9.35549252693480973,
        3.35659845424557539,
    ),
    (
        0,
        62.7769933667564707,
        6.64872645821396749,
        -0.650983507120034222,
    ),
    (1, 63.6958966083338313, 6.64872645821396749, -1.2),
    (
        2,
        69.1477619540541619,
        -9.32551757787501348,
        3.3263206842327168,
    ),
    (
        0,
        75.3528589907806256,
        6.67745420676543164,
        -0.678997607281670225,
    ),
    (1, 76.2391056602252488, 6.67745420676543164, -1.2),
    (
        2,
        81.7099872261343369,
        -9.3025658700307459,
        3.30317839615103233,
    ),
    (
        0,
        87.9258791914031578,
        6.69964849087601238,
        -0.70077260052874386,
    ),
    (1, 88.7871631547654182, 6.69964849087601238, -1.2),
    (
        2,
        94.2732245042581174,
        -9.28453951576336975,
        3.28502509128456104,
    ),
    (
        0,
        100.497113492824869,
        6.71718410619228798,
        -0.718043524755860186,
    ),
    (1, 101.338788208220326, 6.71718410619228798, -1.2),
    (
        2,
        106.837165141822757,
        -9.27011266147690681,
        3.27050992199206123,
    ),
    (
        0,
        113.067157830250777,
        6.7312770156780601,
        -0.731960022856242772,
    ),
    (1, 113.893121274915997, 6.7312770156780601, -1.2),
    (
        2,
        119.40161368708193,
        -9.25839883150209473,
        3.25873250967127342,
    ),
    (
        0,
        125.636372571663224,
        6.74275466840571362,
        -0.74331500279975691,
    ),
    (1, 126.449559324689234, 6.74275466840571362, -1.2),
    (
        2,
        131.966440138653797,
        -9.24877941045307548,
        3.24906602156965995,
    ),
    (
        0,
        138.20498808436356,
        6.75220178977171212,
        -0.752673864737951006,
    ),
];

/// Every event agrees to a relative 1e-12. Where a value is near zero, the error is relative to the
/// size of the motion.
fn assert_cascade(name: &str, events: &[Event], exact: &[Row]) {
    assert_eq!(events.len(), exact.len(), "{name}: {events:?}");
    for (event, &(kind, t, x, b)) in events.iter().zip(exact) {
        assert_eq!(kind_number(event.kind), kind, "{name}, t = {t}");
        for (got, want) in [(event.time, t), (event.displacement, x), (event.force, b)] {
            assert!(
                (got - want).abs() <= 1e-12 * want.abs().max(0.1),
                "{name}, t = {t}: {got} is not {want}"
            );
        }
    }
}

#[test]
fn every_event_of_the_paper_s_noiseless_scenes_is_exact() {
    assert_cascade(
        "forcing 1/4",
        &noiseless_events(&paper(0.25, 0.0), 139.0),
        QUARTER,
    );
    assert_cascade(
        "forcing 1/2",
        &noiseless_events(&paper(0.5, 0.0), 139.0),
        HALF,
    );
}

/// The scene of tests/reference/cascade.py with this name, and its t_end.
fn reference_scene(name: &str) -> (Problem, f64) {
    let (damping, f_d, f_s, x0, harmonics, end): (_, _, _, _, &[(f64, f64, f64)], _) = match name {
        "underdamped" => (0.125, 1.0, 1.2, 6.0, &[(1.0, 0.25, 0.0)], 60.0),
        "critical" => (1.0, 0.5, 1.2, 6.0, &[(1.0, 0.25, 0.0)], 60.0),
        "overdamped" => (3.0, 0.5, 1.2, 6.0, &[(1.0, 0.25, 0.0)], 60.0),
        "resonant" => (0.0, 1.0, 1.2, 0.0, &[(0.5, 1.0, 0.3)], 30.0),
        "near_resonant" => (0.0, 1.0, 1.2, 0.0, &[(0.5, 1.000000001, 0.3)], 30.0),
        "two_harmonics_and_a_constant" => (
            0.05,
            0.9,
            1.1,
            1.0,
            &[(0.7, 0.25, 0.5), (0.3, 1.75, -1.0), (0.2, 0.0, 0.4)],
            60.0,
        ),
        "starts_outside" => (0.0, 1.0, 1.2, 12.0, &[(1.0, 0.25, 0.0)], 30.0),
        "no_dynamic_friction" => (0.05, 0.0, 1.2, 6.0, &[(1.0, 0.25, 0.0)], 30.0),
        "equal_thresholds" => (0.0, 1.0, 1.0, 6.0, &[(1.0, 0.25, 0.0)], 60.0),
        _ => panic!("{name} is not in cascade.py"),
    };
    let harmonics = harmonics
        .iter()
        .map(|&(amplitude, angular_frequency, phase)| Harmonic {
            amplitude,
            angular_frequency,
            phase,
        })
        .collect();
    let mut model = paper(0.25, 0.0);
    model.oscillator.damping = damping;
    model.friction = Friction {
        static_force: f_s,
        dynamic_force: f_d,
    };
    model.temperature.harmonics = harmonics;
    model.initial_displacement = x0;
    (model, end)
}

#[test]
fn every_damping_regime_and_resonance_is_exact() {
    let mut scenes: Vec<(String, Vec<Row>)> = Vec::new();
    for line in include_str!("../reference/cascade.csv").lines().skip(1) {
        let mut fields = line.split(',');
        let name = fields.next().expect("a scene");
        let mut number = || {
            fields
                .next()
                .and_then(|f| f.parse::<f64>().ok())
                .expect("a number")
        };
        let row = (number() as u8, number(), number(), number());
        match scenes.last_mut() {
            Some((last, rows)) if last == name => rows.push(row),
            _ => scenes.push((name.to_owned(), vec![row])),
        }
    }
    assert_eq!(scenes.len(), 9);
    for (name, rows) in &scenes {
        let (model, end) = reference_scene(name);
        assert_cascade(name, &noiseless_events(&model, end), rows);
    }
}

#[test]
fn ten_thousand_periods_do_not_drift() {
    // After its transient the orbit of the 1/4 scene is symmetric: half a forcing period later,
    // everything has changed sign. The transient decays by a factor of 8 in each phase (see
    // QUARTER), so long before event 100 only rounding is left of it.
    let half_period = std::f64::consts::PI / 0.25;
    let periods = 1e4;
    let events = noiseless_events(&paper(0.25, 0.0), 2.0 * half_period * periods);
    assert_eq!(
        events.len(),
        4 * 10_000 - 1,
        "two sticks and two slips a period; the first begins at t = 0"
    );
    let (first, last) = (events[100], events[events.len() - 3]);
    let halves = ((last.time - first.time) / half_period).round();
    assert!(halves > 19_900.0);
    // Times are reported as doubles, which have a spacing of 2.9e-11 at 2.5e5.
    assert!((last.time - first.time - halves * half_period).abs() < 6e-11);
    for pair in events[100..].windows(3).map(|w| (w[0], w[2])) {
        assert!((pair.0.displacement + pair.1.displacement).abs() < 1e-13 * 6.2);
        assert!((pair.0.force + pair.1.force).abs() < 1e-13 * 6.2);
    }
}

#[test]
fn a_scene_that_never_slips_reports_no_event() {
    let mut model = paper(0.25, 0.0);
    model.friction.static_force = 13.0; // above |b| <= K beta 2
    assert!(noiseless_events(&model, 1e6).is_empty());
    assert!(
        noiseless_events(&paper(0.25, 0.0), 2.5).is_empty(),
        "the first slip is at 2.574"
    );
}

#[test]
fn a_run_of_length_zero_is_observed_once_and_does_nothing() {
    let mut recorder = Recorder::default();
    assert!(
        EventDrivenSimulation::new(&paper(0.25, 0.0), &timeline(0.0), DEFAULT_TOLERANCE)
            .simulate(0, &[0], &mut recorder)
            .is_empty()
    );
    assert!(recorder.events.is_empty());
    assert!(
        recorder
            .rows
            .iter()
            .all(|row| (row.1, row.2, row.3, row.5) == (0.0, 6.0, 0.0, true))
    );
}

#[test]
fn without_any_friction_it_is_the_plain_oscillator() {
    let mut model = paper(0.25, 0.0);
    model.friction = Friction {
        static_force: 0.0,
        dynamic_force: 0.0,
    };
    model.initial_displacement = 0.0;
    let line = Timeline {
        end: 50.0,
        output_step: 0.7,
        period: None,
        after: 0.0,
    };
    let mut recorder = Recorder::default();
    assert!(
        EventDrivenSimulation::new(&model, &line, DEFAULT_TOLERANCE)
            .simulate(0, &[0], &mut recorder)
            .is_empty()
    );
    for &(_, t, x, v, _, _) in &recorder.rows {
        // x'' + x = 6 cos(t/4), x(0) = x'(0) = 0: x = 6.4 (cos(t/4) - cos t).
        assert!(
            (x - 6.4 * ((0.25 * t).cos() - t.cos())).abs() < 1e-12,
            "{t}"
        );
        assert!(
            (v - 6.4 * (t.sin() - 0.25 * (0.25 * t).sin())).abs() < 1e-12,
            "{t}"
        );
    }
}

#[test]
fn observing_does_not_touch_a_noiseless_path() {
    let (mut coarse, mut fine) = (Recorder::default(), Recorder::default());
    let line = |output_step| Timeline {
        end: 60.0,
        output_step,
        period: Some(8.0 * std::f64::consts::PI),
        after: 0.0,
    };
    EventDrivenSimulation::new(&paper(0.25, 0.0), &line(60.0), DEFAULT_TOLERANCE).simulate(
        0,
        &[0, 1],
        &mut coarse,
    );
    EventDrivenSimulation::new(&paper(0.25, 0.0), &line(0.37), DEFAULT_TOLERANCE).simulate(
        0,
        &[0, 1],
        &mut fine,
    );
    assert_eq!(coarse.events, fine.events);
    assert_eq!(coarse.events[0], coarse.events[1]);
    for &(_, t, x, v, temperature, is_static) in &fine.rows {
        assert!((temperature - (0.25 * t).cos()).abs() < 1e-14);
        assert!(!is_static || v == 0.0);
        assert!(x.abs() < 6.3);
    }
}

#[test]
fn relaxation_without_diffusion_is_one_more_exponential() {
    // sigma = 0, v(0) = 2, no harmonics: b = 6 e^{-t/2} - x leaves the stick band downwards where 6
    // e^{-t/2} = 6 - 1.2.
    let mut model = paper(0.25, 0.0);
    model.temperature = Temperature {
        noises: vec![OrnsteinUhlenbeck {
            intensity: 0.5,
            relaxation_rate: 0.5,
            diffusion: 0.0,
            initial: InitialNoise::At(2.0),
        }],
        ..Temperature::default()
    };
    let events = noiseless_events(&model, 60.0);
    assert!((events[0].time - 2.0 * (6.0f64 / 4.8).ln()).abs() < 1e-14);
    assert_eq!(events[0].kind, EventKind::SlipStarted(Sign::Negative));
    // Then x'' + x = 1 + 4.8 e^{-r/2} with x(0) = 6: x = 1 + 3.84 e^{-r/2} + 1.16 cos r + 1.92 sin
    // r.
    let r = events[1].time - events[0].time;
    let velocity = -1.92 * (-r / 2.0).exp() - 1.16 * r.sin() + 1.92 * r.cos();
    assert!(velocity.abs() < 1e-13);
    let x = 1.0 + 3.84 * (-r / 2.0).exp() + 1.16 * r.cos() + 1.92 * r.sin();
    assert!((events[1].displacement - x).abs() < 1e-13);
}

/// For each row, the sums over the lanes of T, T^2 and T times T at the row before, all about the
/// mean of T.
struct TemperatureMoments {
    mean: fn(f64) -> f64,
    previous: Vec<f64>,
    sums: Vec<(f64, [f64; 3])>,
}

impl Observer for TemperatureMoments {
    fn event(&mut self, _: usize, _: Event) {}
    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if instant == Instant::End {
            return;
        }
        let about: Vec<f64> = s
            .temperature
            .iter()
            .map(|t| t - (self.mean)(s.time))
            .collect();
        self.previous.resize(about.len(), 0.0);
        let product = about.iter().zip(&self.previous).map(|(a, b)| a * b).sum();
        self.sums.push((
            s.time,
            [
                about.iter().sum(),
                about.iter().map(|a| a * a).sum(),
                product,
            ],
        ));
        self.previous = about;
    }
}

#[test]
fn noise_that_moves_nothing_is_seen_in_the_temperature() {
    // With beta = 0, or beta so small that the noise is lost in the rounding of the forces, T is
    // still cos(t/4) + rho v, where v starts at 2 or from its stationary law. Null hypothesis:
    // mean, variance and autocovariance at lag 0.7 of that process. Sample size: 1e5 paths, ten
    // times, seed 11. False-alarm rate: 1e-4 for each of 240 comparisons at 3.9 standard errors.
    let (rho, theta, sigma, lag, paths) = (0.25, 0.5, 2.0, 0.7, 100_000u64);
    let stationary: f64 = rho * rho * sigma * sigma / (2.0 * theta);
    let (numbers, n): (Vec<u64>, f64) = ((0..paths).collect(), paths as f64);
    let line = Timeline {
        end: 6.3,
        output_step: lag,
        period: None,
        after: 0.0,
    };
    for dilatation in [0.0, 1e-25] {
        for initial in [InitialNoise::At(2.0), InitialNoise::Stationary] {
            let mut model = paper(0.25, 0.0);
            model.oscillator.drive = Drive::Dilatation(dilatation);
            model.temperature.noises = vec![OrnsteinUhlenbeck {
                intensity: rho,
                relaxation_rate: theta,
                diffusion: sigma,
                initial,
            }];
            let is_stationary = initial == InitialNoise::Stationary;
            let variance = |t: f64| {
                if is_stationary {
                    stationary
                } else {
                    -stationary * (-2.0 * theta * t).exp_m1()
                }
            };
            let mean = if is_stationary {
                |t: f64| (0.25 * t).cos()
            } else {
                |t: f64| (0.25 * t).cos() + 0.5 * (-0.5 * t).exp()
            };
            for quasi in [false, true] {
                let mut moments = TemperatureMoments {
                    mean,
                    previous: Vec::new(),
                    sums: Vec::new(),
                };
                let failed = if quasi {
                    QuasiStaticSimulation::new(&model, &line, DEFAULT_TOLERANCE).simulate(
                        11,
                        &numbers,
                        &mut moments,
                    )
                } else {
                    EventDrivenSimulation::new(&model, &line, DEFAULT_TOLERANCE).simulate(
                        11,
                        &numbers,
                        &mut moments,
                    )
                };
                assert!(failed.is_empty());
                assert_eq!(moments.sums.len(), 10);
                for (row, &(t, sums)) in moments.sums.iter().enumerate() {
                    let (var, before) =
                        (variance(t), if row == 0 { 0.0 } else { variance(t - lag) });
                    let covariance = before * (-theta * lag).exp();
                    let errors = [
                        var.sqrt(),
                        2f64.sqrt() * var,
                        (var * before + covariance * covariance).sqrt(),
                    ];
                    for ((sum, want), sd) in
                        sums.into_iter().zip([0.0, var, covariance]).zip(errors)
                    {
                        let (got, error) = (sum / n, sd / n.sqrt());
                        // At the first row nothing fluctuates yet, and T differs from its mean by
                        // rounding.
                        assert!(
                            (got - want).abs() <= FALSE_ALARM * error + 1e-14,
                            "beta {dilatation}, {initial:?}, quasi-static {quasi}, t = {t}: {got}, not {want} +- {error}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_slip_transition_keeps_ten_digits_in_every_entry() {
    // The reference is Van Loan's block exponential and spectral sums in 220-digit arithmetic
    // (tests/reference/slip_transition.py). Entries that have decayed to less than 1e-100 of their
    // natural scale are left out, because whatever they are added to is not changed by them.
    for line in include_str!("../reference/slip_transition.csv")
        .lines()
        .skip(1)
    {
        let row: Vec<f64> = line
            .split(',')
            .map(|f| f.parse().expect("a number"))
            .collect();
        let (w0, theta, alpha, h) = (row[0], row[1], row[2], row[3]);
        let step = DrivenOscillator::new(1.0, alpha, w0, theta, 1.0, &[]).transition(h, &mut []);
        let ([xx, xv, xn, _], [vx, vv, vn, _]) = (step.x, step.v);
        let got = [&[xx, xv, xn, vx, vv, vn, step.n][..], &step.covariance].concat();
        let (sn, sv, sx) = (row[11].sqrt(), row[14].sqrt(), row[16].sqrt());
        let scale = [
            1.0,
            1.0 / w0,
            1.0 / (w0 * w0),
            w0,
            1.0,
            1.0 / w0,
            1.0,
            sn * sn,
            sn * sv,
            sn * sx,
            sv * sv,
            sv * sx,
            sx * sx,
        ];
        for (column, ((got, want), scale)) in got.iter().zip(&row[4..]).zip(scale).enumerate() {
            let allowed = 1e-10 * want.abs() + 1e-100 * scale;
            assert!(
                (got - want).abs() <= allowed,
                "w0 {w0} theta {theta} alpha {alpha} h {h}, {column}: {got:e} {want:e}"
            );
        }
    }
}

/// Over all pairs of rates, dampings and steps of the reference.
#[test]
fn a_slip_transition_composes_and_factorises() {
    let steps = [1e-9, 1e-6, 1e-3, 0.03, 0.5, 4.0, 30.0, 1000.0];
    for (w0, theta) in [0.3, 1.0, 20.0]
        .map(|w0| [0.01, 1.0, 50.0].map(|theta| (w0, theta)))
        .concat()
    {
        for (ratio, h) in [0.0, 0.1, 1.0, 3.0]
            .map(|ratio| steps.map(|h| (ratio, h)))
            .concat()
        {
            let oscillator = DrivenOscillator::new(1.0, ratio * w0, w0, theta, 1.0, &[]);
            let [first, second, whole] =
                [0.3, 0.7, 1.0].map(|part| oscillator.transition(part * h, &mut []));
            let case = format!("w0 {w0} theta {theta} ratio {ratio} h {h}");
            check_composition(&case, [&first, &second, &whole]);
            check_factors(&case, &whole);
        }
    }
}

/// Phi(a + b) = Phi(b) Phi(a) and Q(a + b) = Q(b) + Phi(b) Q(a) Phi(b)^T, to ten digits of the sum of
/// the sizes of all terms.
fn check_composition(case: &str, [first, second, whole]: [&SlipTransition; 3]) {
    let means = |step: &SlipTransition| {
        let row = |of: &[f64; 4]| [of[0], of[1], of[2]];
        [row(&step.x), row(&step.v), [0.0, 0.0, step.n]]
    };
    let covariance = |step: &SlipTransition| {
        let [nn, nv, nx, vv, vx, xx] = step.covariance;
        [[xx, vx, nx], [vx, vv, nv], [nx, nv, nn]]
    };
    let ([a, b, all], [q, more, spread]) = (
        [first, second, whole].map(means),
        [first, second, whole].map(covariance),
    );
    for (i, j) in [0, 1, 2].map(|i| [0, 1, 2].map(|j| (i, j))).concat() {
        let mean = [0, 1, 2].map(|k| b[i][k] * a[k][j]);
        let pairs = [0, 1, 2].map(|k| [0, 1, 2].map(|l| b[i][k] * q[k][l] * b[j][l]));
        for (got, terms) in [
            (all[i][j], mean.to_vec()),
            (spread[i][j], [&[more[i][j]][..], &pairs.concat()].concat()),
        ] {
            let (sum, size) = terms.iter().fold((0.0, 0.0), |(sum, size), term| {
                (sum + term, size + term.abs())
            });
            assert!(
                (got - sum).abs() <= 1e-10 * size + 1e-100,
                "{case}, {i} {j}: {got:e} {sum:e}"
            );
        }
    }
}

/// The law of v and x given n reproduces the covariance. Its standard deviations are positive,
/// although the condition number of the covariance is h^-4.
fn check_factors(case: &str, step: &SlipTransition) {
    let [nn, nv, nx, vv, vx, xx] = step.covariance;
    let [sn, sv, sx] = [nn, vv, xx].map(f64::sqrt);
    let [v_on_n, v_sd, x_on_n, x_on_v, x_sd] = step.given_noise;
    assert!(v_sd > 0.0 && x_sd > 0.0, "{case}: {:?}", step.given_noise);
    let (vn, xn) = (v_on_n * sn, x_on_n * sn);
    for (got, want, scale) in [
        (vn * sn, nv, sn * sv),
        (vn * vn + v_sd * v_sd, vv, sv * sv),
        (xn * sn, nx, sn * sx),
        (xn * vn + x_on_v * v_sd, vx, sv * sx),
        (xn * xn + x_on_v * x_on_v + x_sd * x_sd, xx, sx * sx),
    ] {
        assert!((got - want).abs() <= 1e-10 * scale, "{case}");
    }
}

#[test]
fn a_transition_under_forcing_follows_the_closed_form() {
    // The noiseless sub-phase by series and doubling compared with divided differences of the
    // exponential, at resonance as well.
    for (alpha, w) in [
        (0.0, 1.0),
        (0.0, 0.25),
        (0.1, 1.75),
        (1.0, 0.25),
        (4.0, 0.0),
    ] {
        let free = ImpulseResponse::new(alpha, 1.0);
        let oscillator = DrivenOscillator::new(1.0, alpha, 1.0, 1.0, 0.0, &[w]);
        for h in [1e-6, 0.01, 0.3, 1.0, 7.0, 100.0] {
            let mut responses = [HarmonicResponse {
                x: (0.0, 0.0),
                v: (0.0, 0.0),
                turn: (1.0, 0.0),
            }];
            let step = oscillator.transition(h, &mut responses);
            let (x, z) = (
                free.exponential(Complex::new(0.0, w), h),
                Complex::new(0.0, w),
            );
            let v = z * x + Complex::new(free.impulse(h), 0.0);
            let [
                HarmonicResponse {
                    x: got_x,
                    v: got_v,
                    turn,
                },
            ] = responses;
            // The phase has a rounding error proportional to h.
            let close =
                |got: f64, want: f64, scale: f64| (got - want).abs() <= 1e-13 * scale * h.max(1.0);
            assert!(
                close(got_x.0, x.re, x.abs()) && close(got_x.1, x.im, x.abs()),
                "{alpha} {w} {h}"
            );
            assert!(
                close(got_v.0, v.re, 1.0) && close(got_v.1, v.im, 1.0),
                "{alpha} {w} {h}"
            );
            assert!(close(turn.0, (w * h).cos(), 1.0) && close(step.x[1], free.impulse(h), 1.0));
            assert!(
                close(step.x[3], free.exponential(Complex::ZERO, h).re, step.x[3]),
                "{alpha} {w} {h}"
            );
        }
    }
}

/// Statistical comparisons are made at 3.9 standard errors, which fail by chance once in 1e4. Seeds
/// are fixed.
const FALSE_ALARM: f64 = 3.9;

/// The sums of one path from which the statistics are computed.
#[derive(Clone, Default)]
struct Fold {
    first_stick: f64,
    entered: f64,
    sticks: f64,
    stick_time: f64,
    slips: f64,
    sub_phases: f64,
    multiple: f64,
    current: f64,
    left: Option<f64>,
    jumps: f64,
    displacement_end: f64,
}

struct Folds(Vec<Fold>);

impl Observer for Folds {
    fn event(&mut self, lane: usize, event: Event) {
        let path = &mut self.0[lane];
        match event.kind {
            EventKind::SlipStarted(_) => {
                let duration = event.time - path.entered;
                if path.left.is_none() {
                    path.first_stick = duration;
                } else {
                    path.sticks += 1.0;
                    path.stick_time += duration;
                }
                path.left = Some(event.displacement);
                path.current = 1.0;
            }
            EventKind::SubPhaseBoundary(_) => path.current += 1.0,
            EventKind::StickEntered => {
                path.slips += 1.0;
                path.sub_phases += path.current;
                path.multiple += f64::from(u8::from(path.current > 1.0));
                path.jumps += (event.displacement - path.left.expect("a slip began")).abs();
                path.entered = event.time;
            }
        }
    }

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if instant == Instant::End {
            self.0
                .iter_mut()
                .zip(s.displacement)
                .for_each(|(path, &x)| path.displacement_end = x);
        }
    }
}

fn folds(model: &Problem, line: &Timeline, tolerance: f64, seed: u64, paths: u64) -> Vec<Fold> {
    let scheme = EventDrivenSimulation::new(model, line, tolerance);
    let mut all = Vec::new();
    for first in (0..paths).step_by(256) {
        let numbers: Vec<u64> = (first..paths.min(first + 256)).collect();
        let mut observer = Folds(vec![Fold::default(); numbers.len()]);
        assert!(
            scheme.simulate(seed, &numbers, &mut observer).is_empty(),
            "no path is given up"
        );
        all.extend(observer.0);
    }
    all
}

/// The ratio sum f / sum g over paths, with the standard error of a ratio whose independent unit is
/// the path.
fn ratio(paths: &[Fold], f: impl Fn(&Fold) -> f64, g: impl Fn(&Fold) -> f64) -> (f64, f64) {
    let (above, below): (f64, f64) = (paths.iter().map(&f).sum(), paths.iter().map(&g).sum());
    let r = above / below;
    let squares: f64 = paths.iter().map(|p| (f(p) - r * g(p)).powi(2)).sum();
    (r, squares.sqrt() / below)
}

/// The statistics of the reference file, in its order, each with its standard error.
fn statistics(paths: &[Fold]) -> [(&'static str, (f64, f64)); 8] {
    let one = |_: &Fold| 1.0;
    [
        (
            "stick_duration_mean",
            ratio(paths, |p| p.stick_time, |p| p.sticks),
        ),
        ("sticks_per_path", ratio(paths, |p| p.sticks, one)),
        ("slips_per_path", ratio(paths, |p| p.slips, one)),
        (
            "displacement_end_mean",
            ratio(paths, |p| p.displacement_end, one),
        ),
        (
            "sub_phases_mean",
            ratio(paths, |p| p.sub_phases, |p| p.slips),
        ),
        (
            "sub_phases_multiple_share",
            ratio(paths, |p| p.multiple, |p| p.slips),
        ),
        ("jump_abs_mean", ratio(paths, |p| p.jumps, |p| p.slips)),
        (
            "first_stick_duration_mean",
            ratio(paths, |p| p.first_stick, one),
        ),
    ]
}

#[test]
fn the_paper_s_noisy_scene_has_the_reference_statistics() {
    // Null hypothesis: the statistics are those of another program that was written independently
    // (tests/reference/noisy.c), up to the 0.1 % that the tolerance allows; the mean of the first
    // stick is exact (backward Kolmogorov equation). Sample size: 2e5 paths. False-alarm rate: 1e-4
    // for each of 8 comparisons.
    let reference = |name: &str| match name {
        "first_stick_duration_mean" => (0.775576827665, 0.0),
        _ => reference::limit(name),
    };
    let paths = folds(
        &paper(0.25, 0.25),
        &timeline(60.0),
        DEFAULT_TOLERANCE,
        2024,
        200_000,
    );
    for (name, (value, error)) in statistics(&paths) {
        let (want, known_to) = reference(name);
        println!("{name}: {value} +- {error}, reference {want} +- {known_to}");
        let allowed = FALSE_ALARM * error.hypot(known_to) + DEFAULT_TOLERANCE * f64::abs(want);
        assert!((value - want).abs() <= allowed, "{name}: {value} {want}");
    }
}

#[test]
fn statistics_do_not_depend_on_the_tolerance() {
    // Null hypothesis: every statistic has the same value for each tolerance and output grid. All
    // statistics exist in this scene, which has three whole forcing periods. Sample size: 25 000 paths
    // on either side, seeds 1 to 5. False-alarm rate: 1e-4 for each of 84 comparisons.
    let line = |output_step| Timeline {
        end: 76.0,
        output_step,
        period: Some(8.0 * std::f64::consts::PI),
        after: 0.0,
    };
    let standard = event_driven_summary(
        &paper(0.25, 0.25),
        &line(60.0),
        DEFAULT_TOLERANCE,
        1,
        25_000,
    );
    let others = [
        (0.5, 60.0, 2),
        (2.0, 60.0, 3),
        (1.0, 0.7, 4),
        (16.0, 0.3, 5),
    ];
    for (factor, output_step, seed) in others {
        let other = event_driven_summary(
            &paper(0.25, 0.25),
            &line(output_step),
            factor * DEFAULT_TOLERANCE,
            seed,
            25_000,
        );
        for statistic in Statistic::asked_by(&Record::NOTHING) {
            let ((a, sa), (b, sb)) = (estimate(&standard, statistic), estimate(&other, statistic));
            let name = statistic.name();
            println!(
                "x{factor}, every {output_step}: {name} {a} {b} ({:+.1} se)",
                (b - a) / sa.hypot(sb)
            );
            assert!(sa > 0.0 && sb > 0.0, "{name} exists");
            assert!(
                (a - b).abs() <= FALSE_ALARM * sa.hypot(sb),
                "x{factor}, every {output_step}: {name} {a} {b}"
            );
        }
    }
}

/// Keeps x and x' of every lane at the end.
struct EndStates(Vec<(f64, f64)>);

impl Observer for EndStates {
    fn event(&mut self, _: usize, _: Event) {}
    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if instant == Instant::End {
            self.0.extend(
                s.displacement
                    .iter()
                    .copied()
                    .zip(s.velocity.iter().copied()),
            );
        }
    }
}

#[test]
fn without_friction_finding_zeros_leaves_the_gaussian_law_alone() {
    // With f_s = f_d = 0 every zero of x' is an event at which the motion is cut and started again.
    // Null hypothesis: (x, x') still has the law of a linear system, the mean and covariance of one
    // exact transition over the whole time. Sample size: 30 000 paths in each of three cases.
    // False-alarm rate: 1e-4 for each of 5 moments in a case.
    for (case, (rho, theta, alpha)) in [(0.25, 1.0, 0.0), (2.0, 0.3, 0.1), (0.5, 4.0, 0.5)]
        .into_iter()
        .enumerate()
    {
        let mut model = paper(0.25, rho);
        model.friction = Friction {
            static_force: 0.0,
            dynamic_force: 0.0,
        };
        model.oscillator.damping = alpha;
        for noise in &mut model.temperature.noises {
            noise.relaxation_rate = theta;
        }
        let end = 8.0;
        let scheme = EventDrivenSimulation::new(&model, &timeline(end), DEFAULT_TOLERANCE);
        let mut states = EndStates(Vec::new());
        for first in (0..30_000).step_by(250) {
            let numbers: Vec<u64> = (first..first + 250).collect();
            assert!(
                scheme
                    .simulate(case as u64, &numbers, &mut states)
                    .is_empty()
            );
        }
        let mut response = [HarmonicResponse {
            x: (0.0, 0.0),
            v: (0.0, 0.0),
            turn: (1.0, 0.0),
        }];
        let law = DrivenOscillator::new(1.0, alpha, 1.0, theta, 6.0 * rho, &[0.25])
            .transition(end, &mut response);
        let (mx, mv) = (
            6.0 * law.x[0] + 6.0 * response[0].x.0,
            6.0 * law.v[0] + 6.0 * response[0].v.0,
        );
        let [_, _, _, vv, vx, xx] = law.covariance;
        let n = states.0.len() as f64;
        let mean = |f: &dyn Fn(f64, f64) -> f64| {
            states
                .0
                .iter()
                .map(|&(x, v)| f(x - mx, v - mv))
                .sum::<f64>()
                / n
        };
        for (name, got, want, sd) in [
            ("mean x", mean(&|x, _| x), 0.0, xx.sqrt()),
            ("mean v", mean(&|_, v| v), 0.0, vv.sqrt()),
            ("var x", mean(&|x, _| x * x), xx, 2f64.sqrt() * xx),
            ("var v", mean(&|_, v| v * v), vv, 2f64.sqrt() * vv),
            ("cov", mean(&|x, v| x * v), vx, (xx * vv + vx * vx).sqrt()),
        ] {
            let z = (got - want) / (sd / n.sqrt());
            println!("case {case} {name}: {got} {want} ({z:+.1} se)");
            assert!(z.abs() <= FALSE_ALARM, "case {case} {name}: {got} {want}");
        }
    }
}

fn path_events(model: &Problem, end: f64, seed: u64, numbers: &[u64]) -> Vec<Vec<Event>> {
    let mut recorder = Recorder::default();
    let line = Timeline {
        end,
        output_step: 0.7,
        period: None,
        after: 0.0,
    };
    assert!(
        EventDrivenSimulation::new(model, &line, DEFAULT_TOLERANCE)
            .simulate(seed, numbers, &mut recorder)
            .is_empty()
    );
    recorder.events
}

#[test]
fn a_path_is_a_function_of_the_seed_and_its_number_alone() {
    let model = paper(0.25, 0.25);
    let together = path_events(&model, 60.0, 9, &[3, 4, 5, 1 << 40]);
    for (lane, number) in [3, 4, 5, 1 << 40].into_iter().enumerate() {
        assert_eq!(together[lane], path_events(&model, 60.0, 9, &[number])[0]);
    }
    assert_ne!(together[0], together[1]);
    assert_ne!(together[0], path_events(&model, 60.0, 10, &[3])[0]);
}

/// x, x', T, and whether the path is static.
type State = (f64, f64, f64, bool);

/// Keeps everything that is reported of some paths: the events, and the states at the rows, lane by
/// lane.
#[derive(Default, PartialEq, Debug)]
struct Reported {
    events: Vec<Vec<Event>>,
    rows: Vec<(f64, Vec<State>)>,
}

impl Observer for Reported {
    fn event(&mut self, lane: usize, event: Event) {
        if self.events.len() <= lane {
            self.events.resize(lane + 1, Vec::new());
        }
        self.events[lane].push(event);
    }

    fn snapshot(&mut self, _: Instant, s: Snapshot<'_>) {
        let lanes = s
            .displacement
            .iter()
            .zip(s.velocity)
            .zip(s.temperature)
            .zip(s.is_static);
        self.rows.push((
            s.time,
            lanes
                .map(|(((x, v), t), is_static)| (*x, *v, *t, *is_static))
                .collect(),
        ));
    }
}

/// Whatever the output grid is, the events are the same to the last bit, and so is the state
/// wherever a row lies at the end of a macro step (multiples of 0.5 in this scene). If the run ends
/// in the middle of a macro step, also of the first, the path is the same up to that time.
#[test]
fn looking_at_a_path_does_not_change_it() {
    let mut forced = paper(0.25, 0.25);
    let own = Expression::parse("-0.02*x^3 + 0.3*sin(t) - 0.1*xdot*abs(xdot)", &[])
        .expect("an expression");
    forced.force = Some(Force::new(own));
    let numbers: Vec<u64> = (0..200).collect();
    let scenes = [
        (Kind::EventDriven, paper(0.25, 0.25)),
        (Kind::QuasiStatic, paper(0.25, 0.25)),
        (Kind::EventDriven, forced),
    ];
    for (kind, model) in scenes {
        let reported = |end: f64, output_step: f64, period: Option<f64>| {
            let line = Timeline {
                end,
                after: 0.0,
                output_step,
                period,
            };
            let mut reported = Reported::default();
            let simulation = kind.with(DEFAULT_TOLERANCE).simulation(&model, &line);
            assert!(simulation.simulate(5, &numbers, &mut reported).is_empty());
            reported
        };
        let seldom = reported(60.0, 60.0, None);
        assert!(seldom.events.iter().map(Vec::len).sum::<usize>() > 200 * 10);
        for (output_step, period) in [
            (0.5, None),
            (0.07, Some(8.0 * std::f64::consts::PI)),
            (1.0, Some(0.3)),
        ] {
            let often = reported(60.0, output_step, period);
            assert_eq!(often.events, seldom.events, "{kind:?}, every {output_step}");
            assert_eq!(
                often.rows.last(),
                seldom.rows.last(),
                "{kind:?}, every {output_step}"
            );
        }
        let (half, whole) = (reported(60.0, 0.5, None), reported(60.0, 0.25, None));
        for (row, same) in half
            .rows
            .iter()
            .zip(whole.rows.iter().filter(|row| (2.0 * row.0).fract() == 0.0))
        {
            assert_eq!(row, same, "{kind:?}");
        }
        // A finer output grid passes through the states of a coarser one, also inside macro steps.
        let coarse = reported(60.0, 0.7, None);
        let line = Timeline {
            end: 60.0,
            after: 0.0,
            output_step: 0.1,
            period: None,
        };
        let mut close = Reported::default();
        let simulation = kind
            .with(DEFAULT_TOLERANCE)
            .simulation(&model, &line)
            .with_additional_rows(7);
        assert!(simulation.simulate(5, &numbers, &mut close).is_empty());
        assert_eq!(close.events, seldom.events, "{kind:?}");
        for (row, same) in coarse
            .rows
            .iter()
            .zip(close.rows.iter().step_by(7))
            .take(86)
        {
            assert!((row.0 - same.0).abs() < 1e-12, "{} {}", row.0, same.0);
            for (a, b) in row.1.iter().zip(&same.1) {
                let off = (a.0 - b.0)
                    .abs()
                    .max((a.1 - b.1).abs())
                    .max((a.2 - b.2).abs());
                assert!(
                    off < 1e-9 && a.3 == b.3,
                    "{kind:?}, t = {}: {a:?} {b:?}",
                    row.0
                );
            }
        }
        for end in [31.3, 0.3] {
            let short = reported(end, end, None);
            assert!(
                short.events.iter().any(|events| !events.is_empty()),
                "{kind:?}, {end}"
            );
            for (lane, long) in seldom.events.iter().enumerate() {
                let until: Vec<Event> = long
                    .iter()
                    .copied()
                    .filter(|event| event.time <= end)
                    .collect();
                let none = Vec::new();
                assert_eq!(
                    *short.events.get(lane).unwrap_or(&none),
                    until,
                    "{kind:?}, {end}"
                );
            }
        }
    }
}

/// A slip begins 2e-9 before the end of a macro step at t = 2.5, where it is too short for an exact
/// step, and a row lies in its middle. The forcing is that of the paper, shifted so that |b| = f_s
/// there; the noise moves this time by 6e-11. At the row the body has moved for 1e-9 with the
/// acceleration -(f_s - f_d)/m = -0.2, and T is the forcing.
#[test]
fn a_slip_that_begins_just_before_the_end_of_a_cell_is_observed() {
    let (exit, row, w) = (2.5 - 2e-9, 2.5 - 1e-9, 0.25);
    let mut model = paper(w, 1e-11);
    let phase = w * (2.574_004_435_173_137_6 - exit);
    model.temperature.harmonics[0].phase = phase;
    let line = Timeline {
        end: 3.0,
        output_step: row,
        period: None,
        after: 0.0,
    };
    let mut reported = Reported::default();
    let simulation = EventDrivenSimulation::new(&model, &line, DEFAULT_TOLERANCE);
    assert!(
        simulation
            .simulate(3, &(0..20).collect::<Vec<_>>(), &mut reported)
            .is_empty()
    );
    for (x, v, temperature, is_static) in &reported.rows[1].1 {
        assert!(
            !is_static && *x <= 6.0 && (x - 6.0).abs() < 1e-15,
            "{x} {is_static}"
        );
        assert!((v / (-0.2 * 1e-9) - 1.0).abs() < 0.5, "{v}");
        assert!(
            (temperature - (w * row + phase).cos()).abs() < 1e-9,
            "{temperature}"
        );
    }
}

/// Under weak noise, rows every twentieth of the fastest time scale show the noise that moves the
/// body: from row to row, through slips, stops and sticks, v is an Ornstein-Uhlenbeck process.
/// Null: the squared innovations over such a step, divided by their variance, have mean 1. With
/// 100 paths and 400 rows the standard error is 0.7 %, and 4 of them are allowed for each of three
/// noises, which is exceeded by chance once in 5000 runs of the test. If the states inside a step
/// were drawn with twice their spread, the mean would be 2.6.
#[test]
fn under_weak_noise_rows_show_the_noise_that_moves_the_body() {
    let (w, lag) = (0.25, 0.05);
    for rho in [1e-3, 1e-5, 1e-7] {
        let line = Timeline {
            end: 20.0,
            output_step: lag,
            period: None,
            after: 0.0,
        };
        let simulation = EventDrivenSimulation::new(&paper(w, rho), &line, DEFAULT_TOLERANCE);
        let mut reported = Reported::default();
        assert!(
            simulation
                .simulate(11, &(0..100).collect::<Vec<_>>(), &mut reported)
                .is_empty()
        );
        let v = |(t, seen): &(f64, Vec<State>), lane: usize| (seen[lane].2 - (w * t).cos()) / rho;
        let (decay, variance) = ((-lag).exp(), 0.5 * (1.0 - (-2.0 * lag).exp()));
        let rows = &reported.rows[..=400];
        let squares = rows.windows(2).flat_map(|pair| {
            (0..100).map(|lane| (v(&pair[1], lane) - decay * v(&pair[0], lane)).powi(2) / variance)
        });
        let mean = squares.sum::<f64>() / 40_000.0;
        println!("rho = {rho:e}: {mean}");
        assert!(
            (mean - 1.0).abs() < 4.0 * (2.0 / 40_000.0_f64).sqrt(),
            "rho = {rho:e}: {mean}"
        );
    }
}

/// Moments of the states at one instant, each with its standard error: of x, x', T and of whether
/// the path is static, of the noise where it is static, and of x' where it slips.
fn seen_moments(
    model: &Problem,
    tolerance: f64,
    times: &[f64],
    seed: u64,
    paths: u64,
) -> Vec<Vec<(f64, f64)>> {
    let line = Timeline {
        end: times[times.len() - 1],
        after: 0.0,
        output_step: times[0],
        period: None,
    };
    let simulation = EventDrivenSimulation::new(model, &line, tolerance);
    let mut rows: Vec<Vec<State>> = vec![Vec::new(); times.len() + 1];
    for first in (0..paths).step_by(250) {
        let numbers: Vec<u64> = (first..first + 250).collect();
        let mut reported = Reported::default();
        assert!(
            simulation
                .simulate(seed, &numbers, &mut reported)
                .is_empty()
        );
        for (row, (_, seen)) in rows.iter_mut().zip(reported.rows) {
            row.extend(seen);
        }
    }
    let measures: [fn(&State) -> f64; 9] = [
        |s| s.0,
        |s| s.0 * s.0,
        |s| s.1,
        |s| s.1 * s.1,
        |s| s.2,
        |s| s.2 * s.2,
        |s| f64::from(u8::from(s.3)),
        // b where the path is static: how near it is to the thresholds, on either side.
        |s| f64::from(u8::from(s.3)) * (6.0 * s.2 - s.0).powi(2),
        |s| f64::from(u8::from(!s.3)) * s.1 * (6.0 * s.2 - s.0),
    ];
    let moments = |row: &Vec<State>| {
        measures
            .iter()
            .map(|f| mean_and_error(&row.iter().map(f).collect::<Vec<_>>()))
            .collect()
    };
    rows[1..].iter().map(moments).collect()
}

fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (
        mean,
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt(),
    )
}

/// Null hypothesis: a state that is drawn inside a macro step has the same law as one at the end of
/// a macro step. At the default tolerance macro steps are 0.5 long, and t = 0.7, 1.4, .. lies
/// inside them except for every fifth. At 1/25 of that tolerance macro steps are 0.1 long, and all
/// of these times are ends. Sample size: 1e5 paths on either side, seeds 61 and 62. False-alarm
/// rate: 1e-4 for each of 9 moments at 10 instants. If the bridge in a stick were drawn without the
/// condition that it stays in the band, or if the noise in a slip were twice too large between
/// ends, the moments would be off by tens of standard errors.
#[test]
fn what_is_seen_inside_a_cell_has_the_law_of_the_path() {
    let model = paper(0.25, 0.25);
    let times: Vec<f64> = (1..=10).map(|k| 0.7 * f64::from(k)).collect();
    let inside = seen_moments(&model, DEFAULT_TOLERANCE, &times, 61, 100_000);
    let ends = seen_moments(&model, DEFAULT_TOLERANCE / 25.0, &times, 62, 100_000);
    let mut worst = 0.0f64;
    for ((time, inside), ends) in times.iter().zip(inside).zip(ends) {
        for (i, ((a, ea), (b, eb))) in inside.into_iter().zip(ends).enumerate() {
            let z = (a - b) / ea.hypot(eb).max(1e-300);
            worst = worst.max(z.abs());
            assert!(
                z.abs() <= FALSE_ALARM,
                "t = {time}, moment {i}: {a} +- {ea}, {b} +- {eb}"
            );
        }
    }
    println!("largest difference: {worst:.1} standard errors");
}

/// The squares of the increments of T from row to row, divided by their variance.
struct Increments {
    rate: f64,
    variance: f64,
    before: Vec<f64>,
    squares: Vec<f64>,
}

impl Observer for Increments {
    fn event(&mut self, _: usize, _: Event) {}

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if let Instant::Output(row) = instant {
            for (before, now) in self.before.iter_mut().zip(s.temperature) {
                let added = now - (-self.rate).exp() * *before;
                *before = *now;
                if row > 0 {
                    self.squares.push(added * added / self.variance);
                }
            }
        }
    }
}

/// In a slip whose forces are 1e9 times larger than the changes by the noise, the noise cannot be
/// recovered from the forces. Null hypothesis: T still has the increments of the noise from row to
/// row. Sample size: 40 rows inside one macro step (0.5 long) in each of 500 paths, whose scaled
/// squares have the mean 1 +- 0.01; seed 12. False-alarm rate: 1e-4 for each comparison. The same
/// holds where four of five rows come from a finer output grid. If rows were drawn one by one from
/// the law given both ends of the macro step, the mean would be 18.
#[test]
fn in_a_slip_the_temperature_follows_feeble_noise() {
    let mut model = paper(0.25, 0.25);
    model.temperature.harmonics.clear();
    model.initial_displacement = 1e9;
    let (step, numbers): (f64, Vec<u64>) = (0.01, (0..500).collect());
    let line = Timeline {
        end: 0.4,
        output_step: step,
        period: None,
        after: 0.0,
    };
    let variance = 0.25 * 0.25 * -(-2.0 * step).exp_m1() / 2.0;
    for row_stride in [1, 5] {
        let before = vec![0.0; numbers.len()];
        let mut increments = Increments {
            rate: step,
            variance,
            before,
            squares: Vec::new(),
        };
        let simulation = EventDrivenSimulation::new(&model, &line, DEFAULT_TOLERANCE)
            .with_additional_rows(row_stride);
        assert!(
            simulation
                .simulate(12, &numbers, &mut increments)
                .is_empty()
        );
        let (mean, error) = mean_and_error(&increments.squares);
        println!("row_stride {row_stride}: {mean:.4} +- {error:.4}");
        assert_eq!(increments.squares.len(), 40 * 500);
        assert!(
            (mean - 1.0).abs() <= FALSE_ALARM * error,
            "row_stride {row_stride}: {mean} +- {error}"
        );
    }
}

/// Two scenes with the same seed see the same noise: the variance of the difference of independent
/// runs divided by that of runs with one seed, for rho = 0.25 and 0.2525. 2e4 paths, so that these
/// gains are known to some 5 %; each must reach nine tenths of a target.
#[test]
fn two_scenes_see_the_same_noise() {
    let runs = [0.25, 0.2525].map(|rho| {
        folds(
            &paper(0.25, rho),
            &timeline(60.0),
            DEFAULT_TOLERANCE,
            17,
            20_000,
        )
    });
    let mean = |paths: &[Fold], f: &dyn Fn(&Fold) -> f64| {
        paths.iter().map(f).sum::<f64>() / paths.len() as f64
    };
    // The contribution of a path to a ratio of means, to first order.
    let shares = |paths: &[Fold], f: fn(&Fold) -> f64, g: fn(&Fold) -> f64| -> Vec<f64> {
        let (below, ratio) = (mean(paths, &g), mean(paths, &f) / mean(paths, &g));
        paths
            .iter()
            .map(|p| (f(p) - ratio * g(p)) / below)
            .collect()
    };
    let variance = |values: &[f64]| {
        let (_, error) = mean_and_error(values);
        error * error * values.len() as f64
    };
    let one: fn(&Fold) -> f64 = |_| 1.0;
    type Measure = fn(&Fold) -> f64;
    let cases: [(&str, Measure, Measure, f64); 4] = [
        ("static time between sticks", |p| p.stick_time, one, 50.0),
        ("mean stick", |p| p.stick_time, |p| p.sticks, 7.0),
        ("sticks per path", |p| p.sticks, one, 10.0),
        ("x at the end", |p| p.displacement_end, one, 1000.0),
    ];
    for (name, f, g, target) in cases {
        let [a, b] = [shares(&runs[0], f, g), shares(&runs[1], f, g)];
        let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
        let gain = (variance(&a) + variance(&b)) / variance(&differences);
        println!("{name}: {gain:.1} (target {target})");
        assert!(gain > 0.9 * target, "{name}: {gain}");
    }
}

#[test]
fn events_alternate_and_carry_consistent_forces() {
    let model = paper(0.25, 0.25);
    for events in path_events(&model, 60.0, 1, &(0..500).collect::<Vec<_>>()) {
        let (mut time, mut slipping) = (0.0, false);
        for event in &events {
            assert!(event.time >= time && event.time <= 60.0);
            time = event.time;
            match event.kind {
                EventKind::SlipStarted(sign) => {
                    assert!(!slipping && (event.force - 1.2 * sign.value()).abs() < 1e-12);
                    slipping = true;
                }
                EventKind::SubPhaseBoundary(sign) => {
                    assert!(slipping && event.force * sign.value() > 1.2);
                }
                EventKind::StickEntered => {
                    assert!(slipping && event.force.abs() <= 1.2);
                    slipping = false;
                }
            }
        }
    }
}

#[test]
fn units_do_not_matter_path_by_path() {
    // Length and force in units of 1/4, and time in units of 1/2 (the mass keeps K/m). These are
    // powers of two, so only the transcendental functions may round differently, and paths stay
    // together until rounding decides an event.
    let model = paper(0.25, 0.25);
    let mut scaled = model.clone();
    let (length, time) = (4.0, 2.0);
    scaled.oscillator.mass = time * time;
    scaled.oscillator.drive = Drive::Dilatation(model.oscillator.rest_position(length));
    scaled.friction = Friction {
        static_force: 1.2 * length,
        dynamic_force: length,
    };
    scaled.initial_displacement *= length;
    scaled.temperature.harmonics[0].angular_frequency /= time;
    for noise in &mut scaled.temperature.noises {
        (noise.relaxation_rate, noise.diffusion) = (1.0 / time, 1.0 / f64::sqrt(time));
    }
    let line = |unit: f64| Timeline {
        end: 60.0 * unit,
        output_step: 60.0 * unit,
        period: None,
        after: 0.0,
    };
    let events = |model: &Problem, unit| {
        let mut recorder = Recorder::default();
        let numbers: Vec<u64> = (0..100).collect();
        EventDrivenSimulation::new(model, &line(unit), DEFAULT_TOLERANCE).simulate(
            3,
            &numbers,
            &mut recorder,
        );
        recorder.events
    };
    for (a, b) in events(&model, 1.0).iter().zip(&events(&scaled, time)) {
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(b) {
            assert_eq!(a.kind, b.kind);
            assert!(
                (a.time - b.time / time).abs() < 1e-7
                    && (a.displacement - b.displacement / length).abs() < 1e-7
            );
        }
    }
}

#[test]
fn vanishing_noise_recovers_the_deterministic_cascade() {
    // The noise n has a standard deviation of 4.2 rho and enters t, x and b with factors of order
    // one. The bound is ten standard deviations. The end of a slip is searched on an interpolated
    // motion, which alone would be off by 1e-4 here, and is then moved to the exact one.
    for (rho, within) in [(1e-9, 5e-8), (1e-12, 1e-10)] {
        let mut worst = 0.0f64;
        for events in path_events(&paper(0.25, rho), 139.0, 4, &[0, 1, 2]) {
            assert_eq!(events.len(), QUARTER.len());
            for (event, &(kind, t, x, b)) in events.iter().zip(QUARTER) {
                assert_eq!(kind_number(event.kind), kind);
                for (got, want) in [(event.time, t), (event.displacement, x), (event.force, b)] {
                    worst = worst.max((got - want).abs());
                }
            }
        }
        println!("rho = {rho:e}: within {worst:e}");
        assert!(worst < within, "rho = {rho:e}: off by {worst:e}");
    }
}

#[test]
fn equal_thresholds_under_noise_have_a_stated_resolution() {
    let mut model = paper(0.25, 0.25);
    model.friction.static_force = 1.0;
    let scheme = EventDrivenSimulation::new(&model, &timeline(60.0), DEFAULT_TOLERANCE);
    let resolution = scheme.resolution().expect("stated");
    assert!(
        resolution.static_force > 1.0
            && resolution.static_force < 1.01
            && resolution.shortest_slip > 0.0
    );
    let paths = folds(&model, &timeline(60.0), DEFAULT_TOLERANCE, 1, 256);
    let (sticks, _) = ratio(&paths, |p| p.sticks, |_| 1.0);
    assert!(
        sticks > 50.0 && sticks < 1e4,
        "many, but not without bound: {sticks}"
    );
    assert!(
        EventDrivenSimulation::new(&paper(0.25, 0.25), &timeline(60.0), DEFAULT_TOLERANCE)
            .resolution()
            .is_none()
    );
}

/// The number of evaluations of a path is bounded by what happens on it and not by how extreme its
/// numbers are. The bounds are twice what was counted, and far below the 10^8 evaluations at which
/// a path is given up. They are counts, so they are the same on any machine. A limit below what a
/// path needs is respected as well: the path is given up, and no further evaluation is made.
#[test]
fn extreme_scenes_end_in_bounded_work() {
    // ((rho, theta, f_s, f_d, alpha, t_end), the most evaluations of a path)
    for ((rho, theta, f_s, f_d, alpha, end), most) in [
        ((100.0, 1.0, 1.2, 1.0, 0.0, 10.0), 640),
        ((1e6, 1.0, 1.2, 1.0, 0.0, 1.0), 1_240),
        ((1e-300, 1.0, 1.2, 1.0, 0.0, 10.0), 2),
        ((0.25, 300.0, 1.2, 1.0, 0.0, 10.0), 20_200),
        ((0.25, 1e-6, 1.2, 1.0, 0.0, 60.0), 1_000),
        ((0.25, 1.0, 0.0, 0.0, 0.0, 10.0), 730),
        ((0.25, 1.0, 1.2, 0.0, 0.0, 10.0), 80),
        ((0.25, 1.0, 1e9, 1.0, 0.0, 1e4), 40_000),
        ((0.25, 1.0, 1.2, 1.0, 20.0, 10.0), 1_360),
        ((0.25, 1.0, 1.2, 1.0, 0.0, 0.0), 1),
    ] {
        let mut model = paper(0.25, rho);
        model.friction = Friction {
            static_force: f_s,
            dynamic_force: f_d,
        };
        model.oscillator.damping = alpha;
        for noise in &mut model.temperature.noises {
            noise.relaxation_rate = theta;
        }
        let scheme = EventDrivenSimulation::new(&model, &timeline(end), DEFAULT_TOLERANCE);
        let paths: Vec<u64> = (0..8).collect();
        let counted = |scheme: &EventDrivenSimulation| {
            let mut folds = Folds(vec![Fold::default(); paths.len()]);
            let simulated = scheme.simulate_counting(1, &paths, &mut folds);
            (simulated, folds.0)
        };
        let (simulated, folds) = counted(&scheme);
        println!(
            "{rho} {theta} {f_s} {f_d} {alpha} {end}: {} evaluations a path",
            simulated.evaluations / 8
        );
        assert!(
            simulated.lost.is_empty() && folds.iter().all(|p| p.displacement_end.is_finite()),
            "{rho} {theta} {f_s} {f_d} {alpha}"
        );
        let each = simulated.evaluations / 8;
        assert!(
            (most / 4..=most.max(1)).contains(&each),
            "{rho} {theta} {f_s} {f_d} {alpha}: {each}"
        );
        let limit = simulated.evaluations / 8 / 4;
        let (limited, _) = counted(&scheme.with_work_limit(limit));
        assert!(limited.evaluations <= 8 * limit, "{limit} {limited:?}");
        assert!(
            limited.lost.len() == 8 || simulated.evaluations < 8 * 8,
            "{limit} {limited:?}"
        );
    }
}

#[test]
fn the_viaduct_slips_seldom_and_briefly() {
    // 300 days. Slips last pi/w0 = 0.0723 s and move 2 (f_s - f_d)/K = 0.498 mm, because the
    // temperature hardly changes meanwhile: its noise moves the force by s sqrt(pi/w0) = 300 N, 0.6
    // % of f_s - f_d.
    let mut recorder = Recorder::default();
    let line = Timeline {
        end: 2.592e7,
        output_step: 3600.0,
        period: None,
        after: 0.0,
    };
    let numbers: Vec<u64> = (0..16).collect();
    let clock = std::time::Instant::now();
    let scheme = EventDrivenSimulation::new(&shipped_model("viaduct"), &line, DEFAULT_TOLERANCE);
    assert!(scheme.simulate(1, &numbers, &mut recorder).is_empty());
    println!(
        "{:?} a path, {} events",
        clock.elapsed() / 16,
        recorder.events[0].len()
    );
    assert!(scheme.resolution().is_none());
    for events in &recorder.events {
        assert!(events.len() > 200, "{}", events.len());
        for pair in events
            .windows(2)
            .filter(|pair| pair[1].kind == EventKind::StickEntered)
        {
            let (duration, jump) = (
                pair[1].time - pair[0].time,
                pair[1].displacement - pair[0].displacement,
            );
            assert!(
                (duration / (std::f64::consts::PI / 1888f64.sqrt()) - 1.0).abs() < 4e-2,
                "{duration}"
            );
            assert!(
                (jump.abs() / (2.0 * 0.047e6 / 1.888e8) - 1.0).abs() < 4e-2,
                "{jump}"
            );
        }
    }
}

#[test]
fn the_quasi_static_recursion_is_the_paper_s() {
    // Slow forcing, w = w0/1000: the exits where 6 cos(w t) = x_j -+ f_s, computed independently,
    // and slips that last pi/w0 and move 2 (f_s - f_d)/K.
    let (w, f_s, jump) = (1e-3, 1.2, 0.4);
    let mut model = paper(w, 0.0);
    // From 6, jumps of 0.4 would meet the extremum of the forcing to the last digit.
    model.initial_displacement = 5.9;
    let mut recorder = Recorder::default();
    let line = Timeline {
        end: 10_000.0,
        output_step: 100.0,
        period: None,
        after: 0.0,
    };
    assert!(
        QuasiStaticSimulation::new(&model, &line, DEFAULT_TOLERANCE)
            .simulate(0, &[0, 1], &mut recorder)
            .is_empty()
    );
    assert_eq!(recorder.events[0], recorder.events[1]);
    let (mut x, mut t): (f64, f64) = (5.9, 0.0);
    for pair in recorder.events[0].chunks_exact(2) {
        // The next time after t at which 6 cos(w t) leaves [x - f_s, x + f_s]: the earlier of the
        // crossings of the two thresholds.
        let crossings = [x - f_s, x + f_s]
            .into_iter()
            .filter(|level: &f64| level.abs() <= 6.0)
            .flat_map(|level| {
                let angle = (level / 6.0).acos();
                let turn = std::f64::consts::TAU;
                [angle, turn - angle].map(|a| (a + turn * ((w * t - a) / turn).ceil().max(0.0)) / w)
            });
        // A stick that begins outside the stick band has no duration.
        let outside = (6.0 * (w * t).cos() - x).abs() > f_s;
        let exit = if outside {
            t
        } else {
            crossings.fold(f64::INFINITY, f64::min)
        };
        let eps = (6.0 * (w * exit).cos() - x).signum();
        (x, t) = (x + eps * jump, exit + std::f64::consts::PI);
        assert!(
            (pair[0].time - exit).abs() < 1e-9,
            "{} {exit}",
            pair[0].time
        );
        assert!((pair[1].time - t).abs() < 1e-9 && (pair[1].displacement - x).abs() < 1e-12);
    }
    assert!(recorder.events[0].len() > 60);
}

#[test]
fn quasi_static_with_equal_thresholds_never_moves() {
    let mut model = paper(0.25, 0.25);
    model.friction.static_force = 1.0;
    let mut recorder = Recorder::default();
    let line = Timeline {
        end: 60.0,
        output_step: 0.5,
        period: None,
        after: 0.0,
    };
    assert!(
        QuasiStaticSimulation::new(&model, &line, DEFAULT_TOLERANCE)
            .simulate(1, &[0], &mut recorder)
            .is_empty()
    );
    assert!(recorder.rows.iter().all(|row| row.2 == 6.0 && row.3 == 0.0));
    assert!(!recorder.events[0].is_empty());
}

#[test]
fn quasi_static_holds_on_the_viaduct_not_under_fast_forcing() {
    // Null hypothesis: both schemes have the same mean number of slips and the same mean final
    // displacement. Sample size: 400 paths on either side. False-alarm rate: 1e-4 for each
    // comparison. The laws differ by the work of the noise during a slip of 0.07 s, which is far
    // too small to be seen with 400 paths.
    let line = Timeline {
        end: 2.592e7,
        output_step: 2.592e7,
        period: None,
        after: 0.0,
    };
    let fold = |numbers: std::ops::Range<u64>, quasi: bool, model: &Problem, line: &Timeline| {
        let numbers: Vec<u64> = numbers.collect();
        let mut observer = Folds(vec![Fold::default(); numbers.len()]);
        let failed = if quasi {
            QuasiStaticSimulation::new(model, line, DEFAULT_TOLERANCE).simulate(
                1,
                &numbers,
                &mut observer,
            )
        } else {
            EventDrivenSimulation::new(model, line, DEFAULT_TOLERANCE).simulate(
                1,
                &numbers,
                &mut observer,
            )
        };
        assert!(failed.is_empty());
        observer.0
    };
    let exact = fold(0..400, false, &shipped_model("viaduct"), &line);
    let quasi = fold(400..800, true, &shipped_model("viaduct"), &line);
    let measures: [fn(&Fold) -> f64; 3] = [|p| p.slips, |p| p.displacement_end, |p| p.jumps];
    for (i, measure) in measures.into_iter().enumerate() {
        let ((a, sa), (b, sb)) = (
            ratio(&exact, measure, |_| 1.0),
            ratio(&quasi, measure, |_| 1.0),
        );
        println!("measure {i}: event-driven {a} +- {sa}, quasi-static {b} +- {sb}");
        assert!(
            (a - b).abs() <= FALSE_ALARM * sa.hypot(sb),
            "{i}: {a} +- {sa}, {b} +- {sb}"
        );
    }
    // At w = w0/4 slips move by 12 and not by 0.4.
    let jump = |quasi| {
        ratio(
            &fold(0..64, quasi, &paper(0.25, 0.0), &timeline(139.0)),
            |p| p.jumps,
            |p| p.slips,
        )
        .0
    };
    assert!(jump(false) > 12.0 && (jump(true) - 0.4).abs() < 1e-12);
}

#[test]
fn the_quasi_static_approximation_fails_where_forcing_is_fast() {
    // The numbers of docs/event-driven.md: mean |x_{j+1} - x_j| over ten periods, without noise.
    println!("| w/w0 | event-driven | quasi-static |\n|---|---|---|");
    let mut excesses = Vec::new();
    for w in [1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.25] {
        let line = timeline(10.0 * std::f64::consts::TAU / w);
        let jump =
            |quasi: bool| {
                let mut observer = Folds(vec![Fold::default()]);
                let failed =
                    if quasi {
                        QuasiStaticSimulation::new(&paper(w, 0.0), &line, DEFAULT_TOLERANCE)
                            .simulate(0, &[0], &mut observer)
                    } else {
                        EventDrivenSimulation::new(&paper(w, 0.0), &line, DEFAULT_TOLERANCE)
                            .simulate(0, &[0], &mut observer)
                    };
                assert!(failed.is_empty());
                ratio(&observer.0, |p| p.jumps, |p| p.slips).0
            };
        println!("| {w} | {:.4} | {:.4} |", jump(false), jump(true));
        excesses.push(jump(false) / jump(true) - 1.0);
    }
    assert!(
        excesses.windows(2).all(|pair| pair[1] > pair[0]),
        "the faster, the worse: {excesses:?}"
    );
    assert!(excesses[0] < 0.01 && excesses[6] > 10.0);
}
