//! What is known of a path between its events: the states on the rows of the output grid. From both
//! follow the energy that each force gives to the body, and the farthest and the fastest it gets.
//!
//! Events and rows are nodes. Between two nodes of a sub-phase x' has one sign, so the work of
//! friction is f_d times the distance, and x is farthest at a node: both are exact. x' between
//! nodes is the cubic that has x' and x'' of the nodes, and the other works are integrals by
//! Simpson's rule:
//!
//! ```text
//! of the temperature  c integral T x' dt         of damping  2 alpha integral x'^2 dt
//! of a force of the user's own  integral g x' dt
//! ```
//!
//! T in the middle is the mean of T there plus the mean of the noise at the nodes. So the energy
//! balance holds to the order of the spacing of the nodes, 4 without noise, and what is left of it
//! shows the error.

use super::law_counts::LawCounts;
use super::{Extremes, PassageLevels, Passages};
use crate::model::{Event, EventKind, Model, Sign};
use crate::scheme::{Instant, Timeline};
use crate::sums::codec::{Codec, Damaged, Reader, codec_of_fields};
use crate::sums::interval::Measured;
use crate::sums::moments::Moments;
use crate::sums::range::Sample;
use crate::sums::spread::SpreadMoments;
use crate::sums::{Ends, Unit};

/// A state of the body in motion.
#[derive(Clone, Copy, Debug)]
struct Node {
    time: f64,
    x: f64,
    v: f64,
    acceleration: f64,
    temperature: f64,
}

/// The energy that each force gave to the body, or took from it, since the end of the burn-in.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Works {
    temperature: f64,
    own_force: f64,
    /// These two are taken.
    damping: f64,
    friction: f64,
    /// Kinetic energy and that of the spring, at the beginning and at the end.
    stored: [f64; 2],
}

impl Works {
    fn change(&self) -> f64 {
        self.stored[1] - self.stored[0]
    }

    /// What is left of the balance, which is zero but for the errors of the integrals.
    fn residual(&self) -> f64 {
        self.temperature + self.own_force - self.damping - self.friction - self.change()
    }
}

/// One path.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionFold {
    node: Node,
    /// The direction of the present sub-phase; none at rest.
    direction: Option<Sign>,
    start: f64,
    /// The largest |x - x0| and the largest |x'| so far.
    largest: [f64; 2],
    works: Works,
}

impl MotionFold {
    /// A path at rest at x0.
    pub fn starting_at(model: &Model) -> Self {
        let x = model.initial_displacement;
        let node = Node { time: 0.0, x, v: 0.0, acceleration: 0.0, temperature: 0.0 };
        let stored = [0.5 * model.oscillator.stiffness * x * x; 2];
        let works = Works { stored, ..Works::default() };
        MotionFold { node, direction: None, start: x, largest: [0.0; 2], works }
    }

    /// Add the next event.
    pub fn event(&mut self, model: &Model, event: &Event) {
        let at_rest = |direction: Sign| Node {
            time: event.time,
            x: event.displacement,
            v: 0.0,
            acceleration: acceleration(model, event.force, direction),
            temperature: model.temperature_at(event),
        };
        if let Some(direction) = self.direction {
            self.pass(model, at_rest(direction), direction);
        }
        self.direction = match event.kind {
            EventKind::StickEntered => None,
            EventKind::SlipStarted(direction) | EventKind::SubPhaseBoundary(direction) => Some(direction),
        };
        self.node = at_rest(self.direction.unwrap_or(Sign::Positive));
    }

    /// Add the state (x, x', T) at an instant.
    pub fn at(&mut self, model: &Model, instant: Instant, time: f64, [x, v, temperature]: [f64; 3]) {
        if let Some(direction) = self.direction {
            let force = model.total_force(time, temperature, x, v);
            let node = Node { time, x, v, acceleration: acceleration(model, force, direction), temperature };
            self.pass(model, node, direction);
        }
        match instant {
            Instant::Counting => self.works = Works { stored: [self.stored(model); 2], ..Works::default() },
            Instant::End => self.works.stored[1] = self.stored(model),
            Instant::Output(_) | Instant::Period(_) => {}
        }
    }

    fn stored(&self, model: &Model) -> f64 {
        let Node { x, v, .. } = self.node;
        let v = if self.direction.is_some() { v } else { 0.0 };
        0.5 * (model.oscillator.mass * v * v + model.oscillator.stiffness * x * x)
    }

