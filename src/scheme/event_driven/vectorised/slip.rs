//! Sub-phases that may stop in the macro step, and those that begin in it.

use super::super::law::{
    Extent, FEEBLE, FINEST, Interval, Node, SAME_LENGTH, SHORTEST, STOP_REFINEMENTS, SlipPoint,
    SlipTransition, SlipVelocity, early_parts, force, forwards, given_noise, halves,
};
use super::super::noisy::Noisy;
use super::crossing::{Crossing, Task};
use super::forced::ForcedStep;
use super::jobs::{Count, DEPTH, Jobs, RowNumbers};
use super::states::Border;
use super::stick::SearchedStick;
use crate::lanes::{Lanes, ROW};
use crate::model::{Event, EventKind};
use crate::noise::LaneDraws;

/// A slip that is searched for its stop, from left to right.
#[derive(Clone, Copy)]
pub(super) struct SearchedSlip<L: Lanes> {
    /// The motion at the start of the interval, and the time and distance there since the start of
    /// the step.
    pub left: SlipVelocity<L>,
    pub after: L,
    pub travel: L,
    pub count: Count<L>,
    /// x at the start of the step, and its time after the start of the macro step.
    pub x: L,
    pub start: L,
    pub eps: L,
    pub interval: Interval<L>,
    pub origin: L::Bits,
    pub key: L::Bits,
}

impl<L: Lanes> SearchedSlip<L> {
    #[inline(always)]
    pub fn put(&self, jobs: &mut Jobs, rows: &RowNumbers) {
        let SearchedSlip {
            left,
            after,
            travel,
            count,
            x,
            start,
            eps,
            ..
        } = *self;
        let row = [
            left.velocity,
            left.acceleration,
            after,
            travel,
            count.number(),
            x,
            start,
            eps,
        ];
        L::scatter_rows(row, &mut jobs.left, rows);
        L::scatter_rows(self.row_of(&self.interval), &mut jobs.right, rows);
    }

    #[inline(always)]
    fn get(jobs: &Jobs, rows: &RowNumbers) -> Self {
        let rows = &jobs.known(rows);
        let [velocity, acceleration, after, travel, count, x, start, eps] =
            L::gather_rows(&jobs.left, rows);
        let (interval, origin, key) = interval_of(L::gather_rows(&jobs.right, rows));
        let (left, count) = (
            SlipVelocity {
                velocity,
                acceleration,
            },
            Count::of(count),
        );
        SearchedSlip {
            left,
            after,
            travel,
            count,
            x,
            start,
            eps,
            interval,
            origin,
            key,
        }
    }

    /// An interval as a row.
    #[inline(always)]
    fn row_of(
        &self,
        &Interval {
            end,
            travel,
            length,
            inverse,
            noise,
        }: &Interval<L>,
    ) -> [L; ROW] {
        let (origin, key) = (L::from_bits(self.origin), L::from_bits(self.key));
        [
            end.velocity,
            end.acceleration,
            travel,
            length,
            inverse,
            noise,
            origin,
            key,
        ]
    }

    #[inline(always)]
    fn draws(&self, macro_step: u64) -> LaneDraws<L> {
        self.count.draws(macro_step, self.origin, self.key)
    }

    /// Moves the start of the search to the end of the interval `passed`, where `mask` holds.
    #[inline(always)]
    fn pass(&mut self, mask: L::Mask, passed: &Interval<L>) {
        self.after = L::select(mask, self.after + passed.length, self.after);
        self.travel = L::select(mask, self.travel + passed.travel, self.travel);
        self.left = SlipVelocity::select(mask, passed.end, self.left);
        self.count = self.count.spent_where(mask);
    }
}

#[inline(always)]
fn interval_of<L: Lanes>(
    [v, a, travel, length, inverse, noise, origin, key]: [L; ROW],
) -> (Interval<L>, L::Bits, L::Bits) {
    let end = SlipVelocity {
        velocity: v,
        acceleration: a,
    };
    (
        Interval {
            end,
            travel,
            length,
            inverse,
            noise,
        },
        origin.to_bits(),
        key.to_bits(),
    )
}

