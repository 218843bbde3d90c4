//! What a signal does that asks a process to end: the first one asks the run to end, the second one
//! ends it.
//!
//! A signal that was ignored when the process began, as `nohup` ignores the one of a terminal that
//! closes, stays ignored.

use super::failure::note;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
use signal_hook::iterator::Signals;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

/// Signals of users and schedulers: Ctrl-C, a terminal that closes, a time limit that comes near.
const ENDING: [i32; 6] = [SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2];

/// The one that came; 0 for none.
static CAME: AtomicI32 = AtomicI32::new(0);

/// What a process exits with that was ended by the signal that came: 130 for Ctrl-C, 143 for
/// SIGTERM.
pub fn exit_code() -> u8 {
    let signal = match CAME.load(Ordering::Relaxed) {
        0 => SIGINT,
        signal => signal,
    };
    128 + u8::try_from(signal).unwrap_or(0)
}

/// A flag that the first of these signals raises; the second one ends the process. Called once in a
/// process.
pub fn stop_on_signals() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    // A file that is too large for its limit is an error of the write, which says what to do.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
    let ignored = ignored();
    let heard = ENDING.into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    // Without a handler a signal still ends the process, only less gently.
    let Ok(mut signals) = Signals::new(heard) else { return stop };
    let raised = Arc::clone(&stop);
    std::thread::spawn(move || {
        for signal in signals.forever() {
            CAME.store(signal, Ordering::Relaxed);
            if raised.swap(true, Ordering::Relaxed) {
                std::process::exit(i32::from(exit_code()));
            }
            note("\nstopping; press Ctrl-C again to stop at once");
        }
    });
    stop
}

/// The signals that this process ignores, signal n at bit n - 1; none where the system does not
/// say.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let bits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    bits.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok()).unwrap_or(0)
}
