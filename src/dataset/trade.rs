//! A trade as a data set: what was measured for every setting, and what was predicted for every
//! target.

use super::header::{Format, write_origin};
use super::layout::{Unit, Variable, coordinate, table, variable};
use super::summary::write_statistics;
use super::{
    Dataset, Source, columns_of, counted, read_attribute, read_other_program, read_sized,
    read_variable, series, texts,
};
use crate::engine::Provenance;
use crate::scenario::Scenario;
use crate::scheme::{Kind, Scheme};
use crate::stats::Statistic;
use crate::study::trade::{
    Choice, Cost, CostCurves, Number, Pairing, TARGETS, Trade, TradeSetting,
};

/// Name and version of the format.
pub const TRADE_FORMAT: Format = ("stick-slip trade", (2, 1));

impl Dataset {
    /// The data set of a trade of this scenario.
    pub fn of_trade(scenario: &Scenario, trade: &Trade) -> Self {
        let header = Provenance::of(scenario);
        let mut dataset = Dataset::new(&header.units);
        write_origin(&mut dataset, TRADE_FORMAT, &header.title);
        dataset.set_attribute("seed", header.seed);
        dataset.set_attribute("generator", header.program.generator.as_str());
        dataset.set_attribute("reference", trade.reference().scheme.to_string());
        dataset.set_attribute("scenario", header.scenario_text.as_str());
        series::write(&mut dataset, &header);
        write_statistics(&mut dataset, &Statistic::ALL);
        let schemes = trade.schemes().into_iter().map(Kind::name);
        dataset.write(&RUNG, &counted(0, trade.settings.len()));
        dataset.write(&SCHEME, &texts(schemes));
        dataset.write(&TARGET, &TARGETS);
        settings(&mut dataset, trade);
        orders(&mut dataset, trade);
        predicted(&mut dataset, trade);
        dataset
    }

    /// The trade in the data set. Fails if the data set is not that of a trade.
    pub fn trade(&self) -> Result<StoredTrade, String> {
        read(self)
    }
}

const STATISTICS: usize = Statistic::ALL.len();

/// The step and the tolerance of a scheme; NaN where it has none.
fn parameters(scheme: Scheme) -> [f64; 2] {
    [scheme.step(), scheme.tolerance()].map(|parameter| parameter.unwrap_or(f64::NAN))
}

/// The measurements of the settings, and the biases that follow from them.
fn settings(to: &mut Dataset, trade: &Trade) {
    let all = || trade.settings.iter();
    let counts = |count: fn(&TradeSetting) -> u64| all().map(count).collect::<Vec<u64>>();
    let reals = |real: fn(&TradeSetting) -> f64| all().map(real).collect::<Vec<f64>>();
    let [steps, tolerances] = columns_of(all().map(|setting| parameters(setting.scheme)));
    let names = all().map(|setting| setting.scheme.name());
    to.write(&RUNG_SCHEME, &texts(names));
    to.write(&RUNG_STEP, &steps);
    to.write(&RUNG_TOLERANCE, &tolerances);
    to.write(&RUNG_PATHS, &counts(|setting| setting.paths));
    to.write(&RUNG_DIVERGED, &counts(|setting| setting.diverged));
    to.write(&RUNG_SECONDS_FIRST, &reals(|setting| setting.cost.first));
    to.write(&RUNG_SECONDS, &reals(|setting| setting.cost.each));
    let numbers = |setting: &TradeSetting| {
        Statistic::ALL.map(|statistic| {
            let estimate = setting.estimate(statistic);
            let bias = trade.bias(setting, statistic);
            let missing = Number {
                value: f64::NAN,
                error: f64::NAN,
            };
            let change = setting.change(statistic).unwrap_or(missing);
            [
                estimate.value,
                estimate.error,
                setting.variance(statistic),
                bias.value,
                bias.error,
                change.value,
                change.error,
            ]
        })
    };
    let variables = [
        RUNG_ESTIMATE,
        RUNG_STANDARD_ERROR,
        RUNG_VARIANCE,
        RUNG_BIAS,
        RUNG_BIAS_ERROR,
        RUNG_CHANGE,
        RUNG_CHANGE_ERROR,
    ];
    let columns = columns_of(all().flat_map(numbers));
    for (variable, values) in variables.iter().zip(&columns) {
        to.write(variable, values);
    }
}