impl<L: Lanes> Crossing<'_, '_, L> {
    /// Divides the intervals in their middles.
    #[inline(always)]
    pub(super) fn bisect(&mut self, rows: &RowNumbers, lanes: u32) {
        let searched = SearchedSlip::<L>::get(&self.paths.jobs, rows);
        let too_short = searched
            .interval
            .length
            .le(L::splat(self.macro_step.length * (2.0 * FINEST)));
        let fallback = L::bitmask(L::or(too_short, searched.count.has(DEPTH as f64 - 1.0))) & lanes;
        self.fall_back(rows, fallback);
        let lanes = lanes & !fallback;
        let normals = searched
            .draws(self.macro_step.index)
            .three_normals(self.paths.normals, 0);
        let parts = halves(searched.left, &searched.interval, normals);
        self.search_parts(searched, rows, lanes, parts, L::always());
    }

    /// Searches the two parts of the intervals of `lanes`, which are the lanes of `is_divided`.
    /// Where both parts are clear, the lane goes on to the next waiting interval.
    #[inline(always)]
    fn search_parts(
        &mut self,
        mut searched: SearchedSlip<L>,
        rows: &RowNumbers,
        lanes: u32,
        (near, far): (Interval<L>, Interval<L>),
        is_divided: L::Mask,
    ) {
        let search = self.paths.noisy.search;
        self.paths
            .jobs
            .place_behind(rows, searched.count, searched.row_of(&far));
        let near_clear = L::and(is_divided, search.is_clear(searched.left, &near));
        let waits = L::and(is_divided, L::not(near_clear));
        searched.count = searched
            .count
            .drawn(2)
            .spent_where(is_divided)
            .behind_where(waits);
        self.saw_slip(rows, L::bitmask(near_clear) & lanes, &searched, &near);
        searched.pass(near_clear, &near);
        searched.interval = Interval::select(near_clear, &far, &near);
        let far_clear = L::and(near_clear, search.is_clear(searched.left, &far));
        self.saw_slip(rows, L::bitmask(far_clear) & lanes, &searched, &far);
        searched.pass(far_clear, &far);
        let clear = L::bitmask(far_clear) & lanes;
        let more = !L::bitmask(searched.count.has_none());
        self.queue_searched(searched, rows, lanes & !clear, clear & more, far_clear);
    }

    /// Puts each of `lanes` into the queue of its next task, those of `more` into that for the next
    /// waiting interval, and writes their rows.
    #[inline(always)]
    fn queue_searched(
        &mut self,
        searched: SearchedSlip<L>,
        rows: &RowNumbers,
        lanes: u32,
        more: u32,
        is_clear: L::Mask,
    ) {
        let is_stop = self
            .paths
            .noisy
            .search
            .is_stop(searched.left, &searched.interval);
        let is_stop = L::and(is_stop, L::not(is_clear));
        let searched = SearchedSlip {
            count: searched.count.scalar_where(is_stop),
            ..searched
        };
        searched.put(&mut self.paths.jobs, rows);
        let stops = L::bitmask(is_stop) & lanes;
        self.queue(Task::FindStop, rows, stops);
        self.queue(Task::Bisect, rows, lanes & !stops);
        self.queue(Task::SlipOn, rows, more);
    }

    /// Goes on to the next interval.
    #[inline(always)]
    pub(super) fn slip_on(&mut self, rows: &RowNumbers, lanes: u32) {
        let mut searched = SearchedSlip::<L>::get(&self.paths.jobs, rows);
        searched.count = searched.count.taken();
        let interval;
        (interval, ..) = interval_of(self.paths.jobs.last_behind(rows, searched.count));
        searched.interval = interval;
        let is_clear = self.paths.noisy.search.is_clear(searched.left, &interval);
        self.saw_slip(rows, L::bitmask(is_clear) & lanes, &searched, &interval);
        searched.pass(is_clear, &interval);
        let clear = L::bitmask(is_clear) & lanes;
        let more = !L::bitmask(searched.count.has_none());
        self.queue_searched(searched, rows, lanes & !clear, clear & more, is_clear);
    }

