//! A scenario as TOML, with every default and with the symbol of the paper beside every number.

use super::fields::DIRECTIONS;
use super::keys::{self, Key};
use crate::model::{Drive, Expression, Force, Friction, InitialNoise, Model, Noise, Series, Sides, Temperature};
use crate::scenario::{Measured, Period, Scenario, SensorBearing, Statistics, Time, Units, WrittenForce};
use crate::stats::Record;
use std::fmt::Write as _;

/// The text of a scenario. Each number is the shortest decimal that reads back as the same double.
pub(super) fn resolved(scenario: &Scenario) -> String {
    let Scenario { title, bearing, time, scheme, statistics, ensemble, record, units, .. } = scenario;
    let mut text = format!("title = {}\n", string(title));
    physics(&mut text, scenario);
    if let Some(SensorBearing { stiffness, offset }) = *bearing {
        table(&mut text, "bearing");
        match stiffness {
            Some(stiffness) => number(&mut text, keys::BEARING_STIFFNESS, stiffness),
            None => text.push_str("# no stiffness: the bearing is rigid\n"),
        }
        number(&mut text, keys::OFFSET, offset);
    }
    let Time { end, output_step } = *time;
    table(&mut text, "time");
    number(&mut text, keys::END, end);
    match scheme.step() {
        Some(step) => number(&mut text, keys::STEP, step),
        None => drop(writeln!(text, "# no step: the {} scheme has none", scheme.name())),
    }
    number(&mut text, keys::OUTPUT_STEP, output_step);
    table(&mut text, "scheme");
    let is_followed = scenario.model.force.is_some() && !scheme.kind().has_step();
    let meaning =
        if is_followed { "from event to event, your force to the tolerance" } else { scheme.kind().meaning() };
    line(&mut text, keys::KIND.name, &string(scheme.name()), meaning);
    if let Some(tolerance) = scheme.tolerance() {
        number(&mut text, keys::TOLERANCE, tolerance);
    }
    table(&mut text, "statistics");
    let Statistics { after, period } = *statistics;
    number(&mut text, keys::AFTER, after);
    if !record.levels.is_empty() {
        let levels: Vec<String> = record.levels.iter().map(|level| format!("{level:?}")).collect();
        other(&mut text, keys::LEVELS, &format!("[{}]", levels.join(", ")));
    }
    match (period, scenario.period()) {
        (Some(period), _) => number(&mut text, keys::COMPARED, period),
        (None, Some(Period { length, source })) => {
            let _ = writeln!(text, "# no period, so P is {}, {length:?}", source.words());
        }
        (None, None) => {}
    }
    table(&mut text, "ensemble");
    other(&mut text, keys::PATHS, &ensemble.paths.to_string());
    other(&mut text, keys::SEED, &ensemble.seed.to_string());
    other(&mut text, keys::ANTITHETIC, &ensemble.antithetic.to_string());
    let Record { paths, events, trajectories, laws, density, spectrum, energy, levels: _ } = *record;
    table(&mut text, "record");
    other(&mut text, keys::RECORD_PATHS, &paths.to_string());
    other(&mut text, keys::EVENTS, &events.to_string());
    other(&mut text, keys::TRAJECTORIES, &trajectories.to_string());
    other(&mut text, keys::LAWS, &laws.to_string());
    other(&mut text, keys::DENSITY, &density.to_string());
    other(&mut text, keys::SPECTRUM, &spectrum.to_string());
    other(&mut text, keys::ENERGY, &energy.to_string());
    let Units { time, length, force, temperature } = units;
    table(&mut text, "units");
    let labels = [keys::TIME_LABEL, keys::LENGTH_LABEL, keys::FORCE_LABEL, keys::TEMPERATURE_LABEL];
    for (key, label) in labels.into_iter().zip([time, length, force, temperature]) {
        other(&mut text, key, &string(label));
    }
    text
}

/// The text of a scenario that is meant to be edited: the resolved scenario without the keys that
/// hold only for its samples, and the tables that it does not use as comments.
pub(super) fn template(scenario: &Scenario) -> String {
    let is_of_samples = |line: &&str| ["start = ", "hash = "].iter().any(|key| line.starts_with(key));
    let resolved = resolved(scenario);
    let mut text: String =
        resolved.lines().filter(|line| !is_of_samples(line)).map(|line| format!("{line}\n")).collect();
    let temperature = &scenario.model.temperature;
    let unused = [
        (temperature.noise.is_none(), NOISE_PART),
        (temperature.series.is_none(), SERIES_PART),
        (scenario.written_force.is_none(), FORCE_PART),
        (scenario.bearing.is_none(), BEARING_PART),
    ];
    let unused: Vec<&str> = unused.iter().filter(|(is_unused, _)| *is_unused).map(|(_, part)| *part).collect();
    if !unused.is_empty() {
        text.push_str("\n# What this scenario does not use. Remove the `#` in front of a part to use it.\n");
    }
    for part in unused {
        text.push('\n');
        text.extend(part.lines().map(|line| format!("# {line}\n")));
    }
    text
}

