//! The sums from which every statistic is computed: empty, of a block, merged, and summarised.

use super::bands::{self, BandCounts, BandSums};
use super::cascade::CascadeSums;
use super::catalogue::Over;
use super::density::DensityCounts;
use super::deterministic::Deterministic;
use super::energy::EnergySums;
use super::extremes::{ExtremeCounts, ExtremeSums};
use super::law::{LawSums, PhaseLaw};
use super::law_counts::{LawCounts, OrderedLaw};
use super::laws::LawsSums;
use super::measure::{Measure, Sampled};
use super::path::PathFold;
use super::periods::PeriodSums;
use super::spectrum::SpectrumSums;
use super::sub_phases::SubPhaseTotals;
use super::{Distribution, Estimate, FirstSticks, Record, Statistic, Summary, Transient};
use crate::model::Problem;
use crate::scheme::{Snapshot, Timeline};
use crate::sums::batches::BATCHES;
use crate::sums::codec::{Codec, Damaged, Reader, sums, sums_of_fields};
use crate::sums::interval::Measured;
use crate::sums::range::{Range, Sample};
use crate::sums::{Merge, Replicate};

/// All sums and counts of one or more blocks. Their size does not grow with the number of paths
/// (except for the numbers of the diverged ones).
///
/// There are two parts. [`Counts`] merge exactly, in any order. [`Sums`] are rounded when they
/// merge, so that their order decides the last bits. A run therefore merges those of its blocks
/// along a tree ([`super::RunTotals`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Totals {
    pub(super) timeline: Timeline,
    pub(super) sums: Sums,
    pub(super) counts: Counts,
}

sums! {
    /// Floating-point moments over paths. Merging them is associative only up to rounding.
    #[derive(Clone, Debug, PartialEq)]
    pub struct Sums {
        pub(super) phases: PhaseSums,
        bands: BandSums,
        /// If requested.
        pub(super) spectrum: Option<Box<SpectrumSums>>,
    }
}

sums! {
    /// The moments from which statistics are estimated, without those of the bands.
    #[derive(Clone, Debug, PartialEq)]
    pub(super) struct PhaseSums {
        pub cascade: CascadeSums,
        pub periods: PeriodSums,
        /// The moments of laws, energies and extremes, if requested.
        pub laws: Option<Box<LawsSums>>,
        pub energy: Option<Box<EnergySums>>,
        pub extremes: Option<Box<ExtremeSums>>,
    }
}

/// Integers, extremes and lists of numbers. Merging them is exact in any order.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts {
    /// The requests, and the numbers on which all paths must agree, both from the scenario.
    pub(super) record: Record,
    deterministic: Deterministic,
    /// Number of paths folded, without the diverged ones.
    paths: u64,
    /// Number of independent units: that of the paths, or half of it for pairs.
    pub(super) units: u64,
    diverged: Diverged,
    /// By the number of the law: that of sticks, and the others if they are asked for.
    pub(super) laws: Vec<LawCounts>,
    /// First sticks that ended, and those that run at t_end.
    pub(super) first_completed: u64,
    pub(super) first_censored: u64,
    pub(super) sub_phases: SubPhaseTotals,
    /// Completed sticks, j >= 1, and slips that began before the end of the burn-in.
    early_sticks: u64,
    early_slips: u64,
    bands: BandCounts,
    /// If requested.
    pub(super) density: Option<Box<DensityCounts>>,
    pub(super) extremes: Option<Box<ExtremeCounts>>,
}

sums_of_fields!(Counts {
    paths,
    units,
    diverged,
    laws,
    first_completed,
    first_censored,
    sub_phases,
    early_sticks,
    early_slips,
    bands,
    density,
    extremes
});

/// Numbers of diverged paths, in ascending order: the only list whose length the scenario does not
/// fix.
#[derive(Clone, Debug, Default, PartialEq)]
struct Diverged(Vec<u64>);

impl Merge for Diverged {
    fn merge(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
        self.0.sort_unstable();
    }
}

