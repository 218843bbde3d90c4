use super::super::law::StepRules;
use super::super::macro_step_loop::{self, SharedObserver};
use super::super::noisy::Noisy;
use super::super::scalar::ScalarPaths;
use super::Vectorised;
use crate::lanes::InstructionSet;
use crate::model::tests::paper;
use crate::model::{Event, Expression, Force, Harmonic, Problem};
use crate::noise::MIRROR;
use crate::scheme::{Instant, Observer, Snapshot, Timeline};

/// All events and snapshots of every path, in bits.
#[derive(Clone, Debug, Default, PartialEq)]
struct Everything {
    events: Vec<Vec<String>>,
    seen: Vec<[u64; 3]>,
    count: usize,
    stops: usize,
}

impl Observer for Everything {
    fn event(&mut self, lane: usize, event: Event) {
        let bits = [event.time, event.displacement, event.force].map(f64::to_bits);
        self.events[lane].push(format!("{:?} {bits:?}", event.kind));
        self.count += 1;
    }

    fn snapshot(&mut self, _: Instant, snapshot: Snapshot<'_>) {
        for lane in 0..self.events.len() {
            let state = [
                snapshot.displacement[lane],
                snapshot.velocity[lane],
                snapshot.temperature[lane],
            ];
            // The sign of a zero may differ.
            self.seen.push(state.map(|value| (value + 0.0).to_bits()));
            self.stops += usize::from(snapshot.is_static[lane]);
        }
    }
}

fn scenes() -> Vec<(&'static str, Problem)> {
    let mut damped = paper(0.25, 0.25);
    damped.oscillator.damping = 0.2;
    let mut three = paper(0.25, 0.4);
    three.temperature.harmonics.push(Harmonic {
        amplitude: 0.4,
        angular_frequency: 0.7,
        phase: 1.0,
    });
    three.temperature.harmonics.push(Harmonic {
        amplitude: 0.1,
        angular_frequency: 0.9,
        phase: -2.0,
    });
    let mut loose = paper(0.25, 0.25);
    loose.friction.static_force = loose.friction.dynamic_force * 1.01;
    let mut bare = paper(0.25, 1.5);
    bare.temperature.harmonics.clear();
    // A slip takes some thirty steps a macro step.
    let mut stiff = paper(0.25, 0.25);
    stiff.oscillator.mass = 1e-3;
    let forced = |expression: &str| {
        let mut model = paper(0.25, 0.25);
        model.initial_displacement = 3.0;
        let law = Expression::parse(expression, &[]).expect("an expression");
        model.force = Some(Force::new(law));
        model
    };
    vec![
        ("cubic", forced("-0.02*x^3")),
        (
            "of all",
            forced("-0.5*tanh(x)*(1 + 0.1*xdot) + 0.2*sin(0.3*t)"),
        ),
        ("steep", forced("-0.3*xdot*abs(xdot) - 0.1*x^5")),
        ("stiff", stiff),
        ("paper", paper(0.25, 0.25)),
        ("loud", paper(0.25, 2.0)),
        ("quiet", paper(0.25, 0.06)),
        ("feeble", paper(0.25, 0.003)),
        ("damped", damped),
        ("three harmonics", three),
        ("small gap", loose),
        ("no forcing", bare),
    ]
}

/// A path has the same bits vectorised and scalar, on every instruction set and among any other
/// paths, with output rows at the ends of macro steps and inside them.
#[test]
fn a_path_is_the_same_vectorised_and_scalar() {
    let paths: Vec<u64> = (100..300)
        .chain((100..153).map(|path| path | MIRROR))
        .collect();
    for (name, model) in scenes() {
        for output_step in [0.5, 0.77, 0.1, 0.06] {
            let timeline = Timeline {
                end: 30.0,
                output_step,
                period: None,
                after: 0.0,
            };
            let noisy = Noisy::new(&model, &timeline, &StepRules::new(1e-3));
            assert_eq!(noisy.has_one_step_a_macro_step(), name != "stiff");
            let nothing = Everything {
                events: vec![Vec::new(); paths.len()],
                ..Everything::default()
            };
            let mut scalar = nothing.clone();
            let singly = macro_step_loop::simulate(
                &mut ScalarPaths::new(&noisy, 5, &paths, &|| false, false),
                paths.len(),
                &SharedObserver::new(&mut scalar),
            );
            for set in InstructionSet::ALL
                .into_iter()
                .filter(|set| set.is_available())
            {
                let mut together = Vectorised::new(&noisy, set, 5, &paths, &|| false);
                let mut vectorised = nothing.clone();
                let simulated = macro_step_loop::simulate(
                    &mut together,
                    paths.len(),
                    &SharedObserver::new(&mut vectorised),
                );
                let is_fallback = together.fell_back as f64 / together.swept as f64;
                println!(
                    "{name}, {}: {} events, {is_fallback:.4} fallback",
                    set.name(),
                    scalar.count
                );
                for (lane, (a, b)) in vectorised.events.iter().zip(&scalar.events).enumerate() {
                    let same = a.iter().zip(b).take_while(|(a, b)| a == b).count();
                    assert!(
                        a == b,
                        "{name}, {}, lane {lane}: {:?}, {:?}",
                        set.name(),
                        a.get(same),
                        b.get(same)
                    );
                }
                for (i, (a, b)) in vectorised.seen.iter().zip(&scalar.seen).enumerate() {
                    let (row, lane) = (i / paths.len(), i % paths.len());
                    assert!(
                        a == b,
                        "{name}, {}, row {row}, lane {lane}: {a:?}, {b:?}",
                        set.name()
                    );
                }
                assert!(vectorised == scalar, "{name}, {}", set.name());
                assert_eq!(
                    simulated.evaluations,
                    singly.evaluations,
                    "{name}, {}",
                    set.name()
                );
            }
        }
    }
}
