//! The cascade under Ornstein-Uhlenbeck noise, exact in law up to the tolerance.
//!
//! A path is taken from cell to cell ([`super::cell_loop`]); n at the end of the cell is drawn
//! first.
//!
//! - Stick: the bridge of n between known values may cross a threshold ([`super::corridor`]).
//! - Slip: exact steps of (x, x', n) ([`DrivenOscillator`]), given n at their ends, each of which
//!   is searched for the first zero of x' ([`super::first_stop`]). Where a slip stops, the state
//!   that was drawn at the end of the step is discarded: what follows depends only on n at the end
//!   of the cell.
//!
//! A cell is as long as one step of a slip. Where the body oscillates much faster than forcing and
//! noise change, a cell is as long as these allow; then a slip makes many steps in a cell, and n at
//! their ends is drawn from its bridge to the end of the cell.

use super::abreast::Abreast;
use super::cell_loop::{self, Cascade, OneByOne, Path, WHOLE_PLACE};
use super::cells::{Cell, cell_length};
use super::corridor::Corridor;
use super::first_stop::{Interval, KnownStep, Motion, PendingIntervals, SlipStop, StopSearch, forwards};
use super::ladder::Ladder;
use super::scene::{Scene, forcing};
use super::slip_step::{SlipState, force, motion, resolved_travel};
use super::slip_transition::{DrivenOscillator, HarmonicResponse, SlipTransition};
use super::step_rules::StepRules;
use super::watch::{CoastPiece, Flow, FlowPiece, Glance, Known, SlipPiece, Watch, Way, noise_between};
use super::work::{Simulated, Unresolved, WORK_LIMIT};
use crate::lanes::InstructionSet;
use crate::model::{Complex, Event, EventKind, Model, Phase, Sign};
use crate::noise::AddressedDraws;
use crate::scheme::{Observer, Timeline};
use std::cell;

/// The noisy scheme for one scene.
#[derive(Clone, Debug)]
pub struct Noisy {
    scene: Scene,
    timeline: Timeline,
    ladder: Ladder,
    corridor: Corridor,
    oscillator: DrivenOscillator,
    step: SlipStep,
    search: StopSearch,
    /// The number of evaluations that a path may make.
    pub(super) work_limit: u64,
    /// Every `closeness`-th row of the output grid belongs to the run.
    pub(super) closeness: usize,
}

/// A slip step of the usual length, with its coefficients.
#[derive(Clone, Debug)]
struct SlipStep {
    transition: SlipTransition,
    root_length: f64,
    harmonics: Vec<HarmonicResponse>,
}

impl SlipStep {
    /// The step between two places, with the motion there.
    #[inline(always)]
    fn between(&self, eps: f64, (x0, start): (f64, Motion), (x1, end): (f64, Motion)) -> KnownStep {
        let length = self.transition.length;
        let travel = resolved_travel(eps * x0, eps * x1, start, end, length);
        KnownStep { start, end, travel, length, root_length: self.root_length }
    }
}

/// Buffers for the computation of one path at a time.
#[derive(Debug)]
pub struct SlipBuffers {
    partial: SlipStep,
    pending: PendingIntervals,
    /// The terms of B at the end of a step.
    terms: Vec<Complex>,
    /// Buffers for the motion over a part of a step.
    flow: cell::RefCell<FlowBuffers>,
    /// The intervals of a step, kept where its state is observed.
    passed: Vec<Passed>,
}

/// The transition over a part of a step with its responses to the harmonics, which all paths share
/// that are observed at one instant, and the terms of B at its end.
#[derive(Debug)]
struct FlowBuffers {
    transition: SlipTransition,
    harmonics: Vec<HarmonicResponse>,
    terms: Vec<Complex>,
}

/// If the fastest rate of the body is more than this multiple of the rates of forcing and noise,
/// the length of a cell follows from forcing and noise instead.
const TWO_SCALES: f64 = 16.0;

/// Up to this number of paths are simulated one by one, because they do not fill the lanes.
const FEW: usize = 8;

