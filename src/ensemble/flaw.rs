//! Panics as errors. A panic is a bug in this program; a run loses at most the block in which it
//! happens.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::fmt;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

/// A panic, and the operation in which it happened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Flaw {
    /// The operation; empty if not known.
    pub doing: String,
    /// The message of the panic.
    pub message: String,
    /// The file and the line of the panic.
    pub place: String,
}

impl Flaw {
    /// What the user can do about it.
    pub const REMEDY: &'static str = "report this error with the scenario and the command";
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Flaw {
            doing,
            message,
            place,
        } = self;
        let doing = if doing.is_empty() {
            String::new()
        } else {
            format!(" {doing}")
        };
        write!(f, "internal error{doing}: {message}, at {place}")
    }
}

thread_local! {
    /// The nesting depth of [`guarded`] in this thread.
    static GUARDS: Cell<usize> = const { Cell::new(0) };
    /// The place of its last panic.
    static PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Does some work. A panic in it becomes an error, and is not printed.
///
/// After a panic, data changed by the work may be inconsistent and must not be used.
pub fn guarded<R>(work: impl FnOnce() -> R) -> Result<R, Flaw> {
    note_places();
    GUARDS.set(GUARDS.get() + 1);
    let done = panic::catch_unwind(AssertUnwindSafe(work));
    GUARDS.set(GUARDS.get() - 1);
    done.map_err(flaw)
}

/// Does some work. A panic in it is passed to the caller as a [`Flaw`] with the operation.
pub(super) fn naming<R>(doing: impl FnOnce() -> String, work: impl FnOnce() -> R) -> R {
    guarded(work).unwrap_or_else(|mut flaw| {
        if flaw.doing.is_empty() {
            flaw.doing = doing();
        }
        panic::resume_unwind(Box::new(flaw))
    })
}

/// The flaw carried by a panic, or made from it.
fn flaw(panic: Box<dyn Any + Send>) -> Flaw {
    let panic = match panic.downcast::<Flaw>() {
        Ok(flaw) => return *flaw,
        Err(panic) => panic,
    };
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    let message = text
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a panic".to_string());
    Flaw {
        doing: String::new(),
        message,
        place: PLACE.take(),
    }
}

/// Only the hook of the process receives the place of a panic. Panics outside of [`guarded`] are
/// passed to the previous hook.
fn note_places() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if GUARDS.get() == 0 {
                return before(info);
            }
            let place = info
                .location()
                .map_or_else(|| "an unknown place".to_string(), ToString::to_string);
            // File names are relative to the folder of the package.
            PLACE.set(place.rsplit("../").next().unwrap_or_default().to_string());
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_that_says_what_was_done_and_where() {
        let nothing: [u8; 0] = [];
        let index = nothing.len() + 3;
        let work = || naming(|| "in paths 0 to 255".to_string(), || nothing[index]);
        let flaw = guarded(|| {
            std::thread::scope(|scope| {
                scope
                    .spawn(work)
                    .join()
                    .unwrap_or_else(|e| panic::resume_unwind(e))
            })
        });
        let said = flaw.expect_err("it panics").to_string();
        assert!(
            said.starts_with("internal error in paths 0 to 255: index out of bounds"),
            "{said}"
        );
        assert!(said.contains("at src/ensemble/flaw.rs:"), "{said}");
        assert_eq!(guarded(|| 3), Ok(3));
    }
}
