//! A data set in memory.

use super::layout::Described;
use super::rows::{self, RowTable, Rows};
use super::{
    Attribute, Column, ColumnView, Destination, ElementType, Source, StoredCalibration, StoredSweep, StoredTrade,
    attributes_of, calibration, forecast, run, series, summary, sweep, trade, twin,
};
use crate::bearing::calibration::{self as bearing, Twin};
use crate::bearing::forecast::Forecast;
use crate::engine::{Provenance, Replay, Status};
use crate::model::Series;
use crate::scenario::Scenario;
use crate::stats::{Summary, Units};
use crate::study::sweep::Sweep;
use crate::study::trade::Trade;
use ndarray::ArrayViewD;
use std::convert::Infallible;
use std::sync::Arc;

/// A data set in memory, with the same variables and attributes as a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dataset {
    /// Attributes of the data set, by name.
    pub attributes: Vec<(String, Attribute)>,
    /// Variables. A coordinate comes before the variables that lie along it.
    pub entries: Vec<Entry>,
    units: Units,
}

/// A variable of a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name of the variable. A variable with the name of its only axis is the coordinate of that
    /// dimension.
    pub name: String,
    /// Names of the dimensions, the slowest first.
    pub axes: Vec<String>,
    /// Attributes of the variable, by name.
    pub attributes: Vec<(String, Attribute)>,
    /// Values, the last axis fastest.
    pub column: Column,
}

impl Dataset {
    /// An empty data set whose units have these labels.
    pub(crate) fn new(units: &Units) -> Self {
        Dataset { units: units.clone(), ..Dataset::default() }
    }

    /// A data set from its attributes and variables.
    pub fn of(attributes: Vec<(String, Attribute)>, entries: Vec<Entry>) -> Self {
        Dataset { attributes, entries, ..Dataset::default() }
    }

    /// The data set of a sweep.
    pub fn of_sweep(sweep: &Sweep) -> Self {
        let header = Provenance::of(&sweep.question.scenario);
        let mut dataset = Dataset::new(&header.units);
        let Ok(()) = sweep::write(&mut dataset, &header, sweep);
        dataset
    }

    /// The data set of a trade of this scenario.
    pub fn of_trade(scenario: &Scenario, trade: &Trade) -> Self {
        let header = Provenance::of(scenario);
        let mut dataset = Dataset::new(&header.units);
        let Ok(()) = trade::write(&mut dataset, &header, trade);
        dataset
    }

    /// The data set of a calibration.
    pub fn of_calibration(calibration: &StoredCalibration) -> Self {
        let mut dataset = Dataset::new(&calibration::units());
        let Ok(()) = calibration::write(&mut dataset, calibration);
        dataset
    }

    /// The data set of a forecast. `title` is one line, and `scenario_text` is the scenario as it
    /// was written.
    pub fn of_forecast(title: &str, scenario_text: &str, forecast: &Forecast) -> Self {
        let mut dataset = Dataset::new(&calibration::units());
        let Ok(()) = forecast::write(&mut dataset, title, scenario_text, forecast);
        dataset
    }

    /// The data set of synthetic measurements, with the true values that a calibration should find
    /// in them. `start` is the time stamp of t = 0.
    pub fn of_twin(start: &str, truth: &bearing::Values, twin: &Twin) -> Self {
        let mut dataset = Dataset::new(&calibration::units());
        let Ok(()) = twin::write(&mut dataset, start, truth, twin);
        dataset
    }

    /// The data set of a single path of an ensemble.
    pub fn of_replay(replay: &Replay) -> Self {
        let header = replay.provenance();
        let mut dataset = Dataset::new(&header.units);
        let Ok(()) = run::write_start(&mut dataset, &header);
        let Ok(()) = rows::tables(&Rows::from(&replay.block), header.bearing, |table| dataset.grow(&table));
        let Ok(()) = run::write_end(&mut dataset, &replay.block.totals.summary(), Status::Complete);
        dataset
    }

    /// Add the rows of single paths that another part of the run holds. Fails if a variable is
    /// missing there or has another type.
    pub fn append_rows(&mut self, part: &Dataset) -> Result<(), String> {
        let is_row = |entry: &&mut Entry| {
            entry.axes.first().is_some_and(|axis| ["path", "event", "trajectory"].contains(&axis.as_str()))
        };
        for entry in self.entries.iter_mut().filter(is_row) {
            let more = part.entry(&entry.name).ok_or_else(|| format!("{} is missing", entry.name))?;
            entry.column.append(&more.column).map_err(|()| format!("{} has another type", entry.name))?;
        }
        Ok(())
    }

    /// The trade in the data set. Fails if the data set is not that of a trade.
    pub fn trade(&self) -> Result<StoredTrade, String> {
        trade::read(self)
    }

    /// The sweep in the data set. Fails if the data set is not that of a sweep.
    pub fn sweep(&self) -> Result<StoredSweep, String> {
        sweep::read(self)
    }

