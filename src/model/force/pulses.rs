//! Times of short pulses of a force that the steps of a scheme would miss.

/// The samples in each of the first steps. From there on, whenever the time doubles, there are half
/// as many, so that the samples of a run are those of any longer one.
const IN_STEP: u64 = 4096;

/// The number of these steps.
const FIRST: u64 = 8;

/// A difference that is this share of both numbers is rounding.
const ROUNDING: f64 = 1e-9;

/// A resolved peak falls four times as far in two steps as in one, and a pulse hardly farther.
const LEVEL: f64 = 2.0;

/// The peaks, up or down, of pulses of a function of t that are shorter than a step, from 0 to
/// `end`. The samples lie at parts of the step.
pub(super) fn pulses(g: impl Fn(f64) -> f64, end: f64, step: f64) -> Vec<f64> {
    let mut found = Vec::new();
    let (mut from, mut to, mut parts) = (0, FIRST, IN_STEP);
    while parts >= 2 && from as f64 * step < end {
        let time = |i: u64| step * (i as f64 / parts as f64);
        let value = |i: Option<u64>| i.map_or(f64::NAN, |i| g(time(i)));
        let is_pulse = |i: u64, [last, here, next]: [f64; 3], sign: f64| {
            let above = |other: f64| sign * (here - other);
            // Where there is nothing on one side, the other one decides.
            let is_level = |one: f64, two: f64| {
                let is_peak = above(one) > ROUNDING * (here.abs() + one.abs());
                (!two.is_nan()).then(|| is_peak && above(two) < LEVEL * above(one))
            };
            let are_level = || {
                let before = [1, 2].map(|n| value(i.checked_sub(n * parts)));
                let behind = [1, 2].map(|n| value(Some(i + n * parts)));
                let sides = [before, behind].map(|[one, two]| is_level(one, two));
                sides.contains(&Some(true)) && !sides.contains(&Some(false))
            };
            above(last) > 0.0 && above(next) >= 0.0 && are_level()
        };
        let first = from * parts;
        let mut values = [first.checked_sub(1), Some(first), Some(first + 1)].map(value);
        for i in (first..to * parts).take_while(|i| time(*i) <= end) {
            if [1.0, -1.0]
                .into_iter()
                .any(|sign| is_pulse(i, values, sign))
            {
                found.push(time(i));
            }
            values = [values[1], values[2], value(Some(i + 2))];
        }
        (from, to, parts) = (to, 2 * to, parts / 2);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trapezium, up or down, that is shorter than a step: rising from 4.31 to 4.33, level until
    /// 4.36, zero again at 4.37. Its top is one pulse.
    #[test]
    fn a_flat_topped_pulse_is_found_once_in_its_top() {
        let trapezium = |t: f64| ((t - 4.31) / 0.02).min((4.37 - t) / 0.01).clamp(0.0, 1.0);
        for sign in [1.0, -1.0] {
            let found = pulses(|t| 7.0 + sign * trapezium(t), 10.0, 1.0);
            assert!(
                matches!(found[..], [t] if (4.33..=4.36).contains(&t)),
                "{sign}: {found:?}"
            );
        }
    }
}
