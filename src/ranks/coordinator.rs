//! Rank 0: lends, takes back, and hands what comes to the run in order.

use super::lease::{self, Errand, Manner, Parcel};
use super::message::{Kind, Nap, Received, abort, receive, receive_from, send};
use crate::engine::{Crew, Deliver, RunError, Work};
use crate::ensemble::{Leases, Plan};
use crate::stats::Damaged;
use crate::store::Question;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// How long ranks that were told to give up may take to say so: much longer than they do. One that
/// is lost never does.
const PATIENCE: Duration = Duration::from_secs(3);

/// Several ranks, of which this process is the first.
#[derive(Debug)]
pub struct Coordinator {
    ranks: usize,
    /// Ranks on this machine.
    here: usize,
    /// Whether a rank did not answer.
    has_lost: AtomicBool,
}

impl Coordinator {
    pub(super) fn new(ranks: usize, here: usize) -> Self {
        Coordinator { ranks, here, has_lost: AtomicBool::new(false) }
    }

    /// One rank is what a process is without MPI.
    pub(super) fn alone() -> Self {
        Coordinator::new(1, 1)
    }

    /// How many ranks there are, this one included.
    pub fn ranks(&self) -> usize {
        self.ranks
    }

    /// Threads for each rank, where nobody says: those that this one may use, shared with the
    /// others on this machine unless each has processors of its own.
    pub fn threads(&self, usable: usize) -> usize {
        let is_bound = processors().is_some_and(|all| usable < all);
        if is_bound { usable } else { (usable / self.here).max(1) }
    }

    /// Tell all ranks that the program is over, and wait until they have heard it. Where one is
    /// lost, all are ended at once.
    pub fn end(&self) {
        if self.has_lost.load(Ordering::Relaxed) {
            abort();
        }
        (1..self.ranks).for_each(|rank| send(rank, Kind::End, &[]));
        let (start, mut nap, mut left) = (Instant::now(), Nap::default(), self.ranks - 1);
        while left > 0 {
            match receive() {
                Some(Received { kind: Kind::End, .. }) => left -= 1,
                // A parcel that nobody waits for any more.
                Some(_) => nap = Nap::default(),
                None if start.elapsed() > PATIENCE => abort(),
                None => thread::sleep(nap.next()),
            }
        }
    }
}

/// Processors of this machine, if it says.
fn processors() -> Option<usize> {
    let text = std::fs::read_to_string("/sys/devices/system/cpu/online").ok()?;
    let count = |range: &str| -> Option<usize> {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        Some(last.parse::<usize>().ok()? + 1 - first.parse::<usize>().ok()?)
    };
    text.trim().split(',').map(count).sum()
}

