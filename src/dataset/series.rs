//! The samples of a measured temperature. They are part of a data set so that it is complete
//! without the file of the measurement.

use super::layout;
use super::{Dataset, Source, read_or_empty};
use crate::engine::Provenance;
use crate::model::Series;
use std::sync::Arc;

/// Write the samples, and the time stamp of t = 0 if they have time stamps.
pub(super) fn write(to: &mut Dataset, header: &Provenance) {
    let Some(series) = &header.series else { return };
    let stamp = header.series_start.as_deref().map(|stamp| [("start", stamp)]);
    let time = layout::SERIES_TIME.with(stamp.as_ref().map_or(&[], |stamp| stamp));
    to.write(&time, series.times());
    to.write(&layout::SERIES_TEMPERATURE, series.values());
}

/// The samples in a data set; none if it has no samples.
pub(crate) fn read(from: &dyn Source) -> Result<Option<Arc<Series>>, String> {
    let times: Vec<f64> = read_or_empty(from, &layout::SERIES_TIME)?;
    if times.is_empty() {
        return Ok(None);
    }
    let series = Series::new(times, read_or_empty(from, &layout::SERIES_TEMPERATURE)?);
    series.map(|series| Some(Arc::new(series))).map_err(|error| error.to_string())
}

impl Dataset {
    /// The samples of a measured temperature, if there are any. Fails if they are not a valid
    /// series.
    pub fn series(&self) -> Result<Option<Arc<Series>>, String> {
        read(self)
    }
}
