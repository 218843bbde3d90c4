//! Warnings about a user-defined force.

use super::case::Case;
use super::steepness::{expression, scales};
use crate::model::{ForceWarning, beyond_hold, force_warnings};
use crate::scheme::Kind;
use stickslip_data::numbers::short;

/// The expression has a jump, or grows faster than linearly and does not confine. The paper's
/// existence theorem (its section 2.1) takes b to be locally Lipschitz and to grow at most
/// linearly.
pub(super) fn force_warning(case: &Case) -> Vec<String> {
    let Some(expression) = expression(case.scenario) else {
        return Vec::new();
    };
    let found = force_warnings(expression, scales(case.scenario, &case.derived));
    let text = expression.text();
    let told = |ForceWarning {
                    start,
                    end,
                    sentence,
                }: ForceWarning| {
        let place = text.get(start..end).unwrap_or(text);
        let column = text
            .get(..start)
            .map_or(1, |before| before.chars().count() + 1);
        format!(
            "[force] expression, column {column}, `{}`: {sentence}",
            stickslip_data::excerpt::short(place)
        )
    };
    found.into_iter().map(told).collect()
}

/// How the force drives the body outward at any distance or adds energy to it at any speed, in one
/// sentence. Faster growth than linear is a warning of its own.
pub(super) fn beyond_hold_of(case: &Case) -> Option<String> {
    let expression = expression(case.scenario)?;
    let model = &case.scenario.model;
    beyond_hold(
        expression,
        scales(case.scenario, &case.derived),
        &model.oscillator,
        model.friction.dynamic_force,
    )
}

/// Slip steps of a path under noise that may be too many.
const MANY_STEPS: f64 = 1e6;

/// Under noise, slips under a user-defined force are simulated in steps that resolve a damping
/// which settles the velocity at once.
pub(super) fn stiff_damping(case: &Case) -> Option<String> {
    let (model, end) = (&case.scenario.model, case.scenario.time.end);
    let rate = model.oscillator.damping_rate();
    let is_noisy = model.temperature.is_random() && model.oscillator.force_per_temperature() != 0.0;
    let is_general = case.scenario.scheme.kind() == Kind::EventDriven && model.force.is_some();
    let steps = 2.0 * rate * end;
    (is_noisy && is_general && steps > MANY_STEPS).then(|| {
        format!(
            "slip steps under noise resolve the damping, m/alpha = {}: up to {} steps of a path, which may be given up. \
             Raise `oscillator.mass`, on which the motion does not depend while alpha/m is far above sqrt(K/m)",
            short(1.0 / rate),
            short(steps)
        )
    })
}
