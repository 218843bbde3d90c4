//! Times at which a force is so short that a scheme whose steps follow from slower things would pass it
//! by.

/// The number of samples in which pulses are looked for: one that is shorter than their distance is
/// not seen.
const SAMPLES: usize = 1 << 14;

/// A pulse is higher than what is this share of the samples away on both sides.
const AWAY: usize = SAMPLES / 64;

/// How much higher, as a share of the range of the force.
const HIGHER: f64 = 1e-3;

/// With more than this number, the force oscillates, and is found by its rate.
const MOST: usize = 1000;

/// The peaks of pulses of a function of t from 0 to `end`, up or down, as far as samples show them.
pub(super) fn pulses(g: impl Fn(f64) -> f64, end: f64) -> Vec<f64> {
    let time = |i: usize| end * i as f64 / SAMPLES as f64;
    let values: Vec<f64> = (0..=SAMPLES).map(|i| g(time(i))).collect();
    let most = |sign: f64| values.iter().fold(f64::NEG_INFINITY, |most, value| most.max(sign * value));
    let higher = HIGHER * (most(1.0) + most(-1.0));
    let is_peak = |i: usize, sign: f64| {
        let above = |j: usize| sign * (values[i] - values[j]);
        let away = [i.saturating_sub(AWAY), (i + AWAY).min(SAMPLES)];
        above(i - 1) > 0.0 && above(i + 1) >= 0.0 && away.iter().all(|j| above(*j) > higher)
    };
    let peaks: Vec<f64> = (1..SAMPLES).filter(|i| is_peak(*i, 1.0) || is_peak(*i, -1.0)).map(time).collect();
    if peaks.len() > MOST { Vec::new() } else { peaks }
}
