//! A trade as a data set: what was measured for every rung, and what was predicted for every
//! target.

use super::header::CONVENTIONS;
use super::layout::{self, Unit, Variable, variable};
use super::summary::write_statistics;
use super::{Destination, Source, read_attribute, read_or_empty, read_variable, series, texts};
use crate::provenance::Provenance;
use crate::scenario::Scenario;
use crate::scheme::{Kind, Scheme};
use crate::stats::{Estimate, Statistic};
use crate::study::trade::{Choice, Cost, Number, Pairing, Prices, Rung, TARGETS, Trade};

/// The attribute `format_name` of a trade.
pub(crate) const TRADE_FORMAT_NAME: &str = "stick-slip trade";

/// Write a trade.
pub(crate) fn write<D: Destination>(to: &mut D, header: &Provenance, trade: &Trade) -> Result<(), D::Error> {
    attributes(to, header, trade)?;
    if let Some(samples) = &header.series {
        series::write(to, samples, header.series_start.as_deref())?;
    }
    coordinates(to, trade)?;
    measured(to, trade)?;
    orders(to, trade)?;
    predicted(to, trade)
}

fn attributes<D: Destination>(to: &mut D, header: &Provenance, trade: &Trade) -> Result<(), D::Error> {
    to.set_attribute("Conventions", CONVENTIONS)?;
    to.set_attribute("title", header.title.as_str())?;
    to.set_attribute("format_name", TRADE_FORMAT_NAME)?;
    to.set_attribute("format_version", "1.1")?;
    to.set_attribute("program_version", header.program_version.as_str())?;
    to.set_attribute("git_hash", header.git_hash.as_str())?;
    to.set_attribute("seed", header.seed)?;
    to.set_attribute("generator", header.generator.as_str())?;
    to.set_attribute("reference", trade.reference().scheme.to_string())?;
    to.set_attribute("scenario", header.scenario_text.as_str())
}

fn coordinates<D: Destination>(to: &mut D, trade: &Trade) -> Result<(), D::Error> {
    let numbers: Vec<u32> = (0..).take(trade.rungs.len()).collect();
    write_statistics(to)?;
    to.write_variable(&RUNG, &numbers)?;
    to.write_variable(&SCHEME, &texts(trade.schemes().into_iter().map(|scheme| scheme.name())))?;
    to.write_variable(&TARGET, &TARGETS)
}

fn measured<D: Destination>(to: &mut D, trade: &Trade) -> Result<(), D::Error> {
    let of = |value: &dyn Fn(&Rung) -> f64| -> Vec<f64> { trade.rungs.iter().map(value).collect() };
    let whole = |value: &dyn Fn(&Rung) -> u64| -> Vec<u64> { trade.rungs.iter().map(value).collect() };
    to.write_variable(&RUNG_SCHEME, &texts(trade.rungs.iter().map(|rung| rung.scheme.name())))?;
    to.write_variable(&RUNG_STEP, &of(&|rung| rung.scheme.step().unwrap_or(f64::NAN)))?;
    to.write_variable(&RUNG_TOLERANCE, &of(&|rung| rung.scheme.tolerance().unwrap_or(f64::NAN)))?;
    to.write_variable(&RUNG_PATHS, &whole(&|rung| rung.paths))?;
    to.write_variable(&RUNG_DIVERGED, &whole(&|rung| rung.diverged))?;
    to.write_variable(&RUNG_SECONDS_FIRST, &of(&|rung| rung.cost.first))?;
    to.write_variable(&RUNG_SECONDS, &of(&|rung| rung.cost.each))?;
    let each = |value: &dyn Fn(&Rung, Statistic) -> f64| -> Vec<f64> {
        trade.rungs.iter().flat_map(|rung| Statistic::ALL.map(|statistic| value(rung, statistic))).collect()
    };
    let change =
        |rung: &Rung, s: Statistic| rung.change(s).map_or([f64::NAN; 2], |change| [change.value, change.error]);
    to.write_variable(&RUNG_ESTIMATE, &each(&|rung, s| rung.estimate(s).value))?;
    to.write_variable(&RUNG_STANDARD_ERROR, &each(&|rung, s| rung.estimate(s).error))?;
    to.write_variable(&RUNG_VARIANCE, &each(&|rung, s| rung.variance(s)))?;
    to.write_variable(&RUNG_BIAS, &each(&|rung, s| trade.bias(rung, s).value))?;
    to.write_variable(&RUNG_BIAS_ERROR, &each(&|rung, s| trade.bias(rung, s).error))?;
    to.write_variable(&RUNG_CHANGE, &each(&|rung, s| change(rung, s)[0]))?;
    to.write_variable(&RUNG_CHANGE_ERROR, &each(&|rung, s| change(rung, s)[1]))
}

