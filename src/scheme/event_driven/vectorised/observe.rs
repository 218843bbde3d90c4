//! The states of the paths at instants inside a macro step, in lanes, after the paths have crossed
//! it.

use super::super::law::{
    Bridge, Interval, Node, ObservationTime, SlipPoint, SlipSegment, SlipVelocity, StickEnd,
    StickSegment, Stuck, TRIES, Way, force, motion, resolved_travel, stick_piece,
};
use super::super::macro_step_loop::Inside;
use super::Vectorised;
use super::crossing::Crossing;
use super::jobs::RowNumbers;
use super::records::is_inside;
use super::shared_step::SharedStep;
use super::slip::SearchedSlip;
use super::states::{Border, rows_from};
use crate::lanes::{Lanes, ROW};
use crate::model::Sign;
use crate::noise::{LaneDraws, TimeChange, short_bridge_at};
use crate::scheme::columns::{LOST, StateColumns};

/// The start of a slip step.
#[derive(Clone, Copy)]
struct StepStart<L: Lanes> {
    /// Its time after the start of the macro step.
    after: L,
    state: SlipPoint<L>,
    motion: SlipVelocity<L>,
    eps: L,
    /// The constant that stands for g.
    push: L,
}

/// A slip that lasts throughout the macro step, from the last instant at which it was observed.
struct ClearSlip<L: Lanes> {
    step: StepStart<L>,
    piece: SlipSegment<L>,
}

impl<L: Lanes> Crossing<'_, '_, L> {
    /// Draws the states of all lanes at the instants inside the macro step. A lane in which a state
    /// cannot be drawn in lanes is added to `fallback`.
    #[inline(always)]
    pub(super) fn observe(&mut self, inside: &mut Inside) {
        self.observe_clear_lanes(inside);
        self.observe_slips(inside);
        self.observe_sticks(StickEnd::Clear, inside);
        self.observe_sticks(StickEnd::Kept, inside);
        self.observe_sticks(StickEnd::Exit, inside);
    }

    /// Draws the states of all lanes as if they crossed the macro step in one piece. Those of the
    /// lanes that do not are replaced afterwards.
    #[inline(always)]
    fn observe_clear_lanes(&mut self, inside: &mut Inside) {
        let noisy = self.paths.noisy;
        let whole = SharedStep::<L>::new(&noisy.step, self.macro_step);
        let nothing = SharedStep::<L>::until(noisy, self.macro_step, 0.0);
        let mut parts = Vec::with_capacity(inside.instants.len());
        // Slips of many steps cross the macro step in scalar form, and are observed there.
        if noisy.has_one_step_a_macro_step() {
            for instant in &inside.instants {
                parts.push(SharedStep::<L>::until(noisy, self.macro_step, instant.time));
            }
        }
        for lane in (0..self.paths.count).step_by(L::WIDTH) {
            let rows = rows_from(lane).map(|row| row.min(self.paths.count as u32 - 1));
            let now = Border::<L>::get(&self.paths.now, &rows);
            let next = Border::<L>::get(&self.paths.next, &rows);
            let is_slip = now.eps.abs().gt(L::splat(0.0));
            let mut stick = self.clear_stick(&now, &next);
            let push = at::<L>(&self.paths.begun[2], &rows);
            let mut slip = self.clear_slip(&now, &next, push, [&nothing, &whole]);
            let mut known_fallback = 0;
            for (i, &instant) in inside.instants.iter().enumerate() {
                let draws = now.draws(self.macro_step.index << 32 | instant.place);
                let (mut x, mut v, mut noise) = (
                    now.x,
                    L::splat(0.0),
                    self.stick_until(&mut stick, instant, &draws),
                );
                if let Some(part) = parts.get(i) {
                    let (seen, is_felt) = self.slip_until(&mut slip, part, instant, &draws);
                    let fallback = L::bitmask(L::and(is_slip, L::not(is_felt)));
                    self.not_in_lanes(&rows, fallback & !known_fallback);
                    known_fallback |= fallback;
                    x = L::select(is_slip, seen.0, x);
                    v = L::select(is_slip, seen.1, v);
                    noise = L::select(is_slip, seen.2, noise);
                }
                let seen = (x, v, noisy.scene.temperature(instant.forcing, noise));
                inside.seen[i].set_lanes(lane, seen, !L::bitmask(is_slip));
            }
        }
        for &lane in self.paths.lost.keys() {
            inside.seen[..inside.instants.len()]
                .iter_mut()
                .for_each(|seen| seen.set(lane, LOST));
        }
    }