impl Codec for Diverged {
    fn write(&self, out: &mut Vec<u8>) {
        self.0.write(out);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        self.0 = vec![0; from.clone().length()?];
        self.0.read(from)?;
        if self.0.is_sorted_by(|a, b| a < b) {
            Ok(())
        } else {
            Err(Damaged)
        }
    }
}

impl Sums {
    /// The sums of no paths.
    pub fn empty(model: &Problem, timeline: &Timeline, record: &Record) -> Self {
        Sums {
            phases: PhaseSums::empty(timeline, record),
            bands: BandSums::empty(timeline.rows()),
            spectrum: record
                .spectrum
                .then(|| Box::new(SpectrumSums::empty(model, timeline))),
        }
    }
}

impl Counts {
    /// The counts of no paths.
    pub fn empty(model: &Problem, timeline: &Timeline, record: &Record) -> Self {
        // The largest duration and length that are to be expected, roughly.
        let [time, length] = [timeline.end, model.length_scale(timeline.end)];
        let scale = |law: PhaseLaw| if law.is_of_time() { time } else { length };
        let laws = if record.laws {
            &PhaseLaw::ALL[..]
        } else {
            &[PhaseLaw::Stick]
        };
        let (levels, rows) = (record.levels, timeline.rows());
        Counts {
            record: *record,
            deterministic: Deterministic::of(model, timeline),
            paths: 0,
            units: 0,
            diverged: Diverged::default(),
            laws: laws
                .iter()
                .map(|law| LawCounts::empty(scale(*law)))
                .collect(),
            first_completed: 0,
            first_censored: 0,
            sub_phases: SubPhaseTotals::default(),
            early_sticks: 0,
            early_slips: 0,
            bands: BandCounts::empty(model, rows),
            density: record.density.then(Box::default),
            extremes: (!levels.is_empty())
                .then(|| Box::new(ExtremeCounts::empty(levels, rows, [time, length]))),
        }
    }

    /// Set the step of the scheme, if it has one, before anything is counted.
    pub(super) fn set_step(&mut self, step: Option<f64>) {
        let of_time = self
            .laws
            .iter_mut()
            .zip(PhaseLaw::ALL)
            .filter(|(_, law)| law.is_of_time());
        of_time.for_each(|(counts, _)| counts.set_step(step));
    }

    /// The median of a law without each batch; NaN if it was not requested.
    pub(super) fn medians_without_each_batch(&self, law: PhaseLaw) -> [f64; BATCHES] {
        self.laws
            .get(law as usize)
            .map_or([f64::NAN; BATCHES], LawCounts::medians_without_each_batch)
    }

    /// Counts the waiting values.
    pub(super) fn settle(&mut self) {
        self.laws.iter_mut().for_each(LawCounts::settle);
        self.extremes
            .iter_mut()
            .for_each(|extremes| extremes.settle());
        self.bands.settle();
    }

    /// This number of units, if their agreement would be a matter of chance.
    fn random_units(&self, units: u64) -> Option<u64> {
        (!self.deterministic.everything).then_some(units)
    }

    fn sample(&self) -> Sample {
        Sample {
            paths: self.paths,
            units: self.units,
            is_random: !self.deterministic.everything,
        }
    }

    fn unit(&self) -> Replicate {
        if self.units < self.paths {
            Replicate::Pair
        } else {
            Replicate::Path
        }
    }
}

impl Totals {
    /// The totals of no paths.
    pub fn empty(model: &Problem, timeline: &Timeline, record: &Record) -> Self {
        Totals {
            timeline: *timeline,
            sums: Sums::empty(model, timeline, record),
            counts: Counts::empty(model, timeline, record),
        }
    }

    /// Set row `row` of the output grid from all paths of the block.
    pub(super) fn row(&mut self, row: usize, snapshot: &Snapshot<'_>, unit: Replicate) {
        self.sums.bands.fold(row, snapshot, unit);
        self.counts.bands.fold(row, snapshot);
    }

    /// Set the counts of the paths of one block, once these have reached t_end.
    pub(super) fn end(&mut self, paths: &[PathFold], diverged: &[u64], unit: Replicate) {
        self.counts.paths = paths.len() as u64;
        self.counts.units = self.counts.paths / unit.size();
        self.counts.early_sticks = paths.iter().map(|path| u64::from(path.early_sticks)).sum();
        self.counts.early_slips = paths.iter().map(|path| u64::from(path.early_slips)).sum();
        self.counts.diverged = Diverged(diverged.to_vec());
    }

