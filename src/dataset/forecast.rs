//! A forecast as a data set: what is expected of a year, and every year that was simulated.

use super::layout::{Unit, Variable, variable};
use super::{Destination, texts};
use crate::bearing::forecast::{Forecast, ForecastLevel, ReturnLevel};
use crate::engine::{PROGRAM_VERSION, commit};
use crate::stats::Dimension;

/// The attribute `format_name` of a forecast.
const FORMAT_NAME: &str = "stick-slip forecast";

/// Write a forecast.
pub(crate) fn write<D: Destination>(
    to: &mut D,
    title: &str,
    scenario_text: &str,
    forecast: &Forecast,
) -> Result<(), D::Error> {
    let Forecast { question, years, levels, return_levels, .. } = forecast;
    for (name, value) in [
        ("title", title),
        ("format_name", FORMAT_NAME),
        ("program_version", PROGRAM_VERSION),
        ("git_hash", commit()),
        ("scenario", scenario_text),
    ] {
        to.set_attribute(name, value)?;
    }
    to.set_attribute("seed", question.seed)?;
    to.set_attribute("interval", question.level)?;
    to.set_attribute("share", question.share)?;
    to.write_variable(&QUANTITY, &texts(levels.iter().map(|level| level.quantity.name())))?;
    to.write_variable(&QUANTITY_UNIT, &texts(levels.iter().map(|level| level.quantity.unit())))?;
    let of = |value: fn(&ForecastLevel) -> f64| levels.iter().map(value).collect::<Vec<_>>();
    to.write_variable(&EXPECTED, &of(|level| level.expected))?;
    to.write_variable(&EXPECTED_LOW, &of(|level| level.expected_interval[0]))?;
    to.write_variable(&EXPECTED_HIGH, &of(|level| level.expected_interval[1]))?;
    to.write_variable(&YEAR_LOW, &of(|level| level.year_interval[0]))?;
    to.write_variable(&YEAR_HIGH, &of(|level| level.year_interval[1]))?;
    let of = |value: fn(&ReturnLevel) -> f64| return_levels.iter().map(value).collect::<Vec<_>>();
    to.write_variable(&RETURN_PERIOD, &of(|level| level.years))?;
    to.write_variable(&RETURN_LEVEL, &of(|level| level.expected))?;
    to.write_variable(&RETURN_LEVEL_LOW, &of(|level| level.interval[0]))?;
    to.write_variable(&RETURN_LEVEL_HIGH, &of(|level| level.interval[1]))?;
    let numbers = |count: usize| (0..).take(count).collect::<Vec<u32>>();
    to.write_variable(&DRAW, &numbers(years.len()))?;
    to.write_variable(&YEAR, &numbers(years.first().map_or(0, Vec::len)))?;
    for level in levels {
        let unit = [("units", level.quantity.unit())];
        let each = variable(level.quantity.name(), &["draw", "year"], Unit::None, "of one year").with(&unit);
        let values = years.iter().flatten().map(|year| year[level.quantity as usize]);
        to.write_variable(&each, &values.collect::<Vec<_>>())?;
    }
    Ok(())
}

const LENGTH: Unit = Unit::Of(Dimension::LENGTH);
const PER_QUANTITY: &[(&str, &str)] = &[("coordinates", "quantity_unit")];
const QUANTITY: Variable = variable("quantity", &["quantity"], Unit::None, "name of the quantity");
const QUANTITY_UNIT: Variable = variable("quantity_unit", &["quantity"], Unit::None, "unit of the quantity");
const EXPECTED: Variable =
    variable("expected", &["quantity"], Unit::None, "mean over years with the likeliest parameters").with(PER_QUANTITY);
const EXPECTED_LOW: Variable =
    variable("expected_low", &["quantity"], Unit::None, "lower end of the interval of that mean").with(PER_QUANTITY);
const EXPECTED_HIGH: Variable =
    variable("expected_high", &["quantity"], Unit::None, "upper end of the interval of that mean").with(PER_QUANTITY);
const YEAR_LOW: Variable =
    variable("year_low", &["quantity"], Unit::None, "lower end of the interval of one year").with(PER_QUANTITY);
const YEAR_HIGH: Variable =
    variable("year_high", &["quantity"], Unit::None, "upper end of the interval of one year").with(PER_QUANTITY);
const RETURN_PERIOD: Variable = variable("return_period", &["return_period"], Unit::None, "return period in years");
const RETURN_LEVEL: Variable =
    variable("return_level", &["return_period"], LENGTH, "|z| that is exceeded in one of so many years");
const RETURN_LEVEL_LOW: Variable =
    variable("return_level_low", &["return_period"], LENGTH, "lower end of the interval of that |z|");
const RETURN_LEVEL_HIGH: Variable =
    variable("return_level_high", &["return_period"], LENGTH, "upper end of the interval of that |z|");
const DRAW: Variable = variable("draw", &["draw"], Unit::None, "number of the draw of the parameters");
const YEAR: Variable = variable("year", &["year"], Unit::None, "number of the year of a draw");
