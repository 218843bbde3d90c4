//! How much room a run needs, and whether the disk has it.

use super::{Header, StoreError};
use crate::stats::Record;
use std::path::Path;

/// Header, attributes, summary of a small run: what every file needs, in bytes.
const FIXED_BYTES: u64 = 200_000;

/// Bytes of one path: number, five reals, three counts, one flag.
const PATH_BYTES: u64 = 8 + 5 * 8 + 3 * 4 + 1;

/// Bytes of one event: three reals, two flags.
const EVENT_BYTES: f64 = 3.0 * 8.0 + 2.0;

/// Bytes of one row of a trajectory: three reals, one flag.
const TRAJECTORY_ROW_BYTES: u64 = 3 * 8 + 1;

/// Bytes of one time of the bands: three means, deviations and sets of five quantiles, a probability, the time.
const BAND_ROW_BYTES: u64 = (3 * 7 + 2) * 8;

/// The size of the file in bytes, if nothing of it could be compressed: an upper bound as good as the guess of
/// `events_per_path`, which counts only if events are recorded.
pub fn estimated_size(header: &Header, record: &Record, events_per_path: f64) -> u64 {
    let rows = header.time.len() as u64;
    let paths = if record.paths { header.paths.saturating_mul(PATH_BYTES) } else { 0 };
    let events = if record.events {
        let counts = header.paths.saturating_mul(8 + 4);
        counts.saturating_add((header.paths as f64 * events_per_path * EVENT_BYTES) as u64)
    } else {
        0
    };
    let kept = record.trajectories.min(header.paths);
    let trajectories = kept.saturating_mul(rows.saturating_mul(TRAJECTORY_ROW_BYTES));
    [rows.saturating_mul(BAND_ROW_BYTES), paths, events, trajectories, header.scenario_text.len() as u64]
        .into_iter()
        .fold(FIXED_BYTES, u64::saturating_add)
}

/// Whether a folder has room for so many bytes. Better known before a long run than at its end.
pub fn check_space(folder: &Path, needed: u64) -> Result<(), StoreError> {
    // The folder of a bare file name is the empty path.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let disk = rustix::fs::statvfs(folder)
        .map_err(|error| StoreError::Space { folder: folder.to_owned(), source: error.into() })?;
    let free = disk.f_bavail.saturating_mul(disk.f_frsize);
    // Some file systems do not know their size and report zero blocks in all.
    if disk.f_blocks > 0 && free < needed {
        return Err(StoreError::TooLittleSpace { folder: folder.to_owned(), needed, free });
    }
    Ok(())
}
