//! A model of a measured temperature: a mean, harmonics, and one or two Ornstein-Uhlenbeck
//! processes.
//!
//! ```text
//! T(t_k) = a_0 + sum_i (b_i cos w_i t_k + c_i sin w_i t_k) + u_1(t_k) + u_2(t_k) + e_k
//! du_j = -theta_j u_j dt + sd_j sqrt(2 theta_j) dW_j,    e_k ~ N(0, r)
//! ```
//!
//! If the likelihood requires it, the sum of the processes is smoothed before it is observed, as
//! steel smooths the air temperature: ds/dt = (u_1 + u_2 - s)/tau replaces u_1 + u_2. A sample may
//! also be a mean over the time between samples. All of these are linear, so the likelihood stays
//! exact (`system.rs`).
//!
//! The periods of the harmonics are given, such as a year and a day. Amplitudes, rates and
//! variances maximise the restricted likelihood, which is exact for samples at any times. A Kalman
//! filter gives the innovations (`kalman.rs`), a regression gives the amplitudes and the best scale
//! of all variances, and one to five parameters remain to be searched (`search.rs`, `simplex.rs`).
//! The white noise e is due to the thermometer, for example because it shows whole tenths. It is
//! not part of the simulated weather.
//!
//! With one process, the temperature varies either more than real weather from one sample to the
//! next, or less from day to day. One process therefore gives too many slips or too few, and two
//! are the default.

mod fit;
mod hidden;
mod kalman;
mod periods;
mod result;
mod search;
mod simplex;
mod smoother;
mod system;

/// A year and a day, in seconds: the periods of an outdoor temperature.
pub const PERIODS: [f64; 2] = [365.25 * 86_400.0, 86_400.0];

pub use fit::{WeatherError, fit};
pub(super) use hidden::HiddenTemperature;
pub use periods::{HarmonicError, usual};
pub use result::{Cycle, Process, Weather, WeatherFit};
pub(super) use system::{Passage, Square, States, System, dot, root, times};
