//! A run whose disk is full: one clear error, no crash, and no file under the final name.
//!
//! Disks are filled in processes of their own, which these tests start. The tests write no file
//! themselves: HDF5 opens files such that a child process inherits them with their locks, so a file
//! that another test is writing would stay locked.

use crate::synthetic::{EVERYTHING, block, header, summary};
use assert_cmd::Command;
use rustix::mount::{MountFlags, UnmountFlags, mount, unmount};
use std::ffi::CString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;
use stickslip::engine::Status;
use stickslip_files::store::{StoreError, Writer, read};

/// Says which part of a test was skipped. `eprintln!` is not used, because the test harness hides
/// it.
fn skip(reason: &str) {
    let _ = writeln!(std::io::stderr(), "SKIPPED: {reason}");
}

/// A small disk that is unmounted when this value is dropped.
struct SmallDisk(PathBuf);

impl SmallDisk {
    /// Mounts it; none where this user may not mount a file system.
    fn mount(folder: &Path, size: &str) -> Option<SmallDisk> {
        // A system call is used instead of a command, because a child process would inherit the
        // files that other tests have open, with their locks.
        let options = CString::new(format!("size={size}")).ok()?;
        let done = mount(
            "tmpfs",
            folder,
            "tmpfs",
            MountFlags::empty(),
            options.as_c_str(),
        );
        done.is_ok().then(|| SmallDisk(folder.to_owned()))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // The unmount is lazy, because after a write error the file stays open on purpose until the
        // process ends.
        let _ = unmount(&self.0, UnmountFlags::DETACH);
    }
}

/// After a failed write the handles of the file are leaked on purpose, and with them the state that
/// the library keeps about a disk that is gone. A process that goes on to write other files may
/// then crash. So this test has a process of its own, as `mc` ends after such an error.
#[test]
fn a_full_disk_is_one_clear_error_and_no_crash() {
    let output = Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "full_disk::what_small_disks_make_of_a_run",
            "--ignored",
            "--nocapture",
        ])
        .env(SMALL_DISKS, "yes")
        .timeout(Duration::from_secs(300))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && said.contains("1 passed"),
        "{}\n{said}",
        output.status
    );
    said.lines()
        .filter_map(|line| line.strip_prefix("SKIPPED: "))
        .for_each(skip);
}

/// The environment variable that is set where the test above runs the next one.
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
    // Disks that become full in `create`, in `append` and, with only a few pages missing, in
    // `finish`.
    let small = (1..8).map(|step| step * 16_384);
    let large = (1..8).map(|step| step * needed / 8);
    let almost = (1..16).map(|step| needed - step * 4096);
    let mut failures = 0;
    for size in small.chain(large).chain(almost) {
        let small = tempfile::tempdir().unwrap();
        let Some(disk) = SmallDisk::mount(small.path(), &size.to_string()) else {
            // The test below shows what happens when a write fails, without needing a disk.
            skip(
                "this user may not mount a small tmpfs, so no disk is filled; a file that fits was written and is read",
            );
            assert_eq!(read(&target).unwrap().completed_paths, 40_000);
            return;
        };
        let target = disk.0.join("run.h5");
        let Err(error) = fill(&target) else {
            // A file may need a little less than its size, because a page that is never written
            // takes no space.
            assert!(
                size > needed - 16_384,
                "{size} of {needed} bytes were enough"
            );
            continue;
        };
        let message = error.to_string();
        assert!(
            matches!(
                error,
                StoreError::DiskFull { .. } | StoreError::NotCreated { .. }
            ),
            "{size}: {error:?}"
        );
        assert!(
            message.contains("run.h5.partial") && message.contains("No space left"),
            "{message}"
        );
        assert!(!target.exists());
        failures += 1;
    }
    assert!(failures >= 20, "{failures}");
}

/// The shell sets a limit on the size of files for a process of this test alone. The write then
/// fails for another reason than a full disk, and every user can make it fail.
#[test]
fn a_write_that_fails_is_one_clear_error_and_no_crash() {
    // The limit is in blocks of 512 or 1024 bytes, depending on the shell. Writes fail in `create`
    // and in `append`.
    for blocks in [4, 16, 64, 256, 1024] {
        let folder = tempfile::tempdir().unwrap();
        let output = Command::new("sh")
            // The signal that comes with the error would end the process before it can handle the
            // error.
            .args([
                "-c",
                "trap '' XFSZ; ulimit -f \"$LIMIT\" && exec \"$@\"",
                "sh",
            ])
            .arg(std::env::current_exe().unwrap())
            .args([
                "--exact",
                "full_disk::what_a_limited_process_writes",
                "--ignored",
                "--nocapture",
            ])
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
        assert!(
            said.contains("1 passed") && said.contains("File too large"),
            "{blocks}: {said}"
        );
        assert!(!folder.path().join("run.h5").exists());
    }
}

/// The environment variable with the folder that the limited process writes to.
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
    // A limit on the size of files counts as a full disk, except for the very first bytes.
    let is_named = matches!(
        error,
        StoreError::DiskFull { .. } | StoreError::Write { .. } | StoreError::NotCreated { .. }
    );
    assert!(is_named, "{error:?}");
    assert!(error.to_string().contains("run.h5.partial"), "{error}");
}

/// Writes a run of about 2 MB.
fn fill(target: &Path) -> Result<(), StoreError> {
    let header = header(40_000);
    let mut writer = Writer::create(target, &header, &EVERYTHING, false)?;
    for first in (0..40_000).step_by(4_000) {
        if let Err(error) = writer.append(&block(first, 4_000, 61, 40).rows(&EVERYTHING)) {
            // A caller that continues after the error gets the same error again.
            assert!(
                writer
                    .append(&block(first, 4_000, 61, 40).rows(&EVERYTHING))
                    .is_err()
            );
            assert!(
                writer
                    .finish(&summary(first, &header), Status::Interrupted)
                    .is_err()
            );
            return Err(error);
        }
    }
    writer.finish(&summary(40_000, &header), Status::Complete)
}
