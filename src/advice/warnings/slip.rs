//! A slip of the quasi-static recursion.

use crate::model::{Problem, StepResponse};

/// A slip of the recursion, and the change of the forcing during it.
pub(super) struct Slip {
    /// Duration of the slip: pi/w0 without damping.
    pub duration: f64,
    /// The approximate change of the force in that time.
    pub change: f64,
    /// The force that the slip releases: 2 (f_s - f_d) without damping.
    pub released: f64,
    /// The largest rate at which harmonics and series change the force.
    pub rate: f64,
    /// The rate above which the slip does not end.
    pub limit: f64,
    /// Whether slips move the body; they do not if f_s = f_d.
    pub moves: bool,
}

impl Slip {
    pub fn of(model: &Problem) -> Self {
        let Problem {
            oscillator,
            friction,
            temperature,
            ..
        } = model;
        let swing = StepResponse::new(oscillator);
        let duration = swing.duration;
        let series = temperature.series.as_ref();
        let rates = temperature
            .harmonics
            .iter()
            .map(|h| h.amplitude.abs() * h.angular_frequency);
        let rates = rates
            .chain(series.map(|series| series.steepest()))
            .chain([temperature.trend.abs()]);
        // A harmonic changes by at most twice its amplitude, and measured values by at most their
        // range.
        let bounds = temperature
            .harmonics
            .iter()
            .map(|h| 2.0 * h.amplitude.abs());
        let bounds = bounds
            .chain(series.map(|series| series.range().1 - series.range().0))
            .chain([f64::INFINITY]);
        let harmonics: f64 = rates
            .clone()
            .zip(bounds)
            .map(|(rate, bound)| (rate * duration).min(bound))
            .sum();
        let noise = temperature.effective_noises().map(|noise| {
            let spread = noise.diffusion * duration.min(0.5 / noise.relaxation_rate).sqrt();
            noise.intensity * spread
        });
        let noise = noise.fold(0.0, f64::hypot);
        let to_force = oscillator.force_per_temperature().abs();
        let gap = friction.static_force - friction.dynamic_force;
        // A slip ends because the body returns faster than the forcing changes, or because of the
        // noise.
        let swings_back = swing.return_speed * oscillator.natural_frequency() * gap;
        Slip {
            duration,
            change: to_force * (harmonics + noise),
            released: (1.0 + swing.overshoot) * gap,
            rate: to_force * rates.sum::<f64>(),
            limit: swings_back + to_force * noise / duration,
            moves: gap != 0.0,
        }
    }

    pub fn creeps(&self) -> bool {
        self.moves && self.rate > self.limit && self.change <= self.released
    }
}
