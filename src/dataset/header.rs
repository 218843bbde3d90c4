//! What a run says of itself: the attributes of its data set.

use super::Destination;
use crate::engine::{Part, Status};
use crate::provenance::Provenance;
use crate::stats::Units;

/// What `format_name` says of every run of this program.
pub(crate) const FORMAT_NAME: &str = "stick-slip ensemble";

/// Major and minor version of the format. A new minor version only adds; a new major version may change or remove.
pub const FORMAT_VERSION: (u32, u32) = (1, 3);

/// Version of the CF conventions that every data set follows.
pub(crate) const CONVENTIONS: &str = "CF-1.11";

/// Write every attribute of a run that has just started.
pub(crate) fn write<D: Destination>(to: &mut D, header: &Provenance) -> Result<(), D::Error> {
    let (major, minor) = FORMAT_VERSION;
    to.say("Conventions", CONVENTIONS)?;
    to.say("title", header.title.as_str())?;
    to.say("format_name", FORMAT_NAME)?;
    to.say("format_version", format!("{major}.{minor}"))?;
    to.say("program_version", header.program_version.as_str())?;
    to.say("git_hash", header.git_hash.as_str())?;
    to.say("scheme", header.scheme.as_str())?;
    if let Some(step) = header.step {
        to.say("step", step)?;
    }
    if let Some(resolution) = header.resolution {
        to.say("resolution", resolution)?;
    }
    to.say("seed", header.seed)?;
    to.say("generator", header.generator.as_str())?;
    to.say("paths", header.paths)?;
    if header.antithetic {
        to.say("antithetic", 1_u64)?;
    }
    to.say("block_size", header.block_size)?;
    to.say("status", Status::Running.name())?;
    to.say("completed_paths", 0_u64)?;
    let Units { time, length, force, temperature } = &header.units;
    for (name, label) in
        [("time_unit", time), ("length_unit", length), ("force_unit", force), ("temperature_unit", temperature)]
    {
        // An absent label is a dimensionless one: some readers stumble over empty strings.
        if !label.is_empty() {
            to.say(name, label.as_str())?;
        }
    }
    to.say("scenario", header.scenario_text.as_str())
}

/// Say how the run ended, with how many paths, and how many of them diverged.
pub(crate) fn write_end<D: Destination>(
    to: &mut D,
    completed: u64,
    diverged: u64,
    status: Status,
) -> Result<(), D::Error> {
    to.say("diverged_paths", diverged)?;
    to.say("completed_paths", completed)?;
    to.say("status", status.name())
}

/// Say which part of a run it is.
pub(crate) fn write_part<D: Destination>(to: &mut D, part: Part) -> Result<(), D::Error> {
    to.say("part", part.to_string())
}

/// Say what ended the run before its last path.
pub(crate) fn write_ended_by<D: Destination>(to: &mut D, reason: &str) -> Result<(), D::Error> {
    to.say("ended_by", reason)
}
