//! What is measured along the motion and not on the rows of a run: works, extremes and densities,
//! against closed forms, against sums over fine rows, and against the balance of energy.

use super::measures::{body, run, scenario};
use std::sync::atomic::AtomicBool;
use stickslip::dataset::Recorder;
use stickslip::engine::Run;
use stickslip::model::{Expression, Force, Sign};
use stickslip::scenario::Scenario;
use stickslip::scheme::{CorrectedVi, EventDriven, QuasiStatic};
use stickslip::stats::{PassageLevels, Statistic, Summary};
use stickslip::study::sweep::{Design, Seeds, Sweep, SweepAxis, SweepQuestion, SweepSimulation};

fn shipped(name: &str, paths: u64) -> Scenario {
    let mut scenario = Scenario::shipped(name).expect("shipped");
    scenario.ensemble.paths = paths;
    scenario.record = stickslip::stats::Record {
        energy: true,
        ..stickslip::stats::Record::NOTHING
    };
    scenario.record.levels = PassageLevels::of(&[scenario.model.length_scale(scenario.time.end)]);
    scenario
}

fn event_driven(scenario: Scenario) -> Scenario {
    scenario
        .with_scheme(EventDriven { tolerance: 1e-3 })
        .expect("suits")
}

fn of(summary: &Summary, statistic: Statistic) -> f64 {
    summary.estimate(statistic).estimate
}

/// T is known at every time, so that its work is an integral of its own, and the balance tests all
/// works: closed forms with damping, a cubic spring, a belt, an elastic stop of K = 1000, and the
/// swings of 0.07 s of the bridge, which is quasi-static, where the work of the temperature is that of
/// the one that is held. At most 3e-13 of the work of friction was found.
#[test]
fn without_noise_the_balance_of_energy_closes() {
    let mut scenes = Vec::new();
    let mut add = |name: &str, change: &dyn Fn(&mut Scenario)| {
        let mut scene = event_driven(shipped(name, 1));
        scene.model.temperature.noises.clear();
        change(&mut scene);
        scenes.push((format!("{name} {}", scenes.len()), scene));
    };
    add("shaw", &|scene| scene.model.oscillator.damping = 0.05);
    add("damped", &|_| ());
    add("duffing", &|_| ());
    add("belt", &|_| ());
    add("shaw", &|scene| {
        let stop =
            Expression::parse("-1000*(max(0, x - 5) + min(0, x + 5))", &[]).expect("an expression");
        scene.model.force = Some(Force::new(stop));
    });
    add("viaduct", &|scene| {
        *scene = scene
            .with_scheme(QuasiStatic { tolerance: 1e-3 })
            .expect("suits")
    });
    for (name, scene) in &scenes {
        let summary = run(scene);
        let [residual, friction] =
            [Statistic::EnergyResidualMean, Statistic::FrictionWorkMean].map(|s| of(&summary, s));
        println!("{name}: {:e} of {friction}", residual / friction);
        assert!(
            friction > 0.0 && residual.abs() < 1e-9 * friction,
            "{name}: {residual} of {friction}"
        );
    }
}

