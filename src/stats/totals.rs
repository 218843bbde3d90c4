//! The sums from which every statistic is computed: empty, of a block, merged, and summarised.

use super::bands::{self, BandCounts, BandSums};
use super::cascade::CascadeSums;
use super::catalogue::{Extra, Over};
use super::certain::Certain;
use super::density::DensityCounts;
use super::energy::EnergySums;
use super::extremes::{ExtremeCounts, ExtremeSums};
use super::law::{LawSums, PhaseLaw};
use super::law_counts::{LawCounts, OrderedLaw};
use super::laws::{LawFold, LawsCounts, LawsSums};
use super::measure::{Measure, Sampled};
use super::motion::MotionFold;
use super::path::PathFold;
use super::periods::PeriodSums;
use super::spectrum::SpectrumSums;
use super::sub_phases::SubPhaseTotals;
use super::{Distribution, Estimate, FirstSticks, PassageLevels, Record, Statistic, Summary, Transient};
use crate::model::Model;
use crate::scheme::{Snapshot, Timeline};
use crate::sums::batches::BATCHES;
use crate::sums::codec::{Codec, Damaged, Reader, sums_of_fields};
use crate::sums::interval::Measured;
use crate::sums::range::{Range, Sample};
use crate::sums::{Merge, Unit};

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

/// Floating-point moments over paths. Merging them is associative only up to rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    pub(super) phases: PhaseSums,
    bands: BandSums,
    /// If it is asked for.
    pub(super) spectrum: Option<Box<SpectrumSums>>,
}

sums_of_fields!(Sums { phases, bands, spectrum });

/// The moments from which statistics are estimated, without those of the bands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PhaseSums {
    cascade: CascadeSums,
    pub(super) periods: PeriodSums,
    /// The moments of the laws that are asked for.
    pub(super) laws: Option<Box<LawsSums>>,
    /// Energies and extremes, if they are asked for.
    energy: Option<Box<EnergySums>>,
    extremes: Option<Box<ExtremeSums>>,
}

sums_of_fields!(PhaseSums { cascade, periods, laws, energy, extremes });

/// Integers, extremes and lists of numbers. Merging them is exact in any order.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts {
    /// What all paths must agree on, which follows from the scenario.
    certain: Certain,
    /// Number of paths folded, without the diverged ones.
    paths: u64,
    /// Number of independent units: that of the paths, or half of it for pairs.
    units: u64,
    /// Numbers of the diverged paths, in ascending order.
    diverged: Vec<u64>,
    pub(super) sticks: LawCounts,
    /// The other laws, if they are asked for.
    pub(super) laws: Option<Box<LawsCounts>>,
    /// The largest duration and length that are to be expected, roughly, for the bins of the laws.
    scales: [f64; 2],
    /// First sticks that ended, and those that run at t_end.
    pub(super) first_completed: u64,
    pub(super) first_censored: u64,
    pub(super) sub_phases: SubPhaseTotals,
    /// Completed sticks, j >= 1, and slips that began before the end of the burn-in.
    early_sticks: u64,
    early_slips: u64,
    bands: BandCounts,
    /// If they are asked for.
    pub(super) density: Option<Box<DensityCounts>>,
    pub(super) extremes: Option<Box<ExtremeCounts>>,
    levels: PassageLevels,
}

impl Sums {
    /// The sums of no paths.
    pub fn empty(timeline: &Timeline) -> Self {
        Sums { phases: PhaseSums::empty(timeline), bands: BandSums::empty(timeline.rows()), spectrum: None }
    }
}

impl Merge for Counts {
    fn merge(&mut self, other: &Counts) {
        self.paths += other.paths;
        self.units += other.units;
        self.diverged.extend_from_slice(&other.diverged);
        if !self.diverged.is_sorted() {
            self.diverged.sort_unstable();
        }
        self.sticks.merge(&other.sticks);
        self.laws.merge(&other.laws);
        self.first_completed += other.first_completed;
        self.first_censored += other.first_censored;
        self.sub_phases.merge(&other.sub_phases);
        self.early_sticks += other.early_sticks;
        self.early_slips += other.early_slips;
        self.bands.merge(&other.bands);
        self.density.merge(&other.density);
        self.extremes.merge(&other.extremes);
        if self.levels.is_empty() {
            self.levels = other.levels;
        }
    }
}

