//! The steps under a user-defined force g.
//!
//! g is computed for many paths at once, so that dispatching each of its operations costs little.
//! So all paths make a step before any of them makes the next one, in groups whose states stay in
//! the nearest cache, and the normals of several steps are drawn in advance.
//!
//! Where friction has a load, or g a direction, S is computed with the forces of either direction
//! ([`crate::model::Sides`]), and the body moves in that in which friction does not hold it.

use super::{LaneRun, Regime, Splat, State, note};
use crate::lanes::Lanes;
use crate::model::Sign;
use std::ops::Range;

/// Paths that are stepped together: whole registers.
const TOGETHER: usize = 256;

/// Steps whose increments of the noise are drawn at once.
const DRAWN: usize = 8;

/// Buffers for the paths of a group, in addition to their states.
struct GroupBuffers<L: Lanes> {
    /// How each register of paths moves.
    regimes: [Regime<L>; TOGETHER],
    /// The increments of the noise, `[step][path]`.
    chi: [[f64; TOGETHER]; DRAWN],
    /// g of each path; with a load, that which starts a slip and that in a slip, upwards and
    /// downwards.
    g: [[f64; TOGETHER]; 4],
}

impl<const OWN: bool, const NOISE: bool, const CORRECTED: bool> LaneRun<'_, OWN, NOISE, CORRECTED> {
    /// Takes every path through the whole run.
    #[inline(always)]
    pub(super) fn advance_forced<L: Lanes>(&mut self) {
        let c = Splat::<L>::new(self.c);
        let regimes = [c.regime(L::splat(0.0)); TOGETHER];
        let mut buffers = GroupBuffers {
            regimes,
            chi: [[0.0; TOGETHER]; DRAWN],
            g: [[0.0; TOGETHER]; 4],
        };
        let (lanes, steps) = (self.work.paths.noise.len(), self.work.forcing.len() - 1);
        let has_load = self
            .kernel
            .own
            .as_ref()
            .is_some_and(|own| own.sides().is_some());
        for lane in (0..lanes).step_by(TOGETHER) {
            let group = lane..lanes.min(lane + TOGETHER);
            let velocities = self.work.paths.velocity[group.clone()].chunks_exact(L::WIDTH);
            for (regime, v) in buffers.regimes.iter_mut().zip(velocities) {
                *regime = c.regime(L::load(v));
            }
            for n in 0..steps {
                if NOISE && n % DRAWN == 0 {
                    self.draw::<L>(group.clone(), &mut buffers.chi[..DRAWN.min(steps - n)]);
                }
                self.compute(group.clone(), n, &mut buffers.g);
                if has_load {
                    self.step::<L, true>(&c, group.clone(), n, &mut buffers);
                } else {
                    self.step::<L, false>(&c, group.clone(), n, &mut buffers);
                }
            }
        }
    }

    /// Draws the increments of the noise of these paths over several steps.
    #[inline(always)]
    fn draw<L: Lanes>(&mut self, group: Range<usize>, chi: &mut [[f64; TOGETHER]]) {
        for from in (0..group.len()).step_by(L::WIDTH) {
            let mut normals = self.work.streams.take::<L, 1>(group.start + from);
            for chi in chi.iter_mut() {
                self.scale.increment(&mut normals)[0].store(&mut chi[from..]);
            }
            self.work.streams.put(group.start + from, &normals);
        }
    }

    /// g of these paths at the n-th instant of the run.
    #[inline(always)]
    fn compute(&self, group: Range<usize>, n: usize, g: &mut [[f64; TOGETHER]; 4]) {
        if let Some(own) = &self.kernel.own {
            let time = (self.work.n + n as u64) as f64 * self.c.h;
            let (x, v) = (
                &self.work.paths.displacement[group.clone()],
                &self.work.paths.velocity[group.clone()],
            );
            let [up, down] = own.in_stick();
            let all = [
                up,
                down,
                own.in_slip(Sign::Positive),
                own.in_slip(Sign::Negative),
            ];
            let needed = if own.sides().is_some() { 4 } else { 1 };
            for (force, g) in all.into_iter().zip(g).take(needed) {
                force.fill(self.kernel.instructions, x, v, time, &mut g[..group.len()]);
            }
        }
    }

    /// Takes these paths from the n-th instant of the run to the next one.
    #[inline(always)]
    fn step<L: Lanes, const LOAD: bool>(
        &mut self,
        c: &Splat<L>,
        group: Range<usize>,
        n: usize,
        buffers: &mut GroupBuffers<L>,
    ) {
        let (zero, forcing) = (L::splat(0.0), L::splat(self.work.forcing[n]));
        let every_lane = (1 << L::WIDTH) - 1;
        let paths = &mut *self.work.paths;
        let x = paths.displacement[group.clone()].chunks_exact_mut(L::WIDTH);
        let v = paths.velocity[group.clone()].chunks_exact_mut(L::WIDTH);
        let noise = paths.noise[group.clone()].chunks_exact_mut(L::WIDTH);
        let [g, sides @ ..] = &buffers.g;
        let (g, chi) = (
            g.chunks_exact(L::WIDTH),
            buffers.chi[n % DRAWN].chunks_exact(L::WIDTH),
        );
        let mut lane = group.start;
        for (((((x, v), noise), g), chi), regime) in x
            .zip(v)
            .zip(noise)
            .zip(g)
            .zip(chi)
            .zip(&mut buffers.regimes)
        {
            let state = State {
                x: L::load(x),
                v: L::load(v),
                noise: if NOISE { L::load(noise) } else { zero },
            };
            let b = c.force::<NOISE>(&state, forcing);
            let s = c.impulse(b + L::load(g), &state);
            let (turned, mut next_v);
            if LOAD {
                let [lower, up, down] = sides;
                let at = lane - group.start;
                let (is_up, _) = c.beyond(s, state.v);
                let (_, is_down) = c.beyond(c.impulse(b + L::load(&lower[at..]), &state), state.v);
                let up = c
                    .impulse(b + L::load(&up[at..]), &state)
                    .sub(c.dynamic_impulse);
                let down = c
                    .impulse(b + L::load(&down[at..]), &state)
                    .add(c.dynamic_impulse);
                // The corrected scheme may let go a body that friction would still brake.
                next_v = L::either(
                    L::and(is_up, up.gt(zero)),
                    up,
                    L::and(is_down, down.lt(zero)),
                    down,
                );
                next_v = up.mul_add(zero, down.mul_add(zero, next_v));
                let (was_up, was_down) =
                    (L::bitmask(state.v.gt(zero)), L::bitmask(state.v.lt(zero)));
                turned = (was_up ^ L::bitmask(next_v.gt(zero)))
                    | (was_down ^ L::bitmask(next_v.lt(zero)));
            } else {
                turned = every_lane ^ L::bitmask(regime.holds(s, L::always()));
                next_v = regime.velocity(s);
                if turned != 0 {
                    next_v = c.settle(s, c.beyond(s, state.v));
                }
            }
            // NaN if the force is NaN: otherwise the body would be considered at rest.
            next_v = s.mul_add(zero, next_v);
            let next = c.next::<NOISE, CORRECTED>(&state, next_v, L::load(chi));
            if turned != 0 {
                note(self.work.turns, lane, n, turned, &state, &next);
                *regime = c.regime(next_v);
            }
            next.x.store(x);
            next.v.store(v);
            if NOISE {
                next.noise.store(noise);
            }
            lane += L::WIDTH;
        }
    }
}
