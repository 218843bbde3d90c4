//! Conditions for statistics to exist.

/// A condition for a statistic to exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Need {
    /// A completed stick, the first one apart.
    Stick,
    TwoSticks,
    FirstStick,
    Slip,
    TwoSlips,
    /// A slip that began after another.
    Recurrence,
    TwoRecurrences,
    /// A whole period P.
    Period,
    TwoPeriods,
    EndOfPeriod,
    TwoPaths,
    TwoDisplacements,
    DifferentDisplacements,
    /// A time that is counted.
    Duration,
}

impl Need {
    /// The message if the condition is not met.
    pub fn words(self) -> &'static str {
        match self {
            Need::Stick => "no stick after the first ended",
            Need::TwoSticks => "needs two completed sticks",
            Need::FirstStick => "no first stick ended",
            Need::Slip => "no slip was completed",
            Need::TwoSlips => "needs two completed slips",
            Need::Recurrence => "no path has two slips",
            Need::TwoRecurrences => "needs two times from slip to slip",
            Need::Period => "needs the ends of two periods",
            Need::TwoPeriods => "needs the ends of three periods",
            Need::EndOfPeriod => "needs the end of a period",
            Need::TwoPaths => "needs two paths",
            Need::TwoDisplacements => "needs two displacements",
            Need::DifferentDisplacements => "needs displacements that differ",
            Need::Duration => "the run has no duration",
        }
    }
}
