//! A run as a data set, except for the rows of single paths: what is known at its start, and what
//! is known at its end.

use super::{Destination, header, series, summary};
use crate::engine::{Provenance, Status};
use crate::stats::Summary;

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
