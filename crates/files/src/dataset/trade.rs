//! A trade as a data set: what was measured for every setting, and what was predicted for every
//! target.

use super::header::{Format, walk_origin};
use super::layout::{Unit, Variable, coordinate, table, variable};
use super::summary::write_statistics;
use super::walk::{Walk, Walked};
use super::{
    Dataset, Source, columns_of, counted, read_attribute, read_other_program, read_variable,
    series, texts,
};
use stickslip::engine::Provenance;
use stickslip::scenario::Scenario;
use stickslip::scheme::Kind;
use stickslip::stats::Statistic;
use stickslip::study::trade::{
    Choice, Cost, CostCurves, Number, Pairing, TARGETS, Trade, TradeSetting,
};

/// Name and version of the format.
pub(crate) const TRADE_FORMAT: Format = ("stick-slip trade", (2, 1));

impl Dataset {
    /// The data set of a trade of this scenario.
    pub fn of_trade(scenario: &Scenario, trade: &Trade) -> Self {
        let mut header = Provenance::of(scenario);
        let units = header.units.clone();
        let mut reference = trade.reference().scheme.to_string();
        let mut dataset =
            Dataset::written(&units, |walk| attributes(walk, &mut header, &mut reference));
        series::write(&mut dataset, &header);
        write_statistics(&mut dataset, &Statistic::ALL);
        dataset.write(&RUNG, &counted(0, trade.settings.len()));
        dataset.write(
            &SCHEME,
            &texts(trade.schemes().into_iter().map(|scheme| scheme.name())),
        );
        dataset.write(&TARGET, &TARGETS);
        let of_rung = |setting: &TradeSetting| {
            Statistic::ALL.map(|statistic| {
                let Number { value, error } = trade.bias(setting, statistic);
                [setting.variance(statistic), value, error]
            })
        };
        let derived = columns_of(trade.settings.iter().flat_map(of_rung));
        dataset.write_by(|to| measured(to, &mut trade.settings.clone(), derived));
        orders(&mut dataset, trade);
        predicted(&mut dataset, trade);
        dataset
    }

    /// The trade in the data set. Fails if the data set is not that of a trade.
    pub fn trade(&self) -> Result<StoredTrade, String> {
        read(self)
    }
}

fn attributes(walk: &mut Walk, header: &mut Provenance, reference: &mut String) -> Walked {
    walk_origin(walk, TRADE_FORMAT, &mut header.title, &mut header.program)?;
    walk.derived_attribute("seed", header.seed);
    walk.derived_attribute("generator", header.program.generator.as_str());
    walk.attribute("reference", reference)?;
    walk.attribute("scenario", &mut header.scenario_text)
}

/// Walk over the measurements of the settings. Variance, bias and the error of the bias follow from
/// them.
fn measured(walk: &mut Walk, settings: &mut Vec<TradeSetting>, derived: [Vec<f64>; 3]) -> Walked {
    let mut columns = SettingColumns::of(settings);
    columns.walk(walk, &derived)?;
    *settings = (0..columns.names.len())
        .map(|i| columns.setting(i))
        .collect::<Result<_, _>>()?;
    Ok(())
}

/// The measurements of all settings, as the variables of a file.
struct SettingColumns {
    names: Vec<String>,
    steps: Vec<f64>,
    tolerances: Vec<f64>,
    paths: Vec<u64>,
    diverged: Vec<u64>,
    first: Vec<f64>,
    each: Vec<f64>,
    estimates: Vec<f64>,
    errors: Vec<f64>,
    changes: Vec<f64>,
    change_errors: Vec<f64>,
}

impl SettingColumns {
    const ALL: usize = Statistic::ALL.len();

    fn of(settings: &[TradeSetting]) -> Self {
        let of_rung = |setting: &TradeSetting| {
            let TradeSetting {
                scheme,
                cost: Cost { first, each },
                ..
            } = setting;
            [
                scheme.step().unwrap_or(f64::NAN),
                scheme.tolerance().unwrap_or(f64::NAN),
                *first,
                *each,
            ]
        };
        let numbers = |setting: &TradeSetting| {
            Statistic::ALL.map(|statistic| {
                let estimate = setting.estimate(statistic);
                let change = setting.change(statistic).unwrap_or(Number {
                    value: f64::NAN,
                    error: f64::NAN,
                });
                [estimate.value, estimate.error, change.value, change.error]
            })
        };
        let [steps, tolerances, first, each] = columns_of(settings.iter().map(of_rung));
        let [estimates, errors, changes, change_errors] =
            columns_of(settings.iter().flat_map(numbers));
        SettingColumns {
            names: texts(settings.iter().map(|setting| setting.scheme.name())),
            steps,
            tolerances,
            paths: settings.iter().map(|setting| setting.paths).collect(),
            diverged: settings.iter().map(|setting| setting.diverged).collect(),
            first,
            each,
            estimates,
            errors,
            changes,
            change_errors,
        }
    }

