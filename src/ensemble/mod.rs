//! Ensembles of paths in blocks of a fixed size, which are simulated on any number of threads and
//! delivered in order. Only this module uses rayon.
//!
//! A run is the sequence of its blocks: block k contains the paths `k BLOCK_SIZE .. (k + 1)
//! BLOCK_SIZE`, for any number of threads and on any machine. The result of a block does not depend
//! on other blocks, and results can be merged. Since blocks are delivered in order, sums and files
//! receive the same sequence every time, and a stopped run consists of the first blocks, without
//! gaps.

mod flaw;
mod flight;
mod in_order;
mod piece;
mod threads;

pub use flaw::{Flaw, guarded};
pub(crate) use flight::Flight;
#[doc(hidden)]
pub use in_order::in_order;
pub(crate) use in_order::in_order_while;
pub use threads::{MOST_THREADS, ThreadsError, check_threads};

use crate::model::{Event, Problem};
use crate::noise;
use crate::scheme::{Observer, Segment, Simulate as _, Simulation, Timeline, Unresolved};
use crate::stats::{AuxiliaryObserver, BlockObserver, BlockResult, Record, RunTotals, Summary};
use crate::sums::Overlap;
use flaw::naming;
use in_order::PIECES_AHEAD;
use piece::PathRange;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of paths in a block. It is large enough to fill the registers many times over, and small
/// enough that little is lost if unfinished blocks are given up. Results depend on this number:
/// with another one the last bits of every mean change.
pub const BLOCK_SIZE: u64 = 256;

/// A thread simulates several blocks together only if every thread still gets at least this many
/// such groups, because some threads may be idle while the last ones of a run are simulated.
const TURNS: u64 = 4;

/// Blocks with more rows of the output grid than this are simulated one at a time: the tables of
/// several would not stay in the cache, and the snapshots of such blocks take longer than the
/// simulation.
const MOST_ROWS: usize = 1000;

/// Everything that determines the results of an ensemble.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What is simulated, with which scheme, and at which times snapshots are taken.
    pub simulation: Simulation,
    /// What is recorded of single paths.
    pub record: Record,
    /// The seed. Together with the number of a path, it determines the path.
    pub seed: u64,
    /// Number of paths.
    pub paths: u64,
    /// Whether the paths 2k and 2k + 1 are an antithetic pair: the second one has the noise of the
    /// first one with the opposite sign.
    pub antithetic: bool,
}

/// The path numbers that determine the random numbers of these paths. In an ensemble of antithetic
/// pairs these are the even path of each pair and its mirror image, and otherwise the paths
/// themselves.
pub fn drawn(paths: &[u64], antithetic: bool) -> Vec<u64> {
    paths
        .iter()
        .map(|&path| {
            if antithetic {
                noise::antithetic(path)
            } else {
                path
            }
        })
        .collect()
}

/// The observed path: its events, and its motion between them.
#[derive(Default)]
pub(crate) struct PathMotion {
    pub events: Vec<Event>,
    pub segments: Vec<Segment>,
}

impl Observer for PathMotion {
    fn event(&mut self, _: usize, event: Event) {
        self.events.push(event);
    }

    fn follows(&self) -> bool {
        true
    }

    fn segment(&mut self, _: usize, segment: &Segment) {
        self.segments.push(*segment);
    }
}

/// Why a path was given up, and how far it got.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{why}, after t = {time:.4e} at x = {displacement:.4e}")]
pub struct GivenUp {
    /// The reason.
    pub why: Unresolved,
    /// The end of the last segment of its motion, a time.
    pub time: f64,
    /// x there, a length.
    pub displacement: f64,
}

/// The last observed state of a path.
struct SeenLast([f64; 2]);

impl Observer for SeenLast {
    fn event(&mut self, _: usize, event: Event) {
        self.0 = [event.time, event.displacement];
    }

    fn follows(&self) -> bool {
        true
    }

    fn segment(&mut self, _: usize, segment: &Segment) {
        self.0 = [segment.end(), segment.displacement + segment.way];
    }
}

impl Plan {
    /// The model that is simulated.
    pub fn model(&self) -> &Problem {
        self.simulation.model()
    }

    /// The times of the snapshots.
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

    /// The same ensemble with a finer output grid, of which every `row_stride`-th row is one of the
    /// run and the others are only intermediate observation times
    /// ([`crate::scheme::Simulate::with_additional_rows`]).
    pub fn with_additional_rows(self, row_stride: usize) -> Self {
        Plan {
            simulation: self.simulation.with_additional_rows(row_stride),
            ..self
        }
    }

    /// Simulate path number `path` of the ensemble alone. It has the same bits as in the ensemble.
    pub fn replay(&self, path: u64) -> BlockResult {
        self.piece(path, 1)
    }

    /// The motion of path number `path` of the ensemble, segment by segment, without its sticks;
    /// none if it is lost.
    pub fn motion(&self, path: u64) -> Option<Vec<Segment>> {
        let mut motion = PathMotion::default();
        let lost = self.simulated(&[path], &mut motion);
        lost.is_empty().then_some(motion.segments)
    }

