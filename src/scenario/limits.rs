//! Limits on the size of a scenario.

/// Largest number of paths.
pub const MAX_PATHS: u64 = 1 << 40;

/// Largest number of paths kept on the output grid.
pub const MAX_TRAJECTORIES: u64 = 1_000_000;

/// Largest number of rows of the output grid. The quantile bands keep the value of every path of a
/// block at every row, so memory grows with the rows. One row every ten minutes gives 52 561 in a
/// year.
pub const MAX_ROWS: usize = 100_000;

/// Largest number of steps of a path. Beyond 2^53 the times t_n = n h are no longer distinct for
/// every n.
pub const MAX_STEPS: f64 = 9_007_199_254_740_992.0;

/// Largest phase of the forcing, w t or the phase at t = 0, in radians. A phase is a double, and at
/// this size it is rounded to a thousandth of a radian; at 1e16 it has no digits left.
pub const MAX_PHASE: f64 = 1e13;

/// Largest number of periods at which x is observed. The drift statistics need few, and
/// memory grows with them.
pub const MAX_PERIODS: usize = 10_000;
