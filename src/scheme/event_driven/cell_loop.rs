//! The loop over cells and phases of the schemes that follow noisy paths from event to event:
//! event-driven and quasi-static.
//!
//! The paths of a block cross the same cells of time, one cell or a run of up to 64, before any of
//! them goes on. Within a cell, a path is taken phase by phase:
//!
//! ```text
//! n at the end of the cell    drawn from its law given n at the start: the skeleton
//! stick                       does b leave the corridor, given n at both ends?    `Corridor`
//! slip                        where does it stop, given n at the end?             the scheme
//! ```
//!
//! The state at an instant inside a cell is drawn separately and does not change the path
//! ([`super::watch`]).

use super::cells::Cell;
use super::corridor::{Corridor, PendingNodes};
use super::ladder::Ladder;
use super::scene::Scene;
use super::watch::{Glance, Glances, Nobody, Seen, Watch};
use super::work::{Simulated, Unresolved, Work};
use crate::lanes::{InstructionSet, LaneProgram, Lanes};
use crate::model::{Event, EventKind, Phase, Sign};
use crate::noise::{AddressedDraws, looking_place};
use crate::scheme::columns::Columns;
use crate::scheme::timeline::Stop;
use crate::scheme::{Instant, Observer, Timeline};

/// The state of one path.
#[derive(Clone, Debug)]
pub struct Path<M> {
    /// The time up to which it has been simulated, after the start of the cell.
    pub after: f64,
    /// x, or x at the start of the phase if the scheme computes x from that.
    pub displacement: f64,
    /// n.
    pub noise: f64,
    /// The part of n that is the second noise, at the start of the cell; 0 where there is only one
    /// noise.
    pub second_noise: f64,
    /// b. Where a phase begins it is the value that is known exactly (the threshold, or the force
    /// at a stop), not a difference of larger forces.
    pub force: f64,
    pub phase: Phase,
    /// What else the scheme needs to know of the motion.
    pub motion: M,
    pub draws: AddressedDraws,
    pub work: Work,
    pub is_lost: bool,
}

/// What the loop needs from a scheme.
pub trait Cascade {
    /// What the scheme knows of the motion of a path besides displacement, noise, force and phase.
    type Memory: Default;
    /// Buffers for the computation of one path at a time.
    type Scratch;

    fn scene(&self) -> &Scene;
    fn timeline(&self) -> &Timeline;
    /// The division of time into cells.
    fn ladder(&self) -> &Ladder;
    /// Finds the exits from sticks.
    fn corridor(&self) -> &Corridor;
    /// The number of evaluations that a path may make.
    fn work_limit(&self) -> u64;
    /// Every `closeness`-th row of the output grid belongs to the run; the rows between are only
    /// for a closer look at a path.
    fn closeness(&self) -> usize;
    fn scratch(&self) -> Self::Scratch;

    /// Takes a path in a sub-phase to the end of the cell, where n is `end_noise`, or to the event
    /// that ends the sub-phase if this comes first. Returns that event.
    fn slip(
        &self,
        cell: &Cell,
        path: &mut Path<Self::Memory>,
        direction: Sign,
        end_noise: f64,
        scratch: &mut Self::Scratch,
        watch: &mut impl Watch,
    ) -> Result<Option<Event>, Unresolved>;

    /// The motion at the start of the phase that follows an event.
    fn motion_after(&self, event: &Event) -> Self::Memory;

    /// x and x' at the end of the cell to which the path has been taken.
    fn look(&self, path: &Path<Self::Memory>, cell: &Cell) -> (f64, f64);
}

/// A stop lies on the end of a cell if their times differ by at most this fraction, which is
/// rounding.
const ALIGNMENT: f64 = 4.0 * f64::EPSILON;

/// The largest number of cells that one path crosses before the next path.
const MOST_QUIET: usize = 64;

/// Places of the random numbers of a cell: n at its end, the motion of a slip over the whole cell,
/// and from `EVENT_PLACE` on everything else inside the cell.
pub const NOISE_PLACE: u64 = 0;
pub const WHOLE_PLACE: u64 = 1;
pub const EVENT_PLACE: u64 = 2;

/// The paths of a block at the border of two cells, and how the loop takes them across cells.
pub trait PathSet {
    /// The scheme.
    type Cascade: Cascade;

