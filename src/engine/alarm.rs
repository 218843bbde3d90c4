//! Rings when a run is to end: somebody wants it to, or its time is up. Blocks in work then have a
//! moment to be finished.

use crate::ensemble::Stops;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often it looks, and how long blocks in work may take once the run is to end.
const LOOK: Duration = Duration::from_millis(50);
const GRACE: Duration = Duration::from_millis(150);

/// Flags that are raised in time.
#[derive(Debug)]
pub(super) struct Alarm<'a> {
    /// Raised by somebody else.
    stop: &'a AtomicBool,
    /// When the time for paths is up, and when all of it is.
    limits: [Option<Instant>; 2],
    /// Raised when blocks in work are to be given up.
    pub halt: AtomicBool,
    /// Raised when the run is to end, whatever it does.
    pub end: AtomicBool,
    is_over: Mutex<bool>,
    over: Condvar,
}

impl<'a> Alarm<'a> {
    /// For a run that somebody may stop, with so much time left for its paths, and in all.
    pub fn new(stop: &'a AtomicBool, left: [Option<Duration>; 2]) -> Self {
        let limits = left.map(|left| left.and_then(|left| Instant::now().checked_add(left)));
        let [halt, end] = [(); 2].map(|()| AtomicBool::new(false));
        Alarm { stop, limits, halt, end, is_over: Mutex::new(false), over: Condvar::new() }
    }

    /// Do something while it watches.
    pub fn watching<R>(&self, work: impl FnOnce() -> R) -> R {
        std::thread::scope(|scope| {
            let watch = std::thread::Builder::new().spawn_scoped(scope, || self.watch());
            // Where there is no thread to be had, the run ends at the end of a block.
            let _ = watch;
            let _over = Over(self);
            work()
        })
    }

    /// The flags as blocks obey them.
    pub fn stops(&self) -> Stops<'_> {
        Stops { stop: self.stop, halt: &self.halt }
    }

    fn watch(&self) {
        let mut is_over = self.is_over.lock().unwrap_or_else(PoisonError::into_inner);
        let mut rung: Option<Instant> = None;
        while !*is_over {
            let is_past = |limit: Option<Instant>| limit.is_some_and(|limit| Instant::now() >= limit);
            let is_stopped = self.stop.load(Ordering::Relaxed);
            if is_stopped || is_past(self.limits[0]) {
                let since = *rung.get_or_insert_with(Instant::now);
                self.halt.fetch_or(since.elapsed() >= GRACE, Ordering::Relaxed);
            }
            self.end.fetch_or(is_stopped || is_past(self.limits[1]), Ordering::Relaxed);
            is_over = self.over.wait_timeout(is_over, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

/// Ends the watch, whatever the work came to.
struct Over<'a>(&'a Alarm<'a>);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        *self.0.is_over.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.over.notify_all();
    }
}
