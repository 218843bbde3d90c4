//! The temperature underlying its samples: without the noise of the thermometer, within the
//! averaging time of a sample, and between samples that are far apart compared with its correlation
//! time.

use super::kalman::Shape;
use super::periods::usual;
use super::search::ProcessSearch;
use super::smoother::{Smoother, WeatherNode};
use stickslip::noise::Stream;

/// A temperature known only by samples, on a fine grid of times.
pub struct HiddenTemperature {
    /// Times, in seconds.
    pub times: Vec<f64>,
    /// The variance that it gains, in K^2/s.
    pub roughness: f64,
    /// The standard deviation of the noise of the thermometer, in kelvin.
    pub white: f64,
    nodes: Vec<WeatherNode>,
    smoother: Smoother,
    /// The mean and the harmonics at each node, and at each sample.
    waves: [Vec<f64>; 2],
}

/// The maximum number of samples for estimating the shape, which takes a third of a second, and the
/// length of the segments from which they are taken.
const MOST: usize = 12_000;
const SEGMENT: usize = 400;

/// White noise has to lower the deviance by this much, which happens by chance in one of 200
/// records without noise (chi^2 with one degree of freedom, on one side).
const CLEAR: f64 = 6.6;

/// The longest step between nodes as a share of the shortest correlation time.
const SHARE: f64 = 0.1;

/// White noise matters if it exceeds this fraction of the standard deviation that the temperature
/// gains from one sample to the next.
const NOISY: f64 = 0.15;

/// Times that are closer than this are the same, in seconds.
const SAME: f64 = 1e-3;

/// The maximum number of parts of the time between two samples.
const PARTS: f64 = 12.0;

/// The shape of the temperature of these samples, and its largest relevant rate.
fn shape([times, temperatures]: [&[f64]; 2], interval: f64, window: f64) -> Option<(Shape, f64)> {
    let every = times.len().div_ceil(MOST);
    let taken = |values: &[f64]| -> Vec<f64> {
        let segments = values.chunks(SEGMENT).step_by(every);
        segments.flatten().copied().collect()
    };
    let (some, values) = (taken(times), taken(temperatures));
    let periods = usual(&some).0;
    let search = ProcessSearch::new([&some, &values], &periods, 2, false, window);
    let mut shape = search.scaled(&search.rough(None, CLEAR)?)?;
    shape.processes.retain(|(_, variance)| *variance > 1e-6);
    // A process that decorrelates from one sample to the next is noise.
    if window == 0.0 && shape.processes.len() > 1 {
        let forgotten = |(rate, _): &&(f64, f64)| rate * interval > 1.0;
        shape.white += shape
            .processes
            .iter()
            .filter(forgotten)
            .map(|(_, v)| v)
            .sum::<f64>();
        shape.processes.retain(|process| !forgotten(&process));
    }
    let rates = shape.processes.iter().map(|(rate, _)| *rate);
    let fastest = rates.fold(0.0, f64::max);
    (fastest > 0.0).then_some((shape, fastest))
}

impl HiddenTemperature {
    /// The temperature of these samples, given as times and values, each `interval` seconds after the
    /// one before and a mean over `window` seconds around its time, at the times `wanted` as well and
    /// in steps of at most `step` seconds. `None` if the samples show it directly, as a diffusion
    /// sampled at these times without noise.
    pub fn new(
        [times, temperatures]: [&[f64]; 2],
        wanted: &[f64],
        [interval, window, step]: [f64; 3],
    ) -> Option<Self> {
        let (mut shape, fastest) = shape([times, temperatures], interval, window)?;
        let gained = |(rate, variance): &(f64, f64)| 2.0 * rate * variance;
        let roughness: f64 = shape.processes.iter().map(gained).sum();
        let is_noisy = shape.white > NOISY * NOISY * roughness * interval;
        if !(window > 0.0 || is_noisy || fastest * interval > SHARE || wanted != times) {
            return None;
        }
        let periods = usual(times).0;
        let search = ProcessSearch::new([times, temperatures], &periods, 2, false, window);
        let step = (SHARE / fastest).max(interval / PARTS).min(step);
        let nodes = nodes([times, search.left()], wanted, window, step);
        shape.smoothing = 0.0;
        shape.window = window;
        let at_samples = temperatures
            .iter()
            .zip(search.left())
            .map(|(t, left)| t - left);
        Some(HiddenTemperature {
            times: nodes.iter().map(|node| node.time).collect(),
            roughness,
            white: if is_noisy { shape.white.sqrt() } else { 0.0 },
            smoother: Smoother::new(&shape, &nodes),
            waves: [
                nodes.iter().map(|node| search.wave(node.time)).collect(),
                at_samples.collect(),
            ],
            nodes,
        })
    }

    /// The mean of the temperature at its times, given samples that show these values.
    pub fn mean(&self, temperatures: &[f64]) -> Vec<f64> {
        let mut left = temperatures
            .iter()
            .zip(&self.waves[1])
            .map(|(t, wave)| t - wave);
        let samples = |node: &WeatherNode| node.sample.and_then(|_| left.next()).unwrap_or(0.0);
        let means = self.smoother.smoothed(self.nodes.iter().map(samples));
        self.with_waves(means)
    }

    /// A sample of the temperature at its times from its posterior distribution.
    pub fn posterior_sample(&self, random: &mut Stream) -> Vec<f64> {
        self.with_waves(self.smoother.drawn(&self.nodes, random))
    }

    fn with_waves(&self, left: Vec<f64>) -> Vec<f64> {
        left.iter()
            .zip(&self.waves[0])
            .map(|(a, b)| a + b)
            .collect()
    }
}

/// Nodes at samples that are means over `window` around their times, at the times `wanted`, and in
/// between in steps of at most `step`.
fn nodes([times, left]: [&[f64]; 2], wanted: &[f64], window: f64, step: f64) -> Vec<WeatherNode> {
    let plain = |time: f64| WeatherNode {
        time,
        sample: None,
        opens: false,
    };
    let mut nodes: Vec<WeatherNode> = Vec::new();
    let mut wanted = wanted.iter().copied().peekable();
    for (time, left) in times.iter().zip(left) {
        let [begin, end] = [time - 0.5 * window, time + 0.5 * window];
        if window > 0.0 {
            match nodes.last_mut() {
                Some(last) if begin - last.time < 1.0 => last.opens = true,
                _ => nodes.push(WeatherNode {
                    opens: true,
                    ..plain(begin)
                }),
            }
        }
        let last = nodes.last().map(|node| node.time);
        let mut until = |to: f64, sample: Option<f64>| {
            let from = nodes.last().map_or(to, |node| node.time);
            let parts = ((to - from) / step - 1e-6).ceil().clamp(1.0, 4.0 * PARTS);
            let part = |k: u32| plain(from + f64::from(k) * (to - from) / parts);
            nodes.extend((1..parts as u32).map(part));
            nodes.push(WeatherNode {
                sample,
                ..plain(to)
            });
        };
        while let Some(time) = wanted.next_if(|time| *time < end + SAME) {
            if last.is_some_and(|last| time > last + SAME) && time < end - SAME {
                until(time, None);
            }
        }
        until(end, Some(*left));
    }
    nodes
}
