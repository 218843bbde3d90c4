//! The part of rank 0: it gives leases to the ranks, takes them back, and delivers their blocks to
//! the run in order.

use super::lease::{self, Instructions, Parcel, RankOptions, Simulator, Stretch};
use super::leases::Leases;
use super::message::{Kind, Pause, Received, abort, receive, receive_from, send};
use super::settling::Settling;
use super::snapshots::{Counted, Snapshots};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread;
use std::time::{Duration, Instant};
use stick_slip::engine::{Crew, Deliver, Portion, RunError, Work};
use stick_slip::ensemble::{Delivered, Plan};
use stick_slip::stats::{BlockResult, Counts};
use stick_slip::store::RunQuestion;
use stick_slip::sums::Damaged;

/// How long to wait for the ranks after they were told to give up their blocks, or that the program
/// is over. They normally need much less; a rank that is lost never answers.
const PATIENCE: Duration = Duration::from_secs(3);

/// Several ranks, of which this process is the first.
#[derive(Debug)]
pub struct Coordinator {
    ranks: usize,
    /// Number of ranks on this machine, this one included.
    here: usize,
    /// Whether a rank has not answered in time.
    has_lost: AtomicBool,
}

impl Coordinator {
    pub(super) fn new(ranks: usize, here: usize) -> Self {
        Coordinator { ranks, here, has_lost: AtomicBool::new(false) }
    }

    /// The coordinator of a single rank, which has no others to send to.
    pub(super) fn alone() -> Self {
        Coordinator::new(1, 1)
    }

    /// Number of ranks, this one included.
    pub fn ranks(&self) -> usize {
        self.ranks
    }

    /// Number of threads for each rank if the user does not set it. `usable` is the number of
    /// processors that this rank may use. If these are all processors of the machine, the ranks on
    /// this machine share them; otherwise the launcher has given each rank processors of its own.
    pub fn threads(&self, usable: usize) -> usize {
        let is_bound = processors().is_some_and(|all| usable < all);
        if is_bound { usable } else { (usable / self.here).max(1) }
    }

    /// Tell all ranks that the program is over, and wait until they have answered. If a rank is
    /// lost or does not answer, all ranks are aborted.
    pub fn end(&self) {
        if self.has_lost.load(Ordering::Relaxed) {
            abort();
        }
        (1..self.ranks).for_each(|rank| send(rank, Kind::End, &[]));
        let (start, mut pause, mut left) = (Instant::now(), Pause::default(), self.ranks - 1);
        while left > 0 {
            match receive() {
                Some(Received { kind: Kind::End, .. }) => left -= 1,
                // This message is no longer needed.
                Some(_) => pause = Pause::default(),
                None if start.elapsed() > PATIENCE => abort(),
                None => thread::sleep(pause.next()),
            }
        }
    }
}

/// Number of processors of this machine, if the system states it.
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
        let options = RankOptions { threads: *threads, has_goals: !asked.goals.is_empty() };
        let question = RunQuestion { scenario: (*scenario).clone(), asked: (*asked).clone(), note: String::new() };
        let outlet = work.outlet.clone().unwrap_or_default();
        let instructions = Instructions { question, options, outlet }.to_bytes();
        (1..self.ranks).for_each(|rank| send(rank, Kind::Run, &instructions));
        let snapshots = &Snapshots::default();
        let (own_leases, to_do) = channel();
        let (done, parcels) = channel();
        thread::scope(|scope| {
            // The sender is moved here, so that it is dropped when this closure ends, and the
            // thread below then ends too.
            let own_leases = own_leases;
            scope.spawn(move || {
                let mut simulator = Simulator::new(plan, options, *stops, snapshots);
                for lease in to_do {
                    // An error means that the run has failed, and the parcel is then not needed.
                    let _ = done.send(simulator.simulate(lease));
                }
            });
            let mut dispatcher = Dispatcher {
                plan,
                ranks: self.ranks,
                has_goals: options.has_goals,
                own_leases,
                last_order: None,
                settling: Settling::new(plan, self.ranks),
                deliver,
                delivered: 0,
                has_enough: false,
                is_cut: false,
            };
            let mut leases = Leases::new(work.blocks.clone(), &vec![*threads; self.ranks]);
            let (mut pause, mut halted) = (Pause::default(), None::<Instant>);
            loop {
                let is_stopped = stops.stop.load(Ordering::Relaxed);
                dispatcher.tell(is_stopped, stops.halt.load(Ordering::Relaxed));
                if !dispatcher.is_cut && !is_stopped {
                    dispatcher.lend(&mut leases);
                }
                let is_waiting = leases.on_loan() > 0 || !dispatcher.settling.is_empty();
                let own = parcels.recv_timeout(if is_waiting { pause.next() } else { Duration::ZERO }).ok();
                let come = match own {
                    // Rank 0 simulates without a log here, so its parcels are never errors.
                    Some(parcel) => parcel.ok().map(|parcel| Answer::Parcel(0, parcel)),
                    None => Answer::receive(plan, &leases),
                };
                if come.is_some() {
                    pause = Pause::default();
                }
                match come {
                    Some(Answer::Parcel(rank, parcel)) => {
                        let start = Instant::now();
                        let Parcel { done, seconds, rows, ref lease, .. } = parcel;
                        leases.take_back(rank, lease.start, done, seconds, rows, parcel);
                        dispatcher.hand_on(&mut leases)?;
                        leases.took(start.elapsed().as_secs_f64());
                    }
                    Some(Answer::Counted(counted)) => dispatcher.settle(counted.map(|counted| *counted))?,
                    Some(Answer::Failed(reason)) => {
                        return Err(RunError::Sink { error: reason.into(), outcome: None });
                    }
                    None => {}
                }
                let is_over = leases.is_done() || dispatcher.is_cut || stops.stop.load(Ordering::Relaxed);
                let is_last = is_over && leases.on_loan() == 0;
                if let Some(end) = dispatcher.settling.ask(is_last) {
                    let question = lease::to_bytes(&(0..end));
                    (1..self.ranks).for_each(|rank| send(rank, Kind::Count, &question));
                    dispatcher.settle(snapshots.before(end))?;
                }
                if is_last && dispatcher.settling.is_empty() {
                    return Ok(dispatcher.delivered);
                }
                if stops.halt.load(Ordering::Relaxed) {
                    let since = *halted.get_or_insert_with(Instant::now);
                    if since.elapsed() > PATIENCE {
                        self.has_lost.store(true, Ordering::Relaxed);
                        return Ok(dispatcher.delivered);
                    }
                }
            }
        })
    }

    fn threads(&self, of_one: usize) -> usize {
        of_one * self.ranks
    }
}

