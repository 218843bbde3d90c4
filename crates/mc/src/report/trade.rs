//! The report of a trade: tables of costs, biases, orders of convergence, and the cheapest runs.

use super::{Cell, Column, INTERVAL, Report, Row, ShownStatistics, Table};
use crate::arguments::accuracy::pairs;
use crate::output::numbers::{grouped, percent, significant, time};
use std::path::Path;
use stickslip::scheme::Kind;
use stickslip::stats::{Record, Statistic};
use stickslip::study::trade::{
    Choice, LeftOut, Pairing, Refusal, Standing, TARGETS, Trade, TradeSetting,
};

/// The statistics that a trade measures: those that need no key of the scenario.
fn measured() -> impl Iterator<Item = Statistic> {
    Statistic::asked_by(&Record::NOTHING).into_iter()
}

/// The names of the statistics for which no accuracy can be requested, grouped by reason.
pub fn without_answer(trade: &Trade) -> Vec<(String, Standing)> {
    let reasons = [Standing::Zero, Standing::NoLimit, Standing::Absent].into_iter();
    let named = reasons.map(|reason| {
        let here = measured().filter(|statistic| trade.standing(*statistic) == reason);
        (
            here.map(Statistic::name).collect::<Vec<_>>().join(", "),
            reason,
        )
    });
    named.filter(|(names, _)| !names.is_empty()).collect()
}

/// The report of all that was measured, with the commands for this scenario file and statistic.
pub fn trade(title: &str, trade: &Trade, shown: Option<(&Path, Statistic)>) -> Report {
    let reference = trade.reference();
    let legend = "Cheapest run of each scheme: step or tolerance, x paths, CPU time; * marks the cheapest of \
                  all. A step in brackets was not run: its bias is from the fitted law. Paths marked p are \
                  antithetic pairs (`--set ensemble.antithetic=true`). `bias b`: no setting has a bias below \
                  b. `bias? b`: the bias is known only to b; use a larger budget. Biases enter by their \
                  upper bound (one-sided 95 %).";
    let without = without_answer(trade)
        .into_iter()
        .map(|(names, reason)| ("none", format!("{names}: {reason}")));
    let left_out = trade
        .left_out
        .iter()
        .map(|LeftOut { what, why }| ("not run", format!("{what}: {why}")));
    let mut tables: Vec<Table> = trade
        .schemes()
        .into_iter()
        .map(|scheme| of_scheme(trade, scheme))
        .collect();
    tables.push(deviations(trade));
    tables.extend(TARGETS.map(|target| winners(trade, target)));
    tables.push(Table {
        below: legend.into(),
        ..Table::default()
    });
    Report {
        title: title.to_string(),
        about: format!(
            "Costs: CPU on one thread. Biases: percent, with half the 95 % interval, against {} ({} paths); \
             in percent of the standard deviation per path (marked sd) if a value is zero within its error. \
             Each step is half the previous one, shown to three digits.",
            reference.scheme, reference.paths
        ),
        tables,
        commands: shown.map_or_else(Vec::new, |(path, statistic)| {
            commands(trade, path, statistic)
        }),
        remarks: without.chain(left_out).collect(),
    }
}

