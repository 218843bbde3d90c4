//! The loop over macro steps, for the schemes that simulate noisy paths event by event:
//! event-driven and quasi-static.
//!
//! All paths that are simulated together cross the same macro steps, one or a run of up to 64,
//! before any of them continues. They do so [scalar](super::scalar), one after the other, or
//! [vectorised](super::vectorised). Within a macro step, a path is taken phase by phase:
//!
//! ```text
//! n at the end of the step  drawn from its law given n at the start: the skeleton
//! stick                     does b leave the band, given n at both ends?
//! slip                      where does it stop, given n at the end?
//! ```
//!
//! The state at an instant inside a macro step is drawn separately and does not change the path.

use super::law::{MacroStep, ObservationTime};
use super::scalar::{Cascade, MotionObserver, ObservedTimes, Path, PendingNodes, cross};
use super::work::Simulated;
use crate::model::Event;
use crate::noise::observation_place;
use crate::scheme::columns::{LOST, StateColumns};
use crate::scheme::timeline::Stop;
use crate::scheme::{Instant, Observer, Segment};
use std::cell::RefCell;

/// A stop lies on the end of a macro step if their times differ by at most this fraction, which is
/// rounding.
const ALIGNMENT: f64 = 4.0 * f64::EPSILON;

/// The largest number of macro steps that one path crosses before the next path.
const MOST_QUIET: usize = 64;

/// The observer, which is asked between events whether the paths are still wanted.
pub type SharedObserver<'o> = RefCell<&'o mut dyn Observer>;

/// Paths at the border of two macro steps, and how the loop advances them across macro steps.
pub trait PathSet {
    /// The scheme.
    type Cascade: Cascade;

    fn cascade(&self) -> &Self::Cascade;
    /// Takes all paths across macro steps that have no stop inside.
    fn cross(&mut self, macro_steps: &[MacroStep], observer: &SharedObserver<'_>);
    /// Takes all paths across a macro step with stops inside.
    fn cross_observed(&mut self, macro_step: &MacroStep, inside: &mut Inside);
    /// Writes the state of every path at the end of the macro step that was crossed last.
    fn write_states(&self, passed: &MacroStep, columns: &mut StateColumns);
    /// Whether all paths have been given up.
    fn are_lost(&self) -> bool;
    fn simulated(&self) -> Simulated;
}

/// Simulates `count` paths to the last stop of the timeline, or until the observer stops them.
pub fn simulate(
    paths: &mut impl PathSet,
    count: usize,
    observer: &SharedObserver<'_>,
) -> Simulated {
    let propagation = paths.cascade().propagation();
    let mut macro_step = MacroStep::new(paths.cascade().scene(), &propagation.grid, 0);
    let (row_stride, timeline) = (propagation.row_stride, propagation.timeline);
    let mut columns = StateColumns::new(count);
    let (mut quiet, mut inside) = (
        Vec::new(),
        Inside {
            segments: observer.borrow().follows().then(Vec::new),
            ..Inside::default()
        },
    );
    let mut stops = timeline.stops().peekable();
    let is_before = |stop: &Stop, end: f64| stop.time < end - ALIGNMENT * end;
    let is_by = |stop: &Stop, end: f64| stop.time <= end + ALIGNMENT * end;
    while let Some(stop) = stops.peek().filter(|_| !observer.borrow().is_stopped()) {
        // Collect the macro steps without a stop inside, up to the end of a macro step at which
        // there is a stop. Where paths go in scalar form, each crosses all of them before the next
        // path, which is easier for the branch prediction of a processor.
        quiet.clear();
        while !is_before(stop, macro_step.end) && quiet.len() < MOST_QUIET {
            quiet.push(macro_step.clone());
            macro_step.move_to(
                paths.cascade().scene(),
                &paths.cascade().propagation().grid,
                macro_step.index + 1,
            );
        }
        if quiet.is_empty() {
            let next = || stops.next_if(|stop| is_before(stop, macro_step.end));
            inside.begin(std::iter::from_fn(next), &macro_step, count, row_stride);
            paths.cross_observed(&macro_step, &mut inside);
            inside.report(*observer.borrow_mut(), stops.peek().is_none());
            quiet.push(macro_step.clone());
            macro_step.move_to(
                paths.cascade().scene(),
                &paths.cascade().propagation().grid,
                macro_step.index + 1,
            );
        } else {
            paths.cross(&quiet, observer);
        }
        let passed = &quiet[quiet.len() - 1];
        let mut is_set = false;
        while let Some(stop) = stops.next_if(|stop| is_by(stop, passed.end)) {
            if !is_set {
                paths.write_states(passed, &mut columns);
                is_set = true;
            }
            observer
                .borrow_mut()
                .snapshot(stop.instant, columns.snapshot(stop.time));
        }
        if paths.are_lost() {
            columns.fill(LOST);
            let mut observer = observer.borrow_mut();
            stops
                .by_ref()
                .for_each(|stop| observer.snapshot(stop.instant, columns.snapshot(stop.time)));
        }
    }
    paths.simulated()
}

/// The stops inside a macro step, the states of all paths there, and the events of the macro step.
#[derive(Default)]
pub struct Inside {
    stops: Vec<Stop>,
    /// The times of the stops, each once.
    pub instants: Vec<ObservationTime>,
    /// The index in `instants` of each stop.
    places: Vec<usize>,
    /// The states of all paths at each of `instants`. There may be more than needed.
    pub seen: Vec<StateColumns>,
    pub events: Vec<(usize, Event)>,
    /// The motion in the macro step, if it is followed.
    segments: Option<Vec<(usize, Segment)>>,
}

impl Inside {
    /// Starts a new macro step with these stops, at which `paths` paths are observed.
    fn begin(
        &mut self,
        stops: impl Iterator<Item = Stop>,
        macro_step: &MacroStep,
        paths: usize,
        row_stride: usize,
    ) {
        self.stops.clear();
        self.stops.extend(stops);
        self.instants.clear();
        self.places.clear();
        for stop in &self.stops {
            let is_additional =
                matches!(stop.instant, Instant::Output(row) if !row.is_multiple_of(row_stride));
            let time = stop.time - macro_step.start;
            match self.instants.last_mut().filter(|last| last.at == stop.time) {
                Some(last) => last.is_additional &= is_additional,
                None => {
                    let forcing = macro_step.forcing(time).value;
                    self.instants.push(ObservationTime {
                        at: stop.time,
                        time,
                        is_additional,
                        forcing,
                        place: 0,
                    });
                }
            }
            self.places.push(self.instants.len() - 1);
        }
        let mut ordinals = [0, 0];
        for instant in &mut self.instants {
            let ordinal = &mut ordinals[usize::from(instant.is_additional)];
            instant.place = observation_place(*ordinal, instant.is_additional);
            *ordinal += 1;
        }
        while self.seen.len() < self.instants.len() {
            self.seen.push(StateColumns::new(paths));
        }
        self.seen[..self.instants.len()]
            .iter_mut()
            .for_each(|seen| seen.fill(LOST));
        self.events.clear();
    }