    /// A stick over the whole macro step.
    #[inline(always)]
    fn clear_stick(&self, now: &Border<L>, next: &Border<L>) -> StickSegment<L> {
        StickSegment {
            after: (L::splat(0.0), L::splat(self.macro_step.length)),
            noise: (now.n, next.n),
            force: (now.force, next.force),
            displacement: now.x,
        }
    }

    /// Draws n in a stick that is clear, and goes on to the part of it after the instant.
    #[inline(always)]
    fn stick_until(
        &self,
        stick: &mut StickSegment<L>,
        instant: ObservationTime,
        draws: &LaneDraws<L>,
    ) -> L {
        let bridge = self.bridge(stick, instant);
        let stuck = stick.inside(
            instant,
            bridge.anywhere(draws.normal(self.paths.normals, 0)),
        );
        *stick = stick.behind(instant, stuck);
        stuck.noise
    }

    /// A slip over the whole macro step. `ends` are the steps to its start and to its end.
    #[inline(always)]
    fn clear_slip(
        &self,
        now: &Border<L>,
        next: &Border<L>,
        push: L,
        ends: [&SharedStep<L>; 2],
    ) -> ClearSlip<L> {
        let (scene, zero, eps) = (&self.paths.noisy.scene, L::splat(0.0), now.eps);
        let state = SlipPoint {
            x: now.x,
            v: now.v,
            n: now.n,
        };
        let end = SlipPoint {
            x: next.x,
            v: next.v,
            n: next.n,
        };
        let (start, interval) =
            self.whole_extent()
                .between(scene, eps, (&state, now.force), (&end, next.force));
        let step = StepStart {
            after: zero,
            state,
            motion: start,
            eps,
            push,
        };
        let until = interval.length;
        let piece = SlipSegment {
            eps,
            x0: state.x,
            after: zero,
            until,
            travel: zero,
            start,
            interval,
        };
        let [nothing, whole] = ends;
        let before = self.shared_way(&step, nothing, 0.0);
        let behind = self.shared_way(&step, whole, self.macro_step.length);
        ClearSlip {
            step,
            piece: piece.less([&before, &behind]),
        }
    }

    /// Draws x, x' and n in a slip that is clear, and goes on to the part of it after the instant,
    /// which is the end of the step `part`. Also returns in which lanes n could be computed.
    #[inline(always)]
    fn slip_until(
        &self,
        ClearSlip { step, piece }: &mut ClearSlip<L>,
        part: &SharedStep<L>,
        instant: ObservationTime,
        draws: &LaneDraws<L>,
    ) -> ((L, L, L), L::Mask) {
        let scene = &self.paths.noisy.scene;
        let here = self.shared_way(step, part, instant.time);
        let there = piece.state(
            scene,
            instant,
            &here,
            draws.three_normals(self.paths.normals, 0),
        );
        let is_felt = piece.is_felt(scene, instant, &here, L::splat(self.macro_step.length));
        let (x, v) = piece.seen(&there);
        *piece = piece.parted_at(instant, &there)[1];
        (
            (x, v, self.noise_in_slip(step, there.noise, (x, v), instant)),
            is_felt,
        )
    }

    /// n in a slip, from a balance of forces in which a constant stands for g.
    #[inline(always)]
    fn noise_in_slip(
        &self,
        step: &StepStart<L>,
        noise: L,
        (x, v): (L, L),
        instant: ObservationTime,
    ) -> L {
        let scene = &self.paths.noisy.scene;
        if !scene.own.is_some() {
            return noise;
        }
        let (mut here, time) = ([step.push], L::splat(instant.at));
        scene
            .own
            .at_points(Sign::Positive, [&[x], &[v], &[time]], &mut here);
        noise - (here[0] - step.push)
    }

