//! Writing the file of a sweep: whole, beside the earlier one, then in its place.

use super::layout::{self as own, along};
use super::{SWEEP_FORMAT_NAME, SWEEP_FORMAT_VERSION};
use crate::engine::Status;
use crate::provenance::Provenance;
use crate::stats::{GROUPS, Statistic};
use crate::store::error::{cause, is_full, system_error};
use crate::store::layout::{self, Described, Unit, variable};
use crate::store::series;
use crate::store::variable::{Place, text, write_attribute, write_text};
use crate::store::writer::create_file;
use crate::store::{StoreError, seal};
use crate::study::sweep::{Design, Paired, Point, Sweep};
use hdf5::types::VarLenUnicode;
use std::fs;
use std::path::{Path, PathBuf};

/// Write a sweep to this path in one step: at every moment there is the earlier file or the new one.
pub(super) fn replace(path: &Path, header: &Provenance, sweep: &Sweep) -> Result<(), StoreError> {
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    let beside = PathBuf::from(name);
    // Left by a process that was killed while it wrote it; ours is the only one that may.
    let _ = fs::remove_file(&beside);
    let file = create_file(&beside)
        .map_err(|error| StoreError::NotCreated { partial: beside.clone(), cause: cause(&error) })?;
    let place = Place { file, units: header.units.clone() };
    let failed = |full: bool, cause: String| match full {
        true => StoreError::DiskFull { partial: beside.clone(), target: path.to_owned(), saved_paths: 0, cause },
        false => StoreError::Write { partial: beside.clone(), target: path.to_owned(), saved_paths: 0, cause },
    };
    if let Err(error) = fill(&place, header, sweep).and_then(|()| place.file.flush()) {
        // As for a run: closing a file that could not be written may crash the library.
        std::mem::forget(place);
        return Err(failed(system_error(&error).is_some_and(|system| is_full(&system)), cause(&error)));
    }
    drop(place);
    seal::seal(&beside).map_err(|error| failed(is_full(&error), error.to_string()))?;
    rename(&beside, path)
}

/// Give a whole file its name, and bring the name to the disk.
pub(super) fn rename(from: &Path, to: &Path) -> Result<(), StoreError> {
    let failed = |source| StoreError::Rename { partial: from.to_owned(), target: to.to_owned(), source };
    fs::rename(from, to).map_err(failed)?;
    let folder = to.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Some file systems do not sync folders; the file itself is on the disk.
    let _ = fs::File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}

fn fill(place: &Place, header: &Provenance, sweep: &Sweep) -> hdf5::Result<()> {
    attributes(place, header, sweep)?;
    if let Some(samples) = &header.series {
        series::write(place, samples, header.series_start.as_deref())?;
    }
    let shape = coordinates(place, sweep)?;
    let shape: Vec<&str> = shape.iter().map(String::as_str).collect();
    points(place, sweep, &shape)?;
    match &sweep.question.design {
        Design::Star { keys, .. } => elasticities(place, sweep, keys.len()),
        Design::Grid(_) | Design::Zip(_) => differences(place, sweep, &shape),
    }
}

fn attributes(place: &Place, header: &Provenance, sweep: &Sweep) -> hdf5::Result<()> {
    let file = &place.file;
    let (major, minor) = SWEEP_FORMAT_VERSION;
    write_text(file, "Conventions", "CF-1.11")?;
    write_text(file, "title", &header.title)?;
    write_text(file, "format_name", SWEEP_FORMAT_NAME)?;
    write_text(file, "format_version", &format!("{major}.{minor}"))?;
    write_text(file, "program_version", &header.program_version)?;
    write_text(file, "git_hash", &header.git_hash)?;
    write_text(file, "scheme", &header.scheme)?;
    write_attribute(file, "seed", header.seed)?;
    write_text(file, "seeds", sweep.question.seeds.name())?;
    write_text(file, "generator", &header.generator)?;
    write_attribute(file, "paths", header.paths)?;
    write_attribute(file, "block_size", header.block_size)?;
    let status = if sweep.is_complete() { Status::Complete } else { Status::Running };
    write_text(file, "status", status.name())?;
    write_attribute(file, "points", sweep.points.len() as u64)?;
    write_attribute(file, "completed_points", sweep.done() as u64)?;
    write_text(file, "bias_of_the_step", if sweep.question.with_bias { "estimated" } else { "left out" })?;
    write_text(file, "design", name(&sweep.question.design))?;
    let axes: Vec<&str> = sweep.question.design.axes().iter().map(|axis| axis.name.as_str()).collect();
    if !axes.is_empty() {
        write_text(file, "axes", &axes.join(" "))?;
    }
    if let Design::Star { relative_step, .. } = sweep.question.design {
        write_attribute(file, "relative_step", relative_step)?;
    }
    write_text(file, "scenario", &header.scenario_text)
}

/// The word for a design.
pub(super) fn name(design: &Design) -> &'static str {
    match design {
        Design::Grid(_) => "grid",
        Design::Zip(_) => "zip",
        Design::Star { .. } => "elasticity",
    }
}

fn texts<'a>(of: impl IntoIterator<Item = &'a str>) -> hdf5::Result<Vec<VarLenUnicode>> {
    of.into_iter().map(text).collect()
}

