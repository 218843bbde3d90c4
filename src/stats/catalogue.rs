//! The list of reported statistics. Each has one name, which is the same in tables, JSON and HDF5.

use super::dimension::Dimension;

/// A reported statistic of an ensemble of paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Statistic {
    /// Mean stick duration D_j = tau_{j+1/2} - tau_j over completed sticks, j >= 1.
    StickDurationMean,
    /// Standard deviation of the stick duration D_j over completed sticks, j >= 1.
    StickDurationSd,
    /// Median stick duration D_j over completed sticks, j >= 1.
    StickDurationMedian,
    /// Mean duration D_0 of the first stick over the paths in which it ended.
    FirstStickDurationMean,
    /// Number of completed sticks, j >= 1, per path.
    SticksPerPath,
    /// Number of completed dynamic phases per path.
    SlipsPerPath,
    /// Mean number k(j) of sub-phases over completed dynamic phases.
    SubPhasesMean,
    /// Share of completed dynamic phases with several sub-phases, k(j) >= 2.
    SubPhasesMultipleShare,
    /// Share of the counted time, [after, t_end], that is spent static, the first and the last
    /// stick included.
    StickingFraction,
    /// Mean displacement at the end, x(t_end).
    DisplacementEndMean,
    /// Standard deviation of the displacement at the end, x(t_end).
    DisplacementEndSd,
    /// Drift velocity: slope of the mean of x(nP) over the whole forcing periods n >= 1 from
    /// `after` on.
    DriftVelocity,
    /// Diffusion coefficient: half the slope of the variance of x(nP) over the whole forcing
    /// periods n >= 1 from `after` on.
    DiffusionCoefficient,
    /// Mean of u_n = x((n + 1)P) - x(nP) over paths and over the whole forcing periods n >= 1 from
    /// `after` on.
    PeriodDisplacementMean,
    /// Standard deviation of u_n over the same paths and periods.
    PeriodDisplacementSd,
    /// Correlation of u_n and u_{n+1}, over the same paths and periods.
    PeriodDisplacementCorrelation,
    /// Standard deviation of x(nP) over paths, as the root mean square over the whole forcing
    /// periods n >= 1 from `after` on.
    PhaseDisplacementSd,
    /// Mean jump of the displacement, x_{j+1} - x_j, over completed dynamic phases.
    JumpMean,
    /// Mean size of that jump, |x_{j+1} - x_j|, over completed dynamic phases.
    JumpAbsMean,
    /// Mean over paths of the friction work, the integral of f_d |x'| dt over [after, t_end].
    FrictionWorkMean,
    /// Mean over paths of the sliding path, the integral of |x'| dt over [after, t_end], divided by
    /// that time.
    SlidingPathRate,
}

impl Statistic {
    /// Every statistic, in the order of tables and files.
    pub const ALL: [Statistic; 21] = [
        Statistic::StickDurationMean,
        Statistic::StickDurationSd,
        Statistic::StickDurationMedian,
        Statistic::FirstStickDurationMean,
        Statistic::SticksPerPath,
        Statistic::SlipsPerPath,
        Statistic::SubPhasesMean,
        Statistic::SubPhasesMultipleShare,
        Statistic::StickingFraction,
        Statistic::DisplacementEndMean,
        Statistic::DisplacementEndSd,
        Statistic::DriftVelocity,
        Statistic::DiffusionCoefficient,
        Statistic::PeriodDisplacementMean,
        Statistic::PeriodDisplacementSd,
        Statistic::PeriodDisplacementCorrelation,
        Statistic::PhaseDisplacementSd,
        Statistic::JumpMean,
        Statistic::JumpAbsMean,
        Statistic::FrictionWorkMean,
        Statistic::SlidingPathRate,
    ];

    /// The position of the statistic in [`Statistic::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// The statistic with this name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Statistic::ALL.into_iter().find(|statistic| statistic.name() == name)
    }

    /// The name of the statistic in tables, JSON and HDF5.
    pub fn name(self) -> &'static str {
        match self {
            Statistic::StickDurationMean => "stick_duration_mean",
            Statistic::StickDurationSd => "stick_duration_sd",
            Statistic::StickDurationMedian => "stick_duration_median",
            Statistic::FirstStickDurationMean => "first_stick_duration_mean",
            Statistic::SticksPerPath => "sticks_per_path",
            Statistic::SlipsPerPath => "slips_per_path",
            Statistic::SubPhasesMean => "sub_phases_mean",
            Statistic::SubPhasesMultipleShare => "sub_phases_multiple_share",
            Statistic::StickingFraction => "sticking_fraction",
            Statistic::DisplacementEndMean => "displacement_end_mean",
            Statistic::DisplacementEndSd => "displacement_end_sd",
            Statistic::DriftVelocity => "drift_velocity",
            Statistic::DiffusionCoefficient => "diffusion_coefficient",
            Statistic::PeriodDisplacementMean => "period_displacement_mean",
            Statistic::PeriodDisplacementSd => "period_displacement_sd",
            Statistic::PeriodDisplacementCorrelation => "period_displacement_correlation",
            Statistic::PhaseDisplacementSd => "phase_displacement_sd",
            Statistic::JumpMean => "jump_mean",
            Statistic::JumpAbsMean => "jump_abs_mean",
            Statistic::FrictionWorkMean => "friction_work_mean",
            Statistic::SlidingPathRate => "sliding_path_rate",
        }
    }

    /// The dimension of the statistic, from which its unit follows.
    pub fn dimension(self) -> Dimension {
        match self {
            Statistic::StickDurationMean
            | Statistic::StickDurationSd
            | Statistic::StickDurationMedian
            | Statistic::FirstStickDurationMean => Dimension::TIME,
            Statistic::SticksPerPath
            | Statistic::SlipsPerPath
            | Statistic::SubPhasesMean
            | Statistic::SubPhasesMultipleShare
            | Statistic::StickingFraction
            | Statistic::PeriodDisplacementCorrelation => Dimension::ONE,
            Statistic::DisplacementEndMean
            | Statistic::DisplacementEndSd
            | Statistic::PeriodDisplacementMean
            | Statistic::PeriodDisplacementSd
            | Statistic::PhaseDisplacementSd
            | Statistic::JumpMean
            | Statistic::JumpAbsMean => Dimension::LENGTH,
            Statistic::DriftVelocity | Statistic::SlidingPathRate => Dimension::VELOCITY,
            Statistic::DiffusionCoefficient => Dimension::DIFFUSIVITY,
            Statistic::FrictionWorkMean => Dimension::WORK,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_statistic_stands_at_its_index() {
        for (i, statistic) in Statistic::ALL.into_iter().enumerate() {
            assert_eq!(statistic.index(), i, "{}", statistic.name());
        }
    }
}
