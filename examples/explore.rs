use stick_slip::{bias::*, model::*, scheme::*, stats::*};
use std::sync::atomic::AtomicBool;
// h paths reps seed0
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|s| s.parse().unwrap()).collect();
    let (h, n, reps) = (a[0], a[1] as u64, a[2] as u64);
    let noise = Noise { intensity: 0.25, relaxation_rate: 1.0, diffusion: 1.0, initial: InitialNoise::At(0.0) };
    let model = Model {
        oscillator: Oscillator { mass: 1.0, stiffness: 1.0, damping: 0.0, dilatation: 6.0 },
        friction: Friction { static_force: 1.2, dynamic_force: 1.0 },
        temperature: Temperature { harmonics: vec![Harmonic { amplitude: 1.0, angular_frequency: 0.25, phase: 0.0 }], noise: Some(noise) },
        initial_displacement: 6.0,
    };
    let timeline = Timeline { end: 60.0, output_step: 60.0, period: model.temperature.period() };
    for rep in 0..reps {
        let t0 = std::time::Instant::now();
        let plan = BiasPlan::new(&model, &timeline, h, 100 + rep, n).unwrap();
        let b = plan.estimate(2, &AtomicBool::new(false)).unwrap();
        eprintln!("{:?}", t0.elapsed());
        for (s, b) in b { println!("{h} {n} {} {} {} {}", s.name(), b.estimate, b.uncertainty, b.order.unwrap_or(f64::NAN)); }
    }
}
