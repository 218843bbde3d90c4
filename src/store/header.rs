//! Root attributes: what a file says about itself, written and read side by side.

use super::variable::{read_text, write_attribute, write_text};
use crate::engine::{NoPart, Part, Status};
use crate::model::Series;
use crate::provenance::Provenance;
use crate::stats::Units;
use hdf5::File;
use std::sync::Arc;

/// What `format_name` says in every file of this program.
pub const FORMAT_NAME: &str = "stick-slip ensemble";

/// Major and minor version of the file format. A new minor version only adds; a new major version may change or remove.
pub const FORMAT_VERSION: (u32, u32) = (1, 3);

/// Version of the CF conventions that the file follows.
const CONVENTIONS: &str = "CF-1.11";

/// Write every root attribute of a run that has just started.
pub(super) fn write(file: &File, header: &Provenance) -> hdf5::Result<()> {
    let (major, minor) = FORMAT_VERSION;
    write_text(file, "Conventions", CONVENTIONS)?;
    write_text(file, "title", &header.title)?;
    write_text(file, "format_name", FORMAT_NAME)?;
    write_text(file, "format_version", &format!("{major}.{minor}"))?;
    write_text(file, "program_version", &header.program_version)?;
    write_text(file, "git_hash", &header.git_hash)?;
    write_text(file, "scheme", &header.scheme)?;
    if let Some(step) = header.step {
        write_attribute(file, "step", step)?;
    }
    if let Some(resolution) = header.resolution {
        write_attribute(file, "resolution", resolution)?;
    }
    write_attribute(file, "seed", header.seed)?;
    write_text(file, "generator", &header.generator)?;
    write_attribute(file, "paths", header.paths)?;
    if header.antithetic {
        write_attribute(file, "antithetic", 1_u64)?;
    }
    write_attribute(file, "block_size", header.block_size)?;
    write_text(file, "status", Status::Running.name())?;
    write_attribute(file, "completed_paths", 0_u64)?;
    let Units { time, length, force, temperature } = &header.units;
    for (name, label) in
        [("time_unit", time), ("length_unit", length), ("force_unit", force), ("temperature_unit", temperature)]
    {
        // An absent label is a dimensionless one: some readers stumble over empty strings.
        if !label.is_empty() {
            write_text(file, name, label)?;
        }
    }
    write_text(file, "scenario", &header.scenario_text)
}

/// Say how many paths the file holds.
pub(super) fn set_completed_paths(file: &File, paths: u64) -> hdf5::Result<()> {
    file.attr("completed_paths")?.write_scalar(&paths)
}

/// Say how many of the paths diverged; only a finished run knows.
pub(super) fn set_diverged_paths(file: &File, paths: u64) -> hdf5::Result<()> {
    write_attribute(file, "diverged_paths", paths)
}

/// Say how the run ended.
pub(super) fn set_status(file: &File, status: Status) -> hdf5::Result<()> {
    file.attr("status")?.write_scalar(&super::variable::text(status.name())?)
}

/// Say which part of a run it is.
pub(super) fn set_part(file: &File, part: Part) -> hdf5::Result<()> {
    write_text(file, "part", &part.to_string())
}

/// Which part of a run it is, if it is one.
pub(super) fn part(file: &File) -> hdf5::Result<Option<Part>> {
    if file.attr("part").is_err() {
        return Ok(None);
    }
    let text = read_text(file, "part")?;
    text.parse().map(Some).map_err(|error: NoPart| format!("part = \"{text}\": {error}").into())
}

/// Say what ended the run before its last path.
pub(super) fn set_ended_by(file: &File, reason: &str) -> hdf5::Result<()> {
    write_text(file, "ended_by", reason)
}

/// What ended the run before its last path, if anything did.
pub(super) fn ended_by(file: &File) -> hdf5::Result<Option<String>> {
    if file.attr("ended_by").is_ok() { read_text(file, "ended_by").map(Some) } else { Ok(None) }
}

/// Major and minor format version, if the file is one of ours.
pub(super) fn format_version(file: &File) -> Option<(u32, u32)> {
    if read_text(file, "format_name").ok()? != FORMAT_NAME {
        return None;
    }
    let version = read_text(file, "format_version").ok()?;
    let (major, minor) = version.split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

/// The status and the number of paths in the file.
pub(super) fn progress(file: &File) -> hdf5::Result<(Status, u64)> {
    let word = read_text(file, "status")?;
    let status = Status::from_name(&word).ok_or_else(|| format!("unknown status \"{word}\""))?;
    Ok((status, file.attr("completed_paths")?.read_scalar()?))
}

/// The header, given the output grid and the measured temperature.
pub(super) fn read(file: &File, time: Vec<f64>, series: Option<Arc<Series>>) -> hdf5::Result<Provenance> {
    let label = |name| if file.attr(name).is_ok() { read_text(file, name) } else { Ok(String::new()) };
    let number = |name| file.attr(name).ok().map(|number| number.read_scalar()).transpose();
    Ok(Provenance {
        title: read_text(file, "title")?,
        scenario_text: read_text(file, "scenario")?,
        scheme: read_text(file, "scheme")?,
        step: number("step")?,
        resolution: number("resolution")?,
        seed: file.attr("seed")?.read_scalar()?,
        generator: read_text(file, "generator")?,
        paths: file.attr("paths")?.read_scalar()?,
        antithetic: file.attr("antithetic").is_ok(),
        block_size: file.attr("block_size")?.read_scalar()?,
        program_version: read_text(file, "program_version")?,
        git_hash: read_text(file, "git_hash")?,
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
