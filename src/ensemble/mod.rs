//! Ensembles: fixed blocks of paths, simulated by any number of threads, delivered in order. The only home of rayon.
//!
//! A run is the sequence of its blocks: block k holds the paths `k BLOCK_SIZE .. (k + 1) BLOCK_SIZE`, whatever the number of
//! threads and whatever the machine. Each block's result is self-contained and mergeable. Blocks are delivered in
//! order, so whatever folds or writes them sees the same sequence every time, and a run that is stopped leaves the first
//! so many blocks, none missing in between.

mod in_order;

#[doc(hidden)]
pub use in_order::in_order;
pub(crate) use in_order::in_order_while;

use crate::model::Model;
use crate::noise;
use crate::scheme::{Simulate as _, Simulation, Timeline};
use crate::stats::{BlockObserver, BlockResult, Companion, Overlap, Record, RunTotals, Summary, Unit};
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};

/// Paths in a block: enough to fill the registers many times over, few enough for a hundred thousandth of a large run to be
/// lost to an interruption. Part of what makes a result reproducible: changing it changes the last bits of every mean.
pub const BLOCK_SIZE: u64 = 256;

/// Everything an ensemble is a function of.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What is simulated, how, and when it is looked at.
    pub simulation: Simulation,
    /// What is kept of single paths.
    pub record: Record,
    /// With a path's number it determines the path.
    pub seed: u64,
    /// Number of paths.
    pub paths: u64,
    /// Whether paths 2k and 2k + 1 see the same noise and its mirror image.
    pub antithetic: bool,
}

/// What these paths draw from: paths of antithetic pairs, or of none.
pub fn drawn(paths: &[u64], antithetic: bool) -> Vec<u64> {
    paths.iter().map(|&path| if antithetic { noise::antithetic(path) } else { path }).collect()
}

impl Plan {
    /// What is simulated.
    pub fn model(&self) -> &Model {
        self.simulation.model()
    }

    /// When paths are looked at.
    pub fn timeline(&self) -> &Timeline {
        self.simulation.timeline()
    }

    /// Number of blocks.
    pub fn blocks(&self) -> u64 {
        self.paths.div_ceil(BLOCK_SIZE)
    }

    /// Simulate block `index`.
    pub fn block(&self, index: u64) -> BlockResult {
        let first = index * BLOCK_SIZE;
        self.piece(first, BLOCK_SIZE.min(self.paths - first))
    }

    /// The same ensemble, of whose output rows every `closeness`-th is one of the run and the others
    /// are a closer look ([`crate::scheme::Simulate::looked_at_closer`]).
    pub fn looked_at_closer(self, closeness: usize) -> Self {
        Plan { simulation: self.simulation.looked_at_closer(closeness), ..self }
    }

    /// Simulate path `path` of the ensemble alone: the same path, bit for bit.
    pub fn replay(&self, path: u64) -> BlockResult {
        self.piece(path, 1)
    }

    /// Simulate the paths `first .. first + paths`, of this ensemble or beyond its end.
    pub fn piece(&self, first: u64, paths: u64) -> BlockResult {
        let never = AtomicBool::new(false);
        loop {
            // Nobody raises the flag, so it is made at once.
            if let Some((piece, ())) = self.piece_beside(first, paths, &(), &never) {
                return piece;
            }
        }
    }

    /// Simulate block `index`, watched by a companion as well; none where `halt` is raised meanwhile.
    pub(crate) fn block_beside<C: Companion>(
        &self,
        index: u64,
        companion: &C,
        halt: &AtomicBool,
    ) -> Option<Delivered<C::Sums>> {
        let first = index * BLOCK_SIZE;
        let (result, beside) = self.piece_beside(first, BLOCK_SIZE.min(self.paths - first), companion, halt)?;
        Some(Delivered { index, result, beside })
    }