fn orders<D: Destination>(to: &mut D, trade: &Trade) -> Result<(), D::Error> {
    let orders: Vec<[f64; 2]> = (trade.schemes().into_iter())
        .flat_map(|scheme| Statistic::ALL.map(|statistic| trade.law(scheme, statistic)))
        .map(|law| law.map_or([f64::NAN; 2], |law| [law.order.value, law.order.error]))
        .collect();
    let scales = Statistic::ALL.map(|statistic| trade.standing(statistic).scale().unwrap_or(f64::NAN));
    let notes = Statistic::ALL.map(|statistic| trade.standing(statistic).to_string());
    to.write_variable(&STATISTIC_SCALE, &scales)?;
    to.write_variable(&STATISTIC_NOTE, &texts(notes.iter().map(String::as_str)))?;
    let ratios = Statistic::ALL.map(|statistic| trade.pairing.ratio(statistic).unwrap_or(f64::NAN));
    to.write_variable(&STATISTIC_PAIRING, &ratios)?;
    to.write_variable(&SCHEME_ORDER, &orders.iter().map(|order| order[0]).collect::<Vec<_>>())?;
    to.write_variable(&SCHEME_ORDER_ERROR, &orders.iter().map(|order| order[1]).collect::<Vec<_>>())
}

fn predicted<D: Destination>(to: &mut D, trade: &Trade) -> Result<(), D::Error> {
    let mut choices: Vec<Option<Choice>> = Vec::new();
    for scheme in trade.schemes() {
        for statistic in Statistic::ALL {
            choices.extend(TARGETS.map(|target| trade.best(Some(scheme), &[statistic], target).ok()));
        }
    }
    let of = |value: &dyn Fn(&Choice) -> f64| -> Vec<f64> {
        choices.iter().map(|choice| choice.as_ref().map_or(f64::NAN, value)).collect()
    };
    to.write_variable(&PREDICTED_SECONDS, &of(&|choice| choice.seconds))?;
    to.write_variable(&PREDICTED_PATHS, &of(&|choice| choice.paths as f64))?;
    let is_antithetic = |choice: &Option<Choice>| i8::from(choice.is_some_and(|choice| choice.is_antithetic));
    to.write_variable(&PREDICTED_ANTITHETIC, &choices.iter().map(is_antithetic).collect::<Vec<i8>>())?;
    to.write_variable(&PREDICTED_STEP, &of(&|choice| choice.scheme.step().unwrap_or(f64::NAN)))?;
    to.write_variable(&PREDICTED_TOLERANCE, &of(&|choice| choice.scheme.tolerance().unwrap_or(f64::NAN)))?;
    to.write_variable(&PREDICTED_BIAS, &of(&|choice| choice.bias))?;
    let winner = |statistic, target| match trade.best(None, &[statistic], target) {
        Ok(choice) => choice.scheme.name(),
        Err(_) => "none",
    };
    let winners = Statistic::ALL.into_iter().flat_map(|s| TARGETS.map(|target| winner(s, target)));
    to.write_variable(&WINNER, &texts(winners))
}

/// Read the measurements of a trade of this scenario back. What follows from them is computed again
/// and not read.
pub(crate) fn read<S: Source>(from: &S, scenario: &Scenario) -> Result<Trade, S::Error> {
    let rungs = read_rungs(from)?;
    let reference: String = read_attribute(from, "reference")?;
    let reference = rungs.iter().position(|rung| rung.scheme.to_string() == reference);
    let reference = reference.ok_or_else(|| "reference is none of its rungs".to_string())?;
    let ratios: Vec<f64> =
        if from.has(STATISTIC_PAIRING.name) { read_or_empty(from, &STATISTIC_PAIRING)? } else { Vec::new() };
    let pairing = match ratios.iter().all(|ratio| ratio.is_nan()) {
        _ if scenario.ensemble.antithetic => Pairing::Asked,
        true => Pairing::Unknown,
        false => Pairing::Measured(ratios),
    };
    Trade::of_rungs(scenario, rungs, reference, pairing).map_err(|misfit| misfit.to_string().into())
}

