//! Handles the signals that ask a process to end: the first one asks the run to stop and save, the
//! second one ends the process.
//!
//! A signal that is ignored when the process begins stays ignored. `nohup`, for instance, starts a
//! process that ignores SIGHUP, the signal of a closing terminal.

use crate::output::failure::{Failure, exit_code, note, signalled};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
use signal_hook::iterator::Signals;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Signals that users and schedulers send: Ctrl-C, the end of the terminal, or a time limit that
/// will soon be reached.
const ENDING: [i32; 6] = [SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2];

/// Makes writing beyond the size limit of files an ordinary error, whose message says what to do.
/// Otherwise a signal would end the process in the middle of a file.
pub fn refuse_large_files() {
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
}

/// A flag that the first of these signals raises. The second signal ends the process. May be called
/// once in a process.
pub fn stop_on_signals() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let ignored = ignored();
    let heard = ENDING
        .into_iter()
        .filter(|signal| ignored >> (signal - 1) & 1 == 0);
    // If the handlers cannot be installed, a signal still ends the process, but the run is not
    // stopped and saved.
    let Ok(mut signals) = Signals::new(heard) else {
        return Ok(stop);
    };
    let raised = Arc::clone(&stop);
    let listening = std::thread::Builder::new().spawn(move || {
        for signal in signals.forever() {
            signalled(signal);
            if raised.swap(true, Ordering::Relaxed) {
                std::process::exit(i32::from(exit_code()));
            }
            note("\nstopping; press Ctrl-C again to stop immediately");
        }
    });
    let remedy = "allow more processes (`ulimit -u`) or more memory (`ulimit -v`)";
    let refused = |error| Failure::run(format!("cannot start a thread: {error}"), remedy);
    listening.map(|_| stop).map_err(refused)
}

/// The signals that this process ignores: signal n is bit n - 1. Zero if the system does not say.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let bits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    bits.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok())
        .unwrap_or(0)
}
