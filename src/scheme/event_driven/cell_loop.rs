//! The loop of the schemes that follow noisy paths from event to event: event-driven and
//! quasi-static.
//!
//! All paths of a block cross one cell of time after the other. A path crosses a cell phase by
//! phase:
//!
//! ```text
//! n at the end of the cell    drawn from its law given n at the start: the skeleton
//! stick                       is the corridor left, given both ends?          `Corridor`
//! slip                        where does it stop, given n at the end?         the scheme
//! ```
//!
//! Whoever looks inside a cell is shown what is drawn for the purpose ([`super::watch`]).

use super::cells::Cell;
use super::corridor::{Corridor, Pending};
use super::scene::Scene;
use super::watch::{Glance, Glances, Nobody, Seen, Watch};
use super::work::{Simulated, Unresolved, Work};
use crate::model::{Event, EventKind, Phase, Sign};
use crate::noise::{AddressedDraws, Transition};
use crate::scheme::columns::Columns;
use crate::scheme::timeline::Stop;
use crate::scheme::{Instant, Observer, Timeline};

/// Where one path is.
#[derive(Clone, Debug)]
pub struct Path<M> {
    /// How far it has been simulated, after the start of the cell.
    pub after: f64,
    /// x, or where the phase began if the scheme tells from that.
    pub displacement: f64,
    /// n.
    pub noise: f64,
    /// b, as it is known where a phase begins: threshold or force at a stop, and not a difference
    /// of larger forces.
    pub force: f64,
    pub phase: Phase,
    /// What else the scheme knows of the motion.
    pub motion: M,
    pub draws: AddressedDraws,
    pub work: Work,
    is_lost: bool,
}

/// A scheme as the loop sees it.
pub trait Cascade {
    /// What it knows of the motion of a path besides place, noise, force and phase.
    type Motion: Default;
    /// Room for what one path needs at a time.
    type Scratch;

    fn scene(&self) -> &Scene;
    fn timeline(&self) -> &Timeline;
    /// How long a cell is.
    fn cell_length(&self) -> f64;
    /// What ends sticks.
    fn corridor(&self) -> &Corridor;
    /// What a path may spend.
    fn work_limit(&self) -> u64;
    /// Every so many rows of the output grid one is the run's; those between are a closer look.
    fn closeness(&self) -> usize;
    fn scratch(&self) -> Self::Scratch;

    /// Take a path in a sub-phase to the end of the cell, where n is `end_noise`, or to the event
    /// that ends the sub-phase before.
    fn slip(
        &self,
        cell: &Cell,
        path: &mut Path<Self::Motion>,
        direction: Sign,
        end_noise: f64,
        scratch: &mut Self::Scratch,
        watch: &mut impl Watch,
    ) -> Result<Option<Event>, Unresolved>;

    /// The motion with which the phase after an event begins.
    fn motion_after(&self, event: &Event) -> Self::Motion;

    /// x and x' at the end of a cell to which the path has been taken.
    fn look(&self, path: &Path<Self::Motion>, cell: &Cell) -> (f64, f64);
}

/// A stop is on the end of a cell if it is within this share of the time, which is its rounding.
const ALIGNMENT: f64 = 4.0 * f64::EPSILON;

/// So many cells are crossed by one path before the next path.
const MOST_QUIET: usize = 64;

/// Places of a cell's numbers: n at its end, what the scheme moves by over a whole cell, and from
/// here on what happens inside.
pub const NOISE_PLACE: u64 = 0;
pub const WHOLE_PLACE: u64 = 1;
const EVENT_PLACE: u64 = 2;

/// Simulate the paths with these numbers. Compiled for the instruction set of the caller, hence
/// `inline(always)`.
#[inline(always)]
pub fn simulate<C: Cascade, O: Observer>(cascade: &C, seed: u64, paths: &[u64], observer: &mut O) -> Simulated {
    let length = cascade.cell_length();
    let scene = cascade.scene();
    let transition = Transition::new(scene.relaxation_rate, scene.diffusion, length);
    let mut lanes: Vec<_> = paths.iter().map(|&path| start(cascade, seed, path)).collect();
    let mut columns = Columns::new(paths.len());
    let mut scratch = (cascade.scratch(), Pending::new());
    let (mut quiet, mut inside) = (Vec::new(), Inside::default());
    let mut stops = cascade.timeline().stops().peekable();
    let is_before = |stop: &Stop, end: f64| stop.time < end - ALIGNMENT * end;
    let is_by = |stop: &Stop, end: f64| stop.time <= end + ALIGNMENT * end;
    let mut cell = Cell::new(scene, length, 0);
    while let Some(stop) = stops.peek() {
        // Cells inside which nobody looks, up to the end of one at which somebody does: each path
        // goes through all of them alone, which processors predict better.
        quiet.clear();
        while !is_before(stop, cell.end()) && quiet.len() < MOST_QUIET {
            quiet.push(cell.clone());
            cell.move_to(scene, cell.index + 1);
        }
        for (lane, path) in lanes.iter_mut().enumerate() {
            let mut cells = quiet.iter();
            while let Some(cell) = cells.next().filter(|_| !path.is_lost) {
                let emit = |event| observer.event(lane, event);
                path.is_lost = cross(cascade, cell, &transition, path, &mut scratch, &mut Nobody, emit).is_err();
            }
        }
        if quiet.is_empty() {
            let next = || stops.next_if(|stop| is_before(stop, cell.end()));
            inside.begin(std::iter::from_fn(next), &cell, lanes.len(), cascade.closeness());
            for (lane, path) in lanes.iter_mut().enumerate().filter(|(_, path)| !path.is_lost) {
                let Inside { glances, seen, events, .. } = &mut inside;
                let draws = path.draws.for_looking(cell.index);
                let mut watch = Glances { glances, draws, seen: &mut seen[lane] };
                let emit = |event| events.push((lane, event));
                path.is_lost = cross(cascade, &cell, &transition, path, &mut scratch, &mut watch, emit).is_err();
            }
            inside.tell(observer, &mut columns, stops.peek().is_none());
            quiet.push(cell.clone());
            cell.move_to(scene, cell.index + 1);
        }
        let passed = &quiet[quiet.len() - 1];
        let mut is_set = false;
        while let Some(stop) = stops.next_if(|stop| is_by(stop, passed.end())) {
            if !is_set {
                lanes.iter().enumerate().for_each(|(lane, path)| columns.set(lane, at_the_end(cascade, passed, path)));
                is_set = true;
            }
            observer.snapshot(stop.instant, columns.snapshot(stop.time));
        }
        if lanes.iter().all(|path| path.is_lost) {
            (0..lanes.len()).for_each(|lane| columns.set(lane, LOST));
            stops.by_ref().for_each(|stop| observer.snapshot(stop.instant, columns.snapshot(stop.time)));
        }
    }
    Simulated {
        lost: lanes.iter().enumerate().filter(|(_, path)| path.is_lost).map(|(lane, _)| lane).collect(),
        evaluations: lanes.iter().map(|path| cascade.work_limit() - path.work.left()).sum(),
    }
}

