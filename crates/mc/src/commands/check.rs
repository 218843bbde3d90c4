//! `mc check`: prints a scenario in full, the numbers that follow from it, and warnings.

use crate::arguments::overrides::Overrides;
use crate::inputs::results;
use crate::output::document::{document, named};
use crate::output::numbers::{bytes, counted, grouped, significant, time, wrapped};
use crate::session::cost;
use crate::{Failure, print_data};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use stickslip::advice::{Derived, DerivedQuantity};
use stickslip::scenario::{Measured, Period, Scenario, WrittenForce};
use stickslip::scheme::{Resolution, Stability};
use stickslip_data::input_unit;

/// Arguments of `mc check`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/check.txt"))]
pub struct Arguments {
    /// The scenario: a TOML file, the name of a shipped one, or - for standard input
    scenario: PathBuf,
    #[command(flatten)]
    overrides: Overrides,
    /// Print one JSON object instead
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let mut scenario = self.overrides.scenario(&self.scenario)?;
        // The printed scenario must run from the working directory, so its data files are named from
        // there.
        let folder = self.scenario.parent().unwrap_or(Path::new(""));
        for measured in &mut scenario.measured {
            measured.file = folder.join(&measured.file).display().to_string();
        }
        if self.json {
            return print_data(&json(&self.scenario.display().to_string(), &scenario));
        }
        // The measurement takes a moment, so what is known without it is printed first.
        print_data(&report(&scenario))?;
        let seconds = cost::measured_cpu_seconds(&scenario, scenario.ensemble.paths)
            .map(|seconds| seconds / crate::cores() as f64);
        print_data(&(duration(seconds) + &warnings(&scenario) + &long(seconds)))
    }
}

/// The resolved scenario, followed by the derived numbers as comments.
pub fn report(scenario: &Scenario) -> String {
    let mut text = scenario.to_toml();
    text.push_str("\n# Derived quantities\n");
    let inputs = scenario
        .measured
        .iter()
        .filter_map(|measured| Some((measured.input()?, measured)));
    let inputs = inputs.map(|(name, measured)| (format!("input {name}"), taken(measured)));
    let derived = derived(scenario)
        .into_iter()
        .map(|(meaning, value)| (meaning.to_string(), value));
    for (meaning, value) in inputs.chain(derived) {
        text += &format!("# {meaning:<46}{value}\n");
    }
    text
}

/// How an input is taken from its file.
fn taken(measured: &Measured) -> String {
    let Measured {
        series,
        unit,
        begin,
        ..
    } = measured;
    let unit = match unit
        .as_ref()
        .and_then(|unit| Some((unit, input_unit(unit)?)))
    {
        None => "unit not given; assuming SI".to_string(),
        Some((_, ("", _))) => "as it is".to_string(),
        Some((_, (si, 1.0))) => format!("in {si}"),
        Some((unit, (si, ratio))) => format!("from {unit} to {si}, times {ratio}"),
    };
    let shifted = if *begin == 0.0 {
        String::new()
    } else {
        format!(", whose time {} is t = 0", number(*begin))
    };
    let [low, high] = [series.range().0, series.range().1].map(number);
    format!(
        "{unit}: {low} to {high}, {} samples to t = {}{shifted}",
        grouped(series.times().len() as u64),
        number(series.end())
    )
}

/// How long the run will take on this machine, as a comment.
fn duration(seconds: Option<f64>) -> String {
    let threads = crate::cores();
    let name = format!(
        "time of the run here, on {}, about",
        counted(threads as u64, "thread")
    );
    let value = seconds.map_or(
        "unknown: no path progressed far enough in a tenth of a second".to_string(),
        time,
    );
    format!("# {name:<46}{value}\n")
}

