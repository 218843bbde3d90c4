//! Paths in groups: an observer that passes each path to its group, and the statistics of all paths
//! and without each group, from which the jackknife computes errors.

use crate::model::{Event, Model};
use crate::scheme::{Glide, Instant, Observer, Snapshot, Timeline};
use crate::stats::{BlockObserver, GroupValues, Record, Statistic, Totals};
use crate::sums::Merge as _;
use crate::sums::jackknife;

/// The statistics of paths in groups; NaN for one that is not wanted.
#[derive(Clone, Debug)]
pub(super) struct Grouped {
    /// The statistics of all paths.
    pub all: GroupValues,
    /// For each group, the statistics of all paths but those of the group.
    pub without: Vec<GroupValues>,
}

/// The totals of each group of paths.
#[derive(Clone, Debug)]
pub(super) struct PairedGroups {
    empty: Totals,
    groups: Vec<Totals>,
}

impl PairedGroups {
    /// This many groups of no paths.
    pub fn empty(model: &Model, timeline: &Timeline, groups: usize) -> Self {
        let empty = Totals::empty(model, timeline);
        PairedGroups { groups: vec![empty.clone(); groups], empty }
    }

    /// Add the totals of further paths, group by group.
    pub fn merge(&mut self, more: &[Totals]) {
        for (mine, more) in self.groups.iter_mut().zip(more) {
            mine.merge(more);
        }
    }

    /// The wanted statistics of all paths, and without each group; NaN in the place of the others.
    pub fn values(&self, is_wanted: impl Fn(Statistic) -> bool) -> Grouped {
        let values = |totals: &Totals| totals.values(&is_wanted);
        let (all, without) = jackknife::leaving_one_out(&self.empty, &self.groups, values);
        Grouped { all, without }
    }
}

/// Passes each path to the observer of its group. The first `width` lanes are the first group, the
/// next `width` lanes the second, and so on.
pub(super) struct PairedObserver {
    observers: Vec<BlockObserver>,
    first: u64,
    /// Number of paths of each group.
    width: usize,
}

impl PairedObserver {
    /// An observer of `groups` groups of `width` paths each, whose numbers run from `first` on,
    /// of a run that records this.
    pub fn new(
        (model, timeline, record): (&Model, &Timeline, &Record),
        first: u64,
        width: usize,
        groups: usize,
    ) -> Self {
        let group = |g: usize| {
            let from = first + (g * width) as u64;
            let numbers: Vec<u64> = (from..from + width as u64).collect();
            BlockObserver::new(model, timeline, record, &numbers)
        };
        PairedObserver { observers: (0..groups).map(group).collect(), first, width }
    }

    /// The totals of each group.
    pub fn finish(self) -> Vec<Totals> {
        let width = self.width as u64;
        let starts = (self.first..).step_by(self.width);
        self.observers.into_iter().zip(starts).map(|(o, first)| o.finish(first, width, Vec::new()).totals).collect()
    }
}

impl Observer for PairedObserver {
    fn event(&mut self, lane: usize, event: Event) {
        self.observers[lane / self.width].event(lane % self.width, event);
    }

    fn follows(&self) -> bool {
        self.observers.iter().any(Observer::follows)
    }

    fn glide(&mut self, lane: usize, glide: &Glide) {
        self.observers[lane / self.width].glide(lane % self.width, glide);
    }

    fn snapshot(&mut self, instant: Instant, snapshot: Snapshot<'_>) {
        for (g, observer) in self.observers.iter_mut().enumerate() {
            let lanes = g * self.width..(g + 1) * self.width;
            let part = Snapshot {
                time: snapshot.time,
                displacement: &snapshot.displacement[lanes.clone()],
                velocity: &snapshot.velocity[lanes.clone()],
                temperature: &snapshot.temperature[lanes.clone()],
                is_static: &snapshot.is_static[lanes],
            };
            observer.snapshot(instant, part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bias::Differences;
    use crate::model::paper::paper;
    use crate::scheme::DiscreteVi;
    use std::sync::atomic::AtomicBool;

    /// Null: D1 of a ratio and of a mean are within Student's t of their expectation, here the mean
    /// over all seeds, in 95 % of 400 seeds. The share is then within four binomial standard
    /// deviations, 4.4 %, and 1.5 % for the skewness of so few paths, with a false-alarm rate of
    /// 6e-5. A standard error that is wrong by a factor of two gives 70 % or 99.9 %.
    #[test]
    fn differences_of_steps_scatter_as_the_jackknife_says() {
        let model = paper(0.25, 0.25);
        let timeline = Timeline { end: 30.0, output_step: 30.0, period: None, after: 0.0 };
        for statistic in [Statistic::StickDurationMean, Statistic::SticksPerPath] {
            let i = statistic.index();
            let differences: Vec<(f64, f64)> = (0..400)
                .map(|seed| {
                    let scheme = DiscreteVi { step: 0.05 }.into();
                    let plan = Differences::new(scheme, &model, &timeline, seed, 8000).expect("enough paths");
                    let levels = plan.simulate(1, &AtomicBool::new(false)).expect("none diverges");
                    let [fine, middle, _] = levels.map(|groups| groups.values(|each| each == statistic));
                    let without: Vec<f64> =
                        middle.without.iter().zip(&fine.without).map(|(middle, fine)| middle[i] - fine[i]).collect();
                    (middle.all[i] - fine.all[i], jackknife::standard_error(&without))
                })
                .collect();
            let n = differences.len() as f64;
            let truth = differences.iter().map(|d| d.0).sum::<f64>() / n;
            let covered =
                differences.iter().filter(|d| (d.0 - truth).abs() < crate::bias::differences::STUDENT * d.1).count();
            let share = covered as f64 / n;
            assert!((share - 0.95).abs() < 0.059, "{}: {share}", statistic.name());
        }
    }
}
