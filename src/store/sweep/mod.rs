//! The file of a sweep: the question, the results at every point, and the comparisons between
//! points.
//!
//! ```text
//! SweepFile::open   takes the lock, and returns the points that are saved already
//!   -> save         replaces NAME.partial, a complete file of the points done so far, in one step
//!     -> finish     renames NAME.partial to NAME
//! read_sweep        reads either of the two
//! ```

mod read;
mod write;

pub use read::read_sweep;

use super::error::StoreError;
use super::lock::Lock;
use super::{check_space, partial_path};
use crate::provenance::Provenance;
use crate::stats::{GROUPS, Statistic};
use crate::study::sweep::{Design, Point, Question, Sweep};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Shortest time between two updates of the file on disk.
const INTERVAL: Duration = Duration::from_secs(1);

/// Updating the file takes at most one part in this many of the time.
const ONE_PART_IN: u32 = 50;

/// The file of a sweep that is being simulated. It holds the lock, so that no other process writes
/// the file meanwhile.
#[derive(Debug)]
pub struct SweepFile {
    target: PathBuf,
    header: Provenance,
    /// When the file was last updated.
    last: Option<Instant>,
    interval: Duration,
    /// Whether a regular file of the target's name is replaced.
    force: bool,
    _lock: Lock,
}

impl SweepFile {
    /// Take the lock for a sweep, and return the points that are known already. If the target
    /// exists and answers the same question, these are all of its points; if an interrupted sweep
    /// of the same question left `NAME.partial`, they are the points in it. A file of another
    /// question is an error, unless `force` lets it be replaced.
    pub fn open(
        target: &Path,
        header: &Provenance,
        question: &Question,
        force: bool,
    ) -> Result<(SweepFile, Vec<Option<Point>>), StoreError> {
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(StoreError::NoFolder { target: target.to_owned(), folder: folder.to_owned() });
        }
        let lock = Lock::take(target)?;
        let nothing = vec![None; question.points.len()];
        let file = |points| {
            let (target, header) = (target.to_owned(), header.clone());
            (SweepFile { target, header, last: None, interval: INTERVAL, force, _lock: lock }, points)
        };
        if target.symlink_metadata().is_ok() && !force {
            return Ok(file(same_question(target, header, question)?));
        }
        check_space(folder, 2 * sweep_bytes(&question.design))?;
        let partial = partial_path(target);
        if !partial.exists() {
            return Ok(file(nothing));
        }
        match same_question(&partial, header, question) {
            Ok(points) => Ok(file(points)),
            Err(_) if force => {
                std::fs::remove_file(&partial).map_err(|source| StoreError::Remove { partial, source })?;
                Ok(file(nothing))
            }
            Err(error) => Err(error),
        }
    }

    /// Update `NAME.partial`, unless that was done a moment ago.
    pub fn save(&mut self, sweep: &Sweep) -> Result<(), StoreError> {
        let is_due = self.last.is_none_or(|last| last.elapsed() >= self.interval);
        if is_due { self.save_now(sweep) } else { Ok(()) }
    }

    /// Update `NAME.partial` now.
    pub fn save_now(&mut self, sweep: &Sweep) -> Result<(), StoreError> {
        let start = Instant::now();
        write::replace(&partial_path(&self.target), &self.header, sweep)?;
        self.last = Some(Instant::now());
        self.interval = INTERVAL.max(start.elapsed() * ONE_PART_IN);
        Ok(())
    }

    /// Update the file a last time and rename it to the target. Every point must be done.
    pub fn finish(mut self, sweep: &Sweep) -> Result<(), StoreError> {
        self.save_now(sweep)?;
        let partial = partial_path(&self.target);
        if self.target.symlink_metadata().is_ok_and(|there| !self.force || !there.is_file()) {
            return Err(StoreError::InTheWay { path: self.target });
        }
        write::rename(&partial, &self.target)
    }
}

/// The points in a file, if it is of this question and was written by this program; an error
/// otherwise.
fn same_question(path: &Path, header: &Provenance, question: &Question) -> Result<Vec<Option<Point>>, StoreError> {
    let stored = read_sweep(path)?;
    match read::difference(&stored, header, question) {
        None => Ok(stored.points),
        Some(what) => Err(StoreError::OtherSweep { path: path.to_owned(), what }),
    }
}

/// Approximate size of the file of a sweep, in bytes.
pub fn sweep_bytes(design: &Design) -> u64 {
    /// Values of one statistic at one point, without those of groups and comparisons.
    const OF_POINT: usize = 10;
    /// Values of one comparison.
    const OF_DIFFERENCE: usize = 5;
    /// Bytes of attributes, names and HDF5's own structures.
    const EMPTY: usize = 40_000;
    let of_statistic = OF_POINT + GROUPS + OF_DIFFERENCE * design.along().len().max(1);
    (EMPTY + design.points() * 8 * (of_statistic * Statistic::ALL.len() + 8)) as u64
}
