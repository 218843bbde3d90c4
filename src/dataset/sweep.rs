//! A sweep as a data set: what was asked, what is known of every point, and what points say together.

use super::header::CONVENTIONS;
use super::layout::{Described, Unit, variable};
use super::summary::write_statistics;
use super::sweep_layout::{self as own, along};
use super::{Destination, series, texts};
use crate::engine::Status;
use crate::provenance::Provenance;
use crate::stats::{GROUPS, Statistic};
use crate::study::sweep::{Axis, Design, Paired, Point, Sweep};

/// What `format_name` says of a sweep.
pub(crate) const SWEEP_FORMAT_NAME: &str = "stick-slip sweep";

/// Major and minor version of that format.
pub(crate) const SWEEP_FORMAT_VERSION: (u32, u32) = (1, 0);

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
    to.say("Conventions", CONVENTIONS)?;
    to.say("title", header.title.as_str())?;
    to.say("format_name", SWEEP_FORMAT_NAME)?;
    to.say("format_version", format!("{major}.{minor}"))?;
    to.say("program_version", header.program_version.as_str())?;
    to.say("git_hash", header.git_hash.as_str())?;
    to.say("scheme", header.scheme.as_str())?;
    to.say("seed", header.seed)?;
    to.say("seeds", sweep.question.seeds.name())?;
    to.say("generator", header.generator.as_str())?;
    to.say("paths", header.paths)?;
    to.say("block_size", header.block_size)?;
    let status = if sweep.is_complete() { Status::Complete } else { Status::Running };
    to.say("status", status.name())?;
    to.say("points", sweep.points.len() as u64)?;
    to.say("completed_points", sweep.done() as u64)?;
    to.say("bias_of_the_step", if sweep.question.with_bias { "estimated" } else { "left out" })?;
    to.say("design", name(&sweep.question.design))?;
    let axes: Vec<&str> = sweep.question.design.axes().iter().map(|axis| axis.name.as_str()).collect();
    if !axes.is_empty() {
        to.say("axes", axes.join(" "))?;
    }
    if let Design::Star { relative_step, .. } = sweep.question.design {
        to.say("relative_step", relative_step)?;
    }
    to.say("scenario", header.scenario_text.as_str())
}

/// The word for a design.
pub(crate) fn name(design: &Design) -> &'static str {
    match design {
        Design::Grid(_) => "grid",
        Design::Zip(_) => "zip",
        Design::Star { .. } => "elasticity",
    }
}

/// The coordinates; returns the names of the dimensions of the design.
fn coordinates<D: Destination>(to: &mut D, sweep: &Sweep) -> Result<Vec<String>, D::Error> {
    write_statistics(to)?;
    to.put(&own::GROUP, &(0..GROUPS as u32).collect::<Vec<_>>())?;
    let design = &sweep.question.design;
    let numbers: Vec<u32> = (0..).take(design.points()).collect();
    match design {
        Design::Grid(axes) => {
            for axis in axes {
                put_axis(to, axis, &[&axis.name])?;
            }
            to.put(&own::ALONG, &texts(design.along()))?;
            Ok(axes.iter().map(|axis| axis.name.clone()).collect())
        }
        Design::Zip(axes) => {
            to.put(&own::POINT, &numbers)?;
            for axis in axes {
                put_axis(to, axis, &["point"])?;
            }
            to.put(&own::ALONG, &texts(design.along()))?;
            Ok(vec!["point".to_string()])
        }
        Design::Star { keys, .. } => {
            to.put(&own::POINT, &numbers)?;
            let settings: Vec<_> = (0..design.points()).map(|point| design.settings(point).pop()).collect();
            let key = |point: usize| settings[point].as_ref().map_or("none", |setting| setting.key.as_str());
            let value = |point: usize| settings[point].as_ref().map_or(f64::NAN, |setting| setting.value);
            to.put(&own::POINT_KEY, &texts((0..design.points()).map(key)))?;
            to.put(&own::POINT_VALUE, &(0..design.points()).map(value).collect::<Vec<_>>())?;
            to.put(&own::KEY, &texts(keys.iter().map(|key| key.0.as_str())))?;
            to.put(&own::KEY_VALUE, &keys.iter().map(|key| key.1).collect::<Vec<_>>())?;
            Ok(vec!["point".to_string()])
        }
    }
}

fn put_axis<D: Destination>(to: &mut D, axis: &Axis, axes: &[&str]) -> Result<(), D::Error> {
    let attributes = [("key", axis.key.as_str())];
    to.put(&variable(&axis.name, axes, Unit::None, &axis.key).with(&attributes), &axis.values)
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
        to.put(&along(variable, &dimensions, &attributes), &values)?;
    }
    let with_groups = [shape, &["group", "statistic"]].concat();
    let missing = [f64::NAN; Statistic::ALL.len()];
    let without = |point: &Option<Point>| {
        let known = point.as_ref().map_or(&[][..], |point| &point.without);
        let all = (0..GROUPS).map(|group| known.get(group).copied().unwrap_or(missing));
        all.flatten().collect::<Vec<f64>>()
    };
    let values: Vec<f64> = sweep.points.iter().flat_map(without).collect();
    to.put(&along(&own::ESTIMATE_WITHOUT, &with_groups, &[]), &values)?;

    let whole =
        |of: fn(&Point) -> u64| -> Vec<u64> { sweep.points.iter().map(|point| point.as_ref().map_or(0, of)).collect() };
    let status = |point: &Option<Point>| match point {
        None => 0,
        Some(point) if point.diverged_paths < point.completed_paths => 1,
        Some(_) => 2_i8,
    };
    let seconds = |point: &Option<Point>| point.as_ref().map_or(f64::NAN, |point| point.seconds);
    let seeds: Vec<u64> = sweep.question.points.iter().map(|scenario| scenario.ensemble.seed).collect();
    to.put(&along(&own::POINT_STATUS, shape, &[]), &sweep.points.iter().map(status).collect::<Vec<i8>>())?;
    to.put(&along(&own::POINT_COMPLETED_PATHS, shape, &[]), &whole(|point| point.completed_paths))?;
    to.put(&along(&own::POINT_DIVERGED_PATHS, shape, &[]), &whole(|point| point.diverged_paths))?;
    to.put(&along(&own::POINT_SEED, shape, &[]), &seeds)?;
    to.put(&along(&own::POINT_SECONDS, shape, &[]), &sweep.points.iter().map(seconds).collect::<Vec<f64>>())
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
    put_each(to, &own::PER_DIFFERENCE, &dimensions, &all)
}

fn elasticities<D: Destination>(to: &mut D, sweep: &Sweep, keys: usize) -> Result<(), D::Error> {
    let of = |key: usize| Statistic::ALL.map(|statistic| numbers(sweep.elasticity(key, statistic)));
    let all: Vec<[f64; 5]> = (0..keys).flat_map(of).collect();
    put_each(to, &own::PER_ELASTICITY, &["key", "statistic"], &all)
}

fn put_each<D: Destination>(
    to: &mut D,
    variables: &[Described],
    dimensions: &[&str],
    all: &[[f64; 5]],
) -> Result<(), D::Error> {
    for (i, variable) in variables.iter().enumerate() {
        let described = Described { axes: dimensions, ..*variable };
        to.put(&described, &all.iter().map(|numbers| numbers[i]).collect::<Vec<f64>>())?;
    }
    Ok(())
}
