//! The state of a path at instants inside a macro step.
//!
//! Events are drawn independently of the instants at which the state is observed. The state at an
//! instant is drawn given the known path on the segment around it
//! ([`crate::scheme::event_driven::law::inside`]), from random numbers that no event depends on.
//!
//! The output rows of a run are drawn first. Additional rows between them are drawn given those,
//! from other random numbers. So they agree with everything that the run has recorded.

use super::super::law::{Bridge, ObservationTime, Scene, StickEnd, StickSegment, Stuck, TRIES};
use crate::noise::{AddressedDraws, TimeChange, bridge_at};
use crate::scheme::Segment;
use crate::scheme::columns::{Seen, StateColumns};

/// An observer of one path inside a macro step.
pub trait PathObserver {
    /// Whether the path is observed inside this macro step.
    fn is_observing(&self) -> bool;
    /// Whether there are instants to observe before this time after the start of the macro step.
    fn is_ahead(&self, end: f64) -> bool;
    /// Observes a segment of the path: draws the state at all instants before its end. An instant
    /// at its end belongs to the next segment.
    fn observe<P: ObservedSegment>(&mut self, scene: &Scene, piece: impl FnOnce() -> P);
    /// Whether the motion is followed, segment by segment.
    #[inline(always)]
    fn follows(&self) -> bool {
        false
    }
    /// Takes a segment of the motion.
    #[inline(always)]
    fn segment(&mut self, _: Segment) {}
}

/// Observes one path like `observer`, and also records its motion if there is a place for it.
pub struct MotionObserver<'a, W> {
    pub observer: W,
    pub lane: usize,
    pub segments: Option<&'a mut Vec<(usize, Segment)>>,
}

impl<W: PathObserver> PathObserver for MotionObserver<'_, W> {
    #[inline(always)]
    fn is_observing(&self) -> bool {
        self.observer.is_observing() || self.follows()
    }

    #[inline(always)]
    fn is_ahead(&self, end: f64) -> bool {
        self.observer.is_ahead(end)
    }

    #[inline(always)]
    fn observe<P: ObservedSegment>(&mut self, scene: &Scene, piece: impl FnOnce() -> P) {
        self.observer.observe(scene, piece);
    }

    #[inline(always)]
    fn follows(&self) -> bool {
        self.segments.is_some()
    }

    #[inline(always)]
    fn segment(&mut self, segment: Segment) {
        if let Some(segments) = &mut self.segments {
            segments.push((self.lane, segment));
        }
    }
}

/// There are no instants to observe inside this macro step.
pub struct NullObserver;

impl PathObserver for NullObserver {
    #[inline(always)]
    fn is_observing(&self) -> bool {
        false
    }

    #[inline(always)]
    fn is_ahead(&self, _: f64) -> bool {
        false
    }

    #[inline(always)]
    fn observe<P: ObservedSegment>(&mut self, _: &Scene, _: impl FnOnce() -> P) {}
}

/// Observes one path at these times, in order.
pub struct ObservedTimes<'a> {
    pub instants: &'a [ObservationTime],
    /// When the macro step begins.
    pub macro_step_start: f64,
    /// The random numbers of the path in this macro step.
    pub draws: AddressedDraws,
    /// The lane of the path, and for each time the states of all paths.
    pub lane: usize,
    pub seen: &'a mut [StateColumns],
    /// The number of times that have been observed so far.
    pub passed: usize,
}

impl PathObserver for ObservedTimes<'_> {
    #[inline(always)]
    fn is_observing(&self) -> bool {
        true
    }

    #[inline(always)]
    fn is_ahead(&self, end: f64) -> bool {
        self.ahead(self.macro_step_start + end).next().is_some()
    }

    #[inline(always)]
    fn observe<P: ObservedSegment>(&mut self, scene: &Scene, piece: impl FnOnce() -> P) {
        let mut rest = piece();
        let end = self.macro_step_start + rest.end();
        while let Some(row) = self.ahead(end).find(|instant| !instant.is_additional) {
            let (seen, before, behind) = rest.parted(scene, row, &mut self.draws.from(row.place));
            self.observe_additional(scene, before, row.at);
            self.put(seen);
            rest = behind;
        }
        self.observe_additional(scene, rest, end);
    }
}

