//! Warnings about a measured temperature.

use super::case::Case;

/// The file of a series was repaired as it was read.
pub(super) fn repaired_series(case: &Case) -> Vec<String> {
    let repaired = case
        .scenario
        .written
        .measured
        .iter()
        .filter(|measured| !measured.repairs.is_empty());
    repaired
        .map(|of| format!("{}: {}", of.file, of.repairs.join("; ")))
        .collect()
}

/// Noise is added to a measured temperature, which already contains the weather.
pub(super) fn noise_over_series(case: &Case) -> Option<String> {
    let temperature = &case.scenario.model.temperature;
    (temperature.series.is_some() && temperature.is_random() && !temperature.is_pinned).then(|| {
        "the weather is counted twice: the measured temperature contains it, and the noise adds it again at \
         every sample. Set `temperature.noise.pinned = true` to let the noise act between samples only, \
         remove [temperature.noise], or use harmonics instead of [temperature.series]"
            .to_string()
    })
}
