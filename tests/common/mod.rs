//! What the tests of the schemes share: scenes and an observer that keeps everything.
#![allow(dead_code, reason = "each test file uses its own part")]

use stick_slip::model::*;
use stick_slip::scheme::{Instant, Observer, Snapshot, Timeline};

/// The parameters (P) of the paper with forcing frequency `w` and noise intensity `rho`.
pub fn paper(w: f64, rho: f64) -> Model {
    let noise = Noise { intensity: rho, relaxation_rate: 1.0, diffusion: 1.0, initial: InitialNoise::At(0.0) };
    Model {
        oscillator: Oscillator { mass: 1.0, stiffness: 1.0, damping: 0.0, dilatation: 6.0 },
        friction: Friction { static_force: 1.2, dynamic_force: 1.0 },
        temperature: Temperature {
            harmonics: vec![Harmonic { amplitude: 1.0, angular_frequency: w, phase: 0.0 }],
            noise: (rho != 0.0).then_some(noise),
        },
        initial_displacement: 6.0,
    }
}

/// A timeline with an output grid and no periods.
pub fn timeline(end: f64, output_step: f64) -> Timeline {
    Timeline { end, output_step, period: None }
}

/// (t, x, x', T, static).
pub type Row = (f64, f64, f64, f64, bool);

/// Keeps every event and every output row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keep {
    /// Events of each lane.
    pub events: Vec<Vec<Event>>,
    /// The rows of each lane.
    pub rows: Vec<Vec<Row>>,
}

impl Keep {
    pub fn lanes(lanes: usize) -> Self {
        Keep { events: vec![Vec::new(); lanes], rows: vec![Vec::new(); lanes] }
    }
}

impl Observer for Keep {
    fn event(&mut self, lane: usize, event: Event) {
        self.events[lane].push(event);
    }

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if let Instant::Output(_) = instant {
            for lane in 0..s.displacement.len() {
                let row = (s.time, s.displacement[lane], s.velocity[lane], s.temperature[lane], s.is_static[lane]);
                self.rows[lane].push(row);
            }
        }
    }
}