impl<'a> ObservedTimes<'a> {
    /// The instants that remain before the time `end`.
    fn ahead(&self, end: f64) -> impl Iterator<Item = ObservationTime> + use<'a> {
        self.instants[self.passed..]
            .iter()
            .copied()
            .take_while(move |instant| instant.at < end)
    }

    /// Draws the states at the rows between those of the run, before the time `end`.
    #[inline(always)]
    fn observe_additional<P: ObservedSegment>(&mut self, scene: &Scene, mut piece: P, end: f64) {
        while let Some(row) = self
            .ahead(end)
            .next()
            .filter(|instant| instant.is_additional)
        {
            let (seen, _, behind) = piece.parted(scene, row, &mut self.draws.from(row.place));
            self.put(seen);
            piece = behind;
        }
    }

    #[inline(always)]
    fn put(&mut self, seen: Seen) {
        self.seen[self.passed].set(self.lane, seen);
        self.passed += 1;
    }
}

/// A segment of a path without an event, except perhaps at its end.
pub trait ObservedSegment: Sized {
    /// The time at which it ends, after the start of the macro step.
    fn end(&self) -> f64;
    /// Draws the state at an instant inside the segment. Returns the state and the two parts of the
    /// segment before and after the instant.
    fn parted(
        &self,
        scene: &Scene,
        instant: ObservationTime,
        draws: &mut AddressedDraws,
    ) -> (Seen, Self, Self);
}

impl ObservedSegment for (StickSegment, StickEnd) {
    fn end(&self) -> f64 {
        self.0.after.1
    }

    #[inline(always)]
    fn parted(
        &self,
        scene: &Scene,
        instant: ObservationTime,
        draws: &mut AddressedDraws,
    ) -> (Seen, Self, Self) {
        let (piece, kind) = *self;
        let there = stuck(&piece, kind, scene, instant, draws);
        let seen = (
            piece.displacement,
            0.0,
            scene.temperature(instant.forcing, there.noise),
            true,
        );
        let before = StickSegment {
            after: (piece.after.0, instant.time),
            noise: (piece.noise.0, there.noise),
            force: (piece.force.0, there.force),
            ..piece
        };
        let kind_before = if kind == StickEnd::Clear {
            StickEnd::Clear
        } else {
            StickEnd::Kept
        };
        (
            seen,
            (before, kind_before),
            (piece.behind(instant, there), kind),
        )
    }
}

