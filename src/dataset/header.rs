//! The attributes of the data set of a run, which say where its numbers come from. One walk writes
//! them and reads them back.

use super::walk::{Reading, Walk};
use super::{Destination, Source, read_attribute};
use crate::engine::{NoPart, Part, Provenance, Status};
use crate::model::{PAPER, Series};
use crate::stats::Units;
use std::sync::Arc;

/// The attribute `format_name` of every run of this program.
pub(crate) const FORMAT_NAME: &str = "stick-slip ensemble";

/// Major and minor version of the format. A new minor version only adds to it; a new major version
/// may change or remove.
pub const FORMAT_VERSION: (u32, u32) = (2, 0);

/// Version of the CF conventions that every data set follows.
pub(crate) const CONVENTIONS: &str = "CF-1.11";

/// Write every attribute of a run that has just started.
pub(crate) fn write<D: Destination>(to: &mut D, header: &Provenance) -> Result<(), D::Error> {
    walk(to, &mut header.clone())
}

/// The attributes of a run, given its output grid and the measured temperature.
pub(crate) fn read<S: Source>(from: &S, time: Vec<f64>, series: Option<Arc<Series>>) -> Result<Provenance, S::Error> {
    let mut header = Provenance { time, series, ..Provenance::default() };
    walk(&mut Reading(from), &mut header)?;
    Ok(header)
}

/// Walk over the attributes that say what a data set is and which program made it. `format` is the
/// name and the version of the format.
pub(super) fn walk_origin<W: Walk>(
    walk: &mut W,
    (name, (major, minor)): (&str, (u32, u32)),
    title: &mut String,
    [version, hash]: [&mut String; 2],
) -> Result<(), W::Error> {
    walk.derived_attribute("Conventions", CONVENTIONS)?;
    walk.attribute("title", title)?;
    walk.derived_attribute("format_name", name)?;
    walk.derived_attribute("format_version", format!("{major}.{minor}"))?;
    walk.derived_attribute("references", PAPER)?;
    walk.derived_attribute("source", format!("stick-slip {version}"))?;
    walk.attribute("program_version", version)?;
    walk.attribute("git_hash", hash)
}

fn walk<W: Walk>(walk: &mut W, header: &mut Provenance) -> Result<(), W::Error> {
    let Provenance {
        title,
        scenario_text,
        scheme,
        step,
        resolution,
        seed,
        generator,
        paths,
        antithetic,
        block_size,
        program_version,
        git_hash,
        units: Units { time, length, force, temperature },
        // Coordinates and variables, and what only a scenario knows.
        time: _,
        series: _,
        series_start: _,
        bearing: _,
    } = header;
    walk_origin(walk, (FORMAT_NAME, FORMAT_VERSION), title, [program_version, git_hash])?;
    walk.attribute("scheme", scheme)?;
    walk.attribute("step", step)?;
    walk.attribute("resolution", resolution)?;
    walk.attribute("seed", seed)?;
    walk.attribute("generator", generator)?;
    walk.attribute("paths", paths)?;
    walk.attribute("antithetic", antithetic)?;
    walk.attribute("block_size", block_size)?;
    walk.derived_attribute("status", Status::Running.name())?;
    walk.derived_attribute("completed_paths", 0)?;
    for (name, label) in
        [("time_unit", time), ("length_unit", length), ("force_unit", force), ("temperature_unit", temperature)]
    {
        // A label that is empty stands for a dimensionless quantity. It is left out, because some
        // readers fail at empty strings.
        let mut there = Some(std::mem::take(label)).filter(|label| !label.is_empty());
        walk.attribute(name, &mut there)?;
        *label = there.unwrap_or_default();
    }
    walk.attribute("scenario", scenario_text)
}

/// Write the status with which the run ended, its number of paths, and how many of them diverged.
pub(crate) fn write_end<D: Destination>(
    to: &mut D,
    completed: u64,
    diverged: u64,
    status: Status,
) -> Result<(), D::Error> {
    to.set_attribute("diverged_paths", diverged)?;
    to.set_attribute("completed_paths", completed)?;
    to.set_attribute("status", status.name())
}

/// Write which part of a run this is.
pub(crate) fn write_part<D: Destination>(to: &mut D, part: Part) -> Result<(), D::Error> {
    to.set_attribute("part", part.to_string())
}

/// Write what ended the run before its last path.
pub(crate) fn write_ended_by<D: Destination>(to: &mut D, reason: &str) -> Result<(), D::Error> {
    to.set_attribute("ended_by", reason)
}

/// Which part of a run this is, if it is a part.
pub(crate) fn read_part<S: Source>(from: &S) -> Result<Option<Part>, S::Error> {
    let Some(text) = read_attribute::<S, Option<String>>(from, "part")? else { return Ok(None) };
    text.parse().map(Some).map_err(|error: NoPart| format!("part = \"{text}\": {error}").into())
}

/// What ended the run before its last path, if anything did.
pub(crate) fn read_ended_by<S: Source>(from: &S) -> Result<Option<String>, S::Error> {
    read_attribute(from, "ended_by")
}

/// Major and minor version of the format, if this is a run of this program.
pub(crate) fn format_version<S: Source>(from: &S) -> Option<(u32, u32)> {
    if read_attribute::<S, String>(from, "format_name").ok()? != FORMAT_NAME {
        return None;
    }
    parse_version(&read_attribute::<S, String>(from, "format_version").ok()?)
}

/// Major and minor version, from `major.minor`.
pub(crate) fn parse_version(version: &str) -> Option<(u32, u32)> {
    let (major, minor) = version.split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

/// The status of the run and its number of completed paths.
pub(crate) fn read_progress<S: Source>(from: &S) -> Result<(Status, u64), S::Error> {
    let word: String = read_attribute(from, "status")?;
    let status = Status::from_name(&word).ok_or_else(|| format!("unknown status \"{word}\""))?;
    Ok((status, read_attribute(from, "completed_paths")?))
}
