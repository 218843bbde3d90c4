//! Synthetic measurements of a bearing as a data set, with the true values.

use super::calibration::{TIME, of_quantity, units, write_quantities};
use crate::calibration::{Twin, Values};
use stickslip::dataset::layout::{Unit, Variable, variable};
use stickslip::dataset::{Dataset, write_origin};

/// The data set of synthetic measurements, with the true values that a calibration should find
/// in them. `title` is one line, and `start` is the time stamp of t = 0.
pub fn twin(title: &str, start: &str, truth: &Values, twin: &Twin) -> Dataset {
    let mut to = Dataset::new(&units());
    write_origin(&mut to, ("stick-slip twin", (1, 0)), title);
    to.set_attribute("start", start);
    to.set_attribute("slips", twin.slips);
    write_quantities(&mut to);
    to.write(&TRUTH, truth);
    to.write(&TIME, &twin.times);
    to.write(&TEMPERATURE, &twin.temperatures);
    to.write(&DISPLACEMENT, &twin.readings);
    to
}
const TRUTH: Variable = of_quantity("truth", "true value of the quantity");
const TEMPERATURE: Variable =
    variable("temperature", &["time"], Unit::None, "measured temperature")
        .with(&[("units", "degC")]);
const DISPLACEMENT: Variable = variable(
    "displacement",
    &["time"],
    Unit::LENGTH,
    "measured displacement",
);
