//! All statistics as functions of keys of the scenario: a run at every point of a design, by
//! default with common seeds.
//!
//! ```text
//! Axis       a key and its values, as the user writes them
//!   -> Design      which points: a grid of axes, zipped axes, or a star around the scenario
//!     -> Question    a checked scenario for each point
//!       -> simulate    points and blocks of paths share the threads
//!         -> Sweep       points; differences and elasticities with paired errors (paired)
//! ```
//!
//! The estimates at a point have the same bits as those of a run of its scenario. Neither they nor
//! the paired errors depend on the number of threads, or on where a sweep was interrupted and
//! continued.

mod axis;
mod cost;
mod design;
mod paired;
mod point;
mod simulate;

pub use axis::{AxisError, AxisValue, AxisValues, MOST_POINTS, SweepAxis, table_of_file};
pub use cost::estimated_seconds;
pub use design::{Design, DesignError, RELATIVE_STEPS, RESERVED, Setting, StarError};
pub use paired::Paired;
pub use point::Point;
pub use simulate::{BlockReceiver, SweepEnd, SweepSimulation};

use crate::model::NamedSeries;
use crate::scenario::Scenario;
use crate::stats::Statistic;

/// Whether all points use the same noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seeds {
    /// Path n has the same noise at every point, from the seed of the scenario.
    Common,
    /// Point i uses the seed of the scenario plus i.
    Independent,
}

impl Seeds {
    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Seeds::Common => "common",
            Seeds::Independent => "independent",
        }
    }
}

/// The definition of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepQuestion {
    /// The scenario that is varied.
    pub scenario: Scenario,
    /// The points.
    pub design: Design,
    /// The scenario of each point, in the order of the design.
    pub points: Vec<Scenario>,
    /// Whether all points use the same noise.
    pub seeds: Seeds,
    /// Whether the discretisation bias is estimated at each point.
    pub with_bias: bool,
}

impl SweepQuestion {
    /// A question from the scenario and the scenarios of the points, in the order of the design.
    /// With independent seeds, the seed of each point is changed here.
    pub fn new(
        scenario: Scenario,
        design: Design,
        mut points: Vec<Scenario>,
        seeds: Seeds,
        with_bias: bool,
    ) -> Self {
        if seeds == Seeds::Independent {
            for (i, point) in (0..).zip(&mut points) {
                point.ensemble.seed = point.ensemble.seed.wrapping_add(i);
            }
        }
        SweepQuestion {
            scenario,
            design,
            points,
            seeds,
            with_bias,
        }
    }

    /// The same, with each scenario made from the settings of its point; the scenario that is
    /// varied has no settings.
    pub fn at_each<E>(
        design: Design,
        seeds: Seeds,
        with_bias: bool,
        scenario_at: impl Fn(&[Setting]) -> Result<Scenario, E>,
    ) -> Result<Self, E> {
        let points = (0..design.points())
            .map(|i| scenario_at(&design.settings(i)))
            .collect::<Result<_, E>>()?;
        Ok(SweepQuestion::new(
            scenario_at(&[])?,
            design,
            points,
            seeds,
            with_bias,
        ))
    }

    /// The samples of all files that the axes name, each called `KEY=FILE`.
    pub fn samples_of_files(&self) -> Vec<NamedSeries> {
        let mut found: Vec<NamedSeries> = Vec::new();
        for (i, point) in self.points.iter().enumerate() {
            for Setting { key, value } in self.design.settings(i) {
                let name = format!("{key}={value}");
                let is_known = found.iter().any(|known| known.name == name);
                let Some(table) = table_of_file(&key).filter(|_| !is_known) else {
                    continue;
                };
                let samples = point.samples().into_iter().find(|of| of.name == table);
                found
                    .extend(samples.map(|NamedSeries { series, .. }| NamedSeries { name, series }));
            }
        }
        found
    }

    /// Whether the paths of any point are random.
    fn is_random(&self) -> bool {
        self.points.iter().any(|point| point.model.is_random())
    }
}

/// A sweep with the results so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The question.
    pub question: SweepQuestion,
    /// The results in the order of the design; `None` for a point that is not done.
    pub points: Vec<Option<Point>>,
}

impl Sweep {
    /// A sweep without results.
    pub fn new(question: SweepQuestion) -> Self {
        let points = vec![None; question.points.len()];
        Sweep { question, points }
    }

    /// Number of points that are done.
    pub fn done(&self) -> usize {
        self.points.iter().flatten().count()
    }

    /// Whether all points are done.
    pub fn is_complete(&self) -> bool {
        self.done() == self.points.len()
    }

    /// The statistic at the next point along a dimension minus that at this point. `None` at the
    /// end of the dimension, or if one of the two is not done.
    pub fn difference(
        &self,
        point: usize,
        dimension: usize,
        statistic: Statistic,
    ) -> Option<Paired> {
        let next = self.question.design.next(point, dimension)?;
        let (from, to) = (self.points[point].as_ref()?, self.points[next].as_ref()?);
        Some(paired::difference(
            from,
            to,
            statistic,
            self.question.is_random(),
        ))
    }

    /// The gain of common seeds over all differences along a dimension: the sum of the variances
    /// that the differences would have with independent seeds, divided by the sum of their
    /// variances. NaN if no difference has an error.
    pub fn gain(&self, dimension: usize, statistic: Statistic) -> f64 {
        let pairs =
            (0..self.points.len()).filter_map(|point| self.difference(point, dimension, statistic));
        let (mut independent, mut common) = (0.0, 0.0);
        for Paired { measurement, gain } in pairs.filter(|pair| pair.gain.is_finite()) {
            let variance = measurement.standard_error * measurement.standard_error;
            independent += gain * variance;
            common += variance;
        }
        independent / common
    }

    /// The elasticity of a statistic for key number `key` of a star; `None` before its three points
    /// are done.
    pub fn elasticity(&self, key: usize, statistic: Statistic) -> Option<Paired> {
        let Design::Star { relative_step, .. } = self.question.design else {
            return None;
        };
        let point = |i: usize| self.points.get(i)?.as_ref();
        let points = [point(0)?, point(1 + 2 * key)?, point(2 + 2 * key)?];
        Some(paired::elasticity(
            points,
            relative_step,
            statistic,
            self.question.is_random(),
        ))
    }
}
