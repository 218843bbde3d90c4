//! Ensembles: fixed blocks of paths, simulated by any number of threads, delivered in order. The
//! only home of rayon.
//!
//! A run is the sequence of its blocks: block k holds the paths `k BLOCK_SIZE .. (k + 1)
//! BLOCK_SIZE`, whatever the number of threads and whatever the machine. Each block's result is
//! self-contained and mergeable. Blocks are delivered in order, so whatever folds or writes them
//! sees the same sequence every time, and a run that is stopped leaves the first so many blocks,
//! none missing in between.

mod flight;
mod in_order;
mod leases;
mod piece;

#[doc(hidden)]
pub use in_order::in_order;
pub(crate) use in_order::in_order_while;
pub use leases::Leases;

use crate::model::Model;
use crate::noise;
use crate::scheme::{Simulate as _, Simulation, Timeline};
use crate::stats::{BlockObserver, BlockResult, Companion, Overlap, Record, RunTotals, Summary};
use flight::Flight;
use piece::Piece;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};

/// Paths in a block: enough to fill the registers many times over, few enough for a hundred
/// thousandth of a large run to be lost to an interruption. Part of what makes a result
/// reproducible: changing it changes the last bits of every mean.
pub const BLOCK_SIZE: u64 = 256;

/// A thread takes several blocks at a time only if that leaves it so many turns, because the last
/// ones of a run may find some threads idle.
const TURNS: u64 = 4;

/// Blocks with more rows of the output grid than this are taken one at a time: their tables would
/// not stay in the cache, and looking takes longer than simulating.
const MOST_ROWS: usize = 1000;

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

    /// The same ensemble, of whose output rows every `closeness`-th is one of the run and the
    /// others are a closer look ([`crate::scheme::Simulate::looked_at_closer`]).
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
            let piece = Piece::new(first, paths, self.antithetic);
            if let Some((piece, ())) = self.piece_beside(piece, &(), &never) {
                return piece;
            }
        }
    }

    /// Simulate block `index`, watched by a companion as well; none where `halt` is raised
    /// meanwhile.
    pub(crate) fn block_beside<C: Companion>(
        &self,
        index: u64,
        companion: &C,
        halt: &AtomicBool,
    ) -> Option<Delivered<C::Sums>> {
        let (result, beside) = self.piece_beside(self.block_piece(index), companion, halt)?;
        Some(Delivered { index, result, beside })
    }

    /// Simulate neighbouring blocks, all of them full but for the last of the run, together; none
    /// where `halt` is raised meanwhile.
    fn flight_beside<C: Companion>(
        &self,
        blocks: Range<u64>,
        companion: &C,
        halt: &AtomicBool,
    ) -> Option<Vec<Delivered<C::Sums>>> {
        if blocks.end - blocks.start == 1 {
            return Some(vec![self.block_beside(blocks.start, companion, halt)?]);
        }
        let pieces: Vec<Piece> = blocks.clone().map(|index| self.block_piece(index)).collect();
        let observers = pieces.iter().map(|piece| self.observers(piece, companion)).collect();
        let mut all = (Flight { blocks: observers, lanes: BLOCK_SIZE as usize }, halt);
        let paths: Vec<u64> = pieces.iter().flat_map(|piece| &piece.kept).copied().collect();
        let lost = self.simulation.simulate(self.seed, &drawn(&paths, self.antithetic), &mut all);
        if halt.load(Ordering::Relaxed) {
            return None;
        }
        let mut delivered = Vec::with_capacity(pieces.len());
        for ((piece, both), index) in pieces.into_iter().zip(all.0.blocks).zip(blocks.clone()) {
            let block = index - blocks.start;
            delivered.push(if lost.iter().any(|&lane| lane as u64 / BLOCK_SIZE == block) {
                // The others of its paths are simulated again without those that diverged.
                self.block_beside(index, companion, halt)?
            } else {
                let (result, beside) = piece.finish(both, companion);
                Delivered { index, result, beside }
            });
        }
        Some(delivered)
    }

    /// How many of so many blocks a thread takes at a time.
    fn blocks_in_flight(&self, blocks: u64, threads: usize) -> u64 {
        if self.timeline().rows() > MOST_ROWS {
            return 1;
        }
        let wanted = self.simulation.paths_abreast() as u64 / BLOCK_SIZE;
        wanted.min(blocks / (threads as u64 * TURNS)).max(1)
    }

    /// The paths of a block.
    fn block_piece(&self, index: u64) -> Piece {
        let first = index * BLOCK_SIZE;
        Piece::new(first, BLOCK_SIZE.min(self.paths - first), self.antithetic)
    }

    /// What watches the paths of a piece that are left: the program's observer and a companion's.
    fn observers<C: Companion>(&self, piece: &Piece, companion: &C) -> (BlockObserver, C::Observer) {
        let own = BlockObserver::new(self.model(), self.timeline(), &self.record, &piece.kept)
            .with_step(self.simulation.step())
            .in_units(piece.unit);
        (own, companion.observer(&piece.kept))
    }

    /// Simulate the paths of a piece, watched by a companion as well; none where `halt` is raised
    /// meanwhile.
    ///
    /// A path that diverges is left out, with the other one of its pair, and the others are
    /// simulated again without it. They are independent of it, so this happens at most once a
    /// block.
    fn piece_beside<C: Companion>(
        &self,
        mut piece: Piece,
        companion: &C,
        halt: &AtomicBool,
    ) -> Option<(BlockResult, C::Sums)> {
        loop {
            let mut all = (self.observers(&piece, companion), halt);
            let lost = self.simulation.simulate(self.seed, &drawn(&piece.kept, self.antithetic), &mut all);
            if halt.load(Ordering::Relaxed) {
                return None;
            }
            if lost.is_empty() {
                return Some(piece.finish(all.0, companion));
            }
            piece.leave_out(&lost);
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

    /// Simulate block after block on `threads` threads, and deliver each in order to `deliver`, in
    /// the order of their numbers. Returns the number of paths delivered.
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

    /// The same for these blocks only, every block watched by a companion as well. Returns the
    /// number of blocks delivered.
    pub fn run_beside<C: Companion, E: Send>(
        &self,
        companion: &C,
        blocks: Range<u64>,
        threads: usize,
        stops: Stops<'_>,
        mut deliver: impl FnMut(Delivered<C::Sums>) -> Result<ControlFlow<()>, E> + Send,
    ) -> Result<u64, E> {
        let count = blocks.end.saturating_sub(blocks.start);
        let size = self.blocks_in_flight(count, threads);
        let make = |flight: u64| {
            let first = blocks.start + flight * size;
            self.flight_beside(first..blocks.end.min(first + size), companion, stops.halt)
        };
        let mut delivered = 0;
        let deliver = |flight: Vec<Delivered<C::Sums>>| {
            for block in flight {
                delivered += 1;
                if deliver(block)?.is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
            Ok(ControlFlow::Continue(()))
        };
        in_order_while(count.div_ceil(size), threads, stops.stop, make, deliver)?;
        Ok(delivered)
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
