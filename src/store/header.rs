//! Reading root attributes: what a file says about itself. `dataset::header` writes them.

use super::variable::read_text;
use crate::dataset::header::FORMAT_NAME;
use crate::engine::{NoPart, Part, Status};
use crate::model::Series;
use crate::provenance::Provenance;
use crate::stats::Units;
use hdf5::File;
use std::sync::Arc;

/// Which part of a run it is, if it is one.
pub(super) fn part(file: &File) -> hdf5::Result<Option<Part>> {
    if file.attr("part").is_err() {
        return Ok(None);
    }
    let text = read_text(file, "part")?;
    text.parse().map(Some).map_err(|error: NoPart| format!("part = \"{text}\": {error}").into())
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
