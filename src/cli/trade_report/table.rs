//! The report of a trade for people: tables of costs, biases, orders of convergence, and the
//! cheapest runs.

use super::{AskedPrices, INTERVAL, without_answer};
use crate::cli::accuracy::pairs;
use crate::cli::numbers::{percent, significant, time, wrapped};
use crate::cli::table::{TableRow, aligned};
use std::fmt::Write as _;
use stick_slip::scheme::Kind;
use stick_slip::stats::Statistic;
use stick_slip::study::trade::{Choice, LeftOut, Pairing, Refusal, Rung, Standing, TARGETS, Trade};

/// The space between two columns. It is narrow because there are many columns.
const GAP: &str = " ";

/// The report as text, at most 120 columns wide.
pub fn table(trade: &Trade, asked: &AskedPrices<'_>) -> String {
    let reference = trade.reference();
    let opening = format!(
        "Costs: CPU on one thread. Biases: percent, with half the 95 % interval, against {} ({} paths); in percent of the \
         standard deviation per path (marked sd) where a value is zero within its error. Each step is half the one before, \
         shown to three digits.",
        reference.scheme, reference.paths
    );
    let legend = "Cheapest run of each scheme: step or tolerance, x paths, CPU time; * the cheapest of all. A step in brackets was not \
                  run: its bias is that of the fitted law. Paths marked p are antithetic pairs (`--set \
                  ensemble.antithetic=true`). `bias b`: no setting has a smaller bias than b. `bias? b`: the bias is \
                  known only to b, and a larger budget says more. A bias counts with its upper bound (one-sided 95 %).";
    let without = without_answer(trade).into_iter().map(|(names, reason)| format!("{names}: {reason}"));
    let left_out = trade.left_out.iter().map(|LeftOut { what, why }| format!("not run: {what}: {why}"));
    let mut parts = vec![format!("{}\n{}", asked.scenario.title, wrapped(&opening, ""))];
    parts.extend(trade.schemes().into_iter().map(|scheme| scheme_table(trade, scheme)));
    parts.push(deviations(trade));
    parts.extend(TARGETS.map(|target| winners(trade, target)));
    parts.push(wrapped(legend, "") + &commands(trade, asked));
    parts.push(without.chain(left_out).map(|line| wrapped(&line, "  ")).collect());
    parts.join("\n")
}

/// The commands of the cheapest runs for the statistic that is shown, ready to paste. They have
/// every digit of the step, unlike the table.
fn commands(trade: &Trade, asked: &AskedPrices<'_>) -> String {
    let mut text = String::new();
    for (statistic, target) in asked.shown.iter().flat_map(|s| TARGETS.map(|target| (*s, target))) {
        if let Ok(choice @ Choice { scheme, paths, .. }) = trade.best(None, &[statistic], target) {
            let (name, path) = (statistic.name(), asked.path.display());
            let _ = writeln!(
                text,
                "{name} to {}: mc run {path} {scheme} --paths {paths}{}",
                percent(target),
                pairs(&choice)
            );
        }
    }
    text
}

/// The bias of every statistic, with one column for each step or tolerance.
fn scheme_table(trade: &Trade, scheme: Kind) -> String {
    let rungs: Vec<&Rung> = trade.rungs_of(scheme).collect();
    let knob = if scheme.has_step() { "step" } else { "tolerance" };
    let row =
        |label: String, cell: &dyn Fn(&Rung) -> String| TableRow::labelled(label, rungs.iter().map(|rung| cell(rung)));
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

/// The bias with its uncertainty in percent, e.g. `+22.1±0.2`, or `ref` for the reference run.
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

/// For every statistic: its value, its standard deviation per path, the variance from antithetic
/// pairs divided by that from as many independent paths, and the observed order of each
/// time-stepping scheme.
fn deviations(trade: &Trade) -> String {
    let reference = trade.reference();
    let mut schemes = trade.schemes();
    schemes.retain(|scheme| scheme.has_step());
    let orders = schemes.iter().map(|scheme| format!("order, {}", scheme.name()));
    let paired = matches!(trade.pairing, Pairing::Measured(_)).then(|| String::from("pairs"));
    let headings = ["reference", "sd per path"].into_iter().map(String::from).chain(paired).chain(orders);
    let mut rows = vec![TableRow::labelled("statistic", headings)];
    for statistic in trade.answerable() {
        let mut cells = vec![
            significant(reference.estimate(statistic).value, 5),
            significant(reference.variance(statistic).sqrt(), 3),
        ];
        cells.extend(trade.pairing.ratio(statistic).map(|ratio| significant(ratio, 2)));
        cells.extend(schemes.iter().map(|scheme| match trade.law(*scheme, statistic) {
            Some(law) => format!("{:.2}±{:.2}", law.order.value, law.order.error),
            None => "not resolved".into(),
        }));
        rows.push(TableRow::labelled(statistic.name(), cells));
    }
    aligned(&rows, GAP)
}

/// Step or tolerance, paths and cost of every scheme for one target. The cheapest is marked.
fn winners(trade: &Trade, target: f64) -> String {
    let schemes = trade.schemes();
    let headings = schemes.iter().map(|scheme| scheme.name().to_string());
    let mut rows = vec![TableRow::labelled(format!("RMSE {}", percent(target)), headings)];
    for statistic in trade.answerable() {
        let winner = trade.best(None, &[statistic], target).ok();
        let cells = schemes.iter().map(|scheme| match trade.best(Some(*scheme), &[statistic], target) {
            Ok(choice) if winner.is_some_and(|w| w.scheme == choice.scheme) => format!("*{}", run(&choice)),
            Ok(choice) => run(&choice),
            Err(Refusal::Bias { least, is_unresolved: true, .. }) => format!("bias? {least:.1e}"),
            Err(Refusal::Bias { least, .. }) => format!("bias {least:.1e}"),
            Err(Refusal::NotRun | Refusal::NoAnswer(_)) => "none".into(),
        });
        rows.push(TableRow::labelled(label(trade, statistic), cells));
    }
    aligned(&rows, GAP)
}

/// One cell, e.g. `0.0039 x684 12.3 ms`. A step that was not run is in brackets, and `p` marks
/// antithetic pairs.
fn run(choice: &Choice) -> String {
    let knob = short(choice.scheme.parameter());
    let knob = if choice.is_measured { knob } else { format!("({knob})") };
    let cost = time(choice.seconds).replace(" min ", "m").replace(" s", "s");
    let pairs = if choice.is_antithetic { "p" } else { "" };
    format!("{knob} x{}{pairs} {cost}", short(choice.paths as f64))
}

/// Three significant digits, with an exponent where that is shorter.
fn short(x: f64) -> String {
    let (plain, powers) = (significant(x, 3), format!("{x:.2e}"));
    let powers = powers.replace(".00e", "e").replace("0e", "e");
    if plain.len() <= powers.len() + 1 { plain } else { powers }
}
