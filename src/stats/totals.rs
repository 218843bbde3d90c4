//! The sums every statistic is computed from: empty, fold a block, merge, sum up.

use super::bands::BandsTotals;
use super::durations::DurationTotals;
use super::interval::Measured;
use super::moments::{FourMoments, JointMoments, Moments};
use super::path::PathFold;
use super::periods::PeriodTotals;
use super::{Estimate, Statistic, SubPhaseCounts, Summary};
use crate::model::Model;
use crate::scheme::Timeline;

/// Dynamic phases with this many sub-phases or more are counted together.
pub const SUB_PHASE_CAP: usize = 64;

/// Everything an ensemble, or a part of it, is summed up from. Its size does not grow with the number of paths (but for
/// the numbers of the diverged ones).
///
/// Merging is associative up to rounding in the floating-point moments and exactly in every count; a run merges its
/// blocks in block order, which makes it reproducible to the last bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Totals {
    timeline: Timeline,
    /// Paths folded, the diverged left out.
    paths: u64,
    diverged: Vec<u64>,
    cascade: CascadeTotals,
    pub(super) durations: DurationTotals,
    pub(super) sub_phases: SubPhaseTotals,
    pub(super) periods: PeriodTotals,
    pub(super) bands: BandsTotals,
}

impl Totals {
    /// The totals of no paths.
    pub fn empty(model: &Model, timeline: &Timeline) -> Self {
        Totals {
            timeline: *timeline,
            paths: 0,
            diverged: Vec::new(),
            cascade: CascadeTotals::default(),
            durations: DurationTotals::empty(timeline),
            sub_phases: SubPhaseTotals::default(),
            periods: PeriodTotals::empty(timeline),
            bands: BandsTotals::empty(model, timeline),
        }
    }

    /// The paths of one block have reached t_end.
    pub(super) fn end(&mut self, paths: &[PathFold], dynamic_force: f64, diverged: &[u64]) {
        self.paths = paths.len() as u64;
        self.diverged = diverged.to_vec();
        self.cascade = CascadeTotals::of(paths, dynamic_force);
    }

    /// Add the paths of `other`, a later block of the same run.
    pub fn merge(&mut self, other: &Totals) {
        debug_assert_eq!(self.timeline, other.timeline, "totals of different runs");
        self.paths += other.paths;
        self.diverged.extend_from_slice(&other.diverged);
        self.cascade.merge(&other.cascade);
        self.durations.merge(&other.durations);
        self.sub_phases.merge(&other.sub_phases);
        self.periods.merge(&other.periods);
        self.bands.merge(&other.bands);
    }

    /// Estimates with intervals, bands, histograms.
    pub fn summary(&self) -> Summary {
        Summary {
            completed_paths: self.paths + self.diverged.len() as u64,
            diverged: self.diverged.clone(),
            estimates: Statistic::ALL.map(|statistic| self.estimate(statistic)).to_vec(),
            stick_durations: self.durations.summary(),
            sub_phases: self.sub_phases.summary(),
            periods: self.periods.summary(),
            bands: self.bands.summary(&self.timeline),
        }
    }

    fn estimate(&self, statistic: Statistic) -> Estimate {
        let CascadeTotals { sticks, first_sticks, slips, stick_time, work, displacement_end, contributing } =
            &self.cascade;
        let measured = match statistic {
            Statistic::StickDurationMean => Measured::ratio(sticks, STICK_SUM, STICKS, contributing.sticks),
            Statistic::StickDurationSd => stick_duration_sd(sticks, contributing.sticks),
            Statistic::StickDurationMedian => self.durations.median(),
            Statistic::FirstStickDurationMean => Measured::ratio(first_sticks, 1, 0, contributing.first_sticks),
            Statistic::SticksPerPath => Measured::mean_of(sticks, STICKS),
            Statistic::SlipsPerPath => Measured::mean_of(slips, SLIPS),
            Statistic::SubPhasesMean => Measured::ratio(slips, SUB_PHASES, SLIPS, contributing.slips),
            Statistic::SubPhasesMultipleShare => Measured::ratio(slips, MULTIPLE, SLIPS, contributing.slips),
            Statistic::StickingFraction if self.timeline.end == 0.0 => Measured::NOTHING,
            Statistic::StickingFraction => Measured::mean(stick_time).divided_by(self.timeline.end),
            Statistic::DisplacementEndMean => Measured::mean(&displacement_end.two),
            Statistic::DisplacementEndSd => Measured::standard_deviation(displacement_end),
            Statistic::DriftVelocity => self.periods.drift_velocity(),
            Statistic::DiffusionCoefficient => self.periods.diffusion_coefficient(),
            Statistic::JumpMean => Measured::ratio(slips, JUMP, SLIPS, contributing.slips),
            Statistic::JumpAbsMean => Measured::ratio(slips, JUMP_ABS, SLIPS, contributing.slips),
            Statistic::FrictionWorkMean => Measured::mean(work),
        };
        measured.named(statistic)
    }
}

// Entries of `CascadeTotals::sticks`; the third, the sum of squares, is used by `stick_duration_sd` alone.
const STICKS: usize = 0;
const STICK_SUM: usize = 1;

