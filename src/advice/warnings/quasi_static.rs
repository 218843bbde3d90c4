//! Warnings about the quasi-static recursion, which takes the forcing as constant during a slip.

use crate::model::{Model, StepResponse};
use crate::numbers::short;
use std::fmt;

/// f_s = f_d in the quasi-static recursion: the body never moves.
#[derive(Clone, Debug, PartialEq)]
pub struct NeverMoves;

impl NeverMoves {
    pub(super) fn due(model: &Model) -> Option<Self> {
        (model.friction.static_force == model.friction.dynamic_force).then_some(NeverMoves)
    }
}

impl fmt::Display for NeverMoves {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "f_s = f_d: in the quasi-static recursion a slip moves the body by 2 (f_s - f_d)/K = 0, so x stays at \
             x0 and only the times of the slips mean something",
        )
    }
}

/// A slip of the recursion, and what the forcing does during it.
struct Slip {
    /// Duration of the slip: pi/w0 without damping.
    duration: f64,
    /// By how much, roughly, the force changes in that time.
    change: f64,
    /// The force that the slip releases: 2 (f_s - f_d) without damping.
    released: f64,
    /// The largest rate at which harmonics and series change the force.
    rate: f64,
    /// The rate from which on the slip does not end.
    limit: f64,
}

impl Slip {
    /// None where slips do not move the body.
    fn of(model: &Model) -> Option<Self> {
        if NeverMoves::due(model).is_some() {
            return None;
        }
        let Model { oscillator, friction, temperature, .. } = model;
        let swing = StepResponse::new(oscillator);
        let duration = swing.duration;
        let series = temperature.series.as_ref();
        let rates = temperature.harmonics.iter().map(|h| h.amplitude.abs() * h.angular_frequency);
        let rates = rates.chain(series.map(|series| series.steepest()));
        // A harmonic, however fast, changes by no more than twice its amplitude, and measured
        // values by no more than their range.
        let bounds = temperature.harmonics.iter().map(|h| 2.0 * h.amplitude.abs());
        let bounds = bounds.chain(series.map(|series| series.range().1 - series.range().0));
        let harmonics: f64 = rates.clone().zip(bounds).map(|(rate, bound)| (rate * duration).min(bound)).sum();
        let noise = temperature.noises().map(|noise| {
            let spread = noise.diffusion * duration.min(0.5 / noise.relaxation_rate).sqrt();
            noise.intensity * spread
        });
        let noise = noise.fold(0.0, f64::hypot);
        let to_force = oscillator.force_per_temperature().abs();
        let gap = friction.static_force - friction.dynamic_force;
        // A slip ends because the body swings back faster than the forcing moves on, or because of
        // the noise.
        let swings_back = swing.return_speed * oscillator.natural_frequency() * gap;
        Some(Slip {
            duration,
            change: to_force * (harmonics + noise),
            released: (1.0 + swing.overshoot) * gap,
            rate: to_force * rates.sum::<f64>(),
            limit: swings_back + to_force * noise / duration,
        })
    }

    fn creeps(&self) -> bool {
        self.rate > self.limit && self.change <= self.released
    }
}

/// The force changes too much during a slip for the quasi-static recursion.
#[derive(Clone, Debug, PartialEq)]
pub struct ForcingDuringSlip {
    /// Duration of a slip: pi/w0 without damping.
    pub duration: f64,
    /// By how much, roughly, the force changes in that time.
    pub change: f64,
    /// The force that a slip releases: 2 (f_s - f_d) without damping.
    pub released: f64,
}

/// If the change of the force during a slip is above this share of the force that the slip
/// releases, the place where the body stops is visibly off. In the paper's scene without noise the
/// jumps are off by 0.85 times that share (docs/event-driven.md).
const SLOW_FORCING: f64 = 0.01;

impl ForcingDuringSlip {
    /// This warning is not due where slips do not move the body, nor where the body creeps.
    pub(super) fn due(model: &Model) -> Option<Self> {
        let slip = Slip::of(model).filter(|slip| !slip.creeps())?;
        let Slip { duration, change, released, .. } = slip;
        (change > SLOW_FORCING * released).then_some(ForcingDuringSlip { duration, change, released })
    }
}

impl fmt::Display for ForcingDuringSlip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ForcingDuringSlip { duration, change, released } = *self;
        write!(
            f,
            "the forcing is not slow: during a slip, which lasts {}, it changes the force by about {}, \
             while the slip releases {}. The quasi-static recursion takes the forcing as constant, so its \
             displacements will be off by about {} %; `--scheme event-driven` follows it",
            short(duration),
            short(change),
            short(released),
            short((100.0 * change / released).ceil())
        )
    }
}

/// The damped body does not swing back fast enough to end a slip of the quasi-static recursion
/// while the forcing moves on: the body creeps.
#[derive(Clone, Debug, PartialEq)]
pub struct Creep {
    /// The largest rate at which harmonics and series change the force.
    pub rate: f64,
    /// The rate from which on a slip does not end.
    pub limit: f64,
}

impl Creep {
    pub(super) fn due(model: &Model) -> Option<Self> {
        let Slip { rate, limit, .. } = Slip::of(model).filter(Slip::creeps)?;
        Some(Creep { rate, limit })
    }
}

impl fmt::Display for Creep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the damped body does not swing back fast enough to end a slip: the harmonics change the force by up to {} \
             per unit of time, and above {} the body creeps behind the temperature until that turns. The quasi-static recursion shows sticks and slips instead; `--scheme event-driven` follows the creep",
            short(self.rate),
            short(self.limit)
        )
    }
}
