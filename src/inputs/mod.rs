//! Random inputs: the realisation of each on a path.
//!
//! A realisation is a function of the seed, the path, the name of the input and the time alone. A
//! kick is a pulse of the right area: for a scheme without a step a rectangle that is too short to
//! matter, for a scheme with a step h the mean over the step in which it lies.

mod filter;

use crate::model::{
    InitialNoise, Problem, PulseShape, PulseSize, RandomInput, RandomProcess, Series, before, fnv1a,
};
use crate::noise::{MIRROR, Stream, Transition};
use filter::GroundFilter;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The length of the pulse that stands for a kick, as a share of the duration of the run.
const PULSE: f64 = 1e-9;

impl Problem {
    /// The problem of one path: every random input has its realisation up to `end`. `step` is that of
    /// the scheme, if it has one. With [`MIRROR`] in `path`, normals have the opposite sign.
    pub fn realised(&self, seed: u64, path: u64, end: f64, step: Option<f64>) -> Problem {
        self.with_inputs(&self.realisations(seed, path, end, step))
    }

    /// The realisation of every random input on one path, by its name.
    pub(crate) fn realisations(
        &self,
        seed: u64,
        path: u64,
        end: f64,
        step: Option<f64>,
    ) -> Vec<(String, Arc<Series>)> {
        let realised = |input: &RandomInput| {
            let series = input.realised(seed, path, end, step);
            (input.name.clone(), Arc::new(series))
        };
        self.random.iter().map(realised).collect()
    }
}

impl RandomInput {
    /// The realisation on a path.
    pub fn realised(&self, seed: u64, path: u64, end: f64, step: Option<f64>) -> Series {
        let mut stream = Stream::new(seed ^ fnv1a(self.name.bytes()), path);
        let samples = match &self.process {
            RandomProcess::Telegraph { values, rates } => {
                telegraph(*values, *rates, &mut stream, end)
            }
            RandomProcess::Shot { rate, size, shape } => {
                let pulses = pulses(*rate, *size, &mut stream, end);
                match (shape, step) {
                    (PulseShape::Kick, None) => rectangles(&pulses, PULSE * end, end),
                    (PulseShape::Kick, Some(step)) => means(&pulses, step, end),
                    (PulseShape::Rectangle(duration), _) => rectangles(&pulses, *duration, end),
                    (PulseShape::Decay(time), _) => decays(&pulses, *time, self.step, end),
                }
            }
            RandomProcess::KanaiTajimi {
                angular_frequency,
                damping_ratio,
                intensity,
            } => {
                let w = *angular_frequency;
                let mut filter = GroundFilter::new(w, *damping_ratio, *intensity, self.step);
                let mut state = filter.start(&mut stream);
                self.sampled(end, |i| {
                    if i > 0 {
                        state = filter.next(state, &mut stream);
                    }
                    let [y, slope] = state;
                    -w * (2.0 * damping_ratio * slope + w * y)
                })
            }
            RandomProcess::OrnsteinUhlenbeck(noise) => {
                let transition = Transition::new(noise.relaxation_rate, noise.diffusion, self.step);
                let mut v = match noise.initial {
                    InitialNoise::At(v) => v,
                    InitialNoise::Stationary => noise.stationary_sd() * stream.normal(),
                };
                self.sampled(end, |i| {
                    if i > 0 {
                        v = transition.next(v, stream.normal());
                    }
                    noise.intensity * v
                })
            }
            RandomProcess::Spectrum(spectrum) => {
                let waves = spectrum.variances().map(|(f, variance)| {
                    let [re, im] = [(); 2].map(|()| variance.sqrt() * stream.normal());
                    (TAU * f, re, im)
                });
                let waves: Vec<_> = waves.collect();
                self.sampled(end, |i| {
                    let t = i as f64 * self.step;
                    let wave = |(w, re, im): &(f64, f64, f64)| {
                        let (sin, cos) = libm::sincos(w * t);
                        re * cos + im * sin
                    };
                    waves.iter().map(wave).sum()
                })
            }
            RandomProcess::Own(own) => {
                return own.0.draw(path & !MIRROR, &mut stream, end);
            }
        };
        series(samples)
    }

    /// Samples at every step, each multiplied by the envelope, until one is not before `end`.
    fn sampled(&self, end: f64, mut value: impl FnMut(u64) -> f64) -> Vec<(f64, f64)> {
        let steps = (end / self.step).ceil() as u64 + 1;
        let envelope = |t: f64| {
            self.envelope
                .as_ref()
                .map_or(1.0, |envelope| envelope.of_time(t))
        };
        let sample = |i: u64| {
            let t = i as f64 * self.step;
            (t, value(i) * envelope(t))
        };
        (0..=steps).map(sample).collect()
    }
}

