//! The command `mc` as one of several processes that make one run, on one machine or on many, by
//! MPI. It is the command of the package `stick-slip`, which gets a
//! [`Crew`](stick_slip::engine::Crew).
//!
//! Rank 0 is the coordinator: only it reads arguments and files, and prints. It gives leases to all
//! ranks, among them its own threads ([`leases::Leases`]). A lease is a sequence of
//! neighbouring blocks that one rank simulates. What comes back with a lease are rows and nodes of
//! the tree of sums, which rank 0 puts in order. The other ranks are workers; they know only what
//! messages tell them.
//!
//! ```text
//! coordinator -> worker   Run     scenario, seed and what else is asked, as a saved run keeps it
//!                         Lease   the first block, and the block after the last one
//!                         Stop    begin no more blocks
//!                         Halt    give up the blocks that are being simulated
//!                         Count   send the counts of your blocks before this one
//!                         End     the program is over
//! worker -> coordinator   Parcel  a lease: the sums of its blocks, and rows of its paths unless
//!                                 they are in a log of the rank
//!                         Counts  the answer to Count, with a receipt for the log
//!                         Failed  why the rank cannot go on
//!                         End     the answer to End
//! ```
//!
//! A rank that waits looks for messages again and again, and sleeps in between, for 1 ms at first
//! and for 20 ms at most. If a rank panics, its message is printed and all ranks end. If a rank is
//! lost, MPI itself ends the others.

#[path = "../../src/cli/mod.rs"]
mod cli;
mod coordinator;
mod lease;
mod leases;
mod message;
mod settling;
mod snapshots;
mod worker;

use coordinator::Coordinator;
use mpi::Threading;
use mpi::environment::Universe;
use mpi::traits::*;
use std::process::ExitCode;
use stick_slip::engine::Crew;

/// Environment variables by which launchers tell a process that it is one of several: those of Open
/// MPI, of MPICH and its relatives, and of PMIx (Slurm).
const LAUNCHED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"];

/// The role of this process among the ranks.
enum Place {
    /// Rank 0. It runs the program as a single process would, and can have the other ranks
    /// simulate.
    First(Coordinator),
    /// Another rank. It has served rank 0 until the program was over; this is its exit code.
    Other(ExitCode),
}

/// Calls the command on the first rank only, however many ranks there are.
fn main() -> ExitCode {
    // MPI ends when the first of these values is dropped.
    let Some((_universe, place)) = join() else { return cli::main(None) };
    match place {
        Place::Other(code) => code,
        Place::First(coordinator) => {
            let coordinator: &'static Coordinator = Box::leak(Box::new(coordinator));
            let code = cli::main(Some(coordinator));
            coordinator.end();
            code
        }
    }
}

impl cli::Ranks for Coordinator {
    fn crew(&self) -> Option<&dyn Crew> {
        (self.ranks() > 1).then_some(self as &dyn Crew)
    }

    fn threads(&self, usable: usize) -> usize {
        Coordinator::threads(self, usable)
    }
}

/// Join the other ranks if a launcher has started several. Returns `None` if there is no launcher,
/// or if MPI cannot be initialised. On a rank other than 0 this function returns only when the
/// program is over.
fn join() -> Option<(Universe, Place)> {
    if LAUNCHED.iter().all(|name| std::env::var_os(name).is_none()) {
        return None;
    }
    let (universe, _) = mpi::initialize_with_threading(Threading::Serialized)?;
    let world = universe.world();
    if world.size() < 2 {
        return Some((universe, Place::First(Coordinator::alone())));
    }
    abort_on_panic();
    let here = world.split_shared(0).size();
    let place = match world.rank() {
        0 => Place::First(Coordinator::new(world.size() as usize, here as usize)),
        _ => Place::Other(worker::serve()),
    };
    Some((universe, place))
}

/// End all ranks after a panic of this one; the others would wait for it forever.
fn abort_on_panic() {
    let say = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        say(panic);
        message::abort();
    }));
}