impl Noisy {
    /// The scheme for a scene with noise.
    pub fn new(model: &Model, timeline: &Timeline, rules: &StepRules) -> Self {
        let mut scene = Scene::new(model);
        scene.friction.static_force += rules.added_gap(&scene);
        let body = scene.oscillator;
        let frequencies: Vec<f64> = scene.harmonics.iter().map(|h| h.angular_frequency).collect();
        let oscillator = DrivenOscillator::new(
            body.mass,
            body.damping / body.mass,
            body.natural_frequency(),
            scene.relaxation_rate,
            scene.diffusion,
            &frequencies,
        );
        let fastest = oscillator.fastest_rate().max(scene.noise_rate());
        let longest = rules.slip_length / fastest;
        let slow = frequencies.iter().copied().fold(scene.noise_rate(), f64::max);
        let is_swift = fastest > TWO_SCALES * slow;
        let longest_cell = if is_swift { rules.slip_length / slow } else { longest };
        let ladder = scene.ladder(cell_length(longest_cell, timeline.end));
        let cell_length = ladder.length();
        let length = cell_length / (cell_length / longest).ceil();
        let mut harmonics = vec![HarmonicResponse::none(); frequencies.len()];
        let transition = oscillator.transition(length, &mut harmonics);
        let step = SlipStep { transition, root_length: length.sqrt(), harmonics };
        let search = StopSearch { noise: scene.diffusion / body.mass, caution: rules.caution };
        let corridor = Corridor::new(&scene, rules.chord_error);
        Noisy {
            scene,
            timeline: *timeline,
            ladder,
            corridor,
            oscillator,
            step,
            search,
            work_limit: WORK_LIMIT,
            closeness: 1,
        }
    }

    /// Whether the paths can be simulated abreast: all cells have one length, and there is only one
    /// noise.
    pub fn has_equal_cells(&self) -> bool {
        self.scene.two_noises.is_none() && self.ladder.is_even()
    }

    /// Whether slips can be simulated abreast too: the cells have the length of one slip step, and
    /// its transition is a sum of power series without doubling.
    pub fn has_one_step_a_cell(&self) -> bool {
        let length = self.step.transition.length;
        self.has_equal_cells() && self.ladder.length() == length && self.oscillator.has_series_for(length)
    }

    /// The slip step of the usual length, and its responses to the harmonics. It covers a whole
    /// cell where [`Noisy::has_one_step_a_cell`].
    pub fn usual_step(&self) -> (&SlipTransition, &[HarmonicResponse]) {
        (&self.step.transition, &self.step.harmonics)
    }

    /// The square root of the length of that step.
    pub fn root_length(&self) -> f64 {
        self.step.root_length
    }

    /// A slip step of another length, and its responses to the harmonics.
    #[inline(always)]
    pub fn part_of_step(&self, length: f64) -> (SlipTransition, Vec<HarmonicResponse>) {
        let mut responses = vec![HarmonicResponse::none(); self.step.harmonics.len()];
        (self.oscillator.transition(length, &mut responses), responses)
    }

    pub fn oscillator(&self) -> &DrivenOscillator {
        &self.oscillator
    }

    pub fn search(&self) -> &StopSearch {
        &self.search
    }

    /// The best number of paths to simulate together: enough to fill the registers with the flagged
    /// lanes of one cell, few enough to stay in the cache.
    pub fn paths_abreast(&self) -> usize {
        if self.has_one_step_a_cell() { 1024 } else { 1 }
    }

    /// Simulates the paths with these numbers.
    pub fn simulate(&self, seed: u64, paths: &[u64], observer: &mut dyn Observer) -> Simulated {
        let instructions = InstructionSet::detect();
        if paths.len() > FEW && self.has_equal_cells() {
            let mut all = Abreast::new(self, instructions, seed, paths);
            return cell_loop::simulate(&mut all, paths.len(), observer);
        }
        let mut all = OneByOne::new(self, instructions, seed, paths);
        cell_loop::simulate(&mut all, paths.len(), observer)
    }

