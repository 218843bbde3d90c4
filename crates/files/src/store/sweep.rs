//! The file of a sweep: the question, the results at every point, and the comparisons between
//! points.
//!
//! ```text
//! SweepFile::open   takes the lock, and returns the points that are saved already
//!   -> save         replaces NAME.partial, a complete file of the points done so far, in one step
//!     -> finish     gives NAME.partial the name NAME
//! ```
//!
//! NAME.partial is written as every file is: in a folder of its own, NAME.partial.partial.

use super::errors::StoreError;
use super::kinds::{check_file, read_kind};
use super::lock::Lock;
use super::staging::{self, Partial};
use super::system::{self, give_name, identity, parent};
use super::writer::write_dataset;
use super::{check_space, errors, partial_path};
use crate::dataset::header::read_program;
use crate::dataset::sweep::{SWEEP_FORMAT, bias_name, name, read_design, read_points};
use crate::dataset::{Dataset, Source, read_attribute, series};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use stickslip::engine::Provenance;
use stickslip::model::NamedSeries;
use stickslip::stats::{GROUPS, Statistic};
use stickslip::study::sweep::{Design, Point, Sweep, SweepQuestion};

/// Bytes of a sample of a record, with its time and the number of its record.
const OF_SAMPLE: usize = 20;

/// Shortest time between two updates of the file on disk.
const INTERVAL: Duration = Duration::from_secs(1);

/// Updating the file takes at most one part in this many of the time.
const ONE_PART_IN: u32 = 50;

/// The file of a sweep that is being simulated. It holds the lock, so that no other process writes
/// the file meanwhile.
#[derive(Debug)]
pub struct SweepFile {
    target: PathBuf,
    /// When the file is to be updated next.
    due: Instant,
    /// Whether a regular file of the target's name is replaced.
    force: bool,
    /// Whether every point is in a file that has its name already.
    has_name: bool,
    /// The file that was NAME.partial when it was last looked at; none if there was none.
    partial: Option<(u64, u64)>,
    _lock: Lock,
}

impl SweepFile {
    /// Take the lock for a sweep, and return the points that are known already. If the target
    /// exists and answers the same question, these are its points; if an interrupted sweep of the
    /// same question left `NAME.partial`, they are the points in it. A file of another question, or
    /// one that another program has changed, is an error, unless `force` lets it be replaced.
    pub fn open(
        target: &Path,
        question: &SweepQuestion,
        force: bool,
    ) -> Result<(SweepFile, Vec<Option<Point>>), StoreError> {
        let lock = staging::lock(target)?;
        if staging::unfinished(target) == Partial::Named {
            staging::clear(target)?;
        }
        let is_there = target.symlink_metadata().is_ok() && !force;
        let points = match is_there {
            true => Some(same_question(target, question)?),
            false => known(target, question, force)?,
        };
        let points = points.unwrap_or_else(|| vec![None; question.points.len()]);
        let has_name = is_there && points.iter().all(Option::is_some);
        if !has_name {
            if is_there {
                staging::make_room(target, false)?;
            }
            let samples = question.samples_of_files();
            let samples: usize = samples.iter().map(|of| of.series.times().len()).sum();
            let bytes = sweep_bytes(&question.design) + (samples * OF_SAMPLE) as u64;
            check_space(&parent(target), 2 * bytes)?;
        }
        let partial = identity(&partial_path(target));
        let target = target.to_owned();
        // A file of this question without some of its points is replaced by one with all of them.
        let force = force || is_there;
        Ok((
            SweepFile {
                target,
                due: Instant::now(),
                force,
                has_name,
                partial,
                _lock: lock,
            },
            points,
        ))
    }

    /// Whether every point is in a file that has its name already, so that nothing is left to do.
    pub fn has_name(&self) -> bool {
        self.has_name
    }

    /// Update `NAME.partial`, unless that was done a moment ago.
    pub fn save(&mut self, sweep: &Sweep) -> Result<(), StoreError> {
        if Instant::now() >= self.due {
            self.save_now(sweep)
        } else {
            Ok(())
        }
    }

    /// Update `NAME.partial` now. A file that somebody has put in its place is not replaced.
    pub fn save_now(&mut self, sweep: &Sweep) -> Result<(), StoreError> {
        let start = Instant::now();
        let partial = partial_path(&self.target);
        let found = identity(&partial);
        if found.is_some() && found != self.partial {
            return Err(StoreError::TakenAway {
                partial,
                target: self.target.clone(),
            });
        }
        write_dataset(&partial, Dataset::of_sweep(sweep), true).map_err(|error| match error {
            // The file that could not be named is not one that `mc resume` knows.
            StoreError::Rename { target, source, .. } => StoreError::Write {
                partial: partial.clone(),
                target,
                saved_paths: 0,
                cause: source.to_string(),
            },
            error => error,
        })?;
        self.partial = identity(&partial);
        self.due = Instant::now() + INTERVAL.max(start.elapsed() * ONE_PART_IN);
        Ok(())
    }

