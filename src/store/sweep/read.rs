//! Reading the file of a sweep back, a finished one or one that is to be continued.

use crate::dataset::sweep::{SWEEP_FORMAT_NAME, SWEEP_FORMAT_VERSION, name};
use crate::dataset::{series, sweep_layout as own};
use crate::engine::Status;
use crate::model::Series;
use crate::provenance::Provenance;
use crate::stats::{Bias, Estimate, GROUPS, Statistic, Values};
use crate::store::StoreError;
use crate::store::error::cause;
use crate::store::reader::{check_file, open};
use crate::store::variable::read_text;
use crate::study::sweep::{Axis, Design, Point, Question, Seeds};
use hdf5::types::VarLenUnicode;
use hdf5::{Error, File, Result};
use std::path::Path;
use std::sync::Arc;

/// What the file of a sweep says.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredSweep {
    /// The scenario that the points are variations of, as TOML.
    pub scenario_text: String,
    /// What its temperature was measured to be, if it was.
    pub series: Option<Arc<Series>>,
    /// Version, commit, generator and block size of the program that wrote it, in a line.
    pub program: String,
    /// Which points there are.
    pub design: Design,
    /// Whether they see the same noise.
    pub seeds: Seeds,
    /// Whether the bias of the step was estimated.
    pub with_bias: bool,
    /// Whether all points are done.
    pub status: Status,
    /// Point by point; none where it is not done.
    pub points: Vec<Option<Point>>,
}

/// What makes numbers of a program: those of another one do not go with them.
fn program(version: &str, hash: &str, generator: &str, block_size: u64) -> String {
    format!("mc {version} ({hash}), {generator}, blocks of {block_size}")
}

impl StoredSweep {
    /// What it was asked otherwise than by this question, if anything.
    pub(super) fn difference_from(&self, header: &Provenance, question: &Question) -> Option<String> {
        let Provenance { program_version, git_hash, generator, block_size, .. } = header;
        let mine = program(program_version, git_hash, generator, *block_size);
        let parts = |design: &Design| -> Vec<String> {
            let axes = design.axes().iter();
            let mut parts: Vec<String> =
                axes.map(|axis| format!("{} = {} at {:?}", axis.name, axis.key, axis.values)).collect();
            if let Design::Star { keys, relative_step } = design {
                parts.extend(keys.iter().map(|(key, value)| format!("{key} = {value:?}")));
                parts.push(format!("relative step {relative_step:?}"));
            }
            parts.push(name(design).to_string());
            parts
        };
        let bias =
            |with_bias| if with_bias { "estimates the bias of the step" } else { "leaves out the bias of the step" };
        let compared = [
            (lines(&self.scenario_text), lines(&header.scenario_text)),
            (parts(&self.design), parts(&question.design)),
            (vec![format!("{} seeds", self.seeds.name())], vec![format!("{} seeds", question.seeds.name())]),
            (vec![bias(self.with_bias).to_string()], vec![bias(question.with_bias).to_string()]),
            (vec![self.program.clone()], vec![mine]),
        ];
        compared.iter().find_map(|(theirs, mine)| {
            let most = theirs.len().max(mine.len());
            let at = |list: &[String], i: usize| list.get(i).cloned().unwrap_or_else(|| "nothing".into());
            let i = (0..most).find(|&i| theirs.get(i) != mine.get(i))?;
            Some(format!("it has `{}`, and this sweep `{}`", at(theirs, i), at(mine, i)))
        })
    }
}

/// The lines that say something, without their comments.
fn lines(text: &str) -> Vec<String> {
    let said = text.lines().map(|line| line.split("  #").next().unwrap_or("").trim().to_string());
    said.filter(|line| !line.is_empty()).collect()
}

/// Read the file of a sweep.
pub fn read_sweep(path: &Path) -> std::result::Result<StoredSweep, StoreError> {
    check_file(path)?;
    let file = open(path)?;
    if read_text(&file, "format_name").ok().as_deref() != Some(SWEEP_FORMAT_NAME) {
        return Err(StoreError::NoSweep { path: path.to_owned() });
    }
    let damaged = |error: Error| StoreError::Damaged { path: path.to_owned(), cause: cause(&error) };
    let version = read_text(&file, "format_version").map_err(damaged)?;
    let major = version.split('.').next().and_then(|major| major.parse().ok()).unwrap_or(u32::MAX);
    if major > SWEEP_FORMAT_VERSION.0 {
        return Err(StoreError::Newer { path: path.to_owned(), major, minor: 0 });
    }
    contents(&file).map_err(damaged)
}

