//! Leases of blocks to workers that are reached by messages, and the results of these leases, put
//! in order. A lease is a sequence of neighbouring blocks that one worker simulates.
//!
//! A lease ends at the end of a large node of the tree of sums, so that its sums are few nodes. It
//! lasts long enough for the coordinator, who gives leases and takes back results, to be idle most
//! of the time. Leases become shorter towards the end of the run, so that all workers end together.

use std::collections::BTreeMap;
use std::ops::Range;

/// The usual duration of a lease, in seconds.
const USUAL: f64 = 1.0;

/// The longest duration of a lease, in seconds. The work of unfinished leases is lost in a crash.
const LONGEST: f64 = 60.0;

/// The shortest duration of a lease, in seconds, when few blocks are left. Since a worker has up to
/// two leases, workers may end apart by twice this time.
const SHORTEST: f64 = 0.1;

/// Except near the end of the run, and up to the longest duration, a lease lasts at least this many
/// times as long as it takes to take back one result from every worker. The coordinator is then
/// idle for five sixths of the time.
const PATIENCE: f64 = 6.0;

/// Number of leases that a worker has at a time. With two of them, the next lease begins when the
/// last one ends, without waiting for a message.
const AHEAD: usize = 2;

/// A lease is at most this part of what its worker would get if all blocks that are left were
/// shared out by speed.
const LAST: f64 = 0.25;

/// The most bytes of rows that a result should have.
const PARCEL: f64 = 64e6;

/// When this many bytes of rows wait for the result of an earlier lease, only that result is taken
/// back.
const WAITING: usize = 1 << 30;

/// Weight of the latest measurement in a running mean.
const NEWEST: f64 = 0.3;

/// The leases of the blocks of one run. `P`, a parcel, is the result of a lease.
#[derive(Debug)]
pub struct Leases<P> {
    /// The first block that no lease has contained yet.
    next: u64,
    end: u64,
    /// The first block whose parcel has not been delivered in order.
    turn: u64,
    workers: Vec<Worker>,
    /// The worker of each unfinished lease, by the first block of the lease.
    lent: BTreeMap<u64, usize>,
    waiting: BTreeMap<u64, Waiting<P>>,
    /// Number of bytes of the rows in `waiting`.
    bytes: usize,
    /// Seconds that it takes the coordinator to take back a parcel, as a running mean.
    handling: f64,
    /// Number of bytes of the rows of one block, on average over the lease that came back last.
    rows: f64,
}

#[derive(Debug)]
struct Waiting<P> {
    end: u64,
    rows: usize,
    parcel: P,
}

#[derive(Clone, Debug)]
struct Worker {
    threads: u64,
    /// Blocks per second, as a running mean; `None` before the first measurement.
    rate: Option<f64>,
    leases: usize,
}

impl<P> Leases<P> {
    /// The leases of these blocks, for one worker per element of `threads`, with that many threads.
    pub fn new(blocks: Range<u64>, threads: &[usize]) -> Self {
        let worker = |&threads: &usize| Worker { threads: threads.max(1) as u64, rate: None, leases: 0 };
        Leases {
            next: blocks.start,
            end: blocks.end,
            turn: blocks.start,
            workers: threads.iter().map(worker).collect(),
            lent: BTreeMap::new(),
            waiting: BTreeMap::new(),
            bytes: 0,
            handling: 0.0,
            rows: 0.0,
        }
    }

    /// Give the next lease to this worker. Returns `None` if the worker has as many leases as it
    /// may have, or if no block is left.
    pub fn lend(&mut self, worker: usize) -> Option<Range<u64>> {
        if self.next >= self.end || self.workers[worker].leases >= AHEAD {
            return None;
        }
        let wanted = self.wanted(worker);
        let start = self.next;
        let node = 1 << (wanted / 2).max(1).ilog2();
        // The lease has at least half of the wanted blocks, and ends at a node of this size.
        let end = (start + wanted).min(self.end);
        let end = if end == self.end { end } else { (end / node * node).max(start + 1) };
        self.workers[worker].leases += 1;
        self.lent.insert(start, worker);
        self.next = end;
        Some(start..end)
    }

    /// The number of blocks that this worker should get now.
    fn wanted(&self, worker: usize) -> u64 {
        let Worker { threads, rate, .. } = self.workers[worker];
        let Some(rate) = rate else { return threads };
        let time = (self.handling * PATIENCE * self.workers.len() as f64).clamp(USUAL, LONGEST);
        let all: f64 = self.workers.iter().filter_map(|worker| worker.rate).sum();
        let left = ((self.end - self.next) as f64 * LAST * rate / all.max(rate)).max(rate * SHORTEST);
        ((rate * time).min(left).min(PARCEL / self.rows.max(1.0)) as u64).max(threads)
    }

    /// Take back a lease that begins at block `start`. The worker has done its first `done` blocks,
    /// in this many seconds, and their rows have this many bytes. The other blocks of the lease are
    /// not done.
    pub fn take_back(&mut self, worker: usize, start: u64, done: u64, seconds: f64, rows: usize, parcel: P) {
        let from = &mut self.workers[worker];
        from.leases = from.leases.saturating_sub(1);
        if done > 0 && seconds > 0.0 {
            let now = done as f64 / seconds;
            from.rate = Some(from.rate.map_or(now, |rate| rate + NEWEST * (now - rate)));
        }
        if done > 0 {
            self.rows = rows as f64 / done as f64;
        }
        self.lent.remove(&start);
        self.bytes += rows;
        self.waiting.insert(start, Waiting { end: start + done, rows, parcel });
    }

