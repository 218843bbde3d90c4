//! Does work on another thread, while the thread that Python called from handles Ctrl-C and reports
//! how far the work has come.

use crate::errors;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;
use stickslip::engine::Progress;
use stickslip::ensemble::{Flaw, guarded};

/// The longest time until a signal is handled. The engine then gives the blocks in work another
/// 0.15 s.
const TICK: Duration = Duration::from_millis(20);

/// The progress is reported at every so many of these times.
const TOLD_EVERY: u64 = 5;

/// How far the work has come, and whether it is to stop.
#[derive(Debug, Default)]
pub struct Watch {
    /// Raised by Ctrl-C, and by a callback that raises an exception.
    pub stop: AtomicBool,
    done: AtomicU64,
    expected: AtomicU64,
}

/// Passes the progress of the engine on to the watch, so that no thread of the engine waits for
/// Python.
#[derive(Debug)]
pub struct WatchedProgress<'a>(pub &'a Watch);

impl Progress for WatchedProgress<'_> {
    fn paths(&mut self, done: u64, expected: u64) {
        self.0.done.store(done, Ordering::Relaxed);
        self.0.expected.store(expected, Ordering::Relaxed);
    }
}

/// Does some work with the interpreter lock released. Ctrl-C raises the flag of the watch, and so
/// does an exception in `progress`, a callable that is called with the numbers of paths done and
/// expected. Returns the result of the work, and whether Ctrl-C interrupted it.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<(T, bool)> {
    let watch = Watch::default();
    let failure: Mutex<Option<PyErr>> = Mutex::new(None);
    let result = py.detach(|| {
        thread::scope(|scope| {
            let (sender, receiver) = channel();
            let watch = &watch;
            scope.spawn(move || sender.send(guarded(|| work(watch))));
            let (mut tick, mut reported) = (0_u64, 0);
            loop {
                tick += 1;
                let received = receiver.recv_timeout(TICK);
                let is_over = !matches!(received, Err(RecvTimeoutError::Timeout));
                let [done, expected] =
                    [&watch.done, &watch.expected].map(|number| number.load(Ordering::Relaxed));
                let is_due = done != reported && (is_over || tick.is_multiple_of(TOLD_EVERY));
                let heard = Python::attach(|py| {
                    py.check_signals()?;
                    match progress {
                        Some(progress) if is_due => progress.call1(py, (done, expected)).map(drop),
                        _ => Ok(()),
                    }
                });
                reported = if is_due { done } else { reported };
                if let (Err(error), Ok(mut failure)) = (heard, failure.lock()) {
                    watch.stop.store(true, Ordering::Relaxed);
                    failure.get_or_insert(error);
                }
                if is_over {
                    return received;
                }
            }
        })
    });
    let failure = failure.into_inner().unwrap_or_default();
    let is_interrupt = |error: &PyErr| error.is_instance_of::<PyKeyboardInterrupt>(py);
    match (result, failure) {
        (_, Some(error)) if !is_interrupt(&error) => Err(error),
        (Ok(Ok(result)), failure) => Ok((result, failure.is_some())),
        (Ok(Err(flaw)), _) => Err(errors::of_flaw(py, &flaw)),
        (Err(_), _) => Err(errors::of_run(
            py,
            "internal error: the computation ended without a result",
            Flaw::REMEDY,
        )),
    }
}
