//! The allocator of the command. When memory runs out, the command prints a message and exits with
//! a code; the standard library would abort it.
//!
//! A verb estimates the memory that it needs and refuses what does not fit. This is for anything
//! that the estimate misses. All memory is allocated here, for this program and for the crates that
//! it uses.
//!
//! SAFETY, for every `unsafe` of this file: each call goes to the system's allocator with the
//! arguments that the caller gave, under the conditions that the caller guarantees.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

#[global_allocator]
static HEAP: Heap = Heap;

struct Heap;

unsafe impl GlobalAlloc for Heap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        there(unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        there(unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        there(unsafe { System.realloc(memory, layout, size) })
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { System.dealloc(memory, layout) }
    }
}

fn there(memory: *mut u8) -> *mut u8 {
    if memory.is_null() { give_up() } else { memory }
}

const MESSAGE: &[u8] =
    b"error: out of memory\n  fix: use fewer --threads, or allow more memory (`ulimit -v`, the limit of the \
container); `mc resume` continues a run that had begun\n";

/// Ends the process, as a kill would: nothing here may ask for memory.
#[cold]
fn give_up() -> ! {
    static IS_SAID: AtomicBool = AtomicBool::new(false);
    if IS_SAID.swap(true, Ordering::Relaxed) {
        // Another thread is ending the process.
        loop {
            std::thread::sleep(Duration::from_secs(1));
        }
    }
    let _ = rustix::io::write(io::stderr(), MESSAGE);
    signal_hook::low_level::exit(1)
}