impl Counts {
    /// The counts of no paths.
    pub fn empty(model: &Model, timeline: &Timeline) -> Self {
        Counts {
            certain: Certain::of(model, timeline),
            paths: 0,
            units: 0,
            diverged: Vec::new(),
            sticks: LawCounts::empty(timeline.end),
            laws: None,
            scales: [timeline.end, model.length_scale(timeline.end)],
            first_completed: 0,
            first_censored: 0,
            sub_phases: SubPhaseTotals::default(),
            early_sticks: 0,
            early_slips: 0,
            bands: BandCounts::empty(model, timeline.rows()),
            density: None,
            extremes: None,
            levels: PassageLevels::NONE,
        }
    }

    /// The same counts, with these laws counted.
    pub(super) fn ask_for_laws(&mut self) -> &mut LawsCounts {
        self.laws.get_or_insert_with(|| Box::new(LawsCounts::empty(self.scales)))
    }

    /// The same counts, with extremes and these levels counted.
    pub(super) fn ask_for_levels(&mut self, levels: PassageLevels) -> &mut ExtremeCounts {
        self.levels = levels;
        self.extremes.get_or_insert_with(|| Box::new(ExtremeCounts::empty(self.scales)))
    }

    /// The counts of a law; none if it was not asked for.
    fn law(&self, law: PhaseLaw) -> Option<&LawCounts> {
        match law {
            PhaseLaw::Stick => Some(&self.sticks),
            asked => self.laws.as_ref().map(|laws| laws.law(asked)),
        }
    }

    /// The median of a law without each batch; NaN where it was not asked for.
    pub(super) fn medians_without_each_batch(&self, law: PhaseLaw) -> [f64; BATCHES] {
        self.law(law).map_or([f64::NAN; BATCHES], LawCounts::medians_without_each_batch)
    }

    /// Counts what waits to be counted.
    pub(super) fn settle(&mut self) {
        self.sticks.settle();
        if let Some(laws) = &mut self.laws {
            laws.settle();
        }
        if let Some(extremes) = &mut self.extremes {
            extremes.settle();
        }
        self.bands.settle();
    }

    /// This number of units, if their agreement would be a matter of chance.
    fn chance(&self, units: u64) -> Option<u64> {
        (!self.certain.everything).then_some(units)
    }

    /// Number of independent units folded, without the diverged paths.
    pub(super) fn units(&self) -> u64 {
        self.units
    }

    fn sample(&self) -> Sample {
        Sample { paths: self.paths, units: self.units, is_random: !self.certain.everything }
    }

    fn unit(&self) -> Unit {
        if self.units < self.paths { Unit::Pair } else { Unit::Path }
    }
}

impl Codec for Counts {
    fn write(&self, out: &mut Vec<u8>) {
        self.paths.write(out);
        self.units.write(out);
        self.diverged.write(out);
        self.sticks.write(out);
        u64::from(self.laws.is_some()).write(out);
        if let Some(laws) = &self.laws {
            laws.write(out);
        }
        self.first_completed.write(out);
        self.first_censored.write(out);
        self.sub_phases.write(out);
        self.early_sticks.write(out);
        self.early_slips.write(out);
        self.bands.write(out);
        self.density.write(out);
        self.levels.iter().collect::<Vec<f64>>().write(out);
        if let Some(extremes) = &self.extremes {
            extremes.write(out);
        }
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        self.paths.read(from)?;
        self.units.read(from)?;
        // This is the only list whose length the scenario does not fix.
        let mut ahead = from.clone();
        self.diverged = vec![0; ahead.length()?];
        self.diverged.read(from)?;
        if !self.diverged.is_sorted_by(|a, b| a < b) {
            return Err(Damaged);
        }
        self.sticks.read(from)?;
        let mut has_laws = 0_u64;
        has_laws.read(from)?;
        match has_laws {
            0 => self.laws = None,
            1 => self.ask_for_laws().read(from)?,
            _ => return Err(Damaged),
        }
        self.first_completed.read(from)?;
        self.first_censored.read(from)?;
        self.sub_phases.read(from)?;
        self.early_sticks.read(from)?;
        self.early_slips.read(from)?;
        self.bands.read(from)?;
        self.density.read(from)?;
        let mut levels = vec![0.0; from.clone().length()?.min(PassageLevels::MOST)];
        levels.read(from)?;
        self.extremes = None;
        if !levels.is_empty() {
            self.ask_for_levels(PassageLevels::of(&levels)).read(from)?;
        }
        Ok(())
    }
}

impl Totals {
    /// The totals of no paths.
    pub fn empty(model: &Model, timeline: &Timeline) -> Self {
        Totals { timeline: *timeline, sums: Sums::empty(timeline), counts: Counts::empty(model, timeline) }
    }

    /// The totals from their two parts.
    pub(super) fn of(timeline: Timeline, sums: Sums, counts: Counts) -> Self {
        Totals { timeline, sums, counts }
    }

