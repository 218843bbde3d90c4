//! The keys of the physics -> a model.

use super::blame::blame;
use super::error::Fault;
use super::fields::Fields;
use super::keys;
use super::series;
use super::source::Sources;
use crate::model::{Friction, Harmonic, InitialNoise, Model, Noise, Oscillator, Temperature};
use crate::scenario::{Bearing, Measured, check};

/// The physics, and what is to be known of where it comes from.
pub(super) struct Physics {
    pub model: Model,
    pub measured: Option<Measured>,
    /// Whether x(0) is said to be where no spring force acts.
    pub is_balanced: bool,
}

/// Read `[oscillator]`, `[friction]`, `[temperature]` and `[initial]`.
pub(super) fn physics(sources: &Sources<'_>, root: &Fields<'_>) -> Result<Physics, Box<Fault>> {
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
    let noises = table.one_or_more("noise")?;
    if let [_, _, third, ..] = &noises[..] {
        let remedy = "keep two of them, or add up those whose relaxation rates are alike: their variances add";
        return Err(third.wrong("is one noise too many; two are simulated at most", remedy));
    }
    let mut read = Vec::new();
    for table in &noises {
        let noise = noise(table)?;
        check::noise(&noise).map_err(fault)?;
        read.push(noise);
    }
    let (noise, second_noise) = (read.first().copied(), read.get(1).copied());

    let (series, measured) = series::series(sources, root)?.unzip();
    let mut is_pinned = false;
    for table in &noises {
        is_pinned |= table.flag_or("pinned", false)?;
    }
    let temperature = Temperature { harmonics, series, is_pinned, noise, second_noise };
    if let Some((problem, remedy)) = check::pinned(&temperature) {
        let place = noises.iter().find_map(|table| table.place_of("pinned"));
        return Err(sources.fault(place, problem.into(), remedy.into()).of("temperature.noise.pinned"));
    }

    let table = root.table("initial")?;
    let given = table.number_or_word(keys::DISPLACEMENT, &["balanced"])?;
    let is_balanced = matches!(given, Some(Err(_)));
    let initial_displacement = match given {
        Some(Ok(x0)) => x0.value,
        Some(Err(_balanced)) => oscillator.dilatation * temperature.mean(0.0),
        None => table.number(keys::DISPLACEMENT)?.value,
    };
    let model = Model { oscillator, friction, temperature, initial_displacement };
    check::forces(&model).map_err(fault)?;
    Ok(Physics { model, measured, is_balanced })
}

/// Read `[bearing]`.
pub(super) fn bearing(root: &Fields<'_>) -> Result<Option<Bearing>, Box<Fault>> {
    let Some(table) = root.table_if_present("bearing")? else { return Ok(None) };
    let stiffness = table.number_if_present(keys::BEARING_STIFFNESS)?.map(|read| read.value);
    Ok(Some(Bearing { stiffness, offset: table.number_or(keys::OFFSET, 0.0)?.value }))
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
