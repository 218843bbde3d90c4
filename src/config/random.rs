//! Inputs that are drawn anew for each path: reading and writing of their tables.

use super::error::Diagnostic;
use super::fields::Fields;
use super::keys::{self, Key};
use super::source::{MeasuredFrom, Sources};
use crate::model::{
    Expression, InitialNoise, InputSpectrum, OrnsteinUhlenbeck, OwnProcess, PulseShape, PulseSize,
    RandomInput, RandomProcess, Realisations,
};
use crate::scenario::Measured;
use std::sync::Arc;

/// The keys that each process has besides `process`.
const PROCESSES: [(&str, &[Key]); 7] = [
    (
        "telegraph",
        &[keys::LOW, keys::HIGH, keys::RATE_UP, keys::RATE_DOWN],
    ),
    (
        "shot",
        &[
            keys::RATE,
            keys::SIZE,
            keys::SIZE_SD,
            keys::SIZES,
            keys::SHAPE,
            keys::DURATION,
            keys::SAMPLE_STEP,
        ],
    ),
    (
        "kanai-tajimi",
        &[
            keys::OF_FILTER,
            keys::DAMPING_RATIO,
            keys::OF_PROCESS,
            keys::SAMPLE_STEP,
            keys::ENVELOPE,
        ],
    ),
    (
        "ornstein-uhlenbeck",
        &[
            keys::OF_PROCESS,
            keys::RELAXATION_RATE,
            keys::DIFFUSION,
            keys::INITIAL_NOISE,
            keys::SAMPLE_STEP,
            keys::ENVELOPE,
        ],
    ),
    (SPECTRUM, &[keys::SAMPLE_STEP, keys::ENVELOPE]),
    (Realisations::OF_FILE, &[keys::REUSE]),
    ("own", &[]),
];

/// The process whose spectrum is in a file. It has the keys of a file, too, like
/// [`Realisations::OF_FILE`].
pub(super) const SPECTRUM: &str = "spectrum";

