//! The one clock of a measurement: CPU time.
//!
//! Effort is planned in CPU seconds, so shares of it must end in CPU seconds too. On a machine that
//! is busy with other work, wall-clock deadlines would cut off what comes last, whatever the plan
//! said.

use rustix::time::{ClockId, clock_gettime};
use std::time::{Duration, Instant};

/// A measurement ends after so many times its budget of wall-clock time, however little the machine
/// let it compute.
const MOST_WALL_TIME: u32 = 4;

/// CPU seconds that this thread has computed.
pub(in crate::study) fn thread_seconds() -> f64 {
    seconds(ClockId::ThreadCPUTime)
}

fn seconds(clock: ClockId) -> f64 {
    let now = clock_gettime(clock);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Tells the time since a measurement began.
#[derive(Clone, Copy, Debug)]
pub(in crate::study) struct Stopwatch {
    threads: usize,
    cpu: f64,
    wall: Instant,
}

impl Stopwatch {
    /// A measurement begins that computes on so many threads.
    pub fn start(threads: usize) -> Self {
        Stopwatch { threads: threads.max(1), cpu: seconds(ClockId::ProcessCPUTime), wall: Instant::now() }
    }

    /// CPU seconds that the process has spent since, all threads together.
    pub fn spent(&self) -> f64 {
        seconds(ClockId::ProcessCPUTime) - self.cpu
    }

    /// The time that each thread has computed since; a fourth of the wall-clock time at least, so
    /// that it always passes.
    pub fn elapsed(&self) -> Duration {
        let computed = Duration::from_secs_f64(self.spent().max(0.0) / self.threads as f64);
        computed.max(self.wall.elapsed() / MOST_WALL_TIME)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sleeping is not computing: half a second of it counts for a fourth; and a loop counts for no
    /// more than its CPU time. No limit from above on the wall-clock time, which the machine
    /// decides.
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
