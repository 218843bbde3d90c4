//! A forecast as a data set: expected values for a year, and every simulated year.

use super::calibration::units;
use crate::forecast::{BearingForecast, Forecast, ForecastLevel, ReturnLevel};
use stickslip::dataset::layout::{Unit, Variable, coordinate, variable};
use stickslip::dataset::{Dataset, Format, columns_of, counted, texts, write_origin};

/// Name and version of the format.
const FORMAT: Format = ("stick-slip forecast", (1, 0));

/// The data set of a forecast. `title` is one line, and `scenario_text` is the scenario as it
/// was written.
pub fn forecast(title: &str, scenario_text: &str, found: &BearingForecast) -> Dataset {
    let Forecast {
        question,
        years,
        levels,
        return_levels,
        showed,
        usual,
        redrawn,
        ..
    } = &found.forecast;
    let mut to = Dataset::new(&units());
    write_origin(&mut to, FORMAT, title);
    to.set_attribute("scenario", scenario_text);
    to.set_attribute("seed", question.seed);
    to.set_attribute("interval", question.level);
    to.set_attribute("share", question.share);
    to.set_attribute("draws_redrawn", *redrawn);
    let repairs = &found.calibration.record.repairs;
    if !repairs.is_empty() {
        to.set_attribute("repairs", repairs.join("\n"));
    }
    for (name, value) in [
        ("record_slips", showed.slips),
        ("record_sliding_path", showed.path),
        ("record_duration", showed.duration),
        ("usual_slips_low", usual[0]),
        ("usual_slips_high", usual[1]),
    ] {
        to.set_attribute(name, value);
    }
    to.write(
        &QUANTITY,
        &texts(levels.iter().map(|level| level.quantity.name())),
    );
    to.write(
        &QUANTITY_UNIT,
        &texts(levels.iter().map(|level| level.quantity.unit())),
    );
    let of_level = |level: &ForecastLevel| {
        let ForecastLevel {
            expected,
            expected_interval: [low, high],
            year_interval: [least, most],
            ..
        } = *level;
        [expected, low, high, least, most]
    };
    for (variable, values) in PER_LEVEL
        .iter()
        .zip(&columns_of(levels.iter().map(of_level)))
    {
        to.write(variable, values);
    }
    let of_period = |of: &ReturnLevel| [of.years, of.expected, of.interval[0], of.interval[1]];
    for (variable, values) in PER_PERIOD
        .iter()
        .zip(&columns_of(return_levels.iter().map(of_period)))
    {
        to.write(variable, values);
    }
    to.write(&DRAW, &counted(0, years.len()));
    to.write(&YEAR, &counted(0, years.first().map_or(0, Vec::len)));
    for level in levels {
        let unit = [("units", level.quantity.unit())];
        let each = variable(
            level.quantity.name(),
            &["draw", "year"],
            Unit::None,
            "value in one simulated year, scaled to the mean with the most likely parameters",
        )
        .with(&unit);
        let values = years
            .iter()
            .flatten()
            .map(|year| year[level.quantity as usize]);
        to.write(&each, &values.collect::<Vec<_>>());
    }
    to
}
const QUANTITY: Variable = coordinate!("quantity", Unit::None, "name of the quantity");
const QUANTITY_UNIT: Variable = variable(
    "quantity_unit",
    &["quantity"],
    Unit::None,
    "unit of the quantity",
);

const fn of_quantity(name: &'static str, meaning: &'static str) -> Variable {
    variable(name, &["quantity"], Unit::None, meaning).with(&[("coordinates", "quantity_unit")])
}

const PER_LEVEL: [Variable; 5] = [
    of_quantity("expected", "mean over all years"),
    of_quantity("expected_low", "lower end of the interval of that mean"),
    of_quantity("expected_high", "upper end of the interval of that mean"),
    of_quantity("year_low", "lower end of the interval for a single year"),
    of_quantity("year_high", "upper end of the interval for a single year"),
];

const fn of_period(name: &'static str, unit: Unit, meaning: &'static str) -> Variable {
    variable(name, &["return_period"], unit, meaning)
}

const PER_PERIOD: [Variable; 4] = [
    of_period("return_period", Unit::None, "return period in years"),
    of_period(
        "return_level",
        Unit::LENGTH,
        "return level: |z| exceeded once per return period",
    ),
    of_period(
        "return_level_low",
        Unit::LENGTH,
        "lower end of the interval of the return level",
    ),
    of_period(
        "return_level_high",
        Unit::LENGTH,
        "upper end of the interval of the return level",
    ),
];
const DRAW: Variable = coordinate!("draw", Unit::None, "number of the parameter draw");
const YEAR: Variable = coordinate!("year", Unit::None, "number of the year within a draw");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forecast::{ForecastQuantity, ForecastQuestion, Showed};

    /// Each variable holds what its name says, for a reader that knows only the names.
    #[test]
    fn variables_hold_what_their_names_say() {
        let level = ForecastLevel {
            quantity: ForecastQuantity::Slips,
            expected: 100.0,
            expected_interval: [90.0, 110.0],
            year_interval: [60.0, 150.0],
        };
        let found = Forecast {
            question: ForecastQuestion {
                draws: 1,
                years: 2,
                seed: 5,
                level: 0.9,
                share: 0.8,
            },
            years: vec![vec![
                [0.1, 90.0, 0.3, 0.4, 0.5, 0.6],
                [0.1, 95.0, 0.3, 0.4, 0.5, 0.6],
            ]],
            levels: vec![level],
            return_levels: vec![ReturnLevel {
                years: 10.0,
                expected: 0.02,
                interval: [0.01, 0.03],
            }],
            showed: Showed {
                slips: 80.0,
                path: 0.04,
                duration: 1e6,
                is_comparable: true,
            },
            usual: [50.0, 130.0],
            redrawn: 3,
        };
        let found = BearingForecast {
            calibration: Default::default(),
            weather: Default::default(),
            forecast: found,
        };
        let dataset = forecast("a title", "", &found);
        for (name, wanted) in [
            ("expected", 100.0),
            ("expected_low", 90.0),
            ("expected_high", 110.0),
            ("year_low", 60.0),
            ("year_high", 150.0),
            ("return_period", 10.0),
            ("return_level", 0.02),
            ("return_level_low", 0.01),
            ("return_level_high", 0.03),
            ("slips", 90.0),
        ] {
            let entry = dataset.entry(name).unwrap_or_else(|| panic!("{name}"));
            let values = <&[f64]>::try_from(&entry.column).expect("reals");
            assert_eq!(values[0], wanted, "{name}");
        }
    }
}
