//! Runs of blocks on loan to workers that are far away, and what comes back, put in order.
//!
//! A lease ends where a large node of the tree of sums does, so that its sums are few nodes. It
//! lasts long enough for whoever hands out and takes back to be idle most of the time, and less
//! towards the end of the work, so that all workers end together.

use std::collections::BTreeMap;
use std::ops::Range;

/// How long a lease is to take, in seconds.
const USUAL: f64 = 1.0;

/// The longest that it may take: what is on loan is lost in a crash.
const LONGEST: f64 = 60.0;

/// The shortest, when little is left: by twice as much may workers end apart.
const SHORTEST: f64 = 0.1;

/// Leases last so many times as long as taking back one from every worker takes, so that five parts
/// in six of the time nothing waits to be taken back.
const PATIENCE: f64 = 6.0;

/// Leases of a worker at a time: the next one begins when the last one ends, and not when an answer
/// has come.
const AHEAD: usize = 2;

/// A worker gets at most this share of its share of what is left.
const LAST: f64 = 0.25;

/// Bytes of rows that a parcel is to have at most.
const PARCEL: f64 = 64e6;

/// Bytes of rows that may wait for an earlier parcel before only that one is asked for.
const WAITING: usize = 1 << 30;

/// Weight of the newest measurement in a running mean.
const NEWEST: f64 = 0.3;

/// The blocks of a run on loan. `P` is what comes back with a lease.
#[derive(Debug)]
pub struct Leases<P> {
    /// The first block that nobody has.
    next: u64,
    end: u64,
    /// The first block that is not taken back in order.
    turn: u64,
    workers: Vec<Worker>,
    /// Whose lease begins where.
    lent: BTreeMap<u64, usize>,
    waiting: BTreeMap<u64, Waiting<P>>,
    /// Bytes of rows that wait.
    bytes: usize,
    /// Seconds that it takes to take back a parcel.
    handling: f64,
    /// Bytes of the rows of a block.
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
    /// Blocks a second, once that is known.
    rate: Option<f64>,
    leases: usize,
}

impl<P> Leases<P> {
    /// Of these blocks, to workers with so many threads each.
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

    /// The next lease of this worker; none while it has enough, and when no block is left.
    pub fn lend(&mut self, worker: usize) -> Option<Range<u64>> {
        if self.next >= self.end || self.workers[worker].leases >= AHEAD {
            return None;
        }
        let wanted = self.wanted(worker);
        let start = self.next;
        let node = 1 << (wanted / 2).max(1).ilog2();
        // At least half of what is wanted, and it ends at a node of that size.
        let end = (start + wanted).min(self.end);
        let end = if end == self.end { end } else { (end / node * node).max(start + 1) };
        self.workers[worker].leases += 1;
        self.lent.insert(start, worker);
        self.next = end;
        Some(start..end)
    }

    /// How many blocks this worker is to have now.
    fn wanted(&self, worker: usize) -> u64 {
        let Worker { threads, rate, .. } = self.workers[worker];
        let Some(rate) = rate else { return threads };
        let time = (self.handling * PATIENCE * self.workers.len() as f64).clamp(USUAL, LONGEST);
        let all: f64 = self.workers.iter().filter_map(|worker| worker.rate).sum();
        let left = ((self.end - self.next) as f64 * LAST * rate / all.max(rate)).max(rate * SHORTEST);
        ((rate * time).min(left).min(PARCEL / self.rows.max(1.0)) as u64).max(threads)
    }

    /// A worker has done the first so many blocks of a lease that begins here, in so many seconds,
    /// and they have so many bytes of rows; the rest of the lease is not done.
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

    /// The parcel whose turn it is, if it is there.
    pub fn in_turn(&mut self) -> Option<P> {
        let Waiting { end, rows, parcel } = self.waiting.remove(&self.turn)?;
        self.bytes -= rows;
        self.turn = end;
        Some(parcel)
    }

    /// The only worker whose parcel may be taken back now: so much waits for it that there is no
    /// room for others.
    pub fn only(&self) -> Option<usize> {
        if self.bytes < WAITING { None } else { self.lent.get(&self.turn).copied() }
    }

    /// It took so many seconds to take back a parcel.
    pub fn took(&mut self, seconds: f64) {
        let weight = if self.handling == 0.0 { 1.0 } else { NEWEST };
        self.handling += weight * (seconds - self.handling);
    }

    /// Whether everything was taken back in order.
    pub fn is_done(&self) -> bool {
        self.turn >= self.end
    }

    /// Leases that are not taken back.
    pub fn on_loan(&self) -> usize {
        self.workers.iter().map(|worker| worker.leases).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Workers of these rates, in blocks a second, until all blocks are back in order; returns when
    /// each worker has ended, and the leases in the order of their blocks.
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
        /// Nothing is left out, nothing is done twice, whoever is how fast.
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

    /// Eight workers, one of them four times as slow: all end within two of the shortest leases of
    /// each other, and no time is lost to speak of. A lease of them is one or few nodes.
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

    /// What waits for a worker that is late does not fill the memory: then only its parcel is asked
    /// for.
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

    /// A coordinator that takes 10 ms for a parcel has a hundred workers: leases grow to seconds,
    /// and it keeps up.
    #[test]
    fn leases_grow_with_what_it_takes_to_take_them_back() {
        let (workers, rate, handling) = (100, 10.0, 0.01);
        let (ends, leases) = simulate(600_000, &vec![rate; workers], handling);
        let last = ends.iter().copied().fold(0.0, f64::max);
        let busy = leases.len() as f64 * handling / last;
        assert!((0.05..0.3).contains(&busy), "busy for {busy} of the time with {} leases in {last} s", leases.len());
    }
}
