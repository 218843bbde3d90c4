//! Schemes: how noise becomes the cascade of stick and slip phases.
//!
//! A scheme simulates a list of paths and reports what happens to an [`Observer`] it is generic over: events as they
//! occur, and the state of all its paths at the instants of a [`Timeline`]. It knows nothing of statistics, files or
//! threads. A path is a function of the seed and its number alone, whatever company it is simulated in.

mod any;
mod columns;
mod discrete_vi;
mod event_driven;
mod quasi_static;
mod reference;
mod timeline;

pub use any::Scheme;
pub use discrete_vi::{DiscreteVi, corrected_exit, divergence_bound, monitoring_shift};
pub use event_driven::{DEFAULT_TOLERANCE, EventDriven, Resolution, Simulated, TOLERANCES, felt_noise};
pub use event_driven::{DrivenOscillator, HarmonicResponse, SlipTransition};
pub use quasi_static::QuasiStatic;
pub use reference::reference_path;
pub use timeline::{Instant, Stop, Timeline};

use crate::model::Event;

/// What watches a simulation. `lane` is the position of a path in the list given to the scheme.
pub trait Observer {
    /// An event of one path; the events of a path arrive in time order.
    fn event(&mut self, lane: usize, event: Event);

    /// The state of every path at an instant; instants arrive in time order, and after every earlier event.
    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>);
}

/// Nobody watches.
impl Observer for () {
    fn event(&mut self, _: usize, _: Event) {}

    fn snapshot(&mut self, _: Instant, _: Snapshot<'_>) {}
}

/// Two watch the same paths.
impl<A: Observer, B: Observer> Observer for (A, B) {
    #[inline]
    fn event(&mut self, lane: usize, event: Event) {
        self.0.event(lane, event);
        self.1.event(lane, event);
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        self.0.snapshot(instant, snapshot);
        self.1.snapshot(instant, snapshot);
    }
}

/// The state of every path at one time; each slice has one entry a lane.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a> {
    /// t.
    pub time: f64,
    /// x(t).
    pub displacement: &'a [f64],
    /// x'(t).
    pub velocity: &'a [f64],
    /// T(t), noise included.
    pub temperature: &'a [f64],
    /// Whether the path is in a static phase at t.
    pub is_static: &'a [bool],
}
