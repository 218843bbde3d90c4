//! A sweep as a data set: the question, the results of every point, and the comparisons between
//! points.

use super::header::CONVENTIONS;
use super::layout::{Described, Unit, Variable, variable};
use super::summary::write_statistics;
use super::sweep_layout::{self as own, along};
use super::{
    Destination, Element, Source, read_count, read_or_empty, read_other_program, read_real, read_text, read_text_of,
    read_variable, series, texts,
};
use crate::engine::{Provenance, Status};
use crate::model::Series;
use crate::scenario::Scenario;
use crate::stats::{Bias, Estimate, GROUPS, Statistic, Values};
use crate::study::sweep::{Axis, Design, DesignError, Paired, Point, Question, Seeds, Setting, Sweep};
use std::sync::Arc;

/// The attribute `format_name` of a sweep.
pub(crate) const SWEEP_FORMAT_NAME: &str = "stick-slip sweep";

/// Major and minor version of the format.
pub(crate) const SWEEP_FORMAT_VERSION: (u32, u32) = (1, 0);

/// A sweep as it is read back from a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredSweep {
    /// The scenario that the points are variations of, as TOML.
    pub scenario_text: String,
    /// The measured temperature of the scenario, if there is one.
    pub series: Option<Arc<Series>>,
    /// Version, commit, generator and block size of the program that wrote the sweep, in one line.
    pub program: String,
    /// The program that wrote the sweep, if it was another one.
    pub other_program: Option<String>,
    /// The design, which determines the points.
    pub design: Design,
    /// Whether all points see the same noise.
    pub seeds: Seeds,
    /// Whether the bias of the step was estimated.
    pub with_bias: bool,
    /// Whether all points are done.
    pub status: Status,
    /// The result of each point; none if the point is not done.
    pub points: Vec<Option<Point>>,
}

impl StoredSweep {
    /// The sweep, where `scenario_at` gives the scenario of a point from its settings. Fails if
    /// `scenario_at` does.
    pub fn whole<E>(self, scenario_at: impl Fn(&[Setting]) -> Result<Scenario, E>) -> Result<Sweep, E> {
        let question = Question::at_each(self.design, self.seeds, self.with_bias, scenario_at)?;
        Ok(Sweep { question, points: self.points })
    }
}

/// Everything about a program that decides its numbers, in one line. Points of programs that differ
/// in it must not be in one sweep.
pub(crate) fn program(version: &str, hash: &str, generator: &str, block_size: u64) -> String {
    format!("mc {version} ({hash}), {generator}, blocks of {block_size}")
}

/// Write a sweep.
pub(crate) fn write<D: Destination>(to: &mut D, header: &Provenance, sweep: &Sweep) -> Result<(), D::Error> {
    attributes(to, header, sweep)?;
    if let Some(samples) = &header.series {
        series::write(to, samples, header.series_start.as_deref())?;
    }
    let shape = coordinates(to, sweep)?;
    let shape: Vec<&str> = shape.iter().map(String::as_str).collect();
    points(to, sweep, &shape)?;
    match &sweep.question.design {
        Design::Star { keys, .. } => elasticities(to, sweep, keys.len()),
        Design::Grid(_) | Design::Zip(_) => differences(to, sweep, &shape),
    }
}

fn attributes<D: Destination>(to: &mut D, header: &Provenance, sweep: &Sweep) -> Result<(), D::Error> {
    let (major, minor) = SWEEP_FORMAT_VERSION;
    to.set_attribute("Conventions", CONVENTIONS)?;
    to.set_attribute("title", header.title.as_str())?;
    to.set_attribute("format_name", SWEEP_FORMAT_NAME)?;
    to.set_attribute("format_version", format!("{major}.{minor}"))?;
    to.set_attribute("program_version", header.program_version.as_str())?;
    to.set_attribute("git_hash", header.git_hash.as_str())?;
    to.set_attribute("scheme", header.scheme.as_str())?;
    to.set_attribute("seed", header.seed)?;
    to.set_attribute("seeds", sweep.question.seeds.name())?;
    to.set_attribute("generator", header.generator.as_str())?;
    to.set_attribute("paths", header.paths)?;
    to.set_attribute("block_size", header.block_size)?;
    let status = if sweep.is_complete() { Status::Complete } else { Status::Running };
    to.set_attribute("status", status.name())?;
    to.set_attribute("points", sweep.points.len() as u64)?;
    to.set_attribute("completed_points", sweep.done() as u64)?;
    to.set_attribute("bias_of_the_step", if sweep.question.with_bias { "estimated" } else { "left out" })?;
    to.set_attribute("design", name(&sweep.question.design))?;
    let axes: Vec<&str> = sweep.question.design.axes().iter().map(|axis| axis.name.as_str()).collect();
    if !axes.is_empty() {
        to.set_attribute("axes", axes.join(" "))?;
    }
    if let Design::Star { relative_step, .. } = sweep.question.design {
        to.set_attribute("relative_step", relative_step)?;
    }
    to.set_attribute("scenario", header.scenario_text.as_str())
}