/// The name of the process of a table, if it has one.
pub(super) fn process_of(table: &Fields<'_>) -> Option<&'static str> {
    table.word(keys::PROCESS, &PROCESSES.map(|(name, _)| name))
}

/// Whether a table names a process, even an invalid one.
pub(super) fn is_process(table: &Fields<'_>) -> bool {
    table.place_of(keys::PROCESS.name).is_some()
}

/// The laws of the areas and the shapes of pulses.
const LAWS: [&str; 3] = ["fixed", "exponential", "normal"];
const SHAPES: [&str; 3] = ["kick", "rectangle", "decay"];

/// Read the process of a table; `file` holds what was read from its file.
pub(super) fn random_input(
    sources: &Sources<'_>,
    table: &Fields<'_>,
    name: &str,
    file: Option<&Measured>,
    parameters: &[(String, f64)],
) -> Option<RandomInput> {
    let process = process_of(table)?;
    let (_, allowed) = PROCESSES.into_iter().find(|(name, _)| *name == process)?;
    report_unused(sources, table, process, allowed);
    let process = match process {
        "telegraph" => {
            let up = table.number(keys::RATE_UP);
            RandomProcess::Telegraph {
                values: [
                    table.number_or(keys::LOW, -1.0),
                    table.number_or(keys::HIGH, 1.0),
                ],
                rates: [up, table.number_or(keys::RATE_DOWN, up)],
            }
        }
        "shot" => shot(sources, table),
        "kanai-tajimi" => RandomProcess::KanaiTajimi {
            angular_frequency: table.number(keys::OF_FILTER),
            damping_ratio: table.number(keys::DAMPING_RATIO),
            intensity: table.number(keys::OF_PROCESS),
        },
        "ornstein-uhlenbeck" => RandomProcess::OrnsteinUhlenbeck(OrnsteinUhlenbeck {
            intensity: table.number(keys::OF_PROCESS),
            relaxation_rate: table.number_or(keys::RELAXATION_RATE, 1.0),
            diffusion: table.number_or(keys::DIFFUSION, 1.0),
            initial: match table.number_or_word(keys::INITIAL_NOISE, &["stationary"]) {
                Some(Ok(v0)) => InitialNoise::At(v0),
                Some(Err(_)) | None => InitialNoise::Stationary,
            },
        }),
        "own" => {
            if !matches!(sources.measured_from, MeasuredFrom::Stored(_)) {
                let problem = "has realisations of its own, which a text does not hold";
                let remedy = "give them with `inputs` in Python or `Problem::input` in Rust, or name another process";
                sources.report(table.diagnostic_of_table(problem, remedy));
            }
            RandomProcess::Own(OwnProcess::missing())
        }
        Realisations::OF_FILE => file?.random.as_ref()?.process.clone(),
        _ => {
            let Measured { file, series, .. } = file?;
            let densities = series.values().to_vec();
            if densities.iter().any(|density| *density < 0.0) || series.bound() == 0.0 {
                let problem = "holds a negative density, or none above 0";
                let remedy =
                    "give a one-sided spectrum: densities over frequencies in cycles per time";
                sources.report(table.diagnostic_of_table(problem, remedy));
            }
            RandomProcess::Spectrum(Arc::new(InputSpectrum {
                file: file.clone(),
                frequencies: series.times().to_vec(),
                densities,
            }))
        }
    };
    let step = match process.is_sampled() {
        true => table.number(keys::SAMPLE_STEP),
        false => 1.0,
    };
    Some(RandomInput {
        name: name.into(),
        process,
        step,
        envelope: envelope(sources, table, parameters),
    })
}

/// Report the keys of other processes.
fn report_unused(sources: &Sources<'_>, table: &Fields<'_>, process: &str, allowed: &[Key]) {
    for key in all_keys().filter(|key| allowed.iter().all(|other| other.name != key.name)) {
        if let Some(place) = table.place_of(key.name) {
            let problem = format!(
                "`{}` has no meaning for the process \"{process}\"",
                table.dotted(key.name)
            );
            let of_process: Vec<&str> = allowed.iter().map(|key| key.name).collect();
            let remedy = format!(
                "remove it; the process has the keys {}",
                of_process.join(", ")
            );
            sources.report(sources.diagnostic(Some(place), problem, remedy));
        }
    }
}

/// Every key of a process.
fn all_keys() -> impl Iterator<Item = &'static Key> {
    PROCESSES.iter().flat_map(|(_, keys)| keys.iter())
}

fn shot(sources: &Sources<'_>, table: &Fields<'_>) -> RandomProcess {
    let size = table.number(keys::SIZE);
    let law = table.word(keys::SIZES, &LAWS).unwrap_or(LAWS[0]);
    let shape = table.word(keys::SHAPE, &SHAPES).unwrap_or(SHAPES[0]);
    let unused = |key: Key, is_used: bool, of: &str| {
        let place = table.place_of(key.name).filter(|_| !is_used);
        if let Some(place) = place {
            let problem = format!("`{}` has no meaning for {of}", table.dotted(key.name));
            sources.report(sources.diagnostic(Some(place), problem, "remove it"));
        }
    };
    unused(keys::SIZE_SD, law == "normal", "areas that are not normal");
    unused(keys::DURATION, shape != "kick", "kicks");
    unused(
        keys::SAMPLE_STEP,
        shape == "decay",
        "pulses without a decay",
    );
    RandomProcess::Shot {
        rate: table.number(keys::RATE),
        size: match law {
            "exponential" => PulseSize::Exponential(size),
            "normal" => PulseSize::Normal(size, table.number_or(keys::SIZE_SD, 0.0)),
            _ => PulseSize::Fixed(size),
        },
        shape: match shape {
            "rectangle" => PulseShape::Rectangle(table.number(keys::DURATION)),
            "decay" => PulseShape::Decay(table.number(keys::DURATION)),
            _ => PulseShape::Kick,
        },
    }
}

