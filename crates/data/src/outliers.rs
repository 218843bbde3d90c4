//! Outliers. They are kept unless the layout says otherwise.

/// Number of samples on each side that a sample is compared with. A change of level, as in a slip,
/// is not a spike, because such a sample agrees with the majority of its window.
const REACH: usize = 3;

/// The smallest number of samples in which spikes are detected.
const LEAST: usize = 30;

/// The smallest number of values in which one can be apart from all others.
const FEWEST: usize = 10;

/// A value stands out if it exceeds this many standard deviations, unless another number is given.
const USUAL: u64 = 8;

/// The values that differ from the local median by more than `far` standard deviations of such
/// differences, and by more than `far` usual steps from one value to the next. The steps matter
/// where values hardly scatter: at the ends of a smooth record, the median lies two steps away.
pub(super) fn spikes(values: &[f64], far: u64) -> Vec<bool> {
    if values.len() < LEAST {
        return vec![false; values.len()];
    }
    let off: Vec<f64> = (0..values.len())
        .map(|i| values[i] - median_around(values, i))
        .collect();
    let mut steps: Vec<f64> = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    // Values with a coarse resolution often equal their own median. These zeros are left out, since
    // they would make the spread zero.
    let moving: Vec<f64> = off.iter().copied().filter(|off| *off != 0.0).collect();
    let usual = spread(&moving)
        .max(spread(&off))
        .max(resolution(values))
        .max(median(&mut steps));
    off.iter()
        .map(|off| off.abs() > far as f64 * usual)
        .collect()
}

/// The most extreme outlier, and the number of outliers: spikes, or a lowest or highest value that
/// is farther from all others than they are from each other, like a mark of missing values.
pub(super) fn odd(values: &[f64]) -> Option<(f64, usize)> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.get(values.len() / 2)?;
    let mut levels = sorted.clone();
    levels.dedup();
    let n = levels.len();
    let is_apart = |value: f64| {
        values.len() >= FEWEST
            && n > 2
            && (value == levels[0] && levels[1] - levels[0] > levels[n - 1] - levels[1]
                || value == levels[n - 1]
                    && levels[n - 1] - levels[n - 2] > levels[n - 2] - levels[0])
    };
    let odd = values
        .iter()
        .zip(spikes(values, USUAL))
        .filter(|(value, spike)| *spike || is_apart(**value));
    let odd: Vec<f64> = odd.map(|(value, _)| *value).collect();
    let farthest = odd
        .iter()
        .copied()
        .max_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()))?;
    Some((farthest, odd.len()))
}

/// The median of the values around one of them.
fn median_around(values: &[f64], i: usize) -> f64 {
    let around = &values[i.saturating_sub(REACH)..(i + REACH + 1).min(values.len())];
    let mut window = [0.0; 2 * REACH + 1];
    let window = &mut window[..around.len()];
    window.copy_from_slice(around);
    median(window)
}

/// The resolution of a sensor: the median distance of neighbouring values that it shows.
pub fn resolution(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let steps = median(
        &mut values
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect::<Vec<_>>(),
    );
    if steps.is_finite() { steps } else { 0.0 }
}

/// The median; of an even number of values, the upper of the middle two. NaN for no values.
pub fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// A robust standard deviation: that of a normal distribution with the same median distance from
/// the median.
pub fn spread(values: &[f64]) -> f64 {
    let centre = median(&mut values.to_vec());
    1.482_602_218_505_602
        * median(
            &mut values
                .iter()
                .map(|value| (value - centre).abs())
                .collect::<Vec<_>>(),
        )
}
