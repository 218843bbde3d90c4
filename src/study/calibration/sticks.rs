//! The samples between slips, taken together in bins.

use super::level::Bin;
use super::samples::{HOUR, Samples};
use std::ops::Range;

/// The stretches of samples without a gap and without a jump; `jumps` are first samples after one.
pub fn sticks(samples: &Samples, jumps: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut starts: Vec<usize> = samples.starts.iter().copied().chain(jumps).collect();
    starts.sort_unstable();
    starts.dedup();
    let ends = starts.iter().skip(1).copied().chain([samples.times.len()]);
    starts.iter().copied().zip(ends).map(|(start, end)| start..end).collect()
}

/// Bins of so many seconds, the `margin` samples next to the ends of each stick left out: a jump
/// that was found a sample too early or too late is not in them.
pub fn bins(samples: &Samples, sticks: &[Range<usize>], seconds: f64, margin: usize) -> Vec<Bin> {
    let mut bins = Vec::new();
    for stick in sticks {
        let (mut i, end) = (stick.start + margin, stick.end.saturating_sub(margin));
        let mut is_first = true;
        while i < end {
            let from = i;
            while i < end && samples.times[i] < samples.times[from] + seconds {
                i += 1;
            }
            bins.push(bin(samples, from..i, is_first));
            is_first = false;
        }
    }
    bins
}

/// These samples together.
pub fn bin(samples: &Samples, range: Range<usize>, is_first: bool) -> Bin {
    let count = range.len() as f64;
    let mean = |values: &[f64]| values[range.clone()].iter().sum::<f64>() / count;
    Bin {
        time: mean(&samples.times),
        temperature: mean(&samples.temperatures),
        reading: mean(&samples.readings),
        count,
        is_first,
    }
}

/// Lengths of bins to choose from, in hours.
const BINS: [f64; 4] = [1.0, 2.0, 3.0, 6.0];

/// Long enough for the temperature to move by three divisions of the thermometer: an error of T
/// makes a slope too flat.
pub fn bin_length(samples: &Samples, resolution: f64) -> f64 {
    let moves = |hours: f64| {
        let step = ((hours * HOUR / samples.interval()).round() as usize).max(1);
        let t = &samples.temperatures;
        let ends = samples.stretches().flat_map(|stretch| stretch.start + step..stretch.end);
        let [sum, count] = ends.fold([0.0; 2], |[sum, count], i| [sum + (t[i] - t[i - step]).powi(2), count + 1.0]);
        (sum / count).sqrt() >= 3.0 * resolution
    };
    HOUR * BINS.into_iter().find(|hours| moves(*hours)).unwrap_or(BINS[3])
}
