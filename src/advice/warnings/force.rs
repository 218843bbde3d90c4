//! Warnings about a user-defined force.

use super::case::Case;
use super::steepness::{expression, scales};
use crate::lanes::InstructionSet;
use crate::model::{ForceWarning, Sides, Sign, beyond_hold, force_warnings};
use crate::scheme::Kind;
use stickslip_text::numbers::short;

/// The expression has a jump, or grows faster than linearly without confining the body. The paper's
/// existence theorem (section 2.1) requires b to be locally Lipschitz and to grow at most linearly.
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
            stickslip_text::excerpt::short(place)
        )
    };
    found.into_iter().map(told).collect()
}

/// How the force drives the body outward at any distance or adds energy to it at any speed, in one
/// sentence. Growth faster than linear has a separate warning.
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

/// In a slip that has just begun, friction exceeds the threshold from which it began, because the
/// load jumps at x' = 0: the slip ends immediately, and another begins.
pub(super) fn friction_jumps(case: &Case) -> Option<String> {
    let model = &case.scenario.model;
    let (force, scales) = (model.force.as_ref()?, scales(case.scenario, &case.derived));
    force.sides().and_then(Sides::load)?;
    let times = || (0..=8).map(|i| f64::from(i) / 8.0);
    // From the middle outward, so that the sentence names a place that the body visits.
    let places = times().flat_map(|x| [x, -x].map(|x| times().map(move |t| [x, t])));
    let jump = |[x, t]: [f64; 2]| {
        let (x, t) = (x * scales.displacement, t * scales.end);
        let hold = force.hold(InstructionSet::detect(), x, t);
        let thresholds = model.friction.limits(hold.excess);
        let at = |(direction, threshold): (Sign, f64)| {
            let velocity = direction.value() * BARELY_MOVING * scales.velocity;
            let friction = model.sliding_friction(direction, t, x, velocity).abs();
            (friction > threshold * (1.0 + JUMP)).then_some([x, t, friction, threshold])
        };
        [Sign::Positive, Sign::Negative]
            .into_iter()
            .zip(thresholds)
            .find_map(at)
    };
    let [x, t, friction, threshold] = places.flatten().find_map(jump)?.map(short);
    Some(format!(
        "friction in a slip, {friction} at x = {x} and t = {t}, exceeds the threshold {threshold} \
         at which the slip begins, because `friction.load` jumps at xdot = 0: slips end as soon \
         as they begin, over and over. Use `direction` in place of `sign(xdot)`"
    ))
}

/// A velocity just after the beginning of a slip, relative to expected velocities.
const BARELY_MOVING: f64 = 1e-9;

/// The relative excess of friction over the threshold that indicates a jump of the load.
const JUMP: f64 = 1e-4;

/// The number of slip steps of a path under noise above which to warn.
const MANY_STEPS: f64 = 1e6;

/// Under noise, slips under a user-defined force are simulated in steps that resolve the damping,
/// even if it stops the body almost immediately.
pub(super) fn stiff_damping(case: &Case) -> Option<String> {
    let (model, end) = (&case.scenario.model, case.scenario.time.end);
    let rate = model.oscillator.damping_rate();
    let is_noisy = model.temperature.is_random() && model.oscillator.force_per_temperature() != 0.0;
    let is_general = case.scenario.scheme.kind() == Kind::EventDriven
        && model.force.is_some()
        && model.absorbed().is_none();
    let steps = 2.0 * rate * end;
    (is_noisy && is_general && steps > MANY_STEPS).then(|| {
        format!(
            "under noise, steps in slips must resolve the damping time m/alpha = {}: a path takes \
             up to {} of them and may be given up. Increase `oscillator.mass`, which does not \
             affect the motion while alpha/m is far above sqrt(K/m)",
            short(1.0 / rate),
            short(steps)
        )
    })
}