/// Under noise, works and extremes are those that sums over 100 000 rows of the same paths give. The
/// rows are drawn given the steps of the path, so that the sums share its events and nothing else:
/// the work of the temperature is the sum of its mean over two rows times their distance, which
/// knows nothing of the balance of energy. What is left of the sums falls with the spacing of the
/// rows; the bounds of works are some ten times what was found, and far below the 1 to 16 % by which
/// works from coarse rows were off. The largest speed between the steps of a path is that of its mean
/// motion there, 0.2 % below that of the rows.
#[test]
fn works_and_extremes_under_noise_are_those_of_the_finest_rows() {
    for (name, scene, tolerated) in [
        (
            "damped",
            event_driven(shipped("damped", 24)),
            [1e-4, 1e-4, 5e-3],
        ),
        (
            "noise of theta = 200",
            {
                let mut scene = event_driven(shipped("damped", 8));
                let noise = scene.model.temperature.noises.first_mut().expect("noisy");
                (noise.relaxation_rate, noise.diffusion) = (200.0, 200.0);
                scene
            },
            [5e-3, 1e-3, 5e-3],
        ),
        (
            "load",
            {
                let more = "temperature = { harmonics = [{ amplitude = 3, angular_frequency = 0.5 }], noise = { intensity = 0.3 } }
                     record = { energy = true, paths = false }
                     ensemble = { paths = 8 }
                     scheme = { kind = \"event-driven\" }";
                let text = body([1.0, 0.1], [1.2, 1.0], [60.0, 0.0, 20.0], more);
                let mut scene = scenario(&text.replace(
                    "dynamic = 1.0",
                    "dynamic = 1.0, load = \"1 + 0.3*sin(2*x)\"",
                ));
                scene.record.levels = PassageLevels::of(&[1.0]);
                scene
            },
            [1e-4, 1e-4, 5e-3],
        ),
    ] {
        let mut fine = scene.clone();
        (fine.time.output_step, fine.record.trajectories) =
            (fine.time.end / 1e5, scene.ensemble.paths);
        let mut recorder = Recorder::default();
        let summary = Run::of(&fine)
            .without_bias()
            .into_sink(&mut recorder)
            .simulate()
            .expect("no sink fails")
            .summary;
        let dataset = recorder.into_dataset();
        let column = |name: &str| match &dataset.entry(name).expect("recorded").column {
            stickslip::dataset::Column::F64(values) => values.clone(),
            other => panic!("{other:?}"),
        };
        let [x, v, temperature] = ["displacement", "velocity", "temperature"]
            .map(|of| column(&format!("trajectory_{of}")));
        let rows = fine.timeline().rows();
        let body = &scene.model.oscillator;
        let (mut of_temperature, mut of_damping, mut of_friction, mut fastest) =
            (0.0, 0.0, 0.0, 0.0);
        for path in 0..scene.ensemble.paths as usize {
            let at = path * rows..(path + 1) * rows;
            for pair in at.clone().collect::<Vec<_>>().windows(2) {
                let [a, b] = [pair[0], pair[1]];
                of_temperature += body.force_per_temperature()
                    * 0.5
                    * (temperature[a] + temperature[b])
                    * (x[b] - x[a]);
                of_damping += body.damping * (v[a] + v[b]) * (x[b] - x[a]);
                let [time, way] = [fine.time.output_step * (a % rows) as f64, x[b] - x[a]];
                of_friction += way
                    * scene
                        .model
                        .sliding_friction(Sign::of(way), time, 0.5 * (x[a] + x[b]), v[a]);
            }
            fastest += v[at].iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        }
        let paths = scene.ensemble.paths as f64;
        let friction = of(&summary, Statistic::FrictionWorkMean);
        for (what, statistic, rows, tolerated) in [
            (
                "temperature",
                Statistic::TemperatureWorkMean,
                of_temperature / paths,
                tolerated[0] * friction,
            ),
            (
                "damping",
                Statistic::DampingWorkMean,
                of_damping / paths,
                tolerated[1] * friction,
            ),
            (
                "friction",
                Statistic::FrictionWorkMean,
                of_friction / paths,
                tolerated[1] * friction,
            ),
            (
                "speed",
                Statistic::LargestSpeedMean,
                fastest / paths,
                tolerated[2] * fastest / paths,
            ),
        ] {
            let found = of(&summary, statistic);
            println!(
                "{name}, {what}: {found} {rows}, apart by {:e}",
                (found - rows) / friction
            );
            assert!(
                (found - rows).abs() < tolerated,
                "{name}, {what}: {found} {rows}"
            );
        }
        // The same paths without rows have the same works, to the last bit.
        let coarse = run(&scene);
        for statistic in [
            Statistic::TemperatureWorkMean,
            Statistic::DampingWorkMean,
            Statistic::LargestSpeedMean,
        ] {
            assert_eq!(
                of(&coarse, statistic),
                of(&summary, statistic),
                "{name}: {}",
                statistic.name()
            );
        }
    }
}

/// A slip of the bridge begins with b = f_s and swings to twice (f_s - f_d)/K with the largest speed
/// (f_s - f_d)/(m w0) half way; an interpolation between rows an hour apart had 4/pi of it less.
#[test]
fn a_slip_of_a_bridge_is_as_fast_as_its_swing() {
    let mut scene = shipped("viaduct", 4)
        .with_scheme(QuasiStatic { tolerance: 1e-3 })
        .expect("suits");
    scene.time.end /= 10.0;
    let summary = run(&scene);
    let body = &scene.model.oscillator;
    let gap = scene.model.friction.static_force - scene.model.friction.dynamic_force;
    let expected = gap / (body.mass * body.natural_frequency());
    let [mean, sd] =
        [Statistic::LargestSpeedMean, Statistic::LargestSpeedSd].map(|s| of(&summary, s));
    assert!(
        (mean / expected - 1.0).abs() < 1e-5 && sd < 1e-9 * mean,
        "{mean} {expected}, sd {sd}"
    );
}

/// An elastic stop gives back what it takes: its work is the energy that it holds at the end, which is
/// none but for paths that end in the stop. With 400 paths at most 1 in 400 does at K = 1000.
#[test]
fn an_elastic_stop_takes_no_work() {
    for stiffness in [100.0, 1000.0] {
        let more = format!(
            "temperature = {{ harmonics = [{{ amplitude = 6, angular_frequency = 0.25 }}], noise = {{ intensity = 1.5, relaxation_rate = 1, diffusion = 1, initial = 0 }} }}
             force.expression = \"-{stiffness:?}*(max(0, x - 8) + min(0, x + 8))\"
             record = {{ energy = true }}
             ensemble = {{ paths = 400 }}
             scheme = {{ kind = \"event-driven\" }}"
        );
        let summary = run(&scenario(&body(
            [1.0, 0.0],
            [1.2, 1.0],
            [60.0, 0.0, 5.0],
            &more,
        )));
        let [own, friction, residual] = [
            Statistic::UserForceWorkMean,
            Statistic::FrictionWorkMean,
            Statistic::EnergyResidualMean,
        ]
        .map(|s| of(&summary, s));
        println!("K = {stiffness}: {own} of {friction}");
        assert!(
            own.abs() < 2e-4 * friction && residual.abs() < 1e-9 * friction,
            "{own} {friction} {residual}"
        );
    }
}

/// What a run reports of a statistic, what its bias subtracts and what a point of a sweep has come
/// from one fold, whatever the rows: on rows ten times as far apart every estimate has the same bits,
/// in a run and in a sweep. Bands, densities by rows and spectra are of the grid by definition.
#[test]
fn no_statistic_depends_on_the_output_step() {
    let everything = |name: &str, paths: u64| {
        let mut scene = shipped(name, paths);
        scene.record.laws = true;
        scene.record.density = true;
        scene
    };
    for scene in [
        everything("rho025", 1024),
        everything("rho025", 256)
            .with_scheme(CorrectedVi { step: 0.02 })
            .expect("suits"),
        event_driven(everything("rho025", 256)),
        everything("duffing", 64),
        everything("belt", 64),
        everything("viaduct", 16)
            .with_scheme(QuasiStatic { tolerance: 1e-3 })
            .expect("suits"),
    ] {
        let mut coarse = scene.clone();
        coarse.time.output_step *= 10.0;
        let name = format!("{} {}", scene.title, scene.scheme);
        let outcomes =
            [&scene, &coarse].map(|scene| Run::of(scene).simulate().expect("no sink").summary);
        let [fine, other] = &outcomes;
        for statistic in Statistic::ALL {
            let [a, b] = [fine, other].map(|summary| *summary.estimate(statistic));
            let bits =
                |of: stickslip::stats::Estimate| [of.estimate, of.low, of.high].map(f64::to_bits);
            assert_eq!(bits(a), bits(b), "{name}: {}", statistic.name());
            // The reference run of the bias may have another number of paths.
            if let (Some(a), Some(b)) = (a.bias, b.bias) {
                let apart = (a.estimate - b.estimate).abs();
                assert!(
                    apart <= a.uncertainty + b.uncertainty,
                    "{name}: bias of {}: {a:?} {b:?}",
                    statistic.name()
                );
            }
        }
        assert_eq!(
            format!("{:?}", fine.densities),
            format!("{:?}", other.densities),
            "{name}"
        );
        assert_eq!(fine.cycle, other.cycle, "{name}");

        let axis = SweepAxis {
            name: "f_s".into(),
            key: "friction.static".into(),
            values: vec![scene.model.friction.static_force].into(),
        };
        let design = Design::of(vec![axis], false).expect("one point");
        for scene in [&scene, &coarse] {
            let question = SweepQuestion::new(
                scene.clone(),
                design.clone(),
                vec![scene.clone()],
                Seeds::Common,
                false,
            );
            let (mut sweep, stop) = (Sweep::new(question), AtomicBool::new(false));
            let simulation = SweepSimulation {
                threads: 1,
                stop: &stop,
                progress: &mut (),
                blocks: None,
            };
            simulation
                .run(&mut sweep, |_| Ok::<(), std::convert::Infallible>(()))
                .expect("never fails");
            let point = sweep.points[0].as_ref().expect("done");
            for (run, swept) in fine.estimates.iter().zip(&point.estimates) {
                assert_eq!(
                    run.estimate.to_bits(),
                    swept.estimate.to_bits(),
                    "{name}: {:?}",
                    run.statistic
                );
            }
            assert_eq!(point.cycle, fine.cycle, "{name}");
        }
    }
}

/// `discrete-vi` creates energy in every slip, which its works must show and its bias must take off:
/// the works that are left are those of the event-driven scheme.
#[test]
fn what_a_step_creates_of_energy_is_its_bias() {
    let scene = shipped("rho025", 2048);
    let [stepping, exact] = [scene.clone(), event_driven(scene)]
        .map(|scene| Run::of(&scene).simulate().expect("no sink").summary);
    for statistic in [
        Statistic::TemperatureWorkMean,
        Statistic::EnergyResidualMean,
        Statistic::EnergyResidualSd,
        Statistic::LargestSpeedMean,
        Statistic::FrictionWorkMean,
    ] {
        let (estimate, truth) = (stepping.estimate(statistic), exact.estimate(statistic));
        let bias = estimate
            .bias
            .unwrap_or_else(|| panic!("{} has no bias", statistic.name()));
        let left = (estimate.estimate - bias.estimate - truth.estimate).abs();
        let error = bias.uncertainty + 2.0 * (truth.high - truth.low);
        println!(
            "{}: {} less {} is {}",
            statistic.name(),
            estimate.estimate,
            bias.estimate,
            truth.estimate
        );
        assert!(
            left <= error + 1e-12,
            "{}: {left}, not below {error}",
            statistic.name()
        );
    }
    let residual = stepping.estimate(Statistic::EnergyResidualMean);
    assert!(
        residual.estimate < -1.0 && residual.bias.expect("known").uncertainty < 0.05 * 1.381,
        "{residual:?}"
    );
}
