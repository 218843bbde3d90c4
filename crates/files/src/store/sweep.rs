//! The file of a sweep: the question, the results at every point, and the comparisons between
//! points.
//!
//! ```text
//! SweepFile::open   takes the lock, and returns the points that are saved already
//!   -> save         replaces NAME.partial/points.h5, a complete file of the points done so far
//!     -> finish     gives that file the name NAME
//! ```

use super::StoreError;
use super::kinds::{check_file, read_kind};
use super::staging::{self, POINTS, Partial, RESULTS, Staging, lock, next_save, partial_path};
use super::system::{check_space, parent};
use super::writer::write_results;
use crate::saved::{first_difference, lines};
use std::path::Path;
use std::time::Instant;
use stickslip::dataset::header::read_program;
use stickslip::dataset::sweep::{SWEEP_FORMAT, bias_name, name, read_design, read_points};
use stickslip::dataset::{Dataset, Source, read_attribute, series};
use stickslip::engine::{Program, Provenance};
use stickslip::model::NamedSeries;
use stickslip::stats::{GROUPS, Statistic};
use stickslip::study::sweep::{Design, Point, Sweep, SweepQuestion};

/// Bytes of a sample of a record, with its time and the number of its record.
const OF_SAMPLE: usize = 20;

/// The file of a sweep that is being simulated. It holds the lock, so that no other process writes
/// the file at the same time.
#[derive(Debug)]
pub struct SweepFile {
    staging: Staging,
    /// When the points are to be saved next.
    due: Instant,
}

impl SweepFile {
    /// Take the lock for a sweep, and return the points that are known already. They come from the
    /// target, if it exists and has the same question (if it has all points, no file is written),
    /// or from the `NAME.partial` of an interrupted sweep with the same question. A file with
    /// another question, or one changed by another program, is an error, unless `force` allows
    /// replacing it.
    pub fn open(
        target: &Path,
        question: &SweepQuestion,
        force: bool,
    ) -> Result<(Option<SweepFile>, Vec<Option<Point>>), StoreError> {
        let lock = lock(target)?;
        let mut left = staging::unfinished(target);
        if matches!(left, Partial::Named | Partial::Empty) {
            staging::clear(target)?;
            left = Partial::Nothing;
        }
        let is_there = target.symlink_metadata().is_ok() && !force;
        let known = match left {
            _ if is_there => Some(same_question(target, question)?),
            Partial::Sweep => match same_question(&partial_path(target).join(POINTS), question) {
                Err(_) if force => None,
                points => Some(points?),
            },
            _ => None,
        };
        let is_continued = known.is_some() && !is_there;
        let points = known.unwrap_or_else(|| vec![None; question.points.len()]);
        if is_there && points.iter().all(Option::is_some) {
            return Ok((None, points));
        }
        let samples = question.samples_of_files();
        let samples: usize = samples.iter().map(|of| of.series.times().len()).sum();
        let bytes = sweep_bytes(&question.design) + (samples * OF_SAMPLE) as u64;
        check_space(&parent(target), 2 * bytes)?;
        let staging = if is_continued {
            Staging::enter(target, force, lock)?
        } else {
            staging::make_room(target, force)?;
            // An incomplete file of this question is replaced by a complete one.
            Staging::create(target, force || is_there, lock)?
        };
        let due = Instant::now();
        Ok((Some(SweepFile { staging, due }), points))
    }

    /// Save the points, unless they were saved recently.
    pub fn save(&mut self, sweep: &Sweep) -> Result<(), StoreError> {
        if Instant::now() >= self.due {
            self.save_now(sweep)
        } else {
            Ok(())
        }
    }

    /// Save the points now.
    pub fn save_now(&mut self, sweep: &Sweep) -> Result<(), StoreError> {
        let start = Instant::now();
        write_results(&self.staging, Dataset::of_sweep(sweep))?;
        self.staging.replace(RESULTS, POINTS)?;
        self.due = next_save(start);
        Ok(())
    }

    /// Save the points for the last time and give the file its name. Every point must be done.
    pub fn finish(mut self, sweep: &Sweep) -> Result<(), StoreError> {
        self.save_now(sweep)?;
        self.staging.publish(POINTS)
    }
}

/// The points in a file, if it is of this question and was written by this program; an error
/// otherwise.
fn same_question(path: &Path, question: &SweepQuestion) -> Result<Vec<Option<Point>>, StoreError> {
    if !check_file(path)? {
        return Err(StoreError::NoChecksum {
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
    let bias = |with_bias| match with_bias {
        true => "estimates the bias of the step",
        false => "leaves out the bias of the step",
    };
    let described = |scenario: &str, design: &Design, seeds: &str, with_bias, program: &Program| {
        let mut all = lines(scenario);
        let axes = design.axes().iter();
        all.extend(axes.map(|axis| format!("{} = {} at [{}]", axis.name, axis.key, axis.values)));
        if let Design::Star {
            keys,
            relative_step,
        } = design
        {
            all.extend(keys.iter().map(|(key, value)| format!("{key} = {value:?}")));
            all.push(format!("relative step {relative_step:?}"));
        }
        all.extend([name(design).to_string(), format!("{seeds} seeds")]);
        all.extend([bias(with_bias).to_string(), program.to_string()]);
        all
    };
    let samples = |samples: Vec<NamedSeries>| {
        let files = samples.into_iter().filter(|of| of.name.contains(".file="));
        let hashed =
            files.map(|of| format!("{} with hash {:016x}", of.name, of.series.fingerprint()));
        hashed.collect::<Vec<String>>()
    };
    let mut mine = described(
        &header.scenario_text,
        &question.design,
        question.seeds.name(),
        question.with_bias,
        &header.program,
    );
    mine.extend(samples(question.samples_of_files()));
    let mut theirs = described(
        &text("scenario")?,
        &read_design(stored)?,
        &text("seeds")?,
        text("bias_of_the_step")? == bias_name(true),
        &read_program(stored)?,
    );
    theirs.extend(samples(series::read(stored)?));
    Ok(first_difference(&theirs, &mine)
        .map(|[theirs, mine]| format!("it has `{theirs}`, but this sweep has `{mine}`")))
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
