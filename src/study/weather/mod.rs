//! From a measured temperature to a model of it: a mean, harmonics, and one or two
//! Ornstein-Uhlenbeck processes.
//!
//! ```text
//! T(t_k) = a_0 + sum_i (b_i cos w_i t_k + c_i sin w_i t_k) + u_1(t_k) + u_2(t_k) + e_k
//! du_j = -theta_j u_j dt + sd_j sqrt(2 theta_j) dW_j,    e_k ~ N(0, r)
//! ```
//!
//! The periods of the harmonics are given, such as a year and a day. Amplitudes, rates and
//! variances are those of largest restricted likelihood. It is exact for samples at any times: a
//! Kalman filter gives the innovations (`kalman.rs`), a regression the amplitudes, and the best
//! scale of all variances follows; so two, three or four numbers are left to be searched
//! (`simplex.rs`). e is what the thermometer adds by itself, for example because it shows whole
//! tenths; it is left out of the weather that is simulated, and out of the model unless the data
//! ask for it.
//!
//! A temperature with one memory is rougher than weather from one sample to the next, or smoother
//! from day to day. So one process makes too many slips or too few, and two are the default.

mod fit;
mod kalman;
mod simplex;

/// A year and a day, in seconds: the periods that a temperature outdoors has.
pub const PERIODS: [f64; 2] = [365.25 * 86_400.0, 86_400.0];

pub use fit::{Cycle, Process, WeatherError, WeatherFit, fit};
