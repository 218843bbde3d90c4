//! Sticks that may be left in the macro step.

use super::super::law::{ATTEMPTS, Node, Scene, StickEnd, StickStep, ends};
use super::crossing::{Crossing, Task};
use super::jobs::{Count, DEPTH, Jobs, RowNumbers};
use super::slip::Begun;
use super::states::Border;
use crate::lanes::{Lanes, ROW};
use crate::model::{EventKind, Sign};
use crate::noise::{LaneDraws, TimeChange, short_bridge_middle};

/// A piece of a stick between two known values of n.
#[derive(Clone, Copy)]
pub(super) struct SearchedStick<L: Lanes> {
    pub left: Node<L>,
    pub right: Node<L>,
    pub x: L,
    /// The side, 1 or -1, on which it is left.
    pub side: L,
    pub count: Count<L>,
    pub origin: L::Bits,
    pub key: L::Bits,
}

impl<L: Lanes> SearchedStick<L> {
    #[inline(always)]
    pub fn put(&self, jobs: &mut Jobs, rows: &RowNumbers) {
        let Node {
            after,
            noise,
            force,
            curvature,
        } = self.left;
        let zero = L::splat(0.0);
        L::scatter_rows(
            [
                after,
                noise,
                force,
                curvature,
                self.count.number(),
                self.x,
                self.side,
                zero,
            ],
            &mut jobs.left,
            rows,
        );
        L::scatter_rows(self.row_of(&self.right), &mut jobs.right, rows);
    }

    #[inline(always)]
    fn get(jobs: &Jobs, rows: &RowNumbers) -> Self {
        let rows = &jobs.known(rows);
        let [after, noise, force, curvature, count, x, side, _] = L::gather_rows(&jobs.left, rows);
        let (right, origin, key) = node_of(L::gather_rows(&jobs.right, rows));
        SearchedStick {
            left: Node {
                after,
                noise,
                force,
                curvature,
            },
            right,
            x,
            side,
            count: Count::of(count),
            origin,
            key,
        }
    }

    #[inline(always)]
    fn row_of(
        &self,
        &Node {
            after,
            noise,
            force,
            curvature,
        }: &Node<L>,
    ) -> [L; ROW] {
        let zero = L::splat(0.0);
        [
            after,
            noise,
            force,
            curvature,
            zero,
            zero,
            L::from_bits(self.origin),
            L::from_bits(self.key),
        ]
    }

    #[inline(always)]
    fn draws(&self, macro_step: u64) -> LaneDraws<L> {
        self.count.draws(macro_step, self.origin, self.key)
    }

    #[inline(always)]
    fn step(&self, scene: &Scene) -> StickStep<L> {
        let length = self.length();
        StickStep {
            length,
            noise: TimeChange::short(scene.relaxation_rate, scene.diffusion, length),
        }
    }

    #[inline(always)]
    fn length(&self) -> L {
        self.right.after - self.left.after
    }
}

#[inline(always)]
fn node_of<L: Lanes>(
    [after, noise, force, curvature, _, _, origin, key]: [L; ROW],
) -> (Node<L>, L::Bits, L::Bits) {
    (
        Node {
            after,
            noise,
            force,
            curvature,
        },
        origin.to_bits(),
        key.to_bits(),
    )
}

impl<L: Lanes> Crossing<'_, '_, L> {
    /// Begins a stick in the macro step, in these lanes, in which K x - g is `spring`.
    #[inline(always)]
    pub(super) fn begin_stick(
        &mut self,
        rows: &RowNumbers,
        lanes: u32,
        piece: &SearchedStick<L>,
        spring: L,
    ) {
        let zero = L::splat(0.0);
        let end_force = L::splat(self.macro_step.last.value) + piece.right.noise - spring;
        let SearchedStick {
            x,
            count,
            origin,
            key,
            ..
        } = *piece;
        let flip = count.flip();
        let next = Border {
            x,
            v: zero,
            n: piece.right.noise,
            force: end_force,
            eps: zero,
            origin,
            key,
            flip,
        };
        self.set_next(rows, lanes, next, false);
        let own = self.paths.jobs.only::<L>(rows, lanes);
        self.queue_piece(*piece, rows, &own, lanes);
    }

    /// Puts each piece into the queue of its next task. Where the piece is clear, the lane goes on
    /// to the next waiting piece. `own` are the rows that are written.
    #[inline(always)]
    fn queue_piece(
        &mut self,
        mut piece: SearchedStick<L>,
        rows: &RowNumbers,
        own: &RowNumbers,
        lanes: u32,
    ) {
        piece.count = piece.count.spent();
        piece.put(&mut self.paths.jobs, own);
        let (band, scene) = (&self.paths.noisy.propagation.band, &self.paths.noisy.scene);
        let reach = band.reach(
            scene,
            piece.length(),
            (&piece.left, &piece.right),
            &scene.constant_limits(),
        );
        let near = L::bitmask(reach.is_near) & lanes;
        let long = L::bitmask(reach.is_long) & near;
        self.queue(Task::Halve, rows, long);
        self.queue(Task::Decide, rows, near & !long);
        self.saw_stick(
            rows,
            lanes & !near,
            (&piece.left, &piece.right),
            piece.x,
            StickEnd::Clear,
        );
        let more = !L::bitmask(piece.count.has_none());
        self.queue(Task::StickOn, rows, lanes & !near & more);
    }