    /// Moves on to the next node of the sub-phase.
    fn pass(&mut self, model: &Model, end: Node, direction: Sign) {
        let (begin, works) = (self.node, &mut self.works);
        let (length, distance) = (end.time - begin.time, end.x - begin.x);
        let c = model.oscillator.force_per_temperature();
        works.friction += model.friction.dynamic_force * distance.abs();
        let simpson = |values: [f64; 3]| length / 6.0 * (values[0] + 4.0 * values[1] + values[2]);
        let velocity = Cubic::new(length, [begin.v, end.v], [begin.acceleration, end.acceleration]);
        let middle = velocity.at(0.5);
        works.damping += 2.0 * model.oscillator.damping * simpson([begin.v, middle, end.v].map(|v| v * v));
        let time = 0.5 * (begin.time + end.time);
        let noise = |node: Node| node.temperature - model.temperature.mean(node.time);
        let temperature = model.temperature.mean(time) + 0.5 * (noise(begin) + noise(end));
        works.temperature += match length > 0.0 {
            true => c * simpson([begin.temperature * begin.v, temperature * middle, end.temperature * end.v]),
            // A slip that takes no time.
            false => c * 0.5 * (begin.temperature + end.temperature) * distance,
        };
        if model.force.is_some() {
            let displacement = Cubic::new(length, [begin.x, end.x], [begin.v, end.v]).at(0.5);
            let power = |x: f64, v: f64, t: f64| model.own_force(t, x, v).unwrap_or(0.0) * v;
            let powers = [(begin.x, begin.v, begin.time), (displacement, middle, time), (end.x, end.v, end.time)];
            works.own_force += simpson(powers.map(|(x, v, t)| power(x, v, t)));
        }
        let fastest = velocity.largest(direction.value());
        self.largest = [self.largest[0].max((end.x - self.start).abs()), self.largest[1].max(fastest)];
        self.node = end;
    }
}

fn acceleration(model: &Model, force: f64, direction: Sign) -> f64 {
    (force - direction.value() * model.friction.dynamic_force) / model.oscillator.mass
}

/// The cubic on [0, 1] with these values and slopes at its ends.
struct Cubic([f64; 4]);

impl Cubic {
    /// Slopes are per unit of an interval of this length.
    fn new(length: f64, [a, b]: [f64; 2], slopes: [f64; 2]) -> Self {
        let [p, q] = slopes.map(|slope| slope * length);
        Cubic([a, p, 3.0 * (b - a) - 2.0 * p - q, 2.0 * (a - b) + p + q])
    }

    fn at(&self, s: f64) -> f64 {
        let Cubic([a, b, c, d]) = *self;
        a + s * (b + s * (c + s * d))
    }

    /// The largest value of `sign` times the cubic.
    fn largest(&self, sign: f64) -> f64 {
        let Cubic([_, b, c, d]) = *self;
        // The derivative is b + 2 c s + 3 d s^2.
        let root = (c * c - 3.0 * b * d).sqrt();
        let extremes = [(-c - root) / (3.0 * d), (-c + root) / (3.0 * d), -b / (2.0 * c)];
        let inside = extremes.into_iter().filter(|s| (0.0..=1.0).contains(s));
        inside.chain([0.0, 1.0]).map(|s| sign * self.at(s)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Moments over paths of the works.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct EnergySums {
    temperature: Moments,
    own_force: Moments,
    damping: Moments,
    change: Moments,
    residual: SpreadMoments,
}

codec_of_fields!(EnergySums { temperature, own_force, damping, change, residual });

impl EnergySums {
    /// The sums over the paths of a block.
    pub fn of(paths: &[MotionFold], unit: Unit) -> Self {
        let column = |of: fn(&Works) -> f64| paths.iter().map(|path| of(&path.works)).collect::<Vec<f64>>();
        let moments = |of: fn(&Works) -> f64| Moments::of(&unit.means(&column(of)));
        EnergySums {
            temperature: moments(|works| works.temperature),
            own_force: moments(|works| works.own_force),
            damping: moments(|works| works.damping),
            change: moments(Works::change),
            residual: SpreadMoments::of(&column(Works::residual), unit),
        }
    }

    pub fn merge(&mut self, other: &EnergySums) {
        self.temperature.merge(&other.temperature);
        self.own_force.merge(&other.own_force);
        self.damping.merge(&other.damping);
        self.change.merge(&other.change);
        self.residual.merge(&other.residual);
    }

    pub fn temperature(&self) -> Measured {
        Measured::mean(&self.temperature)
    }

    pub fn own_force(&self) -> Measured {
        Measured::mean(&self.own_force)
    }

    pub fn damping(&self) -> Measured {
        Measured::mean(&self.damping)
    }

    pub fn change(&self) -> Measured {
        Measured::mean(&self.change)
    }

    pub fn residual(&self) -> Measured {
        Measured::mean(&self.residual.units)
    }

    pub fn residual_sd(&self) -> Measured {
        self.residual.standard_deviation()
    }
}

/// Moments over paths of the largest |x - x0| and the largest |x'|.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ExtremeSums {
    displacement: SpreadMoments,
    velocity: SpreadMoments,
}

codec_of_fields!(ExtremeSums { displacement, velocity });

impl ExtremeSums {
    /// The sums over the paths of a block.
    pub fn of(paths: &[MotionFold], unit: Unit) -> Self {
        let column =
            |i: usize| SpreadMoments::of(&paths.iter().map(|path| path.largest[i]).collect::<Vec<f64>>(), unit);
        ExtremeSums { displacement: column(0), velocity: column(1) }
    }

    pub fn merge(&mut self, other: &ExtremeSums) {
        self.displacement.merge(&other.displacement);
        self.velocity.merge(&other.velocity);
    }

    /// Of |x - x0|.
    pub fn displacement(&self) -> &SpreadMoments {
        &self.displacement
    }

    /// Of |x'|.
    pub fn velocity(&self) -> &SpreadMoments {
        &self.velocity
    }
}

/// Counts of the largest |x - x0| and |x'|, and of the paths that have not yet reached a level.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ExtremeCounts {
    largest: [LawCounts; 2],
    /// For each level and row of the output grid, the number of paths whose |x - x0| has stayed
    /// below the level until then.
    below: Vec<u64>,
}

impl ExtremeCounts {
    /// No paths. The largest duration and the largest length that are to be expected, roughly,
    /// determine the bins.
    pub fn empty([time, length]: [f64; 2]) -> Self {
        let speed = if time > 0.0 { length / time } else { length };
        ExtremeCounts { largest: [length, speed].map(LawCounts::empty), below: Vec::new() }
    }