/// Draws n and b at an instant inside a piece of a stick of one path.
#[inline(always)]
fn stuck(
    piece: &StickSegment,
    kind: StickEnd,
    scene: &Scene,
    instant: ObservationTime,
    draws: &mut AddressedDraws,
) -> Stuck {
    let (before, behind) = (instant.time - piece.after.0, piece.after.1 - instant.time);
    let rest = instant.forcing - scene.spring(piece.displacement, instant.at);
    let (mean, sd) = bridge_at(
        scene.relaxation_rate,
        scene.diffusion,
        before,
        behind,
        piece.noise,
    );
    let bridge = Bridge { mean, sd, rest };
    // Where a user-defined force is not a number, no threshold is met.
    let kind = if rest.is_nan() { StickEnd::Clear } else { kind };
    let drawn = match kind {
        _ if before <= 0.0 || behind <= 0.0 => Stuck {
            noise: mean,
            force: rest + mean,
        },
        StickEnd::Clear => bridge.anywhere(draws.normal()),
        StickEnd::Kept | StickEnd::Exit => {
            let (theta, sigma) = (scene.relaxation_rate, scene.diffusion);
            let halves = [
                TimeChange::new(theta, sigma, before),
                TimeChange::new(theta, sigma, behind),
            ];
            let macro_step_start = instant.at - instant.time;
            let limits = [piece.after.0, instant.time, piece.after.1]
                .map(|after| scene.limits(piece.displacement, macro_step_start + after));
            // This is a loop, because closures are not compiled for the instruction set.
            let mut tries = 0;
            loop {
                let (drawn, is_accepted) = if kind == StickEnd::Kept {
                    let drawn = bridge.anywhere(draws.normal());
                    (
                        drawn,
                        piece.stays(limits, &halves, drawn.force, draws.uniform()),
                    )
                } else {
                    let side = piece.exit_side();
                    let limit = limits[1][usize::from(side < 0.0)];
                    let drawn = bridge.before_exit(limit, side, draws.three_normals());
                    (
                        drawn,
                        piece.misses_other(limits, &halves, drawn.force, draws.uniform()),
                    )
                };
                if is_accepted {
                    break drawn;
                }
                tries += 1;
                if tries == TRIES {
                    // All attempts fail only if both ends are very close to the threshold. Then b
                    // is interpolated linearly between them.
                    let part = before / (before + behind);
                    let force = piece.force.0 + part * (piece.force.1 - piece.force.0);
                    break Stuck {
                        noise: force - rest,
                        force,
                    };
                }
            }
        }
    };
    piece.inside(instant, drawn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scheme::event_driven::law::tests::{mean_and_error, noise_alone};

    /// Null: the mean of b at an instant inside a piece of a stick is the exact one. n is Brownian
    /// motion here, which is absorbed at both thresholds; its densities before and after the
    /// instant are sums over images. In the first piece, which begins close to the lower threshold,
    /// the mean would be closer to that threshold by 17 % if it was not looked at. 2e5 draws each;
    /// seed 51; each of the four comparisons fails by chance once in 1e4 (3.9 standard errors).
    #[test]
    fn a_row_inside_a_stick_is_drawn_between_both_thresholds() {
        let (f_s, width) = (0.9, 1.8);
        let scene = Scene::new(&noise_alone(f_s, 1e-9));
        let images = |term: &dyn Fn(f64) -> f64| {
            (-10..=10)
                .map(|k| term(2.0 * width * f64::from(k)))
                .sum::<f64>()
        };
        let normal = |x: f64, t: f64| (-x * x / (2.0 * t)).exp();
        let absorbed = |from: f64, to: f64, t: f64| {
            images(&|shift| normal(to - from + shift, t) - normal(2.0 * f_s - to - from + shift, t))
        };
        let first = |from: f64, t: f64| {
            images(&|shift| (f_s - from + shift) * normal(f_s - from + shift, t))
        };
        for (from, to, kind) in [
            (-0.75, f_s, StickEnd::Exit),
            (0.3, f_s, StickEnd::Exit),
            (-0.75, 0.6, StickEnd::Kept),
            (0.1, -0.2, StickEnd::Kept),
        ] {
            let time = 0.6;
            let density = |b: f64| {
                let after = if kind == StickEnd::Exit {
                    first(b, 1.0 - time)
                } else {
                    absorbed(b, to, 1.0 - time)
                };
                absorbed(from, b, time) * after
            };
            let (mut mass, mut moment) = (0.0, 0.0);
            for i in 0..4000 {
                let b = -f_s + width * (f64::from(i) + 0.5) / 4000.0;
                (mass, moment) = (mass + density(b), moment + b * density(b));
            }
            let piece = StickSegment {
                after: (0.0, 1.0),
                noise: (from, to),
                force: (from, to),
                displacement: 0.0,
            };
            let instant = ObservationTime {
                at: time,
                time,
                is_additional: false,
                forcing: 0.0,
                place: 0,
            };
            let mut draws = AddressedDraws::new(51, 0);
            let drawn: Vec<f64> = (0..200_000)
                .map(|_| stuck(&piece, kind, &scene, instant, &mut draws).force)
                .collect();
            let (mean, error) = mean_and_error(&drawn);
            println!("{from} to {to}: {mean} +- {error}, exact {}", moment / mass);
            assert!(
                (mean - moment / mass).abs() < 3.9 * error,
                "{from} to {to}: {mean} +- {error}, exact {}",
                moment / mass
            );
        }
    }
}
