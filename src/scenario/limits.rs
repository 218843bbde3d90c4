//! How much of anything a scenario may ask for.

/// Most paths.
pub const MAX_PATHS: u64 = 1 << 40;

/// Most paths kept on the output grid.
pub const MAX_TRAJECTORIES: u64 = 1_000_000;

/// Most rows of the output grid: bands hold every path's value at every row of a block. Ten minutes
/// for a year make 52 561.
pub const MAX_ROWS: usize = 100_000;

/// Most steps of a path: beyond 2^53, t_n = n h is no longer distinct for every n.
pub const MAX_STEPS: f64 = 9_007_199_254_740_992.0;

/// Most forcing periods at which x is observed; the drift statistics need few, and memory grows
/// with them.
pub const MAX_PERIODS: usize = 10_000;
