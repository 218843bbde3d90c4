//! A scenario as TOML, with every default and with the symbol of the paper next to every number.

use super::fields::DIRECTIONS;
use super::keys::{self, Key};
use super::random;
use crate::model::{
    Drive, Force, Friction, InitialNoise, OrnsteinUhlenbeck, Problem, Sides, Temperature,
};
use crate::scenario::{
    Ensemble, Measured, Period, Scenario, SensorBearing, Statistics, Time, Units, WhiteNoise,
    WrittenForce,
};
use crate::scheme::Scheme;
use crate::stats::Record;
use std::fmt::{Display, Write as _};

/// The lines of a scenario.
#[derive(Default)]
struct Written<'a> {
    lines: String,
    /// The dotted name of the current table.
    table: String,
    /// The keys whose numbers name a parameter, and the values of parameters.
    named: &'a [(String, String)],
    parameters: &'a [(String, f64)],
}

/// Column at which comments start if the value is short enough.
const COMMENT_COLUMN: usize = 32;

impl Written<'_> {
    fn plain(&mut self, line: impl Display) {
        let _ = writeln!(self.lines, "{line}");
    }

    fn table(&mut self, name: &str) {
        self.plain(format!("\n[{name}]"));
        self.table = name.to_string();
    }

    /// The next table of an array, with a comment.
    fn entry(&mut self, name: &str, index: usize, comment: &str) {
        self.plain(format!("\n[[{name}]]  # {comment}"));
        self.table = format!("{name}.{index}");
    }

    /// The parameter that the number at a key names, if it still has this value.
    fn parameter(&self, name: &str, value: f64) -> Option<&str> {
        let parameter = self.name_at(&format!("{}.{name}", self.table))?;
        let (_, now) = self
            .parameters
            .iter()
            .find(|(known, _)| known == parameter)?;
        (*now == value).then_some(parameter)
    }

    /// The parameter that the number at a dotted key names, whatever its present value.
    fn name_at(&self, dotted: &str) -> Option<&str> {
        self.named
            .iter()
            .find(|(key, _)| key == dotted)
            .map(|(_, name)| name.as_str())
    }

    /// A number, or the parameter that it names.
    fn shown(&self, name: &str, value: f64) -> String {
        self.parameter(name, value)
            .map_or_else(|| format!("{value:?}"), string)
    }

    fn number(&mut self, key: Key, value: f64) {
        self.other(key, self.shown(key.name, value));
    }

    /// A line with the meaning of its key as a comment.
    fn other(
        &mut self,
        Key {
            name,
            symbol,
            meaning,
            ..
        }: Key,
        value: impl Display,
    ) {
        let colon = if symbol.is_empty() { "" } else { ": " };
        self.line(name, value, &format!("{symbol}{colon}{meaning}"));
    }

    fn line(&mut self, name: &str, value: impl Display, comment: &str) {
        self.plain(format!(
            "{:COMMENT_COLUMN$}# {comment}",
            format!("{name} = {value}  ")
        ));
    }
}

impl Scenario {
    /// The whole scenario as TOML with every default; reading it gives the same scenario again. Each
    /// number is the shortest decimal that reads back as the same double.
    pub fn to_toml(&self) -> String {
        let mut text = Written {
            lines: format!("title = {}\n", string(&self.title)),
            named: &self.written.named,
            parameters: &self.written.parameters,
            ..Written::default()
        };
        physics(&mut text, self);
        if let Some(bearing) = self.bearing {
            self::bearing(&mut text, bearing);
        }
        time(&mut text, self.time, self.scheme);
        scheme(&mut text, self);
        statistics(&mut text, self);
        ensemble(&mut text, self.ensemble);
        record(&mut text, &self.record);
        units(&mut text, &self.units);
        text.lines
    }

