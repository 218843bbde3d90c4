//! Other processes that simulate for this one, if the program was started with any.

use std::sync::OnceLock;
use stick_slip::engine::Crew;

/// The processes that share the work of a run.
pub trait Ranks: Sync {
    /// The processes that simulate, if there are several.
    fn crew(&self) -> Option<&dyn Crew>;

    /// How many of the threads that this process may use it should use.
    fn threads(&self, usable: usize) -> usize;
}

static RANKS: OnceLock<&'static dyn Ranks> = OnceLock::new();

/// From here on, these processes share the work.
pub fn share_with(ranks: &'static dyn Ranks) {
    RANKS.get_or_init(|| ranks);
}

/// The processes that simulate, if there are several.
pub fn crew() -> Option<&'static dyn Crew> {
    RANKS.get()?.crew()
}

/// How many of the threads that this process may use it should use.
pub fn threads(usable: usize) -> usize {
    RANKS.get().map_or(usable, |ranks| ranks.threads(usable))
}
