//! A trade, for people and for machines: pure functions of what was measured.

use super::numbers::{percent, significant, time, wrapped};
use super::table::{Row, aligned};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;
use stick_slip::scenario::Scenario;
use stick_slip::scheme::Kind;
use stick_slip::stats::Statistic;
use stick_slip::study::trade::{Choice, LeftOut, Refusal, Rung, Standing, TARGETS, Trade};

/// What was asked for.
pub struct Asked<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// Its file.
    pub path: &'a Path,
    /// The statistic that the picture shows.
    pub shown: Option<Statistic>,
    /// The budget of time.
    pub budget: Duration,
    /// Threads that measured.
    pub threads: usize,
}

/// Half the width of a 95 % interval, in standard errors.
const INTERVAL: f64 = 1.96;

/// Between columns, of which there are many.
const GAP: &str = " ";

/// The table for people, no wider than 120 columns.
pub fn table(trade: &Trade, asked: &Asked<'_>) -> String {
    let mut text = format!("{}\n", asked.scenario.title);
    let reference = trade.reference();
    let opening = format!(
        "Costs: CPU on one thread. Biases: percent, with half the 95 % interval, against {} ({} paths); in percent of the \
         standard deviation per path (marked sd) where a value is zero within its error. Each step is half the one before, \
         shown to three digits.",
        reference.scheme, reference.paths
    );
    text.push_str(&wrapped(&opening, ""));
    for scheme in trade.schemes() {
        text.push('\n');
        text.push_str(&scheme_table(trade, scheme));
    }
    text.push('\n');
    text.push_str(&deviations(trade));
    for target in TARGETS {
        text.push('\n');
        text.push_str(&winners(trade, target));
    }
    text.push('\n');
    let legend = "Cheapest run of each scheme: step or tolerance, x paths, CPU time; * the cheapest of all. A step in brackets was not \
                  run: its bias is that of the fitted law. `bias b`: no setting has a smaller bias than b. `bias? b`: the bias is \
                  known only to b, and a larger budget says more. A bias counts with its upper bound (one-sided 95 %).";
    text.push_str(&wrapped(legend, ""));
    text.push_str(&commands(trade, asked));
    text.push('\n');
    for standing in [Standing::Zero, Standing::NoLimit, Standing::Absent] {
        let here = Statistic::ALL.into_iter().filter(|statistic| trade.standing(*statistic) == standing);
        let names: Vec<&str> = here.map(Statistic::name).collect();
        if !names.is_empty() {
            text.push_str(&wrapped(&format!("{}: {standing}", names.join(", ")), "  "));
        }
    }
    for LeftOut { what, why } in &trade.left_out {
        text.push_str(&wrapped(&format!("not run: {what}: {why}"), "  "));
    }
    text
}

/// The runs to make for the statistic that is shown, ready to paste; here with every digit of the
/// step.
fn commands(trade: &Trade, asked: &Asked<'_>) -> String {
    let mut text = String::new();
    for (statistic, target) in asked.shown.iter().flat_map(|s| TARGETS.map(|target| (*s, target))) {
        if let Ok(Choice { scheme, paths, .. }) = trade.best(None, &[statistic], target) {
            let (name, path) = (statistic.name(), asked.path.display());
            let _ = writeln!(text, "{name} to {}: mc run {path} {scheme} --paths {paths}", percent(target));
        }
    }
    text
}

/// Biases of every statistic, one column a step or tolerance.
fn scheme_table(trade: &Trade, scheme: Kind) -> String {
    let rungs: Vec<&Rung> = trade.rungs_of(scheme).collect();
    let knob = if scheme.has_step() { "step" } else { "tolerance" };
    let row = |label: String, cell: &dyn Fn(&Rung) -> String| Row::labelled(label, rungs.iter().map(|rung| cell(rung)));
    let mut rows = vec![
        row(format!("{}, {knob}", scheme.name()), &|rung| short(rung.scheme.parameter())),
        row("us per path".into(), &|rung| significant(rung.cost.each * 1e6, 3)),
        row("paths".into(), &|rung| rung.paths.to_string()),
    ];
    for statistic in trade.answerable() {
        rows.push(row(label(trade, statistic), &|rung| bias(trade, rung, statistic)));
    }
    aligned(&rows, GAP)
}

fn label(trade: &Trade, statistic: Statistic) -> String {
    let mark = if matches!(trade.standing(statistic), Standing::Deviation(_)) { " sd" } else { "" };
    format!("{}{mark}", statistic.name())
}

