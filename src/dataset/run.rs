//! A run as a data set, except for the rows of single paths: what is written at its start, and at
//! its end.

use super::{
    Column, Dataset, Source, header, layout, read_attribute, read_or_empty, series, summary,
};
use crate::engine::{Outcome, Part, Provenance, Replay, Status};
use crate::stats::{Record, Summary};
use ndarray::ArrayD;
use std::path::PathBuf;

/// The header and the statistics of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredRun {
    /// Where its numbers come from.
    pub header: Provenance,
    /// How the run ended. For an unfinished run it says whether the run is running or was
    /// interrupted.
    pub status: Status,
    /// Which part of a run this is, if it is one.
    pub part: Option<Part>,
    /// What ended the run before its last path, such as a goal or a limit, if anything did.
    pub ended_by: Option<String>,
    /// The file that the run was to write, if the run is not finished and no process is running it.
    pub unfinished: Option<PathBuf>,
    /// Number of its paths.
    pub completed_paths: u64,
    /// Statistics of these paths.
    pub summary: Summary,
}

impl StoredRun {
    /// Read what was written of a run.
    pub fn read(from: &dyn Source) -> Result<Self, String> {
        let (status, completed_paths) = header::read_progress(from)?;
        let header = header::read(
            from,
            read_or_empty(from, &layout::TIME)?,
            series::read(from)?,
        )?;
        let summary = summary::read(from, completed_paths, header.step)?;
        let (ended_by, part) = (read_attribute(from, "ended_by")?, header::read_part(from)?);
        Ok(StoredRun {
            header,
            status,
            part,
            ended_by,
            unfinished: None,
            completed_paths,
            summary,
        })
    }
}

/// The provenance of the run, the coordinates, and the variables of single paths, without rows.
pub fn start(header: &Provenance, record: &Record) -> Dataset {
    let mut dataset = Dataset::new(&header.units);
    header::write(&mut dataset, header);
    summary::write_coordinates(&mut dataset, &header.time);
    series::write(&mut dataset, header);
    dataset.grow(Dataset::without_rows(record, header));
    dataset
}

/// Write the statistics of the run and how it ended.
pub fn write_end(to: &mut Dataset, summary: &Summary, status: Status) {
    summary::write(to, summary);
    header::write_end(
        to,
        summary.completed_paths,
        summary.diverged.len() as u64,
        status,
    );
}

impl Dataset {
    /// The data set of a single path of an ensemble.
    pub fn of_replay(replay: &Replay) -> Self {
        let header = replay.provenance();
        let mut dataset = start(&header, &replay.record);
        dataset.grow(Dataset::of_rows(
            &replay.block.rows,
            &header.units,
            header.bearing,
        ));
        write_end(
            &mut dataset,
            &replay.block.totals.summary(),
            Status::Complete,
        );
        dataset
    }
}

impl Outcome {
    /// The statistics of the run as named variables with axes, units and intervals, as a file has
    /// them. A [`super::Recorder`] keeps what single paths record, too.
    pub fn dataset(&self) -> Dataset {
        let mut dataset = Dataset::new(&self.units);
        summary::write_coordinates(&mut dataset, &self.summary.bands.time);
        write_end(&mut dataset, &self.summary, self.status);
        dataset
    }

    /// The numbers of one of these variables, such as `displacement_mean` along `time`. Every call
    /// makes the data set; for several variables, make it once and call [`Dataset::array`].
    ///
    /// ```
    /// use stickslip::prelude::*;
    ///
    /// let problem = Problem::oscillator(1.0, 1.0)
    ///     .dilatation(6.0)
    ///     .friction(1.2, 1.0)
    ///     .temperature(Temperature::harmonic(1.0, 0.25).with(OrnsteinUhlenbeck::new(0.25, 1.0, 1.0)));
    /// let run = Run::new(problem).paths(256).end(20.0).simulate()?;
    /// let [time, mean, quantiles] =
    ///     ["time", "displacement_mean", "displacement_quantile"].map(|name| run.array(name));
    /// let (time, mean, quantiles) = (time?, mean?, quantiles?);
    /// assert_eq!((time.len(), mean[0]), (mean.len(), 0.0));
    /// assert_eq!(quantiles.shape(), [5, time.len()]);
    /// let dataset = run.dataset();
    /// let entry = dataset.entry("displacement_mean").expect("it has this variable");
    /// assert_eq!(entry.axes, ["time"]);
    /// assert!(run.array("statistic").is_err(), "texts");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`NoVariable`] if there is no variable of this name, or if its values are texts.
    pub fn array(&self, name: &str) -> Result<ArrayD<f64>, NoVariable> {
        let dataset = self.dataset();
        let entry = dataset.entry(name);
        let values = entry.and_then(|entry| Some((dataset.shape(entry), numbers(&entry.column)?)));
        values
            .and_then(|(shape, values)| ArrayD::from_shape_vec(shape, values).ok())
            .ok_or_else(|| NoVariable {
                name: name.into(),
                known: dataset
                    .entries
                    .iter()
                    .map(|entry| entry.name.clone())
                    .collect(),
            })
    }
}

/// No numbers have this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no variable of numbers is called `{name}`; the variables are {}", known.join(", "))]
pub struct NoVariable {
    /// The name.
    pub name: String,
    /// The names of all variables.
    pub known: Vec<String>,
}

fn numbers(column: &Column) -> Option<Vec<f64>> {
    Some(match column {
        Column::F64(values) => values.clone(),
        Column::U64(values) => values.iter().map(|value| *value as f64).collect(),
        Column::U32(values) => values.iter().copied().map(f64::from).collect(),
        Column::U8(values) => values.iter().copied().map(f64::from).collect(),
        Column::I8(values) => values.iter().copied().map(f64::from).collect(),
        Column::Text(_) => return None,
    })
}
