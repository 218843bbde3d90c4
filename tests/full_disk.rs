//! What becomes of a run whose disk is full: one clear error, no crash, and no file under the final
//! name.
//!
//! Disks are filled in processes of their own, which these tests start. They write no file
//! themselves: HDF5 opens files so that a child inherits them, with their locks, and a file that
//! another test is writing would stay locked.

mod synthetic;

use assert_cmd::Command;
use rustix::mount::{MountFlags, UnmountFlags, mount, unmount};
use std::ffi::CString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;
use stick_slip::engine::Status;
use stick_slip::store::{StoreError, Writer, read};
use synthetic::{EVERYTHING, block, header, summary};

/// Say which part of a test did not happen. Not `eprintln!`, which the test harness hides.
fn skip(reason: &str) {
    let _ = writeln!(std::io::stderr(), "SKIPPED: {reason}");
}

/// A small disk that goes away with this value.
struct SmallDisk(PathBuf);

impl SmallDisk {
    /// None where this user may not mount a file system.
    fn mount(folder: &Path, size: &str) -> Option<SmallDisk> {
        // A system call and not the command: a child process would inherit the files that other
        // tests have open, and their locks.
        let options = CString::new(format!("size={size}")).ok()?;
        let done = mount("tmpfs", folder, "tmpfs", MountFlags::empty(), options.as_c_str());
        done.is_ok().then(|| SmallDisk(folder.to_owned()))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // Lazy: after a write error the file stays open on purpose until the process ends.
        let _ = unmount(&self.0, UnmountFlags::DETACH);
    }
}

/// After a write that failed, the handles of the file are leaked on purpose, and with them what the
/// library thinks of a disk that is gone. A process that goes on writing other files may then
/// crash; so this happens in a process of its own, as `mc` ends after it.
#[test]
fn a_full_disk_is_one_clear_error_and_no_crash() {
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "what_small_disks_make_of_a_run", "--ignored", "--nocapture"])
        .env(SMALL_DISKS, "yes")
        .timeout(Duration::from_secs(300))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("1 passed"), "{}\n{said}", output.status);
    said.lines().filter_map(|line| line.strip_prefix("SKIPPED: ")).for_each(skip);
}

/// Set where the test that follows is run by the one above.
const SMALL_DISKS: &str = "STORE_SMALL_DISKS";

#[test]
#[ignore = "the part of another test that runs in a process of its own"]
fn what_small_disks_make_of_a_run() {
    if std::env::var_os(SMALL_DISKS).is_none() {
        skip("this runs in a process that `a_full_disk_is_one_clear_error_and_no_crash` starts");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.h5");
    fill(&target).unwrap();
    let needed = fs::metadata(&target).unwrap().len();
    // Disks that fill up in `create`, in `append`, and, short of a few pages only, in `finish`.
    let small = (1..8).map(|step| step * 16_384);
    let large = (1..8).map(|step| step * needed / 8);
    let almost = (1..16).map(|step| needed - step * 4096);
    let mut failures = 0;
    for size in small.chain(large).chain(almost) {
        let small = tempfile::tempdir().unwrap();
        let Some(disk) = SmallDisk::mount(small.path(), &size.to_string()) else {
            // What a write that fails comes to, whatever the reason, is tested without a disk
            // below.
            skip(
                "this user may not mount a small tmpfs, so no disk is filled; a file that fits was written and is read",
            );
            assert_eq!(read(&target).unwrap().completed_paths, 40_000);
            return;
        };
        let target = disk.0.join("run.h5");
        let Err(error) = fill(&target) else {
            // A file may need a little less than its size: a page of it that is never written takes
            // no room.
            assert!(size > needed - 16_384, "{size} of {needed} bytes were enough");
            continue;
        };
        let message = error.to_string();
        assert!(matches!(error, StoreError::DiskFull { .. } | StoreError::NotCreated { .. }), "{size}: {error:?}");
        assert!(message.contains("run.h5.partial") && message.contains("No space left"), "{message}");
        assert!(!target.exists());
        failures += 1;
    }
    assert!(failures >= 20, "{failures}");
}

/// No file may grow beyond a limit that a shell sets for this test alone, in a process of its own:
/// the write fails for another reason than a full disk, and any user can have it fail.
#[test]
fn a_write_that_fails_is_one_clear_error_and_no_crash() {
    // In blocks of 512 or 1024 bytes, as the shell has it: in `create`, in `append`.
    for blocks in [4, 16, 64, 256, 1024] {
        let folder = tempfile::tempdir().unwrap();
        let output = Command::new("sh")
            // The signal that comes with the error would end the process before the error is seen.
            .args(["-c", "trap '' XFSZ; ulimit -f \"$LIMIT\" && exec \"$@\"", "sh"])
            .arg(std::env::current_exe().unwrap())
            .args(["--exact", "what_a_limited_process_writes", "--ignored", "--nocapture"])
            .env("LIMIT", blocks.to_string())
            .env(LIMITED, folder.path())
            .timeout(Duration::from_secs(300))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(
            output.status.success(),
            "{blocks}: {}\n{said}{}",
            output.status,
            String::from_utf8_lossy(&output.stderr)
        );
        assert!(said.contains("1 passed") && said.contains("File too large"), "{blocks}: {said}");
        assert!(!folder.path().join("run.h5").exists());
    }
}

/// Where the process with the limit writes to.
const LIMITED: &str = "STORE_LIMITED";

#[test]
#[ignore = "the part of another test that runs in a process of its own"]
fn what_a_limited_process_writes() {
    let Some(folder) = std::env::var_os(LIMITED).map(PathBuf::from) else {
        skip(
            "this runs in a process that `a_write_that_fails_is_one_clear_error_and_no_crash` starts, under its limit",
        );
        return;
    };
    let error = fill(&folder.join("run.h5")).unwrap_err();
    println!("{error}");
    // A limit on the size of files counts as a full disk, but for the very first bytes.
    let is_named =
        matches!(error, StoreError::DiskFull { .. } | StoreError::Write { .. } | StoreError::NotCreated { .. });
    assert!(is_named, "{error:?}");
    assert!(error.to_string().contains("run.h5.partial"), "{error}");
}

/// Write a run of about 2 MB.
fn fill(target: &Path) -> Result<(), StoreError> {
    let header = header(40_000);
    let mut writer = Writer::create(target, &header, &EVERYTHING, false)?;
    for first in (0..40_000).step_by(4_000) {
        if let Err(error) = writer.append_rows(block(first, 4_000, 61, 40).rows(&EVERYTHING)) {
            // Whoever goes on regardless hears the same again.
            assert!(writer.append_rows(block(first, 4_000, 61, 40).rows(&EVERYTHING)).is_err());
            assert!(writer.finish(&summary(first, &header), Status::Interrupted).is_err());
            return Err(error);
        }
    }
    writer.finish(&summary(40_000, &header), Status::Complete)
}
