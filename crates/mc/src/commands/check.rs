//! `mc check`: prints a scenario in full, the numbers that follow from it, and warnings.

use crate::arguments::overrides::Overrides;
use crate::inputs::results;
use crate::output::document::{document, named};
use crate::output::numbers::{bytes, counted, grouped, significant, time, wrapped};
use crate::session::cost;
use crate::{Failure, print_data};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use stickslip::advice::DerivedQuantity;
use stickslip::model::{Oscillator, ProcessMoments, RandomInput};
use stickslip::scenario::{Measured, Scenario, WrittenForce};
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
        // The printed scenario must run from the working directory, so the paths of its data files
        // are relative to it.
        let folder = self.scenario.parent().unwrap_or(Path::new(""));
        for measured in &mut scenario.written.measured {
            if !measured.file.is_empty() {
                measured.file = folder.join(&measured.file).display().to_string();
            }
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
        .written
        .measured
        .iter()
        .filter(|measured| measured.input().is_some() || measured.random.is_some());
    let inputs =
        inputs.map(|measured| (measured.table.replace("input.", "input "), taken(measured)));
    for (meaning, value) in inputs.chain(derived(scenario)) {
        text += &format!("# {meaning:<46}{value}\n");
    }
    text
}

/// How an input was read from its file.
fn taken(measured: &Measured) -> String {
    if let Some(random) = &measured.random {
        return drawn(random);
    }
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
        None => "read in SI units (no unit given)".to_string(),
        Some((_, ("", _))) => "as it is".to_string(),
        Some((_, (si, 1.0))) => format!("in {si}"),
        Some((unit, (si, ratio))) => format!("from {unit} to {si}, times {ratio}"),
    };
    let shifted = if *begin == 0.0 {
        String::new()
    } else {
        format!(", where t = 0 is {} in the file", number(*begin))
    };
    let [low, high] = [series.range().0, series.range().1].map(number);
    format!(
        "{unit}: {low} to {high}, {} samples to t = {}{shifted}",
        grouped(series.times().len() as u64),
        number(series.end())
    )
}

/// The law of an input that each path draws, without its envelope.
fn drawn(RandomInput { process, step, .. }: &RandomInput) -> String {
    let name = process.name();
    let Some(ProcessMoments { mean, sd, time }) = process.moments() else {
        return format!("{name}: each path has a series of its own");
    };
    let [mean, time, step] = [mean, time, *step].map(number);
    let spread = match sd.is_finite() {
        true => format!("sd {}, correlation time {time}", number(sd)),
        false => "kicks: no sd".to_string(),
    };
    let sampled = match process.is_sampled() {
        true => format!(", sampled every {step}"),
        false => ", at its own times".to_string(),
    };
    format!("{name}: mean {mean}, {spread}{sampled}")
}

/// How long the run will take on this machine, as a comment.
fn duration(seconds: Option<f64>) -> String {
    let threads = crate::cores();
    let name = format!(
        "run time here, on {}, about",
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

/// Names and values of the derived quantities that exist.
fn derived(scenario: &Scenario) -> Vec<(String, String)> {
    let shown = |(name, meaning, quantity): (&str, &str, DerivedQuantity)| {
        let shown = match (name, quantity) {
            (_, DerivedQuantity::Unknown) => return None,
            (_, DerivedQuantity::Count(count)) => grouped(count),
            (_, DerivedQuantity::Reals(all)) => {
                let all = all.into_iter().filter(|x| x.is_finite()).map(number);
                Some(all.collect::<Vec<_>>().join(", ")).filter(|all| !all.is_empty())?
            }
            ("expected_amplitude", DerivedQuantity::Real(x)) => significant(x, 2),
            ("output_bytes", DerivedQuantity::Real(x)) => bytes(x),
            ("resolution_static_force", DerivedQuantity::Real(x)) => x.to_string(),
            (_, DerivedQuantity::Real(x)) => number(x),
        };
        Some((meaning.to_string(), shown))
    };
    let mut lines: Vec<_> = scenario.derived().quantities().filter_map(shown).collect();
    if let Some(WrittenForce { without, .. }) = &scenario.written.force {
        let Oscillator {
            stiffness, damping, ..
        } = scenario.model.oscillator;
        let told = match without {
            Some(_) => {
                format!(
                    "linear: simulated as K = {}, alpha = {}",
                    number(stiffness),
                    number(damping)
                )
            }
            None => "general: slips are simulated to a tolerance".to_string(),
        };
        lines.push(("g, user-defined force".into(), told));
    }
    let memory = scenario.run_bytes(scenario.ensemble.paths, crate::cores());
    lines.push(("memory of the run, about".into(), bytes(memory)));
    lines
}

fn json(path: &str, scenario: &Scenario) -> String {
    let number = |quantity| match quantity {
        DerivedQuantity::Unknown => Value::Null,
        DerivedQuantity::Real(number) => json!(number),
        DerivedQuantity::Count(number) => json!(number),
        DerivedQuantity::Reals(numbers) => json!(numbers),
    };
    let derived = scenario.derived();
    let derived = derived
        .quantities()
        .map(|(name, _, quantity)| (name.to_string(), number(quantity)));
    let check = json!({
        "scenario": path,
        "resolved": scenario.to_toml(),
        "derived": derived.into_iter().collect::<Map<_, _>>(),
        // Whether the event-driven scheme is exact in law, or integrates a user-defined force.
        "class": if scenario.model.force.is_some() { "general" } else { "linear" },
        // CPU seconds of the run on one thread of this machine; null where they could not be
        // estimated.
        "cpu_seconds": cost::measured_cpu_seconds(scenario, scenario.ensemble.paths),
        "warnings": named(&results::named(&scenario.warnings())),
    });
    document("check", check)
}