    /// The next step of a slip, when this much of the cell remains, and whether it ends with the
    /// cell.
    #[inline(always)]
    fn step_towards<'a>(&'a self, remaining: f64, partial: &'a mut SlipStep) -> (&'a SlipStep, bool) {
        let usual = self.step.transition.length;
        // A remainder that differs from the usual length only by rounding takes the usual step.
        let is_last = remaining <= usual * (1.0 + ALIGNMENT);
        if is_last && remaining < usual * (1.0 - ALIGNMENT) {
            partial.transition = self.oscillator.transition(remaining, &mut partial.harmonics);
            partial.root_length = remaining.sqrt();
            (partial, is_last)
        } else {
            (&self.step, is_last)
        }
    }

    /// eps x' and its derivative.
    #[inline(always)]
    fn motion(&self, path: &Path<f64>, direction: Sign) -> Motion {
        let eps = direction.value();
        let friction = eps * self.scene.friction.dynamic_force;
        motion(&self.scene.oscillator, eps, path.motion, path.force, friction)
    }

    /// Ends a sub-phase at a stop within the step that begins at `start`. n is computed from the
    /// force at the stop.
    #[inline(always)]
    fn stopped(
        &self,
        cell: &Cell,
        path: &mut Path<f64>,
        direction: Sign,
        (start_after, start): (f64, SlipState),
        stop: &SlipStop,
    ) -> Event {
        let Scene { oscillator, friction, .. } = &self.scene;
        let eps = direction.value();
        path.after = start_after + stop.after;
        path.displacement = start.x + eps * stop.travel;
        let force = eps * friction.dynamic_force + oscillator.mass * eps * stop.acceleration;
        path.noise = force - cell.forcing(path.after).value + oscillator.stiffness * path.displacement;
        let kind = EventKind::at_rest(force.abs() <= friction.static_force, force);
        Event { kind, time: cell.start + path.after, displacement: path.displacement, force }
    }

    /// Takes one exact step of (x, x', n), given n at its end, with one normal for x' and one for
    /// x, and moves B and b with it.
    #[inline(always)]
    fn take(
        &self,
        step: &SlipStep,
        path: &mut Path<f64>,
        terms: &mut [Complex],
        friction: f64,
        end_noise: f64,
        normals: [f64; 2],
    ) {
        let start = SlipState { x: path.displacement, v: path.motion, n: path.noise };
        let mean = mean_state(&step.transition, &step.harmonics, start, terms, friction);
        let end = step.transition.drawn(mean, end_noise, normals);
        path.after += step.transition.length;
        (path.displacement, path.motion, path.noise) = (end.x, end.v, end.n);
        path.force = force(&self.scene.oscillator, forcing(terms), end);
    }

    /// Crosses the remainder of a cell with uniform acceleration, where it is too short for the
    /// noise to be distinguished from rounding.
    fn coast(&self, cell: &Cell, path: &mut Path<f64>, direction: Sign, end_noise: f64, watch: &mut impl Watch) {
        let body = &self.scene.oscillator;
        let piece = CoastPiece {
            direction,
            displacement: path.displacement,
            velocity: path.motion,
            acceleration: (path.force - direction.value() * self.scene.friction.dynamic_force) / body.mass,
            ends: [(path.after, path.noise), (cell.length, end_noise)],
        };
        watch.look(&self.scene, || piece);
        (path.displacement, path.motion) = piece.at(cell.length);
        path.noise = end_noise;
        path.force =
            cell.last.value + end_noise - body.stiffness * path.displacement - 2.0 * body.damping * path.motion;
    }

    /// Draws n at the end of a step that ends before the cell does.
    #[inline(always)]
    fn noise_after(&self, path: &mut Path<f64>, length: f64, remaining: f64, end_noise: f64) -> f64 {
        noise_between(&self.scene, [(0.0, path.noise), (remaining, end_noise)], length, &mut path.draws)
    }

    /// Moves a stop from the quintic of the search to the exact motion without noise; for feeble
    /// noise.
    ///
    /// The search replaces the motion without noise by the quintic between the ends of the step.
    /// Given both ends, the conditional laws of a linear system differ only by their means. Let X
    /// be the motion from the start of the step without noise, and Q the quintic through its ends.
    /// The search draws Q + (drawn deviation); the corrected motion is X + (the same deviation). At
    /// the stop that was found it has the velocity V = X' - Q', so its own zero is a time -V/a
    /// away. The first Newton step corrects the error of the quintic, some 1e-6 of a step; the
    /// second one corrects what is left, the square of that. A deviation larger than the noise can
    /// draw is rounding of the quintic, magnified by differentiation, and is bounded.
    #[inline(always)]
    fn on_the_flow(&self, (searched, stop): (KnownStep, SlipStop), flow: &StepFlow) -> SlipStop {
        let Scene { oscillator: body, relaxation_rate, .. } = &self.scene;
        let eps = flow.direction.value();
        let (travel, end, _) = flow.motion(searched.length);
        let (interpolated_travel, interpolated) = KnownStep { end, travel, ..searched }.mean(stop.after);
        let most = MOST_DEVIATIONS * self.search.noise * searched.root_length;
        let bounded =
            |deviation: f64, most: f64| if deviation.abs() > most { most.copysign(deviation) } else { deviation };
        let off = Motion {
            velocity: bounded(
                -interpolated.velocity,
                most * searched.length + (searched.end.velocity - end.velocity).abs(),
            ),
            acceleration: bounded(
                stop.acceleration - interpolated.acceleration,
                most + (searched.end.acceleration - end.acceleration).abs(),
            ),
        };

        let mut moved = stop;
        for _ in 0..FLOW_STEPS {
            let (travel, exact, to) = flow.motion(moved.after);
            let travel = stop.travel + (travel - interpolated_travel);
            let velocity = exact.velocity + off.velocity;
            let acceleration = exact.acceleration + off.acceleration;
            let slope = self.scene.forcing_slope(&flow.scratch.borrow().terms);
            let change = slope - relaxation_rate * to.n - body.stiffness * to.v;
            let jerk = (eps * change - 2.0 * body.damping * acceleration) / body.mass;
            let late = -velocity / acceleration;
            let after = moved.after + late;
            if !(acceleration < 0.0 && after > 0.0 && after <= searched.length) {
                return stop;
            }
            let travel = forwards(travel + late * (velocity + 0.5 * late * acceleration));
            moved = SlipStop { after, acceleration: acceleration + late * jerk, travel };
        }
        moved
    }
}