fn read_rungs<S: Source>(from: &S) -> Result<Vec<Rung>, S::Error> {
    let names: Vec<String> = read_variable(from, &RUNG_SCHEME)?;
    let column = |variable: &Variable, width: usize| match read_or_empty::<S, f64>(from, variable)? {
        values if values.len() == names.len() * width => Ok(values),
        _ => Err(S::Error::from(format!("{} has another size", variable.name))),
    };
    let all = Statistic::ALL.len();
    let (steps, tolerances) = (column(&RUNG_STEP, 1)?, column(&RUNG_TOLERANCE, 1)?);
    let (first, each) = (column(&RUNG_SECONDS_FIRST, 1)?, column(&RUNG_SECONDS, 1)?);
    let (estimates, errors) = (column(&RUNG_ESTIMATE, all)?, column(&RUNG_STANDARD_ERROR, all)?);
    let (changes, change_errors) = (column(&RUNG_CHANGE, all)?, column(&RUNG_CHANGE_ERROR, all)?);
    let whole = |variable: &Variable| -> Result<Vec<u64>, S::Error> { read_variable(from, variable) };
    let (paths, diverged) = (whole(&RUNG_PATHS)?, whole(&RUNG_DIVERGED)?);
    let rung = |(i, name): (usize, &String)| -> Result<Rung, S::Error> {
        let kind = Kind::from_name(name).ok_or_else(|| format!("unknown scheme \"{name}\""))?;
        let at = |values: &[f64], statistic: Statistic| values[i * all + statistic.index()];
        let estimate = |statistic| Estimate {
            statistic,
            estimate: at(&estimates, statistic),
            standard_error: at(&errors, statistic),
            low: f64::NAN,
            high: f64::NAN,
            bias: None,
        };
        let change = |statistic| Number { value: at(&changes, statistic), error: at(&change_errors, statistic) };
        let changes = Statistic::ALL.map(change);
        let is_measured = changes.iter().any(|change| !change.value.is_nan());
        Ok(Rung {
            scheme: kind.with(if kind.has_step() { steps[i] } else { tolerances[i] }),
            paths: paths[i],
            diverged: diverged[i].min(paths[i]),
            cost: Cost { first: first[i], each: each[i] },
            estimates: Statistic::ALL.map(estimate),
            changes: if is_measured { changes.to_vec() } else { Vec::new() },
        })
    };
    names.iter().enumerate().map(rung).collect()
}

/// The prices of accuracy in a trade, for each statistic.
pub(crate) fn read_prices<S: Source>(from: &S) -> Result<Vec<Prices>, S::Error> {
    let title: String = read_attribute(from, "title")?;
    let schemes: Vec<String> = read_or_empty(from, &SCHEME)?;
    let statistics: Vec<String> = read_or_empty(from, &layout::STATISTIC)?;
    let targets: Vec<f64> = read_or_empty(from, &TARGET)?;
    let seconds: Vec<f64> = read_or_empty(from, &PREDICTED_SECONDS)?;
    if seconds.len() != schemes.len() * statistics.len() * targets.len() {
        return Err(format!("{} has {} values", PREDICTED_SECONDS.name, seconds.len()).into());
    }
    let curve = |(i, scheme): (usize, &String), j: usize| {
        let first = (i * statistics.len() + j) * targets.len();
        let points = seconds[first..].iter().zip(&targets).map(|(seconds, target)| [*seconds, *target]);
        Some((Kind::from_name(scheme)?, points.filter(|[seconds, _]| seconds.is_finite()).collect()))
    };
    let of = |(j, name): (usize, &String)| {
        let curves = schemes.iter().enumerate().filter_map(|scheme| curve(scheme, j)).collect();
        Some(Prices { title: title.clone(), statistic: Statistic::from_name(name)?, curves })
    };
    Ok(statistics.iter().enumerate().filter_map(of).collect())
}

/// The cheapest run for one statistic and one target.
#[derive(Clone, Debug, PartialEq)]
pub struct Cheapest {
    /// The statistic.
    pub statistic: Statistic,
    /// The target: the relative root mean square error of the statistic.
    pub target: f64,
    /// The cheapest run; none if no run reaches the target.
    pub run: Option<CheapestRun>,
}

