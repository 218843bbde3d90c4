//! Warnings about a force of the user's own.

use super::case::Case;
use crate::model::{Doubt, Scales, doubts};

/// The expression has a jump, or grows faster than linearly and does not confine. The paper's
/// existence theorem (its section 2.1) takes b to be locally Lipschitz and to grow at most
/// linearly.
pub(super) fn doubtful(case: &Case) -> Vec<String> {
    let model = &case.scenario.model;
    let Some(expression) = model.force.as_ref().and_then(|force| force.expression()) else { return Vec::new() };
    let scale = case.derived.expected_amplitude.max(model.initial_displacement.abs());
    let displacement = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
    let rate = case.derived.natural_frequency;
    let velocity = displacement * if rate > 0.0 { rate } else { 1.0 };
    let found = doubts(expression, Scales { displacement, velocity, end: case.scenario.time.end });
    let text = expression.text();
    let told = |Doubt { start, end, sentence }: Doubt| {
        let place = text.get(start..end).unwrap_or(text);
        let column = text.get(..start).map_or(1, |before| before.chars().count() + 1);
        format!("[force] expression, column {column}, `{}`: {sentence}", crate::excerpt::short(place))
    };
    found.into_iter().map(told).collect()
}