/// +22.1+-0.2, or `ref`.
fn bias(trade: &Trade, rung: &Rung, statistic: Statistic) -> String {
    if trade.is_reference(rung) {
        return "ref".into();
    }
    let Some(scale) = trade.standing(statistic).scale() else { return "-".into() };
    let bias = trade.bias(rung, statistic);
    let (percent, half) = (100.0 * bias.value / scale, 100.0 * INTERVAL * bias.error / scale);
    if !percent.is_finite() {
        return "none".into();
    }
    let decimals = match percent.abs().max(half) {
        size if size >= 10.0 => 1,
        size if size >= 0.01 => 2,
        _ => return format!("{percent:+.0e}"),
    };
    if half > 0.0 { format!("{percent:+.decimals$}±{half:.decimals$}") } else { format!("{percent:+.decimals$}") }
}

/// Value and standard deviation per path of every statistic, and the observed order of each
/// time-stepping scheme.
fn deviations(trade: &Trade) -> String {
    let reference = trade.reference();
    let mut schemes = trade.schemes();
    schemes.retain(|scheme| scheme.has_step());
    let orders = schemes.iter().map(|scheme| format!("order, {}", scheme.name()));
    let headings = ["reference", "sd per path"].into_iter().map(String::from).chain(orders);
    let mut rows = vec![Row::labelled("statistic", headings)];
    for statistic in trade.answerable() {
        let mut cells = vec![
            significant(reference.estimate(statistic).value, 5),
            significant(reference.variance(statistic).sqrt(), 3),
        ];
        cells.extend(schemes.iter().map(|scheme| match trade.law(*scheme, statistic) {
            Some(law) => format!("{:.2}±{:.2}", law.order.value, law.order.error),
            None => "not resolved".into(),
        }));
        rows.push(Row::labelled(statistic.name(), cells));
    }
    aligned(&rows, GAP)
}

/// Step or tolerance, paths and cost of every scheme for one target, the cheapest marked.
fn winners(trade: &Trade, target: f64) -> String {
    let schemes = trade.schemes();
    let headings = schemes.iter().map(|scheme| scheme.name().to_string());
    let mut rows = vec![Row::labelled(format!("RMSE {}", percent(target)), headings)];
    for statistic in trade.answerable() {
        let winner = trade.best(None, &[statistic], target).ok();
        let cells = schemes.iter().map(|scheme| match trade.best(Some(*scheme), &[statistic], target) {
            Ok(choice) if winner.is_some_and(|w| w.scheme == choice.scheme) => format!("*{}", run(&choice)),
            Ok(choice) => run(&choice),
            Err(Refusal::Bias { least, is_unresolved: true, .. }) => format!("bias? {least:.1e}"),
            Err(Refusal::Bias { least, .. }) => format!("bias {least:.1e}"),
            Err(Refusal::NotRun | Refusal::NoAnswer(_)) => "none".into(),
        });
        rows.push(Row::labelled(label(trade, statistic), cells));
    }
    aligned(&rows, GAP)
}

/// `0.0039 x684 12.3 ms`; a step that was not run is in brackets.
fn run(choice: &Choice) -> String {
    let knob = short(choice.scheme.parameter());
    let knob = if choice.is_measured { knob } else { format!("({knob})") };
    let cost = time(choice.seconds).replace(" min ", "m").replace(" s", "s");
    format!("{knob} x{} {cost}", short(choice.paths as f64))
}

/// Three digits, with an exponent where that is shorter.
fn short(x: f64) -> String {
    let (plain, powers) = (significant(x, 3), format!("{x:.2e}"));
    let powers = powers.replace(".00e", "e").replace("0e", "e");
    if plain.len() <= powers.len() + 1 { plain } else { powers }
}

#[derive(Serialize)]
struct JsonTrade<'a> {
    scenario: &'a str,
    seed: u64,
    budget_seconds: f64,
    threads: usize,
    reference: String,
    rungs: Vec<JsonRung>,
    statistics: Vec<JsonStatistic>,
    winners: Vec<JsonWinner>,
    left_out: Vec<JsonLeftOut<'a>>,
}

#[derive(Serialize)]
struct JsonRung {
    scheme: &'static str,
    step: Option<f64>,
    tolerance: Option<f64>,
    paths: u64,
    diverged_paths: u64,
    cpu_seconds_first_path: f64,
    cpu_seconds_per_path: f64,
    statistics: Vec<JsonBias>,
}