/// Tables that a scenario need not have, each with an example.
pub(super) const NOISE_PART: &str = "\
[temperature.noise]             # rho v, with v an Ornstein-Uhlenbeck process: dv = -theta v dt + sigma dW
intensity = 0.25                # rho: weight of v in T
relaxation_rate = 1.0           # theta
diffusion = 1.0                 # sigma
initial = 0.0                   # v(0), or \"stationary\"
";
pub(super) const SERIES_PART: &str = "\
[temperature.series]            # a measured temperature, added to the harmonics
file = \"temperature.csv\"        # relative to the folder of the scenario
time = \"time\"                   # its column of times: stamps, or numbers with a unit in the name
value = \"temperature_degC\"      # its column of temperatures
max_gap = \"6h\"                  # longest time between two samples
";
pub(super) const FORCE_PART: &str = "\
[force]                         # a force of your own, added to b
expression = \"-k3*x^3\"         # g(x, xdot, t)
[force.parameters]
k3 = 0.02
";
pub(super) const BEARING_PART: &str = "\
[bearing]                       # a sensor at the bearing shows z = z0 + x + F/K_B
stiffness = 2.0e9               # K_B: shear of the bearing under F
offset = 0.0                    # z0: what the sensor shows at x = 0
";

fn physics(text: &mut String, scenario: &Scenario) {
    let Scenario { model, measured, is_balanced, written_force, .. } = scenario;
    let oscillator = written_force.as_ref().and_then(|force| force.without).unwrap_or(model.oscillator);
    table(text, "oscillator");
    number(text, keys::MASS, oscillator.mass);
    number(text, keys::STIFFNESS, oscillator.stiffness);
    number(text, keys::DAMPING, oscillator.damping);
    match oscillator.drive {
        Drive::Dilatation(beta) => number(text, keys::DILATATION, beta),
        Drive::Force(c) => number(text, keys::FORCE_PER_TEMPERATURE, c),
    }
    table(text, "friction");
    friction(text, model, written_force.as_ref());
    temperature(text, &model.temperature, measured.as_ref());
    if let Some(WrittenForce { expression, .. }) = written_force {
        force(text, expression);
    }
    table(text, "initial");
    if *is_balanced {
        let x0 = model.initial_displacement;
        line(
            text,
            keys::DISPLACEMENT.name,
            "\"balanced\"",
            &format!("x0: beta T(0) = {x0:?}, where no spring force acts"),
        );
    } else {
        number(text, keys::DISPLACEMENT, model.initial_displacement);
    }
    if model.initial_velocity != 0.0 {
        number(text, keys::VELOCITY, model.initial_velocity);
    }
}

fn friction(text: &mut String, model: &Model, force: Option<&WrittenForce>) {
    let sides = model.force.as_ref().and_then(Force::sides);
    let both = sides.map_or([model.friction; 2], Sides::friction);
    let mut threshold = |key: Key, of: fn(&Friction) -> f64| match both.each_ref().map(of) {
        [forward, backward] if forward == backward => number(text, key, forward),
        [forward, backward] => {
            let [first, second] = DIRECTIONS;
            other(text, key, &format!("{{ {first} = {forward:?}, {second} = {backward:?} }}"));
        }
    };
    threshold(keys::STATIC, |friction| friction.static_force);
    threshold(keys::DYNAMIC, |friction| friction.dynamic_force);
    let Some(load) = sides.and_then(Sides::load).and_then(Force::expression) else { return };
    other(text, keys::LOAD, &string(load.text()));
    // Those of the force are written with it.
    let known = force.map_or(0, |force| force.expression.parameters().len());
    parameters(text, "friction.parameters", &load.parameters()[known..]);
}

fn force(text: &mut String, expression: &Expression) {
    table(text, "force");
    other(text, keys::EXPRESSION, &string(expression.text()));
    parameters(text, "force.parameters", expression.parameters());
}

fn parameters(text: &mut String, name: &str, all: &[(String, f64)]) {
    if !all.is_empty() {
        table(text, name);
    }
    for (name, value) in all {
        let _ = writeln!(text, "{name} = {value:?}");
    }
}

/// The tables of a temperature alone, harmonics and noises, to be inserted into a scenario.
pub(super) fn of_temperature(temperature: &Temperature) -> String {
    let mut text = String::new();
    self::temperature(&mut text, temperature, None);
    text
}