    /// The whole scenario as TOML that is meant to be edited: every default is written, every key
    /// has a comment, and tables that the scenario does not use are added as comments. Reading it
    /// gives the same scenario again. Keys that apply only to its samples are left out.
    pub fn to_template(&self) -> String {
        let is_of_samples = |line: &&str| {
            ["start = ", "hash = "]
                .iter()
                .any(|key| line.starts_with(key))
        };
        let resolved = self.to_toml();
        let mut text: String = resolved
            .lines()
            .filter(|line| !is_of_samples(line))
            .map(|line| format!("{line}\n"))
            .collect();
        let temperature = &self.model.temperature;
        let unused = [
            (
                temperature.noises.is_empty(),
                include_str!("parts/noise.toml"),
            ),
            (
                temperature.series.is_none(),
                include_str!("parts/series.toml"),
            ),
            (
                self.written.force.is_none(),
                include_str!("parts/force.toml"),
            ),
            (
                self.written
                    .measured
                    .iter()
                    .all(|measured| measured.input().is_none()),
                include_str!("parts/input.toml"),
            ),
            (self.bearing.is_none(), include_str!("parts/bearing.toml")),
        ];
        let unused: Vec<&str> = unused
            .iter()
            .filter(|(is_unused, _)| *is_unused)
            .map(|(_, part)| *part)
            .collect();
        if !unused.is_empty() {
            text.push_str(
                "\n# Optional tables that this scenario does not use. Remove the `#` to use one.\n",
            );
        }
        for part in unused {
            text.push('\n');
            text.extend(part.lines().map(|line| format!("# {line}\n")));
        }
        text
    }
}

fn physics(text: &mut Written, scenario: &Scenario) {
    let (model, written) = (&scenario.model, &scenario.written);
    let oscillator = written
        .force
        .as_ref()
        .and_then(|force| force.without)
        .unwrap_or(model.oscillator);
    text.table("oscillator");
    text.number(keys::MASS, oscillator.mass);
    text.number(keys::STIFFNESS, oscillator.stiffness);
    text.number(keys::DAMPING, oscillator.damping);
    match oscillator.drive {
        Drive::Dilatation(beta) => text.number(keys::DILATATION, beta),
        Drive::Force(c) => text.number(keys::FORCE_PER_TEMPERATURE, c),
    }
    text.table("friction");
    friction(text, model);
    let (inputs, series): (Vec<_>, Vec<_>) = written
        .measured
        .iter()
        .partition(|measured| measured.input().is_some());
    temperature(
        text,
        &model.temperature,
        series.first().copied(),
        written.white_noise,
        written.beside_white.as_ref(),
    );
    inputs
        .into_iter()
        .for_each(|input| series_of(text, input, keys::COLUMN));
    if let Some(WrittenForce { expression, .. }) = &written.force {
        text.table("force");
        text.other(keys::EXPRESSION, string(expression.text()));
    }
    if !written.parameters.is_empty() {
        text.table(keys::PARAMETERS.name);
    }
    for (name, value) in &written.parameters {
        text.plain(format!("{name} = {value:?}"));
    }
    text.table("initial");
    if written.is_balanced {
        let x0 = model.initial_displacement;
        text.line(
            keys::DISPLACEMENT.name,
            "\"balanced\"",
            &format!("x0: beta T(0) = {x0:?}, zero spring force"),
        );
    } else {
        text.number(keys::DISPLACEMENT, model.initial_displacement);
    }
    if model.initial_velocity != 0.0 || text.name_at("initial.velocity").is_some() {
        text.number(keys::VELOCITY, model.initial_velocity);
    }
}

fn bearing(text: &mut Written, SensorBearing { stiffness, offset }: SensorBearing) {
    text.table("bearing");
    match stiffness {
        Some(stiffness) => text.number(keys::BEARING_STIFFNESS, stiffness),
        None => text.plain("# no stiffness: the bearing is rigid"),
    }
    text.number(keys::OFFSET, offset);
}

fn time(text: &mut Written, Time { end, output_step }: Time, scheme: Scheme) {
    text.table("time");
    text.number(keys::END, end);
    match scheme.step() {
        Some(step) => text.number(keys::STEP, step),
        // Keys that a scheme without a step ignores are kept, so that the parameter remains in use.
        None => match text.name_at("time.step").map(string) {
            Some(name) => text.other(keys::STEP, name),
            None => text.plain(format!(
                "# no step: the {} scheme does not use one",
                scheme.name()
            )),
        },
    }
    text.number(keys::OUTPUT_STEP, output_step);
}

fn scheme(text: &mut Written, Scenario { model, scheme, .. }: &Scenario) {
    text.table("scheme");
    let is_followed = model.force.is_some() && !scheme.kind().has_step();
    let meaning = if is_followed {
        "event by event, user-defined force integrated to the tolerance"
    } else {
        scheme.kind().meaning()
    };
    text.line(keys::KIND.name, string(scheme.name()), meaning);
    if let Some(tolerance) = scheme.tolerance() {
        text.number(keys::TOLERANCE, tolerance);
    }
}

