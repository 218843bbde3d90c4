//! The samples of a measured temperature, so that a file says by itself what was run.

use super::layout;
use super::variable::{Place, read_or_empty, write_text};
use crate::model::Series;
use hdf5::{File, Result};
use std::sync::Arc;

/// Write the samples, and the stamp of t = 0 if they have stamps.
pub(super) fn write(place: &Place, series: &Series, start: Option<&str>) -> Result<()> {
    place.put(&layout::SERIES_TIME, series.times())?;
    place.put(&layout::SERIES_TEMPERATURE, series.values())?;
    match start {
        Some(stamp) => write_text(&*place.file.dataset(layout::SERIES_TIME.name)?, "start", stamp),
        None => Ok(()),
    }
}

/// The samples in a file; none where it has none.
pub(super) fn read(file: &File) -> Result<Option<Arc<Series>>> {
    let times: Vec<f64> = read_or_empty(file, &layout::SERIES_TIME)?;
    if times.is_empty() {
        return Ok(None);
    }
    let series = Series::new(times, read_or_empty(file, &layout::SERIES_TEMPERATURE)?);
    series.map(|series| Some(Arc::new(series))).map_err(|error| error.to_string().into())
}
