//! A first search for slips: jumps of z that the temperature does not explain. It does not use the
//! parameters of the bearing.

use super::samples::{HOUR, Samples, median, spread};
use crate::moments::{correlation, variance};

/// A jump between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The index of the first sample after it.
    pub index: usize,
    /// Its size with its sign, in the unit of displacement.
    pub size: f64,
}

/// The detected jumps.
#[derive(Clone, Debug, PartialEq)]
pub struct Jumps {
    /// The jumps in order of time.
    pub jumps: Vec<Jump>,
    /// Number of samples on each side over which means are taken.
    pub window: usize,
    /// The size of a typical jump divided by the standard deviation of the noise.
    pub contrast: f64,
}

impl Jumps {
    /// The indices of the samples after the jumps.
    pub fn indices(&self) -> impl Iterator<Item = usize> {
        self.jumps.iter().map(|jump| jump.index)
    }
}

/// The windows that are tried, in samples.
const WINDOWS: [usize; 9] = [1, 2, 3, 4, 6, 9, 12, 18, 24];

/// The longest window, in seconds.
const LONGEST: f64 = 3.0 * HOUR;

/// A jump must exceed this many standard deviations of the noise.
const SIGNIFICANT: f64 = 4.5;

/// The contrast above which no longer window is tried, because it would only merge neighbouring
/// jumps.
const CLEAR: f64 = 8.0;

/// A jump must have at least this fraction of the typical size.
const SHARE: f64 = 0.35;

/// Find the jumps of z - still T: the peaks of the difference between the means over a window on
/// each side. The window is the shortest in which jumps clearly exceed the noise.
pub fn jumps(samples: &Samples, still: f64) -> Jumps {
    let rest: Vec<f64> = samples
        .readings
        .iter()
        .zip(&samples.temperatures)
        .map(|(z, t)| z - still * t)
        .collect();
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(rest.iter().scan(0.0, |sum, y| {
            *sum += y;
            Some(*sum)
        }))
        .collect();
    let interval = samples.interval();
    let mut best: Option<Jumps> = None;
    for window in WINDOWS
        .into_iter()
        .filter(|window| *window == 1 || *window as f64 * interval <= LONGEST)
    {
        let found = with_window(samples, &sums, window);
        if best
            .as_ref()
            .is_none_or(|best| found.contrast > best.contrast)
        {
            best = Some(found);
        }
        if best.as_ref().is_some_and(|best| best.contrast >= CLEAR) {
            break;
        }
    }
    best.unwrap_or(Jumps {
        jumps: Vec::new(),
        window: 1,
        contrast: 0.0,
    })
}

fn with_window(samples: &Samples, sums: &[f64], window: usize) -> Jumps {
    let n = samples.times.len();
    let mut steps = vec![f64::NAN; n];
    for stretch in samples.stretches() {
        for i in stretch.start + window..(stretch.end + 1).saturating_sub(window) {
            steps[i] = (sums[i + window] - 2.0 * sums[i] + sums[i - window]) / window as f64;
        }
    }
    let known: Vec<f64> = steps
        .iter()
        .copied()
        .filter(|step| step.is_finite())
        .collect();
    let noise = spread(&known);
    let is_peak = |i: usize, least: f64| {
        let height = steps[i].abs();
        let around = i.saturating_sub(window)..(i + window + 1).min(n);
        height >= least
            && around.into_iter().all(|j| {
                let other = steps[j].abs();
                other.is_nan() || j == i || other < height || (other == height && j > i)
            })
    };
    let peaks = |least: f64| -> Vec<Jump> {
        (0..n)
            .filter(|i| is_peak(*i, least))
            .map(|index| Jump {
                index,
                size: steps[index],
            })
            .collect()
    };
    let significant = peaks(SIGNIFICANT * noise);
    let usual = median(
        &mut significant
            .iter()
            .map(|jump| jump.size.abs())
            .collect::<Vec<_>>(),
    );
    if usual.is_nan() {
        return Jumps {
            jumps: Vec::new(),
            window,
            contrast: 0.0,
        };
    }
    let jumps = significant
        .into_iter()
        .filter(|jump| jump.size.abs() >= SHARE * usual)
        .collect();
    Jumps {
        jumps,
        window,
        contrast: usual / noise,
    }
}

/// The correlation of increments over an hour above which z follows T.
const FOLLOWS: f64 = 0.9;

/// The slope of z against T, if z follows T from hour to hour.
pub fn freely(samples: &Samples) -> Option<f64> {
    let rise = |values: &[f64]| -> Vec<f64> {
        let pairs = samples.pairs(samples.intervals(HOUR).max(1));
        pairs.map(|[i, j]| values[j] - values[i]).collect()
    };
    let [t, z] = [rise(&samples.temperatures), rise(&samples.readings)];
    let correlation = correlation(&t, &z);
    (correlation > FOLLOWS).then(|| correlation * (variance(&z) / variance(&t)).sqrt())
}

/// An estimate of `still` before any slip is known, from increments over one hour. Large residuals
/// are left out, because they may contain a slip.
pub fn trimmed_slope(samples: &Samples) -> f64 {
    let Samples {
        temperatures: t,
        readings: z,
        ..
    } = samples;
    let pairs = samples.pairs(samples.intervals(HOUR).max(1));
    let pairs: Vec<[f64; 2]> = pairs.map(|[i, j]| [t[j] - t[i], z[j] - z[i]]).collect();
    let mut slope = 0.0;
    for _ in 0..20 {
        let off = |[t, z]: &[f64; 2]| (z - slope * t).abs();
        let far = 2.0 * median(&mut pairs.iter().map(off).collect::<Vec<_>>());
        let kept = pairs.iter().filter(|pair| off(pair) <= far);
        let [tt, tz] = kept.fold([0.0; 2], |[tt, tz], [t, z]| [tt + t * t, tz + t * z]);
        slope = if tt > 0.0 { tz / tt } else { 0.0 };
    }
    slope
}