    fn walk(&mut self, walk: &mut Walk, derived: &[Vec<f64>; 3]) -> Walked {
        walk.variable(&RUNG_SCHEME, &mut self.names)?;
        walk.check(!self.names.is_empty(), || {
            format!("{} is missing", RUNG_SCHEME.name)
        })?;
        let count = self.names.len();
        walk.sized(&RUNG_STEP, &mut self.steps, count)?;
        walk.sized(&RUNG_TOLERANCE, &mut self.tolerances, count)?;
        walk.sized(&RUNG_PATHS, &mut self.paths, count)?;
        walk.sized(&RUNG_DIVERGED, &mut self.diverged, count)?;
        walk.sized(&RUNG_SECONDS_FIRST, &mut self.first, count)?;
        walk.sized(&RUNG_SECONDS, &mut self.each, count)?;
        let length = count * Self::ALL;
        walk.sized(&RUNG_ESTIMATE, &mut self.estimates, length)?;
        walk.sized(&RUNG_STANDARD_ERROR, &mut self.errors, length)?;
        let variables = [&RUNG_VARIANCE, &RUNG_BIAS, &RUNG_BIAS_ERROR];
        for (variable, values) in variables.into_iter().zip(derived) {
            walk.derived(variable, values);
        }
        walk.sized(&RUNG_CHANGE, &mut self.changes, length)?;
        walk.sized(&RUNG_CHANGE_ERROR, &mut self.change_errors, length)
    }

    fn setting(&self, i: usize) -> Result<TradeSetting, String> {
        let name = &self.names[i];
        let kind = Kind::from_name(name).ok_or_else(|| format!("unknown scheme \"{name}\""))?;
        let numbers = |values: &[f64], errors: &[f64]| -> Vec<Number> {
            let of_rung = i * Self::ALL..(i + 1) * Self::ALL;
            let pairs = values[of_rung.clone()].iter().zip(&errors[of_rung]);
            pairs
                .map(|(&value, &error)| Number { value, error })
                .collect()
        };
        let changes = numbers(&self.changes, &self.change_errors);
        let is_measured = changes.iter().any(|change| !change.value.is_nan());
        Ok(TradeSetting {
            scheme: kind.with(if kind.has_step() {
                self.steps[i]
            } else {
                self.tolerances[i]
            }),
            paths: self.paths[i],
            diverged: self.diverged[i].min(self.paths[i]),
            cost: Cost {
                first: self.first[i],
                each: self.each[i],
            },
            estimates: numbers(&self.estimates, &self.errors),
            changes: if is_measured { changes } else { Vec::new() },
        })
    }
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
    let numbers = |choice: &Option<Choice>| match choice {
        Some(choice) => [
            choice.seconds,
            choice.paths as f64,
            choice.scheme.step().unwrap_or(f64::NAN),
            choice.scheme.tolerance().unwrap_or(f64::NAN),
            choice.bias,
        ],
        None => [f64::NAN; 5],
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
    /// What was measured. What follows from it is computed again, and not read.
    pub trade: Trade,
    /// Its scenario.
    pub scenario: Scenario,
    /// The program that wrote the trade, if it was another one.
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
pub(crate) fn read(from: &dyn Source) -> Result<StoredTrade, String> {
    let text: String = read_attribute(from, "scenario")?;
    let scenario = Scenario::parse_stored("scenario", &text, &[], &series::read(from)?);
    let scenario = scenario.map_err(|error| error.to_string())?;
    let mut settings = Vec::new();
    measured(&mut Walk::Reading(from), &mut settings, Default::default())?;
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
        let text = include_str!("../../../../docs/output-format.md");
        for variable in ALL {
            assert!(
                text.contains(&format!("`{}`", variable.name)),
                "{}",
                variable.name
            );
        }
    }
}
