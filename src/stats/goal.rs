//! A bound on the standard error of a statistic, and whether an estimate meets it.

use super::{Estimate, Statistic};
use std::fmt;
use std::str::FromStr;

/// A bound on the standard error of one statistic, written `NAME < 0.5%` or `NAME < 0.01`.
///
/// ```
/// use stickslip::engine::{EndedBy, Run};
/// use stickslip::scenario::Scenario;
///
/// let mut scenario = Scenario::shipped("rho025")?;
/// scenario.ensemble.paths = 1 << 20;
/// let goals = vec!["stick_duration_mean < 1%".parse()?];
/// let outcome = Run::of(&scenario).without_bias().until(goals).simulate()?;
/// assert!(matches!(outcome.ended_by, Some(EndedBy::Goals { .. })));
/// assert!(outcome.summary.completed_paths < 5_000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The statistic that is bounded.
    pub statistic: Statistic,
    /// The bound that its standard error must be below.
    pub bound: Bound,
}

/// An upper bound of a standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Relative to the estimate.
    Relative(f64),
    /// This number, in the unit of the statistic.
    Absolute(f64),
}

/// The state of an estimate with respect to a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The standard error is below the bound. It is zero if all paths agree, and then every goal is
    /// reached.
    Reached,
    /// The standard error is not yet below the bound. Since it falls like 1/sqrt(paths), the number
    /// of paths must grow by about this factor.
    Ahead(f64),
    /// The estimate is within two of its standard errors of zero, so a relative bound is not
    /// sensible.
    Zero,
    /// The statistic does not exist, or has no standard error.
    Missing,
}

/// An estimate within this many standard errors of zero may be zero.
const ZERO: f64 = 2.0;

impl Goal {
    /// Whether an estimate has reached the goal.
    pub fn judge(&self, estimate: &Estimate) -> Verdict {
        let Estimate {
            estimate,
            standard_error,
            ..
        } = *estimate;
        if !estimate.is_finite() || !standard_error.is_finite() {
            return Verdict::Missing;
        }
        if standard_error == 0.0 {
            return Verdict::Reached;
        }
        let bound = match self.bound {
            Bound::Absolute(bound) => bound,
            Bound::Relative(share) => share * estimate.abs(),
        };
        if standard_error < bound {
            Verdict::Reached
        } else if matches!(self.bound, Bound::Relative(_)) && estimate.abs() < ZERO * standard_error
        {
            Verdict::Zero
        } else {
            Verdict::Ahead((standard_error / bound).powi(2))
        }
    }
}

/// Why a text is not a goal.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GoalError {
    /// The text has no `<`.
    #[error("missing '<'")]
    NoComparison,
    /// The word before the `<` names no statistic.
    #[error("unknown statistic \"{0}\"")]
    UnknownStatistic(String),
    /// The text after the `<` is not a number above zero.
    #[error("\"{0}\" is not a number above zero, such as 0.5% or 0.01")]
    NoBound(String),
}

impl FromStr for Goal {
    type Err = GoalError;

    fn from_str(text: &str) -> Result<Self, GoalError> {
        let (name, bound) = text.split_once('<').ok_or(GoalError::NoComparison)?;
        let name = name.trim();
        let statistic = Statistic::from_name(name)
            .ok_or_else(|| GoalError::UnknownStatistic(name.to_string()))?;
        let bound = bound.trim();
        let number = |text: &str| {
            text.trim()
                .parse::<f64>()
                .ok()
                .filter(|x| x.is_finite() && *x > 0.0)
        };
        let parsed = match bound.strip_suffix('%') {
            Some(percent) => number(percent).map(|percent| Bound::Relative(percent / 100.0)),
            None => number(bound).map(Bound::Absolute),
        };
        Ok(Goal {
            statistic,
            bound: parsed.ok_or_else(|| GoalError::NoBound(bound.to_string()))?,
        })
    }
}

impl fmt::Display for Goal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.bound {
            // The number is rounded to twelve digits, so that 0.7% does not come back as
            // 0.7000000000000001%.
            Bound::Relative(share) => write!(
                f,
                "{} < {}%",
                self.statistic.name(),
                (share * 1e14).round() / 1e12
            ),
            Bound::Absolute(bound) => write!(f, "{} < {bound:?}", self.statistic.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(estimate: f64, standard_error: f64) -> Estimate {
        let statistic = Statistic::StickDurationMean;
        Estimate {
            statistic,
            estimate,
            standard_error,
            low: f64::NAN,
            high: f64::NAN,
            bias: None,
        }
    }

    #[test]
    fn goals_are_read_as_they_are_written() {
        let goal: Goal = " stick_duration_mean <0.5 % ".parse().unwrap();
        assert_eq!(
            goal,
            Goal {
                statistic: Statistic::StickDurationMean,
                bound: Bound::Relative(0.005)
            }
        );
        assert_eq!(goal.to_string(), "stick_duration_mean < 0.5%");
        let goal: Goal = "drift_velocity<1e-3".parse().unwrap();
        assert_eq!(
            goal,
            Goal {
                statistic: Statistic::DriftVelocity,
                bound: Bound::Absolute(0.001)
            }
        );
        for (text, error) in [
            ("60", GoalError::NoComparison),
            ("stick < 1%", GoalError::UnknownStatistic("stick".into())),
            ("jump_mean < 0%", GoalError::NoBound("0%".into())),
            ("jump_mean < nan", GoalError::NoBound("nan".into())),
            ("jump_mean < ", GoalError::NoBound("".into())),
        ] {
            assert_eq!(text.parse::<Goal>(), Err(error), "{text}");
        }
    }

    #[test]
    fn a_goal_twice_as_tight_needs_four_times_the_paths() {
        let goal: Goal = "stick_duration_mean < 1%".parse().unwrap();
        assert_eq!(goal.judge(&estimate(-5.0, 0.049)), Verdict::Reached);
        assert_eq!(goal.judge(&estimate(-5.0, 0.1)), Verdict::Ahead(4.0));
        let goal: Goal = "stick_duration_mean < 0.05".parse().unwrap();
        assert_eq!(goal.judge(&estimate(1e-9, 0.1)), Verdict::Ahead(4.0));
    }

    #[test]
    fn a_share_of_zero_is_no_goal_and_no_spread_reaches_any() {
        let goal: Goal = "stick_duration_mean < 1%".parse().unwrap();
        assert_eq!(goal.judge(&estimate(0.1, 0.06)), Verdict::Zero);
        assert_eq!(goal.judge(&estimate(0.0, 0.0)), Verdict::Reached);
        assert_eq!(goal.judge(&estimate(f64::NAN, f64::NAN)), Verdict::Missing);
        assert_eq!(goal.judge(&estimate(3.0, f64::NAN)), Verdict::Missing);
    }
}