/// A message of a rank.
enum Answer {
    /// The number of the rank, and the parcel of a lease that it has simulated.
    Parcel(usize, Parcel),
    /// What the rank has done of the blocks that it was asked about, if it has done any.
    Counted(Option<Box<Counted>>),
    /// The rank cannot go on, for this reason.
    Failed(String),
}

impl Answer {
    /// The next message, if one has come. A message that cannot be read ends all ranks by a panic.
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

/// What rank 0 keeps track of while the ranks simulate: the leases, the blocks that wait, and what
/// was delivered.
struct Dispatcher<'a, 'd> {
    plan: &'a Plan,
    ranks: usize,
    has_goals: bool,
    own_leases: Sender<std::ops::Range<u64>>,
    /// The last order to the ranks: to stop, or to halt.
    last_order: Option<Kind>,
    settling: Settling<'a>,
    deliver: &'a mut Deliver<'d>,
    /// Number of blocks that were delivered.
    delivered: u64,
    /// Whether the run needs no more blocks.
    has_enough: bool,
    /// Whether no later block is delivered, because the run needs no more or because a lease was
    /// not finished.
    is_cut: bool,
}

impl Dispatcher<'_, '_> {
    /// Pass the flags of this process on to the other ranks, when they have changed.
    fn tell(&mut self, stop: bool, halt: bool) {
        let now = if halt { Some(Kind::Halt) } else { stop.then_some(Kind::Stop) };
        if now.is_some() && now != self.last_order {
            (1..self.ranks).for_each(|rank| now.into_iter().for_each(|kind| send(rank, kind, &[])));
            self.last_order = now;
        }
    }

    /// Give leases to every rank that has too few.
    fn lend(&self, leases: &mut Leases<Parcel>) {
        for rank in 0..self.ranks {
            while let Some(lease) = leases.lend(rank) {
                match rank {
                    // Sending cannot fail, because the thread runs as long as `own_leases` exists.
                    0 => drop(self.own_leases.send(lease)),
                    _ => send(rank, Kind::Lease, &lease::to_bytes(&lease)),
                }
            }
        }
    }

    /// Pass on the parcels whose turn it is. With goals their blocks are delivered to the run, and
    /// otherwise they wait for their counts.
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
            // If a lease was not finished, no later block may be delivered.
            if parcel.done < parcel.lease.end - parcel.lease.start {
                self.is_cut = true;
            }
        }
        Ok(())
    }

    /// Deliver a stretch of one block, which has its own counts.
    fn deliver_blocks(&mut self, stretch: Stretch) -> Result<(), RunError> {
        let Stretch { blocks, results, totals } = stretch;
        for (index, result) in blocks.zip(results) {
            let result = BlockResult { totals: totals.totals(), ..result };
            self.deliver(Portion::Block(Box::new(Delivered { index, result, beside: () })))?;
        }
        Ok(())
    }

    /// Take the counts of a rank. If they are the last that were missing, deliver the blocks that
    /// waited for them.
    fn settle(&mut self, counted: Option<Counted>) -> Result<(), RunError> {
        match self.settling.take(counted) {
            Some(portion) => self.deliver(portion),
            None => Ok(()),
        }
    }

    /// Deliver blocks, unless the run needs no more.
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
