//! Places of values that are inconsistent, for messages.

use super::fields::Fields;
use super::source::Sources;
use crate::scheme::CheckError;

/// Report inconsistent values. They are shown at the first value that an override set, or else at
/// the first value. An override is preferred because the file was probably valid before the command
/// line changed it. A default value has no place in any text.
pub(super) fn report_check_error(
    sources: &Sources<'_>,
    root: &Fields<'_>,
    check_error: CheckError,
) {
    let CheckError {
        about,
        problem,
        remedy,
    } = check_error;
    let is_override = |(key, _): &&(&'static str, f64)| sources.is_override(root.place_of(key));
    sources.report_check_error(*match about.iter().find(is_override).or(about.first()) {
        Some((key, value)) => sources
            .diagnostic(root.place_of(key), problem, remedy)
            .of(key)
            .value(format!("{value:?}")),
        None => sources.diagnostic(None, problem, remedy),
    });
}
