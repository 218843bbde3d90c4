//! Why a statistic or its interval is missing.

use super::need::Need;
use super::{Estimate, PhaseLaw, Statistic, Summary};

/// Whether the summary shows that a need is not met. A need that a summary cannot show comes last
/// in a row, and is the default reason.
fn is_missing(need: Need, summary: &Summary) -> bool {
    match need {
        Need::Stick => summary.stick_durations.completed == 0,
        Need::FirstStick => summary.first_sticks.completed == 0,
        Need::Slip => summary.sub_phases.counts.iter().all(|count| *count == 0),
        Need::Period => summary.counted_periods() < 1,
        Need::TwoPeriods => summary.counted_periods() < 2,
        Need::TwoPaths => summary.valid_paths() < 2,
        Need::Recurrence => summary
            .law(PhaseLaw::Recurrence)
            .is_none_or(|law| law.completed == 0),
        Need::TwoSticks
        | Need::TwoSlips
        | Need::TwoRecurrences
        | Need::EndOfPeriod
        | Need::TwoDisplacements
        | Need::DifferentDisplacements
        | Need::Duration => true,
    }
}

/// Whether a statistic measures the spread over paths.
fn is_spread(statistic: Statistic) -> bool {
    ["_sd", "_cv", "_correlation", "_coefficient"]
        .iter()
        .any(|end| statistic.name().ends_with(end))
}

impl Summary {
    /// Number of completed paths that did not diverge.
    pub(crate) fn valid_paths(&self) -> u64 {
        self.completed_paths
            .saturating_sub(self.diverged.len() as u64)
    }

    /// Why an estimate or its interval is missing; none if both exist.
    pub fn absence(&self, e: &Estimate) -> Option<&'static str> {
        if e.estimate.is_finite() {
            let has_interval =
                e.standard_error.is_finite() && e.low.is_finite() && e.high.is_finite();
            return match (has_interval, self.valid_paths()) {
                (true, _) => None,
                (false, 0..=1) => Some("an interval needs two paths"),
                // Two values are always equally far from their mean.
                (false, 2)
                    if e.standard_error == 0.0 && e.estimate != 0.0 && is_spread(e.statistic) =>
                {
                    Some("an interval needs three paths")
                }
                (false, _) if e.standard_error == 0.0 => Some("all paths agree"),
                (false, _) => Some("too few data for an interval"),
            };
        }
        if self.completed_paths == 0 {
            return Some("no path was completed");
        }
        if self.valid_paths() == 0 {
            return Some("every path diverged or was given up");
        }
        let missing = e
            .statistic
            .row()
            .needs
            .iter()
            .find(|need| is_missing(**need, self));
        Some(missing.map_or("does not exist", |need| need.words()))
    }
}
