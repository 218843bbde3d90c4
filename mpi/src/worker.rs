//! A rank that simulates the leases that rank 0 gives it.

use super::lease::{self, Instructions, Simulator};
use super::message::{Kind, Pause, Received, rank, receive, send};
use super::snapshots::Snapshots;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::thread;
use stick_slip::ensemble::Stops;
use stick_slip::store::{RankLog, StoreError};

/// Serve rank 0 until the program is over. A program simulates one run at most.
pub(super) fn serve() -> ExitCode {
    // The launcher sends a signal to all ranks. Only rank 0 acts on it, and the other ranks ignore
    // it.
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2] {
        let _ = signal_hook::flag::register(signal, Arc::new(AtomicBool::new(false)));
    }
    let mut pause = Pause::default();
    loop {
        match receive() {
            Some(Received { kind: Kind::End, .. }) => break,
            Some(Received { kind: Kind::Run, bytes, .. }) => {
                work(&bytes);
                break;
            }
            _ => thread::sleep(pause.next()),
        }
    }
    send(0, Kind::End, &[]);
    ExitCode::SUCCESS
}

/// Simulate leases of one run until the program is over.
fn work(bytes: &[u8]) {
    let asked = Instructions::of_bytes(bytes);
    let Instructions { question, options, outlet } =
        asked.unwrap_or_else(|error| panic!("cannot do what rank 0 asks: {error}"));
    let plan = &question.plan();
    let [stop, halt] = [(); 2].map(|()| AtomicBool::new(false));
    let stops = Stops { stop: &stop, halt: &halt };
    let snapshots = &Snapshots::default();
    let (leases, to_do) = channel();
    let (done, parcels) = channel();
    thread::scope(|scope| {
        // The sender is moved here, so that it is dropped when this closure ends, and the thread
        // below then ends too.
        let leases = leases;
        let simulated = done.clone();
        scope.spawn(move || {
            let simulate = || -> Result<(), StoreError> {
                let has_log = !options.has_goals && !outlet.is_empty();
                let log = if has_log { RankLog::create(&outlet, rank())? } else { None };
                let mut simulator = Simulator { log, ..Simulator::new(plan, options, stops, snapshots) };
                for lease in to_do {
                    // An error means that the program is over, and the parcel is then not needed.
                    let _ = simulated.send(Ok(simulator.simulate(lease)?.to_bytes()));
                }
                Ok(())
            };
            if let Err(error) = simulate() {
                let _ = simulated.send(Err(error.to_string()));
            }
        });
        let mut pause = Pause::default();
        loop {
            if let Ok(parcel) = parcels.recv_timeout(pause.next()) {
                match parcel {
                    Ok(parcel) => send(0, Kind::Parcel, &parcel),
                    Err(reason) => send(0, Kind::Failed, reason.as_bytes()),
                }
                pause = Pause::default();
            }
            let Some(Received { kind, bytes, .. }) = receive() else { continue };
            pause = Pause::default();
            stop.fetch_or(matches!(kind, Kind::Stop | Kind::Halt | Kind::End), Ordering::Relaxed);
            halt.fetch_or(matches!(kind, Kind::Halt | Kind::End), Ordering::Relaxed);
            match kind {
                Kind::Lease => drop(leases.send(lease::of_bytes(&bytes))),
                Kind::Count => {
                    let counted = snapshots.before(lease::of_bytes(&bytes).end);
                    send(0, Kind::Counts, &counted.map_or_else(Vec::new, |counted| counted.to_bytes()));
                }
                Kind::End => break,
                Kind::Stop | Kind::Halt | Kind::Run | Kind::Parcel | Kind::Counts | Kind::Failed => {}
            }
        }
    });
}
