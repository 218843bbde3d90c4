//! Numbered pieces of work, done on any number of threads. Their results are delivered in order.

use super::MOST_THREADS;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// The number of pieces by which each thread may be ahead of the oldest unfinished one. It limits
/// the memory of a run.
pub(super) const PIECES_AHEAD: u64 = 8;

/// Make the pieces `0 .. count` on `threads` threads, [`MOST_THREADS`] at most, and deliver each in
/// order, until all are delivered, `deliver` breaks or fails, or `stop` is set. Returns the number
/// of delivered pieces. The only errors are those of `deliver`.
///
/// When `deliver` breaks, the piece that it received is the last one, although other pieces may be
/// finished too. This makes the end of a run reproducible. When the caller sets `stop`, the
/// unfinished pieces are completed and delivered, so that no work is lost.
pub fn in_order<R: Send, E: Send>(
    count: u64,
    threads: usize,
    stop: &AtomicBool,
    make: impl Fn(u64) -> R + Sync,
    deliver: impl FnMut(R) -> Result<ControlFlow<()>, E> + Send,
) -> Result<u64, E> {
    in_order_while(count, threads, stop, |piece| Some(make(piece)), deliver)
}

/// The same, except that `make` may give up a piece by returning `None`. Then neither this piece
/// nor a later one is delivered.
pub(crate) fn in_order_while<R: Send, E: Send>(
    count: u64,
    threads: usize,
    stop: &AtomicBool,
    make: impl Fn(u64) -> Option<R> + Sync,
    mut deliver: impl FnMut(R) -> Result<ControlFlow<()>, E> + Send,
) -> Result<u64, E> {
    let workers = threads
        .min(count.try_into().unwrap_or(usize::MAX))
        .clamp(1, MOST_THREADS);
    let queue = OrderedQueue {
        state: Mutex::new(Delivery::new(&mut deliver)),
        moved: Condvar::new(),
    };
    let work = || {
        let _watch = LeaveOnPanic(&queue);
        while let Some(index) = queue.take(count, workers as u64 * PIECES_AHEAD, stop) {
            match make(index) {
                Some(piece) => queue.put(index, piece),
                None => queue.give_up(),
            }
        }
    };
    // The frames of several lanes do not fit into the usual stack unless they are optimised.
    let is_large = cfg!(debug_assertions);
    let pool = (workers > 1 || is_large).then(|| {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(workers);
        match is_large {
            true => threads.stack_size(16 << 20).build(),
            false => threads.build(),
        }
    });
    match pool {
        Some(Ok(pool)) => pool.scope(|scope| (0..workers).for_each(|_| scope.spawn(|_| work()))),
        // If no threads can be created, the thread of the caller makes all pieces.
        _ => work(),
    }
    let state = queue
        .state
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    match state.end {
        Some(Err(error)) => Err(error),
        _ => Ok(state.delivered),
    }
}

/// Finished pieces that wait for their turn to be delivered. The thread that finishes the next
/// piece in order delivers it and those waiting for it, including those that other threads finish
/// in the meantime. No thread is reserved for delivery, and none waits for a delivery to end.
struct OrderedQueue<'a, R, E> {
    state: Mutex<Delivery<'a, R, E>>,
    moved: Condvar,
}

struct Delivery<'a, R, E> {
    /// The number of the next piece to make.
    next: u64,
    /// Number of delivered pieces, which is also the number of the piece to deliver next.
    delivered: u64,
    /// Pieces that were finished before their turn.
    waiting: BTreeMap<u64, R>,
    /// None while a thread delivers.
    deliver: Option<&'a mut (dyn FnMut(R) -> Result<ControlFlow<()>, E> + Send)>,
    /// Set when nothing more is to be delivered, because `deliver` has broken or failed.
    end: Option<Result<(), E>>,
}

impl<'a, R, E> Delivery<'a, R, E> {
    fn new(deliver: &'a mut (dyn FnMut(R) -> Result<ControlFlow<()>, E> + Send)) -> Self {
        Delivery {
            next: 0,
            delivered: 0,
            waiting: BTreeMap::new(),
            deliver: Some(deliver),
            end: None,
        }
    }
}