    /// Why path number `path` of the ensemble was given up. The path is simulated again, until
    /// `stop` is set. None if it was not given up, or for schemes whose lost paths have diverged.
    pub fn why_lost(&self, path: u64, stop: impl Observer) -> Option<GivenUp> {
        let drawn = drawn(&[path], self.antithetic);
        let mut observers = (SeenLast([0.0, self.model().initial_displacement]), stop);
        let why = self
            .simulation
            .why_lost(self.seed, drawn[0], &mut observers)?;
        let [time, displacement] = observers.0.0;
        Some(GivenUp {
            why,
            time,
            displacement,
        })
    }

    /// Simulate the paths `first .. first + paths`. They may lie beyond the end of the ensemble.
    pub fn piece(&self, first: u64, paths: u64) -> BlockResult {
        let never = AtomicBool::new(false);
        loop {
            // The flag is never set, so the first attempt succeeds.
            if let Some(piece) = self.piece_until(first, paths, &never) {
                return piece;
            }
        }
    }

    /// The same. Returns `None` if `stop` is set in the meantime.
    pub(crate) fn piece_until(
        &self,
        first: u64,
        paths: u64,
        stop: &AtomicBool,
    ) -> Option<BlockResult> {
        let piece = PathRange::new(first, paths, self.antithetic);
        Some(self.piece_with_auxiliary(piece, &(), stop)?.0)
    }

    /// Simulate block `index`, also observed by an auxiliary. Returns `None` if `halt` is set in
    /// the meantime.
    pub(crate) fn block_with_auxiliary<C: AuxiliaryObserver>(
        &self,
        index: u64,
        auxiliary: &C,
        halt: &AtomicBool,
    ) -> Option<Delivered<C::Sums>> {
        let (result, auxiliary_sums) =
            self.piece_with_auxiliary(self.block_piece(index), auxiliary, halt)?;
        Some(Delivered {
            index,
            result,
            auxiliary_sums,
        })
    }

    /// Simulate neighbouring blocks together. Only the last block of the run may be less than full.
    /// Returns `None` if `halt` is set in the meantime.
    fn flight_with_auxiliary<C: AuxiliaryObserver>(
        &self,
        blocks: Range<u64>,
        auxiliary: &C,
        halt: &AtomicBool,
    ) -> Option<Vec<Delivered<C::Sums>>> {
        if blocks.end - blocks.start == 1 {
            return Some(vec![self.block_with_auxiliary(
                blocks.start,
                auxiliary,
                halt,
            )?]);
        }
        let pieces: Vec<PathRange> = blocks
            .clone()
            .map(|index| self.block_piece(index))
            .collect();
        let observers = pieces
            .iter()
            .map(|piece| self.observers(piece, auxiliary))
            .collect();
        let mut all = (
            Flight {
                observers,
                lanes: BLOCK_SIZE as usize,
            },
            halt,
        );
        let paths: Vec<u64> = pieces
            .iter()
            .flat_map(|piece| &piece.kept)
            .copied()
            .collect();
        let lost = self.simulated(&paths, &mut all);
        if halt.load(Ordering::Relaxed) {
            return None;
        }
        let mut delivered = Vec::with_capacity(pieces.len());
        for ((piece, both), index) in pieces.into_iter().zip(all.0.observers).zip(blocks.clone()) {
            let block = index - blocks.start;
            delivered.push(
                if lost.iter().any(|&lane| lane as u64 / BLOCK_SIZE == block) {
                    // The block is simulated again, without the paths that diverge.
                    self.block_with_auxiliary(index, auxiliary, halt)?
                } else {
                    let (result, auxiliary_sums) = piece.finish(both, auxiliary);
                    Delivered {
                        index,
                        result,
                        auxiliary_sums,
                    }
                },
            );
        }
        Some(delivered)
    }

    /// Simulate these paths. Returns the lanes of lost paths. A panic names the paths.
    fn simulated(&self, paths: &[u64], observer: &mut dyn Observer) -> Vec<usize> {
        let doing = || match paths {
            [first, .., last] => format!("in the simulation of paths {first} to {last}"),
            [path] => format!("in the simulation of path {path}"),
            [] => String::new(),
        };
        naming(doing, || {
            self.simulation
                .simulate(self.seed, &drawn(paths, self.antithetic), observer)
        })
    }

    /// How many blocks are in memory at a time, at most: those that are simulated, and finished
    /// ones that wait to be delivered in order. If each thread has a processor, none waits for
    /// long; a single thread never waits.
    pub fn blocks_held(&self, threads: usize) -> u64 {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let pieces = match threads {
            1 => 1,
            _ if threads > cores => PIECES_AHEAD,
            _ => PIECES_AHEAD.min(5),
        };
        let of_threads =
            (threads as u64).saturating_mul(pieces * self.blocks_in_flight(self.blocks(), threads));
        of_threads.min(self.blocks())
    }

