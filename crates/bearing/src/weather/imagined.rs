//! A temperature between and behind its samples: behind the noise of a thermometer, within the time
//! over which a sample is a mean, and between samples that are far apart against its memory.

use super::kalman::Shape;
use super::periods::usual;
use super::search::ProcessSearch;
use super::smoother::{Smoother, WeatherNode};
use stickslip::noise::Stream;

/// A temperature at times that are close to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Imagined {
    /// Times, in seconds.
    pub times: Vec<f64>,
    /// The mean of the temperature at these times, given the samples.
    pub mean: Vec<f64>,
    /// Draws from its law given the samples.
    pub drawn: Vec<Vec<f64>>,
    /// The variance that it gains, in K^2/s.
    pub roughness: f64,
    /// The standard deviation of the noise of the thermometer, in kelvin.
    pub white: f64,
}

/// Number of draws.
const DRAWS: u64 = 48;

/// Seed of the draws.
const SEED: u64 = 0x1A_61;

/// The most samples from which the shape is estimated, which takes a tenth of a second, and the
/// length of the pieces in which they are taken.
const MOST: usize = 4000;
const PIECE: usize = 400;

/// The longest step between nodes as a share of the shortest memory.
const SHARE: f64 = 0.1;

/// White noise matters where it has more than this share of the standard deviation that the
/// temperature gains from one sample to the next.
const NOISY: f64 = 0.15;

/// Times that are closer than this are the same, in seconds.
const SAME: f64 = 1e-3;

/// The most parts of the time between two samples.
const PARTS: f64 = 12.0;

/// Imagine the temperature of these samples, given as times and values, each a mean over `window`
/// seconds around its time, at the times `wanted` as well; if the samples do not tell it by themselves, as a
/// diffusion that is sampled at these times without noise.
pub fn imagined(
    [times, temperatures]: [&[f64]; 2],
    wanted: &[f64],
    interval: f64,
    window: f64,
) -> Option<Imagined> {
    let periods = usual(times).0;
    let pieces = times.len().div_ceil(PIECE);
    let every = times.len().div_ceil(MOST);
    let taken = |values: &[f64]| -> Vec<f64> {
        values
            .chunks(PIECE)
            .take(pieces)
            .step_by(every)
            .flatten()
            .copied()
            .collect()
    };
    let (some, values) = (taken(times), taken(temperatures));
    let periods_of_some = usual(&some).0;
    let search = ProcessSearch::new([&some, &values], &periods_of_some, 2, false, window);
    let Shape {
        processes, white, ..
    } = search.scaled(&search.rough(None)?)?;
    let roughness: f64 = processes
        .iter()
        .map(|(rate, variance)| 2.0 * rate * variance)
        .sum();
    // A process that has forgotten itself from one sample to the next is noise.
    let rates = processes
        .iter()
        .filter(|(_, variance)| *variance > 1e-6)
        .map(|(rate, _)| *rate);
    let fastest = rates.fold(0.0, f64::max);
    let is_noisy = white > NOISY * NOISY * roughness * interval;
    if !(window > 0.0 || is_noisy || fastest * interval > SHARE || wanted != times) {
        return None;
    }
    let whole = ProcessSearch::new([times, temperatures], &periods, 2, false, window);
    let step = (SHARE / fastest)
        .min(if window > 0.0 { 0.5 * window } else { interval })
        .max(interval / PARTS);
    let half = 0.5 * window;
    let mut nodes: Vec<WeatherNode> = Vec::new();
    let mut wanted = wanted.iter().copied().peekable();
    for (time, left) in times.iter().zip(whole.left()) {
        let [begin, end] = [time - half, time + half];
        match nodes.last_mut() {
            Some(last) if window > 0.0 && begin - last.time < 1.0 => last.opens = true,
            None if window == 0.0 => (),
            _ if window > 0.0 => nodes.push(WeatherNode {
                time: begin,
                sample: None,
                opens: true,
            }),
            _ => (),
        }
        let last = nodes.last().map(|node| node.time);
        let mut until = |to: f64, sample: Option<f64>| {
            let from = nodes.last().map_or(to, |node| node.time);
            let parts = ((to - from) / step - 1e-6).ceil().clamp(1.0, 4.0 * PARTS);
            let part = |k: u32| WeatherNode {
                time: from + f64::from(k) * (to - from) / parts,
                sample: None,
                opens: false,
            };
            nodes.extend((1..parts as u32).map(part));
            nodes.push(WeatherNode {
                time: to,
                sample,
                opens: false,
            });
        };
        while let Some(time) = wanted.next_if(|time| *time < end + SAME) {
            if last.is_some_and(|last| time > last + SAME) && time < end - SAME {
                until(time, None);
            }
        }
        until(end, Some(*left));
    }
    let shape = Shape {
        processes,
        smoothing: 0.0,
        window,
        white,
    };
    let smoother = Smoother::new(&shape, &nodes);
    let waves: Vec<f64> = nodes.iter().map(|node| whole.wave(node.time)).collect();
    let whole = |left: Vec<f64>| {
        left.iter()
            .zip(&waves)
            .map(|(left, wave)| left + wave)
            .collect::<Vec<f64>>()
    };
    let draw = |number: u64| whole(smoother.drawn(&nodes, &mut Stream::new(SEED, number)));
    Some(Imagined {
        times: nodes.iter().map(|node| node.time).collect(),
        mean: whole(smoother.mean(&nodes)),
        drawn: (0..DRAWS).map(draw).collect(),
        roughness,
        white: if is_noisy { white.sqrt() } else { 0.0 },
    })
}