    /// The step and the piece of a recorded slip. The piece is without its motion without noise.
    #[inline(always)]
    fn recorded_slip(
        &self,
        now: &Border<L>,
        left: [L; 8],
        right: [L; 8],
    ) -> (StepStart<L>, SlipSegment<L>) {
        let scene = &self.paths.noisy.scene;
        let zero = L::splat(0.0);
        let [velocity, acceleration, after, travel, began, x0, eps, push] = left;
        let [v1, a1, distance, length, inverse, noise, noise0, force0] = right;
        let interval = Interval {
            end: SlipVelocity {
                velocity: v1,
                acceleration: a1,
            },
            travel: distance,
            length,
            inverse,
            noise,
        };
        // A step that begins with the macro step has the state at its start; one that begins later
        // starts from rest.
        let is_later = began.gt(zero);
        let state = SlipPoint {
            x: x0,
            v: L::select(is_later, zero, now.v),
            n: L::select(is_later, noise0, now.n),
        };
        let force0 = L::select(is_later, force0, now.force);
        let friction = eps * scene.friction.dynamic_force;
        let step = StepStart {
            after: began,
            state,
            motion: motion(&scene.oscillator, eps, state.v, force0, friction),
            eps,
            push,
        };
        let start = SlipVelocity {
            velocity,
            acceleration,
        };
        let (from, to) = (began + after, began + (after + length));
        let piece = SlipSegment {
            eps,
            x0,
            after: from,
            until: to,
            travel,
            start,
            interval,
        };
        let ways = [&self.way(&step, from), &self.way(&step, to)];
        (step, piece.less(ways))
    }

    /// Draws the states in the recorded pieces of slips.
    #[inline(always)]
    fn observe_slips(&mut self, inside: &mut Inside) {
        let scene = &self.paths.noisy.scene;
        let macro_step_start = L::splat(self.macro_step.start);
        for first in (0..self.paths.records.slips.len).step_by(L::WIDTH) {
            let (rows, lanes, left, right) = self.paths.records.slips.get::<L>(first);
            let now = Border::<L>::get(&self.paths.now, &rows);
            let (step, mut piece) = self.recorded_slip(&now, left, right);
            let (from, to) = (piece.after, piece.until);
            let step_length = L::splat(self.macro_step.length) - step.after;
            let mut fallback = 0;
            for (i, instant) in inside.instants.iter().enumerate() {
                let is_held = is_inside(instant.at, macro_step_start + from, macro_step_start + to);
                let held = L::bitmask(is_held) & lanes;
                if held == 0 {
                    continue;
                }
                let draws = now.draws(self.macro_step.index << 32 | instant.place);
                let here = self.way(&step, L::splat(instant.time));
                let there = piece.state(
                    scene,
                    *instant,
                    &here,
                    draws.three_normals(self.paths.normals, 0),
                );
                let is_felt = piece.is_felt(scene, *instant, &here, step_length);
                fallback |= !L::bitmask(is_felt) & held;
                let (x, v) = piece.seen(&there);
                let noise = self.noise_in_slip(&step, there.noise, (x, v), *instant);
                let seen = (x, v, scene.temperature(instant.forcing, noise));
                set(&mut inside.seen[i], &rows, held, seen, false);
                let rest = piece.parted_at(*instant, &there)[1];
                piece = SlipSegment {
                    after: L::select(is_held, rest.after, piece.after),
                    travel: L::select(is_held, rest.travel, piece.travel),
                    start: SlipVelocity::select(is_held, rest.start, piece.start),
                    interval: Interval::select(is_held, &rest.interval, &piece.interval),
                    ..piece
                };
            }
            self.not_in_lanes(&rows, fallback);
        }
    }

    /// Draws the states in the recorded pieces of sticks of one kind.
    #[inline(always)]
    fn observe_sticks(&mut self, kind: StickEnd, inside: &mut Inside) {
        let scene = &self.paths.noisy.scene;
        let (zero, macro_step_start) = (L::splat(0.0), L::splat(self.macro_step.start));
        for first in (0..self.paths.records.sticks(kind).len).step_by(L::WIDTH) {
            let (rows, lanes, left, right) = self.paths.records.sticks(kind).get::<L>(first);
            let [from, noise, force, _, displacement, ..] = left;
            let [to, end_noise, end_force, ..] = right;
            let now = Border::<L>::get(&self.paths.now, &rows);
            let mut piece = StickSegment {
                after: (from, to),
                noise: (noise, end_noise),
                force: (force, end_force),
                displacement,
            };
            for (i, instant) in inside.instants.iter().enumerate() {
                let is_held = is_inside(instant.at, macro_step_start + from, macro_step_start + to);
                let held = L::bitmask(is_held) & lanes;
                if held == 0 {
                    continue;
                }
                let draws = now.draws(self.macro_step.index << 32 | instant.place);
                let bridge = self.bridge(&piece, *instant);
                let drawn = match kind {
                    StickEnd::Clear => bridge.anywhere(draws.normal(self.paths.normals, 0)),
                    StickEnd::Kept | StickEnd::Exit => {
                        self.accepted(kind, &piece, *instant, &bridge, &draws, (&rows, held))
                    }
                };
                let there = piece.inside(*instant, drawn);
                let seen = (
                    displacement,
                    zero,
                    scene.temperature(instant.forcing, there.noise),
                );
                set(&mut inside.seen[i], &rows, held, seen, true);
                let rest = piece.behind(*instant, there);
                piece = StickSegment {
                    after: (L::select(is_held, rest.after.0, piece.after.0), to),
                    noise: (L::select(is_held, rest.noise.0, piece.noise.0), end_noise),
                    force: (L::select(is_held, rest.force.0, piece.force.0), end_force),
                    ..piece
                };
            }
        }
    }