/// The name of a design.
pub(crate) fn name(design: &Design) -> &'static str {
    match design {
        Design::Grid(_) => "grid",
        Design::Zip(_) => "zip",
        Design::Star { .. } => "elasticity",
    }
}

/// Write the coordinates. Returns the names of the dimensions of the design.
fn coordinates<D: Destination>(to: &mut D, sweep: &Sweep) -> Result<Vec<String>, D::Error> {
    write_statistics(to)?;
    to.write_variable(&own::GROUP, &(0..GROUPS as u32).collect::<Vec<_>>())?;
    let design = &sweep.question.design;
    let numbers: Vec<u32> = (0..).take(design.points()).collect();
    match design {
        Design::Grid(axes) => {
            for axis in axes {
                write_axis(to, axis, &[&axis.name])?;
            }
            to.write_variable(&own::ALONG, &texts(design.along()))?;
            Ok(axes.iter().map(|axis| axis.name.clone()).collect())
        }
        Design::Zip(axes) => {
            to.write_variable(&own::POINT, &numbers)?;
            for axis in axes {
                write_axis(to, axis, &["point"])?;
            }
            to.write_variable(&own::ALONG, &texts(design.along()))?;
            Ok(vec!["point".to_string()])
        }
        Design::Star { keys, .. } => {
            to.write_variable(&own::POINT, &numbers)?;
            let settings: Vec<_> = (0..design.points()).map(|point| design.settings(point).pop()).collect();
            let key = |point: usize| settings[point].as_ref().map_or("none", |setting| setting.key.as_str());
            let value = |point: usize| settings[point].as_ref().map_or(f64::NAN, |setting| setting.value);
            to.write_variable(&own::POINT_KEY, &texts((0..design.points()).map(key)))?;
            to.write_variable(&own::POINT_VALUE, &(0..design.points()).map(value).collect::<Vec<_>>())?;
            to.write_variable(&own::KEY, &texts(keys.iter().map(|key| key.0.as_str())))?;
            to.write_variable(&own::KEY_VALUE, &keys.iter().map(|key| key.1).collect::<Vec<_>>())?;
            Ok(vec!["point".to_string()])
        }
    }
}

fn write_axis<D: Destination>(to: &mut D, axis: &Axis, axes: &[&str]) -> Result<(), D::Error> {
    let attributes = [("key", axis.key.as_str())];
    to.write_variable(&variable(&axis.name, axes, Unit::None, &axis.key).with(&attributes), &axis.values)
}

