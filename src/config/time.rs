//! From `[time]` and `[scheme]` to a duration, an output grid, and a scheme with its step or
//! tolerance.

use super::diagnose::report_check_error;
use super::fields::Fields;
use super::keys::{self, Key};
use super::source::Sources;
use crate::scenario::Measured;
use crate::scheme::{CheckError, DEFAULT_TOLERANCE, Kind, Parameter, Scheme};
use stickslip_text::numbers::tidy;

/// Read `[scheme]` and `[time]`. A missing output step is none.
pub(super) fn scheme_and_time(
    sources: &Sources<'_>,
    root: &Fields<'_>,
    measured: &[Measured],
) -> (Scheme, f64, Option<f64>) {
    let (kind, tolerance) = kind(sources, root);
    let table = root.table("time");
    let scheme = kind.with(match kind.parameter() {
        Parameter::Step => table.number(keys::STEP),
        Parameter::Tolerance { .. } => {
            refuse_step(sources, root, kind);
            tolerance.unwrap_or(DEFAULT_TOLERANCE)
        }
    });
    // `abs` turns -0.0 into 0.0.
    let given = table.number_if_present(keys::END).map(f64::abs);
    let is_measured = root
        .table("temperature")
        .table_if_present("series")
        .is_some();
    let end = match (
        given,
        measured
            .iter()
            .filter(|measured| measured.random.is_none())
            .map(|measured| measured.series.end())
            .reduce(f64::min),
    ) {
        (Some(end), _) => end,
        (None, Some(last)) => last_step(last, scheme),
        // The series could not be read, which has been reported.
        (None, None) if is_measured => 0.0,
        (None, None) => table.number(keys::END),
    };
    let output_step = table.number_if_present(keys::OUTPUT_STEP);
    (scheme, end, output_step)
}

/// The time of the last sample, or of the last step before it.
fn last_step(end: f64, scheme: Scheme) -> f64 {
    scheme.step().map_or(end, |step| {
        tidy((end / step * (1.0 + 1e-12)).floor() * step).min(end)
    })
}

/// The scheme, and the tolerance given for it.
fn kind(sources: &Sources<'_>, root: &Fields<'_>) -> (Kind, Option<f64>) {
    let table = root.table("scheme");
    let names: Vec<&'static str> = Kind::ALL.iter().map(|kind| kind.name()).collect();
    let kind = table
        .word(keys::KIND, &names)
        .and_then(Kind::from_name)
        .unwrap_or(Kind::DiscreteVi);
    let tolerance = table.number_if_present(keys::TOLERANCE);
    // If the command line chooses a scheme with a step, a tolerance in the file is ignored, since
    // it belongs to the scheme of the file.
    let is_override = |key: Key| sources.is_override(table.place_of(key.name));
    let is_left_behind = is_override(keys::KIND) && !is_override(keys::TOLERANCE);
    match tolerance {
        Some(tolerance) if kind.has_step() && !is_left_behind => {
            refuse(sources, root, kind, ("scheme.tolerance", tolerance));
            (kind, None)
        }
        tolerance => (kind, tolerance),
    }
}

/// A step given on the command line is an error for a scheme without steps. A step in the file is
/// ignored, so that one file serves every scheme.
fn refuse_step(sources: &Sources<'_>, root: &Fields<'_>, kind: Kind) {
    let table = root.table("time");
    let is_override = sources.is_override(table.place_of(keys::STEP.name));
    if let Some(step) = table.number_if_present(keys::STEP).filter(|_| is_override) {
        refuse(sources, root, kind, ("time.step", step));
    }
}

/// Report a step or a tolerance that the scheme does not use.
fn refuse(sources: &Sources<'_>, root: &Fields<'_>, kind: Kind, about: (&'static str, f64)) {
    let why = match kind.has_step() {
        true => "whose accuracy is set by `time.step`",
        false => "which has no time step; `scheme.tolerance` sets its accuracy",
    };
    let others = Kind::ALL
        .iter()
        .filter(|other| other.has_step() != kind.has_step())
        .map(|other| format!("`scheme.kind = \"{}\"`", other.name()));
    let problem = format!("is not used by the {} scheme, {why}", kind.name());
    let others = others.collect::<Vec<_>>().join(" or ");
    let remedy = format!("remove it, or choose a scheme that uses it: {others}");
    report_check_error(sources, root, CheckError::new(&[about], problem, remedy));
}
