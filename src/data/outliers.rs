//! Wrong samples: a few in a row that differ strongly from those around them.

/// Number of samples on each side that a sample is compared with. A change of level, as in a slip,
/// is not a spike, because such a sample agrees with the majority of its window.
const REACH: usize = 3;

/// A spike exceeds this many standard deviations of the usual differences from the median around a
/// value, and as many usual steps from one value to the next. The steps matter where values hardly
/// scatter: at the ends of a smooth record, the median lies two steps away.
const FAR: f64 = 8.0;

/// Which values are far from the median of those around them. `resolution` is the smallest
/// difference that the sensor shows; 0 if it is not known.
pub fn spikes(values: &[f64], resolution: f64) -> Vec<bool> {
    let off: Vec<f64> = (0..values.len()).map(|i| values[i] - median_around(values, i)).collect();
    let mut steps: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    // Values with a coarse resolution often equal their own median. These zeros are left out, since
    // they would make the spread zero.
    let moving: Vec<f64> = off.iter().copied().filter(|off| *off != 0.0).collect();
    let far = FAR * spread(&moving).max(spread(&off)).max(resolution).max(median(&mut steps));
    off.iter().map(|off| off.abs() > far).collect()
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
    let steps = median(&mut values.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>());
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
    1.482_602_218_505_602 * median(&mut values.iter().map(|value| (value - centre).abs()).collect::<Vec<_>>())
}
