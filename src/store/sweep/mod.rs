//! The file of a sweep: what was asked, what is known of every point, and what points say together.
//!
//! ```text
//! SweepFile::open   takes the name for this process; what an interrupted sweep of the same question left is where to go on
//!   -> save         NAME.partial: at every moment a whole file of the points that were done, replaced in one step
//!     -> finish     NAME.partial becomes NAME
//! read_sweep        either of them
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

/// Shortest time between two moments at which the file on disk is brought up to date.
const INTERVAL: Duration = Duration::from_secs(1);

/// Bringing it up to date may take at most this share of the time.
const SHARE: u32 = 50;

/// The file of a sweep that is being simulated. Nobody else may write it meanwhile.
#[derive(Debug)]
pub struct SweepFile {
    target: PathBuf,
    header: Provenance,
    /// When it was brought up to date last.
    last: Option<Instant>,
    interval: Duration,
    /// Whether a regular file of the target's name is replaced.
    force: bool,
    _lock: Lock,
}

impl SweepFile {
    /// Take the name for a sweep. Returns the points that are known already: all of them, if the
    /// file is there and answers the same question; those of `NAME.partial`, if an interrupted
    /// sweep of the same question left it. A file of another question is an error, unless it may go
    /// (`force`).
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

    /// Bring `NAME.partial` up to date, unless that was done a moment ago.
    pub fn save(&mut self, sweep: &Sweep) -> Result<(), StoreError> {
        let is_due = self.last.is_none_or(|last| last.elapsed() >= self.interval);
        if is_due { self.save_now(sweep) } else { Ok(()) }
    }

    /// Bring `NAME.partial` up to date.
    pub fn save_now(&mut self, sweep: &Sweep) -> Result<(), StoreError> {
        let start = Instant::now();
        write::replace(&partial_path(&self.target), &self.header, sweep)?;
        self.last = Some(Instant::now());
        self.interval = INTERVAL.max(start.elapsed() * SHARE);
        Ok(())
    }

    /// Every point is done: the file gets its name.
    pub fn finish(mut self, sweep: &Sweep) -> Result<(), StoreError> {
        self.save_now(sweep)?;
        let partial = partial_path(&self.target);
        if self.target.symlink_metadata().is_ok_and(|there| !self.force || !there.is_file()) {
            return Err(StoreError::InTheWay { path: self.target });
        }
        write::rename(&partial, &self.target)
    }
}

/// The points in a file, if it is a sweep of this question by this program.
fn same_question(path: &Path, header: &Provenance, question: &Question) -> Result<Vec<Option<Point>>, StoreError> {
    let stored = read_sweep(path)?;
    match read::difference(&stored, header, question) {
        None => Ok(stored.points),
        Some(what) => Err(StoreError::OtherSweep { path: path.to_owned(), what }),
    }
}

/// About how many bytes the file of a sweep has.
pub fn sweep_bytes(design: &Design) -> u64 {
    /// Numbers of a statistic at a point besides those of each group and each comparison.
    const OF_POINT: usize = 10;
    /// Numbers of a comparison.
    const OF_DIFFERENCE: usize = 5;
    /// Attributes, names, and what HDF5 takes for itself.
    const EMPTY: usize = 40_000;
    let of_statistic = OF_POINT + GROUPS + OF_DIFFERENCE * design.along().len().max(1);
    (EMPTY + design.points() * 8 * (of_statistic * Statistic::ALL.len() + 8)) as u64
}