    /// The calibration in the data set. Fails if the data set is not that of a calibration.
    pub fn calibration(&self) -> Result<StoredCalibration, String> {
        calibration::read(self)
    }

    /// The samples of a measured temperature, if there are any. Fails if they are not a valid
    /// series.
    pub fn series(&self) -> Result<Option<Arc<Series>>, String> {
        series::read(self)
    }

    /// The statistics of a run; `step` is the step of its scheme, if it has one. Fails if the data
    /// set is not that of a run.
    pub fn summary(&self, step: Option<f64>) -> Result<Summary, String> {
        match self.attribute("completed_paths") {
            Some(Attribute::Count(paths)) => summary::read(self, *paths, step),
            _ => Err("completed_paths is missing: this is not the data set of a run".into()),
        }
    }

    /// The variable with this name, if there is one.
    pub fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    /// The attribute of the data set with this name, if there is one.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|(of, _)| of == name).map(|(_, value)| value)
    }

    /// The lengths of the axes of a variable. A dimension without a coordinate, which is that of
    /// events, has the length of its variables.
    pub fn shape(&self, entry: &Entry) -> Vec<usize> {
        let known = |axis: &String| match *axis == entry.name {
            true => Some(entry.column.len()),
            false => self.entry(axis).map(|coordinate| coordinate.column.len()),
        };
        let lengths: Vec<Option<usize>> = entry.axes.iter().map(known).collect();
        let others: usize = lengths.iter().flatten().product();
        lengths
            .into_iter()
            .map(|length| length.unwrap_or(entry.column.len().checked_div(others).unwrap_or(0)))
            .collect()
    }

    /// The values of a variable of this type as an array with the shape of its axes. Nothing is
    /// copied. `None` if there is no such variable, or if its values have another type.
    pub fn array<'a, T>(&'a self, name: &str) -> Option<ArrayViewD<'a, T>>
    where
        &'a [T]: TryFrom<&'a Column>,
    {
        let entry = self.entry(name)?;
        let values = <&[T]>::try_from(&entry.column).ok()?;
        ArrayViewD::from_shape(self.shape(entry), values).ok()
    }

    /// Add rows to the variables of a table. Variables that are not there yet are created.
    pub(super) fn grow(&mut self, table: &RowTable) -> Result<(), Infallible> {
        for (variable, values) in table.variables {
            match self.entries.iter_mut().find(|entry| entry.name == variable.name) {
                Some(entry) => entry.column.extend(*values),
                None => self.begin(variable, *values),
            }
        }
        Ok(())
    }

    fn begin(&mut self, variable: &Described, values: ColumnView) {
        let attributes = attributes_of(variable, &self.units).into_iter();
        let attributes = attributes.map(|(name, value)| (name.to_owned(), value)).collect();
        let mut column = values.empty_column();
        column.extend(values);
        let axes = variable.axes.iter().map(|axis| axis.to_string()).collect();
        self.entries.push(Entry { name: variable.name.into(), axes, attributes, column });
    }
}

impl Destination for Dataset {
    type Error = Infallible;

    fn units(&self) -> &Units {
        &self.units
    }

    fn write_variable<'a>(
        &mut self,
        variable: &Described,
        values: impl Into<ColumnView<'a>>,
    ) -> Result<(), Self::Error> {
        let values = values.into();
        if values.len() > 0 {
            self.begin(variable, values);
        }
        Ok(())
    }

    fn set_attribute(&mut self, name: &str, value: impl Into<Attribute>) -> Result<(), Self::Error> {
        let value = value.into();
        match self.attributes.iter_mut().find(|(of, _)| of == name) {
            Some((_, earlier)) => *earlier = value,
            None => self.attributes.push((name.to_owned(), value)),
        }
        Ok(())
    }
}

impl Source for Dataset {
    type Error = String;

    fn column(&self, variable: &Described, _: ElementType) -> Result<Option<Column>, String> {
        let Some(entry) = self.entry(variable.name) else { return Ok(None) };
        let known = |axis: &&str| self.entry(axis).map(|coordinate| coordinate.column.len());
        let length = variable.axes.iter().map(known).product::<Option<usize>>();
        if length.is_some_and(|length| length != entry.column.len()) {
            return Err(format!("{} has another shape than its axes", variable.name));
        }
        if length.is_none() {
            return Err(format!("{} has values but no coordinate", variable.name));
        }
        Ok(Some(entry.column.clone()))
    }

    fn has(&self, name: &str) -> bool {
        self.entry(name).is_some()
    }

    fn attribute(&self, variable: Option<&str>, name: &str) -> Result<Option<Attribute>, String> {
        let of_entry = |variable| self.entry(variable).map(|entry| &entry.attributes);
        let attributes = variable.map_or(Some(&self.attributes), of_entry);
        let named = |attributes: &Vec<(String, Attribute)>| attributes.iter().find(|(of, _)| of == name).cloned();
        Ok(attributes.and_then(named).map(|(_, value)| value))
    }
}
