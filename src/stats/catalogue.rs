//! The list of reported statistics: one row for each, used by tables, files, pictures and the bias
//! of the step. The formulas are in the files of the measures ([`super::measure`]).

use super::deterministic::Deterministic;
use super::dimension::Dimension;
use super::law::PhaseLaw;
use super::need::Need;
use crate::sums::range::Range;

/// The properties of a statistic, independent of any simulation.
#[derive(Clone, Copy)]
pub(crate) struct CatalogueRow {
    /// Its name in tables, JSON and HDF5.
    name: &'static str,
    /// Its name at an axis.
    words: &'static str,
    /// Its meaning, in words that fit a table or the title of a plot.
    meaning: &'static str,
    /// Its dimension, from which its unit follows.
    dimension: Dimension,
    pub range: Range,
    pub over: Over,
    pub step_error: StepError,
    /// Whether the scenario alone determines the statistic.
    is_deterministic: fn(Deterministic) -> bool,
    /// Why it may not exist: the first of these needs that is not met.
    pub needs: &'static [Need],
    /// The law whose median it is, if it is a median.
    pub median_of: Option<PhaseLaw>,
    /// The optional measure to which the statistic belongs, if any.
    pub asked_by: Option<Extra>,
}

impl CatalogueRow {
    /// A row like this one with these names and this meaning.
    const fn called(self, name: &'static str, words: &'static str, meaning: &'static str) -> Self {
        CatalogueRow {
            name,
            words,
            meaning,
            ..self
        }
    }
}

/// Measures on request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extra {
    /// `record.laws`.
    Laws,
    /// `record.energy`.
    Energy,
    /// `statistics.levels`.
    Levels,
}

/// The population over which a statistic is a mean, or which it counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    /// Completed sticks, the first one apart.
    Sticks,
    /// First sticks that ended.
    FirstSticks,
    /// Completed dynamic phases.
    Slips,
    /// Times from the beginning of a dynamic phase to that of the next.
    Recurrences,
    /// Paths, for each of which phases are counted.
    CountsOfPaths,
    /// Paths.
    Paths,
}

impl Over {
    /// Whether phases are counted or averaged over. There are infinitely many of them if slips of
    /// all sizes occur, which does not affect total times, the first stick and positions.
    #[cfg(feature = "toml")]
    pub fn counts_phases(self) -> bool {
        matches!(
            self,
            Over::Sticks | Over::Slips | Over::Recurrences | Over::CountsOfPaths
        )
    }
}

/// How the error of the time step depends on the step h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StepError {
    /// As sqrt(h): thresholds are checked only once per step.
    Root,
    /// Likewise, and most affected by the short slips that a long step misses.
    RootOfRare,
    /// As h, or as sqrt(h), whichever is observed.
    FirstOrRoot,
    /// In jumps: a median jumps from one hump of the law to another.
    Jumps,
}

