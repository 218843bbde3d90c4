//! Synthetic measurements of a bearing as a data set, with the true values beside them.

use super::calibration::{QUANTITY, QUANTITY_SYMBOL, QUANTITY_UNIT, TIME};
use super::layout::{Unit, Variable, variable};
use super::{Destination, texts};
use crate::bearing::calibration::{Quantity, Twin, Values};
use crate::engine::{PROGRAM_VERSION, commit};
use crate::stats::Dimension;

/// The attribute `format_name` of a twin.
const FORMAT_NAME: &str = "stick-slip twin";

/// Write synthetic measurements with the true values. `start` is the time stamp of t = 0.
pub(crate) fn write<D: Destination>(to: &mut D, start: &str, truth: &Values, twin: &Twin) -> Result<(), D::Error> {
    for (name, value) in
        [("format_name", FORMAT_NAME), ("program_version", PROGRAM_VERSION), ("git_hash", commit()), ("start", start)]
    {
        to.set_attribute(name, value)?;
    }
    to.set_attribute("slips", twin.slips)?;
    to.write_variable(&QUANTITY, &texts(Quantity::ALL.map(Quantity::key)))?;
    to.write_variable(&QUANTITY_SYMBOL, &texts(Quantity::ALL.map(Quantity::symbol)))?;
    to.write_variable(&QUANTITY_UNIT, &texts(Quantity::ALL.map(Quantity::unit)))?;
    to.write_variable(&TRUTH, truth)?;
    to.write_variable(&TIME, &twin.times)?;
    to.write_variable(&TEMPERATURE, &twin.temperatures)?;
    to.write_variable(&DISPLACEMENT, &twin.readings)
}

const TRUTH: Variable = variable("truth", &["quantity"], Unit::None, "what a calibration is to find")
    .with(&[("coordinates", "quantity_symbol quantity_unit")]);
const TEMPERATURE: Variable =
    variable("temperature", &["time"], Unit::None, "temperature as measured").with(&[("units", "degC")]);
const DISPLACEMENT: Variable =
    variable("displacement", &["time"], Unit::Of(Dimension::LENGTH), "displacement as measured");