#[derive(Serialize)]
struct JsonBias {
    name: &'static str,
    estimate: f64,
    standard_error: f64,
    variance_per_path: f64,
    bias: f64,
    bias_low: f64,
    bias_high: f64,
}

#[derive(Serialize)]
struct JsonStatistic {
    name: &'static str,
    scale: Option<f64>,
    note: String,
    orders: Vec<JsonOrder>,
}

#[derive(Serialize)]
struct JsonOrder {
    scheme: &'static str,
    order: f64,
    standard_error: f64,
}

#[derive(Serialize)]
struct JsonWinner {
    statistic: &'static str,
    target: f64,
    winner: Option<&'static str>,
    schemes: Vec<JsonPrediction>,
}

#[derive(Serialize)]
struct JsonPrediction {
    scheme: &'static str,
    step: Option<f64>,
    tolerance: Option<f64>,
    paths: Option<u64>,
    cpu_seconds: Option<f64>,
    measured: Option<bool>,
    reason: Option<String>,
}

#[derive(Serialize)]
struct JsonLeftOut<'a> {
    what: &'a str,
    why: &'a str,
}

/// One object; a number that does not exist is null.
pub fn json(trade: &Trade, asked: &Asked<'_>) -> String {
    let object = JsonTrade {
        scenario: &asked.scenario.title,
        seed: asked.scenario.ensemble.seed,
        budget_seconds: asked.budget.as_secs_f64(),
        threads: asked.threads,
        reference: trade.reference().scheme.to_string(),
        rungs: trade.rungs.iter().map(|rung| json_rung(trade, rung)).collect(),
        statistics: Statistic::ALL.map(|statistic| json_statistic(trade, statistic)).into(),
        winners: (trade.answerable().into_iter())
            .flat_map(|statistic| TARGETS.map(|target| json_winner(trade, statistic, target)))
            .collect(),
        left_out: trade.left_out.iter().map(|LeftOut { what, why }| JsonLeftOut { what, why }).collect(),
    };
    // Nothing in it can fail: every key is a string, and non-finite numbers become null.
    serde_json::to_string_pretty(&object).unwrap_or_default() + "\n"
}

fn json_rung(trade: &Trade, rung: &Rung) -> JsonRung {
    JsonRung {
        scheme: rung.scheme.name(),
        step: rung.scheme.step(),
        tolerance: rung.scheme.tolerance(),
        paths: rung.paths,
        diverged_paths: rung.diverged,
        cpu_seconds_first_path: rung.cost.first,
        cpu_seconds_per_path: rung.cost.each,
        statistics: (Statistic::ALL.into_iter())
            .map(|statistic| {
                let (estimate, bias) = (rung.estimate(statistic), trade.bias(rung, statistic));
                JsonBias {
                    name: statistic.name(),
                    estimate: estimate.value,
                    standard_error: estimate.error,
                    variance_per_path: rung.variance(statistic),
                    bias: bias.value,
                    bias_low: bias.value - INTERVAL * bias.error,
                    bias_high: bias.value + INTERVAL * bias.error,
                }
            })
            .collect(),
    }
}

fn json_statistic(trade: &Trade, statistic: Statistic) -> JsonStatistic {
    let standing = trade.standing(statistic);
    let law = |scheme: Kind| trade.law(scheme, statistic).map(|law| (scheme.name(), law.order));
    JsonStatistic {
        name: statistic.name(),
        scale: standing.scale(),
        note: standing.to_string(),
        orders: (trade.schemes().into_iter().filter_map(law))
            .map(|(scheme, order)| JsonOrder { scheme, order: order.value, standard_error: order.error })
            .collect(),
    }
}

fn json_winner(trade: &Trade, statistic: Statistic, target: f64) -> JsonWinner {
    let winner = trade.best(None, &[statistic], target).ok().map(|choice| choice.scheme.name());
    let prediction = |scheme: Kind| {
        let best = trade.best(Some(scheme), &[statistic], target);
        let choice = best.ok();
        JsonPrediction {
            scheme: scheme.name(),
            step: choice.and_then(|choice| choice.scheme.step()),
            tolerance: choice.and_then(|choice| choice.scheme.tolerance()),
            paths: choice.map(|choice| choice.paths),
            cpu_seconds: choice.map(|choice| choice.seconds),
            measured: choice.map(|choice| choice.is_measured),
            reason: best.err().map(|refusal| refusal.to_string()),
        }
    };
    let schemes = trade.schemes().into_iter().map(prediction).collect();
    JsonWinner { statistic: statistic.name(), target, winner, schemes }
}
