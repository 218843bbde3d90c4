//! The paper's oscillator, for the unit tests of all modules.

use super::{
    Drive, Friction, Harmonic, InitialNoise, OrnsteinUhlenbeck, Oscillator, Problem, Temperature,
};

/// The parameters of the paper's section 3.1, with this forcing frequency and this intensity of the
/// noise. Without noise if the intensity is zero.
pub(crate) fn paper(w: f64, rho: f64) -> Problem {
    let noise = OrnsteinUhlenbeck {
        intensity: rho,
        relaxation_rate: 1.0,
        diffusion: 1.0,
        initial: InitialNoise::At(0.0),
    };
    Problem {
        oscillator: Oscillator {
            mass: 1.0,
            stiffness: 1.0,
            damping: 0.0,
            drive: Drive::Dilatation(6.0),
        },
        friction: Friction {
            static_force: 1.2,
            dynamic_force: 1.0,
        },
        temperature: Temperature {
            harmonics: vec![Harmonic {
                amplitude: 1.0,
                angular_frequency: w,
                phase: 0.0,
            }],
            noises: (rho != 0.0).then_some(noise).into_iter().collect(),
            ..Temperature::default()
        },
        force: None,
        random: Vec::new(),
        initial_displacement: 6.0,
        initial_velocity: 0.0,
    }
}
