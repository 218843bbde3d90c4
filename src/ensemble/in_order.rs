//! Numbered pieces of work on any number of threads, their results delivered in order.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// How many pieces a thread may run ahead of the oldest one still in work; bounds the memory of a
/// run.
const PIECES_AHEAD: u64 = 8;

/// Make the pieces `0 .. count` on `threads` threads, and deliver each in order, until all are
/// delivered, `deliver` breaks or fails, or `stop` is set. Returns how many were delivered.
///
/// When `deliver` breaks, the piece it was given is the last one, whatever else is in work: where a
/// run ends is then as reproducible as what it delivers. When `stop` is set, from outside, the
/// pieces in work are finished and delivered, so that no work is lost.
pub fn in_order<R: Send, E: Send>(
    count: u64,
    threads: usize,
    stop: &AtomicBool,
    make: impl Fn(u64) -> R + Sync,
    deliver: impl FnMut(R) -> Result<ControlFlow<()>, E> + Send,
) -> Result<u64, E> {
    in_order_while(count, threads, stop, |piece| Some(make(piece)), deliver)
}

/// The same where a piece may be given up while it is made: then nothing more is delivered.
pub(crate) fn in_order_while<R: Send, E: Send>(
    count: u64,
    threads: usize,
    stop: &AtomicBool,
    make: impl Fn(u64) -> Option<R> + Sync,
    mut deliver: impl FnMut(R) -> Result<ControlFlow<()>, E> + Send,
) -> Result<u64, E> {
    let workers = threads.min(count.try_into().unwrap_or(usize::MAX)).max(1);
    let queue = Queue { state: Mutex::new(State::new(&mut deliver)), moved: Condvar::new() };
    let work = || {
        while let Some(index) = queue.take(count, workers as u64 * PIECES_AHEAD, stop) {
            match make(index) {
                Some(piece) => queue.put(index, piece),
                None => queue.give_up(),
            }
        }
    };
    let pool = (workers > 1).then(|| rayon::ThreadPoolBuilder::new().num_threads(workers).build());
    match pool {
        Some(Ok(pool)) => pool.scope(|scope| (0..workers).for_each(|_| scope.spawn(|_| work()))),
        // where there are no threads to be had, the caller's own does it all
        _ => work(),
    }
    let state = queue.state.into_inner().unwrap_or_else(PoisonError::into_inner);
    match state.end {
        Some(Err(error)) => Err(error),
        _ => Ok(state.delivered),
    }
}

/// Pieces on their way from the threads that make them to the one consumer, in order. Whichever
/// thread completes the sequence delivers; there is no thread for delivering alone.
struct Queue<'a, R, E> {
    state: Mutex<State<'a, R, E>>,
    moved: Condvar,
}

struct State<'a, R, E> {
    /// The next piece to make.
    next: u64,
    /// Pieces delivered.
    delivered: u64,
    /// Pieces done before their turn.
    waiting: BTreeMap<u64, R>,
    deliver: &'a mut (dyn FnMut(R) -> Result<ControlFlow<()>, E> + Send),
    /// Set when nothing more is to be delivered: the consumer broke, or failed.
    end: Option<Result<(), E>>,
}

impl<'a, R, E> State<'a, R, E> {
    fn new(deliver: &'a mut (dyn FnMut(R) -> Result<ControlFlow<()>, E> + Send)) -> Self {
        State { next: 0, delivered: 0, waiting: BTreeMap::new(), deliver, end: None }
    }
}

impl<'a, R, E> Queue<'a, R, E> {
    fn lock(&self) -> MutexGuard<'_, State<'a, R, E>> {
        // a panic elsewhere is on its way to the caller already
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next piece to make, once it is near enough to the oldest one in work; none when there is
    /// no more to do.
    fn take(&self, count: u64, ahead: u64, stop: &AtomicBool) -> Option<u64> {
        let mut state = self.lock();
        while state.next < count && state.next >= state.delivered + ahead && state.end.is_none() {
            state = self.moved.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        if state.next >= count || state.end.is_some() || stop.load(Ordering::Relaxed) {
            return None;
        }
        state.next += 1;
        Some(state.next - 1)
    }

    /// A piece will not come: no more are made, and those before it are delivered as they come.
    fn give_up(&self) {
        self.lock().next = u64::MAX;
        self.moved.notify_all();
    }

    /// Hand in a piece, and deliver all that are in turn.
    fn put(&self, index: u64, piece: R) {
        let mut state = self.lock();
        state.waiting.insert(index, piece);
        while state.end.is_none() {
            let turn = state.delivered;
            let Some(piece) = state.waiting.remove(&turn) else { break };
            match (state.deliver)(piece) {
                Ok(flow) => {
                    state.delivered += 1;
                    state.end = flow.is_break().then_some(Ok(()));
                }
                Err(error) => state.end = Some(Err(error)),
            }
        }
        self.moved.notify_all();
    }
}