    /// The number of blocks that a thread simulates together, given the numbers of blocks and
    /// threads.
    fn blocks_in_flight(&self, blocks: u64, threads: usize) -> u64 {
        if self.timeline().rows() > MOST_ROWS {
            return 1;
        }
        let wanted = self.simulation.vectorised_paths() as u64 / BLOCK_SIZE;
        wanted.min(blocks / (threads as u64 * TURNS)).max(1)
    }

    /// The paths of a block.
    fn block_piece(&self, index: u64) -> PathRange {
        let first = index * BLOCK_SIZE;
        PathRange::new(first, BLOCK_SIZE.min(self.paths - first), self.antithetic)
    }

    /// The observers of the kept paths of a piece: that of the program and that of the auxiliary.
    fn observers<C: AuxiliaryObserver>(
        &self,
        piece: &PathRange,
        auxiliary: &C,
    ) -> (BlockObserver, C::Observer) {
        let own = BlockObserver::new(
            self.model(),
            self.timeline(),
            &self.record,
            &piece.kept,
            piece.unit,
        )
        .with_step(self.simulation.step());
        (own, auxiliary.observer(&piece.kept))
    }

    /// Simulate the paths of a piece, also observed by an auxiliary. Returns `None` if `halt` is
    /// set in the meantime.
    ///
    /// A path that diverges is left out, together with the other path of its pair, and the others
    /// are simulated again without it. They do not depend on it, so this happens at most once per
    /// block.
    fn piece_with_auxiliary<C: AuxiliaryObserver>(
        &self,
        mut piece: PathRange,
        auxiliary: &C,
        halt: &AtomicBool,
    ) -> Option<(BlockResult, C::Sums)> {
        loop {
            let mut all = (self.observers(&piece, auxiliary), halt);
            let lost = self.simulated(&piece.kept, &mut all);
            if halt.load(Ordering::Relaxed) {
                return None;
            }
            if lost.is_empty() {
                return Some(piece.finish(all.0, auxiliary));
            }
            piece.leave_out(&lost);
        }
    }

    /// Simulate the whole ensemble on `threads` threads, and return the summary of its statistics.
    pub fn run(&self, threads: usize) -> Summary {
        let mut totals = RunTotals::empty(self.model(), self.timeline(), &self.record);
        let deliver = |block: BlockResult| {
            totals.push(block.rows.first_path / BLOCK_SIZE, block.totals)?;
            Ok::<_, Overlap>(ControlFlow::Continue(()))
        };
        // No block is delivered twice, so there is no overlap and no error.
        let _ = self.run_into(threads, &AtomicBool::new(false), deliver);
        totals.totals().summary()
    }

    /// Simulate all blocks on `threads` threads, and deliver them in the order of their numbers,
    /// until `deliver` breaks or fails, or `stop` is set. Returns the number of delivered paths.
    /// The only errors are those of `deliver`.
    pub fn run_into<E: Send>(
        &self,
        threads: usize,
        stop: &AtomicBool,
        mut deliver: impl FnMut(BlockResult) -> Result<ControlFlow<()>, E> + Send,
    ) -> Result<u64, E> {
        let stops = Stops {
            stop,
            halt: &AtomicBool::new(false),
        };
        let blocks = self.run_beside(&(), 0..self.blocks(), threads, stops, |block| {
            deliver(block.result)
        })?;
        Ok((blocks * BLOCK_SIZE).min(self.paths))
    }

    /// The same for these blocks only. An auxiliary also observes every block, and `stops` may also
    /// give up unfinished blocks. Returns the number of delivered blocks.
    pub fn run_beside<C: AuxiliaryObserver, E: Send>(
        &self,
        auxiliary: &C,
        blocks: Range<u64>,
        threads: usize,
        stops: Stops<'_>,
        mut deliver: impl FnMut(Delivered<C::Sums>) -> Result<ControlFlow<()>, E> + Send,
    ) -> Result<u64, E> {
        let count = blocks.end.saturating_sub(blocks.start);
        let size = self.blocks_in_flight(count, threads);
        let make = |flight: u64| {
            let first = blocks.start + flight * size;
            self.flight_with_auxiliary(first..blocks.end.min(first + size), auxiliary, stops.halt)
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

/// Two flags by which a caller ends a run.
#[derive(Clone, Copy, Debug)]
pub struct Stops<'a> {
    /// If this flag is set, no more blocks are begun, and unfinished ones are completed.
    pub stop: &'a AtomicBool,
    /// If this flag is set, unfinished blocks are given up.
    pub halt: &'a AtomicBool,
}

/// A simulated block, as delivered.
#[derive(Clone, Debug)]
pub struct Delivered<S> {
    /// The number of the block.
    pub index: u64,
    /// The result of the block.
    pub result: BlockResult,
    /// The sums of the auxiliary.
    pub auxiliary_sums: S,
}