/// The report of the cheapest run for each of these statistics, or of all, and each target.
pub fn costs(title: &str, trade: &Trade, chosen: ShownStatistics) -> Report {
    let answerable = trade.answerable();
    let statistics = chosen.of(&answerable, &answerable);
    let row = |(statistic, target): (Statistic, f64)| {
        let cells = match trade.best(None, &[statistic], target) {
            Ok(Choice {
                scheme,
                paths,
                is_antithetic,
                seconds,
                ..
            }) => {
                let pairs = if is_antithetic { " p" } else { "" };
                let paths_cell = Cell::number(paths as f64, format!("{}{pairs}", grouped(paths)));
                let parameter = Cell::significant(scheme.parameter(), 3);
                [
                    scheme.name().into(),
                    parameter,
                    paths_cell,
                    Cell::number(seconds, time(seconds)),
                ]
            }
            Err(_) => ["none", "", "", ""].map(Cell::from),
        };
        Row::of(
            statistic.name(),
            [Cell::number(target, percent(target))]
                .into_iter()
                .chain(cells),
        )
    };
    let rows = statistics
        .iter()
        .flat_map(|statistic| TARGETS.map(|target| row((*statistic, target))))
        .collect();
    let columns = super::columns([
        ("statistic", "statistic"),
        ("error", "error"),
        ("scheme", "scheme"),
        ("parameter", "step or tolerance"),
        ("paths", "paths"),
        ("seconds", "CPU time"),
    ]);
    let below = "The cheapest run for this root mean square error; CPU time on one thread. Paths marked p are \
                 antithetic pairs. `none`: no measured or predicted run reaches it.";
    let table = Table {
        heading: "Cheapest runs".into(),
        columns: columns.to_vec(),
        rows,
        below: below.into(),
        ..Table::default()
    };
    Report {
        title: title.into(),
        about: "cost of accuracy".into(),
        tables: vec![table],
        ..Report::default()
    }
}

/// A table with a column for each of these headings.
fn table(headings: impl IntoIterator<Item = impl Into<String>>, rows: Vec<Row>) -> Table {
    let columns = headings
        .into_iter()
        .map(Into::into)
        .map(|heading: String| Column::of(heading.clone(), heading));
    Table {
        columns: columns.collect(),
        rows,
        ..Table::default()
    }
}

/// The commands of the cheapest runs for the statistic that is shown, ready to paste. They have
/// every digit of the step, unlike the table.
fn commands(trade: &Trade, path: &Path, statistic: Statistic) -> Vec<String> {
    let command = |target: f64| {
        let choice @ Choice { scheme, paths, .. } = trade.best(None, &[statistic], target).ok()?;
        let (name, path, target) = (statistic.name(), path.display(), percent(target));
        Some(format!(
            "{name} to {target}: mc run {path} {scheme} --paths {paths}{}",
            pairs(&choice)
        ))
    };
    TARGETS.into_iter().filter_map(command).collect()
}

/// The bias of every statistic, with one column for each step or tolerance.
fn of_scheme(trade: &Trade, scheme: Kind) -> Table {
    let settings: Vec<&TradeSetting> = trade.rungs_of(scheme).collect();
    let knob = if scheme.has_step() {
        "step"
    } else {
        "tolerance"
    };
    let row = |label: String, cell: &dyn Fn(&TradeSetting) -> String| {
        Row::of(label, settings.iter().map(|setting| cell(setting)))
    };
    let mut rows = vec![
        row("us per path".into(), &|setting| {
            significant(setting.cost.each * 1e6, 3)
        }),
        row("paths".into(), &|setting| setting.paths.to_string()),
    ];
    let of_statistic = |statistic| {
        row(label(trade, statistic), &|setting| {
            bias(trade, setting, statistic)
        })
    };
    rows.extend(trade.answerable().into_iter().map(of_statistic));
    let headings = settings
        .iter()
        .map(|setting| short(setting.scheme.parameter()));
    table(
        std::iter::once(format!("{}, {knob}", scheme.name())).chain(headings),
        rows,
    )
}

fn label(trade: &Trade, statistic: Statistic) -> String {
    let mark = if matches!(trade.standing(statistic), Standing::Deviation(_)) {
        " sd"
    } else {
        ""
    };
    format!("{}{mark}", statistic.name())
}

/// The bias with its uncertainty in percent, e.g. `+22.1±0.2`, or `ref` for the reference run.
fn bias(trade: &Trade, setting: &TradeSetting, statistic: Statistic) -> String {
    if trade.is_reference(setting) {
        return "ref".into();
    }
    let Some(scale) = trade.standing(statistic).scale() else {
        return "-".into();
    };
    let bias = trade.bias(setting, statistic);
    let (percent, half) = (
        100.0 * bias.value / scale,
        100.0 * INTERVAL * bias.error / scale,
    );
    if !percent.is_finite() {
        return "none".into();
    }
    let decimals = match percent.abs().max(half) {
        size if size >= 10.0 => 1,
        size if size >= 0.01 => 2,
        _ => return format!("{percent:+.0e}"),
    };
    if half > 0.0 {
        format!("{percent:+.decimals$}±{half:.decimals$}")
    } else {
        format!("{percent:+.decimals$}")
    }
}