fn contents(file: &File) -> Result<StoredSweep> {
    let seeds = match read_text(file, "seeds")?.as_str() {
        "common" => Seeds::Common,
        "independent" => Seeds::Independent,
        other => return Err(format!("unknown seeds \"{other}\"").into()),
    };
    let design = design(file)?;
    let status = read_text(file, "status")?;
    Ok(StoredSweep {
        scenario_text: read_text(file, "scenario")?,
        series: series::read(file)?,
        program: program(
            &read_text(file, "program_version")?,
            &read_text(file, "git_hash")?,
            &read_text(file, "generator")?,
            file.attr("block_size")?.read_scalar()?,
        ),
        with_bias: read_text(file, "bias_of_the_step")? == "estimated",
        seeds,
        status: Status::from_name(&status).ok_or_else(|| format!("unknown status \"{status}\""))?,
        points: points(file, &design)?,
        design,
    })
}

fn design(file: &File) -> Result<Design> {
    let axes = || -> Result<Vec<Axis>> {
        let names = read_text(file, "axes")?;
        let axis = |name: &str| {
            let dataset = file.dataset(name)?;
            Ok(Axis { name: name.to_string(), key: read_text(&dataset, "key")?, values: dataset.read_raw()? })
        };
        names.split(' ').map(axis).collect()
    };
    let refused = |error: crate::study::sweep::DesignError| Error::from(error.to_string());
    match read_text(file, "design")?.as_str() {
        "grid" => Design::of(axes()?, false).map_err(refused),
        "zip" => Design::of(axes()?, true).map_err(refused),
        "elasticity" => {
            let keys: Vec<VarLenUnicode> = file.dataset(own::KEY.name)?.read_raw()?;
            let values: Vec<f64> = file.dataset(own::KEY_VALUE.name)?.read_raw()?;
            let keys = keys.iter().map(|key| key.as_str().to_string()).zip(values).collect();
            Ok(Design::Star { keys, relative_step: file.attr("relative_step")?.read_scalar()? })
        }
        other => Err(format!("unknown design \"{other}\"").into()),
    }
}

fn points(file: &File, design: &Design) -> Result<Vec<Option<Point>>> {
    let (points, statistics) = (design.points(), Statistic::ALL.len());
    // What a file says of its sizes is held against what its design asks for.
    let numbers = |name: &str, each: usize| -> Result<Vec<f64>> {
        let values: Vec<f64> = file.dataset(name)?.read_raw()?;
        if values.len() == points * each { Ok(values) } else { Err(format!("{name} has another size").into()) }
    };
    let whole = |name: &str| -> Result<Vec<u64>> {
        let values: Vec<u64> = file.dataset(name)?.read_raw()?;
        if values.len() == points { Ok(values) } else { Err(format!("{name} has another size").into()) }
    };
    let columns: Vec<Vec<f64>> =
        own::PER_STATISTIC.iter().map(|variable| numbers(variable.name, statistics)).collect::<Result<_>>()?;
    let without = numbers(own::ESTIMATE_WITHOUT.name, GROUPS * statistics)?;
    let seconds = numbers(own::POINT_SECONDS.name, 1)?;
    let (completed, diverged) = (whole(own::POINT_COMPLETED_PATHS.name)?, whole(own::POINT_DIVERGED_PATHS.name)?);
    let status: Vec<i8> = file.dataset(own::POINT_STATUS.name)?.read_raw()?;
    let point = |p: usize| -> Result<Option<Point>> {
        if status.get(p).copied().unwrap_or(0) == 0 {
            return Ok(None);
        }
        if diverged[p] > completed[p] {
            return Err("more diverged paths than paths".into());
        }
        let estimate = |statistic: Statistic| {
            let at = |column: usize| columns[column][p * statistics + statistic.index()];
            let bias =
                Bias { estimate: at(4), uncertainty: at(5), order: Some(at(6)).filter(|order| order.is_finite()) };
            Estimate {
                statistic,
                estimate: at(0),
                standard_error: at(1),
                low: at(2),
                high: at(3),
                bias: Some(bias).filter(|bias| bias.estimate.is_finite()),
            }
        };
        let group = |g: usize| -> Values {
            let first = (p * GROUPS + g) * statistics;
            Statistic::ALL.map(|statistic| without[first + statistic.index()])
        };
        Ok(Some(Point {
            estimates: Statistic::ALL.map(estimate),
            completed_paths: completed[p],
            diverged_paths: diverged[p],
            seconds: seconds[p],
            // There are fewer where there are fewer paths.
            without: (0..GROUPS).map(group).take_while(|values| values.iter().any(|x| !x.is_nan())).collect(),
        }))
    };
    (0..points).map(point).collect()
}