/// From one list: the statistics, and their rows in the same order.
macro_rules! catalogue {
    ($($(#[$doc:meta])* $statistic:ident: $row:expr,)*) => {
        /// A reported statistic of an ensemble of paths.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Statistic {
            $($(#[$doc])* $statistic,)*
        }

        impl Statistic {
            /// Every statistic, in the order of tables and files.
            pub const ALL: [Statistic; ROWS.len()] = [$(Statistic::$statistic,)*];
        }

        static ROWS: [CatalogueRow; [$(Statistic::$statistic,)*].len()] = [$($row,)*];
    };
}

const OF_PATHS: CatalogueRow = CatalogueRow {
    name: "",
    words: "",
    meaning: "",
    dimension: Dimension::LENGTH,
    range: Range::ANY,
    over: Over::Paths,
    step_error: StepError::FirstOrRoot,
    is_deterministic: |_| false,
    needs: &[],
    median_of: None,
    asked_by: None,
};
const OF_STICKS: CatalogueRow = CatalogueRow {
    dimension: Dimension::TIME,
    range: Range::NOT_NEGATIVE,
    over: Over::Sticks,
    step_error: StepError::Root,
    needs: &[Need::Stick],
    ..OF_PATHS
};
const OF_SLIPS: CatalogueRow = CatalogueRow {
    over: Over::Slips,
    step_error: StepError::Root,
    needs: &[Need::Slip],
    ..OF_PATHS
};
const COUNTED: CatalogueRow = CatalogueRow {
    dimension: Dimension::ONE,
    range: Range::NOT_NEGATIVE,
    over: Over::CountsOfPaths,
    step_error: StepError::RootOfRare,
    is_deterministic: |scene| scene.never_sticks,
    ..OF_PATHS
};
/// Energy over the counted time, on request.
const OF_ENERGY: CatalogueRow = CatalogueRow {
    dimension: Dimension::WORK,
    asked_by: Some(Extra::Energy),
    ..OF_PATHS
};
/// A number of the largest displacements or speeds, on request.
const OF_EXTREMES: CatalogueRow = CatalogueRow {
    range: Range::NOT_NEGATIVE,
    asked_by: Some(Extra::Levels),
    ..OF_PATHS
};
/// A number of durations of slips, sizes of jumps or times from slip to slip, on request.
const OF_LAWS: CatalogueRow = CatalogueRow {
    range: Range::NOT_NEGATIVE,
    asked_by: Some(Extra::Laws),
    ..OF_SLIPS
};
/// Spreads of quantities of slips.
const OF_SLIP_SPREADS: CatalogueRow = CatalogueRow {
    needs: &[Need::Slip, Need::TwoSlips],
    ..OF_LAWS
};
const OF_SLIP_DURATIONS: CatalogueRow = CatalogueRow {
    dimension: Dimension::TIME,
    ..OF_LAWS
};
const OF_RECURRENCE: CatalogueRow = CatalogueRow {
    dimension: Dimension::TIME,
    over: Over::Recurrences,
    needs: &[Need::Recurrence],
    ..OF_LAWS
};
const OF_PERIODS: CatalogueRow = CatalogueRow {
    needs: &[Need::Period],
    ..OF_PATHS
};

catalogue! {
    /// Mean stick duration D_j = tau_{j+1/2} - tau_j over completed sticks, j >= 1.
    StickDurationMean: OF_STICKS.called(
        "stick_duration_mean", "mean stick duration", "mean duration of the completed sticks"),
    /// Standard deviation of the stick duration D_j over completed sticks, j >= 1.
    StickDurationSd: CatalogueRow {
        step_error: StepError::RootOfRare,
        needs: &[Need::Stick, Need::TwoSticks],
        ..OF_STICKS.called(
            "stick_duration_sd", "sd of stick durations",
            "standard deviation of the durations of the completed sticks")
    },
    /// Median stick duration D_j over completed sticks, j >= 1.
    StickDurationMedian: CatalogueRow {
        step_error: StepError::Jumps,
        median_of: Some(PhaseLaw::Stick),
        ..OF_STICKS.called(
            "stick_duration_median", "median stick duration", "median duration of the completed sticks")
    },
    /// Mean duration D_0 of the first stick over the paths in which it ended.
    FirstStickDurationMean: CatalogueRow {
        over: Over::FirstSticks,
        is_deterministic: |scene| scene.first_stick,
        needs: &[Need::FirstStick],
        ..OF_STICKS.called(
            "first_stick_duration_mean", "mean first stick", "mean duration of the first sticks that ended")
    },
    /// Number of completed sticks, j >= 1, per path.
    SticksPerPath: COUNTED.called(
        "sticks_per_path", "sticks per path", "completed sticks per path, without the first"),
    /// Number of completed dynamic phases per path.
    SlipsPerPath: COUNTED.called(
        "slips_per_path", "slips per path", "completed dynamic phases per path"),
    /// Mean number k(j) of sub-phases over completed dynamic phases.
    SubPhasesMean: CatalogueRow {
        dimension: Dimension::ONE,
        range: Range::FROM_ONE,
        ..OF_SLIPS.called(
            "sub_phases_mean", "mean number of sub-phases", "mean number of sub-phases of a dynamic phase")
    },
    /// Share of completed dynamic phases with several sub-phases, k(j) >= 2.
    SubPhasesMultipleShare: CatalogueRow {
        dimension: Dimension::ONE,
        range: Range::SHARE,
        ..OF_SLIPS.called(
            "sub_phases_multiple_share", "share of slips with several sub-phases",
            "share of dynamic phases with two or more sub-phases")
    },
    /// Share of the counted time, [after, t_end], that is spent static, the first and the last
    /// stick included.
    StickingFraction: CatalogueRow {
        dimension: Dimension::ONE,
        range: Range::SHARE,
        step_error: StepError::Root,
        is_deterministic: |scene| scene.never_sticks && scene.first_stick,
        needs: &[Need::Duration],
        ..OF_PATHS.called(
            "sticking_fraction", "share of time spent static", "share of the time spent in static phases")
    },
    /// Mean displacement at the end, x(t_end).
    DisplacementEndMean: OF_PATHS.called(
        "displacement_end_mean", "mean final displacement", "mean displacement at the end"),
    /// Standard deviation of the displacement at the end, x(t_end).
    DisplacementEndSd: CatalogueRow {
        range: Range::NOT_NEGATIVE,
        needs: &[Need::TwoPaths],
        ..OF_PATHS.called(
            "displacement_end_sd", "sd of final displacement", "standard deviation of the displacement at the end")
    },
    /// Drift velocity: slope of the mean of x(nP) over the whole periods n >= 1 from
    /// `after` on.
    DriftVelocity: CatalogueRow {
        dimension: Dimension::VELOCITY,
        ..OF_PERIODS.called(
            "drift_velocity", "drift velocity", "slope of the mean displacement over whole periods")
    },
    /// Diffusion coefficient: half the slope of the variance of x(nP) over the whole
    /// periods n >= 1 from `after` on.
    DiffusionCoefficient: CatalogueRow {
        dimension: Dimension::DIFFUSIVITY,
        needs: &[Need::Period, Need::TwoPaths],
        ..OF_PATHS.called(
            "diffusion_coefficient", "diffusion coefficient",
            "half the slope of the variance of the displacement over whole periods")
    },
    /// Mean of u_n = x((n + 1)P) - x(nP) over paths and over the whole periods n >= 1 from
    /// `after` on.
    PeriodDisplacementMean: OF_PERIODS.called(
        "period_displacement_mean", "mean displacement per period", "mean displacement from one period to the next"),
    /// Standard deviation of u_n over the same paths and periods.
    PeriodDisplacementSd: CatalogueRow {
        range: Range::NOT_NEGATIVE,
        needs: &[Need::Period, Need::TwoDisplacements],
        ..OF_PATHS.called(
            "period_displacement_sd", "sd of displacement per period",
            "standard deviation of the displacement from one period to the next")
    },
    /// Correlation of u_n and u_{n+1}, over the same paths and periods.
    PeriodDisplacementCorrelation: CatalogueRow {
        dimension: Dimension::ONE,
        range: Range::CORRELATION,
        needs: &[Need::TwoPeriods, Need::DifferentDisplacements],
        ..OF_PATHS.called(
            "period_displacement_correlation", "correlation of successive periods",
            "correlation of the displacements in successive periods")
    },
    /// Standard deviation of x(nP) over paths, as the root mean square over the whole
    /// periods n >= 1 from `after` on.
    PhaseDisplacementSd: CatalogueRow {
        range: Range::NOT_NEGATIVE,
        needs: &[Need::TwoPaths, Need::EndOfPeriod],
        ..OF_PATHS.called(
            "phase_displacement_sd", "sd of displacement at one phase",
            "standard deviation of the displacement at one phase")
    },
    /// Mean jump of the displacement, x_{j+1} - x_j, over completed dynamic phases.
    JumpMean: OF_SLIPS.called(
        "jump_mean", "mean jump", "mean jump of the displacement in a dynamic phase"),
    /// Mean size of that jump, |x_{j+1} - x_j|, over completed dynamic phases.
    JumpAbsMean: CatalogueRow {
        range: Range::NOT_NEGATIVE,
        ..OF_SLIPS.called(
            "jump_abs_mean", "mean size of a jump", "mean size of the jump of the displacement in a dynamic phase")
    },
    /// Mean over paths of the friction work, the integral of f_d |x'| dt over [after, t_end].
    FrictionWorkMean: CatalogueRow {
        dimension: Dimension::WORK,
        range: Range::NOT_NEGATIVE,
        is_deterministic: |scene| scene.frictionless,
        ..OF_PATHS.called(
            "friction_work_mean", "mean friction work", "mean work done against dynamic friction")
    },
    /// Mean over paths of the sliding path, the integral of |x'| dt over [after, t_end], divided by
    /// that time.
    SlidingPathRate: CatalogueRow {
        dimension: Dimension::VELOCITY,
        range: Range::NOT_NEGATIVE,
        needs: &[Need::Duration],
        ..OF_PATHS.called(
            "sliding_path_rate", "sliding path per time", "mean sliding path per unit of time")
    },
    /// Coefficient of variation of the stick duration D_j over completed sticks, j >= 1.
    StickDurationCv: CatalogueRow {
        dimension: Dimension::ONE,
        step_error: StepError::RootOfRare,
        needs: &[Need::Stick, Need::TwoSticks],
        asked_by: Some(Extra::Laws),
        ..OF_STICKS.called(
            "stick_duration_cv", "variation of stick durations",
            "coefficient of variation of the durations of the completed sticks")
    },
    /// Mean duration tau_{j+1} - tau_{j+1/2} over completed dynamic phases.
    SlipDurationMean: OF_SLIP_DURATIONS.called(
        "slip_duration_mean", "mean slip duration", "mean duration of the completed dynamic phases"),
    /// Standard deviation of these durations.
    SlipDurationSd: CatalogueRow {
        dimension: Dimension::TIME,
        ..OF_SLIP_SPREADS.called(
            "slip_duration_sd", "sd of slip durations",
            "standard deviation of the durations of the completed dynamic phases")
    },
    /// Median of these durations.
    SlipDurationMedian: CatalogueRow {
        step_error: StepError::Jumps,
        median_of: Some(PhaseLaw::Slip),
        ..OF_SLIP_DURATIONS.called(
            "slip_duration_median", "median slip duration", "median duration of the completed dynamic phases")
    },
    /// Coefficient of variation of these durations.
    SlipDurationCv: CatalogueRow {
        dimension: Dimension::ONE,
        ..OF_SLIP_SPREADS.called(
            "slip_duration_cv", "variation of slip durations",
            "coefficient of variation of the durations of the completed dynamic phases")
    },
    /// Standard deviation of the jump x_{j+1} - x_j over completed dynamic phases.
    JumpSd: OF_SLIP_SPREADS.called(
        "jump_sd", "sd of jumps", "standard deviation of the jump of the displacement in a dynamic phase"),
    /// Standard deviation of its size |x_{j+1} - x_j|.
    JumpAbsSd: OF_SLIP_SPREADS.called(
        "jump_abs_sd", "sd of sizes of jumps", "standard deviation of the size of the jump in a dynamic phase"),
    /// Median of its size.
    JumpAbsMedian: CatalogueRow {
        median_of: Some(PhaseLaw::Jump),
        ..OF_LAWS.called(
            "jump_abs_median", "median size of a jump", "median size of the jump in a dynamic phase")
    },
    /// Coefficient of variation of its size.
    JumpAbsCv: CatalogueRow {
        dimension: Dimension::ONE,
        ..OF_SLIP_SPREADS.called(
            "jump_abs_cv", "variation of sizes of jumps",
            "coefficient of variation of the size of the jump in a dynamic phase")
    },
    /// Mean time tau_{j+3/2} - tau_{j+1/2} from the beginning of a dynamic phase to that of the
    /// next.
    RecurrenceTimeMean: OF_RECURRENCE.called(
        "recurrence_time_mean", "mean time from slip to slip",
        "mean time from the beginning of a dynamic phase to that of the next"),
    /// Standard deviation of this time.
    RecurrenceTimeSd: CatalogueRow {
        needs: &[Need::Recurrence, Need::TwoRecurrences],
        ..OF_RECURRENCE.called(
            "recurrence_time_sd", "sd of times from slip to slip",
            "standard deviation of the time from a dynamic phase to the next")
    },
    /// Median of this time.
    RecurrenceTimeMedian: CatalogueRow {
        step_error: StepError::Jumps,
        median_of: Some(PhaseLaw::Recurrence),
        ..OF_RECURRENCE.called(
            "recurrence_time_median", "median time from slip to slip",
            "median time from the beginning of a dynamic phase to that of the next")
    },
    /// Coefficient of variation of this time.
    RecurrenceTimeCv: CatalogueRow {
        dimension: Dimension::ONE,
        needs: &[Need::Recurrence, Need::TwoRecurrences],
        ..OF_RECURRENCE.called(
            "recurrence_time_cv", "variation of times from slip to slip",
            "coefficient of variation of the time from a dynamic phase to the next")
    },
    /// Mean over paths of the work of the temperature, the integral of c T x' dt over [after,
    /// t_end].
    TemperatureWorkMean: OF_ENERGY.called(
        "temperature_work_mean", "mean work of the temperature", "mean work of the temperature on the body"),
    /// Mean over paths of the work of a user-defined force, the integral of g x' dt.
    UserForceWorkMean: OF_ENERGY.called(
        "own_force_work_mean", "mean work of the user-defined force", "mean work of the user-defined force on the body"),
    /// Mean over paths of the energy dissipated by damping, the integral of 2 alpha x'^2 dt.
    DampingWorkMean: OF_ENERGY.called(
        "damping_work_mean", "mean work of damping", "mean work done against damping"),
    /// Mean over paths of the change of m x'^2/2 + K x^2/2.
    StoredEnergyMean: OF_ENERGY.called(
        "stored_energy_change_mean", "mean change of stored energy",
        "mean change of kinetic and spring energy"),
    /// Mean over paths of the residual of the energy balance.
    EnergyResidualMean: OF_ENERGY.called(
        "energy_residual_mean", "mean residual of the energy balance",
        "mean residual of the energy balance, a numerical error"),
    /// Standard deviation over paths of the residual of the energy balance.
    EnergyResidualSd: CatalogueRow {
        range: Range::NOT_NEGATIVE,
        needs: &[Need::TwoPaths],
        ..OF_ENERGY.called(
            "energy_residual_sd", "sd of the residual of the energy balance",
            "standard deviation of the residual of the energy balance")
    },
    /// Mean over paths of the largest |x - x0| over [0, t_end].
    LargestDisplacementMean: OF_EXTREMES.called(
        "largest_displacement_mean", "mean largest displacement",
        "mean of the largest distance from the initial displacement"),
    /// Standard deviation over paths of the largest |x - x0|.
    LargestDisplacementSd: CatalogueRow {
        needs: &[Need::TwoPaths],
        ..OF_EXTREMES.called(
            "largest_displacement_sd", "sd of the largest displacement",
            "standard deviation of the largest distance from the initial displacement")
    },
    /// Mean over paths of the largest |x'| over [0, t_end].
    LargestSpeedMean: CatalogueRow {
        dimension: Dimension::VELOCITY,
        ..OF_EXTREMES.called(
            "largest_speed_mean", "mean largest speed", "mean of the largest speed")
    },
    /// Standard deviation over paths of the largest |x'|.
    LargestSpeedSd: CatalogueRow {
        dimension: Dimension::VELOCITY,
        needs: &[Need::TwoPaths],
        ..OF_EXTREMES.called(
            "largest_speed_sd", "sd of the largest speed", "standard deviation of the largest speed")
    },
}

impl Statistic {
    /// The position of the statistic in [`Statistic::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// The statistic with this name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Statistic::ALL
            .into_iter()
            .find(|statistic| statistic.name() == name)
    }

    pub(crate) fn row(self) -> &'static CatalogueRow {
        &ROWS[self.index()]
    }

    /// Whether the scenario alone determines the statistic, so that all paths must agree on it.
    pub(super) fn is_decided_by(self, scene: Deterministic) -> bool {
        scene.everything || (self.row().is_deterministic)(scene)
    }

    /// The name of the statistic in tables, JSON and HDF5.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The name of the statistic at an axis, e.g. "mean stick duration".
    pub fn words(self) -> &'static str {
        self.row().words
    }

    /// The meaning of the statistic, in words that fit a table or the title of a plot.
    pub fn meaning(self) -> &'static str {
        self.row().meaning
    }

    /// The dimension of the statistic, from which its unit follows.
    pub fn dimension(self) -> Dimension {
        self.row().dimension
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

    #[test]
    fn every_row_is_written_out() {
        for statistic in Statistic::ALL {
            let texts = [statistic.name(), statistic.words(), statistic.meaning()];
            assert!(texts.iter().all(|text| !text.is_empty()), "{statistic:?}");
            assert_eq!(Statistic::from_name(statistic.name()), Some(statistic));
        }
    }
}