/// The samples as a series; of samples at one time, the first counts. A path with a value that is no
/// number is lost.
fn series(mut samples: Vec<(f64, f64)>) -> Series {
    samples.dedup_by(|next, before| next.0 <= before.0);
    let (times, values) = samples.into_iter().unzip();
    Series::new(times, values).unwrap_or_else(|_| Series::unknown())
}

/// An exponential time with this rate; infinite for the rate 0.
fn waiting(rate: f64, stream: &mut Stream) -> f64 {
    -libm::log(stream.uniform()) / rate
}

/// A function that is constant between these times, at which it takes new values. The last value
/// lasts beyond `end`.
fn steps(first: f64, changes: impl IntoIterator<Item = (f64, f64)>, end: f64) -> Vec<(f64, f64)> {
    let mut samples = vec![(0.0, first)];
    let mut value = first;
    for (time, next) in changes {
        let last = samples[samples.len() - 1].0;
        if before(time) > last {
            samples.push((before(time), value));
        }
        match samples.last_mut() {
            Some(sample) if time <= last => sample.1 = next,
            _ => samples.push((time, next)),
        }
        value = next;
    }
    let last = samples[samples.len() - 1].0;
    samples.push((last.max(end) + end.max(1.0), value));
    samples
}

fn telegraph(values: [f64; 2], rates: [f64; 2], stream: &mut Stream, end: f64) -> Vec<(f64, f64)> {
    // The share of the time at the first value is the rate at which the second is left.
    let mut at = usize::from(stream.uniform() * (rates[0] + rates[1]) > rates[1]);
    let first = values[at];
    let mut time = 0.0;
    let mut changes = Vec::new();
    loop {
        time += waiting(rates[at], stream);
        if time > end {
            return steps(first, changes, end);
        }
        at = 1 - at;
        changes.push((time, values[at]));
    }
}

/// The times and areas of pulses.
fn pulses(rate: f64, size: PulseSize, stream: &mut Stream, end: f64) -> Vec<(f64, f64)> {
    let mut time = 0.0;
    let mut pulses = Vec::new();
    loop {
        time += waiting(rate, stream);
        if time > end {
            return pulses;
        }
        let area = match size {
            PulseSize::Fixed(area) => area,
            PulseSize::Exponential(mean) => -mean * libm::log(stream.uniform()),
            PulseSize::Normal(mean, sd) => mean + sd * stream.normal(),
        };
        pulses.push((time, area));
    }
}

/// The sum of rectangles of these areas and this length.
fn rectangles(pulses: &[(f64, f64)], duration: f64, end: f64) -> Vec<(f64, f64)> {
    let ends = pulses.iter().flat_map(|(time, area)| {
        let last = time + duration;
        // The rounded length makes the area exact.
        let height = area / (last - time);
        [(*time, height, 1), (last, -height, -1)]
    });
    let mut ends: Vec<(f64, f64, i32)> = ends.collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut open, mut sum) = (0, 0.0);
    let sums = ends.into_iter().map(|(time, change, more)| {
        open += more;
        // Between pulses the sum is zero without rounding.
        sum = if open == 0 { 0.0 } else { sum + change };
        (time, sum)
    });
    steps(0.0, sums, end)
}

/// The means of kicks over the steps, each at the start of its step.
fn means(pulses: &[(f64, f64)], step: f64, end: f64) -> Vec<(f64, f64)> {
    let count = (end / step).ceil() as usize + 2;
    let mut samples: Vec<(f64, f64)> = (0..count).map(|n| (n as f64 * step, 0.0)).collect();
    for (time, area) in pulses {
        samples[(time / step) as usize].1 += area / step;
    }
    samples
}

/// The sum of decays of these areas, sampled at least every `step`.
fn decays(pulses: &[(f64, f64)], decay: f64, step: f64, end: f64) -> Vec<(f64, f64)> {
    let (mut time, mut value) = (0.0, 0.0);
    let mut samples = vec![(time, value)];
    let last = (end + step, 0.0);
    for (next, area) in pulses.iter().copied().chain([last]) {
        let from = time;
        let mut sample = |at: f64| samples.push((at, value * libm::exp((from - at) / decay)));
        let lines = ((next - from) / step).ceil();
        (1..lines as u64).for_each(|i| sample(from + (next - from) * (i as f64 / lines)));
        sample(before(next));
        value *= libm::exp((from - next) / decay);
        value += area / decay;
        time = next;
        samples.push((time, value));
    }
    samples
}
