//! The samples of a measured temperature. They are part of a data set so that it is complete
//! without the file of the measurement.

use super::layout;
use super::{Destination, Source, read_or_empty};
use crate::model::Series;
use std::sync::Arc;

/// Write the samples, and the time stamp of t = 0 if they have time stamps.
pub(crate) fn write<D: Destination>(to: &mut D, series: &Series, start: Option<&str>) -> Result<(), D::Error> {
    let stamp = start.map(|stamp| [("start", stamp)]);
    let time = layout::SERIES_TIME.with(stamp.as_ref().map_or(&[], |stamp| stamp));
    to.write_variable(&time, series.times())?;
    to.write_variable(&layout::SERIES_TEMPERATURE, series.values())
}

/// The samples in a data set; none if it has no samples.
pub(crate) fn read<S: Source>(from: &S) -> Result<Option<Arc<Series>>, S::Error> {
    let times: Vec<f64> = read_or_empty(from, &layout::SERIES_TIME)?;
    if times.is_empty() {
        return Ok(None);
    }
    let series = Series::new(times, read_or_empty(from, &layout::SERIES_TEMPERATURE)?);
    series.map(|series| Some(Arc::new(series))).map_err(|error| error.to_string().into())
}