impl Cascade for Noisy {
    type Memory = f64;
    type Scratch = SlipBuffers;

    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    fn corridor(&self) -> &Corridor {
        &self.corridor
    }

    fn work_limit(&self) -> u64 {
        self.work_limit
    }

    fn closeness(&self) -> usize {
        self.closeness
    }

    fn scratch(&self) -> SlipBuffers {
        let terms = vec![Complex::ZERO; self.scene.harmonics.len()];
        let SlipStep { transition, harmonics, .. } = self.step.clone();
        let flow = FlowBuffers { transition, harmonics, terms: terms.clone() };
        SlipBuffers {
            partial: self.step.clone(),
            pending: PendingIntervals::new(),
            terms,
            flow: flow.into(),
            passed: Vec::new(),
        }
    }

    #[inline(always)]
    fn slip(
        &self,
        cell: &Cell,
        path: &mut Path<f64>,
        direction: Sign,
        end_noise: f64,
        scratch: &mut SlipBuffers,
        watch: &mut impl Watch,
    ) -> Result<Option<Event>, Unresolved> {
        let eps = direction.value();
        let friction = eps * self.scene.friction.dynamic_force;
        let mut start = self.motion(path, direction);
        let SlipBuffers { partial, pending, terms, flow: flow_scratch, passed } = scratch;
        if path.after == 0.0 {
            terms.copy_from_slice(&cell.terms);
        } else {
            cell.set_terms(path.after, terms);
        }
        loop {
            let remaining = cell.length - path.after;
            if remaining <= SHORTEST * cell.length {
                self.coast(cell, path, direction, end_noise, watch);
                return Ok(None);
            }
            path.work.spend()?;
            let (step, is_last) = self.step_towards(remaining, partial);
            let length = step.transition.length;
            let to_noise = if is_last { end_noise } else { self.noise_after(path, length, remaining, end_noise) };
            let is_whole = is_last && path.after == 0.0;
            let normals = match is_whole {
                true => path.draws.at(cell.index, WHOLE_PLACE).normal_pair(),
                false => path.draws.normal_pair(),
            };
            let before = (path.after, SlipState { x: path.displacement, v: path.motion, n: path.noise });
            self.take(step, path, terms, friction, to_noise, normals);
            let end = self.motion(path, direction);
            if !end.is_finite() {
                return Err(Unresolved);
            }
            let searched = step.between(eps, (before.1.x, start), (path.displacement, end));
            let flow = StepFlow {
                cascade: self,
                cell,
                step,
                direction,
                after: before.0,
                start: before.1,
                first: start,
                end: (before.0 + length, to_noise),
                last_drawn: cell::Cell::new([(before.0, before.1.n); 2]),
                scratch: flow_scratch,
            };
            // The intervals are kept, because a stop at the end of the last one may still be moved.
            passed.clear();
            let pass = |after, travel, start, interval: &Interval| {
                if watch.is_looking() {
                    passed.push((after, travel, start, *interval));
                }
            };
            let mut stop = self.search.first(&searched, &mut path.draws, pending, &mut path.work, pass)?;
            if let Some(stop) = &mut stop
                && self.search.noise * searched.root_length < FEEBLE * stop.acceleration.abs()
            {
                *stop = self.on_the_flow((searched, *stop), &flow);
                if let Some(last) = passed.last_mut() {
                    *last = ending_at(*last, stop);
                }
            }
            // Before a stop, n is known to become what the balance of forces requires there.
            let (mut event, mut known_end) = (None, flow.end);
            if let Some(stop) = &stop {
                event = Some(self.stopped(cell, path, direction, before, stop));
                known_end = (path.after, path.noise);
            }
            // This is not a closure, because a closure is not compiled for the instruction set.
            for (i, &(after, travel, start, interval)) in passed.iter().enumerate() {
                let known = [flow.last_drawn.get()[0], known_end];
                let mut end = after + interval.length;
                if let Some(stop) = stop.filter(|_| i + 1 == passed.len()) {
                    end = stop.after;
                }
                let (after, until) = (before.0 + after, before.0 + end);
                if watch.is_ahead(until) {
                    let piece = SlipPiece { eps, x0: before.1.x, after, until, travel, start, interval };
                    let piece = piece.less([&flow.at(after), &flow.at(until)]);
                    watch.look(&self.scene, || FlowPiece { flow: &flow, piece, known });
                }
            }
            if event.is_some() || is_last {
                return Ok(event);
            }
            start = end;
        }
    }

