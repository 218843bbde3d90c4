//! Warnings about a measured temperature.

use crate::model::Model;
use crate::scenario::Measured;
use std::fmt;

/// The file of the series was not sound, and was repaired as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairedSeries {
    /// The name of the file.
    pub file: String,
    /// The repairs, in words.
    pub repairs: Vec<String>,
}

impl RepairedSeries {
    pub(super) fn due(measured: Option<&Measured>) -> Option<Self> {
        let Measured { file, repairs, .. } = measured.filter(|measured| !measured.repairs.is_empty())?;
        Some(RepairedSeries { file: file.clone(), repairs: repairs.clone() })
    }
}

impl fmt::Display for RepairedSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} was mended as it was read: {}", self.file, self.repairs.join("; "))
    }
}

/// Noise is added to a measured temperature, which already contains the weather.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseOverSeries;

impl NoiseOverSeries {
    pub(super) fn due(model: &Model) -> Option<Self> {
        let temperature = &model.temperature;
        (temperature.series.is_some() && temperature.is_random() && !temperature.is_pinned).then_some(NoiseOverSeries)
    }
}

impl fmt::Display for NoiseOverSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "the weather is counted twice: the measured temperature contains it, and the noise adds as much \
             again at every sample. Write `temperature.noise.pinned = true` to let the noise act between \
             samples only, leave out [temperature.noise], or take harmonics in place of [temperature.series]",
        )
    }
}
