//! A run or a sweep while it is simulated: progress, signals, saving, its end.

pub(crate) mod cost;
pub(crate) mod ending;
pub(crate) mod heap;
pub(crate) mod interrupt;
pub(crate) mod progress;
pub(crate) mod run;
pub(crate) mod sweep;