fn statistics(text: &mut Written, scenario: &Scenario) {
    text.table("statistics");
    let Statistics { after, period } = scenario.statistics;
    text.number(keys::AFTER, after);
    let levels = &scenario.record.levels;
    if !levels.is_empty() {
        let levels: Vec<String> = levels.iter().map(|level| format!("{level:?}")).collect();
        text.other(keys::LEVELS, format!("[{}]", levels.join(", ")));
    }
    match (period, scenario.period()) {
        (Some(period), _) => text.number(keys::COMPARED, period),
        (None, Some(Period { length, source })) => {
            text.plain(format!(
                "# no period, so P is {}, {length:?}",
                source.words()
            ));
        }
        (None, None) => {}
    }
}

fn ensemble(text: &mut Written, ensemble: Ensemble) {
    text.table("ensemble");
    text.other(keys::PATHS, ensemble.paths);
    text.other(keys::SEED, ensemble.seed);
    text.other(keys::ANTITHETIC, ensemble.antithetic);
}

fn record(text: &mut Written, record: &Record) {
    let Record {
        paths,
        events,
        trajectories,
        laws,
        density,
        spectrum,
        energy,
        levels: _,
    } = *record;
    text.table("record");
    text.other(keys::RECORD_PATHS, paths);
    text.other(keys::EVENTS, events);
    text.other(keys::TRAJECTORIES, trajectories);
    for (key, is_asked) in [
        (keys::LAWS, laws),
        (keys::DENSITY, density),
        (keys::SPECTRUM, spectrum),
        (keys::ENERGY, energy),
    ] {
        text.other(key, is_asked);
    }
}

fn units(text: &mut Written, units: &Units) {
    let Units {
        time,
        length,
        force,
        temperature,
    } = units;
    text.table("units");
    for (key, label) in [
        (keys::TIME_LABEL, time),
        (keys::LENGTH_LABEL, length),
        (keys::FORCE_LABEL, force),
        (keys::TEMPERATURE_LABEL, temperature),
    ] {
        text.other(key, string(label));
    }
}

fn friction(text: &mut Written, model: &Problem) {
    let both = model.friction_by_direction();
    let mut threshold = |key: Key, of: fn(&Friction) -> f64| match both.each_ref().map(of) {
        [forward, backward] if forward == backward => text.number(key, forward),
        both => {
            let shown = |i: usize| text.shown(&format!("{}.{}", key.name, DIRECTIONS[i]), both[i]);
            let [[first, second], [forward, backward]] =
                [DIRECTIONS.map(String::from), [0, 1].map(shown)];
            text.other(
                key,
                format!("{{ {first} = {forward}, {second} = {backward} }}"),
            );
        }
    };
    threshold(keys::STATIC, |friction| friction.static_force);
    threshold(keys::DYNAMIC, |friction| friction.dynamic_force);
    let load = model
        .force
        .as_ref()
        .and_then(Force::sides)
        .and_then(Sides::load)
        .and_then(Force::expression);
    if let Some(load) = load {
        text.other(keys::LOAD, string(load.text()));
    }
}

/// The `[temperature.harmonics]` and `[temperature.noise]` of a scenario as TOML. A series is left
/// out, because its samples are in a separate file.
pub fn temperature_part(temperature: &Temperature) -> String {
    let mut text = Written::default();
    self::temperature(&mut text, temperature, None, None, None);
    text.lines
}

fn temperature(
    text: &mut Written,
    of: &Temperature,
    measured: Option<&Measured>,
    white: Option<WhiteNoise>,
    beside: Option<&OrnsteinUhlenbeck>,
) {
    let has_line = of.has_line()
        || ["offset", "trend"]
            .iter()
            .any(|key| text.name_at(&format!("temperature.{key}")).is_some());
    if has_line || of.harmonics.is_empty() {
        text.table("temperature");
    }
    if has_line {
        text.number(keys::TEMPERATURE_OFFSET, of.offset);
        text.number(keys::TREND, of.trend);
    }
    if of.harmonics.is_empty() {
        let meaning = if has_line {
            "no harmonics"
        } else {
            "no deterministic part"
        };
        text.line(keys::HARMONICS.name, "[]", meaning);
    }
    for (i, harmonic) in of.harmonics.iter().enumerate() {
        text.entry("temperature.harmonics", i, "a cos(w t + phi)");
        text.number(keys::AMPLITUDE, harmonic.amplitude);
        text.number(keys::ANGULAR_FREQUENCY, harmonic.angular_frequency);
        text.number(keys::PHASE, harmonic.phase);
    }
    if let Some(measured) = measured {
        series_of(text, measured, keys::VALUE);
    }
    if let Some(beside) = beside {
        text.entry("temperature.noise", 0, "rho v, beside white noise");
        noise(text, beside);
        text.entry("temperature.noise", 1, "white noise");
        for (white, simulated) in white.into_iter().zip(&of.noises) {
            white_noise(text, white, simulated);
        }
        return;
    }
    match &of.noises[..] {
        [] => text.plain("\n# no [temperature.noise]: rho = 0"),
        [only] => {
            text.table("temperature.noise");
            match white {
                Some(white) => white_noise(text, white, only),
                None => noise(text, only),
            }
            if of.is_pinned {
                text.other(keys::PINNED, "true");
            }
        }
        several => {
            for (i, each) in several.iter().enumerate() {
                text.entry("temperature.noise", i, "rho v, one of two");
                noise(text, each);
            }
        }
    }
}