    /// Set row `row` of the output grid from all paths of the block.
    pub(super) fn row(&mut self, row: usize, snapshot: &Snapshot<'_>, unit: Unit) {
        self.sums.bands.fold(row, snapshot, unit);
        self.counts.bands.fold(row, snapshot);
    }

    /// Set the counts of the paths of one block, once these have reached t_end.
    pub(super) fn end(&mut self, paths: &[PathFold], diverged: &[u64], unit: Unit) {
        self.counts.paths = paths.len() as u64;
        self.counts.units = self.counts.paths / unit.size();
        self.counts.early_sticks = paths.iter().map(|path| u64::from(path.early_sticks)).sum();
        self.counts.early_slips = paths.iter().map(|path| u64::from(path.early_slips)).sum();
        self.counts.diverged = diverged.to_vec();
    }

    /// The summary: estimates with intervals, bands, and histograms.
    pub fn summary(&self) -> Summary {
        let Totals { timeline, sums, counts } = self;
        let ordered = |law| counts.law(law).map(LawCounts::ordered);
        let (sticks, laws) = (counts.sticks.ordered(), PhaseLaw::ASKED.map(ordered));
        let of_law = |law: PhaseLaw| match law {
            PhaseLaw::Stick => Some(&sticks),
            asked => PhaseLaw::ASKED.iter().zip(&laws).find(|(law, _)| **law == asked)?.1.as_ref(),
        };
        let estimate = |statistic: Statistic| match statistic.row().median_of.and_then(of_law) {
            Some(law) => Estimate::new(statistic, sums.phases.in_its_range(statistic, law.median(), counts)),
            None => self.estimate(statistic),
        };
        let bands = bands::summary(&sums.bands, &counts.bands, timeline, counts.certain, counts.unit());
        let mean_motion = [bands.displacement.mean.as_slice(), bands.velocity.mean.as_slice()];
        Summary {
            spectrum: sums.spectrum.as_ref().map(|spectrum| spectrum.summary(timeline, mean_motion)),
            extremes: counts.extremes.as_ref().map(|extremes| {
                extremes.summary(&counts.levels, timeline, counts.chance(counts.units), counts.sample())
            }),
            asked: self.asked(),
            cycle: None,
            densities: counts.density.as_ref().map(|density| density.summary(counts.chance(counts.units))),
            completed_paths: counts.paths + counts.diverged.len() as u64,
            diverged: counts.diverged.clone(),
            estimates: Statistic::ALL.map(estimate),
            stick_durations: self.distribution(PhaseLaw::Stick, &counts.sticks, &sticks),
            first_sticks: self.first_sticks(),
            laws: counts.laws.as_ref().map(|of| {
                let empty = || LawCounts::empty(0.0).ordered();
                let mut ordered = laws.into_iter();
                PhaseLaw::ASKED.map(|law| {
                    let ordered = ordered.next().flatten().unwrap_or_else(empty);
                    self.distribution(law, of.law(law), &ordered)
                })
            }),
            sub_phases: counts.sub_phases.summary(counts.chance(sums.phases.cascade.contributing.slips)),
            transient: (timeline.after > 0.0).then(|| self.transient()),
            periods: sums.phases.periods.summary(timeline, !counts.certain.everything, counts.certain.drift),
            bands,
        }
    }

    /// The statistics that were asked for.
    fn asked(&self) -> Vec<Statistic> {
        Statistic::ALL.into_iter().filter(|statistic| self.sums.phases.is_asked(*statistic)).collect()
    }

    fn distribution(&self, law: PhaseLaw, of: &LawCounts, ordered: &OrderedLaw) -> Distribution {
        let Totals { sums, counts, .. } = self;
        let Some(moments) = sums.phases.law(law) else { return Distribution::default() };
        let chance = counts.chance(moments.contributing());
        of.summary(ordered, chance)
    }

    fn first_sticks(&self) -> FirstSticks {
        let Counts { first_completed: completed, first_censored: censored, .. } = self.counts;
        FirstSticks { completed, censored }
    }

    fn transient(&self) -> Transient {
        let Totals { timeline, sums, counts } = self;
        Transient {
            end: timeline.after,
            sticks: counts.early_sticks,
            slips: counts.early_slips,
            displacement: Measured::mean(&sums.phases.cascade.early_displacement)
                .in_range(Range::ANY, counts.chance(counts.units))
                .measurement(),
        }
    }

    /// One statistic with its interval.
    pub fn estimate(&self, statistic: Statistic) -> Estimate {
        Estimate::new(statistic, self.sums.phases.measured(statistic, &self.timeline, &self.counts))
    }

