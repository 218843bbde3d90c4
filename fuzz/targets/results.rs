//! Reads a finished file with some bytes changed, as `mc show` does. Its checksum is removed,
//! because otherwise every changed file would be refused at once.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::LazyLock;
use stickslip::scenario::Scenario;
use stickslip_bearing::dataset::{CALIBRATION_FORMAT, StoredCalibration};
use stickslip::dataset::{RUN_FORMAT, SWEEP_FORMAT, TRADE_FORMAT};
use stickslip_files::store;

/// A folder in memory, where there is one.
static FOLDER: LazyLock<tempfile::TempDir> =
    LazyLock::new(|| tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder"));
static FILE: LazyLock<PathBuf> = LazyLock::new(|| FOLDER.path().join("run.h5"));

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(&*FILE, bytes).expect("room");
    let format = store::format(&FILE).ok().flatten();
    let _ = match format.as_deref() {
        Some(name) if name == RUN_FORMAT.0 => store::read(&FILE).map(|stored| {
            let header = &stored.header;
            let _ = Scenario::parse_stored("fuzz", &header.scenario_text, &[], &header.samples);
        }),
        Some(name) if name == SWEEP_FORMAT.0 => store::read_sweep(&FILE).map(drop),
        Some(name) if name == TRADE_FORMAT.0 => store::read_trade(&FILE).map(drop),
        Some(name) if name == CALIBRATION_FORMAT.0 => {
            store::read_kind(&FILE, CALIBRATION_FORMAT, StoredCalibration::read).map(drop)
        }
        _ => Ok(()),
    };
});
