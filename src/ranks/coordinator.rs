//! Rank 0: lends, takes back, and hands what comes to the run in order.

use super::lease::{self, Errand, Manner, Parcel, Simulator, Stretch};
use super::message::{Kind, Nap, Received, abort, receive, receive_from, send};
use super::settling::Settling;
use super::snapshots::{Counted, Snapshots};
use crate::engine::{Crew, Deliver, Portion, RunError, Work};
use crate::ensemble::{Delivered, Leases, Plan};
use crate::stats::{BlockResult, Counts, Damaged};
use crate::store::Question;
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
        let manner = Manner { threads: *threads, has_goals: !asked.goals.is_empty() };
        let question = Question { scenario: (*scenario).clone(), asked: (*asked).clone(), note: String::new() };
        let outlet = work.outlet.clone().unwrap_or_default();
        let errand = Errand { question, manner, outlet }.to_bytes();
        (1..self.ranks).for_each(|rank| send(rank, Kind::Run, &errand));
        let snapshots = &Snapshots::default();
        let (own_leases, to_do) = channel();
        let (done, parcels) = channel();
        thread::scope(|scope| {
            // Gone with this closure, so that the thread below ends.
            let own_leases = own_leases;
            scope.spawn(move || {
                let mut simulator = Simulator::new(plan, manner, *stops, snapshots);
                for lease in to_do {
                    // Nobody listens any more where the run has failed.
                    let _ = done.send(simulator.simulate(lease));
                }
            });
            let mut desk = Desk {
                plan,
                ranks: self.ranks,
                has_goals: manner.has_goals,
                own_leases,
                last_order: None,
                settling: Settling::new(plan, self.ranks),
                deliver,
                delivered: 0,
                has_enough: false,
                is_cut: false,
            };
            let mut leases = Leases::new(work.blocks.clone(), &vec![*threads; self.ranks]);
            let (mut nap, mut halted) = (Nap::default(), None::<Instant>);
            loop {
                let is_stopped = stops.stop.load(Ordering::Relaxed);
                desk.tell(is_stopped, stops.halt.load(Ordering::Relaxed));
                if !desk.is_cut && !is_stopped {
                    desk.lend(&mut leases);
                }
                let is_waiting = leases.on_loan() > 0 || !desk.settling.is_empty();
                let own = parcels.recv_timeout(if is_waiting { nap.next() } else { Duration::ZERO }).ok();
                let come = match own {
                    // Rank 0 keeps no log of its own here, so that nothing can fail.
                    Some(parcel) => parcel.ok().map(|parcel| Answer::Parcel(0, parcel)),
                    None => Answer::receive(plan, &leases),
                };
                if come.is_some() {
                    nap = Nap::default();
                }
                match come {
                    Some(Answer::Parcel(rank, parcel)) => {
                        let start = Instant::now();
                        let Parcel { done, seconds, rows, ref lease, .. } = parcel;
                        leases.take_back(rank, lease.start, done, seconds, rows, parcel);
                        desk.hand_on(&mut leases)?;
                        leases.took(start.elapsed().as_secs_f64());
                    }
                    Some(Answer::Counted(counted)) => desk.settle(counted.map(|counted| *counted))?,
                    Some(Answer::Failed(reason)) => {
                        return Err(RunError::Sink { error: reason.into(), outcome: None });
                    }
                    None => {}
                }
                let is_over = leases.is_done() || desk.is_cut || stops.stop.load(Ordering::Relaxed);
                let is_last = is_over && leases.on_loan() == 0;
                if let Some(end) = desk.settling.ask(is_last) {
                    let question = lease::to_bytes(&(0..end));
                    (1..self.ranks).for_each(|rank| send(rank, Kind::Count, &question));
                    desk.settle(snapshots.before(end))?;
                }
                if is_last && desk.settling.is_empty() {
                    return Ok(desk.delivered);
                }
                if stops.halt.load(Ordering::Relaxed) {
                    let since = *halted.get_or_insert_with(Instant::now);
                    if since.elapsed() > PATIENCE {
                        self.has_lost.store(true, Ordering::Relaxed);
                        return Ok(desk.delivered);
                    }
                }
            }
        })
    }

    fn threads(&self, of_one: usize) -> usize {
        of_one * self.ranks
    }
}

