//! A run as a data set, except for the rows of single paths: what is written at its start, and at
//! its end.

use super::{Dataset, Source, header, layout, read_attribute, read_or_empty, series, summary};
use std::path::PathBuf;
use stickslip::engine::{Part, Provenance, Replay, Status};
use stickslip::stats::{Record, Summary};

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
    pub(crate) fn read(from: &dyn Source) -> Result<Self, String> {
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
pub(crate) fn start(header: &Provenance, record: &Record) -> Dataset {
    let mut dataset = Dataset::new(&header.units);
    header::write(&mut dataset, header);
    summary::write_coordinates(&mut dataset, &header.time);
    series::write(&mut dataset, header);
    dataset.grow(Dataset::without_rows(record, header));
    dataset
}

/// Write the statistics of the run and how it ended.
pub(crate) fn write_end(to: &mut Dataset, summary: &Summary, status: Status) {
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
