//! The bias of the step in a report.

use crate::cli::numbers::{Digits, with_error};
use stick_slip::stats::{Bias, Estimate, Summary};

/// A bias and its uncertainty, to two digits of the uncertainty; `none` where the bias is not
/// known.
pub fn bias_cells(bias: Option<Bias>) -> [String; 2] {
    match bias {
        Some(Bias { estimate, uncertainty, .. }) => with_error(estimate, uncertainty),
        None => ["none".into(), String::new()],
    }
}

/// The corrected estimate to two digits of its own error. Empty where the correction does not
/// improve the plain estimate.
pub(super) fn corrected_cell(e: &Estimate) -> String {
    let is_better = e.bias.is_some_and(|bias| bias.weight() > 0.0);
    let Some(corrected) = e.corrected().filter(|_| is_better) else { return String::new() };
    let half_width = (corrected.high - corrected.low) / 2.0;
    Digits::of(corrected.estimate, half_width / NORMAL_REACH).show(corrected.estimate)
}

/// Half the width of a 95 % interval of a normal distribution, in standard errors.
const NORMAL_REACH: f64 = 1.96;

/// [`beyond_intervals`] as a warning.
pub fn dominating_bias(summary: &Summary) -> Option<String> {
    beyond_intervals(summary).map(|words| format!("bias {words}"))
}

/// Says in how many statistics the bias of the step is certain and larger than the statistical
/// interval suggests, and what to do. None if there is no such statistic.
pub(super) fn beyond_intervals(summary: &Summary) -> Option<String> {
    let dominated = summary.dominated_by_bias();
    (!dominated.is_empty()).then(|| {
        format!(
            "of the step exceeds {} of {} intervals; `event-driven` has none",
            dominated.len(),
            summary.asked.len(),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::sample::summary;
    use super::*;

    #[test]
    fn a_bias_beyond_the_interval_is_told() {
        let bias = |estimate, uncertainty| Some(Bias { estimate, uncertainty, order: None });
        let mut summary = summary();
        assert_eq!(dominating_bias(&summary), None);
        // The half-widths of the intervals of the sample are 0.00052, 0.0143 and 0.0314.
        summary.estimates[0].bias = bias(0.0005, 0.0001);
        assert_eq!(dominating_bias(&summary), None, "within the interval");
        summary.estimates[0].bias = bias(0.0955, 0.1);
        assert_eq!(dominating_bias(&summary), None, "in doubt");
        summary.estimates[0].bias = bias(0.0955, 0.0311);
        summary.estimates[1].bias = bias(0.5, 0.1);
        let line = dominating_bias(&summary).expect("two are dominated");
        assert!(line.contains("exceeds 2 of 21 intervals"), "{line}");
    }
}
