//! Keys -> a checked scenario. What leaves this file is finite, in range, and can be computed with.

use super::error::Fault;
use super::fields::{Fields, Read};
use super::keys;
use super::source::Sources;
use super::time_keys::scheme_and_time;
use super::tree;
use super::{Ensemble, Scenario, Units};
use crate::model::{
    Friction, Harmonic, InitialNoise, LARGEST, Model, Noise, Oscillator, Temperature, can_be_computed_with,
};
use crate::scheme::Misfit;
use crate::stats::Record;

/// Most paths.
pub const MAX_PATHS: u64 = 1 << 40;

/// Most paths kept on the output grid.
pub const MAX_TRAJECTORIES: u64 = 1_000_000;

/// Paths of a scenario that does not say how many.
const DEFAULT_PATHS: u64 = 10_000;

/// A fixed default, so that a scenario without a seed is still reproducible.
const DEFAULT_SEED: u64 = 1;

/// Read the tree, key by key.
pub(super) fn scenario(sources: &Sources<'_>, default_title: &str) -> Result<Scenario, Box<Fault>> {
    let tree = tree::read(sources)?;
    let root = Fields::root(sources, &tree)?;
    refuse_unknown_keys(&root)?;
    let model = model(sources, &root)?;
    let (scheme, time) = scheme_and_time(sources, &root, &model)?;
    let ensemble = root.table("ensemble")?;
    let record = root.table("record")?;
    let units = root.table("units")?;
    Ok(Scenario {
        title: root.line_or("title", default_title)?,
        model,
        time,
        scheme,
        ensemble: Ensemble {
            paths: ensemble.whole_or("paths", DEFAULT_PATHS, (1, MAX_PATHS))?,
            seed: ensemble.whole_or("seed", DEFAULT_SEED, (0, u64::MAX))?,
        },
        record: Record {
            paths: record.flag_or("paths", true)?,
            events: record.flag_or("events", false)?,
            trajectories: record.whole_or("trajectories", 0, (0, MAX_TRAJECTORIES))?,
        },
        units: Units {
            time: units.line_or("time", "")?,
            length: units.line_or("length", "")?,
            force: units.line_or("force", "")?,
            temperature: units.line_or("temperature", "")?,
        },
    })
}

/// Open every table before any is read: a misspelt key is the better explanation of a missing one.
fn refuse_unknown_keys(root: &Fields<'_>) -> Result<(), Box<Fault>> {
    for name in keys::of_table("").iter().filter(|name| !keys::of_table(name).is_empty()) {
        root.table(name)?;
    }
    let temperature = root.table("temperature")?;
    temperature.tables("harmonics")?;
    temperature.table("noise")?;
    Ok(())
}

fn model(sources: &Sources<'_>, root: &Fields<'_>) -> Result<Model, Box<Fault>> {
    let table = root.table("oscillator")?;
    let mass = table.number(keys::MASS)?;
    let stiffness = table.number(keys::STIFFNESS)?;
    let damping = table.number_or(keys::DAMPING, 0.0)?;
    let dilatation = table.number(keys::DILATATION)?;

    let table = root.table("friction")?;
    let static_force = table.number(keys::STATIC)?;
    let dynamic_force = table.number(keys::DYNAMIC)?;
    if dynamic_force.value > static_force.value {
        let (f_s, f_d) = (static_force.value, dynamic_force.value);
        let problem = format!("`friction.dynamic` = {f_d:?} is above `friction.static` = {f_s:?}");
        let remedy = "0 <= f_d <= f_s must hold: lower `friction.dynamic` or raise `friction.static`";
        return Err(about(sources, &[&dynamic_force, &static_force], problem, remedy.into()));
    }

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
        Some(table) => noise(sources, &table)?,
        None => None,
    };

    let initial = root.table("initial")?.number(keys::DISPLACEMENT)?;
    let oscillator = Oscillator {
        mass: mass.value,
        stiffness: stiffness.value,
        damping: damping.value,
        dilatation: dilatation.value,
    };
    if !oscillator.natural_frequency().powi(2).is_normal() {
        let problem = format!("gives K/m = {:e}, which a double cannot hold", stiffness.value / mass.value);
        let remedy = "choose units in which mass and stiffness are closer to 1";
        return Err(about(sources, &[&stiffness, &mass], problem, remedy.into()));
    }
    let rate = damping.value / mass.value;
    if rate > LARGEST {
        let problem = format!("gives alpha/m = {rate:e}, too large to compute with");
        let remedy = "choose units in which mass and damping are closer to 1";
        return Err(about(sources, &[&damping, &mass], problem, remedy.into()));
    }
    let model = Model {
        oscillator,
        friction: Friction { static_force: static_force.value, dynamic_force: dynamic_force.value },
        temperature: Temperature { harmonics, noise },
        initial_displacement: initial.value,
    };
    let (largest, mass) = (model.largest_force(), model.oscillator.mass);
    let acceleration = largest / mass;
    if !can_be_computed_with(&[largest, acceleration]) {
        let problem = format!(
            "lets the force b = K (beta T - x) reach {largest:e} and b/m {acceleration:e}; above {:e} is too large to compute with",
            LARGEST
        );
        let remedy = "lower the stiffness, dilatation, temperature or displacement, or change units";
        // Most likely the largest factor of it is the one that is wrong.
        let mut factors = [&stiffness, &dilatation, &initial];
        factors.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
        return Err(about(sources, &factors, problem, remedy.into()));
    }
    Ok(model)
}

