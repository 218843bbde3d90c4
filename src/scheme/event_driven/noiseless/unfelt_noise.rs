//! Noise that is too weak to change the motion but is part of the recorded temperature.
//!
//! With K beta = 0, or with noise below the rounding of the other forces, the motion is that of the
//! scene without diffusion. The temperature T still fluctuates, because v = E v + u. E v relaxes
//! from v(0) and is computed with the motion. u is an Ornstein-Uhlenbeck process that starts at 0
//! or in its stationary law. Its exact transition from one instant to the next is added to the T of
//! every snapshot.

use crate::model::{Event, InitialNoise, OrnsteinUhlenbeck, Problem};
use crate::noise::{Stream, Transition};
use crate::scheme::{Instant, Observer, Segment, Snapshot};

/// An observer that adds the fluctuations of each path to T in every snapshot, and passes
/// everything on to another one.
pub struct WithUnfeltNoise<'a> {
    observer: &'a mut dyn Observer,
    /// None if the temperature has no diffusion.
    noise: Option<OrnsteinUhlenbeck>,
    lanes: Vec<Lane>,
    /// The time of the last snapshot.
    time: f64,
    temperature: Vec<f64>,
}

impl<'a> WithUnfeltNoise<'a> {
    /// The observer of these paths of a model.
    pub fn new(model: &Problem, observer: &'a mut dyn Observer, seed: u64, paths: &[u64]) -> Self {
        let noise = model
            .temperature
            .effective_noise()
            .filter(OrnsteinUhlenbeck::is_random);
        let start = |noise| {
            paths
                .iter()
                .map(|&path| Lane::start(noise, Stream::new(seed, path)))
                .collect()
        };
        let lanes = noise.as_ref().map_or(Vec::new(), start);
        WithUnfeltNoise {
            observer,
            noise,
            lanes,
            time: 0.0,
            temperature: Vec::new(),
        }
    }
}

/// u and the random numbers of one path.
struct Lane {
    fluctuation: f64,
    draws: Stream,
}

impl Lane {
    fn start(noise: &OrnsteinUhlenbeck, mut draws: Stream) -> Self {
        let fluctuation = match noise.initial {
            InitialNoise::At(_) => 0.0,
            InitialNoise::Stationary => noise.stationary_sd() * draws.normal(),
        };
        Lane { fluctuation, draws }
    }
}

impl Observer for WithUnfeltNoise<'_> {
    fn event(&mut self, lane: usize, event: Event) {
        self.observer.event(lane, event);
    }

    fn follows(&self) -> bool {
        self.observer.follows()
    }

    fn segment(&mut self, lane: usize, segment: &Segment) {
        self.observer.segment(lane, segment);
    }

    fn is_stopped(&self) -> bool {
        self.observer.is_stopped()
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        let Some(noise) = self.noise else {
            return self.observer.snapshot(instant, snapshot);
        };
        if snapshot.time > self.time {
            let step = Transition::new(
                noise.relaxation_rate,
                noise.diffusion,
                snapshot.time - self.time,
            );
            for lane in &mut self.lanes {
                lane.fluctuation = step.next(lane.fluctuation, lane.draws.normal());
            }
            self.time = snapshot.time;
        }
        self.temperature.clear();
        let lanes = snapshot.temperature.iter().zip(&self.lanes);
        self.temperature
            .extend(lanes.map(|(mean, lane)| mean + noise.intensity * lane.fluctuation));
        self.observer.snapshot(
            instant,
            Snapshot {
                temperature: &self.temperature,
                ..snapshot
            },
        );
    }
}
