//! Measures of every run: sticks, slips, sub-phases, jumps, the time at rest, the sliding path and
//! its work, and x at the end.

use super::Statistic;
use super::law::{LawSums, rare_mean, rare_ratio};
use super::measure::{Measure, Sampled};
use super::path::PathFold;
use crate::sums::Replicate;
use crate::sums::codec::sums;
use crate::sums::interval::Measured;
use crate::sums::moments::{FourMoments, JointMoments};
use crate::sums::rare::{FEWEST, FEWEST_FOR_SPREAD, Powers, are_too_few, cautious};
use crate::sums::spread::SpreadMoments;

// Entries of `CascadeSums::slips`.
const SLIPS: usize = 0;
const SUB_PHASES: usize = 1;
const MULTIPLE: usize = 2;
const JUMP: usize = 3;
const JUMP_ABS: usize = 4;

sums! {
    /// Moments over paths of the numbers that describe the cascade of a path.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub(super) struct CascadeSums {
        /// Durations D_j of completed sticks, j >= 1.
        pub sticks: LawSums,
        /// Powers of the influences of paths on means over events.
        tails: CascadeTails,
        /// Whether the first stick ended, and its D_0.
        first_sticks: JointMoments<2>,
        /// Completed dynamic phases, sum of k(j), number with k(j) >= 2, sum of jumps, sum of
        /// |jumps|.
        slips: JointMoments<5>,
        stick_time: FourMoments,
        work: FourMoments,
        sliding_path: FourMoments,
        displacement_end: SpreadMoments,
        /// Displacement during the burn-in.
        pub early_displacement: FourMoments,
        pub contributing: Contributing,
    }
}

sums! {
    /// Powers of the numbers of units, for the law of the errors of these means.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct CascadeTails {
        first_stick_duration: Powers,
        sub_phases: Powers,
        jump: Powers,
        jump_size: Powers,
        slips: Powers,
    }
}

sums! {
    /// Number of units that completed at least one phase of each kind.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub(super) struct Contributing {
        pub first_sticks: u64,
        pub slips: u64,
        /// Units with any static time.
        sticking: u64,
        /// Units that move in the counted time.
        pub moving: u64,
    }
}

impl CascadeSums {
    /// The sums over the paths of a block.
    pub fn of(paths: &[PathFold], unit: Replicate) -> Self {
        let of_paths = |of: fn(&PathFold) -> f64| paths.iter().map(of).collect::<Vec<f64>>();
        let column = |of: fn(&PathFold) -> f64| unit.column(paths, of);
        let count = |is: fn(&PathFold) -> bool| unit.count(paths, is);
        let [first_sticks, first_durations] = [
            column(|p| f64::from(u8::from(p.first_duration.is_some()))),
            column(|p| p.first_duration.unwrap_or(0.0)),
        ];
        let [slips, sub_phases] = [column(|p| p.slips.into()), column(|p| p.sub_phases.into())];
        let [jumps, jump_sizes] = [column(|p| p.jump), column(|p| p.jump_abs)];
        let tails = CascadeTails {
            first_stick_duration: Powers::of(&first_durations, &first_sticks),
            sub_phases: Powers::of(&sub_phases, &slips),
            jump: Powers::of(&jumps, &slips),
            jump_size: Powers::of(&jump_sizes, &slips),
            slips: Powers::of_mean(&slips),
        };
        CascadeSums {
            sticks: LawSums::of(paths, |path| path.sticks, unit),
            tails,
            first_sticks: JointMoments::of([&first_sticks, &first_durations]),
            slips: JointMoments::of([
                &slips,
                &sub_phases,
                &column(|p| p.multiple.into()),
                &jumps,
                &jump_sizes,
            ]),
            stick_time: FourMoments::of(&column(|p| p.stick_time)),
            work: FourMoments::of(&column(|p| p.friction_work)),
            sliding_path: FourMoments::of(&column(|p| p.travel)),
            displacement_end: SpreadMoments::of(&of_paths(|p| p.displacement_end), unit),
            early_displacement: FourMoments::of(&column(|p| p.early_displacement)),
            contributing: Contributing {
                first_sticks: count(|p| p.first_duration.is_some()),
                slips: count(|p| p.slips > 0),
                sticking: count(|p| p.stick_time > 0.0),
                moving: count(|p| p.travel > 0.0),
            },
        }
    }
}

impl Measure for CascadeSums {
    fn measured(&self, statistic: Statistic, of: &Sampled) -> Option<Measured> {
        let CascadeSums {
            sticks,
            tails,
            first_sticks,
            slips,
            stick_time,
            work,
            sliding_path,
            displacement_end,
            ..
        } = self;
        let (contributing, counted) = (&self.contributing, of.timeline.counted());
        let units = work.two.count;
        let moved =
            |measured: Measured, fewest| measured.of_few(contributing.moving, units, fewest);
        let of_slips =
            |measured: Measured, fewest| measured.of_few(contributing.slips, units, fewest);
        let positive = |of: &FourMoments| moved(Measured::mean_of_four(of), FEWEST);
        Some(match statistic {
            Statistic::StickDurationMean => sticks.mean(),
            Statistic::StickDurationSd => sticks.sd(of.unit),
            Statistic::StickDurationCv => sticks.coefficient_of_variation(of.unit),
            Statistic::FirstStickDurationMean => rare_ratio(
                first_sticks,
                1,
                0,
                &tails.first_stick_duration,
                contributing.first_sticks,
            ),
            Statistic::SticksPerPath => sticks.number(),
            Statistic::SlipsPerPath => rare_mean(slips, SLIPS, &tails.slips, contributing.slips),
            Statistic::SubPhasesMean => rare_ratio(
                slips,
                SUB_PHASES,
                SLIPS,
                &tails.sub_phases,
                contributing.slips,
            ),
            Statistic::SubPhasesMultipleShare => of_slips(
                Measured::ratio(slips, MULTIPLE, SLIPS, contributing.slips),
                FEWEST,
            ),
            Statistic::StickingFraction | Statistic::SlidingPathRate if of.timeline.end == 0.0 => {
                Measured::NOTHING
            }
            Statistic::StickingFraction => {
                let law = cautious(stick_time.error_law(), contributing.sticking, units);
                let mean = Measured::mean(&stick_time.two, law);
                let are_few = are_too_few(contributing.sticking, units, FEWEST);
                (if are_few {
                    mean.without_interval()
                } else {
                    mean
                })
                .divided_by(counted)
            }
            Statistic::DisplacementEndMean => {
                moved(Measured::mean_of_four(&displacement_end.units), FEWEST)
            }
            Statistic::DisplacementEndSd => {
                moved(displacement_end.standard_deviation(), FEWEST_FOR_SPREAD)
            }
            Statistic::JumpMean => rare_ratio(slips, JUMP, SLIPS, &tails.jump, contributing.slips),
            Statistic::JumpAbsMean => {
                rare_ratio(slips, JUMP_ABS, SLIPS, &tails.jump_size, contributing.slips)
            }
            Statistic::FrictionWorkMean => positive(work),
            Statistic::SlidingPathRate => positive(sliding_path).divided_by(counted),
            _ => return None,
        })
    }
}