    /// Draws n in the middle of the pieces.
    #[inline(always)]
    pub(super) fn halve(&mut self, rows: &RowNumbers, lanes: u32) {
        let mut piece = SearchedStick::<L>::get(&self.paths.jobs, rows);
        let fallback = L::bitmask(piece.count.has(DEPTH as f64 - 1.0)) & lanes;
        self.fall_back(rows, fallback);
        let lanes = lanes & !fallback;
        let scene = &self.paths.noisy.scene;
        let h = piece.length();
        let (weight, sd) = short_bridge_middle(scene.relaxation_rate, scene.diffusion, h);
        let normal = piece
            .draws(self.macro_step.index)
            .normal(self.paths.normals, 0);
        let noise = weight * (piece.left.noise + piece.right.noise) + sd * normal;
        let after = piece.left.after + h * 0.5;
        let forcing = self.macro_step.forcing(after);
        let spring = scene.spring_at(piece.x, L::splat(self.macro_step.start));
        let force = forcing.value - spring + noise;
        self.paths
            .jobs
            .place_behind(rows, piece.count, piece.row_of(&piece.right));
        piece.count = piece.count.drawn(1).behind_where(L::always());
        piece.right = Node {
            after,
            noise,
            force,
            curvature: forcing.curvature,
        };
        self.queue_piece(piece, rows, rows, lanes);
    }

    /// Goes on to the next piece.
    #[inline(always)]
    pub(super) fn stick_on(&mut self, rows: &RowNumbers, lanes: u32) {
        let mut piece = SearchedStick::<L>::get(&self.paths.jobs, rows);
        piece.left = piece.right;
        piece.count = piece.count.taken();
        (piece.right, ..) = node_of(self.paths.jobs.last_behind(rows, piece.count));
        self.queue_piece(piece, rows, rows, lanes);
    }

    /// Decides whether pieces are left.
    #[inline(always)]
    pub(super) fn decide(&mut self, rows: &RowNumbers, lanes: u32) {
        let mut piece = SearchedStick::<L>::get(&self.paths.jobs, rows);
        let scene = &self.paths.noisy.scene;
        let step = piece.step(scene);
        let [up, down] = step.first_meeting_probabilities(
            scene,
            &ends(&piece.left, &piece.right, scene.constant_limits()),
        );
        let u = piece.draws(self.macro_step.index).uniform(0);
        let one = L::splat(1.0);
        let is_up = u.lt(up);
        let is_left = L::or(is_up, u.gt(one - down));
        let left = L::bitmask(is_left) & lanes;
        piece.side = L::select(is_up, one, -one);
        // A stick that is left has no waiting pieces any more. The attempts to find the time are
        // counted in their place.
        piece.count = piece.count.drawn(1).scalar_where(is_left);
        piece.put(&mut self.paths.jobs, rows);
        let kept = lanes & !left;
        self.saw_stick(
            rows,
            kept,
            (&piece.left, &piece.right),
            piece.x,
            StickEnd::Kept,
        );
        let more = !L::bitmask(piece.count.has_none());
        self.queue(Task::StickOn, rows, kept & more);
        self.queue(Task::Leave, rows, left);
    }

    /// Finds when pieces are left.
    #[inline(always)]
    pub(super) fn leave(&mut self, rows: &RowNumbers, lanes: u32) {
        let piece = SearchedStick::<L>::get(&self.paths.jobs, rows);
        let scene = &self.paths.noisy.scene;
        let (step, ends) = (
            piece.step(scene),
            ends(&piece.left, &piece.right, scene.constant_limits()),
        );
        let SearchedStick {
            x,
            side,
            origin,
            key,
            count,
            ..
        } = piece;
        let draws = piece.draws(self.macro_step.index);
        let numbers = [
            draws.normal(self.paths.normals, 0),
            draws.uniform(1),
            draws.uniform(2),
        ];
        let (passed, is_accepted) = step.meeting_time(scene, side, &ends, numbers);
        let is_found = L::or(is_accepted, count.has(ATTEMPTS as f64 - 1.0));
        let again = lanes & !L::bitmask(is_found);
        if again != 0 {
            let own = self.paths.jobs.only::<L>(rows, again);
            let count = count.drawn(3).behind_where(L::always());
            SearchedStick { count, ..piece }.put(&mut self.paths.jobs, &own);
            self.queue(Task::Leave, rows, again);
        }
        let lanes = lanes & !again;
        let after = piece.left.after + passed;
        let force = side * scene.friction.static_force;
        let spring = scene.spring_at(x, L::splat(self.macro_step.start));
        let noise = force - self.macro_step.forcing(after).value + spring;
        let exit = Node {
            after,
            noise,
            force,
            curvature: L::splat(0.0),
        };
        self.saw_stick(rows, lanes, (&piece.left, &exit), x, StickEnd::Exit);
        self.report(rows, lanes, (after, x, force), |force, _| {
            EventKind::SlipStarted(Sign::of(force))
        });
        let count = count.drawn(3).spent().scalar_where(L::always());
        let own = self.paths.jobs.only::<L>(rows, lanes);
        Begun {
            after,
            noise,
            force,
            eps: side,
            x,
            count,
            origin,
            key,
        }
        .put(&mut self.paths.jobs, &own);
        self.queue(Task::Begin, rows, lanes);
    }
}
