//! Times of short pulses of a force that the steps of a scheme would miss.

/// The maximum number of samples in the search for pulses; shorter ones are missed.
const MOST: f64 = 32_768.0;

/// The maximum number of samples in a step.
const IN_STEP: f64 = 4096.0;

/// A difference that is this share of both numbers is rounding.
const ROUNDING: f64 = 1e-9;

/// A resolved peak falls four times as far in two steps as in one, and a pulse hardly farther.
const LEVEL: f64 = 2.0;

/// The peaks, up or down, of pulses of a function of t that are shorter than a step, from 0 to
/// `end`. The samples lie at parts of the step, so that those of a shorter run are some of them.
pub(super) fn pulses(g: impl Fn(f64) -> f64, end: f64, step: f64) -> Vec<f64> {
    let parts = (MOST * step / end).min(IN_STEP);
    if !(parts >= 2.0 && end > 0.0) {
        return Vec::new();
    }
    let parts = 2usize.pow(libm::log2(parts) as u32);
    let time = |i: usize| step * (i as f64 / parts as f64);
    let values: Vec<f64> = (0..)
        .map(time)
        .take_while(|time| *time <= end)
        .map(g)
        .collect();
    let at = |i: Option<usize>| i.and_then(|i| values.get(i)).copied().unwrap_or(f64::NAN);
    let is_pulse = |i: usize, sign: f64| {
        let above = |j: Option<usize>| sign * (values[i] - at(j));
        // Next to the ends of the run, one side decides.
        let is_level = |one: Option<usize>, two: Option<usize>| {
            let is_peak = above(one) > ROUNDING * (values[i].abs() + at(one).abs());
            (!at(two).is_nan()).then(|| is_peak && above(two) < LEVEL * above(one))
        };
        let sides = [
            is_level(i.checked_sub(parts), i.checked_sub(2 * parts)),
            is_level(Some(i + parts), Some(i + 2 * parts)),
        ];
        above(i.checked_sub(1)) > 0.0
            && above(Some(i + 1)) >= 0.0
            && sides.contains(&Some(true))
            && !sides.contains(&Some(false))
    };
    (0..values.len())
        .filter(|i| is_pulse(*i, 1.0) || is_pulse(*i, -1.0))
        .map(time)
        .collect()
}
