//! A run as a data set, except for the rows of single paths: what is known at its start, and what
//! is known at its end.

use super::{Destination, Source, header, layout, read_or_empty, series, summary};
use crate::engine::{Part, Provenance, Status};
use crate::stats::Summary;
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
    pub(crate) fn read<S: Source>(from: &S) -> Result<Self, S::Error> {
        let (status, completed_paths) = header::read_progress(from)?;
        let header = header::read(from, read_or_empty(from, &layout::TIME)?, series::read(from)?)?;
        let summary = summary::read(from, completed_paths, header.step)?;
        let (ended_by, part) = (header::read_ended_by(from)?, header::read_part(from)?);
        Ok(StoredRun { header, status, part, ended_by, unfinished: None, completed_paths, summary })
    }
}

/// Write where the numbers of the run come from, and the coordinates.
pub(crate) fn write_start<D: Destination>(to: &mut D, header: &Provenance) -> Result<(), D::Error> {
    header::write(to, header)?;
    summary::write_coordinates(to, &header.time)?;
    match &header.series {
        Some(samples) => series::write(to, samples, header.series_start.as_deref()),
        None => Ok(()),
    }
}

/// Write the statistics of the run and how it ended.
pub(crate) fn write_end<D: Destination>(to: &mut D, summary: &Summary, status: Status) -> Result<(), D::Error> {
    summary::write(to, summary)?;
    header::write_end(to, summary.completed_paths, summary.diverged.len() as u64, status)
}
