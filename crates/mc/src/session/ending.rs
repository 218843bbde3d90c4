//! Messages of a run with a goal: why the goal cannot be reached, or was missed.

use crate::output::numbers::{grouped, significant};
use stickslip::engine::{Hopeless, MOST_PATHS, MissedGoal};
use stickslip::stats::Verdict;

/// The message for a goal that cannot be reached: why, and what to do.
pub fn hopeless(reason: &Hopeless) -> String {
    match reason {
        Hopeless::Zero { estimate, paths } => {
            let name = estimate.statistic.name();
            let (value, error) = (
                significant(estimate.estimate, 3),
                significant(estimate.standard_error, 2),
            );
            format!(
                "{name} is {value} with a standard error of {error} after {} paths: zero within its error, so \
                 a relative bound cannot be reached\n  fix: give an absolute bound, such as --until \"{name} \
                 < {error}\"",
                grouped(*paths)
            )
        }
        Hopeless::Missing { statistic, paths } => format!(
            "{} does not exist after {} paths, so its error cannot be bounded\n  fix: choose another statistic, or a \
             longer time.end",
            statistic.name(),
            grouped(*paths)
        ),
        Hopeless::TooFar {
            goal,
            needed,
            least_error,
        } => format!(
            "{goal} needs about {needed:.1e} paths, but a run has at most {}, which give about {}\n  fix: use \
                a wider bound",
            grouped(MOST_PATHS),
            significant(*least_error, 2)
        ),
    }
}

/// The message for a missed goal, with the number of paths that it would need, if known.
pub fn missed(
    MissedGoal {
        goal,
        paths,
        verdict,
    }: &MissedGoal,
    needed: Option<u64>,
) -> String {
    match (verdict, needed) {
        (Verdict::Zero, _) => {
            format!("{goal} was not reached: the estimate may be zero; give an absolute bound")
        }
        (_, Some(needed)) => format!(
            "{goal} was not reached after {} paths; try --paths {needed}",
            grouped(*paths)
        ),
        (_, None) => format!("{goal} was not reached: the statistic does not exist"),
    }
}