fn points<D: Destination>(to: &mut D, sweep: &Sweep, shape: &[&str]) -> Result<(), D::Error> {
    let axes = sweep.question.design.axes();
    let mut coordinates = "statistic_long_name statistic_unit".to_string();
    match sweep.question.design {
        Design::Grid(_) => {}
        Design::Zip(_) => axes.iter().for_each(|axis| coordinates = format!("{coordinates} {}", axis.name)),
        Design::Star { .. } => coordinates.push_str(" point_key point_value"),
    }
    let attributes = [("coordinates", coordinates.as_str())];
    let dimensions = [shape, &["statistic"]].concat();
    for (i, variable) in own::PER_STATISTIC.iter().enumerate() {
        let of = |point: &Option<Point>| match point {
            Some(point) => point.estimates.map(|e| {
                let corrected = e.corrected();
                let bias = e.bias;
                [
                    e.estimate,
                    e.standard_error,
                    e.low,
                    e.high,
                    bias.map_or(f64::NAN, |bias| bias.estimate),
                    bias.map_or(f64::NAN, |bias| bias.uncertainty),
                    bias.and_then(|bias| bias.order).unwrap_or(f64::NAN),
                    corrected.map_or(f64::NAN, |corrected| corrected.estimate),
                    corrected.map_or(f64::NAN, |corrected| corrected.low),
                    corrected.map_or(f64::NAN, |corrected| corrected.high),
                ][i]
            }),
            None => [f64::NAN; Statistic::ALL.len()],
        };
        let values: Vec<f64> = sweep.points.iter().flat_map(of).collect();
        to.write_variable(&along(variable, &dimensions, &attributes), &values)?;
    }
    let with_groups = [shape, &["group", "statistic"]].concat();
    let missing = [f64::NAN; Statistic::ALL.len()];
    let without = |point: &Option<Point>| {
        let known = point.as_ref().map_or(&[][..], |point| &point.without);
        let all = (0..GROUPS).map(|group| known.get(group).copied().unwrap_or(missing));
        all.flatten().collect::<Vec<f64>>()
    };
    let values: Vec<f64> = sweep.points.iter().flat_map(without).collect();
    to.write_variable(&along(&own::ESTIMATE_WITHOUT, &with_groups, &[]), &values)?;

    let whole =
        |of: fn(&Point) -> u64| -> Vec<u64> { sweep.points.iter().map(|point| point.as_ref().map_or(0, of)).collect() };
    let status = |point: &Option<Point>| match point {
        None => 0,
        Some(point) if point.diverged_paths < point.completed_paths => 1,
        Some(_) => 2_i8,
    };
    let seconds = |point: &Option<Point>| point.as_ref().map_or(f64::NAN, |point| point.seconds);
    let seeds: Vec<u64> = sweep.question.points.iter().map(|scenario| scenario.ensemble.seed).collect();
    to.write_variable(&along(&own::POINT_STATUS, shape, &[]), &sweep.points.iter().map(status).collect::<Vec<i8>>())?;
    to.write_variable(&along(&own::POINT_COMPLETED_PATHS, shape, &[]), &whole(|point| point.completed_paths))?;
    to.write_variable(&along(&own::POINT_DIVERGED_PATHS, shape, &[]), &whole(|point| point.diverged_paths))?;
    to.write_variable(&along(&own::POINT_SEED, shape, &[]), &seeds)?;
    to.write_variable(&along(&own::POINT_SECONDS, shape, &[]), &sweep.points.iter().map(seconds).collect::<Vec<f64>>())
}

fn numbers(paired: Option<Paired>) -> [f64; 5] {
    let Paired { measurement: m, gain } = paired.unwrap_or(Paired::NOTHING);
    [m.estimate, m.standard_error, m.low, m.high, gain]
}

fn differences<D: Destination>(to: &mut D, sweep: &Sweep, shape: &[&str]) -> Result<(), D::Error> {
    let mut all: Vec<[f64; 5]> = Vec::new();
    for dimension in 0..sweep.question.design.along().len() {
        for point in 0..sweep.points.len() {
            let of = |statistic| numbers(sweep.difference(point, dimension, statistic));
            all.extend(Statistic::ALL.map(of));
        }
    }
    let dimensions = [&["along"], shape, &["statistic"]].concat();
    write_each(to, &own::PER_DIFFERENCE, &dimensions, &all)
}

fn elasticities<D: Destination>(to: &mut D, sweep: &Sweep, keys: usize) -> Result<(), D::Error> {
    let of = |key: usize| Statistic::ALL.map(|statistic| numbers(sweep.elasticity(key, statistic)));
    let all: Vec<[f64; 5]> = (0..keys).flat_map(of).collect();
    write_each(to, &own::PER_ELASTICITY, &["key", "statistic"], &all)
}

fn write_each<D: Destination>(
    to: &mut D,
    variables: &[Described],
    dimensions: &[&str],
    all: &[[f64; 5]],
) -> Result<(), D::Error> {
    for (i, variable) in variables.iter().enumerate() {
        let described = Described { axes: dimensions, ..*variable };
        to.write_variable(&described, &all.iter().map(|numbers| numbers[i]).collect::<Vec<f64>>())?;
    }
    Ok(())
}

