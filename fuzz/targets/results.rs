//! Reads a finished file with some bytes changed, as `mc show` does. Its checksum is removed,
//! because otherwise every changed file would be refused at once.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::LazyLock;
use stickslip::scenario::Scenario;
use stickslip_files::store::{self, FileKind};

/// A folder in memory, where there is one.
static FOLDER: LazyLock<tempfile::TempDir> =
    LazyLock::new(|| tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder"));
static FILE: LazyLock<PathBuf> = LazyLock::new(|| FOLDER.path().join("run.h5"));

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(&*FILE, bytes).expect("room");
    let _ = match store::kind(&FILE) {
        Ok(Some(FileKind::Run)) => store::read(&FILE).map(|stored| {
            let header = &stored.header;
            let _ = Scenario::parse_stored("fuzz", &header.scenario_text, &[], &header.samples);
        }),
        Ok(Some(FileKind::Sweep)) => store::read_sweep(&FILE).map(drop),
        Ok(Some(FileKind::Calibration)) => store::read_calibration(&FILE).map(drop),
        Ok(Some(FileKind::Trade)) => store::read_trade(&FILE).map(drop),
        Ok(None) | Err(_) => Ok(()),
    };
});
