//! Why a run has no estimate of its bias.

/// The smallest number of steps of a path. The ends of the three simulations are rounded to a
/// multiple of 4h.
pub(super) const MIN_STEPS: f64 = 16.0;

/// Why there is no estimate of the bias.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoBias {
    /// The event-driven scheme under noise: it has a tolerance instead of a step.
    #[error(
        "this scheme has no time step; its tolerance keeps the relative discretisation error of every \
         statistic that has a limit below {0}"
    )]
    Tolerance(f64),
    /// The event-driven scheme without randomness.
    #[error("this scheme has no step, and without noise every event is exact to rounding")]
    Exact,
    /// The event-driven scheme under a user-defined force, without randomness.
    #[error(
        "this scheme has no step, and without noise a user-defined force is integrated to 1e-13 per step"
    )]
    Integrated,
    /// The event-driven scheme under noise and a user-defined force.
    #[error(
        "this scheme has no step, and integrates a user-defined force to its tolerance {0}; compare with a \
         run at a tenth of it"
    )]
    Followed(f64),
    /// The quasi-static scheme: its error is that of an approximation, which does not depend on a
    /// step.
    #[error(
        "this scheme takes the forcing as constant during a slip, and a smaller step does not reduce that error"
    )]
    Approximation,
    /// The corrected scheme without randomness, or if a reference run costs too much or does not
    /// resolve all slips. The error of this scheme cannot be extrapolated, because it may be equal
    /// at the compared steps.
    #[error(
        "the error of corrected-vi cannot be extrapolated from h, 2h and 4h, and an event-driven reference \
         run would take too long compared with this run; a trade measures it"
    )]
    Corrected,
    /// f_s = f_d under noise: statistics of sticks have no limit as h falls.
    #[error("with f_s = f_d under noise, stick statistics have no limit as the step falls")]
    EqualFriction,
    /// The run has too few paths.
    #[error("at least {needed} paths are needed")]
    FewPaths {
        /// The number of paths that are needed.
        needed: u64,
    },
    /// A path has too few steps.
    #[error("at least {MIN_STEPS} steps are needed")]
    FewSteps,
    /// Paths diverged at h, 2h or 4h.
    #[error("{paths} of the paths simulated at h, 2h and 4h to estimate it diverged")]
    Diverged {
        /// Number of paths that diverged, at all three steps together.
        paths: usize,
    },
    /// No bias is known as well as the estimate.
    #[error(
        "the bias is less certain than the estimates themselves; run more paths to estimate it"
    )]
    Uncertain,
    /// The simulation was stopped by the caller.
    #[error("the run was stopped first")]
    Stopped,
}