/// For every statistic: its value, its standard deviation per path, the variance from antithetic
/// pairs divided by that from the same number of independent paths, and the observed order of each
/// time-stepping scheme.
fn deviations(trade: &Trade) -> Table {
    let reference = trade.reference();
    let mut schemes = trade.schemes();
    schemes.retain(|scheme| scheme.has_step());
    let orders = schemes
        .iter()
        .map(|scheme| format!("order, {}", scheme.name()));
    let paired = matches!(trade.pairing, Pairing::Measured(_)).then(|| String::from("pairs"));
    let headings = ["statistic", "reference", "sd per path"]
        .into_iter()
        .map(String::from)
        .chain(paired)
        .chain(orders);
    let row = |statistic: Statistic| {
        let mut cells = vec![
            significant(reference.estimate(statistic).value, 5),
            significant(reference.variance(statistic).sqrt(), 3),
        ];
        cells.extend(
            trade
                .pairing
                .ratio(statistic)
                .map(|ratio| significant(ratio, 2)),
        );
        cells.extend(
            schemes
                .iter()
                .map(|scheme| match trade.law(*scheme, statistic) {
                    Some(law) => format!("{:.2}±{:.2}", law.order.value, law.order.error),
                    None => "not resolved".into(),
                }),
        );
        Row::of(statistic.name(), cells)
    };
    table(headings, trade.answerable().into_iter().map(row).collect())
}

/// Step or tolerance, paths and cost of every scheme for one target. The cheapest is marked.
fn winners(trade: &Trade, target: f64) -> Table {
    let schemes = trade.schemes();
    let row = |statistic: Statistic| {
        let winner = trade.best(None, &[statistic], target).ok();
        let cells =
            schemes.iter().map(
                |scheme| match trade.best(Some(*scheme), &[statistic], target) {
                    Ok(choice) if winner.is_some_and(|w| w.scheme == choice.scheme) => {
                        format!("*{}", run(&choice))
                    }
                    Ok(choice) => run(&choice),
                    Err(Refusal::Bias {
                        least,
                        is_unresolved: true,
                        ..
                    }) => format!("bias? {least:.1e}"),
                    Err(Refusal::Bias { least, .. }) => format!("bias {least:.1e}"),
                    Err(Refusal::NotRun | Refusal::NoAnswer(_)) => "none".into(),
                },
            );
        Row::of(label(trade, statistic), cells)
    };
    let headings = schemes.iter().map(|scheme| scheme.name().to_string());
    let rows = trade.answerable().into_iter().map(row).collect();
    table(
        std::iter::once(format!("RMSE {}", percent(target))).chain(headings),
        rows,
    )
}

/// One cell, e.g. `0.0039 x684 12.3 ms`. A step that was not run is in brackets, and `p` marks
/// antithetic pairs.
fn run(choice: &Choice) -> String {
    let knob = short(choice.scheme.parameter());
    let knob = if choice.is_measured {
        knob
    } else {
        format!("({knob})")
    };
    let cost = time(choice.seconds)
        .replace(" min ", "m")
        .replace(" s", "s");
    let pairs = if choice.is_antithetic { "p" } else { "" };
    format!("{knob} x{}{pairs} {cost}", short(choice.paths as f64))
}

/// Three significant digits, with an exponent where that is shorter.
fn short(x: f64) -> String {
    let (plain, powers) = (significant(x, 3), format!("{x:.2e}"));
    let powers = powers.replace(".00e", "e").replace("0e", "e");
    if plain.len() <= powers.len() + 1 {
        plain
    } else {
        powers
    }
}