/// What a rank has sent.
enum Answer {
    /// Its number, and a lease that it has done.
    Parcel(usize, Parcel),
    /// What it has done of the blocks that it was asked about, if anything.
    Counted(Option<Box<Counted>>),
    /// Why it cannot go on.
    Failed(String),
}

impl Answer {
    /// The next one, if one has come.
    fn receive(plan: &Plan, leases: &Leases<Parcel>) -> Option<Answer> {
        let Received { kind, from, bytes } = receive_from(leases.only().filter(|&rank| rank > 0))?;
        let refuse = |damaged: Damaged| -> ! { panic!("what rank {from} has sent: {damaged}") };
        match kind {
            Kind::Parcel => {
                Some(Answer::Parcel(from, Parcel::of_bytes(&bytes).unwrap_or_else(|damaged| refuse(damaged))))
            }
            Kind::Counts if bytes.is_empty() => Some(Answer::Counted(None)),
            Kind::Counts => {
                let empty = Counts::empty(plan.model(), plan.timeline());
                let counted = Counted::of_bytes(&bytes, empty).unwrap_or_else(|damaged| refuse(damaged));
                Some(Answer::Counted(Some(Box::new(counted))))
            }
            Kind::Failed => Some(Answer::Failed(String::from_utf8_lossy(&bytes).into_owned())),
            _ => None,
        }
    }
}

/// What lies between the leases, the ranks and the run.
struct Desk<'a, 'd> {
    plan: &'a Plan,
    ranks: usize,
    has_goals: bool,
    own_leases: Sender<std::ops::Range<u64>>,
    /// What the ranks were told last: to stop, or to halt.
    last_order: Option<Kind>,
    settling: Settling<'a>,
    deliver: &'a mut Deliver<'d>,
    /// Blocks that were delivered.
    delivered: u64,
    /// Whether the run wants no more.
    has_enough: bool,
    /// Whether no block is handed on any more: the run has enough, or a lease was cut.
    is_cut: bool,
}

impl Desk<'_, '_> {
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

    /// Hand on what is in turn: to the run where it has goals, and otherwise to where blocks wait
    /// for their counts.
    fn hand_on(&mut self, leases: &mut Leases<Parcel>) -> Result<(), RunError> {
        while !self.is_cut {
            let Some(parcel) = leases.in_turn() else { break };
            let damaged = |damaged: Damaged| panic!("the parcel of blocks {:?}: {damaged}", parcel.lease);
            for stretch in parcel.stretches(self.plan).unwrap_or_else(damaged) {
                match self.has_goals {
                    true => self.deliver_blocks(stretch)?,
                    false => self.settling.add(stretch, parcel.rows)?,
                }
            }
            // A lease that was cut is the last one.
            if parcel.done < parcel.lease.end - parcel.lease.start {
                self.is_cut = true;
            }
        }
        Ok(())
    }

    /// Deliver a stretch of one block with its own counts.
    fn deliver_blocks(&mut self, stretch: Stretch) -> Result<(), RunError> {
        let Stretch { blocks, results, totals } = stretch;
        for (index, result) in blocks.zip(results) {
            let result = BlockResult { totals: totals.totals(), ..result };
            self.deliver(Portion::Block(Box::new(Delivered { index, result, beside: () })))?;
        }
        Ok(())
    }

    /// Take the counts of a rank, and deliver the blocks that they were the last missing piece of.
    fn settle(&mut self, counted: Option<Counted>) -> Result<(), RunError> {
        match self.settling.take(counted) {
            Some(portion) => self.deliver(portion),
            None => Ok(()),
        }
    }

    /// Deliver a portion, unless the run has enough.
    fn deliver(&mut self, portion: Portion) -> Result<(), RunError> {
        if self.has_enough {
            return Ok(());
        }
        self.delivered += portion.blocks();
        self.has_enough = (self.deliver)(portion)?.is_break();
        self.is_cut |= self.has_enough;
        Ok(())
    }
}