    /// Takes a path across the macro step and draws its state at the stops.
    #[inline(always)]
    pub fn cross<C: Cascade>(
        &mut self,
        lane: usize,
        cascade: &C,
        macro_step: &MacroStep,
        path: &mut Path<C::Memory>,
        scratch: &mut (C::Scratch, PendingNodes),
    ) {
        let Inside {
            instants,
            seen,
            events,
            segments,
            ..
        } = self;
        let draws = path.draws.at(macro_step.index, 0);
        let observer = ObservedTimes {
            instants,
            macro_step_start: macro_step.start,
            draws,
            lane,
            seen,
            passed: 0,
        };
        let mut path_observer = MotionObserver {
            observer,
            lane,
            segments: segments.as_mut(),
        };
        let emit = |event| events.push((lane, event));
        path.lost = cross(cascade, macro_step, path, scratch, &mut path_observer, emit).err();
        let (passed, seen) = (path_observer.observer.passed, path_observer.observer.seen);
        if passed < instants.len() {
            seen[passed..instants.len()]
                .iter_mut()
                .for_each(|seen| seen.set(lane, LOST));
        }
    }

    /// Passes events and states to the observer, in order of time. With `is_over`, there is no
    /// later stop, and events after the last one are dropped.
    fn report(&mut self, observer: &mut dyn Observer, is_over: bool) {
        for (lane, segment) in self
            .segments
            .iter_mut()
            .flat_map(|segments| segments.drain(..))
        {
            observer.segment(lane, &segment);
        }
        for (stop, &place) in self.stops.iter().zip(&self.places) {
            self.events.retain(|&(lane, event)| {
                let is_due = event.time <= stop.time;
                if is_due {
                    observer.event(lane, event);
                }
                !is_due
            });
            observer.snapshot(stop.instant, self.seen[place].snapshot(stop.time));
        }
        if !is_over {
            self.events
                .iter()
                .for_each(|&(lane, event)| observer.event(lane, event));
        }
    }
}