// Entries of `CascadeTotals::slips`.
const SLIPS: usize = 0;
const SUB_PHASES: usize = 1;
const MULTIPLE: usize = 2;
const JUMP: usize = 3;
const JUMP_ABS: usize = 4;

/// Moments over paths of what each path's cascade comes down to.
#[derive(Clone, Debug, Default, PartialEq)]
struct CascadeTotals {
    /// Number of completed sticks, j >= 1, sum of D_j, sum of D_j^2.
    sticks: JointMoments<3>,
    /// Whether the first stick ended, and its D_0.
    first_sticks: JointMoments<2>,
    /// Completed dynamic phases, sum of k(j), number with k(j) >= 2, sum of jumps, sum of |jumps|.
    slips: JointMoments<5>,
    stick_time: Moments,
    work: Moments,
    displacement_end: FourMoments,
    contributing: Contributing,
}

/// Number of paths that completed at least one of each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Contributing {
    sticks: u64,
    first_sticks: u64,
    slips: u64,
}

impl CascadeTotals {
    fn of(paths: &[PathFold], dynamic_force: f64) -> Self {
        let column = |of: fn(&PathFold) -> f64| paths.iter().map(of).collect::<Vec<f64>>();
        let count = |is: fn(&PathFold) -> bool| paths.iter().filter(|p| is(p)).count() as u64;
        let work: Vec<f64> = paths.iter().map(|p| dynamic_force * p.travel).collect();
        CascadeTotals {
            sticks: JointMoments::of([
                &column(|p| p.sticks.into()),
                &column(|p| p.duration),
                &column(|p| p.duration_squared),
            ]),
            first_sticks: JointMoments::of([
                &column(|p| f64::from(u8::from(p.first_duration.is_some()))),
                &column(|p| p.first_duration.unwrap_or(0.0)),
            ]),
            slips: JointMoments::of([
                &column(|p| p.slips.into()),
                &column(|p| p.sub_phases.into()),
                &column(|p| p.multiple.into()),
                &column(|p| p.jump),
                &column(|p| p.jump_abs),
            ]),
            stick_time: Moments::of(&column(|p| p.stick_time)),
            work: Moments::of(&work),
            displacement_end: FourMoments::of(&column(|p| p.displacement_end)),
            contributing: Contributing {
                sticks: count(|p| p.sticks > 0),
                first_sticks: count(|p| p.first_duration.is_some()),
                slips: count(|p| p.slips > 0),
            },
        }
    }

    fn merge(&mut self, other: &CascadeTotals) {
        self.sticks.merge(&other.sticks);
        self.first_sticks.merge(&other.first_sticks);
        self.slips.merge(&other.slips);
        self.stick_time.merge(&other.stick_time);
        self.work.merge(&other.work);
        self.displacement_end.merge(&other.displacement_end);
        self.contributing.sticks += other.contributing.sticks;
        self.contributing.first_sticks += other.contributing.first_sticks;
        self.contributing.slips += other.contributing.slips;
    }
}

/// sqrt(q/n - (s/n)^2) from the means over paths n, s, q of the number of sticks, of their summed durations and of their
/// summed squares. An sd below 1e-8 of the root mean square is lost in rounding, and comes out as zero.
fn stick_duration_sd(paths: &JointMoments<3>, contributing: u64) -> Measured {
    let [n, s, q] = paths.mean;
    // One stick has no spread.
    if n * paths.count as f64 <= 1.5 {
        return Measured::NOTHING;
    }
    let (mean, mean_square) = (s / n, q / n);
    let variance = mean_square - mean * mean;
    if variance <= 4.0 * f64::EPSILON * mean_square {
        return Measured::smooth(0.0, paths, [0.0; 3], contributing);
    }
    let sd = variance.sqrt();
    let gradient = [2.0 * mean * mean - mean_square, -2.0 * mean, 1.0].map(|g| g / (2.0 * sd * n));
    Measured::smooth(sd, paths, gradient, contributing)
}

/// Counts of k(j).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SubPhaseTotals {
    counts: [u64; SUB_PHASE_CAP],
    censored: u64,
}

impl Default for SubPhaseTotals {
    fn default() -> Self {
        SubPhaseTotals { counts: [0; SUB_PHASE_CAP], censored: 0 }
    }
}

impl SubPhaseTotals {
    /// A dynamic phase of k >= 1 sub-phases is complete.
    #[inline]
    pub fn completed(&mut self, k: u32) {
        self.counts[(k.max(1) as usize).min(SUB_PHASE_CAP) - 1] += 1;
    }

    /// A dynamic phase runs at t_end.
    pub fn censored(&mut self) {
        self.censored += 1;
    }

    fn merge(&mut self, other: &SubPhaseTotals) {
        for (mine, more) in self.counts.iter_mut().zip(&other.counts) {
            *mine += more;
        }
        self.censored += other.censored;
    }

    fn summary(&self) -> SubPhaseCounts {
        SubPhaseCounts { counts: self.counts.to_vec(), censored: self.censored }
    }
}
