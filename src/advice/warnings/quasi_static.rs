//! What to know about the recursion that takes the forcing to stand still while a slip lasts.

use crate::model::Model;
use crate::numbers::short;
use std::f64::consts::PI;
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

/// The force changes too much during a slip for the quasi-static recursion.
#[derive(Clone, Debug, PartialEq)]
pub struct ForcingDuringSlip {
    /// By how much, roughly, over a slip of pi/w0.
    pub change: f64,
    /// 2 (f_s - f_d), what a slip lets go.
    pub released: f64,
}

/// A change of the force during a slip above this share of what the slip lets go shows in where the
/// body stops. In the noiseless paper scene the jumps are off by 0.85 times that share
/// (docs/event-driven.md).
const SLOW_FORCING: f64 = 0.01;

impl ForcingDuringSlip {
    /// It is not due where slips move nothing.
    pub(super) fn due(model: &Model) -> Option<Self> {
        let Model { oscillator, friction, temperature, .. } = model;
        let slip = PI / oscillator.natural_frequency();
        let rates = temperature.harmonics.iter().map(|h| h.amplitude.abs() * h.angular_frequency);
        // However fast a harmonic, it changes by no more than twice its amplitude.
        let bounds = temperature.harmonics.iter().map(|h| 2.0 * h.amplitude.abs());
        let harmonics: f64 = rates.zip(bounds).map(|(rate, bound)| (rate * slip).min(bound)).sum();
        let noise = temperature.noise.map_or(0.0, |noise| {
            let spread = noise.diffusion * slip.min(0.5 / noise.relaxation_rate).sqrt();
            noise.intensity * spread
        });
        let change = oscillator.force_per_temperature().abs() * (harmonics + noise);
        let released = 2.0 * (friction.static_force - friction.dynamic_force);
        let is_due = NeverMoves::due(model).is_none() && change > SLOW_FORCING * released;
        is_due.then_some(ForcingDuringSlip { change, released })
    }
}

impl fmt::Display for ForcingDuringSlip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ForcingDuringSlip { change, released } = *self;
        write!(
            f,
            "the forcing is not slow: while a slip lasts, pi/w0, it changes the force by about {}, and a slip lets go of 2 \
             (f_s - f_d) = {}. The quasi-static recursion takes it to stand still, so its displacements will be off by \
             about {} %; `--scheme event-driven` takes it as it is",
            short(change),
            short(released),
            short((100.0 * change / released).ceil())
        )
    }
}