    /// The summary: estimates with intervals, bands, and histograms.
    pub fn summary(&self) -> Summary {
        let Totals {
            timeline,
            sums,
            counts,
        } = self;
        let ordered: Vec<OrderedLaw> = counts.laws.iter().map(LawCounts::ordered).collect();
        let estimate = |statistic: Statistic| match statistic
            .row()
            .median_of
            .and_then(|law| ordered.get(law as usize))
        {
            Some(law) => Estimate::new(
                statistic,
                sums.phases.in_its_range(statistic, law.median(), counts),
            ),
            None => self.estimate(statistic),
        };
        let distribution = |law: PhaseLaw| -> Option<Distribution> {
            let (of, ordered) = (counts.laws.get(law as usize)?, ordered.get(law as usize)?);
            Some(of.summary(
                ordered,
                counts.random_units(sums.phases.law(law)?.contributing()),
            ))
        };
        let bands = bands::summary(
            &sums.bands,
            &counts.bands,
            timeline,
            counts.deterministic,
            counts.unit(),
        );
        let mean_motion = [
            bands.displacement.mean.as_slice(),
            bands.velocity.mean.as_slice(),
        ];
        Summary {
            spectrum: sums
                .spectrum
                .as_ref()
                .map(|spectrum| spectrum.summary(timeline, mean_motion)),
            extremes: counts.extremes.as_ref().map(|extremes| {
                extremes.summary(counts.random_units(counts.units), counts.sample())
            }),
            asked: Statistic::asked_by(&counts.record),
            cycle: None,
            densities: counts
                .density
                .as_ref()
                .map(|density| density.summary(counts.random_units(counts.units))),
            completed_paths: counts.paths + counts.diverged.0.len() as u64,
            diverged: counts.diverged.0.clone(),
            estimates: Statistic::ALL.map(estimate),
            stick_durations: distribution(PhaseLaw::Stick).unwrap_or_default(),
            first_sticks: FirstSticks {
                completed: counts.first_completed,
                censored: counts.first_censored,
            },
            laws: counts
                .record
                .laws
                .then(|| PhaseLaw::ASKED.map(|law| distribution(law).unwrap_or_default())),
            sub_phases: counts
                .sub_phases
                .summary(counts.random_units(sums.phases.cascade.contributing.slips)),
            transient: (timeline.after > 0.0).then(|| self.transient()),
            periods: sums.phases.periods.summary(
                timeline,
                !counts.deterministic.everything,
                counts.deterministic.drift,
            ),
            bands,
        }
    }

    fn transient(&self) -> Transient {
        let Totals {
            timeline,
            sums,
            counts,
        } = self;
        Transient {
            end: timeline.after,
            sticks: counts.early_sticks,
            slips: counts.early_slips,
            displacement: Measured::mean_of_four(&sums.phases.cascade.early_displacement)
                .in_range(Range::ANY, counts.random_units(counts.units))
                .measurement(),
        }
    }

    /// One statistic with its interval.
    pub fn estimate(&self, statistic: Statistic) -> Estimate {
        Estimate::new(statistic, self.measured(statistic))
    }

    /// One statistic with the data for its error.
    pub(crate) fn measured(&self, statistic: Statistic) -> Measured {
        let Totals {
            sums,
            timeline,
            counts,
        } = self;
        sums.phases.measured(statistic, timeline, counts)
    }

    /// The numbers of the diverged paths, in ascending order.
    pub fn diverged(&self) -> &[u64] {
        &self.counts.diverged.0
    }

    /// Every statistic with its interval, in the order of `Statistic::ALL`.
    pub fn estimates(&self) -> [Estimate; Statistic::ALL.len()] {
        Statistic::ALL.map(|statistic| self.estimate(statistic))
    }

