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
//! (Paper, section 3.1.) With f_d = f_s the last line is [`crate::model::prox`] at S_n, the
//! solution of the discrete variational inequality. The noise moves from t_n to t_{n+1} by the
//! exact Ornstein-Uhlenbeck transition.
//!
//! ```text
//! plain, corrected   the two schemes that take this step, and their properties
//! simulation         either of them on one model: many paths in lanes, observed on a timeline
//!   kernel             the step itself, the hot loop
//!   reading            finds the phases from the velocities; rare, so it is scalar
//! limits             which steps can be computed with doubles
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