fn noise(
    text: &mut Written,
    OrnsteinUhlenbeck {
        intensity,
        relaxation_rate,
        diffusion,
        initial,
    }: &OrnsteinUhlenbeck,
) {
    text.number(keys::INTENSITY, *intensity);
    text.number(keys::RELAXATION_RATE, *relaxation_rate);
    text.number(keys::DIFFUSION, *diffusion);
    match initial {
        InitialNoise::At(v0) => text.number(keys::INITIAL_NOISE, *v0),
        InitialNoise::Stationary => text.line(
            keys::INITIAL_NOISE.name,
            "\"stationary\"",
            "v(0) ~ N(0, sigma^2 / (2 theta))",
        ),
    }
}

fn white_noise(text: &mut Written, white: WhiteNoise, simulated: &OrnsteinUhlenbeck) {
    text.other(keys::NOISE_KIND, string("white"));
    text.number(keys::STRENGTH, white.strength);
    match white.relaxation_rate {
        Some(theta) => text.number(keys::RELAXATION_RATE, theta),
        None => text.plain(format!(
            "# no relaxation_rate, so theta is {:?}",
            simulated.relaxation_rate
        )),
    }
}

/// The source of measured values; this key names their column.
fn series_of(text: &mut Written, measured: &Measured, column: Key) {
    let Measured {
        table,
        series,
        file,
        value,
        unit,
        layout,
        max_gap,
        start,
        is_held,
        random: process,
        ..
    } = measured;
    text.table(table);
    if let Some(process) = process {
        let number = |key: Key, value| text.shown(key.name, value);
        let of_process = random::written(process, number, string);
        of_process
            .into_iter()
            .for_each(|(key, value)| text.other(key, value));
    }
    if !measured.is_in_file() {
        return;
    }
    text.other(keys::FILE, string(file));
    let missing: Vec<String> = layout.missing.iter().map(|mark| string(mark)).collect();
    for (key, given) in [
        (keys::SERIES_TIME, layout.time.as_deref().map(string)),
        (column, Some(string(value)).filter(|_| !value.is_empty())),
        (
            keys::SAMPLE_STEP,
            layout
                .step
                .map(|step| text.shown(keys::SAMPLE_STEP.name, step)),
        ),
        (keys::UNIT, unit.as_deref().map(string)),
        (keys::ZONE, layout.zone.as_deref().map(string)),
        (keys::DATES, layout.dates.map(|order| string(order.word()))),
        (keys::SKIP, layout.skip.map(|lines| lines.to_string())),
        (
            keys::MISSING,
            Some(format!("[{}]", missing.join(", "))).filter(|_| !missing.is_empty()),
        ),
        (keys::SKIP_BAD, layout.skip_bad.then(|| "true".into())),
        (keys::OUTLIERS, layout.outliers.map(|far| far.to_string())),
        (
            keys::DECIMAL,
            layout.decimal.map(|mark| string(&mark.to_string())),
        ),
        (
            keys::AVERAGED,
            layout.averaged.map(|seconds| seconds.to_string()),
        ),
        (
            keys::MAX_GAP,
            max_gap.map(|gap| text.shown(keys::MAX_GAP.name, gap)),
        ),
        (keys::START, start.as_deref().map(string)),
        (keys::INTERPOLATION, is_held.then(|| string("constant"))),
    ] {
        if let Some(given) = given {
            text.other(key, &given);
        }
    }
    let hash = format!("{:016x}", series.fingerprint());
    text.line(
        keys::HASH.name,
        string(&hash),
        &format!("of the {} samples", series.times().len()),
    );
}

fn string(text: &str) -> String {
    toml::Value::from(text).to_string()
}
