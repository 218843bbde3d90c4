//! The paper's discrete variational inequality: one explicit step for all phases.
//!
//! ```text
//! X_0 = x0, V_0 = 0, t_n = n h
//! X_{n+1} = X_n + h V_n
//! S_n     = V_n + (h/m) b(X_n, V_n, t_n)
//! V_{n+1} = 0                               if |S_n| <= (h/m) f_s
//!         = S_n - (h/m) f_d sign(S_n)       otherwise
//! ```
//!
//! (paper, section 3.1.) With f_d = f_s the last line is [`crate::model::prox`] at S_n, the
//! solution of the discrete variational inequality. The noise between t_n and t_{n+1} is the exact
//! Ornstein-Uhlenbeck transition.
//!
//! ```text
//! plain, corrected   the two schemes that step so, and what each is known for
//! simulation         either of them on one model: paths side by side, looked at on a timeline
//!   kernel             the step itself, the hot loop
//!   reading            what turns a velocity into phases: rare, and scalar
//! limits             what a step can be computed with
//! ```

mod corrected;
mod kernel;
mod limits;
mod plain;
mod reading;
mod simulation;

pub use corrected::{CorrectedVi, corrected_exit, monitoring_shift};
pub use plain::DiscreteVi;
pub use simulation::{DiscreteSimulation, divergence_bound};
