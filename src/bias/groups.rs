//! Paths in groups, and what leaving out one group after another says about errors.
//!
//! The delete-a-group jackknife: of a number g computed from all paths, and from all but those of group i as g_i,
//!
//! ```text
//! standard error^2 = (G - 1)/G sum_i (g_i - mean g_i)^2
//! ```
//!
//! whatever g is: a ratio, a median, a slope, or a function of several of them. (B. Efron, *The Jackknife, the Bootstrap and
//! Other Resampling Plans*, SIAM (1982), chapter 3; J. Shao and D. Tu, *The Jackknife and Bootstrap*, Springer (1995), section 2.3.)

use crate::model::{Event, Model};
use crate::scheme::{Instant, Observer, Snapshot, Timeline};
use crate::stats::{BlockObserver, Record, Statistic, Totals};

/// The value of every statistic, in the order of `Statistic::ALL`.
pub(super) type Values = [f64; Statistic::ALL.len()];

/// The totals of each group of paths.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    empty: Totals,
    groups: Vec<Totals>,
}

impl Groups {
    /// So many groups of no paths.
    pub fn empty(model: &Model, timeline: &Timeline, groups: usize) -> Self {
        let empty = Totals::empty(model, timeline);
        Groups { groups: vec![empty.clone(); groups], empty }
    }

    /// Add later paths, group by group.
    pub fn merge(&mut self, more: &[Totals]) {
        for (mine, more) in self.groups.iter_mut().zip(more) {
            mine.merge(more);
        }
    }

    /// The statistics of all paths; then, group by group, of all paths but those of the group.
    pub fn values(&self) -> (Values, Vec<Values>) {
        let mut after = vec![self.empty.clone()];
        for group in self.groups.iter().rev() {
            let mut sum = group.clone();
            sum.merge(&after[after.len() - 1]);
            after.push(sum);
        }
        let all = after.pop().map_or([f64::NAN; Statistic::ALL.len()], |totals| totals.values());
        let mut before = self.empty.clone();
        let without = self.groups.iter().map(|group| {
            let mut rest = before.clone();
            rest.merge(&after.pop().unwrap_or_else(|| self.empty.clone()));
            before.merge(group);
            rest.values()
        });
        (all, without.collect())
    }
}

/// The standard error of a number that is g_i without group i; zero if there is one group only.
pub(super) fn jackknife(without: &[f64]) -> f64 {
    if without.len() < 2 {
        return 0.0;
    }
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let spread: f64 = without.iter().map(|g| (g - mean) * (g - mean)).sum();
    ((n - 1.0) / n * spread).sqrt()
}

/// Shows each path to the observer of its group: of the lanes, the first so many are the first group, and so on.
pub(super) struct GroupObserver {
    observers: Vec<BlockObserver>,
    first: u64,
    /// Paths of a group.
    width: usize,
}

impl GroupObserver {
    /// For `groups` groups of `width` paths each, in order from number `first` on.
    pub fn new(model: &Model, timeline: &Timeline, first: u64, width: usize, groups: usize) -> Self {
        let nothing = Record { paths: false, events: false, trajectories: 0 };
        let group = |g: usize| {
            let from = first + (g * width) as u64;
            let numbers: Vec<u64> = (from..from + width as u64).collect();
            BlockObserver::new(model, timeline, &nothing, &numbers)
        };
        GroupObserver { observers: (0..groups).map(group).collect(), first, width }
    }

    /// The totals of each group.
    pub fn finish(self) -> Vec<Totals> {
        let width = self.width as u64;
        let starts = (self.first..).step_by(self.width);
        self.observers.into_iter().zip(starts).map(|(o, first)| o.finish(first, width, Vec::new()).totals).collect()
    }
}

impl Observer for GroupObserver {
    fn event(&mut self, lane: usize, event: Event) {
        self.observers[lane / self.width].event(lane % self.width, event);
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