    /// Draws n and b where no threshold is met, or none before the end of the piece: they are drawn
    /// again until they are accepted.
    #[inline(always)]
    fn accepted(
        &mut self,
        kind: StickEnd,
        piece: &StickSegment<L>,
        instant: ObservationTime,
        bridge: &Bridge<L>,
        draws: &LaneDraws<L>,
        (rows, held): (&RowNumbers, u32),
    ) -> Stuck<L> {
        let scene = &self.paths.noisy.scene;
        let (theta, sigma) = (scene.relaxation_rate, scene.diffusion);
        let time = L::splat(instant.time);
        let halves = [
            TimeChange::short(theta, sigma, time - piece.after.0),
            TimeChange::short(theta, sigma, piece.after.1 - time),
        ];
        // On an end of the piece n is known, and nothing is drawn.
        let is_between = L::and(piece.after.0.lt(time), time.lt(piece.after.1));
        let mut left = L::bitmask(is_between) & held;
        let mut is_left = is_between;
        let (side, f_s) = (piece.exit_side(), L::splat(scene.friction.static_force));
        let mut stuck = Stuck {
            noise: bridge.mean,
            force: bridge.rest + bridge.mean,
        };
        for attempt in 0..TRIES as u64 {
            if left == 0 {
                return stuck;
            }
            let (drawn, is_accepted) = if kind == StickEnd::Kept {
                let drawn = bridge.anywhere(draws.normal(self.paths.normals, 2 * attempt));
                (
                    drawn,
                    piece.stays(
                        [[f_s; 2]; 3],
                        &halves,
                        drawn.force,
                        draws.uniform(2 * attempt + 1),
                    ),
                )
            } else {
                let drawn = bridge.before_exit(
                    f_s,
                    side,
                    draws.three_normals(self.paths.normals, 3 * attempt),
                );
                (
                    drawn,
                    piece.misses_other(
                        [[f_s; 2]; 3],
                        &halves,
                        drawn.force,
                        draws.uniform(3 * attempt + 2),
                    ),
                )
            };
            let accepted = L::and(is_left, is_accepted);
            stuck.noise = L::select(accepted, drawn.noise, stuck.noise);
            stuck.force = L::select(accepted, drawn.force, stuck.force);
            is_left = L::and(is_left, L::not(is_accepted));
            left &= !L::bitmask(is_accepted);
        }
        self.not_in_lanes(rows, left);
        stuck
    }

    /// The bridge of n in a piece of a stick at an instant.
    #[inline(always)]
    fn bridge(&self, piece: &StickSegment<L>, instant: ObservationTime) -> Bridge<L> {
        let scene = &self.paths.noisy.scene;
        let (before, behind) = (
            L::splat(instant.time) - piece.after.0,
            piece.after.1 - instant.time,
        );
        let (mean, sd) = short_bridge_at(
            scene.relaxation_rate,
            scene.diffusion,
            before,
            behind,
            piece.noise,
        );
        Bridge {
            mean,
            sd,
            rest: L::splat(instant.forcing)
                - scene.spring_at(piece.displacement, L::splat(instant.at)),
        }
    }

    /// The motion without noise of a step that begins with the macro step, at the end of `part`.
    #[inline(always)]
    fn shared_way(&self, step: &StepStart<L>, part: &SharedStep<L>, since: f64) -> Way<L> {
        let friction = step.eps * self.paths.noisy.scene.friction.dynamic_force - step.push;
        let mean = part.mean(step.state, friction);
        self.way_to(step, mean, L::splat(part.forcing), L::splat(since))
    }

    /// The motion of a step without noise, at a time after the start of the macro step.
    #[inline(always)]
    fn way(&self, step: &StepStart<L>, after: L) -> Way<L> {
        let noisy = self.paths.noisy;
        let since = after - step.after;
        let transition = noisy.oscillator.series(since);
        let friction = step.eps * noisy.scene.friction.dynamic_force - step.push;
        let (mean, forcing) = self.mean_state(&transition, step.state, step.after, friction);
        self.way_to(step, mean, forcing, since)
    }

