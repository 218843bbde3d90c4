//! Random valid scenarios for tests.

use super::limits::MAX_PHASE;
use super::{
    AsWritten, Ensemble, MAX_PATHS, MAX_TRAJECTORIES, Scenario, SensorBearing, Statistics, Time,
    Units,
};
use crate::model::{
    Drive, Friction, Harmonic, InitialNoise, OrnsteinUhlenbeck, Oscillator, Problem, Temperature,
};
use crate::scheme::{Kind, monitoring_shift};
use crate::stats::{PassageLevels, Record};
use proptest::prelude::*;

/// A number of any magnitude for which K/m and the forces stay within the range of a double.
fn size() -> impl Strategy<Value = f64> {
    (1.0..10.0f64, -12..12i32).prop_map(|(x, power)| x * 10f64.powi(power))
}

fn signed() -> impl Strategy<Value = f64> {
    prop_oneof![size(), size().prop_map(|x| -x), Just(0.0)]
}

fn label() -> impl Strategy<Value = String> {
    any::<String>().prop_map(|text| text.chars().filter(|c| !c.is_control()).collect())
}

prop_compose! {
    fn noise()(intensity in size(), relaxation_rate in size(), diffusion in size(), v0 in proptest::option::of(signed()))
        -> OrnsteinUhlenbeck {
        let initial = v0.map_or(InitialNoise::Stationary, InitialNoise::At);
        OrnsteinUhlenbeck { intensity, relaxation_rate, diffusion, initial }
    }
}

prop_compose! {
    fn model()(
        (mass, stiffness, damping) in (size(), prop_oneof![8 => size(), 1 => Just(0.0)], prop_oneof![4 => size(), 4 => Just(0.0), 1 => size().prop_map(|x| -x)]),
        drive in prop_oneof![signed().prop_map(Drive::Dilatation), signed().prop_map(Drive::Force)],
        (offset, trend) in prop_oneof![2 => Just((0.0, 0.0)), 1 => (signed(), signed())],
        (static_force, ratio) in (size(), 0.0..=1.0f64),
        harmonics in proptest::collection::vec((signed(), size(), signed()), 0..4),
        noises in proptest::collection::vec(noise(), 0..3),
        initial_displacement in signed(),
        initial_velocity in prop_oneof![3 => Just(0.0), 1 => signed()],
    ) -> Problem {
        let harmonic = |(amplitude, angular_frequency, phase)| Harmonic { amplitude, angular_frequency, phase };
        Problem {
            oscillator: Oscillator { mass, stiffness, damping, drive },
            friction: Friction { static_force, dynamic_force: static_force * ratio },
            temperature: Temperature { offset, trend, harmonics: harmonics.into_iter().map(harmonic).collect(), series: None, is_pinned: false, noises },
            force: None,
            random: Vec::new(),
            initial_displacement,
            initial_velocity,
        }
    }
}

prop_compose! {
    pub fn scenario()(
        title in label(),
        model in model(),
        (step, steps, stride) in (size(), 0..10_000u32, 1..10_000u32),
        period in proptest::option::of(size()),
        burn_in in prop_oneof![Just(0.0), 0.0..1.0f64],
        (kind, tolerance) in (0..Kind::ALL.len(), 1e-9..=0.1f64),
        (paths, seed) in (1..=MAX_PATHS, any::<u64>()),
        (keep_paths, events, trajectories) in (any::<bool>(), any::<bool>(), 0..=MAX_TRAJECTORIES),
        levels in proptest::collection::vec(size(), 0..=PassageLevels::MOST).prop_map(|levels| PassageLevels::of(&levels)),
        bearing in proptest::option::of((proptest::option::of(size()), signed())),
        (time, length, force, temperature) in (label(), label(), label(), label()),
    ) -> Scenario {
        let kind = Kind::ALL[kind];
        let scheme = kind.with(if kind.has_step() { step } else { tolerance });
        let mut model = model;
        if kind == Kind::QuasiStatic {
            model.initial_velocity = 0.0;
            model.oscillator.damping = model.oscillator.damping.abs();
            model.oscillator.stiffness += f64::from(u8::from(model.oscillator.stiffness == 0.0));
        }
        if kind.has_step() {
            model.temperature.noises.truncate(1);
        }
        if kind == Kind::CorrectedVi && monitoring_shift(&model, step) >= model.friction.static_force / 2.0 {
            model.temperature.noises.clear();
        }
        let mut scenario = Scenario {
            title,
            model,
            bearing: bearing.map(|(stiffness, offset)| SensorBearing { stiffness, offset }),
            time: Time { end: f64::from(steps) * step, output_step: f64::from(stride) * step },
            scheme,
            statistics: Statistics { after: burn_in * f64::from(steps) * step, period },
            ensemble: Ensemble { paths, seed, antithetic: paths % 4 == 2 },
            record: Record { paths: keep_paths, events, trajectories, laws: events, density: keep_paths, spectrum: events, energy: keep_paths, levels },
            units: Units { time, length, force, temperature },
            written: AsWritten::default(),
        };
        let end = scenario.time.end;
        for harmonic in &mut scenario.model.temperature.harmonics {
            harmonic.angular_frequency = harmonic.angular_frequency.min(0.5 * MAX_PHASE / end);
            harmonic.phase = harmonic.phase.clamp(-MAX_PHASE, MAX_PHASE);
        }
        // A second noise is invalid with some of these values, for example if both noises move
        // nothing.
        if scenario.check().is_err() {
            scenario.model.temperature.noises.truncate(1);
        }
        scenario
    }
}
