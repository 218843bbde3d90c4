//! One statistic after another as a function of keys of the scenario: a run at every point of a
//! grid, from common seeds.
//!
//! ```text
//! Axis       a key and its values, as a person writes them
//!   -> Design      which points: crossed axes, zipped ones, or a step to both sides of each key
//!     -> Question    a checked scenario for each point
//!       -> simulate    points and blocks of paths share the threads; every point is a run of its own, to the last bit
//!         -> Sweep       points; differences of neighbours and elasticities with paired errors (groups, paired)
//! ```
//!
//! The estimates of a point are those that a run of its scenario has. No bit of them, nor of a
//! paired error, depends on the number of threads, or on where a sweep was interrupted and
//! continued.

mod axis;
mod cost;
mod design;
mod paired;
mod simulate;

pub use axis::{Axis, AxisError, MOST_POINTS};
pub use cost::estimated_seconds;
pub use design::{Design, DesignError, RELATIVE_STEPS, RESERVED, Setting, StarError};
pub use paired::Paired;
pub use simulate::{Simulation, SweepEnd};

use crate::scenario::Scenario;
use crate::stats::{Estimate, Statistic, Values};

/// Whether points see the same noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seeds {
    /// Path n of every point has the seed of the scenario.
    Common,
    /// Point i has the seed of the scenario plus i.
    Independent,
}

impl Seeds {
    /// The word in files.
    pub fn name(self) -> &'static str {
        match self {
            Seeds::Common => "common",
            Seeds::Independent => "independent",
        }
    }
}

/// What a sweep asks.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The scenario that the points are variations of.
    pub scenario: Scenario,
    /// Which points there are.
    pub design: Design,
    /// The scenario of each point.
    pub points: Vec<Scenario>,
    /// Whether they see the same noise.
    pub seeds: Seeds,
    /// Whether the bias of the step is estimated at each point.
    pub with_bias: bool,
}

impl Question {
    /// Of a scenario and those of its points, in the order of the design. Independent points get
    /// seeds of their own.
    pub fn new(scenario: Scenario, design: Design, mut points: Vec<Scenario>, seeds: Seeds, with_bias: bool) -> Self {
        if seeds == Seeds::Independent {
            for (i, point) in (0..).zip(&mut points) {
                point.ensemble.seed = point.ensemble.seed.wrapping_add(i);
            }
        }
        Question { scenario, design, points, seeds, with_bias }
    }

    /// The same with the scenario of each point from its settings, of which the scenario itself has
    /// none.
    pub fn at_each<E>(
        design: Design,
        seeds: Seeds,
        with_bias: bool,
        scenario_at: impl Fn(&[Setting]) -> Result<Scenario, E>,
    ) -> Result<Self, E> {
        let points = (0..design.points()).map(|i| scenario_at(&design.settings(i))).collect::<Result<_, E>>()?;
        Ok(Question::new(scenario_at(&[])?, design, points, seeds, with_bias))
    }

    /// Whether anything is random at any of the points.
    fn is_random(&self) -> bool {
        self.points.iter().any(|point| point.model.temperature.is_random())
    }
}

/// What is known of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// One for each of `Statistic::ALL`, in that order: what a run of the point's scenario
    /// estimates.
    pub estimates: [Estimate; Statistic::ALL.len()],
    /// Paths simulated to the end, diverged ones included.
    pub completed_paths: u64,
    /// How many of them diverged or were given up; they are in no statistic.
    pub diverged_paths: u64,
    /// CPU seconds that it took.
    pub seconds: f64,
    /// The statistics without each group of paths.
    pub without: Vec<Values>,
}

/// A sweep: what was asked, and what is known so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// What was asked.
    pub question: Question,
    /// Point by point, in the order of the design; none where it is not done yet.
    pub points: Vec<Option<Point>>,
}

impl Sweep {
    /// One of which nothing is known yet.
    pub fn new(question: Question) -> Self {
        let points = vec![None; question.points.len()];
        Sweep { question, points }
    }

    /// How many points are done.
    pub fn done(&self) -> usize {
        self.points.iter().flatten().count()
    }

    /// Whether all are.
    pub fn is_complete(&self) -> bool {
        self.done() == self.points.len()
    }

    /// The next point along a dimension less this one; none at the end, or before both are done.
    pub fn difference(&self, point: usize, dimension: usize, statistic: Statistic) -> Option<Paired> {
        let next = self.question.design.next(point, dimension)?;
        let (from, to) = (self.points[point].as_ref()?, self.points[next].as_ref()?);
        Some(paired::difference(from, to, statistic, self.question.is_random()))
    }

    /// The gain of common seeds for the differences along a dimension, all of them together: the
    /// sum of their variances with independent seeds over the sum of what they are. Missing where
    /// no difference has an error.
    pub fn gain(&self, dimension: usize, statistic: Statistic) -> f64 {
        let pairs = (0..self.points.len()).filter_map(|point| self.difference(point, dimension, statistic));
        pooled(pairs)
    }

    /// The elasticity of a statistic for the `key`-th key of a star; none before its points are
    /// done.
    pub fn elasticity(&self, key: usize, statistic: Statistic) -> Option<Paired> {
        let Design::Star { relative_step, .. } = self.question.design else { return None };
        let point = |i: usize| self.points.get(i)?.as_ref();
        let points = [point(0)?, point(1 + 2 * key)?, point(2 + 2 * key)?];
        Some(paired::elasticity(points, relative_step, statistic, self.question.is_random()))
    }
}

/// The gain of several numbers together.
fn pooled(pairs: impl Iterator<Item = Paired>) -> f64 {
    let (mut independent, mut common) = (0.0, 0.0);
    for Paired { measurement, gain } in pairs.filter(|pair| pair.gain.is_finite()) {
        let variance = measurement.standard_error * measurement.standard_error;
        independent += gain * variance;
        common += variance;
    }
    independent / common
}
