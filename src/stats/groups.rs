//! The paths of a run in groups. The values of its statistics without each group give the
//! uncertainty of numbers computed from several runs.
//!
//! In every run, a path is in the group of its number modulo [`GROUPS`], and an antithetic pair in
//! that of the pair's number. If path n of two runs has the same noise, so have all paths of a
//! group, and the effects of a group on both runs are kept together. The errors of differences and
//! ratios of runs then follow by the jackknife ([`crate::sums::jackknife`]). Groups hold whole
//! paths, so the phases of a path may depend on each other in any way.
//!
//! A group holds moments alone. A median comes from the values of the run, which are kept in
//! the same groups.

use super::folds::PathFolds;
use super::periods::PeriodFold;
use super::totals::PhaseSums;
use super::{AuxiliaryObserver, Record, Statistic, Totals};
use crate::model::{Event, Problem};
use crate::scheme::{Instant, Observer, Segment, Snapshot, Timeline};
use crate::sums::Merge;
use crate::sums::Replicate;
use crate::sums::batches::{BATCHES, batch_of};
use crate::sums::jackknife::leaving_one_out;

/// Number of groups of paths. With 31 degrees of freedom an interval is 4 % wider than by the
/// normal law, and an error is known to 13 %.
pub const GROUPS: usize = BATCHES;

/// The value of every statistic, in the order of [`Statistic::ALL`].
pub type GroupValues = [f64; Statistic::ALL.len()];

/// Observes the blocks of a run, and sums each group of paths separately.
#[derive(Clone, Debug)]
pub struct Grouping {
    timeline: Timeline,
    unit: Replicate,
    model: Problem,
    record: Record,
}

/// The moments of each group, in order.
#[derive(Clone, Debug)]
pub struct Groups(Vec<PhaseSums>);

impl Merge for Groups {
    fn merge(&mut self, other: &Groups) {
        self.0.merge(&other.0);
    }
}

impl Groups {
    /// For each group, the value of every statistic over the other paths. `run` has the totals of
    /// all paths. If there are fewer units than groups, each unit is a group. The median is NaN
    /// where durations are whole numbers of steps, because leaving out paths mostly does not change
    /// it at all.
    pub fn without(&self, run: &Totals) -> Vec<GroupValues> {
        let Totals {
            timeline, counts, ..
        } = run;
        let some = &self.0[..GROUPS.min(counts.units as usize)];
        let empty = PhaseSums::empty(timeline, &counts.record);
        // The median is taken from the run, because computing it for every group would be slow.
        let is_no_median = |statistic: Statistic| statistic.row().median_of.is_none();
        let of = |sums: &PhaseSums| sums.values(timeline, counts, is_no_median);
        let (_, mut without) = leaving_one_out(&empty, some, of);
        let medians = Statistic::ALL
            .into_iter()
            .filter_map(|statistic| Some((statistic, statistic.row().median_of?)));
        for (statistic, law) in medians {
            for (values, median) in without
                .iter_mut()
                .zip(counts.medians_without_each_batch(law))
            {
                values[statistic.index()] = median;
            }
        }
        without
    }
}

impl Grouping {
    /// A grouping for runs of this model on this timeline, whose independent units are paths or
    /// pairs, and which measure what `record` asks for.
    pub fn new(model: &Problem, timeline: &Timeline, record: &Record, unit: Replicate) -> Self {
        Grouping {
            timeline: *timeline,
            unit,
            model: model.clone(),
            record: *record,
        }
    }
}

impl AuxiliaryObserver for Grouping {
    type Observer = GroupObserver;
    type Sums = Groups;

    fn empty(&self) -> Groups {
        Groups(vec![PhaseSums::empty(&self.timeline, &self.record); GROUPS])
    }

    fn observer(&self, paths: &[u64]) -> GroupObserver {
        let mut lanes = vec![Vec::new(); GROUPS];
        for (lane, path) in paths.iter().enumerate() {
            lanes[batch_of(self.unit.of(*path))].push(lane);
        }
        let group = |lanes: Vec<usize>| {
            let periods = PeriodFold::new(
                &self.timeline,
                self.model.initial_displacement,
                lanes.len(),
                self.unit,
            );
            let [displacement, velocity] = [lanes.len(); 2].map(Vec::with_capacity);
            Group {
                lanes,
                periods,
                displacement,
                velocity,
            }
        };
        let folds = PathFolds::new(&self.model, &self.timeline, &self.record, paths.len());
        GroupObserver {
            folds,
            groups: lanes.into_iter().map(group).collect(),
        }
    }

    fn finish(&self, GroupObserver { folds, groups }: GroupObserver, _: Replicate) -> Groups {
        let sums = |group: Group| folds.sums(Some(&group.lanes), group.periods.finish(), self.unit);
        Groups(groups.into_iter().map(sums).collect())
    }
}

/// Folds each path of a block, and for each group the instants at which its paths are observed
/// together.
pub struct GroupObserver {
    folds: PathFolds,
    groups: Vec<Group>,
}

/// The paths of a block that are in one group.
struct Group {
    lanes: Vec<usize>,
    periods: PeriodFold,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl Observer for GroupObserver {
    #[inline]
    fn event(&mut self, lane: usize, event: Event) {
        self.folds.event(lane, &event, |_, _| {});
    }

    fn realised(&mut self, lane: usize, model: &Problem) {
        self.folds.realised(lane, model);
    }

    fn follows(&self) -> bool {
        self.folds.motion.is_some()
    }

    fn segment(&mut self, lane: usize, segment: &Segment) {
        self.folds.segment(lane, segment);
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        match instant {
            Instant::Output(_) => {}
            Instant::Counting | Instant::End => self.folds.at(instant, &snapshot, |_, _| ()),
            Instant::Period(n) => {
                for Group {
                    lanes,
                    periods,
                    displacement,
                    velocity,
                } in &mut self.groups
                {
                    let gather = |into: &mut Vec<f64>, from: &[f64]| {
                        into.clear();
                        into.extend(lanes.iter().map(|&lane| from[lane]));
                    };
                    gather(displacement, snapshot.displacement);
                    gather(velocity, snapshot.velocity);
                    periods.observe(
                        n,
                        &Snapshot {
                            displacement,
                            velocity,
                            ..snapshot
                        },
                    );
                }
            }
        }
    }
}