    /// Draws a state near the stop. Where the stop is found, the state is replaced by that at the
    /// stop; elsewhere the interval is refined.
    #[inline(always)]
    pub(super) fn find_stop(&mut self, rows: &RowNumbers, lanes: u32) {
        let searched = SearchedSlip::<L>::get(&self.paths.jobs, rows);
        let search = self.paths.noisy.search;
        let normals = searched
            .draws(self.macro_step.index)
            .three_normals(self.paths.normals, 0);
        let near = search.near_stop(searched.left, &searched.interval, normals);
        let is_first = searched.count.has_none();
        let count = searched
            .count
            .drawn(2)
            .spent_where(is_first)
            .behind_where(L::always());

        let is_before = near.motion.velocity.gt(L::splat(0.0));
        let [before, behind] = near.parted(&searched.interval, search.noise);
        let (there, rest) = near.zero();
        let (found_after, found_travel) = (searched.after + there, searched.travel + rest);
        let after = L::select(is_before, searched.after + near.after, searched.after);
        let travel = L::select(is_before, searched.travel + near.travel, searched.travel);
        let left = SlipVelocity::select(is_before, near.motion, searched.left);
        let at_it = SearchedSlip {
            left: SlipVelocity::select(near.is_at_it, near.motion, left),
            after: L::select(near.is_at_it, found_after, after),
            travel: L::select(near.is_at_it, forwards(found_travel), travel),
            count,
            interval: Interval::select(is_before, &behind, &before),
            ..searched
        };
        at_it.put(&mut self.paths.jobs, rows);

        let found = L::bitmask(near.is_at_it) & lanes;
        let acceleration = near.motion.acceleration;
        let is_finite = (found_after + found_travel + acceleration)
            .abs()
            .lt(L::splat(f64::INFINITY));
        let step = L::splat(self.macro_step.length) - searched.start;
        let is_felt = (step.sqrt() * search.noise).ge(acceleration.abs() * FEEBLE);
        // Under g, the motion without noise is not known better than the quintic.
        let own = self.paths.noisy.scene.own.is_some();
        let is_felt = if own { L::always() } else { is_felt };
        let good = L::bitmask(L::and(is_finite, is_felt)) & found;
        let missed = lanes & !found;
        let spoiled = L::bitmask(searched.count.has(STOP_REFINEMENTS as f64 - 1.0)) & missed;
        self.fall_back(rows, (found & !good) | spoiled);
        self.saw_slip(rows, L::bitmask(is_before) & missed, &searched, &before);
        let end = SlipVelocity {
            velocity: L::splat(0.0),
            acceleration,
        };
        self.saw_slip(
            rows,
            good,
            &searched,
            &Interval::new(end, rest, there, search.noise),
        );
        self.queue(Task::FindStop, rows, missed & !spoiled);
        self.queue(Task::Rest, rows, good);
    }

    /// Begins what follows a stop: a stick, or another sub-phase.
    #[inline(always)]
    pub(super) fn rest(&mut self, rows: &RowNumbers, lanes: u32) {
        let searched = SearchedSlip::<L>::get(&self.paths.jobs, rows);
        let scene = &self.paths.noisy.scene;
        let (body, eps) = (&scene.oscillator, searched.eps);
        let after = searched.start + searched.after;
        let x = searched.x + eps * searched.travel;
        let spring = scene.spring_at(x, after + self.macro_step.start);
        let force =
            eps * scene.friction.dynamic_force + eps * body.mass * searched.left.acceleration;
        let forcing = self.macro_step.forcing(after);
        let noise = force - forcing.value + spring;
        let f_s = L::splat(scene.friction.static_force);
        let held = L::bitmask(force.abs().le(f_s)) & lanes;
        let end_force = L::splat(self.macro_step.last.value) - spring + self.end_noise(rows);
        let is_finite = end_force.abs().lt(L::splat(f64::INFINITY));
        let inside = L::bitmask(L::and(force.abs().lt(f_s), is_finite));
        let is_moved = scene.own.depends_on_time();
        let edge = if is_moved { held } else { held & !inside };
        let turned = lanes & !held;
        self.report(rows, lanes, (after, x, force), |force, lane| {
            EventKind::at_rest(held >> lane & 1 == 1, force)
        });
        self.fall_back(rows, edge);

        let SearchedSlip { origin, key, .. } = searched;
        let count = searched.count.spent().scalar_where(L::always());
        if turned != 0 {
            let eps = L::select(force.lt(L::splat(0.0)), L::splat(-1.0), L::splat(1.0));
            let begun = Begun {
                after,
                noise,
                force,
                eps,
                x,
                count,
                origin,
                key,
            };
            let own = self.paths.jobs.only::<L>(rows, turned);
            begun.put(&mut self.paths.jobs, &own);
            self.queue(Task::Begin, rows, turned);
        }
        let held = held & !edge;
        if held != 0 {
            let left = Node {
                after,
                noise,
                force,
                curvature: forcing.curvature,
            };
            let end_noise = self.end_noise(rows);
            let curvature = L::splat(self.macro_step.last.curvature);
            let right = Node {
                after: L::splat(self.macro_step.length),
                noise: end_noise,
                force: end_force,
                curvature,
            };
            let piece = SearchedStick {
                left,
                right,
                x,
                side: L::splat(0.0),
                count,
                origin,
                key,
            };
            self.begin_stick(rows, held, &piece, spring);
        }
    }

