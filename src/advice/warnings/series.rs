//! Warnings about a measured temperature.

use super::case::Case;
use crate::model::{PulseShape, RandomInput, RandomProcess};
use stickslip_text::numbers::short;

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

/// The most changes of a process in a step that resolves it.
const RESOLVED: f64 = 0.25;

/// The samples of a process are too far apart for it, or the step of the scheme passes its pulses by.
pub(super) fn coarse_process(case: &Case) -> Vec<String> {
    let coarse = |RandomInput {
                      name,
                      process,
                      step,
                      ..
                  }: &RandomInput| {
        let too_long = |step: f64, rate: f64| step * rate > RESOLVED;
        let limit = |rate: f64| short(RESOLVED / rate);
        if let Some(rate) = process.fastest_rate().filter(|rate| too_long(*step, *rate)) {
            return Some(format!(
                "`{name}.step` = {} is long for the process, which changes within {}: its samples lose \
                 variance between them. Use {} or less",
                short(*step),
                short(1.0 / rate),
                limit(rate)
            ));
        }
        let rate = match process {
            RandomProcess::Telegraph { rates, .. } => rates[0].max(rates[1]),
            RandomProcess::Shot {
                shape: PulseShape::Rectangle(duration),
                ..
            } => 1.0 / duration,
            RandomProcess::Shot { rate, .. } => *rate,
            _ => return None,
        };
        let h = case.step.filter(|h| too_long(*h, rate))?;
        Some(format!(
            "time.step = {} is long for `{name}`, which changes within {}: the scheme sees it only once a \
             step. Use {} or less, or `scheme.kind = \"event-driven\"`, whose times are exact",
            short(h),
            short(1.0 / rate),
            limit(rate)
        ))
    };
    let random = &case.scenario.model.random;
    random.iter().filter_map(coarse).collect()
}

/// A spectrum gives realisations that repeat themselves before the end.
pub(super) fn repeats(case: &Case) -> Vec<String> {
    let end = case.scenario.time.end;
    let repeats = |RandomInput { name, process, .. }: &RandomInput| match process {
        RandomProcess::Spectrum(spectrum) if spectrum.repeats_after() < end => Some(format!(
            "`{name}` repeats itself after {}, before time.end = {}: the frequencies of its spectrum are \
             too far apart. Give them at distances below {}",
            short(spectrum.repeats_after()),
            short(end),
            short(1.0 / end)
        )),
        _ => None,
    };
    let random = &case.scenario.model.random;
    random.iter().filter_map(repeats).collect()
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
