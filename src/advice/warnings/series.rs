//! Warnings about a measured temperature.

use super::case::{Case, when};

/// The file of the series was not sound, and was repaired as it was read.
pub(super) fn repaired_series(case: &Case) -> Vec<String> {
    let Some(measured) = &case.scenario.measured else { return Vec::new() };
    when(!measured.repairs.is_empty(), || format!("{}, as it was read: {}", measured.file, measured.repairs.join("; ")))
}

/// Noise is added to a measured temperature, which already contains the weather.
pub(super) fn noise_over_series(case: &Case) -> Vec<String> {
    let temperature = &case.scenario.model.temperature;
    when(temperature.series.is_some() && temperature.is_random() && !temperature.is_pinned, || {
        "the weather is counted twice: the measured temperature contains it, and the noise adds as much \
         again at every sample. Write `temperature.noise.pinned = true` to let the noise act between \
         samples only, leave out [temperature.noise], or take harmonics in place of [temperature.series]"
            .to_string()
    })
}
