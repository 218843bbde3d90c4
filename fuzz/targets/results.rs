//! A finished file of which some bytes are others, as `mc show` reads it. Its seal is taken away, or nothing would come past it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::LazyLock;
use stick_slip::scenario::Scenario;
use stick_slip::store::{self, FileKind};

/// In memory, where there is such a folder.
static FOLDER: LazyLock<tempfile::TempDir> =
    LazyLock::new(|| tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder"));
static FILE: LazyLock<PathBuf> = LazyLock::new(|| FOLDER.path().join("run.h5"));

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(&*FILE, bytes).expect("room");
    let _ = match store::kind(&FILE) {
        Ok(Some(FileKind::Run)) => store::read(&FILE).map(|stored| {
            let header = &stored.header;
            let _ = Scenario::parse_stored("fuzz", &header.scenario_text, &[], header.series.as_ref());
        }),
        Ok(Some(FileKind::Sweep)) => store::read_sweep(&FILE).map(drop),
        Ok(Some(FileKind::Calibration)) => store::read_calibration(&FILE).map(drop),
        Ok(Some(FileKind::Trade)) => store::read_prices(&FILE, None).map(drop),
        Ok(None) | Err(_) => Ok(()),
    };
});
