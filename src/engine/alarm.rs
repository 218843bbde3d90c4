//! Sets flags when a run is to end, because the caller stops it or its time is up. Unfinished
//! blocks then get a short time to be completed.

use crate::ensemble::Stops;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// `CHECK_INTERVAL` is the time between two checks of the clock and the caller's flag. `GRACE` is the time
/// that unfinished blocks may still take when the run is to end.
const CHECK_INTERVAL: Duration = Duration::from_millis(50);
const GRACE: Duration = Duration::from_millis(150);

/// The flags, and the conditions for setting them.
#[derive(Debug)]
pub(super) struct Alarm<'a> {
    /// Set by the caller.
    stop: &'a AtomicBool,
    /// The time limits for the paths and for the whole run.
    limits: [Option<Instant>; 2],
    /// Set when unfinished blocks are to be given up.
    pub halt: AtomicBool,
    /// Set when the run is to end, whether it simulates paths or estimates the bias.
    pub end: AtomicBool,
    is_over: Mutex<bool>,
    over: Condvar,
}

impl<'a> Alarm<'a> {
    /// For a run that ends if `stop` is set. `left` is the remaining time for its paths, and for
    /// the whole run; `None` means no limit.
    pub fn new(stop: &'a AtomicBool, left: [Option<Duration>; 2]) -> Self {
        let limits = left.map(|left| left.and_then(|left| Instant::now().checked_add(left)));
        let [halt, end] = [(); 2].map(|()| AtomicBool::new(false));
        Alarm {
            stop,
            limits,
            halt,
            end,
            is_over: Mutex::new(false),
            over: Condvar::new(),
        }
    }

    /// Do some work while a thread watches the flag and the clock.
    pub fn watching<R>(&self, work: impl FnOnce() -> R) -> R {
        std::thread::scope(|scope| {
            let watch = std::thread::Builder::new().spawn_scoped(scope, || self.watch());
            // If no thread can be created, nothing is given up, and the run ends only at the end of
            // a block.
            let _ = watch;
            let _over = AlarmOver(self);
            work()
        })
    }

    /// The flags that the simulation of blocks checks.
    pub fn stops(&self) -> Stops<'_> {
        Stops {
            stop: self.stop,
            halt: &self.halt,
        }
    }

    fn watch(&self) {
        let mut is_over = self.is_over.lock().unwrap_or_else(PoisonError::into_inner);
        let mut rung: Option<Instant> = None;
        while !*is_over {
            let is_past =
                |limit: Option<Instant>| limit.is_some_and(|limit| Instant::now() >= limit);
            let is_stopped = self.stop.load(Ordering::Relaxed);
            if is_stopped || is_past(self.limits[0]) {
                let since = *rung.get_or_insert_with(Instant::now);
                self.halt
                    .fetch_or(since.elapsed() >= GRACE, Ordering::Relaxed);
            }
            self.end
                .fetch_or(is_stopped || is_past(self.limits[1]), Ordering::Relaxed);
            is_over = self
                .over
                .wait_timeout(is_over, CHECK_INTERVAL)
                .unwrap_or_else(PoisonError::into_inner)
                .0;
        }
    }
}

/// Stops the alarm when the work is over, even after a panic.
struct AlarmOver<'a>(&'a Alarm<'a>);

impl Drop for AlarmOver<'_> {
    fn drop(&mut self) {
        *self
            .0
            .is_over
            .lock()
            .unwrap_or_else(PoisonError::into_inner) = true;
        self.0.over.notify_all();
    }
}