fn read_settings(from: &dyn Source) -> Result<Vec<TradeSetting>, String> {
    let names: Vec<String> = read_variable(from, &RUNG_SCHEME)?;
    let count = names.len();
    let reals = |variable| read_sized::<f64>(from, variable, count);
    let [steps, tolerances] = [reals(&RUNG_STEP)?, reals(&RUNG_TOLERANCE)?];
    let [first, each] = [reals(&RUNG_SECONDS_FIRST)?, reals(&RUNG_SECONDS)?];
    let paths: Vec<u64> = read_sized(from, &RUNG_PATHS, count)?;
    let diverged: Vec<u64> = read_sized(from, &RUNG_DIVERGED, count)?;
    let numbers = |values, errors| -> Result<Vec<Number>, String> {
        let read = |variable| read_sized::<f64>(from, variable, count * STATISTICS);
        let pairs = read(values)?.into_iter().zip(read(errors)?);
        Ok(pairs
            .map(|(value, error)| Number { value, error })
            .collect())
    };
    let estimates = numbers(&RUNG_ESTIMATE, &RUNG_STANDARD_ERROR)?;
    let changes = numbers(&RUNG_CHANGE, &RUNG_CHANGE_ERROR)?;
    let setting = |(i, name): (usize, String)| {
        let kind = Kind::from_name(&name).ok_or_else(|| format!("unknown scheme \"{name}\""))?;
        let parameters = if kind.has_step() { &steps } else { &tolerances };
        let of_rung = i * STATISTICS..(i + 1) * STATISTICS;
        let changes = &changes[of_rung.clone()];
        let is_measured = changes.iter().any(|change| !change.value.is_nan());
        Ok(TradeSetting {
            scheme: kind.with(parameters[i]),
            paths: paths[i],
            diverged: diverged[i].min(paths[i]),
            cost: Cost {
                first: first[i],
                each: each[i],
            },
            estimates: estimates[of_rung].to_vec(),
            changes: if is_measured {
                changes.to_vec()
            } else {
                Vec::new()
            },
        })
    };
    names.into_iter().enumerate().map(setting).collect()
}

fn orders(to: &mut Dataset, trade: &Trade) {
    let law = |scheme, statistic| match trade.law(scheme, statistic) {
        Some(law) => [law.order.value, law.order.error],
        None => [f64::NAN; 2],
    };
    let schemes = trade.schemes().into_iter();
    let [orders, errors] =
        columns_of(schemes.flat_map(|scheme| Statistic::ALL.map(|of| law(scheme, of))));
    let standings = Statistic::ALL.map(|statistic| trade.standing(statistic));
    let ratio = |statistic| trade.pairing.ratio(statistic).unwrap_or(f64::NAN);
    to.write(
        &STATISTIC_SCALE,
        &standings
            .each_ref()
            .map(|standing| standing.scale().unwrap_or(f64::NAN)),
    );
    to.write(
        &STATISTIC_NOTE,
        &standings.map(|standing| standing.to_string()),
    );
    to.write(&STATISTIC_PAIRING, &Statistic::ALL.map(ratio));
    to.write(&SCHEME_ORDER, &orders);
    to.write(&SCHEME_ORDER_ERROR, &errors);
}

fn predicted(to: &mut Dataset, trade: &Trade) {
    let mut choices: Vec<Option<Choice>> = Vec::new();
    for scheme in trade.schemes() {
        for statistic in Statistic::ALL {
            choices
                .extend(TARGETS.map(|target| trade.best(Some(scheme), &[statistic], target).ok()));
        }
    }
    let numbers = |choice: &Option<Choice>| {
        choice.map_or([f64::NAN; 5], |choice| {
            let [step, tolerance] = parameters(choice.scheme);
            [
                choice.seconds,
                choice.paths as f64,
                step,
                tolerance,
                choice.bias,
            ]
        })
    };
    let is_antithetic =
        |choice: &Option<Choice>| i8::from(choice.is_some_and(|choice| choice.is_antithetic));
    let [seconds, paths, steps, tolerances, biases] = columns_of(choices.iter().map(numbers));
    to.write(&PREDICTED_SECONDS, &seconds);
    to.write(&PREDICTED_PATHS, &paths);
    to.write(
        &PREDICTED_ANTITHETIC,
        &choices.iter().map(is_antithetic).collect::<Vec<i8>>(),
    );
    to.write(&PREDICTED_STEP, &steps);
    to.write(&PREDICTED_TOLERANCE, &tolerances);
    to.write(&PREDICTED_BIAS, &biases);
    let winner = |statistic, target| match trade.best(None, &[statistic], target) {
        Ok(choice) => choice.scheme.name(),
        Err(_) => "none",
    };
    let winners = Statistic::ALL
        .into_iter()
        .flat_map(|s| TARGETS.map(|target| winner(s, target)));
    to.write(&WINNER, &texts(winners));
}

