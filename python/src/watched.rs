//! Does work on another thread, while the thread that Python called from handles Ctrl-C and reports
//! how far the work has come.

use crate::errors;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};
use stickslip::engine::Progress;
use stickslip::ensemble::{Flaw, guarded};

/// The longest time until a signal is handled. The engine then gives the blocks in work another
/// 0.15 s.
const TICK: Duration = Duration::from_millis(20);

/// The progress is reported at every so many of these times.
const REPORTED_EVERY: u64 = 5;

/// A function of Python that is called with the numbers of paths done and expected, and with what
/// is being done. The numbers are 0 where no paths are counted.
pub type Callback = Option<Py<PyAny>>;

/// How far the work has come, and whether it is to stop.
#[derive(Debug, Default)]
pub struct Watch {
    /// Raised by Ctrl-C, and by a callback that raises an exception.
    pub stop: AtomicBool,
    reached: Mutex<Reached>,
}

/// The numbers of paths done and expected, and what is being done.
type Reached = (u64, u64, String);

impl Watch {
    /// Something begins.
    pub fn begins(&self, what: &str) {
        self.change(|reached| reached.2 = what.to_string());
    }

    /// The progress of a simulation of so many paths, which begins.
    pub fn paths(&self, expected: u64) -> WatchedProgress<'_> {
        self.change(|reached| *reached = (0, expected, "simulating".to_string()));
        WatchedProgress(self)
    }

    fn change(&self, change: impl FnOnce(&mut Reached)) {
        change(&mut self.reached.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn reached(&self) -> Reached {
        self.reached
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

/// Passes the progress of the engine on to the watch, so that no thread of the engine waits for
/// Python.
#[derive(Debug)]
pub struct WatchedProgress<'a>(&'a Watch);

impl Progress for WatchedProgress<'_> {
    fn paths(&mut self, done: u64, expected: u64) {
        self.0
            .change(|reached| (reached.0, reached.1) = (done, expected));
    }

    fn estimating_bias(&mut self) {
        self.0.begins("estimating the bias of the step");
    }
}

/// How the work ended, and the exception that Ctrl-C or a callback raised meanwhile.
type Ended<T> = (Result<Result<T, Flaw>, RecvTimeoutError>, Option<PyErr>);

/// Waits for the work, with the interpreter lock released, but not longer than `patience` after an
/// exception. Ctrl-C raises the flag of the watch, and so does an exception in `progress`.
fn attend<T>(
    receiver: &Receiver<Result<T, Flaw>>,
    watch: &Watch,
    progress: &Callback,
    patience: Duration,
) -> Ended<T> {
    let mut failure: Option<(PyErr, Instant)> = None;
    let (mut tick, mut reported) = (0_u64, Reached::default());
    loop {
        tick += 1;
        let received = receiver.recv_timeout(TICK);
        let is_left = matches!(&failure, Some((_, since)) if since.elapsed() > patience);
        let is_over = is_left || !matches!(received, Err(RecvTimeoutError::Timeout));
        let reached = watch.reached();
        // A clock moves even where nothing else does.
        let is_due = match is_over {
            true => reached != reported,
            false => tick.is_multiple_of(REPORTED_EVERY),
        };
        let heard = Python::attach(|py| {
            py.check_signals()?;
            match progress {
                Some(progress) if is_due => {
                    reported = reached;
                    progress.call1(py, reported.clone()).map(drop)
                }
                _ => Ok(()),
            }
        });
        if let Err(error) = heard {
            watch.stop.store(true, Ordering::Relaxed);
            failure.get_or_insert((error, Instant::now()));
        }
        if is_over {
            return (received, failure.map(|(error, _)| error));
        }
    }
}

/// The result of the work, and whether Ctrl-C interrupted it.
fn settled<T>(py: Python<'_>, (result, failure): Ended<T>) -> PyResult<(T, bool)> {
    let is_interrupt = |error: &PyErr| error.is_instance_of::<PyKeyboardInterrupt>(py);
    match (result, failure) {
        (_, Some(error)) if !is_interrupt(&error) => Err(error),
        (Ok(Ok(result)), failure) => Ok((result, failure.is_some())),
        (Ok(Err(flaw)), _) => Err(errors::of_flaw(py, &flaw)),
        (Err(RecvTimeoutError::Timeout), Some(error)) => Err(error),
        (Err(_), _) => Err(errors::of_run(
            py,
            "internal error: the computation ended without a result",
            Flaw::REMEDY,
        )),
    }
}

/// Does some work with the interpreter lock released, and calls `progress` a few times a second.
/// Ctrl-C raises the flag of the watch, and so does an exception in `progress`. Returns the result
/// of the work, and whether Ctrl-C interrupted it.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: &Callback,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<(T, bool)> {
    let watch = Watch::default();
    let ended = py.detach(|| {
        thread::scope(|scope| {
            let (sender, receiver) = channel();
            let watch = &watch;
            scope.spawn(move || sender.send(guarded(|| work(watch))));
            attend(&receiver, watch, progress, Duration::MAX)
        })
    });
    settled(py, ended)
}

/// Does the same with work that looks at the flag of the watch only now and then, or never. After
/// Ctrl-C it is a `KeyboardInterrupt` at once; the thread ends when it looks at the flag.
pub fn abandoned_on_interrupt<T: Send + 'static>(
    py: Python<'_>,
    progress: &Callback,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let ended = py.detach(|| {
        let (sender, receiver) = channel();
        let of_work = Arc::clone(&watch);
        // The receiver of abandoned work is gone.
        thread::spawn(move || sender.send(guarded(|| work(&of_work))).unwrap_or_default());
        attend(&receiver, &watch, progress, Duration::ZERO)
    });
    match ended {
        (_, Some(error)) => Err(error),
        ended => settled(py, ended).map(|(result, _)| result),
    }
}
