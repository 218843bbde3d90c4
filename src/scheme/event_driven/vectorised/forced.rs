//! Slip steps under a user-defined force, in lanes. Only steps that need not be halved are taken
//! here; other lanes cross the macro step in scalar form.

use super::super::law::{ForcedStart, SAME_LENGTH, SlipPoint, SlipTransition, Trial};
use super::crossing::Crossing;
use crate::lanes::Lanes;
use crate::model::Sign;

/// A step to the end of the macro step.
pub(super) struct ForcedStep<L: Lanes> {
    start: ForcedStart<L>,
    trial: Trial<L>,
    friction: L,
    is_resolved: L::Mask,
}

impl<L: Lanes> ForcedStep<L> {
    /// The constant that stands for g.
    #[inline(always)]
    pub fn push(own: &Option<Self>) -> L {
        own.as_ref().map_or(L::splat(0.0), |own| own.trial.means[0])
    }

    /// Where g is resolved.
    #[inline(always)]
    pub fn is_resolved(own: &Option<Self>) -> L::Mask {
        own.as_ref().map_or(L::always(), |own| own.is_resolved)
    }
}

impl<L: Lanes> Crossing<'_, '_, L> {
    /// A step of this length from a state with its b, a time after the start of the macro step;
    /// none if there is no g.
    #[inline(always)]
    pub(super) fn forced_step(
        &self,
        eps: L,
        (state, force): (SlipPoint<L>, L),
        after: L,
        length: L,
    ) -> Option<ForcedStep<L>> {
        let scene = &self.paths.noisy.scene;
        if !scene.own.is_some() {
            return None;
        }
        // Without friction by direction, g is the same in both.
        let (direction, time) = (Sign::Positive, after + self.macro_step.start);
        let friction = eps * scene.friction.dynamic_force;
        let mut here = [force];
        scene
            .own
            .at_points(direction, [&[state.x], &[state.v], &[time]], &mut here);
        let start = ForcedStart {
            direction,
            x: state.x,
            v: state.v,
            force,
            acceleration: (force - friction) / L::splat(scene.oscillator.mass),
            time,
            here: here[0],
        };
        let (spread, is_usual) = self.spread(length);
        let trial = start.trial(scene, length, spread);
        let limits = start.limits(scene, &self.paths.noisy.rules);
        Some(ForcedStep {
            start,
            trial,
            friction,
            is_resolved: L::and(is_usual, trial.is_resolved(&limits)),
        })
    }

    /// How far the noise may take x and x' in the shortest halved step that is not shorter than
    /// this, and where it is the longest, or the step is not one of them.
    #[inline(always)]
    fn spread(&self, length: L) -> ([L; 2], L::Mask) {
        let halved = &self.paths.noisy.halved;
        let whole = length.ge(L::splat(halved[0].length()));
        let mut spread = halved[0].spread().map(L::splat);
        let mut is_usual = L::always();
        for step in &halved[1..] {
            let (least, most) = (1.0 - SAME_LENGTH, 1.0 + SAME_LENGTH);
            let is_within = length.le(L::splat(step.length()));
            let [x, v] = step.spread().map(L::splat);
            spread = [
                L::select(is_within, x, spread[0]),
                L::select(is_within, v, spread[1]),
            ];
            let is_step = L::and(
                length.ge(L::splat(step.length() * least)),
                length.le(L::splat(step.length() * most)),
            );
            is_usual = L::and(is_usual, L::not(is_step));
            if L::bitmask(length.le(L::splat(step.length() * most))) == 0 {
                break;
            }
        }
        (spread, L::or(whole, is_usual))
    }

    /// The end of a step that was drawn with the constant for g, and b there.
    #[inline(always)]
    pub(super) fn corrected(
        &self,
        own: &Option<ForcedStep<L>>,
        transition: &SlipTransition<L>,
        after: L,
        (end, end_force): (SlipPoint<L>, L),
    ) -> (SlipPoint<L>, L) {
        let Some(own) = own else {
            return (end, end_force);
        };
        let time = after + transition.length + self.macro_step.start;
        let scene = &self.paths.noisy.scene;
        let drawn = (end, end_force, time);
        let to = own
            .start
            .corrected(scene, transition, &own.trial, drawn, own.friction);
        (
            SlipPoint {
                x: to.x,
                v: to.v,
                ..end
            },
            to.force,
        )
    }
}