    #[inline(always)]
    fn way_to(&self, step: &StepStart<L>, mean: SlipPoint<L>, forcing: L, since: L) -> Way<L> {
        let scene = &self.paths.noisy.scene;
        let (body, eps) = (&scene.oscillator, step.eps);
        let friction = eps * scene.friction.dynamic_force - step.push;
        let motion = motion(body, eps, mean.v, force(body, forcing, mean), friction);
        let travel = resolved_travel(eps * step.state.x, eps * mean.x, step.motion, motion, since);
        Way {
            travel,
            motion,
            noise: mean.n,
        }
    }

    /// Adds these lanes to `fallback`, unless they are there or have been given up.
    #[inline(always)]
    fn not_in_lanes(&mut self, rows: &RowNumbers, mut lanes: u32) {
        while lanes != 0 {
            let lane = rows[lanes.trailing_zeros() as usize];
            let Vectorised { fallback, lost, .. } = &mut *self.paths;
            if !fallback.contains(&lane) && !lost.contains_key(&(lane as usize)) {
                fallback.push(lane);
            }
            lanes &= lanes - 1;
        }
    }

    /// Records the interval of a slip, which begins where the search has come to, in lanes in which
    /// it has no stop, or one at its end.
    #[inline(always)]
    pub(super) fn saw_slip(
        &mut self,
        rows: &RowNumbers,
        lanes: u32,
        searched: &SearchedSlip<L>,
        interval: &Interval<L>,
    ) {
        if !self.paths.records.is_observed() {
            return;
        }
        let SearchedSlip {
            left,
            after,
            travel,
            x,
            start,
            eps,
            ..
        } = *searched;
        let held = self
            .paths
            .records
            .hold(start + after, start + (after + interval.length))
            & lanes;
        if held != 0 {
            let Interval {
                end,
                travel: distance,
                length,
                inverse,
                noise,
            } = *interval;
            let [noise0, force0, push] = [0, 1, 2].map(|i| at::<L>(&self.paths.begun[i], rows));
            let left = [
                left.velocity,
                left.acceleration,
                after,
                travel,
                start,
                x,
                eps,
                push,
            ];
            let right = [
                end.velocity,
                end.acceleration,
                distance,
                length,
                inverse,
                noise,
                noise0,
                force0,
            ];
            self.paths.records.slips.push(rows, held, left, right);
        }
    }

    /// Records a piece of a stick in these lanes.
    #[inline(always)]
    pub(super) fn saw_stick(
        &mut self,
        rows: &RowNumbers,
        lanes: u32,
        (left, right): (&Node<L>, &Node<L>),
        displacement: L,
        kind: StickEnd,
    ) {
        if !self.paths.records.is_observed() {
            return;
        }
        let held = self.paths.records.hold(left.after, right.after) & lanes;
        if held != 0 {
            let StickSegment {
                after,
                noise,
                force,
                ..
            } = stick_piece(left, right, displacement);
            let x = displacement;
            let left = [after.0, noise.0, force.0, x, x, x, x, x];
            let right = [after.1, noise.1, force.1, x, x, x, x, x];
            self.paths
                .records
                .sticks(kind)
                .push(rows, held, left, right);
        }
    }
}

/// The entries of a column in these rows.
#[inline(always)]
fn at<L: Lanes>(column: &[f64], rows: &RowNumbers) -> L {
    let mut values = [0.0; ROW];
    for (value, &row) in values.iter_mut().zip(rows) {
        *value = column[row as usize];
    }
    L::load(&values)
}

/// Sets x, x' and T in these lanes.
#[inline(always)]
fn set<L: Lanes>(
    seen: &mut StateColumns,
    rows: &RowNumbers,
    mut lanes: u32,
    (x, v, temperature): (L, L, L),
    is_static: bool,
) {
    let (mut xs, mut vs, mut ts) = ([0.0; ROW], [0.0; ROW], [0.0; ROW]);
    x.store(&mut xs);
    v.store(&mut vs);
    temperature.store(&mut ts);
    while lanes != 0 {
        let i = lanes.trailing_zeros() as usize;
        seen.set(rows[i] as usize, (xs[i], vs[i], ts[i], is_static));
        lanes &= lanes - 1;
    }
}
