//! Warnings about a force of the user's own.

use super::case::Case;
use super::steepness::{expression, scales};
use crate::model::{Doubt, beyond_hold, doubts};

/// The expression has a jump, or grows faster than linearly and does not confine. The paper's
/// existence theorem (its section 2.1) takes b to be locally Lipschitz and to grow at most
/// linearly.
pub(super) fn doubtful(case: &Case) -> Vec<String> {
    let Some(expression) = expression(case.scenario) else { return Vec::new() };
    let found = doubts(expression, scales(case.scenario, &case.derived));
    let text = expression.text();
    let told = |Doubt { start, end, sentence }: Doubt| {
        let place = text.get(start..end).unwrap_or(text);
        let column = text.get(..start).map_or(1, |before| before.chars().count() + 1);
        format!("[force] expression, column {column}, `{}`: {sentence}", stickslip_data::excerpt::short(place))
    };
    found.into_iter().map(told).collect()
}

/// How the force drives the body outward at any distance or adds energy to it at any speed, in one
/// sentence. Faster growth than linear is a doubt of its own.
pub(super) fn beyond_hold_of(case: &Case) -> Option<String> {
    let expression = expression(case.scenario)?;
    let model = &case.scenario.model;
    beyond_hold(expression, scales(case.scenario, &case.derived), &model.oscillator, model.friction.dynamic_force)
}