    /// The next parcel in the order of the blocks, if it has come back.
    pub fn in_turn(&mut self) -> Option<P> {
        let Waiting { end, rows, parcel } = self.waiting.remove(&self.turn)?;
        self.bytes -= rows;
        self.turn = end;
        Some(parcel)
    }

    /// The only worker whose parcel may be taken back now, if so many rows wait for it that there
    /// is no memory for those of others.
    pub fn only(&self) -> Option<usize> {
        if self.bytes < WAITING { None } else { self.lent.get(&self.turn).copied() }
    }

    /// State how many seconds it took to take back a parcel.
    pub fn took(&mut self, seconds: f64) {
        let weight = if self.handling == 0.0 { 1.0 } else { NEWEST };
        self.handling += weight * (seconds - self.handling);
    }

    /// Whether the parcels of all blocks were delivered in order.
    pub fn is_done(&self) -> bool {
        self.turn >= self.end
    }

    /// Number of leases that have not come back.
    pub fn on_loan(&self) -> usize {
        self.workers.iter().map(|worker| worker.leases).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Simulate workers of these rates, in blocks per second, until all blocks have come back in
    /// order. Returns the time at which each worker has ended, and the leases in the order of their
    /// blocks.
    fn simulate(end: u64, rates: &[f64], handling: f64) -> (Vec<f64>, Vec<Range<u64>>) {
        let mut leases = Leases::new(0..end, &vec![1; rates.len()]);
        let mut queues: Vec<Vec<(f64, Range<u64>)>> = vec![Vec::new(); rates.len()];
        let (mut ends, mut in_order) = (vec![0.0; rates.len()], Vec::new());
        let mut now = 0.0;
        while !leases.is_done() {
            for (worker, queue) in queues.iter_mut().enumerate() {
                while let Some(lease) = leases.lend(worker) {
                    let start = queue.last().map_or(now, |(end, _)| *end);
                    queue.push((start + (lease.end - lease.start) as f64 / rates[worker], lease));
                }
            }
            let first = |queue: &Vec<(f64, Range<u64>)>| queue.first().map_or(f64::INFINITY, |(end, _)| *end);
            let soonest = (0..rates.len()).min_by(|&a, &b| first(&queues[a]).total_cmp(&first(&queues[b])));
            let worker = soonest.expect("there are workers");
            let (end, lease) = queues[worker].remove(0);
            (now, ends[worker]) = (end, end);
            let done = lease.end - lease.start;
            leases.take_back(worker, lease.start, done, done as f64 / rates[worker], 16_000 * done as usize, lease);
            leases.took(handling);
            while let Some(lease) = leases.in_turn() {
                in_order.push(lease);
            }
        }
        assert_eq!(leases.on_loan(), 0);
        (ends, in_order)
    }

    proptest! {
        /// No block is left out and none is done twice, whatever the speeds of the workers.
        #[test]
        fn every_block_comes_back_once_and_in_order(
            end in 1_u64..100_000,
            rates in prop::collection::vec(0.5..1000.0f64, 1..40),
            handling in 0.0..0.1f64,
        ) {
            let (_, leases) = simulate(end, &rates, handling);
            prop_assert_eq!((leases[0].start, leases[leases.len() - 1].end), (0, end));
            prop_assert!(leases.windows(2).all(|pair| pair[0].end == pair[1].start));
            prop_assert!(leases.iter().all(|lease| lease.start < lease.end));
        }
    }

    /// Eight workers, of which one is four times slower than the others, end within 0.5 s of each
    /// other, and the whole takes less than 2 % more than the ideal time. A lease consists of one
    /// node or of few.
    #[test]
    fn unequal_workers_end_together() {
        let rates = [400.0, 400.0, 400.0, 400.0, 400.0, 400.0, 400.0, 100.0];
        let (ends, leases) = simulate(100_000, &rates, 1e-4);
        let (first, last) =
            (ends.iter().copied().fold(f64::INFINITY, f64::min), ends.iter().copied().fold(0.0, f64::max));
        assert!(last - first < 0.5, "{ends:?}");
        let ideal = 100_000.0 / rates.iter().sum::<f64>();
        assert!(last < 1.02 * ideal, "{last} {ideal}");
        let typical = &leases[leases.len() / 2];
        let size = typical.end - typical.start;
        assert!(size >= 16 && typical.end % (size / 4).next_power_of_two() == 0, "{typical:?}");
    }

    /// Parcels that wait for a late worker do not fill the memory: only its parcel is then taken
    /// back.
    #[test]
    fn a_late_worker_is_waited_for() {
        let mut leases: Leases<()> = Leases::new(0..1000, &[1; 3]);
        let first = leases.lend(0).expect("the first");
        for _ in 0..2 {
            assert_eq!(leases.only(), None);
            let lease = leases.lend(1).expect("more");
            leases.take_back(1, lease.start, lease.end - lease.start, 1.0, 1 << 29, ());
        }
        assert_eq!(leases.only(), Some(0));
        leases.take_back(0, first.start, first.end - first.start, 1.0, 0, ());
        while leases.in_turn().is_some() {}
        assert_eq!(leases.only(), None);
    }

    /// A coordinator that needs 10 ms for a parcel has a hundred workers. Leases then last for
    /// seconds, and the coordinator is busy for 5 % to 30 % of the time.
    #[test]
    fn leases_grow_with_what_it_takes_to_take_them_back() {
        let (workers, rate, handling) = (100, 10.0, 0.01);
        let (ends, leases) = simulate(600_000, &vec![rate; workers], handling);
        let last = ends.iter().copied().fold(0.0, f64::max);
        let busy = leases.len() as f64 * handling / last;
        assert!((0.05..0.3).contains(&busy), "busy for {busy} of the time with {} leases in {last} s", leases.len());
    }
}
