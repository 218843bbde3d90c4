//! Keys -> a checked scenario. What leaves this file is finite, in range, and can be computed with.

use super::check::largest_force;
use super::error::Fault;
use super::fields::{Fields, Read};
use super::keys;
use super::source::Sources;
use super::tree;
use super::{Ensemble, Scenario, SchemeKind, Time, Units};
use crate::model::{Friction, Harmonic, InitialNoise, Model, Noise, Oscillator, Temperature};
use crate::stats::Record;

/// Most rows of the output grid: bands hold every path's value at every row of a block.
pub const MAX_ROWS: usize = 10_000;

/// Most steps of a path: beyond 2^53, t_n = n h is no longer distinct for every n.
pub const MAX_STEPS: f64 = 9_007_199_254_740_992.0;

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
    let time = time(sources, &root, &model)?;
    let ensemble = root.table("ensemble")?;
    let record = root.table("record")?;
    let units = root.table("units")?;
    let scheme = root.table("scheme")?.word("kind", &SchemeKind::NAMES)?;
    Ok(Scenario {
        title: root.line_or("title", default_title)?,
        model,
        time,
        scheme: scheme.and_then(SchemeKind::from_name).unwrap_or(SchemeKind::DiscreteVi),
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
    if !(damping.value / mass.value).is_finite() {
        let remedy = "choose units in which mass and damping are closer to 1";
        return Err(about(sources, &[&damping, &mass], "gives an infinite alpha/m".into(), remedy.into()));
    }
    let model = Model {
        oscillator,
        friction: Friction { static_force: static_force.value, dynamic_force: dynamic_force.value },
        temperature: Temperature { harmonics, noise },
        initial_displacement: initial.value,
    };
    let largest = largest_force(&model);
    if !largest.is_finite() {
        let problem = format!("lets the force b = K (beta T - x) reach {largest}, which a double cannot hold");
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
    if !noise.stationary_sd().is_finite() || (noise.diffusion > 0.0 && !noise.stationary_sd().is_normal()) {
        let problem = "gives a stationary sd of v, sigma / sqrt(2 theta), which a double cannot hold".to_string();
        let remedy = "choose units in which relaxation rate and diffusion are closer to 1";
        return Err(about(sources, &[&diffusion, &relaxation_rate], problem, remedy.into()));
    }
    let starts_at_zero = matches!(initial, InitialNoise::Stationary | InitialNoise::At(0.0));
    let silent = noise.intensity == 0.0 || (noise.diffusion == 0.0 && starts_at_zero);
    Ok((!silent).then_some(noise))
}

fn time(sources: &Sources<'_>, root: &Fields<'_>, model: &Model) -> Result<Time, Box<Fault>> {
    let table = root.table("time")?;
    let end = table.number(keys::END)?;
    let step = table.number(keys::STEP)?;
    // 0.0, never -0.0.
    let (t_end, h) = (end.value.abs(), step.value);

    let ratio = t_end / h;
    if ratio > MAX_STEPS {
        let problem = format!("makes t_end / h = {ratio:.3e} steps, and at most 2^53 = 9.0e15 can be counted");
        let remedy = format!("raise `time.step` to {:?} or more, or lower `time.end`", tidy(t_end / MAX_STEPS * 1.001));
        return Err(about(sources, &[&step, &end], problem, remedy));
    }
    let steps = whole_multiple(t_end, h).ok_or_else(|| {
        let (below, above) = (ratio.floor(), ratio.ceil());
        let problem = format!("`time.end` = {t_end:?} is not a whole number of steps `time.step` = {h:?}");
        let list = |f: &dyn Fn(f64) -> f64, counts: [f64; 2]| {
            let values = counts.iter().filter(|n| **n > 0.0).map(|n| format!("{:?}", tidy(f(*n))));
            values.collect::<Vec<_>>().join(" or ")
        };
        let remedy = format!(
            "the nearest steps are {}; the nearest ends are {}",
            list(&|n| t_end / n, [above, below]),
            list(&|n| n * h, [below, above]),
        );
        about(sources, &[&step, &end], problem, remedy)
    })?;

    if !step_is_usable(model, h) {
        let problem =
            format!("gives h/m = {:e} or a threshold h f_s/m that a double cannot hold", h / model.oscillator.mass);
        let remedy = "choose units in which mass, forces and step are closer to 1";
        return Err(about(sources, &[&step], problem, remedy.into()));
    }

    let output_step = match table.number_if_present(keys::OUTPUT_STEP)? {
        None => default_output_step(t_end, h, steps),
        Some(output) => {
            let ratio = output.value / h;
            if whole_multiple(output.value, h).is_none() {
                let spacing = output.value;
                let problem =
                    format!("`time.output_step` = {spacing:?} is not a whole number of steps `time.step` = {h:?}");
                let nearest = [ratio.floor(), ratio.ceil()].map(|n| tidy(n.max(1.0) * h));
                let values = if nearest[0] == nearest[1] { &nearest[..1] } else { &nearest[..] };
                let values: Vec<String> = values.iter().map(|x| format!("{x:?}")).collect();
                let remedy = format!("the nearest output steps are {}", values.join(" or "));
                return Err(about(sources, &[&output, &step], problem, remedy));
            }
            let rows = (t_end / output.value * (1.0 + WHOLE)).floor() + 1.0;
            if rows > MAX_ROWS as f64 {
                let problem = format!("makes an output grid of {rows} rows, and at most {MAX_ROWS} are kept");
                let least = (t_end / h / (MAX_ROWS - 1) as f64).ceil() * h;
                let remedy = format!("write `time.output_step` = {:?} or more, or lower `time.end`", tidy(least));
                return Err(about(sources, &[&output, &end], problem, remedy));
            }
            output.value
        }
    };
    Ok(Time { end: t_end, step: h, output_step })
}

/// h/m and the thresholds it makes of the friction forces: finite, and not so small that digits are lost.
fn step_is_usable(model: &Model, h: f64) -> bool {
    let h_over_m = h / model.oscillator.mass;
    let usable = |x: f64| x == 0.0 || x.is_normal();
    let thresholds = [model.friction.static_force, model.friction.dynamic_force];
    h.is_normal()
        && h_over_m.is_normal()
        && thresholds.iter().all(|f| usable(*f) && (*f == 0.0 || (h_over_m * f).is_normal()))
        && (h_over_m * largest_force(model)).is_finite()
}

/// How far, relative to it, a duration may be from a whole number of steps: rounding of decimal fractions, no more.
const WHOLE: f64 = 1e-9;

/// n, if `total` is n `part`.
fn whole_multiple(total: f64, part: f64) -> Option<f64> {
    let ratio = total / part;
    let n = ratio.round();
    ((ratio - n).abs() <= WHOLE * n && (n > 0.0 || total == 0.0)).then_some(n)
}

/// Rows of a default output grid, the first one not counted.
const DEFAULT_ROWS: f64 = 120.0;

/// About 120 rows: the count from 60 to 240 nearest to it that divides the steps, else whatever is near it.
fn default_output_step(end: f64, h: f64, steps: f64) -> f64 {
    if steps <= DEFAULT_ROWS {
        return h;
    }
    let distance = |rows: &f64| (rows / DEFAULT_ROWS).ln().abs();
    let divisor = (60..=240).map(f64::from).filter(|rows| steps % rows == 0.0);
    match divisor.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
        // end / rows rather than a multiple of h: 60 / 120 is 0.5, 50 * 0.01 need not be.
        Some(rows) => end / rows,
        None => (steps / DEFAULT_ROWS).round() * h,
    }
}

/// To twelve digits, if that is all there is to it: 0.9 rather than 0.8999999999999999.
fn tidy(x: f64) -> f64 {
    format!("{x:.11e}").parse().unwrap_or(x)
}

/// Whether `a` comes from an override and `b` does not: then `a` is the one to blame.
fn override_of(sources: &Sources<'_>, a: &Read<f64>, b: &Read<f64>) -> bool {
    let is_override = |read: &Read<f64>| read.place.is_some_and(|place| sources.override_at(place).is_some());
    is_override(a) && !is_override(b)
}

/// A fault in what several values make together, shown at the first, or at the one that an override brought.
fn about(sources: &Sources<'_>, reads: &[&Read<f64>], problem: String, remedy: String) -> Box<Fault> {
    let mut shown = reads[0];
    for read in &reads[1..] {
        if override_of(sources, read, shown) {
            shown = read;
        }
    }
    Fault::at(sources, shown.place, problem, remedy).of(&shown.path).value(format!("{:?}", shown.value))
}
