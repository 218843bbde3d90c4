//! The steepness of a user-defined force, and the body where it is steepest.

use crate::advice::derived::Derived;
use crate::model::{Expression, Oscillator, Scales, Steepest, steepest};
use crate::scenario::Scenario;
use stickslip_text::numbers::short;

/// The force as a text, if there is one.
pub(super) fn expression(scenario: &Scenario) -> Option<&Expression> {
    scenario
        .model
        .force
        .as_ref()
        .and_then(|force| force.expression())
}

/// The range in which a force is examined.
pub(super) fn scales(scenario: &Scenario, derived: &Derived) -> Scales {
    let end = scenario.time.end;
    let scale = derived
        .expected_amplitude
        .max(scenario.model.initial_displacement.abs());
    let displacement = if scale > 0.0 && scale.is_finite() {
        scale
    } else {
        1.0
    };
    // Without a spring, a constant acceleration leads to twice the mean velocity.
    let rate = if derived.natural_frequency > 0.0 {
        derived.natural_frequency
    } else {
        2.0 / end
    };
    Scales {
        displacement,
        velocity: displacement * rate,
        end,
    }
}

/// The body where the user-defined force is steepest.
pub(super) struct Stiffened {
    /// The body with the largest slope of the force in its stiffness.
    pub stiffest: Oscillator,
    /// The body with both slopes.
    pub body: Oscillator,
    found: Steepest,
}

impl Stiffened {
    /// None without an expression, or if it is nowhere steep.
    pub fn of(scenario: &Scenario, derived: &Derived) -> Option<Self> {
        let body = scenario.model.oscillator;
        let expression = expression(scenario)?;
        let found = steepest(expression, scales(scenario, derived), &body);
        let stiffest = Oscillator {
            stiffness: body.stiffness + found.stiffness,
            ..body
        };
        let body = Oscillator {
            damping: body.damping.max(0.0) + found.damping,
            ..stiffest
        };
        (found.stiffness > 0.0 || found.damping > 0.0).then_some(Stiffened {
            stiffest,
            body,
            found,
        })
    }

    /// The stability limit of a step that moves with the new velocity. The explicit step has the
    /// same limit under strong damping, and otherwise adds energy below it.
    pub fn largest_step(&self) -> f64 {
        let (rate, w0) = (self.body.damping_rate(), self.body.natural_frequency());
        2.0 / (rate + rate.hypot(w0))
    }

    /// The behaviour of the force where it sets that limit.
    pub fn reason(&self) -> String {
        let Steepest {
            damping,
            most_damped,
            ..
        } = &self.found;
        if self.body.damping_rate() > self.body.natural_frequency() && *damping > 0.0 {
            format!(
                "[force] acts like damping alpha = {} at {most_damped}",
                short(*damping)
            )
        } else {
            self.stiffest_place()
        }
    }

    /// The largest stiffness of the force, and its place.
    pub fn stiffest_place(&self) -> String {
        format!(
            "[force] has the stiffness K = {} at {}",
            short(self.found.stiffness),
            self.found.stiffest
        )
    }
}