/// A warning if the run takes hours; empty otherwise.
fn long(seconds: Option<f64>) -> String {
    let Some(seconds) = seconds.filter(|seconds| *seconds > cost::LONG) else {
        return String::new();
    };
    let warning = format!(
        "# warning: the run takes about {} here. Fewer `--paths`, a larger step or tolerance, or `--scheme \
         event-driven` shorten it; `mc run --max-time` bounds it; `mc trade` measures the cost of accuracy",
        time(seconds)
    );
    wrapped(&warning, "#   ")
}

fn warnings(scenario: &Scenario) -> String {
    let warnings = scenario.warnings();
    let lines: String = warnings
        .iter()
        .map(|warning| wrapped(&format!("# warning: {warning}"), "#   "))
        .collect();
    format!(
        "\n{}",
        if lines.is_empty() {
            "# no warnings\n"
        } else {
            &lines
        }
    )
}

/// Significant digits of a derived quantity.
const DIGITS: usize = 6;

fn number(x: f64) -> String {
    significant(x, DIGITS)
}

fn optional(x: Option<f64>, none: &str) -> String {
    x.map_or(none.to_string(), number)
}

/// What a number means, and the number.
type Line = (&'static str, String);

fn derived(scenario: &Scenario) -> Vec<Line> {
    let d = scenario.derived();
    [
        of_model(scenario, &d),
        of_noise(&d),
        of_scheme(&d),
        of_motion(scenario, &d),
        of_run(scenario, &d),
    ]
    .concat()
}

fn of_model(scenario: &Scenario, d: &Derived) -> Vec<Line> {
    let body = scenario.model.oscillator;
    let mut lines = vec![(
        "w0 = sqrt(K/m), natural frequency",
        number(d.natural_frequency),
    )];
    if d.natural_frequency > 0.0 {
        let ratios = d.frequency_ratios.iter();
        lines.extend(ratios.map(|ratio| ("w/w0, forcing", number(*ratio))));
    }
    if body.stiffness > 0.0 {
        lines.push((
            "alpha/(m w0), damping ratio",
            number(body.damping / (body.mass * d.natural_frequency)),
        ));
    }
    if let Some(WrittenForce { without, .. }) = &scenario.written_force {
        let (stiffness, damping) = (number(body.stiffness), number(body.damping));
        let told = match without {
            Some(_) => format!("linear: simulated as K = {stiffness}, alpha = {damping}"),
            None => "general: slips are simulated to a tolerance".to_string(),
        };
        lines.push(("g, user-defined force", told));
    }
    if scenario.model.has_load() {
        lines.push((
            "friction",
            "depends on a load or direction; f_s and f_d below exclude it".to_string(),
        ));
    }
    let amplitudes = scenario
        .model
        .temperature
        .harmonics
        .iter()
        .map(|harmonic| harmonic.amplitude.abs());
    let forcing = body.force_per_temperature().abs() * amplitudes.fold(0.0, |sum, size| sum + size);
    lines.push(("K beta sum |a|, force of the harmonics", number(forcing)));
    lines.push((
        "f_d/f_s, friction ratio",
        optional(d.friction_ratio, "none: f_s = 0"),
    ));
    lines
}

fn of_noise(d: &Derived) -> Vec<Line> {
    let mut lines = vec![(
        "K beta rho sigma/sqrt(2 theta), noise in b",
        optional(d.noise_force, "no noise"),
    )];
    if d.noise_force.is_some() {
        lines.push((
            "f_s/(K beta rho), half width of the stick band in v",
            optional(d.corridor_half_width, "unbounded"),
        ));
        lines.push((
            "(f_s/(K beta rho sigma))^2, time to cross it",
            optional(d.corridor_time, "unbounded"),
        ));
    }
    lines
}

/// What limits the scheme.
fn of_scheme(d: &Derived) -> Vec<Line> {
    let mut lines = Vec::new();
    if let Some(amplitude) = d.runaway_amplitude {
        lines.push((
            "amplitude beyond which the motion grows without bound",
            number(amplitude),
        ));
    }
    lines.extend(d.stability.map(of_stability));
    if let Some(shift) = d.monitoring_shift {
        lines.push((
            "0.5826 K beta rho sigma sqrt(h), shift of f_s",
            number(shift),
        ));
    }
    if let Some(tolerance) = d.tolerance {
        lines.push(("tolerance, relative", number(tolerance)));
    }
    if let Some(Resolution {
        static_force,
        shortest_slip,
    }) = d.resolution
    {
        lines.push((
            "resolution: shortest slip resolved, about",
            number(shortest_slip),
        ));
        lines.push(("resolution: f_s as simulated", static_force.to_string()));
    }
    lines
}

fn of_stability(stability: Stability) -> Line {
    let (meaning, limit, why) = match stability {
        Stability::Growing {
            critical_amplitude: a,
        } => (
            "the same, including the error of the step",
            a,
            " (negative damping)",
        ),
        Stability::Undamped {
            critical_amplitude: a,
        } => (
            "A_c = 4 f_d/(pi w0 h K), critical amplitude",
            a,
            " (no damping)",
        ),
        Stability::Underdamped { largest_step: h } => (
            "2 alpha/K, stability limit of the step",
            h,
            " (underdamped)",
        ),
        Stability::Overdamped { largest_step: h } => (
            "2/|lambda_max|, stability limit of the step",
            h,
            " (overdamped)",
        ),
        Stability::NewVelocity { largest_step: h } => ("stability limit of the step", h, ""),
    };
    (meaning, number(limit) + why)
}

fn of_motion(scenario: &Scenario, d: &Derived) -> Vec<Line> {
    let without = match d.runaway_amplitude {
        _ if scenario.model.force.is_some() => " without [force]",
        Some(limit) if d.expected_amplitude > limit => " if the motion stays bounded",
        _ => "",
    };
    let with_source =
        |period: Period| format!("{}, {}", number(period.length), period.source.words());
    vec![
        (
            "largest |x| expected, roughly",
            significant(d.expected_amplitude, 2) + without,
        ),
        (
            "P, period at which displacements are compared",
            d.period.map_or("none".to_string(), with_source),
        ),
        ("whole periods P", number(d.whole_periods)),
        (
            "whole periods P that are counted",
            grouped(d.counted_periods as u64),
        ),
    ]
}

/// What the run takes.
fn of_run(scenario: &Scenario, d: &Derived) -> Vec<Line> {
    let none = || {
        format!(
            "none; the {} scheme does not use time.step",
            scenario.scheme.name()
        )
    };
    let memory = scenario.run_bytes(scenario.ensemble.paths, crate::cores());
    let mut lines = vec![("steps of a path", d.steps.map_or_else(none, grouped))];
    if let Some(steps) = d.path_steps {
        lines.push(("path-steps in all", significant(steps, 3)));
    }
    lines.extend([
        ("rows of the output grid", grouped(d.rows as u64)),
        ("memory of the run, about", bytes(memory)),
        ("output file, about", bytes(d.output_bytes)),
    ]);
    lines
}

fn json(path: &str, scenario: &Scenario) -> String {
    let number = |quantity| match quantity {
        DerivedQuantity::Unknown => Value::Null,
        DerivedQuantity::Real(number) => json!(number),
        DerivedQuantity::Count(number) => json!(number),
        DerivedQuantity::Reals(numbers) => json!(numbers),
    };
    let derived = scenario
        .derived()
        .quantities()
        .map(|(name, quantity)| (name.to_string(), number(quantity)));
    let check = json!({
        "scenario": path,
        "resolved": scenario.to_toml(),
        "derived": derived.into_iter().collect::<Map<_, _>>(),
        // Whether the event-driven scheme is exact in law, or follows a force of the user's own.
        "class": if scenario.model.force.is_some() { "general" } else { "linear" },
        // CPU seconds of the run on one thread of this machine; null where they could not be
        // estimated.
        "cpu_seconds": cost::measured_cpu_seconds(scenario, scenario.ensemble.paths),
        "warnings": named(&results::named(&scenario.warnings())),
    });
    document("check", check)
}