    fn motion_after(&self, _: &Event) -> f64 {
        0.0
    }

    fn look(&self, path: &Path<f64>, _: &Cell) -> (f64, f64) {
        match path.phase {
            Phase::Static => (path.displacement, 0.0),
            Phase::Slip(_) => (path.displacement, path.motion),
        }
    }
}

/// An interval without a zero of the velocity: the time and the distance at its start (since the
/// start of the step), the motion there, and the interval itself.
type Passed = (f64, f64, Motion, Interval);

/// The interval before a stop, ending at the stop.
fn ending_at((after, travel, start, interval): Passed, stop: &SlipStop) -> Passed {
    let part = (stop.after - after) / interval.length;
    let end = Motion { velocity: 0.0, acceleration: stop.acceleration };
    let interval = if part > 0.0 { interval.parted(part, stop.travel - travel, end)[0] } else { interval };
    (after, travel, start, interval)
}

/// The motion of a step without noise, from the state at its start.
struct StepFlow<'a> {
    cascade: &'a Noisy,
    cell: &'a Cell,
    step: &'a SlipStep,
    direction: Sign,
    /// The time at which the step begins, after the start of the cell.
    after: f64,
    start: SlipState,
    /// The motion along the direction at the start.
    first: Motion,
    /// The time at which the step ends, and n there.
    end: Known,
    /// The last time at which n was drawn for an observer, and n there: for the rows of the run,
    /// and for the rows between them.
    last_drawn: cell::Cell<[Known; 2]>,
    scratch: &'a cell::RefCell<FlowBuffers>,
}

