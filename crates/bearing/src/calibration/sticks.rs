//! The samples between slips, and their means in bins.

use super::level::Bin;
use super::samples::{HOUR, Samples, stretches};
use std::ops::Range;

/// The segments of samples without a gap and without a jump. `jumps` are the indices of first
/// samples after a jump.
pub fn sticks(samples: &Samples, jumps: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut starts: Vec<usize> = samples.starts.iter().copied().chain(jumps).collect();
    starts.sort_unstable();
    starts.dedup();
    stretches(&starts, samples.times.len()).collect()
}

/// Bins of this many seconds. The `margin` samples at both ends of each stick are left out, so that
/// a jump detected a sample too early or too late is not in them.
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

/// The mean of these samples.
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

/// The lengths of bins that may be chosen, in hours.
const BINS: [f64; 4] = [1.0, 2.0, 3.0, 6.0];

/// The shortest length of bins, in seconds, in which the temperature changes by three divisions of
/// the thermometer. With smaller changes, errors of T would make the slope too small.
pub fn bin_length(samples: &Samples, resolution: f64) -> f64 {
    let moves = |hours: f64| {
        let t = &samples.temperatures;
        let pairs = samples.pairs(samples.intervals(hours * HOUR).max(1));
        let [sum, count] = pairs.fold([0.0; 2], |[sum, count], [i, j]| {
            [sum + (t[j] - t[i]).powi(2), count + 1.0]
        });
        (sum / count).sqrt() >= 3.0 * resolution
    };
    HOUR * BINS
        .into_iter()
        .find(|hours| moves(*hours))
        .unwrap_or(BINS[3])
}
