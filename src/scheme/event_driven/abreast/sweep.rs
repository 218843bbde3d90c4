//! Takes all lanes across a cell as if it had no event, and finds the lanes that may have one.

use super::Crossing;
use super::jobs::{Count, Rows, Task};
use super::slip::Searched;
use super::stick::Piece;
use crate::lanes::Lanes;
use crate::noise::LaneDraws;
use crate::scheme::event_driven::cell_loop::{Cascade as _, EVENT_PLACE, NOISE_PLACE, WHOLE_PLACE};
use crate::scheme::event_driven::corridor::Node;
use crate::scheme::event_driven::first_stop::Interval;
use crate::scheme::event_driven::slip_step::{Push, State, force, motion, resolved_travel};
use crate::scheme::event_driven::slip_transition::{SlipTransition, splat};

impl<L: Lanes> Crossing<'_, '_, L> {
    /// Takes every lane to the end of the cell, and puts the flagged lanes into queues.
    #[inline(always)]
    pub(super) fn sweep(&mut self) {
        let (step, root_length) = self.paths.noisy.usual_step();
        let transition = splat::<L>(step);
        let whole = WholeStep::new(self.paths.noisy.pushes(self.cell));
        let rows: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
        for lane in (0..self.paths.keys[0].len()).step_by(L::WIDTH) {
            let rows = rows.map(|i| lane as u32 + i);
            let draws = self.draws_of(lane, self.cell.index << 32);
            let normal = draws.normal(self.paths.normals, NOISE_PLACE);
            let n = L::load(&self.paths.now.n[lane..]);
            let end_noise = n * self.cell.transition.decay + normal * self.cell.transition.increment_sd;
            end_noise.store(&mut self.paths.next.n[lane..]);
            let spent = L::load_bits(&self.paths.spent[lane..]);
            L::store_bits(L::add_bits(spent, L::splat_bits(1)), &mut self.paths.spent[lane..]);

            let eps = L::load(&self.paths.now.eps[lane..]);
            eps.store(&mut self.paths.next.eps[lane..]);
            let is_slip = eps.abs().gt(L::splat(0.0));
            let present = self.present(lane);
            let slips = L::bitmask(is_slip) & present;
            let sticks = present & !slips;
            let x = L::load(&self.paths.now.x[lane..]);
            let (mut x1, mut v1) = (x, L::splat(0.0));
            let mut force1 =
                L::splat(self.cell.last.value) + end_noise - x * self.paths.noisy.scene().oscillator.stiffness;
            if slips != 0 {
                let start = State { x, v: L::load(&self.paths.now.v[lane..]), n };
                let (end, end_force) =
                    self.slip_whole(&transition, root_length, &whole, (lane, &rows, slips), (start, eps), &draws);
                (x1, v1) = (L::select(is_slip, end.x, x), L::select(is_slip, end.v, v1));
                force1 = L::select(is_slip, end_force, force1);
            }
            if sticks != 0 {
                self.stick_whole((lane, &rows, sticks), (x, n, end_noise), &draws);
            }
            x1.store(&mut self.paths.next.x[lane..]);
            v1.store(&mut self.paths.next.v[lane..]);
            force1.store(&mut self.paths.next.force[lane..]);
        }
    }

    /// The random numbers of neighbouring lanes.
    #[inline(always)]
    fn draws_of(&self, lane: usize, counter: u64) -> LaneDraws<L> {
        LaneDraws {
            origin: L::load_bits(&self.paths.keys[0][lane..]),
            key: L::load_bits(&self.paths.keys[1][lane..]),
            counter: L::splat_bits(counter),
            flip: L::load_bits(&self.paths.keys[2][lane..]),
        }
    }

    /// A mask of the lanes from here on that hold a path which has not been given up.
    #[inline(always)]
    fn present(&self, lane: usize) -> u32 {
        let last = self.paths.count.min(lane + L::WIDTH);
        let mut present = 0;
        for i in lane..last {
            present |= u32::from(!self.paths.is_lost[i]) << (i - lane);
        }
        present
    }

