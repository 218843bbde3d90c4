//! Why a statistic or its interval is missing.

use stick_slip::stats::{Estimate, Statistic, Summary};

/// Why an estimate or its interval is missing; none if both exist.
pub(super) fn absence(e: &Estimate, summary: &Summary) -> Option<&'static str> {
    let valid = summary.completed_paths.saturating_sub(summary.diverged.len() as u64);
    if e.estimate.is_finite() {
        let has_interval = e.standard_error.is_finite() && e.low.is_finite() && e.high.is_finite();
        return match (has_interval, valid) {
            (true, _) => None,
            (false, 0..=1) => Some("an interval needs two paths"),
            (false, _) if e.standard_error == 0.0 => Some("all paths agree"),
            (false, _) => Some("too little to form an interval"),
        };
    }
    let sticks = &summary.stick_durations;
    let slips: u64 = summary.sub_phases.counts.iter().sum();
    let reason = match e.statistic {
        _ if summary.completed_paths == 0 => "no path was completed",
        _ if valid == 0 => "every path diverged or was given up",
        Statistic::StickDurationMean | Statistic::StickDurationSd | Statistic::StickDurationMedian
            if sticks.completed == 0 =>
        {
            "no stick ended, the first one apart"
        }
        Statistic::StickDurationSd => "needs two sticks that ended",
        Statistic::FirstStickDurationMean if sticks.first_completed == 0 => "no first stick ended",
        Statistic::SubPhasesMean | Statistic::SubPhasesMultipleShare | Statistic::JumpMean | Statistic::JumpAbsMean
            if slips == 0 =>
        {
            "no slip was completed"
        }
        Statistic::DriftVelocity
        | Statistic::DiffusionCoefficient
        | Statistic::PeriodDisplacementMean
        | Statistic::PeriodDisplacementSd
            if summary.counted_periods() < 1 =>
        {
            "needs the ends of two forcing periods"
        }
        Statistic::PeriodDisplacementCorrelation if summary.counted_periods() < 2 => {
            "needs the ends of three forcing periods"
        }
        Statistic::PeriodDisplacementCorrelation => "needs displacements that differ",
        Statistic::DisplacementEndSd | Statistic::DiffusionCoefficient if valid < 2 => "needs two paths",
        Statistic::PhaseDisplacementSd if valid < 2 => "needs two paths",
        Statistic::PhaseDisplacementSd => "needs the end of a forcing period",
        Statistic::PeriodDisplacementSd => "needs two displacements",
        Statistic::StickingFraction | Statistic::SlidingPathRate => "the run has no duration",
        _ => "does not exist",
    };
    Some(reason)
}

#[cfg(test)]
mod tests {
    use super::super::sample::{info, reason, row, set, summary};
    use super::super::table;
    use super::*;

    #[test]
    fn a_number_that_does_not_exist_says_why() {
        let mut summary = summary();
        summary.stick_durations.completed = 0;
        summary.stick_durations.first_completed = 0;
        summary.sub_phases.counts = vec![];
        summary.periods.time.truncate(1);
        for (statistic, why) in [
            (Statistic::StickDurationMean, "no stick ended, the first one apart"),
            (Statistic::FirstStickDurationMean, "no first stick ended"),
            (Statistic::SubPhasesMean, "no slip was completed"),
            (Statistic::JumpAbsMean, "no slip was completed"),
            (Statistic::DriftVelocity, "needs the ends of two forcing periods"),
            (Statistic::PeriodDisplacementCorrelation, "needs the ends of three forcing periods"),
        ] {
            set(&mut summary, statistic, f64::NAN);
            let table = table(&summary, &info());
            assert!(row(&table, statistic.name()).contains("none"), "{table}");
            assert_eq!(reason(&table, statistic.name()), why);
        }
    }

    #[test]
    fn paths_that_agree_by_chance_have_no_interval_and_the_table_says_why() {
        let mut summary = summary();
        for e in summary.estimates.iter_mut().filter(|e| e.statistic == Statistic::SlipsPerPath) {
            *e = Estimate { estimate: 0.0, standard_error: 0.0, low: 0.0, high: f64::INFINITY, ..*e };
        }
        let table = table(&summary, &info());
        assert!(row(&table, "slips_per_path").contains("none"), "{table}");
        assert_eq!(reason(&table, "slips_per_path"), "all paths agree");
    }

    #[test]
    fn one_path_has_estimates_without_intervals() {
        let mut summary = summary();
        summary.completed_paths = 1;
        set(&mut summary, Statistic::SticksPerPath, 4.0);
        let table = table(&summary, &info());
        assert!(row(&table, "sticks_per_path").contains("4.000000"), "{table}");
        assert_eq!(reason(&table, "sticks_per_path"), "an interval needs two paths");
        assert_eq!(table.matches("an interval needs two paths").count(), 1, "said once:\n{table}");
    }
}
