//! A force of the user's own, from `[force]`.

use super::error::Fault;
use super::fields::Fields;
use super::keys;
use super::source::{Place, Sources};
use crate::excerpt::underlined;
use crate::model::{Drive, Expression, ExpressionError, Force, Linear, Oscillator};
use crate::scenario::WrittenForce;

/// What `[force]` makes of a body.
pub(super) struct Forced {
    /// The body, with a linear force in its stiffness and its damping.
    pub oscillator: Oscillator,
    /// The force, unless it is linear.
    pub force: Option<Force>,
    /// The force as it is written, and the body without it.
    pub written: Option<WrittenForce>,
}

/// Read `[force]`, if it is there.
pub(super) fn force(sources: &Sources<'_>, root: &Fields<'_>, oscillator: Oscillator) -> Forced {
    let free = Forced { oscillator, force: None, written: None };
    let Some(table) = root.table_if_present("force") else { return free };
    let place = table.place_of(keys::EXPRESSION.name);
    let Some(place) = place else {
        let remedy = "add `expression = \"-k3*x^3\"`: g(x, xdot, t), which is added to b";
        sources.report(table.missing_text(keys::EXPRESSION, remedy));
        return free;
    };
    let parameters = table.numbers(keys::PARAMETERS);
    let Some(text) = table.lines_if_sound(keys::EXPRESSION) else { return free };
    // Line breaks and tabs are spaces, each in the same place.
    let line = text.replace(['\n', '\r', '\t'], " ");
    let named: Vec<(String, f64)> = parameters.iter().map(|(name, value, _)| (name.clone(), *value)).collect();
    let place_of = |name: &str| parameters.iter().find(|(other, ..)| other == name).and_then(|(_, _, place)| *place);
    let expression = match Expression::parse(line.trim_end(), &named) {
        Ok(expression) => expression,
        Err(ExpressionError { parameter: Some(name), problem, remedy, .. }) => {
            sources.report(sources.fault(place_of(&name), problem, remedy).of("force.parameters"));
            return free;
        }
        Err(error) => {
            sources.report(fault(sources, place, &text, error));
            return free;
        }
    };
    let all = if sources.is_override(Some(place)) { ", or all with `--set 'force.parameters={}'`" } else { "" };
    for unused in expression.unused_parameters() {
        let problem = format!("`force.parameters.{unused}` is not in the expression");
        let remedy = format!("write `{unused}` in `force.expression`, or remove it{all}");
        sources.report(sources.fault(place_of(unused), problem, remedy));
    }
    let absorbed = expression.linear().and_then(|linear| with(oscillator, linear));
    let written = WrittenForce { expression: expression.clone(), without: absorbed.map(|_| oscillator) };
    let force = if absorbed.is_some() { None } else { Some(Force::new(expression)) };
    Forced { oscillator: absorbed.unwrap_or(oscillator), force, written: Some(written) }
}

/// The body with a linear force in its stiffness and its damping; none if the stiffness would be
/// negative.
fn with(oscillator: Oscillator, Linear { displacement, velocity }: Linear) -> Option<Oscillator> {
    let (stiffness, damping) = (oscillator.stiffness - displacement, oscillator.damping - 0.5 * velocity);
    // The temperature acts on the spring that is written, which is not the spring of the sum.
    let is_same = displacement == 0.0;
    let drive = if is_same { oscillator.drive } else { Drive::Force(oscillator.force_per_temperature()) };
    (stiffness >= 0.0).then_some(Oscillator { stiffness, damping, drive, ..oscillator })
}

/// The fault for an expression, at its place inside the text of the scenario where this can be
/// told, and with an excerpt of the expression elsewhere.
fn fault(sources: &Sources<'_>, place: Place, text: &str, error: ExpressionError) -> Box<Fault> {
    let ExpressionError { start, end, problem, remedy, .. } = error;
    let fault = match sources.within(place, text, start..end) {
        Some(inside) => sources.fault(Some(inside), problem, remedy),
        None if text.is_empty() => sources.fault(Some(place), problem, remedy),
        None => {
            let mut fault = sources.fault(Some(place), problem, remedy);
            let characters = |bytes: std::ops::Range<usize>| text.get(bytes).map_or(0, |part| part.chars().count());
            fault.excerpt = Some(underlined(text, characters(0..start), characters(start..end)).join("\n"));
            fault
        }
    };
    fault.of("force.expression")
}