impl Crew for Coordinator {
    fn simulate(&self, work: &Work<'_>, deliver: &mut Deliver<'_>) -> Result<u64, RunError> {
        let Work { scenario, asked, plan, threads, stops, .. } = work;
        // A goal may be reached after any block.
        let grain = if asked.goals.is_empty() { u64::MAX } else { 1 };
        let manner = Manner { threads: *threads, grain };
        let question = Question { scenario: (*scenario).clone(), asked: (*asked).clone(), note: String::new() };
        let errand = Errand { question, manner }.to_bytes();
        (1..self.ranks).for_each(|rank| send(rank, Kind::Run, &errand));
        let (own_leases, to_do) = channel();
        let (done, parcels) = channel();
        thread::scope(|scope| {
            // Gone with this closure, so that the thread below ends.
            let own_leases = own_leases;
            scope.spawn(move || {
                for lease in to_do {
                    // Nobody listens any more where the run has failed.
                    let _ = done.send(lease::simulate(plan, lease, manner, *stops));
                }
            });
            let mut desk = Desk { ranks: self.ranks, own_leases, last_order: None, flow: ControlFlow::Continue(()) };
            let mut leases = Leases::new(work.blocks.clone(), &vec![*threads; self.ranks]);
            let (mut delivered, mut nap, mut halted) = (0, Nap::default(), None::<Instant>);
            loop {
                desk.tell(stops.stop.load(Ordering::Relaxed), stops.halt.load(Ordering::Relaxed));
                if desk.flow.is_continue() && !stops.stop.load(Ordering::Relaxed) {
                    desk.lend(&mut leases);
                }
                let own = parcels.recv_timeout(if leases.on_loan() > 0 { nap.next() } else { Duration::ZERO }).ok();
                let own = own.map(|parcel| (0, Ok(parcel)));
                let come = own.or_else(|| {
                    let message = receive_from(leases.only().filter(|&rank| rank > 0));
                    let Received { from, bytes, .. } = message.filter(|message| message.kind == Kind::Parcel)?;
                    Some((from, Parcel::of_bytes(&bytes)))
                });
                if let Some((rank, parcel)) = come {
                    let start = Instant::now();
                    let parcel = parcel.unwrap_or_else(|damaged| panic!("the parcel of rank {rank}: {damaged}"));
                    let Parcel { done, seconds, rows, ref lease, .. } = parcel;
                    leases.take_back(rank, lease.start, done, seconds, rows, parcel);
                    delivered += desk.hand_on(&mut leases, plan, deliver)?;
                    leases.took(start.elapsed().as_secs_f64());
                    nap = Nap::default();
                }
                let is_over = leases.is_done() || desk.flow.is_break() || stops.stop.load(Ordering::Relaxed);
                if is_over && leases.on_loan() == 0 {
                    return Ok(delivered);
                }
                if stops.halt.load(Ordering::Relaxed) {
                    let since = *halted.get_or_insert_with(Instant::now);
                    if since.elapsed() > PATIENCE {
                        self.has_lost.store(true, Ordering::Relaxed);
                        return Ok(delivered);
                    }
                }
            }
        })
    }

    fn threads(&self, of_one: usize) -> usize {
        of_one * self.ranks
    }
}

/// What lies between the leases and the ranks.
struct Desk {
    ranks: usize,
    own_leases: Sender<std::ops::Range<u64>>,
    /// What the ranks were told last: to stop, or to halt.
    last_order: Option<Kind>,
    /// Whether more is wanted.
    flow: ControlFlow<()>,
}

impl Desk {
    /// Pass on what this process is told.
    fn tell(&mut self, stop: bool, halt: bool) {
        let now = if halt { Some(Kind::Halt) } else { stop.then_some(Kind::Stop) };
        if now.is_some() && now != self.last_order {
            (1..self.ranks).for_each(|rank| now.into_iter().for_each(|kind| send(rank, kind, &[])));
            self.last_order = now;
        }
    }

    /// Lend to whoever has too little to do.
    fn lend(&self, leases: &mut Leases<Parcel>) {
        for rank in 0..self.ranks {
            while let Some(lease) = leases.lend(rank) {
                match rank {
                    // The thread is there as long as this.
                    0 => drop(self.own_leases.send(lease)),
                    _ => send(rank, Kind::Lease, &lease::to_bytes(&lease)),
                }
            }
        }
    }

    /// Hand on what is in turn; returns the number of blocks.
    fn hand_on(
        &mut self,
        leases: &mut Leases<Parcel>,
        plan: &Plan,
        deliver: &mut Deliver<'_>,
    ) -> Result<u64, RunError> {
        let mut delivered = 0;
        while self.flow.is_continue() {
            let Some(parcel) = leases.in_turn() else { break };
            let damaged = |damaged: Damaged| panic!("the parcel of blocks {:?}: {damaged}", parcel.lease);
            for portion in parcel.portions(plan).unwrap_or_else(damaged) {
                delivered += portion.blocks();
                self.flow = deliver(portion)?;
                if self.flow.is_break() {
                    break;
                }
            }
            // A lease that was cut is the last one.
            if parcel.done < parcel.lease.end - parcel.lease.start {
                self.flow = ControlFlow::Break(());
            }
        }
        Ok(delivered)
    }
}