    fn cascade(&self) -> &Self::Cascade;
    /// Takes all paths across cells that have no stop inside.
    fn cross(&mut self, cells: &[Cell], observer: &mut dyn Observer);
    /// Takes all paths across a cell with stops inside.
    fn cross_watched(&mut self, cell: &Cell, inside: &mut Inside);
    /// Writes the state of every path at the end of the cell that was crossed last.
    fn look(&self, passed: &Cell, columns: &mut Columns);
    /// Whether all paths have been given up.
    fn are_lost(&self) -> bool;
    fn simulated(&self) -> Simulated;
}

/// Simulates `count` paths to the last stop of the timeline, or until the observer stops them.
pub fn simulate(paths: &mut impl PathSet, count: usize, observer: &mut dyn Observer) -> Simulated {
    let mut cell = Cell::new(paths.cascade().scene(), paths.cascade().ladder(), 0);
    let (closeness, timeline) = (paths.cascade().closeness(), *paths.cascade().timeline());
    let mut columns = Columns::new(count);
    let (mut quiet, mut inside) = (Vec::new(), Inside::default());
    let mut stops = timeline.stops().peekable();
    let is_before = |stop: &Stop, end: f64| stop.time < end - ALIGNMENT * end;
    let is_by = |stop: &Stop, end: f64| stop.time <= end + ALIGNMENT * end;
    while let Some(stop) = stops.peek().filter(|_| !observer.is_stopped()) {
        // Collect the cells without a stop inside, up to the end of a cell at which there is a
        // stop. Where paths go one by one, each crosses all of them before the next path, which is
        // easier for the branch prediction of a processor.
        quiet.clear();
        while !is_before(stop, cell.end) && quiet.len() < MOST_QUIET {
            quiet.push(cell.clone());
            cell.move_to(paths.cascade().scene(), paths.cascade().ladder(), cell.index + 1);
        }
        if quiet.is_empty() {
            let next = || stops.next_if(|stop| is_before(stop, cell.end));
            inside.begin(std::iter::from_fn(next), &cell, count, closeness);
            paths.cross_watched(&cell, &mut inside);
            inside.tell(observer, stops.peek().is_none());
            quiet.push(cell.clone());
            cell.move_to(paths.cascade().scene(), paths.cascade().ladder(), cell.index + 1);
        } else {
            paths.cross(&quiet, observer);
        }
        let passed = &quiet[quiet.len() - 1];
        let mut is_set = false;
        while let Some(stop) = stops.next_if(|stop| is_by(stop, passed.end)) {
            if !is_set {
                paths.look(passed, &mut columns);
                is_set = true;
            }
            observer.snapshot(stop.instant, columns.snapshot(stop.time));
        }
        if paths.are_lost() {
            columns.fill(LOST);
            stops.by_ref().for_each(|stop| observer.snapshot(stop.instant, columns.snapshot(stop.time)));
        }
    }
    paths.simulated()
}

/// Paths that are simulated one after the other.
pub struct OneByOne<'a, C: Cascade> {
    cascade: &'a C,
    instructions: InstructionSet,
    paths: Vec<Path<C::Memory>>,
    /// The events of the cells that were crossed last, with their lanes.
    events: Vec<(usize, Event)>,
    scratch: (C::Scratch, PendingNodes),
}

impl<'a, C: Cascade> OneByOne<'a, C> {
    /// The paths with these numbers, at t = 0.
    pub fn new(cascade: &'a C, instructions: InstructionSet, seed: u64, paths: &[u64]) -> Self {
        OneByOne {
            cascade,
            instructions,
            paths: paths.iter().map(|&path| start(cascade, seed, path)).collect(),
            events: Vec::new(),
            scratch: (cascade.scratch(), PendingNodes::new()),
        }
    }
}

/// Takes one path after the other across cells, with or without stops inside. This scalar program
/// is compiled for each instruction set together with everything that it calls often (hence
/// `inline(always)` there), so that a fused multiply-add is an instruction instead of a call. The
/// bits are the same on all instruction sets.
struct CrossOneByOne<'p, 'a, C: Cascade> {
    all: &'p mut OneByOne<'a, C>,
    cells: &'p [Cell],
    inside: Option<&'p mut Inside>,
    is_stopped: &'p dyn Fn() -> bool,
}

impl<C: Cascade> LaneProgram for CrossOneByOne<'_, '_, C> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let OneByOne { cascade, paths, events, scratch, .. } = &mut *self.all;
        for (lane, path) in paths.iter_mut().enumerate() {
            let mut cells = self.cells.iter();
            if (self.is_stopped)() {
                return;
            }
            while let Some(cell) = cells.next().filter(|_| !path.is_lost) {
                if let Some(inside) = &mut self.inside {
                    inside.cross(lane, *cascade, cell, path, scratch);
                } else {
                    let emit = |event| events.push((lane, event));
                    path.is_lost = cross(*cascade, cell, path, scratch, &mut Nobody, emit).is_err();
                }
            }
        }
    }
}