impl<'a, R, E> OrderedQueue<'a, R, E> {
    fn lock(&self) -> MutexGuard<'_, Delivery<'a, R, E>> {
        // A panic of another thread reaches the caller in any case.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The number of the next piece to make. This waits until that piece is close enough to the
    /// oldest unfinished one. Returns `None` when no piece is left or the work has ended.
    fn take(&self, count: u64, ahead: u64, stop: &AtomicBool) -> Option<u64> {
        let mut state = self.lock();
        while state.next < count && state.next >= state.delivered + ahead && state.end.is_none() {
            state = self
                .moved
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
        if state.next >= count || state.end.is_some() || stop.load(Ordering::Relaxed) {
            return None;
        }
        state.next += 1;
        Some(state.next - 1)
    }

    /// State that a piece is given up. No more pieces are begun, and the pieces before it are still
    /// delivered.
    fn give_up(&self) {
        self.lock().next = u64::MAX;
        self.moved.notify_all();
    }

    /// Take a finished piece, and deliver all pieces whose turn it is, unless another thread is
    /// delivering. That thread will find this piece, because it looks for the next one before it
    /// puts `deliver` back, under the same lock.
    fn put(&self, index: u64, piece: R) {
        let mut state = self.lock();
        state.waiting.insert(index, piece);
        let Some(deliver) = state.deliver.take() else {
            return;
        };
        while state.end.is_none() {
            let turn = state.delivered;
            let Some(piece) = state.waiting.remove(&turn) else {
                break;
            };
            drop(state);
            let flow = deliver(piece);
            state = self.lock();
            match flow {
                Ok(flow) => {
                    state.delivered += 1;
                    state.end = flow.is_break().then_some(Ok(()));
                }
                Err(error) => state.end = Some(Err(error)),
            }
            self.moved.notify_all();
        }
        state.deliver = Some(deliver);
    }
}

/// Gives up when its thread panics. Otherwise the other threads would wait forever for its piece,
/// and the panic would not reach the caller.
struct LeaveOnPanic<'a, 'b, R, E>(&'b OrderedQueue<'a, R, E>);

impl<R, E> Drop for LeaveOnPanic<'_, '_, R, E> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.give_up();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;
    use std::sync::mpsc;
    use std::time::Duration;

    const LONG: Duration = Duration::from_secs(20);

    /// The delivery of piece 0 lasts until piece 3 is begun. So the other thread must be able to
    /// finish the pieces 1 and 2 during that delivery.
    #[test]
    fn no_thread_waits_for_a_delivery_of_another_to_end() {
        let (begun, third) = mpsc::channel();
        let third = Mutex::new(third);
        let make = |index: u64| {
            if index == 3 {
                begun.send(()).unwrap();
            }
            index
        };
        let mut seen = Vec::new();
        let deliver = |index: u64| -> Result<_, Infallible> {
            if index == 0 {
                third
                    .lock()
                    .unwrap()
                    .recv_timeout(LONG)
                    .expect("piece 3 begins during the delivery of piece 0");
            }
            seen.push(index);
            Ok(ControlFlow::Continue(()))
        };
        assert_eq!(
            in_order(40, 2, &AtomicBool::new(false), make, deliver),
            Ok(40)
        );
        assert!(seen.into_iter().eq(0..40));
    }

    /// There are more pieces than the threads may be ahead of the one that is never finished.
    #[test]
    fn a_panic_reaches_the_caller_whoever_panics() {
        for (maker, deliverer) in [(5, u64::MAX), (u64::MAX, 5)] {
            let (done, ended) = mpsc::channel();
            let run = std::thread::spawn(move || {
                let make = |index: u64| {
                    if index == maker {
                        panic!("planned")
                    } else {
                        index
                    }
                };
                let deliver = |index: u64| -> Result<_, Infallible> {
                    if index == deliverer {
                        panic!("planned")
                    } else {
                        Ok(ControlFlow::Continue(()))
                    }
                };
                let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                    in_order(1000, 3, &AtomicBool::new(false), make, deliver)
                }));
                done.send(outcome.is_err()).unwrap();
            });
            assert!(ended.recv_timeout(LONG).expect("the call ends"));
            run.join().unwrap();
        }
    }
}
