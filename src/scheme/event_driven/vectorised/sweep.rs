//! Takes all lanes across a macro step as if it had no event, and finds the lanes that may have
//! one.

use super::super::law::{EVENT_PLACE, Extent, NOISE_PLACE, Node, SlipPoint, WHOLE_PLACE, force};
use super::super::noisy::Noisy;
use super::Vectorised;
use super::crossing::{Crossing, Task};
use super::forced::ForcedStep;
use super::jobs::{Count, RowNumbers};
use super::shared_step::SharedStep;
use super::slip::SearchedSlip;
use super::states::Border;
use super::stick::SearchedStick;
use crate::lanes::Lanes;

impl<L: Lanes> Crossing<'_, '_, L> {
    /// Takes every lane to the end of the macro step, and puts the flagged lanes into queues.
    #[inline(always)]
    pub(super) fn sweep(&mut self) {
        let Vectorised {
            phases,
            slips,
            sticks,
            spent,
            jobs,
            ..
        } = &mut *self.paths;
        jobs.width = L::WIDTH;
        phases.divide::<L>(slips, sticks);
        spent.iter_mut().for_each(|spent| *spent += 1);
        let nobody = self.paths.jobs.nobody();
        let whole = SharedStep::<L>::new(&self.paths.noisy.step, self.macro_step);
        let has_one_step = self.paths.noisy.has_one_step_a_macro_step();
        let is_forced = self.paths.noisy.scene.own.is_some();
        while let Some((rows, lanes)) = self.paths.slips.pop::<L>(nobody) {
            if has_one_step {
                // The trial of a step under g is an evaluation of its own.
                if is_forced {
                    let rows = &rows[..lanes.count_ones() as usize];
                    rows.iter()
                        .for_each(|row| self.paths.spent[*row as usize] += 1);
                }
                self.slip_whole(&whole, &rows, lanes);
            } else {
                self.fall_back(&rows, lanes);
            }
        }
        let is_moved = self.paths.noisy.scene.own.depends_on_time();
        while let Some((rows, lanes)) = self.paths.sticks.pop::<L>(nobody) {
            if is_moved {
                self.fall_back(&rows, lanes);
            } else {
                self.stick_whole(&rows, lanes);
            }
        }
    }

    /// The extent of a step over the whole macro step.
    #[inline(always)]
    pub(super) fn whole_extent(&self) -> Extent<L> {
        let Noisy { search, step, .. } = self.paths.noisy;
        Extent {
            length: L::splat(self.macro_step.length),
            inverse: L::splat(1.0 / self.macro_step.length),
            noise: L::splat(search.noise * step.root_length),
        }
    }

    /// Draws n at the end of the macro step.
    #[inline(always)]
    fn end_noise_of(&self, now: &Border<L>) -> L {
        let normal = now
            .draws(self.macro_step.index << 32)
            .normal(self.paths.normals, NOISE_PLACE);
        now.n * self.macro_step.transition.decay + normal * self.macro_step.transition.increment_sd
    }

    #[inline(always)]
    fn stick_whole(&mut self, rows: &RowNumbers, lanes: u32) {
        let scene = &self.paths.noisy.scene;
        let now = Border::<L>::get(&self.paths.now, &self.paths.jobs.known(rows));
        let end_noise = self.end_noise_of(&now);
        let Border { x, n, force, .. } = now;
        let spring = scene.spring_at(x, L::splat(self.macro_step.start));
        let force1 = L::splat(self.macro_step.last.value) + end_noise - spring;
        Border {
            n: end_noise,
            force: force1,
            ..now
        }
        .put(&mut self.paths.next, rows);
        let left = Node {
            after: L::splat(0.0),
            noise: n,
            force,
            curvature: L::splat(self.macro_step.first.curvature),
        };
        let end_force = L::splat(self.macro_step.last.value) - spring + end_noise;
        let curvature = L::splat(self.macro_step.last.curvature);
        let right = Node {
            after: L::splat(self.macro_step.length),
            noise: end_noise,
            force: end_force,
            curvature,
        };
        let is_inside = force.abs().lt(L::splat(scene.friction.static_force));
        let is_finite = end_force.abs().lt(L::splat(f64::INFINITY));
        let is_out = lanes & !L::bitmask(L::and(is_inside, is_finite));
        let reach = self.paths.noisy.propagation.band.reach(
            scene,
            right.after,
            (&left, &right),
            &scene.constant_limits(),
        );
        let near = L::bitmask(reach.is_near) & lanes & !is_out;
        if (near | is_out) != 0 {
            self.fall_back(rows, is_out);
            let count = Count::from(EVENT_PLACE, now.flip);
            let piece = SearchedStick {
                left,
                right,
                x,
                side: L::splat(0.0),
                count,
                origin: now.origin,
                key: now.key,
            };
            let own = self.paths.jobs.only::<L>(rows, near);
            piece.put(&mut self.paths.jobs, &own);
            self.paths.jobs.flag::<L>(rows, near);
            let is_long = L::bitmask(reach.is_long) & near;
            self.queue(Task::Halve, rows, is_long);
            self.queue(Task::Decide, rows, near & !is_long);
        }
    }