/// A run that was predicted to reach a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheapestRun {
    /// The scheme of the run, with its step or tolerance.
    pub scheme: Scheme,
    /// Number of paths.
    pub paths: u64,
    /// Whether the paths are antithetic pairs.
    pub is_antithetic: bool,
    /// CPU time on one thread, in seconds.
    pub seconds: f64,
}

/// The title and the resolved scenario of a trade.
pub(crate) fn read_origin<S: Source>(from: &S) -> Result<(String, String), S::Error> {
    Ok((read_attribute(from, "title")?, read_attribute(from, "scenario")?))
}

/// The cheapest runs for each statistic and each target.
pub(crate) fn read_cheapest<S: Source>(from: &S) -> Result<Vec<Cheapest>, S::Error> {
    let schemes: Vec<String> = read_or_empty(from, &SCHEME)?;
    let statistics: Vec<String> = read_or_empty(from, &layout::STATISTIC)?;
    let targets: Vec<f64> = read_or_empty(from, &TARGET)?;
    let winners: Vec<String> = read_or_empty(from, &WINNER)?;
    let [seconds, paths, steps, tolerances] =
        [&PREDICTED_SECONDS, &PREDICTED_PATHS, &PREDICTED_STEP, &PREDICTED_TOLERANCE].map(|v| read_or_empty(from, v));
    let (seconds, paths, steps, tolerances): (Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>) =
        (seconds?, paths?, steps?, tolerances?);
    let pairs: Vec<i8> = read_or_empty(from, &PREDICTED_ANTITHETIC)?;
    let cells = schemes.len() * statistics.len() * targets.len();
    let lengths = [seconds.len(), paths.len(), steps.len(), tolerances.len(), pairs.len()];
    if lengths.iter().any(|length| *length != cells) || winners.len() != statistics.len() * targets.len() {
        return Err("the variables of its predictions differ in length".to_string().into());
    }
    let run = |name: &str, cell: usize| {
        let i = schemes.iter().position(|scheme| scheme == name)?;
        let at = i * winners.len() + cell;
        let kind = Kind::from_name(name)?;
        let parameter = if kind.has_step() { steps[at] } else { tolerances[at] };
        let (scheme, paths) = (kind.with(parameter), paths[at] as u64);
        Some(CheapestRun { scheme, paths, is_antithetic: pairs[at] != 0, seconds: seconds[at] })
    };
    let each = winners.iter().enumerate().filter_map(|(cell, name)| {
        let statistic = Statistic::from_name(&statistics[cell / targets.len()])?;
        Some(Cheapest { statistic, target: targets[cell % targets.len()], run: run(name, cell) })
    });
    Ok(each.collect())
}

const PER_RUNG: &[(&str, &str)] = &[("coordinates", "rung_scheme rung_step rung_tolerance")];

const RUNG: Variable =
    variable("rung", &["rung"], Unit::ONE, "number of the rung: scheme by scheme, from coarse to fine");
const SCHEME: Variable = variable("scheme", &["scheme"], Unit::None, "name of the scheme");
const TARGET: Variable = variable("target", &["target"], Unit::ONE, "root mean square error asked for, relative");
const RUNG_SCHEME: Variable = variable("rung_scheme", &["rung"], Unit::None, "scheme of the rung");
const RUNG_STEP: Variable = variable("rung_step", &["rung"], Unit::TIME, "time step, missing where there is none");
const RUNG_TOLERANCE: Variable =
    variable("rung_tolerance", &["rung"], Unit::ONE, "tolerance, missing where there is none");
const RUNG_PATHS: Variable = variable("rung_paths", &["rung"], Unit::ONE, "paths simulated").with(PER_RUNG);
const RUNG_DIVERGED: Variable = variable("rung_diverged", &["rung"], Unit::ONE, "paths that diverged").with(PER_RUNG);
const RUNG_SECONDS_FIRST: Variable =
    variable("rung_seconds_first", &["rung"], Unit::Seconds, "CPU time of a run of one path").with(PER_RUNG);
const RUNG_SECONDS: Variable =
    variable("rung_seconds", &["rung"], Unit::Seconds, "CPU time per path of a large run").with(PER_RUNG);

