//! The report of a trade for programs: one JSON object.

use super::{Asked, INTERVAL, measured};
use crate::cli::document::document;
use serde_json::{Value, json};
use stick_slip::scheme::Kind;
use stick_slip::stats::Statistic;
use stick_slip::study::trade::{LeftOut, Rung, TARGETS, Trade};

/// The report as one JSON object. A number that does not exist is null.
pub fn json(trade: &Trade, asked: &Asked<'_>) -> String {
    let winners = trade.answerable().into_iter().flat_map(|statistic| TARGETS.map(|target| (statistic, target)));
    let left_out = trade.left_out.iter().map(|LeftOut { what, why }| json!({ "what": what, "why": why }));
    let object = json!({
        "scenario": asked.scenario.title,
        "seed": asked.scenario.ensemble.seed,
        "budget_seconds": asked.budget.as_secs_f64(),
        "threads": asked.threads,
        "reference": trade.reference().scheme.to_string(),
        "rungs": trade.rungs.iter().map(|rung| json_rung(trade, rung)).collect::<Vec<_>>(),
        "statistics": measured().map(|statistic| json_statistic(trade, statistic)).collect::<Vec<_>>(),
        "winners": winners.map(|(statistic, target)| json_winner(trade, statistic, target)).collect::<Vec<_>>(),
        "left_out": left_out.collect::<Vec<_>>(),
    });
    document("trade", object)
}

fn json_rung(trade: &Trade, rung: &Rung) -> Value {
    let statistics = measured().map(|statistic| {
        let (estimate, bias) = (rung.estimate(statistic), trade.bias(rung, statistic));
        json!({
            "name": statistic.name(),
            "estimate": estimate.value,
            "standard_error": estimate.error,
            "variance_per_path": rung.variance(statistic),
            "bias": bias.value,
            "bias_low": bias.value - INTERVAL * bias.error,
            "bias_high": bias.value + INTERVAL * bias.error,
        })
    });
    json!({
        "scheme": rung.scheme.name(),
        "step": rung.scheme.step(),
        "tolerance": rung.scheme.tolerance(),
        "paths": rung.paths,
        "diverged_paths": rung.diverged,
        "cpu_seconds_first_path": rung.cost.first,
        "cpu_seconds_per_path": rung.cost.each,
        "statistics": statistics.collect::<Vec<_>>(),
    })
}

fn json_statistic(trade: &Trade, statistic: Statistic) -> Value {
    let standing = trade.standing(statistic);
    let order = |scheme: Kind| {
        let order = trade.law(scheme, statistic)?.order;
        Some(json!({ "scheme": scheme.name(), "order": order.value, "standard_error": order.error }))
    };
    json!({
        "name": statistic.name(),
        "scale": standing.scale(),
        "note": standing.to_string(),
        "orders": trade.schemes().into_iter().filter_map(order).collect::<Vec<_>>(),
    })
}

fn json_winner(trade: &Trade, statistic: Statistic, target: f64) -> Value {
    let winner = trade.best(None, &[statistic], target).ok().map(|choice| choice.scheme.name());
    let prediction = |scheme: Kind| {
        let best = trade.best(Some(scheme), &[statistic], target);
        let choice = best.ok();
        json!({
            "scheme": scheme.name(),
            "step": choice.and_then(|choice| choice.scheme.step()),
            "tolerance": choice.and_then(|choice| choice.scheme.tolerance()),
            "paths": choice.map(|choice| choice.paths),
            "antithetic": choice.map(|choice| choice.is_antithetic),
            "cpu_seconds": choice.map(|choice| choice.seconds),
            "measured": choice.map(|choice| choice.is_measured),
            "reason": best.err().map(|refusal| refusal.to_string()),
        })
    };
    let schemes: Vec<Value> = trade.schemes().into_iter().map(prediction).collect();
    json!({ "statistic": statistic.name(), "target": target, "winner": winner, "schemes": schemes })
}
