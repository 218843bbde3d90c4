//! The report of a trade for programs: one JSON object.

use super::{Asked, INTERVAL};
use crate::cli::document::document;
use serde::Serialize;
use stick_slip::scheme::Kind;
use stick_slip::stats::Statistic;
use stick_slip::study::trade::{LeftOut, Rung, TARGETS, Trade};

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
    antithetic: Option<bool>,
    cpu_seconds: Option<f64>,
    measured: Option<bool>,
    reason: Option<String>,
}

#[derive(Serialize)]
struct JsonLeftOut<'a> {
    what: &'a str,
    why: &'a str,
}

/// The report as one JSON object. A number that does not exist is null.
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
    document("trade", &object)
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
            antithetic: choice.map(|choice| choice.is_antithetic),
            cpu_seconds: choice.map(|choice| choice.seconds),
            measured: choice.map(|choice| choice.is_measured),
            reason: best.err().map(|refusal| refusal.to_string()),
        }
    };
    let schemes = trade.schemes().into_iter().map(prediction).collect();
    JsonWinner { statistic: statistic.name(), target, winner, schemes }
}
