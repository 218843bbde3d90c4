//! What Ctrl-C does: the first one asks to end, the second one ends.

use super::failure::note;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that the first Ctrl-C raises; the second one ends the process. Called once in a process.
pub fn stop_on_ctrl_c() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&stop);
    // Without a handler Ctrl-C still stops the process, only less gently.
    let _ = ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        note("\nstopping after what is in flight; press Ctrl-C again to stop at once");
    });
    stop
}
