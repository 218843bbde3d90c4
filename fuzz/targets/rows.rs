//! Reads the log of rows of an unfinished run, as `mc resume` does. The state beside it says that
//! the whole log counts, and checksums are made right, because otherwise every changed log would be
//! refused at once.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::LazyLock;
use stickslip::engine::Run;
use stickslip::scenario::Scenario;
use stickslip::stats::RunTotals;
use stickslip::sums::Codec as _;
use stickslip_files::store::{self, FileSink, RunQuestion};

/// A folder in memory, where there is one.
static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder");
    let partial = folder.path().join("run.h5.partial");
    std::fs::create_dir(&partial).expect("room");
    std::fs::write(partial.join("made-by-mc"), "").expect("room");
    folder
});
static TARGET: LazyLock<PathBuf> = LazyLock::new(|| FOLDER.path().join("run.h5"));

/// The state of a run of which no path is done: the part before its log, and its sums.
static STATE: LazyLock<(Vec<u8>, Vec<u8>)> = LazyLock::new(|| {
    let mut scenario = Scenario::shipped("rho025").expect("shipped");
    // There are few rows of the output grid, so that the state is small.
    scenario.time.output_step = scenario.time.end;
    let asked = Run::of(&scenario).question();
    let mut head = RunQuestion { scenario: scenario.clone(), asked, note: String::new() }.to_bytes();
    let sums = RunTotals::empty(&scenario.model, &scenario.timeline(), &scenario.record).to_bytes();
    let mut length = Vec::new();
    (sums.len() as u64).write(&mut length);
    let tail = [length, sums].concat();
    // An empty log takes two bytes, and the checksum four.
    head.truncate(head.len() - 4 - tail.len() - 2);
    (head, tail)
});

fuzz_target!(|bytes: &[u8]| {
    // The first byte decides whether the bytes are one block, or blocks as they are.
    let (how, bytes) = bytes.split_first().unwrap_or((&0, &[]));
    let mut log = bytes.to_vec();
    if how % 2 == 0 {
        log.splice(0..0, (bytes.len() as u64).to_le_bytes());
    }
    let checksum = crc32fast::hash(&log);
    let (head, tail) = &*STATE;
    let mut state = head.clone();
    (log.len() as u64).write(&mut state);
    u64::from(checksum).write(&mut state);
    state.extend(tail);
    state.extend(crc32fast::hash(&state).to_le_bytes());
    let folder = store::partial_path(&TARGET);
    std::fs::write(folder.join("state"), state).expect("room");
    std::fs::write(folder.join("rows"), log).expect("room");
    let _ = FileSink::go_on(&TARGET, false);
});