/// A trade in a file or in a data set.
#[derive(Clone, Debug)]
pub struct StoredTrade {
    /// The measurements. Derived numbers are computed again, not read.
    pub trade: Trade,
    /// Its scenario.
    pub scenario: Scenario,
    /// The program that wrote the trade, if it was a different one.
    pub other_program: Option<String>,
}

impl StoredTrade {
    /// The costs of accuracy for this statistic, or for the first statistic that has any; none if
    /// none has.
    pub fn cost_curves(&self, statistic: Option<Statistic>) -> Option<CostCurves> {
        let costs = |statistic| CostCurves::of(&self.trade, statistic, &self.scenario);
        match statistic {
            Some(statistic) => Some(costs(statistic)),
            None => Statistic::ALL
                .into_iter()
                .map(costs)
                .find(CostCurves::has_points),
        }
    }
}

/// Read a trade back.
pub fn read(from: &dyn Source) -> Result<StoredTrade, String> {
    let text: String = read_attribute(from, "scenario")?;
    let scenario = Scenario::parse_stored("scenario", &text, &[], &series::read(from)?);
    let scenario = scenario.map_err(|error| error.to_string())?;
    let settings = read_settings(from)?;
    let reference: String = read_attribute(from, "reference")?;
    let reference = settings
        .iter()
        .position(|setting| setting.scheme.to_string() == reference);
    let reference = reference.ok_or_else(|| "reference is not one of its settings".to_string())?;
    let ratios: Vec<f64> = read_variable(from, &STATISTIC_PAIRING)?;
    let pairing = match ratios.iter().all(|ratio| ratio.is_nan()) {
        _ if scenario.ensemble.antithetic => Pairing::Asked,
        true => Pairing::Unknown,
        false => Pairing::Measured(ratios),
    };
    let trade = Trade::of_rungs(&scenario, settings, reference, pairing)
        .map_err(|check_error| check_error.to_string())?;
    Ok(StoredTrade {
        trade,
        scenario,
        other_program: read_other_program(from)?,
    })
}

const PER_RUNG: &[(&str, &str)] = &[("coordinates", "rung_scheme rung_step rung_tolerance")];
const BOTH: &[&str] = &["rung", "statistic"];
const PREDICTION: &[&str] = &["scheme", "statistic", "target"];