const BOTH: &[&str] = &["rung", "statistic"];
const RUNG_ESTIMATE: Variable = variable("rung_estimate", BOTH, Unit::None, "estimate").with(PER_RUNG);
const RUNG_STANDARD_ERROR: Variable =
    variable("rung_standard_error", BOTH, Unit::None, "standard error of the estimate").with(PER_RUNG);
const RUNG_VARIANCE: Variable =
    variable("rung_path_variance", BOTH, Unit::None, "variance per path, in the unit of the statistic squared")
        .with(PER_RUNG);
const RUNG_BIAS: Variable = variable("rung_bias", BOTH, Unit::None, "difference from the reference").with(PER_RUNG);
const RUNG_BIAS_ERROR: Variable =
    variable("rung_bias_error", BOTH, Unit::None, "standard error of that difference").with(PER_RUNG);
const RUNG_CHANGE: Variable = variable(
    "rung_change",
    BOTH,
    Unit::None,
    "estimate minus that at half the step, on the same \
              noise",
)
.with(PER_RUNG);
const RUNG_CHANGE_ERROR: Variable =
    variable("rung_change_error", BOTH, Unit::None, "standard error of that change").with(PER_RUNG);

const STATISTIC_SCALE: Variable =
    variable("statistic_scale", &["statistic"], Unit::None, "what errors of the statistic are relative to");
const STATISTIC_NOTE: Variable =
    variable("statistic_note", &["statistic"], Unit::None, "what that is, or why there is none");
const STATISTIC_PAIRING: Variable = variable(
    "statistic_pairing",
    &["statistic"],
    Unit::ONE,
    "variance with antithetic pairs over that with as many independent paths, missing where not measured",
);
const SCHEME_ORDER: Variable =
    variable("scheme_order", &["scheme", "statistic"], Unit::ONE, "observed order p of the bias C h^p");
const SCHEME_ORDER_ERROR: Variable =
    variable("scheme_order_error", &["scheme", "statistic"], Unit::ONE, "its standard error");

const PREDICTION: &[&str] = &["scheme", "statistic", "target"];
const PREDICTED_SECONDS: Variable =
    variable("predicted_seconds", PREDICTION, Unit::Seconds, "CPU time of the cheapest run that meets the target");
const PREDICTED_PATHS: Variable = variable("predicted_paths", PREDICTION, Unit::ONE, "its number of paths");
const PREDICTED_STEP: Variable = variable("predicted_step", PREDICTION, Unit::TIME, "its time step");
const PREDICTED_TOLERANCE: Variable = variable("predicted_tolerance", PREDICTION, Unit::ONE, "its tolerance");
const PREDICTED_BIAS: Variable = variable("predicted_bias", PREDICTION, Unit::ONE, "upper bound of its bias, relative");
const PREDICTED_ANTITHETIC: Variable =
    variable("predicted_antithetic", PREDICTION, Unit::ONE, "1 where its paths are antithetic pairs");
const WINNER: Variable =
    variable("winner", &["statistic", "target"], Unit::None, "scheme of the cheapest run, or none");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documentation_names_every_variable() {
        let text = include_str!("../../docs/output-format.md");
        for variable in [
            RUNG,
            SCHEME,
            TARGET,
            RUNG_SCHEME,
            RUNG_STEP,
            RUNG_TOLERANCE,
            RUNG_PATHS,
            RUNG_DIVERGED,
            RUNG_SECONDS_FIRST,
            RUNG_SECONDS,
            RUNG_ESTIMATE,
            RUNG_STANDARD_ERROR,
            RUNG_VARIANCE,
            RUNG_BIAS,
            RUNG_BIAS_ERROR,
            RUNG_CHANGE,
            RUNG_CHANGE_ERROR,
            STATISTIC_SCALE,
            STATISTIC_NOTE,
            STATISTIC_PAIRING,
            SCHEME_ORDER,
            SCHEME_ORDER_ERROR,
            PREDICTED_SECONDS,
            PREDICTED_PATHS,
            PREDICTED_ANTITHETIC,
            PREDICTED_STEP,
            PREDICTED_TOLERANCE,
            PREDICTED_BIAS,
            WINNER,
        ] {
            assert!(text.contains(&format!("`{}`", variable.name)), "{}", variable.name);
        }
    }
}
