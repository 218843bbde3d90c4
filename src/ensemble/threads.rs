//! How many threads may share the work.

use std::sync::{PoisonError, RwLock};
use std::thread;

/// The most threads that share the work of a run. More would only wait for each other, and each of
/// them needs memory.
pub const MOST_THREADS: usize = 1024;

/// Why this number of threads cannot share the work.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ThreadsError {
    /// There are none, or more than [`MOST_THREADS`].
    #[error("threads = {0} must be between 1 and {MOST_THREADS}")]
    OutOfRange(usize),
    /// The system does not start this number of threads.
    #[error("the system started only {started} of {asked} threads: {cause}")]
    NotStarted {
        /// How many were asked for.
        asked: usize,
        /// How many it started.
        started: usize,
        /// What it says of the next one.
        cause: String,
    },
}

impl ThreadsError {
    /// What the user can do about it.
    pub const REMEDY: &'static str = "use fewer threads; the results do not depend on their number";
}

/// Check that this number of threads can share the work. The system is asked by starting them, because
/// limits of the user, of the container and of the memory may all be in the way.
///
/// ```
/// use stickslip::ensemble::{ThreadsError, check_threads};
///
/// assert_eq!(check_threads(2), Ok(()));
/// assert_eq!(check_threads(1 << 40), Err(ThreadsError::OutOfRange(1 << 40)));
/// ```
pub fn check_threads(threads: usize) -> Result<(), ThreadsError> {
    match threads {
        // The thread of the caller does the work.
        1 => Ok(()),
        2..=MOST_THREADS => start(threads),
        _ => Err(ThreadsError::OutOfRange(threads)),
    }
}

fn start(threads: usize) -> Result<(), ThreadsError> {
    let gate = RwLock::new(());
    thread::scope(|scope| {
        // No thread ends before the last one has started.
        let _closed = gate.write().unwrap_or_else(PoisonError::into_inner);
        (0..threads).try_for_each(|started| {
            let wait = || drop(gate.read());
            let begun = thread::Builder::new().spawn_scoped(scope, wait);
            begun.map(drop).map_err(|error| ThreadsError::NotStarted {
                asked: threads,
                started,
                cause: error.to_string(),
            })
        })
    })
}
