//! The model from the tables that describe the physics.

use super::error::Diagnostic;
use super::fields::Fields;
use super::force::{Forced, force};
use super::keys;
use super::series;
use super::source::Sources;
use crate::model::{
    Drive, Friction, Harmonic, InitialNoise, OrnsteinUhlenbeck, Oscillator, Problem, RandomInput,
    RandomProcess, Temperature,
};
use crate::scenario::{AsWritten, Measured, SensorBearing, TEMPERATURE_SERIES, WhiteNoise};

/// The model, and the sources of its parts.
pub(super) struct Physics {
    /// White noise is not yet in it.
    pub model: Problem,
    /// How it is spelled; which numbers name parameters is not known yet.
    pub written: AsWritten,
    /// For each parameter that does not occur in any expression, the error to report if no number
    /// names it either.
    pub unused: Vec<(String, Box<Diagnostic>)>,
}

/// Read `[oscillator]`, `[friction]`, `[temperature]`, `[force]` and `[initial]`.
pub(super) fn physics(sources: &Sources<'_>, root: &Fields<'_>) -> Physics {
    let oscillator = oscillator(sources, &root.table("oscillator"));
    let friction = friction(&root.table("friction"));

    let table = root.table("temperature");
    let harmonics = table.tables("harmonics").iter().map(harmonic).collect();
    let noises = table.one_or_more("noise");
    let white_noise = white_noise(sources, &noises);
    let beside = white_noise.and(beside_white(&noises));
    let mut measured = measured_temperature(sources, root);
    let inputs = series::inputs(sources, root, &measured);
    let is_pinned = noises.iter().fold(false, |is_pinned, of| {
        is_pinned | of.flag_or(keys::PINNED, false)
    });
    if beside.is_some() && !measured.is_empty() {
        report_crowded(sources, root);
    }
    let noises = if white_noise.is_some() {
        Vec::new()
    } else {
        noises.iter().map(noise).collect()
    };
    let temperature = Temperature {
        offset: table.number_or(keys::TEMPERATURE_OFFSET, 0.0),
        trend: table.number_or(keys::TREND, 0.0),
        harmonics,
        series: measured.first().map(|measured| measured.series.clone()),
        is_pinned,
        noises,
    };

    let table = root.table("initial");
    let given = table.number_or_word(keys::DISPLACEMENT, &["balanced"]);
    let is_balanced = matches!(given, Some(Err(_)));
    let initial_displacement = match given {
        Some(Ok(x0)) => x0,
        Some(Err(_balanced)) => balanced(sources, &table, &oscillator, temperature.mean(0.0)),
        None => table.number(keys::DISPLACEMENT),
    };
    let Forced {
        oscillator,
        force,
        written: written_force,
        parameters,
        unused,
    } = force(sources, root, oscillator, friction, &inputs);
    measured.extend(inputs.into_iter().map(|(input, _)| input));
    let model = Problem {
        oscillator,
        friction: Friction::weaker(friction),
        temperature,
        force,
        random: measured
            .iter()
            .filter_map(|measured| measured.random.clone())
            .chain(beside.map(sampled))
            .collect(),
        initial_displacement,
        initial_velocity: table.number_or(keys::VELOCITY, 0.0),
    };
    Physics {
        model,
        written: AsWritten {
            measured,
            parameters,
            named: Vec::new(),
            is_balanced,
            white_noise,
            beside_white: beside,
            force: written_force,
            realised: Vec::new(),
        },
        unused,
    }
}

fn oscillator(sources: &Sources<'_>, table: &Fields<'_>) -> Oscillator {
    Oscillator {
        mass: table.number(keys::MASS),
        stiffness: table.number(keys::STIFFNESS),
        damping: table.number_or(keys::DAMPING, 0.0),
        drive: drive(sources, table),
    }
}

/// The thresholds forwards and backwards.
fn friction(table: &Fields<'_>) -> [Friction; 2] {
    let static_force = table.by_direction(keys::STATIC);
    let dynamic_force = table.by_direction(keys::DYNAMIC);
    [0, 1].map(|i| Friction {
        static_force: static_force[i],
        dynamic_force: dynamic_force[i],
    })
}

fn harmonic(table: &Fields<'_>) -> Harmonic {
    Harmonic {
        amplitude: table.number(keys::AMPLITUDE),
        angular_frequency: table.number(keys::ANGULAR_FREQUENCY),
        phase: table.number_or(keys::PHASE, 0.0),
    }
}

/// The measured temperature, if there is one.
fn measured_temperature(sources: &Sources<'_>, root: &Fields<'_>) -> Vec<Measured> {
    // Runs do not use this table, but every command reports errors in it.
    let displacement = root.table("displacement").table("series");
    series::source(&displacement, keys::VALUE, None);
    sources
        .or_report(series::temperature(sources, root))
        .flatten()
        .into_iter()
        .collect()
}