    /// The values of the wanted statistics, in the order of `Statistic::ALL`, without errors and
    /// intervals; NaN in the place of the others.
    pub fn values(&self, is_wanted: impl Fn(Statistic) -> bool) -> [f64; Statistic::ALL.len()] {
        self.sums
            .phases
            .values(&self.timeline, &self.counts, is_wanted)
    }
}

impl Merge for Totals {
    fn merge(&mut self, other: &Totals) {
        debug_assert_eq!(self.timeline, other.timeline, "totals of different runs");
        self.sums.merge(&other.sums);
        self.counts.merge(&other.counts);
    }
}

impl PhaseSums {
    /// The sums of no paths.
    pub fn empty(timeline: &Timeline, record: &Record) -> Self {
        PhaseSums {
            cascade: CascadeSums::default(),
            periods: PeriodSums::empty(timeline),
            laws: record.laws.then(Box::default),
            energy: record.energy.then(Box::default),
            extremes: (!record.levels.is_empty()).then(Box::default),
        }
    }

    /// The moments of a law; none if it was not requested.
    fn law(&self, law: PhaseLaw) -> Option<&LawSums> {
        match law {
            PhaseLaw::Stick => Some(&self.cascade.sticks),
            asked => self.laws.as_ref().map(|laws| laws.law(asked)),
        }
    }

    /// The measures: those of every run, and the requested ones.
    fn measures(&self) -> impl Iterator<Item = &dyn Measure> {
        let PhaseSums {
            cascade,
            periods,
            laws,
            energy,
            extremes,
        } = self;
        let asked = [
            laws.as_deref().map(|laws| laws as &dyn Measure),
            energy.as_deref().map(|energy| energy as &dyn Measure),
            extremes.as_deref().map(|extremes| extremes as &dyn Measure),
        ];
        let always: [&dyn Measure; 2] = [cascade, periods];
        always.into_iter().chain(asked.into_iter().flatten())
    }

    /// The values of the statistics that are wanted, without errors and intervals; NaN for others.
    pub(super) fn values(
        &self,
        timeline: &Timeline,
        counts: &Counts,
        is_wanted: impl Fn(Statistic) -> bool,
    ) -> [f64; Statistic::ALL.len()] {
        let value = |statistic| self.measured(statistic, timeline, counts).estimate();
        Statistic::ALL.map(|statistic| {
            if is_wanted(statistic) {
                value(statistic)
            } else {
                f64::NAN
            }
        })
    }

    /// A statistic of the run that has these sums.
    pub(super) fn measured(
        &self,
        statistic: Statistic,
        timeline: &Timeline,
        counts: &Counts,
    ) -> Measured {
        self.in_its_range(
            statistic,
            self.without_range(statistic, timeline, counts),
            counts,
        )
    }

    /// A measured value of a statistic, with an interval that does not leave the range of the
    /// statistic.
    fn in_its_range(&self, statistic: Statistic, measured: Measured, counts: &Counts) -> Measured {
        let contributing = &self.cascade.contributing;
        let units = match statistic.row().over {
            Over::Sticks => self.cascade.sticks.contributing(),
            Over::FirstSticks => contributing.first_sticks,
            Over::Slips => contributing.slips,
            Over::Recurrences => self
                .law(PhaseLaw::Recurrence)
                .map_or(0, LawSums::contributing),
            Over::CountsOfPaths | Over::Paths => counts.units,
        };
        let range = statistic.row().range;
        measured.in_range(
            range,
            counts
                .random_units(units)
                .filter(|_| !statistic.is_decided_by(counts.deterministic)),
        )
    }

    fn without_range(
        &self,
        statistic: Statistic,
        timeline: &Timeline,
        counts: &Counts,
    ) -> Measured {
        if !statistic.is_asked_by(&counts.record) {
            return Measured::NOTHING;
        }
        if let Some(law) = statistic.row().median_of {
            return counts
                .laws
                .get(law as usize)
                .map_or(Measured::NOTHING, |law| law.ordered().median());
        }
        let of = Sampled {
            timeline,
            unit: counts.unit(),
        };
        self.measures()
            .find_map(|measure| measure.measured(statistic, &of))
            .unwrap_or(Measured::NOTHING)
    }
}

#[cfg(test)]
mod tests;