impl<C: Cascade> PathSet for OneByOne<'_, C> {
    type Cascade = C;

    fn cascade(&self) -> &C {
        self.cascade
    }

    fn cross(&mut self, cells: &[Cell], observer: &mut dyn Observer) {
        let instructions = self.instructions;
        let is_stopped = &|| observer.is_stopped();
        instructions.run(&mut CrossOneByOne { all: self, cells, inside: None, is_stopped });
        for (lane, event) in self.events.drain(..) {
            observer.event(lane, event);
        }
    }

    fn cross_watched(&mut self, cell: &Cell, inside: &mut Inside) {
        let cells = std::slice::from_ref(cell);
        let instructions = self.instructions;
        instructions.run(&mut CrossOneByOne { all: self, cells, inside: Some(inside), is_stopped: &|| false });
    }

    fn look(&self, passed: &Cell, columns: &mut Columns) {
        for (lane, path) in self.paths.iter().enumerate() {
            columns.set(lane, at_the_end(self.cascade, passed, path));
        }
    }

    fn are_lost(&self) -> bool {
        self.paths.iter().all(|path| path.is_lost)
    }

    fn simulated(&self) -> Simulated {
        Simulated {
            lost: self.paths.iter().enumerate().filter(|(_, path)| path.is_lost).map(|(lane, _)| lane).collect(),
            evaluations: self.paths.iter().map(|path| self.cascade.work_limit() - path.work.left()).sum(),
        }
    }
}

/// The state that an observer sees of a path at the end of a cell.
fn at_the_end<C: Cascade>(cascade: &C, cell: &Cell, path: &Path<C::Memory>) -> Seen {
    if path.is_lost {
        return LOST;
    }
    let (x, v) = cascade.look(path, cell);
    let temperature = cascade.scene().temperature(cell.last.value, path.noise);
    (x, v, temperature, path.phase == Phase::Static)
}

/// The state that an observer sees of a path that was given up.
pub const LOST: Seen = (f64::NAN, f64::NAN, f64::NAN, false);

/// A path at t = 0.
pub fn start<C: Cascade>(cascade: &C, seed: u64, path: u64) -> Path<C::Memory> {
    let (scene, draws) = (cascade.scene(), AddressedDraws::new(seed, path));
    let (noise, second_noise) = scene.draw_initial_noise(draws);
    Path { second_noise, ..Path::new(scene, noise, draws, Work::new(cascade.work_limit())) }
}

impl<M: Default> Path<M> {
    /// A path at t = 0, at rest, with this n.
    pub fn new(scene: &Scene, noise: f64, draws: AddressedDraws, work: Work) -> Self {
        let displacement = scene.initial_displacement;
        Path {
            after: 0.0,
            displacement,
            noise,
            second_noise: 0.0,
            force: scene.initial_forcing() + noise - scene.oscillator.stiffness * displacement,
            phase: Phase::Static,
            motion: M::default(),
            draws,
            work,
            is_lost: false,
        }
    }
}

/// Takes a path across a cell, phase by phase.
#[inline(always)]
pub fn cross<C: Cascade>(
    cascade: &C,
    cell: &Cell,
    path: &mut Path<C::Memory>,
    (scratch, pending): &mut (C::Scratch, PendingNodes),
    watch: &mut impl Watch,
    mut emit: impl FnMut(Event),
) -> Result<(), Unresolved> {
    let end_noise = noise_at_the_end(cell, path);
    path.draws = path.draws.at(cell.index, EVENT_PLACE);
    path.after = 0.0;
    loop {
        let event = match path.phase {
            Phase::Static => stick(cascade, cell, path, end_noise, pending, watch)?,
            Phase::Slip(direction) => cascade.slip(cell, path, direction, end_noise, scratch, watch)?,
        };
        let Some(event) = event else { break };
        path.work.spend()?;
        path.displacement = event.displacement;
        path.force = event.force;
        (path.phase, path.motion) = (event.kind.phase(), cascade.motion_after(&event));
        emit(event);
    }
    path.noise = end_noise;
    Ok(())
}