/// The envelope of a table, an expression of t and the parameters.
fn envelope(
    sources: &Sources<'_>,
    table: &Fields<'_>,
    parameters: &[(String, f64)],
) -> Option<Expression> {
    let place = table.place_of(keys::ENVELOPE.name)?;
    let text = table.line_if_present(keys::ENVELOPE)?;
    let wrong = |problem: String, remedy: String| -> Box<Diagnostic> {
        sources
            .diagnostic(Some(place), problem, remedy)
            .of(&table.dotted(keys::ENVELOPE.name))
    };
    let read =
        Expression::parse(&text, parameters).map_err(|error| wrong(error.problem, error.remedy));
    let envelope = sources.or_report(read)?;
    if !envelope.is_of_time_alone() {
        let remedy = "write an expression of t, such as exp(-t/5)";
        sources.report(wrong("must be a function of t alone".into(), remedy.into()));
    }
    Some(envelope)
}

/// The keys of a random input with their values, in the order of the table; a number as the function
/// writes it.
pub(super) fn written(
    input: &RandomInput,
    number: impl Fn(Key, f64) -> String,
    string: impl Fn(&str) -> String,
) -> Vec<(Key, String)> {
    let mut all = vec![(keys::PROCESS, string(input.process.name()))];
    let mut numbers = |pairs: &[(Key, f64)]| {
        all.extend(
            pairs
                .iter()
                .map(|(key, value)| (*key, number(*key, *value))),
        );
    };
    match &input.process {
        RandomProcess::Telegraph {
            values: [low, high],
            rates: [up, down],
        } => numbers(&[
            (keys::LOW, *low),
            (keys::HIGH, *high),
            (keys::RATE_UP, *up),
            (keys::RATE_DOWN, *down),
        ]),
        RandomProcess::Shot { rate, size, shape } => {
            let (law, mean, sd) = match size {
                PulseSize::Fixed(mean) => (LAWS[0], mean, None),
                PulseSize::Exponential(mean) => (LAWS[1], mean, None),
                PulseSize::Normal(mean, sd) => (LAWS[2], mean, Some(*sd)),
            };
            let (shape, duration) = match shape {
                PulseShape::Kick => (SHAPES[0], None),
                PulseShape::Rectangle(duration) => (SHAPES[1], Some(*duration)),
                PulseShape::Decay(time) => (SHAPES[2], Some(*time)),
            };
            numbers(&[(keys::RATE, *rate), (keys::SIZE, *mean)]);
            sd.iter().for_each(|sd| numbers(&[(keys::SIZE_SD, *sd)]));
            duration
                .iter()
                .for_each(|duration| numbers(&[(keys::DURATION, *duration)]));
            all.extend([(keys::SIZES, string(law)), (keys::SHAPE, string(shape))]);
        }
        RandomProcess::KanaiTajimi {
            angular_frequency,
            damping_ratio,
            intensity,
        } => numbers(&[
            (keys::OF_FILTER, *angular_frequency),
            (keys::DAMPING_RATIO, *damping_ratio),
            (keys::OF_PROCESS, *intensity),
        ]),
        RandomProcess::OrnsteinUhlenbeck(noise) => {
            numbers(&[
                (keys::OF_PROCESS, noise.intensity),
                (keys::RELAXATION_RATE, noise.relaxation_rate),
                (keys::DIFFUSION, noise.diffusion),
            ]);
            if let InitialNoise::At(v0) = noise.initial {
                numbers(&[(keys::INITIAL_NOISE, v0)]);
            }
        }
        RandomProcess::Own(own) if own.0.is_reused() => all.push((keys::REUSE, "true".into())),
        RandomProcess::Spectrum(_) | RandomProcess::Own(_) => {}
    }
    if input.process.is_sampled() {
        all.push((keys::SAMPLE_STEP, number(keys::SAMPLE_STEP, input.step)));
    }
    if let Some(envelope) = &input.envelope {
        all.push((keys::ENVELOPE, string(envelope.text())));
    }
    all
}
