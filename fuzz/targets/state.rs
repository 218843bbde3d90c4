//! Reads the state of an unfinished run, as `mc show` does. The checksum is made right, because
//! otherwise every changed state would be refused at once.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::LazyLock;
use stickslip_files::store;

/// A folder in memory, where there is one.
static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder");
    std::fs::create_dir(folder.path().join("run.h5.partial")).expect("room");
    folder
});
static TARGET: LazyLock<PathBuf> = LazyLock::new(|| FOLDER.path().join("run.h5"));

fuzz_target!(|body: &[u8]| {
    let bytes = [body, &crc32fast::hash(body).to_le_bytes()].concat();
    std::fs::write(store::partial_path(&TARGET).join("state"), bytes).expect("room");
    let _ = store::read(&TARGET);
});