/// Read a sweep.
pub(crate) fn read<S: Source>(from: &S) -> Result<StoredSweep, S::Error> {
    let seeds = match read_text(from, "seeds")?.as_str() {
        "common" => Seeds::Common,
        "independent" => Seeds::Independent,
        other => return Err(format!("unknown seeds \"{other}\"").into()),
    };
    let design = read_design(from)?;
    let status = read_text(from, "status")?;
    Ok(StoredSweep {
        scenario_text: read_text(from, "scenario")?,
        series: series::read(from)?,
        program: program(
            &read_text(from, "program_version")?,
            &read_text(from, "git_hash")?,
            &read_text(from, "generator")?,
            read_count(from, "block_size")?,
        ),
        other_program: read_other_program(from)?,
        with_bias: read_text(from, "bias_of_the_step")? == "estimated",
        seeds,
        status: Status::from_name(&status).ok_or_else(|| format!("unknown status \"{status}\""))?,
        points: read_points(from, &design)?,
        design,
    })
}

fn read_design<S: Source>(from: &S) -> Result<Design, S::Error> {
    let axes = |dimension: Option<&str>| -> Result<Vec<Axis>, S::Error> {
        let names = read_text(from, "axes")?;
        let axis = |name: &str| {
            let axes = [dimension.unwrap_or(name)];
            let values = read_variable(from, &variable(name, &axes, Unit::None, ""))?;
            Ok(Axis { name: name.to_string(), key: read_text_of(from, name, "key")?, values })
        };
        names.split(' ').map(axis).collect()
    };
    let refused = |error: DesignError| S::Error::from(error.to_string());
    match read_text(from, "design")?.as_str() {
        "grid" => Design::of(axes(None)?, false).map_err(refused),
        "zip" => Design::of(axes(Some("point"))?, true).map_err(refused),
        "elasticity" => {
            let keys: Vec<String> = read_variable(from, &own::KEY)?;
            let keys = keys.into_iter().zip(read_variable(from, &own::KEY_VALUE)?).collect();
            Ok(Design::Star { keys, relative_step: read_real(from, "relative_step")? })
        }
        other => Err(format!("unknown design \"{other}\"").into()),
    }
}

fn read_points<S: Source>(from: &S, design: &Design) -> Result<Vec<Option<Point>>, S::Error> {
    let (points, statistics) = (design.points(), Statistic::ALL.len());
    let axes: Vec<&str> = match design {
        Design::Grid(axes) => axes.iter().map(|axis| axis.name.as_str()).collect(),
        Design::Zip(_) | Design::Star { .. } => vec!["point"],
    };
    let columns = own::PER_STATISTIC.iter().map(|variable| read_at_points(from, variable, &axes, points * statistics));
    let columns: Vec<Vec<f64>> = columns.collect::<Result<_, _>>()?;
    let without: Vec<f64> = read_at_points(from, &own::ESTIMATE_WITHOUT, &axes, points * GROUPS * statistics)?;
    let seconds: Vec<f64> = read_at_points(from, &own::POINT_SECONDS, &axes, points)?;
    let completed: Vec<u64> = read_at_points(from, &own::POINT_COMPLETED_PATHS, &axes, points)?;
    let diverged: Vec<u64> = read_at_points(from, &own::POINT_DIVERGED_PATHS, &axes, points)?;
    let status: Vec<i8> = read_at_points(from, &own::POINT_STATUS, &axes, points)?;
    let point = |p: usize| -> Result<Option<Point>, S::Error> {
        if status[p] == 0 {
            return Ok(None);
        }
        if diverged[p] > completed[p] {
            return Err("more diverged paths than paths".to_string().into());
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
            // There are fewer groups where there are fewer paths.
            without: (0..GROUPS).map(group).take_while(|values| values.iter().any(|x| !x.is_nan())).collect(),
        }))
    };
    (0..points).map(point).collect()
}

/// Read a variable along the dimensions of the design and then its own. Its size must be the one
/// that the design requires.
fn read_at_points<S: Source, T: Element>(
    from: &S,
    variable: &Variable,
    axes: &[&str],
    length: usize,
) -> Result<Vec<T>, S::Error> {
    let axes = [axes, variable.axes].concat();
    match read_or_empty(from, &along(variable, &axes, &[]))? {
        values if values.len() == length => Ok(values),
        _ => Err(format!("{} has another size", variable.name).into()),
    }
}
