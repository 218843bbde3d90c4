//! A rank that simulates what rank 0 lends to it.

use super::lease::{self, Errand, Simulator};
use super::message::{Kind, Nap, Received, receive, send};
use super::snapshots::Snapshots;
use crate::ensemble::Stops;
use crate::stats::Codec as _;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// Serve rank 0 until the program is over, which simulates one run at most.
pub(super) fn serve() -> ExitCode {
    // A signal goes to all ranks, and rank 0 decides what becomes of the run.
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2] {
        let _ = signal_hook::flag::register(signal, Arc::new(AtomicBool::new(false)));
    }
    let mut nap = Nap::default();
    loop {
        match receive() {
            Some(Received { kind: Kind::End, .. }) => break,
            Some(Received { kind: Kind::Run, bytes, .. }) => {
                work(&bytes);
                break;
            }
            _ => thread::sleep(nap.next()),
        }
    }
    send(0, Kind::End, &[]);
    ExitCode::SUCCESS
}

/// Simulate leases of a run until the program is over.
fn work(bytes: &[u8]) {
    let asked = Errand::of_bytes(bytes);
    let Errand { question, manner } = asked.unwrap_or_else(|error| panic!("cannot do what rank 0 asks: {error}"));
    let plan = &question.plan();
    let [stop, halt] = [(); 2].map(|()| AtomicBool::new(false));
    let stops = Stops { stop: &stop, halt: &halt };
    let snapshots = &Snapshots::default();
    let (leases, to_do) = channel();
    let (done, parcels) = channel();
    thread::scope(|scope| {
        // Gone with this closure, so that the thread below ends.
        let leases = leases;
        scope.spawn(move || {
            let mut simulator = Simulator::new(plan, manner, stops, snapshots);
            for lease in to_do {
                // Nobody listens any more where the program is over.
                let _ = done.send(simulator.simulate(lease).to_bytes());
            }
        });
        let mut nap = Nap::default();
        loop {
            if let Ok(parcel) = parcels.recv_timeout(nap.next()) {
                send(0, Kind::Parcel, &parcel);
                nap = Nap::default();
            }
            let Some(Received { kind, bytes, .. }) = receive() else { continue };
            nap = Nap::default();
            stop.fetch_or(matches!(kind, Kind::Stop | Kind::Halt | Kind::End), Ordering::Relaxed);
            halt.fetch_or(matches!(kind, Kind::Halt | Kind::End), Ordering::Relaxed);
            match kind {
                Kind::Lease => drop(leases.send(lease::of_bytes(&bytes))),
                Kind::Count => send(0, Kind::Counts, &counts_before(snapshots, &bytes)),
                Kind::End => break,
                Kind::Stop | Kind::Halt | Kind::Run | Kind::Parcel | Kind::Counts => {}
            }
        }
    });
}

/// The counts of this rank before the block that the message names, as bytes; no bytes where it has
/// done none.
fn counts_before(snapshots: &Snapshots, message: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Some(counts) = snapshots.before(lease::of_bytes(message).end) {
        counts.write(&mut bytes);
    }
    bytes
}