    pub fn settle(&mut self) {
        self.largest.iter_mut().for_each(LawCounts::settle);
    }

    pub fn merge(&mut self, other: &ExtremeCounts) {
        self.largest.iter_mut().zip(&other.largest).for_each(|(mine, more)| mine.merge(more));
        if self.below.is_empty() {
            self.below = vec![0; other.below.len()];
        }
        self.below.iter_mut().zip(&other.below).for_each(|(mine, more)| *mine += more);
    }

    /// Add the paths of a block at a row of the output grid.
    pub fn row(&mut self, row: usize, rows: usize, levels: &PassageLevels, paths: &[MotionFold]) {
        self.below.resize(levels.iter().count() * rows, 0);
        for (i, level) in levels.iter().enumerate() {
            self.below[i * rows + row] += paths.iter().filter(|path| path.largest[0] < level).count() as u64;
        }
    }

    /// Add a path that has ended.
    pub fn end(&mut self, unit: u64, path: &MotionFold) {
        self.largest.iter_mut().zip(path.largest).for_each(|(counts, largest)| counts.completed(unit, largest));
    }

    /// What is reported. `chance` is the number of units, if these are random.
    pub fn summary(
        &self,
        levels: &PassageLevels,
        timeline: &Timeline,
        chance: Option<u64>,
        sample: Sample,
    ) -> Extremes {
        let certain = [sample.paths as f64; 2];
        let [displacement, velocity] =
            self.largest.each_ref().map(|counts| counts.summary(&counts.ordered(), certain, chance, sample, true));
        let rows = timeline.rows();
        let below = |i: usize| self.below.get(i * rows..(i + 1) * rows).unwrap_or_default();
        let passages = levels.iter().enumerate().map(|(i, level)| Passages {
            level,
            survival: below(i).iter().map(|count| *count as f64 / sample.paths as f64).collect(),
            survival_ends: below(i).iter().map(|count| sample.share(*count)).collect::<Ends>(),
        });
        Extremes { displacement, velocity, passages: passages.collect() }
    }
}

impl Codec for ExtremeCounts {
    fn write(&self, out: &mut Vec<u8>) {
        self.largest.write(out);
        self.below.write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        self.largest.read(from)?;
        self.below = vec![0; from.clone().length()?];
        self.below.read(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cubic_fits_its_ends_and_finds_its_largest_value() {
        // s^3 - s on [0, 2], whose values are 0 and 6 and whose slopes are -1 and 11; its least
        // value is at 1/sqrt(3).
        let cubic = Cubic::new(2.0, [0.0, 6.0], [-1.0, 11.0]);
        assert!((cubic.at(0.5) - 0.0).abs() < 1e-15 && (cubic.at(1.0) - 6.0).abs() < 1e-14);
        assert!((cubic.largest(-1.0) - 2.0 / 27f64.sqrt()).abs() < 1e-15 && (cubic.largest(1.0) - 6.0).abs() < 1e-14);
        // A parabola, whose third power vanishes.
        let parabola = Cubic::new(1.0, [0.0, 0.0], [1.0, -1.0]);
        assert!((parabola.largest(1.0) - 0.25).abs() < 1e-15);
    }
}