    /// The numbers of the diverged paths, in ascending order.
    pub fn diverged(&self) -> &[u64] {
        &self.counts.diverged
    }

    /// Every statistic with its interval, in the order of `Statistic::ALL`.
    pub fn estimates(&self) -> [Estimate; Statistic::ALL.len()] {
        Statistic::ALL.map(|statistic| self.estimate(statistic))
    }

    /// The values of the wanted statistics, in the order of `Statistic::ALL`, without errors and
    /// intervals; NaN in the place of the others.
    pub fn values(&self, is_wanted: impl Fn(Statistic) -> bool) -> [f64; Statistic::ALL.len()] {
        let measured = |statistic| self.sums.phases.measured(statistic, &self.timeline, &self.counts);
        let value = |statistic| if is_wanted(statistic) { measured(statistic).estimate() } else { f64::NAN };
        Statistic::ALL.map(value)
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
    pub(super) fn empty(timeline: &Timeline) -> Self {
        PhaseSums {
            cascade: CascadeSums::default(),
            periods: PeriodSums::empty(timeline),
            laws: None,
            energy: None,
            extremes: None,
        }
    }

    /// The sums of paths that have reached t_end.
    pub(super) fn of(
        paths: &[PathFold],
        periods: PeriodSums,
        (laws, motion, record): (Option<&[LawFold]>, &[MotionFold], &Record),
        unit: Unit,
    ) -> Self {
        PhaseSums {
            cascade: CascadeSums::of(paths, unit),
            periods,
            laws: laws.map(|laws| Box::new(LawsSums::of(laws, unit))),
            energy: record.energy.then(|| Box::new(EnergySums::of(motion, unit))),
            extremes: (!record.levels.is_empty()).then(|| Box::new(ExtremeSums::of(motion, unit))),
        }
    }

    /// The moments of a law; none if it was not asked for.
    fn law(&self, law: PhaseLaw) -> Option<&LawSums> {
        match law {
            PhaseLaw::Stick => Some(&self.cascade.sticks),
            asked => self.laws.as_ref().map(|laws| laws.law(asked)),
        }
    }

    /// The measures: those of every run, and those that were asked for.
    fn measures(&self) -> impl Iterator<Item = &dyn Measure> {
        let PhaseSums { cascade, periods, laws, energy, extremes } = self;
        let asked = [
            laws.as_deref().map(|laws| laws as &dyn Measure),
            energy.as_deref().map(|energy| energy as &dyn Measure),
            extremes.as_deref().map(|extremes| extremes as &dyn Measure),
        ];
        let always: [&dyn Measure; 2] = [cascade, periods];
        always.into_iter().chain(asked.into_iter().flatten())
    }

    /// Whether a statistic belongs to what was asked for.
    fn is_asked(&self, statistic: Statistic) -> bool {
        statistic.row().asked_by.is_none_or(|extra| match extra {
            Extra::Laws => self.laws.is_some(),
            Extra::Energy => self.energy.is_some(),
            Extra::Levels => self.extremes.is_some(),
        })
    }

    /// A statistic of the run that has these sums.
    pub(super) fn measured(&self, statistic: Statistic, timeline: &Timeline, counts: &Counts) -> Measured {
        self.in_its_range(statistic, self.without_range(statistic, timeline, counts), counts)
    }

    /// A measured value of a statistic, with an interval that does not leave the range of the
    /// statistic.
    fn in_its_range(&self, statistic: Statistic, measured: Measured, counts: &Counts) -> Measured {
        let contributing = &self.cascade.contributing;
        let units = match statistic.row().over {
            Over::Sticks => self.cascade.sticks.contributing(),
            Over::FirstSticks => contributing.first_sticks,
            Over::Slips => contributing.slips,
            Over::Recurrences => self.law(PhaseLaw::Recurrence).map_or(0, LawSums::contributing),
            Over::CountsOfPaths | Over::Paths => counts.units,
        };
        let range = statistic.row().range;
        measured.in_range(range, counts.chance(units).filter(|_| !statistic.is_decided_by(counts.certain)))
    }

    fn without_range(&self, statistic: Statistic, timeline: &Timeline, counts: &Counts) -> Measured {
        if !self.is_asked(statistic) {
            return Measured::NOTHING;
        }
        if let Some(law) = statistic.row().median_of {
            return counts.law(law).map_or(Measured::NOTHING, |law| law.ordered().median());
        }
        let of = Sampled { timeline, unit: counts.unit() };
        self.measures().find_map(|measure| measure.measured(statistic, &of)).unwrap_or(Measured::NOTHING)
    }
}

#[cfg(test)]
mod tests;