/// The rest position at this temperature, which a body without a spring does not have.
fn balanced(
    sources: &Sources<'_>,
    table: &Fields<'_>,
    oscillator: &Oscillator,
    temperature: f64,
) -> f64 {
    if oscillator.stiffness > 0.0 {
        return oscillator.rest_position(temperature);
    }
    let problem =
        "`initial.displacement` = \"balanced\" needs a spring, and `oscillator.stiffness` is 0";
    let place = table.place_of(keys::DISPLACEMENT.name);
    sources.report(sources.diagnostic(place, problem, "write a number, e.g. `displacement = 0`"));
    0.0
}

/// How the temperature drives the body: by a dilatation or by a force, whichever is given.
fn drive(sources: &Sources<'_>, table: &Fields<'_>) -> Drive {
    let Some(force) = table.number_if_present(keys::FORCE_PER_TEMPERATURE) else {
        return Drive::Dilatation(table.number(keys::DILATATION));
    };
    if table.number_if_present(keys::DILATATION).is_some() {
        let problem =
            "`oscillator.dilatation` and `oscillator.force_per_temperature` are both given";
        let remedy = "keep one: `dilatation` moves the rest position by beta T, `force_per_temperature` adds \
            the force c T";
        sources.report(sources.diagnostic(
            table.place_of(keys::FORCE_PER_TEMPERATURE.name),
            problem,
            remedy,
        ));
    }
    Drive::Force(force)
}

/// Read `[bearing]`.
pub(super) fn bearing(root: &Fields<'_>) -> Option<SensorBearing> {
    let table = root.table_if_present("bearing")?;
    let stiffness = table.number_if_present(keys::BEARING_STIFFNESS);
    Some(SensorBearing {
        stiffness,
        offset: table.number_or(keys::OFFSET, 0.0),
    })
}

fn noise(table: &Fields<'_>) -> OrnsteinUhlenbeck {
    OrnsteinUhlenbeck {
        intensity: table.number(keys::INTENSITY),
        relaxation_rate: table.number_or(keys::RELAXATION_RATE, 1.0),
        diffusion: table.number_or(keys::DIFFUSION, 1.0),
        initial: match table.number_or_word(keys::INITIAL_NOISE, &["stationary"]) {
            None => InitialNoise::At(0.0),
            Some(Ok(v0)) => InitialNoise::At(v0),
            Some(Err(_stationary)) => InitialNoise::Stationary,
        },
    }
}

/// The noise beside white noise, if there is one.
fn beside_white(noises: &[Fields<'_>]) -> Option<OrnsteinUhlenbeck> {
    let other = |of: &&Fields<'_>| of.word(keys::NOISE_KIND, &KINDS) != Some(WHITE);
    noises.iter().find(other).map(noise)
}

/// A noise beside white noise as a random temperature. Between its samples it lacks a variance of
/// (rho sigma)^2 step/6, a thousandth of what it has, and white noise is there all the more.
fn sampled(noise: OrnsteinUhlenbeck) -> RandomInput {
    RandomInput {
        name: TEMPERATURE_SERIES.into(),
        process: RandomProcess::OrnsteinUhlenbeck(noise),
        step: 3e-3 / noise.relaxation_rate,
        envelope: None,
    }
}

/// Report a measured temperature beside white noise and another noise.
fn report_crowded(sources: &Sources<'_>, root: &Fields<'_>) {
    let table = root.table("temperature").table("series");
    let problem = "cannot be combined with white noise beside another noise";
    let remedy = "remove one of the noises, or give the samples as an input of `force.expression`";
    sources.report(table.diagnostic_of_table(problem, remedy));
}

/// White noise, if one of the noises is white. It has no other keys.
fn white_noise(sources: &Sources<'_>, noises: &[Fields<'_>]) -> Option<WhiteNoise> {
    let table = noises
        .iter()
        .find(|of| of.word(keys::NOISE_KIND, &KINDS) == Some(WHITE))?;
    let white = |of: &&Fields<'_>| of.word(keys::NOISE_KIND, &KINDS) == Some(WHITE);
    if noises.iter().filter(white).count() > 1 {
        let remedy = "add up their strengths D in one table";
        sources.report(table.diagnostic_of_table("is white noise, as another table is", remedy));
    }
    for key in [
        keys::INTENSITY,
        keys::DIFFUSION,
        keys::INITIAL_NOISE,
        keys::PINNED,
    ] {
        if let Some(place) = table.place_of(key.name) {
            let problem = format!(
                "`temperature.noise.{}` has no meaning for white noise",
                key.name
            );
            sources.report(sources.diagnostic(
                Some(place),
                problem,
                "remove it; `strength` is D in sqrt(2 D) xi(t)",
            ));
        }
    }
    let relaxation_rate = table.number_if_present(keys::RELAXATION_RATE);
    Some(WhiteNoise {
        strength: table.number(keys::STRENGTH),
        relaxation_rate,
    })
}

/// The kind of a noise without memory.
const WHITE: &str = "white";
const KINDS: [&str; 2] = ["ornstein-uhlenbeck", WHITE];
