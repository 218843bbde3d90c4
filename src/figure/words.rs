//! What statistics are called at an axis.

use crate::stats::Statistic;

/// A statistic in a few words: "mean stick duration".
pub fn words(statistic: Statistic) -> &'static str {
    match statistic {
        Statistic::StickDurationMean => "mean stick duration",
        Statistic::StickDurationSd => "sd of stick durations",
        Statistic::StickDurationMedian => "median stick duration",
        Statistic::FirstStickDurationMean => "mean first stick",
        Statistic::SticksPerPath => "sticks per path",
        Statistic::SlipsPerPath => "slips per path",
        Statistic::SubPhasesMean => "mean number of sub-phases",
        Statistic::SubPhasesMultipleShare => "share of slips with sub-phases",
        Statistic::StickingFraction => "share of time spent static",
        Statistic::DisplacementEndMean => "mean final displacement",
        Statistic::DisplacementEndSd => "sd of final displacement",
        Statistic::DriftVelocity => "drift velocity",
        Statistic::DiffusionCoefficient => "diffusion coefficient",
        Statistic::PeriodDisplacementMean => "mean displacement per period",
        Statistic::PeriodDisplacementSd => "sd of displacement per period",
        Statistic::PeriodDisplacementCorrelation => "correlation of successive periods",
        Statistic::PhaseDisplacementSd => "sd of displacement at one phase",
        Statistic::JumpMean => "mean jump",
        Statistic::JumpAbsMean => "mean size of a jump",
        Statistic::FrictionWorkMean => "mean friction work",
        Statistic::SlidingPathRate => "sliding path per time",
    }
}

/// A whole number in groups of three that stay together.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join("\u{a0}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped() {
        assert_eq!([7, 1234, 1_234_567].map(grouped), ["7", "1\u{a0}234", "1\u{a0}234\u{a0}567"]);
    }
}
