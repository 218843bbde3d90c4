//! Schemes: the ways to simulate the cascade of stick and slip phases.
//!
//! ```text
//! Scheme       how to simulate: a scheme with its one parameter, a step or a tolerance
//!   -> Simulation   the scheme on one Problem, observed on one Timeline
//!        -> Observer    receives the events of the paths, and their states at the instants of the
//!                       timeline
//! ```
//!
//! A scheme is independent of statistics, files and threads. A path is a function of the seed and
//! its number alone; it does not depend on the paths that are simulated with it. The properties of
//! a scheme (its name, its parameter, how its error is known, when it is stable) are in its own
//! file, as a [`Method`]. The list of the schemes is the call of `schemes!` below.

#[macro_use]
mod any;
mod check_error;
mod columns;
mod discrete_vi;
mod event_driven;
mod method;
mod quasi_static;
mod realised;
mod segment;
mod stability;
mod timeline;

pub use check_error::CheckError;
#[doc(hidden)]
pub use discrete_vi::corrected_exit;
pub use discrete_vi::{
    CorrectedVi, DiscreteSimulation, DiscreteVi, divergence_bound, monitoring_shift,
};
pub use event_driven::{
    DEFAULT_TOLERANCE, EventDriven, EventDrivenSimulation, Resolution, Simulated, TOLERANCES,
    Unresolved,
};
#[doc(hidden)]
pub use event_driven::{DrivenOscillator, HarmonicResponse, SlipTransition};
pub use method::{Appearance, Discretisation, Method, Parameter, Simulate};
pub use quasi_static::{QuasiStatic, QuasiStaticSimulation};
pub use realised::Simulation;
pub use segment::{Along, Course, Segment};
pub use stability::Stability;
pub use timeline::{Instant, Timeline};

use crate::model::{Event, Problem};
use std::sync::atomic::{AtomicBool, Ordering};

schemes! { DiscreteVi, CorrectedVi, EventDriven, QuasiStatic }

/// Receives the events and states of the simulated paths. `lane` is the position of a path in the
/// list of paths that are simulated. Methods that an observer does not implement do nothing.
///
/// ```
/// use stickslip::model::{Drive, Event, EventKind, Friction, Harmonic, Problem, Oscillator, Temperature};
/// use stickslip::scheme::{EventDriven, Observer, Scheme, Simulate as _, Timeline};
///
/// /// When each path first slips.
/// struct FirstSlip(Vec<Option<f64>>);
///
/// impl Observer for FirstSlip {
///     fn event(&mut self, lane: usize, event: Event) {
///         if let EventKind::SlipStarted(_) = event.kind { self.0[lane].get_or_insert(event.time); }
///     }
/// }
///
/// let harmonics = vec![Harmonic { amplitude: 1.0, angular_frequency: 0.25, phase: 0.0 }];
/// let model = Problem {
///     oscillator: Oscillator { mass: 1.0, stiffness: 1.0, damping: 0.0, drive: Drive::Dilatation(6.0) },
///     friction: Friction { static_force: 1.2, dynamic_force: 1.0 },
///     temperature: Temperature { harmonics, ..Temperature::default() },
///     force: None,
///     random: Vec::new(),
///     initial_displacement: 6.0,
///     initial_velocity: 0.0,
/// };
/// let timeline = Timeline { end: 60.0, output_step: 1.0, period: None, after: 0.0 };
/// let simulation = Scheme::from(EventDriven { tolerance: 1e-3 }).simulation(&model, &timeline);
/// let mut first = FirstSlip(vec![None; 3]);
/// let diverged = simulation.simulate(1, &[0, 1, 4711], &mut first);
/// assert!(diverged.is_empty() && first.0.iter().all(|time| time.is_some_and(|time| time < 10.0)));
/// ```
pub trait Observer {
    /// An event of one path; the events of a path arrive in time order.
    fn event(&mut self, _lane: usize, _event: Event) {}

    /// The state of every path at an instant. Instants arrive in time order, after all events that
    /// happened until then.
    fn snapshot(&mut self, _instant: Instant, _snapshot: Snapshot<'_>) {}

    /// Whether the motion between the events is wanted: a scheme then reports the [`Segment`]s of
    /// every path. This is called once, before the paths begin.
    fn follows(&self) -> bool {
        false
    }

    /// A segment of the motion of one path. The segments of a path arrive in time order, each
    /// before the state at [`Instant::End`]. Segments do not depend on the instants of observation:
    /// one may begin before an instant and end after it, may arrive before or after the state at an
    /// instant within or before it, and the last ones may extend beyond the end. A step arrives
    /// before all later states.
    fn segment(&mut self, _lane: usize, _segment: &Segment) {}

    /// The model of one path, if it has random inputs: that with its realisations. This is called
    /// before anything else of the path.
    fn realised(&mut self, _lane: usize, _model: &Problem) {}

    /// Whether the results of these paths are no longer needed. A scheme then returns soon, and the
    /// observer must discard the data of these paths.
    fn is_stopped(&self) -> bool {
        false
    }
}

/// An observer that ignores everything.
impl Observer for () {}

/// Two observers of the same paths.
impl<A: Observer, B: Observer> Observer for (A, B) {
    #[inline]
    fn event(&mut self, lane: usize, event: Event) {
        self.0.event(lane, event);
        self.1.event(lane, event);
    }

    fn realised(&mut self, lane: usize, model: &Problem) {
        self.0.realised(lane, model);
        self.1.realised(lane, model);
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        self.0.snapshot(instant, snapshot);
        self.1.snapshot(instant, snapshot);
    }

    fn follows(&self) -> bool {
        self.0.follows() || self.1.follows()
    }

    fn segment(&mut self, lane: usize, segment: &Segment) {
        self.0.segment(lane, segment);
        self.1.segment(lane, segment);
    }

    #[inline]
    fn is_stopped(&self) -> bool {
        self.0.is_stopped() || self.1.is_stopped()
    }
}

/// An observer that ignores everything, and stops the simulation when the flag is set.
impl Observer for &AtomicBool {
    #[inline]
    fn is_stopped(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}

/// The state of every path at one time; each slice has one entry a lane.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a> {
    /// t, in units of time.
    pub time: f64,
    /// x(t), in units of length.
    pub displacement: &'a [f64],
    /// x'(t), in units of length per time.
    pub velocity: &'a [f64],
    /// T(t), in units of temperature, including the noise.
    pub temperature: &'a [f64],
    /// Whether the path is in a static phase at t.
    pub is_static: &'a [bool],
}