/// Draws n at the end of a cell, given n at its start: the next value of the skeleton.
#[inline(always)]
fn noise_at_the_end<M>(cell: &Cell, path: &mut Path<M>) -> f64 {
    let mut draws = path.draws.at(cell.index, NOISE_PLACE);
    let Some([first, second]) = cell.two_transitions else { return cell.transition.next(path.noise, draws.normal()) };
    let [for_first, for_second] = draws.normal_pair();
    let first = first.next(path.noise - path.second_noise, for_first);
    path.second_noise = second.next(path.second_noise, for_second);
    first + path.second_noise
}

/// Takes a path in a static phase to the end of the cell, or to its exit if this comes first.
/// Returns the exit.
#[inline(always)]
fn stick<C: Cascade>(
    cascade: &C,
    cell: &Cell,
    path: &mut Path<C::Memory>,
    end_noise: f64,
    pending: &mut PendingNodes,
    watch: &mut impl Watch,
) -> Result<Option<Event>, Unresolved> {
    let scene = cascade.scene();
    let f_s = scene.friction.static_force;
    let displacement = path.displacement;
    let slip = |force: f64, after: f64| Event {
        kind: EventKind::SlipStarted(Sign::of(force)),
        time: cell.start + after,
        displacement,
        force,
    };
    if path.force.abs() >= f_s {
        return Ok(Some(slip(path.force, path.after)));
    }
    let exit = cascade.corridor().exit(scene, cell, path, end_noise, pending, watch)?;
    let Some((after, sign)) = exit else {
        path.force = cell.last.value + end_noise - scene.oscillator.stiffness * path.displacement;
        return Ok(None);
    };
    let event = slip(sign.value() * f_s, after);
    path.after = after;
    path.noise = event.force - cell.forcing(after).value + scene.oscillator.stiffness * path.displacement;
    Ok(Some(event))
}

/// The stops inside a cell, the states of all paths there, and the events of the cell.
#[derive(Default)]
pub struct Inside {
    stops: Vec<Stop>,
    /// The times of the stops, each once.
    pub glances: Vec<Glance>,
    /// The index in `glances` of each stop.
    places: Vec<usize>,
    /// The states of all paths at each of `glances`. There may be more than needed.
    pub seen: Vec<Columns>,
    pub events: Vec<(usize, Event)>,
}

impl Inside {
    /// Starts a new cell with these stops, at which `paths` paths are observed.
    fn begin(&mut self, stops: impl Iterator<Item = Stop>, cell: &Cell, paths: usize, closeness: usize) {
        self.stops.clear();
        self.stops.extend(stops);
        self.glances.clear();
        self.places.clear();
        for stop in &self.stops {
            let is_closer = matches!(stop.instant, Instant::Output(row) if !row.is_multiple_of(closeness));
            let time = stop.time - cell.start;
            match self.glances.last_mut().filter(|last| last.at == stop.time) {
                Some(last) => last.is_closer &= is_closer,
                None => {
                    let forcing = cell.forcing(time).value;
                    self.glances.push(Glance { at: stop.time, time, is_closer, forcing, place: 0 });
                }
            }
            self.places.push(self.glances.len() - 1);
        }
        let mut ordinals = [0, 0];
        for glance in &mut self.glances {
            let ordinal = &mut ordinals[usize::from(glance.is_closer)];
            glance.place = looking_place(*ordinal, glance.is_closer);
            *ordinal += 1;
        }
        while self.seen.len() < self.glances.len() {
            self.seen.push(Columns::new(paths));
        }
        self.seen[..self.glances.len()].iter_mut().for_each(|seen| seen.fill(LOST));
        self.events.clear();
    }

    /// Takes a path across the cell and draws its state at the stops.
    #[inline(always)]
    pub fn cross<C: Cascade>(
        &mut self,
        lane: usize,
        cascade: &C,
        cell: &Cell,
        path: &mut Path<C::Memory>,
        scratch: &mut (C::Scratch, PendingNodes),
    ) {
        let Inside { glances, seen, events, .. } = self;
        let draws = path.draws.at(cell.index, 0);
        let mut watch = Glances { glances, cell_start: cell.start, draws, lane, seen, passed: 0 };
        let emit = |event| events.push((lane, event));
        path.is_lost = cross(cascade, cell, path, scratch, &mut watch, emit).is_err();
        let passed = watch.passed;
        if passed < glances.len() {
            seen[passed..glances.len()].iter_mut().for_each(|seen| seen.set(lane, LOST));
        }
    }

    /// Passes events and states to the observer, in order of time. With `is_over`, there is no
    /// later stop, and events after the last one are dropped.
    fn tell(&mut self, observer: &mut dyn Observer, is_over: bool) {
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
            self.events.iter().for_each(|&(lane, event)| observer.event(lane, event));
        }
    }
}