    #[inline(always)]
    fn stick_whole(
        &mut self,
        (lane, rows, sticks): (usize, &Rows, u32),
        (x, n, end_noise): (L, L, L),
        draws: &LaneDraws<L>,
    ) {
        let scene = self.paths.noisy.scene();
        let force = L::load(&self.paths.now.force[lane..]);
        let left = Node { after: L::splat(0.0), noise: n, force, curvature: L::splat(self.cell.first.curvature) };
        let end_force = L::splat(self.cell.last.value) - x * scene.oscillator.stiffness + end_noise;
        let curvature = L::splat(self.cell.last.curvature);
        let right = Node { after: L::splat(self.cell.length), noise: end_noise, force: end_force, curvature };
        let is_out = L::bitmask(force.abs().ge(L::splat(scene.friction.static_force))) & sticks;
        let reach = self.paths.noisy.corridor().reach(scene, right.after, &left, &right);
        let near = L::bitmask(reach.is_near) & sticks & !is_out;
        if (near | is_out) != 0 {
            self.odd_lanes(rows, is_out);
            let count = Count::from(EVENT_PLACE, draws.flip);
            let piece = Piece { left, right, x, count, origin: draws.origin, key: draws.key };
            let own = self.paths.jobs.only::<L>(rows, near);
            piece.put(&mut self.paths.jobs, &own);
            self.flag(rows, near);
            let is_long = L::bitmask(reach.is_long) & near;
            self.paths.jobs.push::<L>(Task::Halve, rows, is_long);
            self.paths.jobs.push::<L>(Task::Decide, rows, near & !is_long);
        }
    }

    #[inline(always)]
    fn slip_whole(
        &mut self,
        transition: &SlipTransition<L>,
        root_length: f64,
        whole: &WholeStep,
        (lane, rows, slips): (usize, &Rows, u32),
        (start, eps): (State<L>, L),
        draws: &LaneDraws<L>,
    ) -> (State<L>, L) {
        let scene = self.paths.noisy.scene();
        let body = &scene.oscillator;
        let friction = eps * scene.friction.dynamic_force;
        let mut mean = transition.free(start, friction);
        for push in &whole.pushes {
            (mean.x, mean.v) = (mean.x + push.x, mean.v + push.v);
        }
        let end_noise = L::load(&self.paths.next.n[lane..]);
        let end = transition.drawn(mean, end_noise, draws.normal_pair(self.paths.normals, WHOLE_PLACE));
        let end_force = force(body, L::splat(whole.forcing), end);
        let first = motion(body, eps, start.v, L::load(&self.paths.now.force[lane..]), friction);
        let last = motion(body, eps, end.v, end_force, friction);
        let length = L::splat(self.cell.length);
        let search = self.paths.noisy.search();
        let interval = Interval {
            end: last,
            travel: resolved_travel(eps * start.x, eps * end.x, first, last, length),
            length,
            inverse: L::splat(1.0 / self.cell.length),
            noise: L::splat(search.noise * root_length),
        };
        let finite = L::bitmask(last.is_finite()) & slips;
        let clear = L::bitmask(search.is_clear(first, &interval)) & finite;
        let flagged = slips & !clear;
        if flagged != 0 {
            self.odd_lanes(rows, flagged & !finite);
            let zero = L::splat(0.0);
            let searched = Searched {
                left: first,
                after: zero,
                travel: zero,
                count: Count::from(EVENT_PLACE, draws.flip),
                x: start.x,
                start: zero,
                eps,
                interval,
                origin: draws.origin,
                key: draws.key,
            };
            let own = self.paths.jobs.only::<L>(rows, flagged);
            searched.put(&mut self.paths.jobs, &own);
            self.flag(rows, flagged);
            let stops = L::bitmask(search.is_stop(first, &interval)) & flagged & finite;
            self.paths.jobs.push::<L>(Task::Stop, rows, stops);
            self.paths.jobs.push::<L>(Task::Bisect, rows, flagged & finite & !stops);
        }
        (end, end_force)
    }

    /// Notes that these lanes may have an event.
    #[inline(always)]
    fn flag(&mut self, rows: &Rows, lanes: u32) {
        let flagged = L::compress(rows, lanes);
        self.paths.jobs.flagged.extend_from_slice(&flagged[..lanes.count_ones() as usize]);
    }

    /// Marks lanes that have to cross the cell again, alone.
    #[inline(always)]
    pub(super) fn odd_lanes(&mut self, rows: &Rows, mut lanes: u32) {
        while lanes != 0 {
            self.paths.odd.push(rows[lanes.trailing_zeros() as usize]);
            lanes &= lanes - 1;
        }
    }
}

/// The contribution of the forcing to every slip over the whole cell.
struct WholeStep {
    pushes: Vec<Push>,
    /// B at the end.
    forcing: f64,
}

impl WholeStep {
    fn new(pushes: Vec<Push>) -> Self {
        let forcing = pushes.iter().map(|push| push.term.re).sum();
        WholeStep { pushes, forcing }
    }
}
