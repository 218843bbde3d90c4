//! One run in several processes, on one machine or many, by MPI. The only home of MPI (feature
//! `mpi`).
//!
//! Rank 0 is the coordinator: it alone reads arguments and files, and prints. It lends runs of
//! blocks to all ranks, its own threads among them ([`crate::ensemble::Leases`]), and takes back
//! rows and nodes of the tree of sums, in order. The other ranks are workers, which know nothing
//! but what they are sent.
//!
//! ```text
//! coordinator -> worker   Run     scenario, seed and what else is asked, as a saved run has it
//!                         Lease   the first block and the last
//!                         Stop    begin no more blocks            Halt    give up those in work
//!                         Count   send the counts of your blocks before this one
//!                         End     the program is over
//! worker -> coordinator   Parcel  a lease: sums of its blocks, and rows of its paths unless they are
//!                                 in a log of the rank's own
//!                         Counts  what Count asks for, and how much of the log they go with
//!                         Failed  why the rank cannot go on
//!                         End     heard
//! ```
//!
//! Whoever waits sleeps, for a millisecond at first and up to twenty. A panic anywhere ends all
//! ranks with its message, and so does MPI itself where a rank is lost.

mod coordinator;
mod lease;
mod message;
mod settling;
mod snapshots;
mod worker;

pub use coordinator::Coordinator;

use mpi::Threading;
use mpi::environment::Universe;
use mpi::traits::*;
use std::process::ExitCode;

/// Variables by which launchers tell a process that it is one of several: Open MPI, MPICH and its
/// kin, PMIx (Slurm).
const LAUNCHED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"];

/// What this process is among several.
pub enum Place {
    /// Rank 0, which does what it would do alone, with the others at hand.
    First(Coordinator),
    /// Another rank, which has served rank 0 until its end.
    Other(ExitCode),
}

/// MPI itself; it is left when this is dropped.
pub struct Membership(#[expect(dead_code, reason = "kept for its end")] Universe);

/// Join the other ranks, if a launcher has started several. A rank other than the first comes back
/// when the program is over.
pub fn join() -> Option<(Membership, Place)> {
    if LAUNCHED.iter().all(|name| std::env::var_os(name).is_none()) {
        return None;
    }
    let (universe, _) = mpi::initialize_with_threading(Threading::Serialized)?;
    let world = universe.world();
    if world.size() < 2 {
        return Some((Membership(universe), Place::First(Coordinator::alone())));
    }
    abort_on_panic();
    let here = world.split_shared(0).size();
    let place = match world.rank() {
        0 => Place::First(Coordinator::new(world.size() as usize, here as usize)),
        _ => Place::Other(worker::serve()),
    };
    Some((Membership(universe), place))
}

/// A panic of one rank would leave the others waiting for it.
fn abort_on_panic() {
    let say = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        say(panic);
        message::abort();
    }));
}
