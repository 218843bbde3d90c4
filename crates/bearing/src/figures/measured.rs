//! Data for the figures of a calibration.

use crate::dataset::CALIBRATION_FORMAT;
use std::ops::Range;
use stickslip::dataset::{Attribute, Column, Dataset};
use stickslip_data::Start;
use stickslip_figure::{Absent, Subject};

pub const DAY: f64 = 86_400.0;

/// The maximum number of points of a curve. More would be closer together than the dots of a
/// printer.
const POINTS: usize = 8_000;

/// The data set of a calibration.
#[derive(Clone, Copy)]
pub struct Measured<'a> {
    pub title: &'a str,
    dataset: &'a Dataset,
}

impl<'a> Measured<'a> {
    pub fn of(subject: &Subject<'a>) -> Result<Self, Absent> {
        let (title, dataset) =
            subject.dataset(CALIBRATION_FORMAT.0, "the result of a calibration")?;
        let of = Measured { title, dataset };
        let length = of.numbers("time").len();
        let columns = ["temperature", "displacement", "displacement_modelled"];
        match columns.iter().all(|name| of.numbers(name).len() == length) {
            true => Ok(of),
            false => Err(Absent::Nothing(
                "measurement and model are not in the data set",
            )),
        }
    }

    /// The real numbers in a variable; none if there is no such variable.
    pub fn numbers(&self, name: &str) -> &'a [f64] {
        match self.dataset.entry(name).map(|entry| &entry.column) {
            Some(Column::F64(values)) => values,
            _ => &[],
        }
    }

    /// The instant from which the times count, if it is known.
    pub fn start(&self) -> Option<Start> {
        match self.dataset.attribute("record_start")? {
            Attribute::Text(text) => Start::parse(text),
            _ => None,
        }
    }

    /// The length of the record.
    pub fn days(&self) -> f64 {
        self.numbers("time").last().copied().unwrap_or(0.0) / DAY
    }

    /// The thermometer's own samples: times and temperatures.
    pub fn thermometer(&self) -> [Vec<f64>; 2] {
        let flags = self.dataset.entry("temperature_interpolated");
        let flags = match flags.map(|entry| &entry.column) {
            Some(Column::I8(flags)) => flags.as_slice(),
            _ => &[],
        };
        ["time", "temperature"].map(|name| {
            let own = self.numbers(name).iter().enumerate();
            let own = own.filter(|(i, _)| flags.get(*i) != Some(&1));
            own.map(|(_, value)| *value).collect()
        })
    }
}

/// The indices of the samples of a curve: at most `POINTS` of them.
pub fn thinned(samples: Range<usize>) -> impl Iterator<Item = usize> {
    let step = samples.len().div_ceil(POINTS).max(1);
    samples.step_by(step)
}
