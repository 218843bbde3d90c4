//! `[time]` and `[scheme]` -> a duration, a grid, and a scheme with its step or tolerance.

use super::blame::blame;
use super::error::Fault;
use super::fields::Fields;
use super::keys;
use super::source::Sources;
use crate::model::Model;
use crate::numbers::tidy;
use crate::scenario::time::check_end;
use crate::scenario::{Time, check};
use crate::scheme::{DEFAULT_TOLERANCE, Kind, Misfit, Parameter, Scheme};

/// Read `[scheme]` and `[time]`.
pub(super) fn scheme_and_time(
    sources: &Sources<'_>,
    root: &Fields<'_>,
    model: &Model,
) -> Result<(Scheme, Time), Box<Fault>> {
    let fault = |misfit| blame(sources, root, &misfit);
    let (kind, tolerance) = kind(sources, root)?;
    let table = root.table("time")?;
    // 0.0, never -0.0.
    let given = table.number_if_present(keys::END)?.map(|end| end.value.abs());
    let series = model.temperature.series.as_ref();
    let end = match (given, series) {
        (Some(end), _) => end,
        (None, Some(series)) => last_step(series.end(), &table, kind)?,
        (None, None) => table.number(keys::END)?.value,
    };
    check::series(model, end).map_err(fault)?;
    check::reach(model, end).map_err(fault)?;
    let scheme = kind.with(match kind.parameter() {
        Parameter::Step => table.number(keys::STEP)?.value,
        Parameter::Tolerance { .. } => {
            refuse_step(sources, root, kind)?;
            tolerance.unwrap_or(DEFAULT_TOLERANCE)
        }
    });
    check_end(scheme, end).map_err(fault)?;
    scheme.check(model, end).map_err(fault)?;
    let time = match table.number_if_present(keys::OUTPUT_STEP)? {
        None => Time::with_default_rows(end, scheme),
        Some(output_step) => Time { end, output_step: output_step.value },
    };
    time.check_rows(scheme).map_err(fault)?;
    Ok((scheme, time))
}

/// The last sample of a series, or the last step before it.
fn last_step(end: f64, table: &Fields<'_>, kind: Kind) -> Result<f64, Box<Fault>> {
    Ok(if kind.has_step() {
        let step = table.number(keys::STEP)?.value;
        tidy((end / step * (1.0 + 1e-12)).floor() * step).min(end)
    } else {
        end
    })
}

/// The scheme, and the tolerance that is given for it.
fn kind(sources: &Sources<'_>, root: &Fields<'_>) -> Result<(Kind, Option<f64>), Box<Fault>> {
    let table = root.table("scheme")?;
    let names: Vec<&'static str> = Kind::ALL.iter().map(|kind| kind.name()).collect();
    let kind = table.word("kind", &names)?.and_then(Kind::from_name).unwrap_or(Kind::DiscreteVi);
    let Some(tolerance) = table.number_if_present(keys::TOLERANCE)? else { return Ok((kind, None)) };
    // A scheme chosen on the command line leaves the tolerance of the file's own behind.
    let is_left_behind = sources.is_override(table.place_of("kind")) && !sources.is_override(tolerance.place);
    if !kind.has_step() || is_left_behind {
        return Ok((kind, Some(tolerance.value)));
    }
    let problem = format!("is given, but the accuracy of the {} scheme is set by `time.step` alone", kind.name());
    let others = names_of(false);
    let remedy = format!(
        "remove it, or choose the scheme {} (`--scheme {}`)",
        listed(&others, |name| format!("\"{name}\"")),
        others.first().unwrap_or(&"")
    );
    Err(blame(sources, root, &Misfit::new(&[("scheme.tolerance", tolerance.value)], problem, remedy)))
}

/// A step in the file is left alone by a scheme without steps, so that one file serves every
/// scheme; asking for one on the command line is a misunderstanding.
fn refuse_step(sources: &Sources<'_>, root: &Fields<'_>, kind: Kind) -> Result<(), Box<Fault>> {
    let step = root.table("time")?.number_if_present(keys::STEP)?;
    let Some(step) = step.filter(|step| sources.is_override(step.place)) else { return Ok(()) };
    let problem = format!("is given, but the {} scheme has no time step", kind.name());
    let remedy = format!(
        "leave it out (`scheme.tolerance` sets the accuracy), or choose a scheme that has one: {}",
        listed(&names_of(true), |name| format!("`--scheme {name}`"))
    );
    Err(blame(sources, root, &Misfit::new(&[("time.step", step.value)], problem, remedy)))
}

/// The schemes with a step, or those without.
fn names_of(has_step: bool) -> Vec<&'static str> {
    Kind::ALL.iter().filter(|kind| kind.has_step() == has_step).map(|kind| kind.name()).collect()
}

fn listed(names: &[&str], show: impl Fn(&str) -> String) -> String {
    names.iter().map(|name| show(name)).collect::<Vec<_>>().join(" or ")
}