/// The noise, if there is any: rho = 0, or v = 0 for ever, is no noise.
fn noise(sources: &Sources<'_>, table: &Fields<'_>) -> Result<Option<Noise>, Box<Fault>> {
    let intensity = table.number(keys::INTENSITY)?;
    let relaxation_rate = table.number_or(keys::RELAXATION_RATE, 1.0)?;
    let diffusion = table.number_or(keys::DIFFUSION, 1.0)?;
    let initial = match table.number_or_word(keys::INITIAL_NOISE, &["stationary"])? {
        None => InitialNoise::At(0.0),
        Some(Ok(v0)) => InitialNoise::At(v0.value),
        Some(Err(_stationary)) => InitialNoise::Stationary,
    };
    let noise = Noise {
        intensity: intensity.value,
        relaxation_rate: relaxation_rate.value,
        diffusion: diffusion.value,
        initial,
    };
    let size = noise.intensity * noise.stationary_sd();
    if !can_be_computed_with(&[size, noise.stationary_sd()])
        || (noise.diffusion > 0.0 && !noise.stationary_sd().is_normal())
    {
        let problem =
            "gives a stationary sd of v, sigma / sqrt(2 theta), or of rho v, that cannot be computed with".to_string();
        let remedy = "choose units in which relaxation rate and diffusion are closer to 1";
        return Err(about(sources, &[&diffusion, &relaxation_rate], problem, remedy.into()));
    }
    let starts_at_zero = matches!(initial, InitialNoise::Stationary | InitialNoise::At(0.0));
    let silent = noise.intensity == 0.0 || (noise.diffusion == 0.0 && starts_at_zero);
    Ok((!silent).then_some(noise))
}

/// Whether `a` comes from an override and `b` does not: then `a` is the one to blame.
fn override_of(sources: &Sources<'_>, a: &Read<f64>, b: &Read<f64>) -> bool {
    sources.is_override(a.place) && !sources.is_override(b.place)
}

/// A fault in what several values make together, shown at the first, or at the one that an override brought.
pub(super) fn about(sources: &Sources<'_>, reads: &[&Read<f64>], problem: String, remedy: String) -> Box<Fault> {
    let mut shown = reads[0];
    for read in &reads[1..] {
        if override_of(sources, read, shown) {
            shown = read;
        }
    }
    Fault::at(sources, shown.place, problem, remedy).of(&shown.path).value(format!("{:?}", shown.value))
}

/// The same for values that do not go together, wherever each of them stands; a default stands nowhere.
pub(super) fn located(sources: &Sources<'_>, root: &Fields<'_>, misfit: &Misfit) -> Box<Fault> {
    let read =
        |(key, value): &(&'static str, f64)| Read { value: *value, place: root.place_of(key), path: key.to_string() };
    let reads: Vec<Read<f64>> = misfit.about.iter().map(read).collect();
    about(sources, &reads.iter().collect::<Vec<_>>(), misfit.problem.clone(), misfit.remedy.clone())
}