    /// The mean state after a step which starts a time `after` the start of the macro step, and B
    /// at the end of the step.
    #[inline(always)]
    pub(super) fn mean_state(
        &self,
        transition: &SlipTransition<L>,
        start: SlipPoint<L>,
        after: L,
        friction: L,
    ) -> (SlipPoint<L>, L) {
        let mut mean = transition.free(start, friction);
        let mut forcing = L::splat(0.0);
        for harmonic in 0..self.macro_step.terms.len() {
            let response = self.paths.noisy.oscillator.response(transition, harmonic);
            let push = response.push(self.macro_step.term(harmonic, after));
            (mean.x, mean.v) = (mean.x + push.x, mean.v + push.v);
            forcing = forcing + push.term.re;
        }
        (mean, forcing)
    }

    /// Begins a sub-phase in the macro step, with one exact step to the end of the macro step,
    /// which is divided soon after its start where it is not clear.
    #[inline(always)]
    pub(super) fn begin(&mut self, rows: &RowNumbers, lanes: u32) {
        if !self.paths.noisy.has_one_step_a_macro_step() {
            return self.fall_back(rows, lanes);
        }
        let begun = Begun::<L>::get(&self.paths.jobs, rows);
        let Begun {
            after,
            noise,
            force,
            eps,
            x,
            count,
            origin,
            key,
        } = begun;
        let (zero, length) = (L::splat(0.0), self.macro_step.length);
        let remaining = L::splat(length) - after;
        let start = SlipPoint {
            x,
            v: zero,
            n: noise,
        };
        let (end, end_force, own) = self.drawn_to_the_end(&begun, start, remaining, rows);
        let is_resolved = ForcedStep::is_resolved(&own);
        let Noisy { scene, search, .. } = self.paths.noisy;
        let (first, interval) = Extent::new(remaining, search.noise).between(
            scene,
            eps,
            (&start, force),
            (&end, end_force),
        );

        let is_long = remaining.gt(L::splat(SHORTEST * length));
        let is_part = remaining.lt(L::splat(length * (1.0 - SAME_LENGTH)));
        let is_good = L::and(L::and(is_long, is_part), interval.end.is_finite());
        let good = L::bitmask(L::and(is_good, is_resolved)) & lanes;
        self.fall_back(rows, lanes & !good);
        let next = Border {
            x: end.x,
            v: end.v,
            n: end.n,
            force: end_force,
            eps,
            origin,
            key,
            flip: count.flip(),
        };
        self.set_next(rows, good, next, true);
        self.began(rows, good, [noise, force, ForcedStep::push(&own)]);
        let mut count = count.drawn(1).spent();
        if scene.own.is_some() {
            // The trial of the step.
            count = count.spent();
        }
        let searched = SearchedSlip {
            left: first,
            after: zero,
            travel: zero,
            count,
            x,
            start: after,
            eps,
            interval,
            origin,
            key,
        };
        // Under weak noise the motion inside a step is known better than from the quintic, so a
        // clear step is not divided.
        let is_clear = search.is_clear(first, &interval);
        let clear = L::bitmask(is_clear) & good;
        self.saw_slip(rows, clear, &searched, &interval);
        let normals = searched
            .draws(self.macro_step.index)
            .three_normals(self.paths.normals, 0);
        let parts = early_parts(first, &interval, normals);
        self.search_parts(searched, rows, good & !clear, parts, L::not(is_clear));
    }