fn temperature(text: &mut String, of: &Temperature, measured: Option<&Measured>) {
    if of.has_line() || of.harmonics.is_empty() {
        table(text, "temperature");
    }
    if of.has_line() {
        number(text, keys::TEMPERATURE_OFFSET, of.offset);
        number(text, keys::TREND, of.trend);
    }
    if of.harmonics.is_empty() {
        let meaning = if of.has_line() { "no harmonics" } else { "no deterministic part" };
        line(text, keys::HARMONICS.name, "[]", meaning);
    }
    for harmonic in &of.harmonics {
        text.push_str("\n[[temperature.harmonics]]  # a cos(w t + phi)\n");
        number(text, keys::AMPLITUDE, harmonic.amplitude);
        number(text, keys::ANGULAR_FREQUENCY, harmonic.angular_frequency);
        number(text, keys::PHASE, harmonic.phase);
    }
    if let (Some(measured), Some(samples)) = (measured, &of.series) {
        series(text, measured, samples);
    }
    match (&of.noise, &of.second_noise) {
        (None, _) => text.push_str("\n# no [temperature.noise]: rho = 0\n"),
        (Some(only), None) => {
            table(text, "temperature.noise");
            noise(text, only);
            if of.is_pinned {
                other(text, keys::PINNED, "true");
            }
        }
        (Some(first), Some(second)) => {
            for each in [first, second] {
                text.push_str("\n[[temperature.noise]]  # rho v, one of two\n");
                noise(text, each);
            }
        }
    }
}

fn noise(text: &mut String, Noise { intensity, relaxation_rate, diffusion, initial }: &Noise) {
    number(text, keys::INTENSITY, *intensity);
    number(text, keys::RELAXATION_RATE, *relaxation_rate);
    number(text, keys::DIFFUSION, *diffusion);
    match initial {
        InitialNoise::At(v0) => number(text, keys::INITIAL_NOISE, *v0),
        InitialNoise::Stationary => {
            line(text, keys::INITIAL_NOISE.name, "\"stationary\"", "v(0) ~ N(0, sigma^2 / (2 theta))")
        }
    }
}

fn series(text: &mut String, measured: &Measured, samples: &Series) {
    let Measured { file, value, unit, layout, max_gap, start, .. } = measured;
    table(text, "temperature.series");
    other(text, keys::FILE, &string(file));
    let skip = layout.skip.map(|lines| lines.to_string());
    let decimal = layout.decimal.map(|mark| string(&mark.to_string()));
    let outliers = layout.outliers.map(|far| far.to_string());
    let missing: Vec<String> = layout.missing.iter().map(|mark| string(mark)).collect();
    for (key, given) in [
        (keys::SERIES_TIME, layout.time.as_deref().map(string)),
        (keys::VALUE, Some(string(value))),
        (keys::UNIT, unit.as_deref().map(string)),
        (keys::ZONE, layout.zone.as_deref().map(string)),
        (keys::DATES, layout.dates.map(|order| string(order.word()))),
        (keys::SKIP, skip),
        (keys::MISSING, Some(format!("[{}]", missing.join(", "))).filter(|_| !missing.is_empty())),
        (keys::OUTLIERS, outliers),
        (keys::DECIMAL, decimal),
    ] {
        if let Some(given) = given {
            other(text, key, &given);
        }
    }
    if let Some(max_gap) = *max_gap {
        number(text, keys::MAX_GAP, max_gap);
    }
    if let Some(start) = start {
        other(text, keys::START, &string(start));
    }
    let hash = format!("{:016x}", samples.fingerprint());
    line(text, keys::HASH.name, &string(&hash), &format!("of the {} samples", samples.times().len()));
}

fn table(text: &mut String, name: &str) {
    let _ = writeln!(text, "\n[{name}]");
}

fn number(text: &mut String, key: Key, value: f64) {
    other(text, key, &format!("{value:?}"));
}

/// A line with the meaning of its key as a comment.
fn other(text: &mut String, key: Key, value: &str) {
    let Key { name, symbol, meaning, .. } = key;
    let comment = if symbol.is_empty() { meaning.to_string() } else { format!("{symbol}: {meaning}") };
    line(text, name, value, &comment);
}

/// Column at which comments start if the value is short enough.
const COMMENT_COLUMN: usize = 32;

fn line(text: &mut String, name: &str, value: &str, comment: &str) {
    let _ = writeln!(text, "{:COMMENT_COLUMN$}# {comment}", format!("{name} = {value}  "));
}

fn string(text: &str) -> String {
    toml::Value::from(text).to_string()
}
