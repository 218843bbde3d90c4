//! The keys of the physics -> a model.

use super::blame::blame;
use super::error::Fault;
use super::fields::Fields;
use super::keys;
use super::source::Sources;
use crate::model::{Friction, Harmonic, InitialNoise, Model, Noise, Oscillator, Temperature};
use crate::scenario::check;

/// Read `[oscillator]`, `[friction]`, `[temperature]` and `[initial]`.
pub(super) fn model(sources: &Sources<'_>, root: &Fields<'_>) -> Result<Model, Box<Fault>> {
    let fault = |misfit| blame(sources, root, &misfit);
    let table = root.table("oscillator")?;
    let oscillator = Oscillator {
        mass: table.number(keys::MASS)?.value,
        stiffness: table.number(keys::STIFFNESS)?.value,
        damping: table.number_or(keys::DAMPING, 0.0)?.value,
        dilatation: table.number(keys::DILATATION)?.value,
    };

    let table = root.table("friction")?;
    let static_force = table.number(keys::STATIC)?.value;
    let dynamic_force = table.number(keys::DYNAMIC)?.value;
    let friction = Friction { static_force, dynamic_force };
    check::friction(&friction).map_err(fault)?;

    let table = root.table("temperature")?;
    let mut harmonics = Vec::new();
    for harmonic in table.tables("harmonics")? {
        harmonics.push(Harmonic {
            amplitude: harmonic.number(keys::AMPLITUDE)?.value,
            angular_frequency: harmonic.number(keys::ANGULAR_FREQUENCY)?.value,
            phase: harmonic.number_or(keys::PHASE, 0.0)?.value,
        });
    }
    let noise = match table.table_if_present("noise")? {
        Some(table) => Some(noise(&table)?),
        None => None,
    };

    noise.as_ref().map_or(Ok(()), check::noise).map_err(fault)?;

    let initial_displacement = root.table("initial")?.number(keys::DISPLACEMENT)?.value;
    let model = Model { oscillator, friction, temperature: Temperature { harmonics, noise }, initial_displacement };
    check::forces(&model).map_err(fault)?;
    Ok(model)
}

fn noise(table: &Fields<'_>) -> Result<Noise, Box<Fault>> {
    Ok(Noise {
        intensity: table.number(keys::INTENSITY)?.value,
        relaxation_rate: table.number_or(keys::RELAXATION_RATE, 1.0)?.value,
        diffusion: table.number_or(keys::DIFFUSION, 1.0)?.value,
        initial: match table.number_or_word(keys::INITIAL_NOISE, &["stationary"])? {
            None => InitialNoise::At(0.0),
            Some(Ok(v0)) => InitialNoise::At(v0.value),
            Some(Err(_stationary)) => InitialNoise::Stationary,
        },
    })
}