    /// Draws the state at the end of the macro step of a sub-phase that begins in it, and b there.
    /// Also returns its step under g.
    #[inline(always)]
    fn drawn_to_the_end(
        &self,
        begun: &Begun<L>,
        start: SlipPoint<L>,
        remaining: L,
        rows: &RowNumbers,
    ) -> (SlipPoint<L>, L, Option<ForcedStep<L>>) {
        let Noisy {
            scene, oscillator, ..
        } = self.paths.noisy;
        let mut transition = oscillator.series(remaining);
        transition.given_noise = given_noise(&transition.covariance);
        let own = self.forced_step(begun.eps, (start, begun.force), begun.after, remaining);
        let friction = begun.eps * scene.friction.dynamic_force - ForcedStep::push(&own);
        let (mean, forcing) = self.mean_state(&transition, start, begun.after, friction);
        let draws = begun
            .count
            .draws(self.macro_step.index, begun.origin, begun.key);
        let end = transition.drawn(
            mean,
            self.end_noise(rows),
            draws.normal_pair(self.paths.normals, 0),
        );
        let drawn = (end, force(&scene.oscillator, forcing, end));
        let (end, end_force) = self.corrected(&own, &transition, begun.after, drawn);
        (end, end_force, own)
    }

    /// Notes n and b at the start of a step, and the constant for g in it, for observing it.
    #[inline(always)]
    pub(super) fn began(&mut self, rows: &RowNumbers, lanes: u32, start: [L; 3]) {
        if self.paths.records.is_observed() {
            let own = self.paths.jobs.only::<L>(rows, lanes);
            for (values, column) in start.into_iter().zip(&mut self.paths.begun) {
                let mut numbers = [0.0; ROW];
                values.store(&mut numbers);
                for i in 0..L::WIDTH {
                    column[own[i] as usize] = numbers[i];
                }
            }
        }
    }

    /// n at the end of the macro step.
    #[inline(always)]
    fn end_noise(&self, rows: &RowNumbers) -> L {
        Border::<L>::get(&self.paths.next, rows).n
    }

    /// Sets the states of these lanes at the end of the macro step.
    #[inline(always)]
    pub(super) fn set_next(
        &mut self,
        rows: &RowNumbers,
        lanes: u32,
        next: Border<L>,
        is_slip: bool,
    ) {
        let own = self.paths.jobs.only::<L>(rows, lanes);
        next.put(&mut self.paths.next, &own);
        self.paths.phases.set_all(rows, lanes, is_slip);
    }

    /// Records an event of each of these lanes, at these times after the start of the macro step.
    #[inline(always)]
    pub(super) fn report(
        &mut self,
        rows: &RowNumbers,
        mut lanes: u32,
        (after, x, force): (L, L, L),
        kind: impl Fn(f64, u32) -> EventKind,
    ) {
        let (mut afters, mut xs, mut forces) = ([0.0; ROW], [0.0; ROW], [0.0; ROW]);
        after.store(&mut afters);
        x.store(&mut xs);
        force.store(&mut forces);
        while lanes != 0 {
            let i = lanes.trailing_zeros();
            let (time, force) = (
                self.macro_step.start + afters[i as usize],
                forces[i as usize],
            );
            let event = Event {
                kind: kind(force, i),
                time,
                displacement: xs[i as usize],
                force,
            };
            self.paths.events.push((rows[i as usize], event));
            lanes &= lanes - 1;
        }
    }
}

/// The start of a sub-phase in the macro step.
#[derive(Clone, Copy)]
pub(super) struct Begun<L: Lanes> {
    pub after: L,
    pub noise: L,
    pub force: L,
    pub eps: L,
    pub x: L,
    pub count: Count<L>,
    pub origin: L::Bits,
    pub key: L::Bits,
}

impl<L: Lanes> Begun<L> {
    #[inline(always)]
    pub fn put(&self, jobs: &mut Jobs, rows: &RowNumbers) {
        let Begun {
            after,
            noise,
            force,
            eps,
            x,
            count,
            ..
        } = *self;
        let (origin, key) = (L::from_bits(self.origin), L::from_bits(self.key));
        L::scatter_rows(
            [after, noise, force, eps, count.number(), x, origin, key],
            &mut jobs.left,
            rows,
        );
    }

    #[inline(always)]
    fn get(jobs: &Jobs, rows: &RowNumbers) -> Self {
        let rows = &jobs.known(rows);
        let [after, noise, force, eps, count, x, origin, key] = L::gather_rows(&jobs.left, rows);
        let (origin, key) = (origin.to_bits(), key.to_bits());
        Begun {
            after,
            noise,
            force,
            eps,
            x,
            count: Count::of(count),
            origin,
            key,
        }
    }
}
