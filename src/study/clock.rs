//! The clock by which measurements are planned and ended: CPU time.
//!
//! Costs are planned in CPU seconds, so shares of it must end in CPU seconds too. With deadlines in
//! wall-clock time, a busy machine would cut off whatever is measured last.

use rustix::time::{ClockId, clock_gettime};
use std::time::{Duration, Instant};

/// A measurement ends at the latest after this many times its budget of wall-clock time, even if it
/// received little CPU time.
const MOST_WALL_TIME: u32 = 4;

/// CPU seconds that this thread has used.
pub(in crate::study) fn thread_seconds() -> f64 {
    seconds(ClockId::ThreadCPUTime)
}

fn seconds(clock: ClockId) -> f64 {
    let now = clock_gettime(clock);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Measures the time since a measurement began.
#[derive(Clone, Copy, Debug)]
pub(in crate::study) struct Stopwatch {
    threads: usize,
    cpu: f64,
    wall: Instant,
}

impl Stopwatch {
    /// Start the clock for a measurement that uses this number of threads.
    pub fn start(threads: usize) -> Self {
        Stopwatch {
            threads: threads.max(1),
            cpu: seconds(ClockId::ProcessCPUTime),
            wall: Instant::now(),
        }
    }

    /// CPU seconds that the process has used since the start, over all threads.
    pub fn spent(&self) -> f64 {
        seconds(ClockId::ProcessCPUTime) - self.cpu
    }

    /// CPU time per thread since the start, but at least a fourth of the wall-clock time, so that
    /// it always advances.
    pub fn elapsed(&self) -> Duration {
        let computed = Duration::from_secs_f64(self.spent().max(0.0) / self.threads as f64);
        computed.max(self.wall.elapsed() / MOST_WALL_TIME)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// While the process sleeps, a fourth of the wall-clock time counts; while it computes, at
    /// least its CPU time counts. Wall-clock time has no upper limit in this test, because it
    /// depends on the load of the machine.
    #[test]
    fn a_pause_counts_for_little_and_computing_for_what_it_took() {
        let watch = Stopwatch::start(1);
        std::thread::sleep(Duration::from_millis(400));
        let (asleep, wall) = (watch.elapsed(), watch.wall.elapsed());
        assert!(asleep >= Duration::from_millis(100), "{asleep:?}");
        let (before, spent) = (thread_seconds(), watch.spent());
        let mut x = 1.0_f64;
        while thread_seconds() - before < 0.05 {
            x = std::hint::black_box(x.sin());
        }
        assert!(watch.spent() - spent >= 0.05);
        assert!(watch.wall.elapsed() >= wall && watch.elapsed() >= asleep);
    }
}
