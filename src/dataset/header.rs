//! The attributes of the data set of a run, which say where its numbers come from. Writing and
//! reading are side by side.

use super::{Destination, Source, read_count, read_real_if_present, read_text, read_text_if_present};
use crate::engine::{NoPart, Part, Provenance, Status};
use crate::model::Series;
use crate::stats::Units;
use std::sync::Arc;

/// The attribute `format_name` of every run of this program.
pub(crate) const FORMAT_NAME: &str = "stick-slip ensemble";

/// Major and minor version of the format. A new minor version only adds to it; a new major version
/// may change or remove.
pub const FORMAT_VERSION: (u32, u32) = (1, 3);

/// Version of the CF conventions that every data set follows.
pub(crate) const CONVENTIONS: &str = "CF-1.11";

/// Write every attribute of a run that has just started.
pub(crate) fn write<D: Destination>(to: &mut D, header: &Provenance) -> Result<(), D::Error> {
    let (major, minor) = FORMAT_VERSION;
    to.set_attribute("Conventions", CONVENTIONS)?;
    to.set_attribute("title", header.title.as_str())?;
    to.set_attribute("format_name", FORMAT_NAME)?;
    to.set_attribute("format_version", format!("{major}.{minor}"))?;
    to.set_attribute("program_version", header.program_version.as_str())?;
    to.set_attribute("git_hash", header.git_hash.as_str())?;
    to.set_attribute("scheme", header.scheme.as_str())?;
    if let Some(step) = header.step {
        to.set_attribute("step", step)?;
    }
    if let Some(resolution) = header.resolution {
        to.set_attribute("resolution", resolution)?;
    }
    to.set_attribute("seed", header.seed)?;
    to.set_attribute("generator", header.generator.as_str())?;
    to.set_attribute("paths", header.paths)?;
    if header.antithetic {
        to.set_attribute("antithetic", 1_u64)?;
    }
    to.set_attribute("block_size", header.block_size)?;
    to.set_attribute("status", Status::Running.name())?;
    to.set_attribute("completed_paths", 0_u64)?;
    let Units { time, length, force, temperature } = &header.units;
    for (name, label) in
        [("time_unit", time), ("length_unit", length), ("force_unit", force), ("temperature_unit", temperature)]
    {
        // A label that is empty stands for a dimensionless quantity. It is left out, because some
        // readers fail at empty strings.
        if !label.is_empty() {
            to.set_attribute(name, label.as_str())?;
        }
    }
    to.set_attribute("scenario", header.scenario_text.as_str())
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
    let Some(text) = read_text_if_present(from, "part")? else { return Ok(None) };
    text.parse().map(Some).map_err(|error: NoPart| format!("part = \"{text}\": {error}").into())
}

/// What ended the run before its last path, if anything did.
pub(crate) fn read_ended_by<S: Source>(from: &S) -> Result<Option<String>, S::Error> {
    read_text_if_present(from, "ended_by")
}

/// Major and minor version of the format, if this is a run of this program.
pub(crate) fn format_version<S: Source>(from: &S) -> Option<(u32, u32)> {
    if read_text(from, "format_name").ok()? != FORMAT_NAME {
        return None;
    }
    let version = read_text(from, "format_version").ok()?;
    let (major, minor) = version.split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

/// The status of the run and its number of completed paths.
pub(crate) fn read_progress<S: Source>(from: &S) -> Result<(Status, u64), S::Error> {
    let word = read_text(from, "status")?;
    let status = Status::from_name(&word).ok_or_else(|| format!("unknown status \"{word}\""))?;
    Ok((status, read_count(from, "completed_paths")?))
}

/// The attributes of a run, given its output grid and the measured temperature.
pub(crate) fn read<S: Source>(from: &S, time: Vec<f64>, series: Option<Arc<Series>>) -> Result<Provenance, S::Error> {
    let label = |name| Ok::<_, S::Error>(read_text_if_present(from, name)?.unwrap_or_default());
    Ok(Provenance {
        title: read_text(from, "title")?,
        scenario_text: read_text(from, "scenario")?,
        scheme: read_text(from, "scheme")?,
        step: read_real_if_present(from, "step")?,
        resolution: read_real_if_present(from, "resolution")?,
        seed: read_count(from, "seed")?,
        generator: read_text(from, "generator")?,
        paths: read_count(from, "paths")?,
        antithetic: from.attribute(None, "antithetic")?.is_some(),
        block_size: read_count(from, "block_size")?,
        program_version: read_text(from, "program_version")?,
        git_hash: read_text(from, "git_hash")?,
        units: Units {
            time: label("time_unit")?,
            length: label("length_unit")?,
            force: label("force_unit")?,
            temperature: label("temperature_unit")?,
        },
        time,
        series,
        series_start: None,
        bearing: None,
    })
}