    /// Simulate the paths `first .. first + paths`, watched by a companion as well.
    ///
    /// A path that diverges is left out, with the other one of its pair, and the others are simulated again without it. They are independent of it, so this happens
    /// at most once a block.
    fn piece_beside<C: Companion>(
        &self,
        first: u64,
        paths: u64,
        companion: &C,
        halt: &AtomicBool,
    ) -> Option<(BlockResult, C::Sums)> {
        // A piece that cuts a pair, such as a path alone, has no pairs.
        let holds_pairs = self.antithetic && first.is_multiple_of(2) && paths.is_multiple_of(2);
        let unit = if holds_pairs { Unit::Pair } else { Unit::Path };
        let mut kept: Vec<u64> = (first..first + paths).collect();
        let mut diverged = Vec::new();
        loop {
            let own = BlockObserver::new(self.model(), self.timeline(), &self.record, &kept)
                .with_step(self.simulation.step())
                .in_units(unit);
            let mut all = ((own, companion.observer(&kept)), halt);
            let lost = self.simulation.simulate(self.seed, &drawn(&kept, self.antithetic), &mut all);
            if halt.load(Ordering::Relaxed) {
                return None;
            }
            if lost.is_empty() {
                let ((own, theirs), _) = all;
                return Some((own.finish(first, paths, diverged), companion.finish(theirs, unit)));
            }
            // With a path the other one of its pair is left out.
            let lost: Vec<u64> = lost.into_iter().map(|lane| unit.of(kept[lane])).collect();
            let (out, rest) = kept.into_iter().partition(|&path| lost.contains(&unit.of(path)));
            kept = rest;
            diverged.extend::<Vec<u64>>(out);
            diverged.sort_unstable();
        }
    }

    /// Simulate the whole ensemble on `threads` threads and sum it up.
    pub fn run(&self, threads: usize) -> Summary {
        let mut totals = RunTotals::empty(self.model(), self.timeline());
        let deliver = |block: BlockResult| {
            totals.push(block.first_path / BLOCK_SIZE, block.totals)?;
            Ok::<_, Overlap>(ControlFlow::Continue(()))
        };
        // No block is delivered twice, so nothing overlaps.
        let _ = self.run_into(threads, &AtomicBool::new(false), deliver);
        totals.totals().summary()
    }

    /// Simulate block after block on `threads` threads, and deliver each in order to `deliver`, in the order of their numbers. Returns the
    /// number of paths delivered.
    pub fn run_into<E: Send>(
        &self,
        threads: usize,
        stop: &AtomicBool,
        mut deliver: impl FnMut(BlockResult) -> Result<ControlFlow<()>, E> + Send,
    ) -> Result<u64, E> {
        let stops = Stops { stop, halt: &AtomicBool::new(false) };
        let blocks = self.run_beside(&(), 0..self.blocks(), threads, stops, |block| deliver(block.result))?;
        Ok((blocks * BLOCK_SIZE).min(self.paths))
    }

    /// The same for these blocks only, every block watched by a companion as well. Returns the number of blocks delivered.
    pub fn run_beside<C: Companion, E: Send>(
        &self,
        companion: &C,
        blocks: Range<u64>,
        threads: usize,
        stops: Stops<'_>,
        deliver: impl FnMut(Delivered<C::Sums>) -> Result<ControlFlow<()>, E> + Send,
    ) -> Result<u64, E> {
        let make = |piece: u64| self.block_beside(blocks.start + piece, companion, stops.halt);
        in_order_while(blocks.end.saturating_sub(blocks.start), threads, stops.stop, make, deliver)
    }
}

/// Two flags that end a run.
#[derive(Clone, Copy, Debug)]
pub struct Stops<'a> {
    /// No more blocks are begun; those in work are finished.
    pub stop: &'a AtomicBool,
    /// Those in work are given up.
    pub halt: &'a AtomicBool,
}

/// A block on its way from the threads that simulate to whoever folds it.
#[derive(Clone, Debug)]
pub struct Delivered<S> {
    /// Its number.
    pub index: u64,
    /// What it leaves behind.
    pub result: BlockResult,
    /// What the companion made of it.
    pub beside: S,
}