table! {
    RUNG = coordinate!("rung", Unit::ONE, "number of the setting: scheme by scheme, from coarse to fine");
    SCHEME = coordinate!("scheme", Unit::None, "name of the scheme");
    TARGET = coordinate!("target", Unit::ONE, "target relative root mean square error");
    RUNG_SCHEME = variable("rung_scheme", &["rung"], Unit::None, "scheme of the setting");
    RUNG_STEP = variable("rung_step", &["rung"], Unit::TIME, "time step, missing if there is none");
    RUNG_TOLERANCE = variable("rung_tolerance", &["rung"], Unit::ONE, "tolerance, missing if there is none");
    RUNG_PATHS = variable("rung_paths", &["rung"], Unit::ONE, "paths simulated").with(PER_RUNG);
    RUNG_DIVERGED = variable("rung_diverged", &["rung"], Unit::ONE, "paths that diverged").with(PER_RUNG);
    RUNG_SECONDS_FIRST = variable("rung_seconds_first", &["rung"], Unit::Seconds,
        "CPU time of a run of one path").with(PER_RUNG);
    RUNG_SECONDS = variable("rung_seconds", &["rung"], Unit::Seconds,
        "CPU time per path of a large run").with(PER_RUNG);

    RUNG_ESTIMATE = variable("rung_estimate", BOTH, Unit::None, "estimate").with(PER_RUNG);
    RUNG_STANDARD_ERROR = variable("rung_standard_error", BOTH, Unit::None,
        "standard error of the estimate").with(PER_RUNG);
    RUNG_VARIANCE = variable("rung_path_variance", BOTH, Unit::None,
        "variance per path, in the unit of the statistic squared").with(PER_RUNG);
    RUNG_BIAS = variable("rung_bias", BOTH, Unit::None, "difference from the reference").with(PER_RUNG);
    RUNG_BIAS_ERROR = variable("rung_bias_error", BOTH, Unit::None,
        "standard error of that difference").with(PER_RUNG);
    RUNG_CHANGE = variable("rung_change", BOTH, Unit::None,
        "estimate minus the one at half the step, with the same noise").with(PER_RUNG);
    RUNG_CHANGE_ERROR = variable("rung_change_error", BOTH, Unit::None,
        "standard error of that difference").with(PER_RUNG);

    STATISTIC_SCALE = variable("statistic_scale", &["statistic"], Unit::None,
        "scale to which errors of the statistic are relative");
    STATISTIC_NOTE = variable("statistic_note", &["statistic"], Unit::None, "meaning of that scale, or why \
        there is none");
    STATISTIC_PAIRING = variable("statistic_pairing", &["statistic"], Unit::ONE,
        "variance with antithetic pairs divided by that with the same number of independent paths, missing if \
            not measured");
    SCHEME_ORDER = variable("scheme_order", &["scheme", "statistic"], Unit::ONE,
        "observed order p of the bias C h^p");
    SCHEME_ORDER_ERROR = variable("scheme_order_error", &["scheme", "statistic"], Unit::ONE, "its standard error");

    PREDICTED_SECONDS = variable("predicted_seconds", PREDICTION, Unit::Seconds,
        "CPU time of the cheapest run that meets the target");
    PREDICTED_PATHS = variable("predicted_paths", PREDICTION, Unit::ONE, "number of paths of the cheapest run");
    PREDICTED_STEP = variable("predicted_step", PREDICTION, Unit::TIME, "time step of the cheapest run");
    PREDICTED_TOLERANCE = variable("predicted_tolerance", PREDICTION, Unit::ONE, "its tolerance");
    PREDICTED_BIAS = variable("predicted_bias", PREDICTION, Unit::ONE, "upper bound of the relative bias of \
        the cheapest run");
    PREDICTED_ANTITHETIC = variable("predicted_antithetic", PREDICTION, Unit::ONE,
        "1 if its paths are antithetic pairs");
    WINNER = variable("winner", &["statistic", "target"], Unit::None, "scheme of the cheapest run, or none");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documentation_names_every_variable() {
        let text = include_str!("../../docs/output-format.md");
        for variable in ALL {
            assert!(
                text.contains(&format!("`{}`", variable.name)),
                "{}",
                variable.name
            );
        }
    }

    /// Settings of value 1 + h^(1/2)/10, two of steps and a reference without one. Biases are those to
    /// the reference, changes those to half the step, and the order is 1/2.
    #[test]
    fn variables_hold_what_their_names_say() {
        let scenario = Scenario::shipped("rho025").expect("shipped");
        let all = |value: f64, error: f64| vec![Number { value, error }; STATISTICS];
        let off = |h: f64| 0.1 * h.sqrt();
        let of = |scheme: Scheme, paths, value: f64, changes| TradeSetting {
            scheme,
            paths,
            diverged: 0,
            cost: Cost {
                first: 2.0,
                each: 1.0,
            },
            estimates: all(value, 1e-6),
            changes,
        };
        let mut settings: Vec<TradeSetting> = (0..5)
            .map(|k| {
                let h = 0.1 * 0.5f64.powi(k);
                let changes = all(off(h) - off(h / 2.0), 1e-7);
                of(Kind::DiscreteVi.with(h), 100, 1.0 + off(h), changes)
            })
            .collect();
        settings.push(of(Kind::EventDriven.with(1e-5), 200, 1.0, Vec::new()));
        let reference = settings.len() - 1;
        let trade = Trade::of_rungs(&scenario, settings, reference, Pairing::Unknown);
        let dataset = Dataset::of_trade(&scenario, &trade.expect("sound"));
        let first = |name: &str| {
            let entry = dataset.entry(name).unwrap_or_else(|| panic!("{name}"));
            <&[f64]>::try_from(&entry.column).expect("reals")[0]
        };
        for (name, wanted) in [
            ("rung_step", 0.1),
            ("rung_seconds_first", 2.0),
            ("rung_seconds", 1.0),
            ("rung_estimate", 1.0 + off(0.1)),
            ("rung_standard_error", 1e-6),
            ("rung_bias", off(0.1)),
            ("rung_change", off(0.1) - off(0.05)),
            ("rung_change_error", 1e-7),
            ("scheme_order", 0.5),
        ] {
            assert!(
                (first(name) - wanted).abs() < 1e-4 * wanted,
                "{name}: {}",
                first(name)
            );
        }
    }
}