impl StepFlow<'_> {
    /// The distance, the motion along the direction and the state, a time after the start of the
    /// step.
    #[inline(always)]
    fn motion(&self, since: f64) -> (f64, Motion, SlipState) {
        let Noisy { scene, oscillator, .. } = self.cascade;
        let (body, eps) = (&scene.oscillator, self.direction.value());
        let friction = eps * scene.friction.dynamic_force;
        let FlowBuffers { transition, harmonics, terms } = &mut *self.scratch.borrow_mut();
        self.cell.set_terms(self.after, terms);
        let mut to = self.start;
        if since == self.step.transition.length {
            to = mean_state(&self.step.transition, &self.step.harmonics, self.start, terms, friction);
        } else if since > 0.0 {
            if transition.length != since {
                *transition = oscillator.transition(since, harmonics);
            }
            to = mean_state(transition, harmonics, self.start, terms, friction);
        }
        let motion = motion(body, eps, to.v, force(body, forcing(terms), to), friction);
        (resolved_travel(eps * self.start.x, eps * to.x, self.first, motion, since), motion, to)
    }
}

impl Flow for StepFlow<'_> {
    #[inline(always)]
    fn at(&self, after: f64) -> Way {
        let (travel, motion, to) = self.motion(after - self.after);
        Way { travel, motion, noise: to.n }
    }

    fn length(&self) -> f64 {
        self.step.transition.length
    }

    #[inline(always)]
    fn noise(&self, glance: Glance, [mut before, behind]: [Known; 2], draws: &mut AddressedDraws) -> f64 {
        let mut last_drawn = self.last_drawn.get();
        let between = &mut last_drawn[usize::from(glance.is_closer)];
        if between.0 > before.0 {
            before = *between;
        }
        let noise = noise_between(&self.cascade.scene, [before, behind], glance.time, draws);
        *between = (glance.time, noise);
        self.last_drawn.set(last_drawn);
        noise
    }
}

/// The mean state after a step, from a known start. `terms` is moved to the end of the step.
#[inline(always)]
fn mean_state(
    transition: &SlipTransition,
    responses: &[HarmonicResponse],
    start: SlipState,
    terms: &mut [Complex],
    friction: f64,
) -> SlipState {
    let mut mean = transition.free(start, friction);
    for (term, response) in terms.iter_mut().zip(responses) {
        let push = response.push(*term);
        mean.x += push.x;
        mean.v += push.v;
        *term = push.term;
    }
    mean
}

/// The noise is feeble where c sqrt(h)/|a| is below this. There the error of the quintic in a,
/// (rate h)^4/1920 of a, is no longer below the first neglected terms of the conditional law, (rate
/// h)^2/100 of its standard deviation c sqrt(h)/4. The value is for the default step, rate h = 1/2.
pub const FEEBLE: f64 = 0.05;

/// A remainder of a cell that is shorter than this fraction of it takes no exact step: the
/// difference of n at both its ends, which such a step needs, would have lost its digits.
pub const SHORTEST: f64 = 1e-8;

/// No draw is further from its mean than this number of standard deviations. These are at most c
/// sqrt(h) for a and c h^{3/2} for V.
const MOST_DEVIATIONS: f64 = 10.0;

/// Newton steps from the stop of the quintic to that of the exact motion.
const FLOW_STEPS: usize = 3;

/// Two step lengths whose relative difference is smaller than this differ only by the rounding of
/// the times from which they were computed.
pub const ALIGNMENT: f64 = 1e-9;
