//! The attributes of the data set of a run: the provenance of its numbers. One walk writes them and
//! reads them back.

use super::walk::{Walk, Walked};
use super::{Dataset, Source, read_attribute};
use crate::engine::{NoPart, Part, Program, Provenance, Status};
use crate::model::{NamedSeries, PAPER};
use crate::stats::Units;

/// Name of a format, with its major and minor version. A new minor version only adds to it; a new
/// major version may change or remove.
pub type Format = (&'static str, (u32, u32));

/// Version of the format of a run.
pub const FORMAT_VERSION: (u32, u32) = (3, 0);

/// Name and version of the format of every run.
pub const FORMAT: Format = ("stick-slip ensemble", FORMAT_VERSION);

/// Version of the CF conventions that every data set follows.
pub const CONVENTIONS: &str = "CF-1.11";

/// Write every attribute of a run that has just started.
pub(super) fn write(to: &mut Dataset, header: &Provenance) {
    to.write_by(|to| walk(to, &mut header.clone()));
}

/// The attributes of a run, given its output grid and what was measured.
pub fn read(
    from: &dyn Source,
    time: Vec<f64>,
    samples: Vec<NamedSeries>,
) -> Result<Provenance, String> {
    let mut header = Provenance {
        time,
        samples,
        ..Provenance::default()
    };
    walk(&mut Walk::Reading(from), &mut header)?;
    Ok(header)
}

/// Walk over the attributes that identify a data set and the program that made it.
pub fn walk_origin(
    walk: &mut Walk,
    (name, (major, minor)): Format,
    title: &mut String,
    Program {
        version, git_hash, ..
    }: &mut Program,
) -> Walked {
    walk.derived_attribute("Conventions", CONVENTIONS);
    walk.attribute("title", title)?;
    walk.derived_attribute("format_name", name);
    walk.derived_attribute("format_version", format!("{major}.{minor}"));
    walk.derived_attribute("references", PAPER);
    walk.derived_attribute("source", format!("stick-slip {version}"));
    walk.attribute("program_version", version)?;
    walk.attribute("git_hash", git_hash)
}

/// Write the attributes that identify a data set and this program.
pub fn write_origin(to: &mut Dataset, format: Format, title: &str) {
    to.write_by(|to| walk_origin(to, format, &mut title.into(), &mut Program::mine()));
}

fn walk(walk: &mut Walk, header: &mut Provenance) -> Walked {
    let Provenance {
        title,
        scenario_text,
        scheme,
        step,
        resolution,
        seed,
        paths,
        antithetic,
        program,
        units:
            Units {
                time,
                length,
                force,
                temperature,
            },
        // Coordinates, variables, and facts from the scenario.
        time: _,
        samples: _,
        series_start: _,
        bearing: _,
    } = header;
    walk_origin(walk, FORMAT, title, program)?;
    walk.attribute("scheme", scheme)?;
    walk.attribute("step", step)?;
    walk.attribute("resolution", resolution)?;
    walk.attribute("seed", seed)?;
    walk.attribute("generator", &mut program.generator)?;
    walk.attribute("paths", paths)?;
    walk.attribute("antithetic", antithetic)?;
    walk.attribute("block_size", &mut program.block_size)?;
    walk.derived_attribute("status", Status::Running.name());
    walk.derived_attribute("completed_paths", 0);
    for (name, label) in [
        ("time_unit", time),
        ("length_unit", length),
        ("force_unit", force),
        ("temperature_unit", temperature),
    ] {
        // An empty label denotes a dimensionless quantity. It is left out, because some readers
        // fail on empty strings.
        let mut there = Some(std::mem::take(label)).filter(|label| !label.is_empty());
        walk.attribute(name, &mut there)?;
        *label = there.unwrap_or_default();
    }
    walk.attribute("scenario", scenario_text)
}

/// The program that wrote the data set of a run or a sweep.
pub fn read_program(from: &dyn Source) -> Result<Program, String> {
    Ok(Program {
        version: read_attribute(from, "program_version")?,
        git_hash: read_attribute(from, "git_hash")?,
        generator: read_attribute(from, "generator")?,
        block_size: read_attribute(from, "block_size")?,
    })
}

/// Write the status with which the run ended, its number of paths, and how many of them diverged.
pub(super) fn write_end(to: &mut Dataset, completed: u64, diverged: u64, status: Status) {
    to.set_attribute("diverged_paths", diverged);
    to.set_attribute("completed_paths", completed);
    to.set_attribute("status", status.name());
}

/// Write which part of a run this is, if it is a part.
pub fn write_part(to: &mut Dataset, part: Option<Part>) {
    part.into_iter()
        .for_each(|part| to.set_attribute("part", part.to_string()));
}

/// Write what ended the run before its last path, if anything did.
pub fn write_ended_by(to: &mut Dataset, reason: Option<String>) {
    reason
        .into_iter()
        .for_each(|reason| to.set_attribute("ended_by", reason));
}

/// Which part of a run this is, if it is a part.
pub fn read_part(from: &dyn Source) -> Result<Option<Part>, String> {
    let Some(text) = read_attribute::<Option<String>>(from, "part")? else {
        return Ok(None);
    };
    text.parse()
        .map(Some)
        .map_err(|error: NoPart| format!("part = \"{text}\": {error}"))
}

/// The status of the run and its number of completed paths.
pub fn read_progress(from: &dyn Source) -> Result<(Status, u64), String> {
    let word: String = read_attribute(from, "status")?;
    let status = Status::from_name(&word).ok_or_else(|| format!("unknown status \"{word}\""))?;
    Ok((status, read_attribute(from, "completed_paths")?))
}