    /// Update the file a last time and give it its name. Every point must be done.
    pub fn finish(mut self, sweep: &Sweep) -> Result<(), StoreError> {
        self.save_now(sweep)?;
        let partial = partial_path(&self.target);
        give_name(&partial, None, &self.target, &partial, self.force)?;
        if let Err(error) = system::remove(&partial) {
            errors::stays(&partial, &error);
        }
        Ok(())
    }
}

/// The points that an interrupted sweep of this question has left in `NAME.partial`, if any. With
/// `force`, what is left of anything else is removed.
fn known(
    target: &Path,
    question: &SweepQuestion,
    force: bool,
) -> Result<Option<Vec<Option<Point>>>, StoreError> {
    if staging::unfinished(target) == Partial::File {
        match same_question(&partial_path(target), question) {
            Err(_) if force => {}
            points => return points.map(Some),
        }
    }
    staging::make_room(target, force).map(|()| None)
}

/// The points in a file, if it is of this question and was written by this program; an error
/// otherwise.
fn same_question(path: &Path, question: &SweepQuestion) -> Result<Vec<Option<Point>>, StoreError> {
    if !check_file(path)? {
        return Err(StoreError::NotSealed {
            path: path.to_owned(),
        });
    }
    let read = |file: &dyn Source| match difference(file, question)? {
        Some(what) => Ok(Err(what)),
        None => read_points(file).map(|(_, points)| Ok(points)),
    };
    let found = read_kind(path, SWEEP_FORMAT, read).map_err(|error| match error {
        StoreError::Foreign { path } => StoreError::NotASweep { path },
        error => error,
    })?;
    found.map_err(|what| StoreError::OtherSweep {
        path: path.to_owned(),
        what,
    })
}

/// The first difference between a stored sweep and this question, in words; `None` if there is
/// none.
fn difference(stored: &dyn Source, question: &SweepQuestion) -> Result<Option<String>, String> {
    let header = Provenance::of(&question.scenario);
    let text = |name| read_attribute::<String>(stored, name);
    let parts = |design: &Design| -> Vec<String> {
        let axes = design.axes().iter();
        let mut parts: Vec<String> = axes
            .map(|axis| format!("{} = {} at [{}]", axis.name, axis.key, axis.values))
            .collect();
        if let Design::Star {
            keys,
            relative_step,
        } = design
        {
            parts.extend(keys.iter().map(|(key, value)| format!("{key} = {value:?}")));
            parts.push(format!("relative step {relative_step:?}"));
        }
        parts.push(name(design).to_string());
        parts
    };
    let seeds = |name: &str| vec![format!("{name} seeds")];
    let bias = |with_bias| match with_bias {
        true => vec!["estimates the bias of the step".to_string()],
        false => vec!["leaves out the bias of the step".to_string()],
    };
    let samples = |samples: Vec<NamedSeries>| -> Vec<String> {
        let files = samples.into_iter().filter(|of| of.name.contains(".file="));
        let hashed =
            files.map(|of| format!("{} with hash {:016x}", of.name, of.series.fingerprint()));
        hashed.collect()
    };
    let stored_samples = samples(series::read(stored)?);
    let with_bias = text("bias_of_the_step")? == bias_name(true);
    let program = read_program(stored)?;
    let compared = [
        (lines(&text("scenario")?), lines(&header.scenario_text)),
        (parts(&read_design(stored)?), parts(&question.design)),
        (stored_samples, samples(question.samples_of_files())),
        (seeds(&text("seeds")?), seeds(question.seeds.name())),
        (bias(with_bias), bias(question.with_bias)),
        (vec![program.to_string()], vec![header.program.to_string()]),
    ];
    Ok(compared.iter().find_map(|(theirs, mine)| {
        let most = theirs.len().max(mine.len());
        let at =
            |list: &[String], i: usize| list.get(i).cloned().unwrap_or_else(|| "nothing".into());
        let differs = |&i: &usize| theirs.get(i) != mine.get(i);
        // A title lists what was changed, so the changed key says more.
        let is_title = |&i: &usize| at(theirs, i).starts_with("title = ");
        let i = (0..most)
            .find(|i| differs(i) && !is_title(i))
            .or_else(|| (0..most).find(differs))?;
        Some(format!(
            "it has `{}`, but this sweep has `{}`",
            at(theirs, i),
            at(mine, i)
        ))
    }))
}

/// The lines of a text without comments and empty lines.
fn lines(text: &str) -> Vec<String> {
    let said = text
        .lines()
        .map(|line| line.split("  #").next().unwrap_or("").trim().to_string());
    said.filter(|line| !line.is_empty()).collect()
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
