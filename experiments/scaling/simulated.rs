//! Simulates the protocol of the ranks by a queue of events and a clock.

use super::leases::Leases;
use super::measured::Costs;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::ops::Range;

/// Bytes that rank 0 can receive in a second: a usual network of 100 Gbit/s.
const NETWORK: f64 = 12.5e9;
/// The longest time in seconds until a message is noticed, which is how long a waiting rank sleeps.
const NOTICED: f64 = 0.02;

/// Rank 0 asks all ranks for their counts once a second, or less often if that takes more than one
/// part in twenty of its time (`mpi/src/settling.rs`).
const COUNTED: [f64; 2] = [1.0, 20.0];

/// A machine with ranks of one thread each.
pub struct Machine<'a> {
    pub ranks: usize,
    pub costs: &'a Costs,
}

pub struct Outcome {
    /// How long the run took, in seconds.
    pub seconds: f64,
    /// How long rank 0 was busy, in seconds.
    pub busy: f64,
    /// The length of a lease in the middle of the run, in seconds.
    pub lease: f64,
    pub bytes: f64,
}

/// A time in whole nanoseconds, which can be ordered. Times are not negative.
fn at(seconds: f64) -> u64 {
    (seconds * 1e9) as u64
}

pub fn simulate(paths: u64, machine: &Machine) -> Outcome {
    let Machine { ranks, costs } = machine;
    let blocks = paths.div_ceil(256);
    let block = costs.block + costs.rows.map_or(0.0, |rows| rows.logged);
    let counts = *ranks as f64 * (costs.counts.joined + costs.counts.bytes / NETWORK);
    let mut next_counts = COUNTED[0];
    let mut leases: Leases<()> = Leases::new(0..blocks, &vec![1; *ranks]);
    // The leases of each rank, of which the first is in work; and the times at which the first one
    // of each rank is done and noticed.
    let mut queues: Vec<VecDeque<Range<u64>>> = vec![VecDeque::new(); *ranks];
    let mut free = vec![0.0_f64; *ranks];
    let mut events = BinaryHeap::new();
    // Ranks are not equally fast: some are slower by up to 5 %.
    let speed = |rank: usize| 1.0 + 0.05 * ((rank * 7919) % 997) as f64 / 997.0;
    let mut outcome = Outcome { seconds: 0.0, busy: 0.0, lease: 0.0, bytes: 0.0 };
    let mut desk = 0.0_f64;
    // The ranks that may get a lease.
    let mut idle: Vec<usize> = (0..*ranks).collect();
    loop {
        idle.retain(|&rank| {
            while let Some(lease) = leases.lend(rank) {
                let length = (lease.end - lease.start) as f64 * block * speed(rank);
                free[rank] = free[rank].max(desk) + length;
                if lease.start <= blocks / 2 && blocks / 2 < lease.end {
                    outcome.lease = length;
                }
                events.push(Reverse((at(free[rank] + NOTICED / 2.0), rank)));
                queues[rank].push_back(lease);
            }
            queues[rank].is_empty() && !leases.is_done()
        });
        let Some(Reverse((time, rank))) = events.pop() else { break };
        let Some(lease) = queues[rank].pop_front() else { break };
        idle.push(rank);
        let done = lease.end - lease.start;
        let seconds = costs.sums.joined + costs.sums.bytes / NETWORK;
        // Rank 0 takes messages one after the other.
        desk = desk.max(time as f64 / 1e9) + seconds;
        outcome.busy += seconds;
        outcome.bytes += costs.sums.bytes;
        leases.take_back(rank, lease.start, done, done as f64 * block * speed(rank), 0, ());
        leases.took(seconds);
        while leases.in_turn().is_some() {}
        if desk >= next_counts || leases.is_done() {
            desk += counts;
            outcome.busy += counts;
            outcome.bytes += costs.counts.bytes * *ranks as f64;
            next_counts = desk + COUNTED[0].max(COUNTED[1] * counts);
        }
    }
    outcome.seconds = desk;
    outcome
}
