//! Ensembles: fixed blocks of paths, simulated by any number of threads, delivered in order. The only home of rayon.
//!
//! A run is the sequence of its blocks: block k holds the paths `k BLOCK_SIZE .. (k + 1) BLOCK_SIZE`, whatever the number of
//! threads and whatever the machine. Each block's result is self-contained and mergeable. Blocks are delivered in
//! order, so whatever folds or writes them sees the same sequence every time, and a run that is stopped leaves the first
//! so many blocks, none missing in between.

use crate::model::Model;
use crate::scheme::{Scheme, Timeline};
use crate::stats::{BlockObserver, BlockResult, Record, Summary, Totals};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Paths in a block: enough to fill the registers many times over, few enough for a hundred thousandth of a large run to be
/// lost to an interruption. Part of what makes a result reproducible: changing it changes the last bits of every mean.
pub const BLOCK_SIZE: u64 = 256;

/// How many blocks a thread may run ahead of the oldest one still being simulated; bounds the memory of a run.
const BLOCKS_AHEAD: u64 = 8;

/// Everything an ensemble is a function of.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The physics.
    pub model: Model,
    /// How it is simulated.
    pub scheme: Scheme,
    /// When paths are observed.
    pub timeline: Timeline,
    /// What is kept of single paths.
    pub record: Record,
    /// With a path's number it determines the path.
    pub seed: u64,
    /// Number of paths.
    pub paths: u64,
}

impl Plan {
    /// Number of blocks.
    pub fn blocks(&self) -> u64 {
        self.paths.div_ceil(BLOCK_SIZE)
    }

    /// Simulate block `index`.
    pub fn block(&self, index: u64) -> BlockResult {
        let first = index * BLOCK_SIZE;
        self.simulate(first, BLOCK_SIZE.min(self.paths - first))
    }

    /// Simulate path `path` of the ensemble alone: the same path, bit for bit.
    pub fn replay(&self, path: u64) -> BlockResult {
        self.simulate(path, 1)
    }

    /// A path that diverges is left out, and the others are simulated again without it. They are independent of it, so this happens
    /// at most once a block.
    fn simulate(&self, first: u64, paths: u64) -> BlockResult {
        let mut kept: Vec<u64> = (first..first + paths).collect();
        let mut diverged = Vec::new();
        loop {
            let mut observer = BlockObserver::new(&self.model, &self.timeline, &self.record, &kept);
            let lost = self.scheme.simulate(self.seed, &kept, &mut observer);
            if lost.is_empty() {
                return observer.finish(first, paths, diverged);
            }
            for lane in lost.into_iter().rev() {
                diverged.push(kept.remove(lane));
            }
            diverged.sort_unstable();
        }
    }

    /// Simulate the whole ensemble on `threads` threads and sum it up.
    pub fn run(&self, threads: usize) -> Summary {
        let mut totals = Totals::empty(&self.model, &self.timeline);
        let deliver = |block: BlockResult| -> Result<(), Infallible> {
            totals.merge(&block.totals);
            Ok(())
        };
        match self.run_into(threads, &AtomicBool::new(false), deliver) {
            Ok(_) => totals.summary(),
        }
    }

    /// Simulate block after block on `threads` threads, and deliver each in order to `deliver`, until all are done, `stop` is set
    /// or `deliver` fails. Blocks in flight when `stop` is set are finished and delivered. Returns the number of paths delivered.
    pub fn run_into<E: Send>(
        &self,
        threads: usize,
        stop: &AtomicBool,
        mut deliver: impl FnMut(BlockResult) -> Result<(), E> + Send,
    ) -> Result<u64, E> {
        if threads <= 1 {
            for index in 0..self.blocks() {
                if stop.load(Ordering::Relaxed) {
                    return Ok(index * BLOCK_SIZE);
                }
                deliver(self.block(index))?;
            }
            return Ok(self.paths);
        }
        let queue = Queue { state: Mutex::new(State::new(&mut deliver)), moved: Condvar::new() };
        let workers = threads.min(self.blocks().try_into().unwrap_or(usize::MAX));
        let work = || {
            while let Some(index) = queue.take(self.blocks(), workers as u64 * BLOCKS_AHEAD, stop) {
                queue.put(index, self.block(index));
            }
        };
        match rayon::ThreadPoolBuilder::new().num_threads(workers).build() {
            Ok(pool) => pool.scope(|scope| (0..workers).for_each(|_| scope.spawn(|_| work()))),
            // no threads to be had: the caller's own does it all
            Err(_) => work(),
        }
        let state = queue.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        match state.failure {
            Some(error) => Err(error),
            None => Ok((state.delivered * BLOCK_SIZE).min(self.paths)),
        }
    }
}

/// Blocks on their way from the threads that simulate them to the one consumer, in order. Whichever thread completes the
/// sequence delivers; there is no thread for delivering alone.
struct Queue<'a, E> {
    state: Mutex<State<'a, E>>,
    moved: Condvar,
}

struct State<'a, E> {
    /// The next block to simulate.
    next: u64,
    /// Blocks delivered.
    delivered: u64,
    /// Blocks done before their turn.
    waiting: BTreeMap<u64, BlockResult>,
    deliver: &'a mut (dyn FnMut(BlockResult) -> Result<(), E> + Send),
    failure: Option<E>,
}

impl<'a, E> State<'a, E> {
    fn new(deliver: &'a mut (dyn FnMut(BlockResult) -> Result<(), E> + Send)) -> Self {
        State { next: 0, delivered: 0, waiting: BTreeMap::new(), deliver, failure: None }
    }
}

impl<'a, E> Queue<'a, E> {
    fn lock(&self) -> MutexGuard<'_, State<'a, E>> {
        // a panic elsewhere is on its way to the caller already
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next block to simulate, once it is near enough to the oldest one in flight; none when there is no more to do.
    fn take(&self, blocks: u64, ahead: u64, stop: &AtomicBool) -> Option<u64> {
        let mut state = self.lock();
        while state.next < blocks && state.next >= state.delivered + ahead && state.failure.is_none() {
            state = self.moved.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        if state.next >= blocks || state.failure.is_some() || stop.load(Ordering::Relaxed) {
            return None;
        }
        state.next += 1;
        Some(state.next - 1)
    }

    /// Hand in a block, and deliver all that are in turn.
    fn put(&self, index: u64, block: BlockResult) {
        let mut state = self.lock();
        state.waiting.insert(index, block);
        while state.failure.is_none() {
            let turn = state.delivered;
            let Some(block) = state.waiting.remove(&turn) else { break };
            match (state.deliver)(block) {
                Ok(()) => state.delivered += 1,
                Err(error) => state.failure = Some(error),
            }
        }
        self.moved.notify_all();
    }
}