/// What is seen of a path at the end of a cell.
fn at_the_end<C: Cascade>(cascade: &C, cell: &Cell, path: &Path<C::Motion>) -> Seen {
    if path.is_lost {
        return LOST;
    }
    let (x, v) = cascade.look(path, cell);
    let temperature = (cell.last.value + path.noise) / cascade.scene().force_per_temperature;
    (x, v, temperature, path.phase == Phase::Static)
}

const LOST: Seen = (f64::NAN, f64::NAN, f64::NAN, false);

fn start<C: Cascade>(cascade: &C, seed: u64, path: u64) -> Path<C::Motion> {
    let (scene, draws) = (cascade.scene(), AddressedDraws::new(seed, path));
    Path::new(scene, scene.draw_initial_noise(draws), draws, Work::new(cascade.work_limit()))
}

impl<M: Default> Path<M> {
    /// At t = 0, at rest, with this n.
    pub fn new(scene: &Scene, noise: f64, draws: AddressedDraws, work: Work) -> Self {
        let displacement = scene.initial_displacement;
        let forcing: f64 = scene.harmonics.iter().map(|h| h.force.re).sum();
        Path {
            after: 0.0,
            displacement,
            noise,
            force: forcing + noise - scene.oscillator.stiffness * displacement,
            phase: Phase::Static,
            motion: M::default(),
            draws,
            work,
            is_lost: false,
        }
    }
}

/// Take a path across a cell, phase by phase.
#[inline(always)]
fn cross<C: Cascade>(
    cascade: &C,
    cell: &Cell,
    transition: &Transition,
    path: &mut Path<C::Motion>,
    (scratch, pending): &mut (C::Scratch, Pending),
    watch: &mut impl Watch,
    mut emit: impl FnMut(Event),
) -> Result<(), Unresolved> {
    let end_noise = transition.next(path.noise, path.draws.at(cell.index, NOISE_PLACE).normal());
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

/// Take a path in a static phase to the end of the cell or to its exit.
#[inline(always)]
fn stick<C: Cascade>(
    cascade: &C,
    cell: &Cell,
    path: &mut Path<C::Motion>,
    end_noise: f64,
    pending: &mut Pending,
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

/// The stops inside a cell, what was seen there, and the events of the cell.
#[derive(Default)]
struct Inside {
    stops: Vec<Stop>,
    /// When they are, each time once, and which of them are a closer look.
    glances: Vec<Glance>,
    /// The glance of each stop.
    places: Vec<usize>,
    /// What was seen at each stop, lane by lane.
    seen: Vec<Vec<Seen>>,
    events: Vec<(usize, Event)>,
}

impl Inside {
    /// The stops in the next cell, at which so many paths are looked at.
    fn begin(&mut self, stops: impl Iterator<Item = Stop>, cell: &Cell, paths: usize, closeness: usize) {
        self.stops.clear();
        self.stops.extend(stops);
        self.glances.clear();
        self.places.clear();
        for stop in &self.stops {
            let is_closer = matches!(stop.instant, Instant::Output(row) if !row.is_multiple_of(closeness));
            let time = stop.time - cell.start;
            match self.glances.last_mut().filter(|last| last.time == time) {
                Some(last) => last.is_closer &= is_closer,
                None => self.glances.push(Glance { time, is_closer }),
            }
            self.places.push(self.glances.len() - 1);
        }
        self.seen.resize(paths, Vec::new());
        self.seen.iter_mut().for_each(Vec::clear);
        self.events.clear();
    }

    /// Tell the observer what happened, in order of time. `is_over` if nothing after the last stop
    /// matters.
    fn tell<O: Observer>(&mut self, observer: &mut O, columns: &mut Columns, is_over: bool) {
        for (stop, &place) in self.stops.iter().zip(&self.places) {
            self.events.retain(|&(lane, event)| {
                let is_due = event.time <= stop.time;
                if is_due {
                    observer.event(lane, event);
                }
                !is_due
            });
            for (lane, seen) in self.seen.iter().enumerate() {
                columns.set(lane, seen.get(place).copied().unwrap_or(LOST));
            }
            observer.snapshot(stop.instant, columns.snapshot(stop.time));
        }
        if !is_over {
            self.events.iter().for_each(|&(lane, event)| observer.event(lane, event));
        }
    }
}