    #[inline(always)]
    fn slip_whole(&mut self, whole: &SharedStep<L>, rows: &RowNumbers, lanes: u32) {
        let scene = &self.paths.noisy.scene;
        let now = Border::<L>::get(&self.paths.now, &self.paths.jobs.known(rows));
        let end_noise = self.end_noise_of(&now);
        let (eps, zero) = (now.eps, L::splat(0.0));
        let start = SlipPoint {
            x: now.x,
            v: now.v,
            n: now.n,
        };
        let transition = &whole.transition;
        let own = self.forced_step(eps, (start, now.force), zero, transition.length);
        let friction = eps * scene.friction.dynamic_force - ForcedStep::push(&own);
        let normals = now
            .draws(self.macro_step.index << 32)
            .normal_pair(self.paths.normals, WHOLE_PLACE);
        let end = transition.drawn(whole.mean(start, friction), end_noise, normals);
        let end_force = force(&scene.oscillator, L::splat(whole.forcing), end);
        let (end, end_force) = self.corrected(&own, transition, zero, (end, end_force));
        let resolved = lanes & L::bitmask(ForcedStep::is_resolved(&own));
        self.fall_back(rows, lanes & !resolved);
        if own.is_some() {
            self.began(rows, resolved, [now.n, now.force, ForcedStep::push(&own)]);
        }
        let lanes = resolved;
        Border {
            x: end.x,
            v: end.v,
            n: end_noise,
            force: end_force,
            ..now
        }
        .put(&mut self.paths.next, rows);
        let (first, interval) =
            self.whole_extent()
                .between(scene, eps, (&start, now.force), (&end, end_force));
        let search = &self.paths.noisy.search;
        let finite = L::bitmask(interval.end.is_finite()) & lanes;
        let clear = L::bitmask(search.is_clear(first, &interval)) & finite;
        let flagged = lanes & !clear;
        if flagged != 0 {
            let searched = SearchedSlip {
                left: first,
                after: zero,
                travel: zero,
                count: Count::from(EVENT_PLACE, now.flip),
                x: start.x,
                start: zero,
                eps,
                interval,
                origin: now.origin,
                key: now.key,
            };
            let own = self.paths.jobs.only::<L>(rows, flagged);
            searched.put(&mut self.paths.jobs, &own);
            self.paths.jobs.flag::<L>(rows, flagged);
            // A slip from rest is first divided elsewhere. Only a path that slips at t = 0 is at
            // rest at the start of a macro step.
            let searches = L::bitmask(first.velocity.gt(zero)) & flagged & finite;
            self.fall_back(rows, flagged & !searches);
            let stops = L::bitmask(search.is_stop(first, &interval)) & searches;
            self.queue(Task::FindStop, rows, stops);
            self.queue(Task::Bisect, rows, searches & !stops);
        }
    }

    /// Puts these lanes into the queue of a task.
    #[inline(always)]
    pub(super) fn queue(&mut self, task: Task, rows: &RowNumbers, lanes: u32) {
        self.paths.jobs.push::<L>(task, rows, lanes);
    }

    /// Marks lanes that have to cross the macro step again in scalar form.
    #[inline(always)]
    pub(super) fn fall_back(&mut self, rows: &RowNumbers, mut lanes: u32) {
        while lanes != 0 {
            self.paths
                .fallback
                .push(rows[lanes.trailing_zeros() as usize]);
            lanes &= lanes - 1;
        }
    }
}
