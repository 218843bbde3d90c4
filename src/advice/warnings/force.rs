//! Warnings about a force of the user's own.

use super::case::Case;
use crate::advice::derived::Derived;
use crate::model::{Doubt, Expression, Oscillator, Scales, Steepest, beyond_hold, doubts, steepest};
use crate::numbers::short;
use crate::scenario::Scenario;

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
        format!("[force] expression, column {column}, `{}`: {sentence}", crate::excerpt::short(place))
    };
    found.into_iter().map(told).collect()
}

/// How the force drives the body outward at any distance or adds energy to it at any speed, in one
/// sentence. Faster growth than linear is a doubt of its own.
pub(super) fn beyond_hold_of(case: &Case) -> Option<String> {
    let expression = expression(case.scenario)?;
    beyond_hold(expression, scales(case.scenario, &case.derived), &case.scenario.model.oscillator)
}

fn expression(scenario: &Scenario) -> Option<&Expression> {
    scenario.model.force.as_ref().and_then(|force| force.expression())
}

/// How far a force is looked at.
fn scales(scenario: &Scenario, derived: &Derived) -> Scales {
    let end = scenario.time.end;
    let scale = derived.expected_amplitude.max(scenario.model.initial_displacement.abs());
    let displacement = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
    let rate = derived.natural_frequency;
    let velocity = displacement * if rate > 0.0 { rate } else { 1.0 };
    Scales { displacement, velocity, end }
}

/// The body where the force of the user's own is steepest.
pub(super) struct Stiffened {
    /// The body with the largest slope of the force in its stiffness.
    pub stiffest: Oscillator,
    /// The body with both slopes.
    pub body: Oscillator,
    found: Steepest,
}

impl Stiffened {
    /// None without an expression, and where it is nowhere steep.
    pub fn of(scenario: &Scenario, derived: &Derived) -> Option<Self> {
        let body = scenario.model.oscillator;
        let expression = expression(scenario)?;
        let found = steepest(expression, scales(scenario, derived), &body);
        let stiffest = Oscillator { stiffness: body.stiffness + found.stiffness, ..body };
        let body = Oscillator { damping: body.damping.max(0.0) + found.damping, ..stiffest };
        (found.stiffness > 0.0 || found.damping > 0.0).then_some(Stiffened { stiffest, body, found })
    }

    /// The stability limit of a step that moves with the new velocity. The explicit step has the
    /// same one under strong damping, and adds energy below it otherwise.
    pub fn largest_step(&self) -> f64 {
        let (rate, w0) = (self.body.damping_rate(), self.body.natural_frequency());
        2.0 / (rate + rate.hypot(w0))
    }

    /// What the force is like where it sets that limit.
    pub fn reason(&self) -> String {
        let Steepest { damping, most_damped, .. } = &self.found;
        if self.body.damping_rate() > self.body.natural_frequency() && *damping > 0.0 {
            format!("[force] damps the body as alpha = {} would at {most_damped}", short(*damping))
        } else {
            self.stiffest_place()
        }
    }

    /// How stiff the force is at most, and where.
    pub fn stiffest_place(&self) -> String {
        format!("[force] is as stiff as a spring of K = {} at {}", short(self.found.stiffness), self.found.stiffest)
    }
}