/// The coordinates; returns the names of the dimensions of the design.
fn coordinates(place: &Place, sweep: &Sweep) -> hdf5::Result<Vec<String>> {
    let units = Statistic::ALL.map(|statistic| statistic.dimension().udunits(&place.units));
    place.put(&layout::STATISTIC, &texts(Statistic::ALL.map(Statistic::name))?)?;
    place.put(&layout::STATISTIC_LONG_NAME, &texts(Statistic::ALL.map(layout::long_name))?)?;
    place.put(&layout::STATISTIC_UNIT, &texts(units.iter().map(String::as_str))?)?;
    place.put(&own::GROUP, &(0..GROUPS as u32).collect::<Vec<_>>())?;
    let design = &sweep.question.design;
    let numbers: Vec<u32> = (0..).take(design.points()).collect();
    match design {
        Design::Grid(axes) => {
            for axis in axes {
                put_axis(place, axis, &[&axis.name])?;
            }
            place.put(&own::ALONG, &texts(design.along())?)?;
            Ok(axes.iter().map(|axis| axis.name.clone()).collect())
        }
        Design::Zip(axes) => {
            place.put(&own::POINT, &numbers)?;
            for axis in axes {
                put_axis(place, axis, &["point"])?;
            }
            place.put(&own::ALONG, &texts(design.along())?)?;
            Ok(vec!["point".to_string()])
        }
        Design::Star { keys, .. } => {
            place.put(&own::POINT, &numbers)?;
            let settings: Vec<_> = (0..design.points()).map(|point| design.settings(point).pop()).collect();
            let key = |point: usize| settings[point].as_ref().map_or("none", |setting| setting.key.as_str());
            let value = |point: usize| settings[point].as_ref().map_or(f64::NAN, |setting| setting.value);
            place.put(&own::POINT_KEY, &texts((0..design.points()).map(key))?)?;
            place.put(&own::POINT_VALUE, &(0..design.points()).map(value).collect::<Vec<_>>())?;
            place.put(&own::KEY, &texts(keys.iter().map(|key| key.0.as_str()))?)?;
            place.put(&own::KEY_VALUE, &keys.iter().map(|key| key.1).collect::<Vec<_>>())?;
            Ok(vec!["point".to_string()])
        }
    }
}

fn put_axis(place: &Place, axis: &crate::study::sweep::Axis, axes: &[&str]) -> hdf5::Result<()> {
    let attributes = [("key", axis.key.as_str())];
    place.put(&variable(&axis.name, axes, Unit::None, &axis.key).with(&attributes), &axis.values)
}

fn points(place: &Place, sweep: &Sweep, shape: &[&str]) -> hdf5::Result<()> {
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
        place.put(&along(variable, &dimensions, &attributes), &values)?;
    }
    let with_groups = [shape, &["group", "statistic"]].concat();
    let missing = [f64::NAN; Statistic::ALL.len()];
    let without = |point: &Option<Point>| {
        let known = point.as_ref().map_or(&[][..], |point| &point.without);
        let all = (0..GROUPS).map(|group| known.get(group).copied().unwrap_or(missing));
        all.flatten().collect::<Vec<f64>>()
    };
    let values: Vec<f64> = sweep.points.iter().flat_map(without).collect();
    place.put(&along(&own::ESTIMATE_WITHOUT, &with_groups, &[]), &values)?;

    let whole =
        |of: fn(&Point) -> u64| -> Vec<u64> { sweep.points.iter().map(|point| point.as_ref().map_or(0, of)).collect() };
    let status = |point: &Option<Point>| match point {
        None => 0,
        Some(point) if point.diverged_paths < point.completed_paths => 1,
        Some(_) => 2_i8,
    };
    let seconds = |point: &Option<Point>| point.as_ref().map_or(f64::NAN, |point| point.seconds);
    let seeds: Vec<u64> = sweep.question.points.iter().map(|scenario| scenario.ensemble.seed).collect();
    place.put(&along(&own::POINT_STATUS, shape, &[]), &sweep.points.iter().map(status).collect::<Vec<i8>>())?;
    place.put(&along(&own::POINT_COMPLETED_PATHS, shape, &[]), &whole(|point| point.completed_paths))?;
    place.put(&along(&own::POINT_DIVERGED_PATHS, shape, &[]), &whole(|point| point.diverged_paths))?;
    place.put(&along(&own::POINT_SEED, shape, &[]), &seeds)?;
    place.put(&along(&own::POINT_SECONDS, shape, &[]), &sweep.points.iter().map(seconds).collect::<Vec<f64>>())
}

fn numbers(paired: Option<Paired>) -> [f64; 5] {
    let Paired { measurement: m, gain } = paired.unwrap_or(Paired::NOTHING);
    [m.estimate, m.standard_error, m.low, m.high, gain]
}

fn differences(place: &Place, sweep: &Sweep, shape: &[&str]) -> hdf5::Result<()> {
    let mut all: Vec<[f64; 5]> = Vec::new();
    for dimension in 0..sweep.question.design.along().len() {
        for point in 0..sweep.points.len() {
            let of = |statistic| numbers(sweep.difference(point, dimension, statistic));
            all.extend(Statistic::ALL.map(of));
        }
    }
    let dimensions = [&["along"], shape, &["statistic"]].concat();
    put_each(place, &own::PER_DIFFERENCE, &dimensions, &all)
}

fn elasticities(place: &Place, sweep: &Sweep, keys: usize) -> hdf5::Result<()> {
    let of = |key: usize| Statistic::ALL.map(|statistic| numbers(sweep.elasticity(key, statistic)));
    let all: Vec<[f64; 5]> = (0..keys).flat_map(of).collect();
    put_each(place, &own::PER_ELASTICITY, &["key", "statistic"], &all)
}

fn put_each(place: &Place, variables: &[Described], dimensions: &[&str], all: &[[f64; 5]]) -> hdf5::Result<()> {
    for (i, variable) in variables.iter().enumerate() {
        let described = Described { axes: dimensions, ..*variable };
        place.put(&described, &all.iter().map(|numbers| numbers[i]).collect::<Vec<f64>>())?;
    }
    Ok(())
}
