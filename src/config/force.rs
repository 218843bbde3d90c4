//! A force of the user's own, from `[force]`.

use super::error::Fault;
use super::fields::Fields;
use super::keys::{self, Key};
use super::source::{Place, Sources};
use crate::model::{Drive, Expression, ExpressionError, Force, Friction, Linear, NamedSeries, Oscillator};
use crate::scenario::{INPUT, Measured, WrittenForce};
use stickslip_data::excerpt::underlined;

/// What `[force]` makes of a body.
pub(super) struct Forced {
    /// The body, with a linear force in its stiffness and its damping.
    pub oscillator: Oscillator,
    /// The force, unless it is linear and friction constant.
    pub force: Option<Force>,
    /// The force as it is written, and the body without it.
    pub written: Option<WrittenForce>,
    /// For each parameter that no expression contains, the fault if no number names it either.
    pub unused: Vec<(String, Box<Fault>)>,
}

/// A number in a table whose keys are free: its name, value and place.
type Parameter = (String, f64, Option<Place>);

/// Read `[force]`, if it is there, and what makes friction no constant: its load, its difference
/// between the directions, forwards and backwards.
pub(super) fn force(
    sources: &Sources<'_>,
    root: &Fields<'_>,
    oscillator: Oscillator,
    friction: [Friction; 2],
    inputs: &[(Measured, Option<Place>)],
) -> Forced {
    let (table, dry) = (root.table_if_present("force"), root.table("friction"));
    let of_force = table.as_ref().map_or(Vec::new(), |table| table.numbers(keys::PARAMETERS));
    let of_load = dry.numbers(keys::LOAD_PARAMETERS);
    let has_load = dry.place_of(keys::LOAD.name).is_some();
    let all: Vec<Parameter> = of_force.iter().chain(&of_load).cloned().collect();
    let named = |(of, place): &(Measured, Option<Place>)| {
        Some((NamedSeries { name: of.input()?.to_string(), series: of.series.clone() }, *place))
    };
    let inputs: Vec<_> = inputs.iter().filter_map(named).collect();
    let load = expression(sources, &dry, keys::LOAD, &all, &inputs);
    let own = table.as_ref().and_then(|table| {
        if table.place_of(keys::EXPRESSION.name).is_none() {
            let remedy = "add `expression = \"-k3*x^3\"`: g(x, xdot, t), added to b";
            sources.report(table.missing_text(keys::EXPRESSION, remedy));
        }
        expression(sources, table, keys::EXPRESSION, &of_force, &inputs)
    });
    let uses = |of: &Option<Expression>, name: &str| of.as_ref().is_some_and(|of| of.unused_names().all(|n| n != name));
    let (is_in_load, is_used) = (|name: &str| uses(&load, name), |name: &str| uses(&own, name) || uses(&load, name));
    let mut unused = Vec::new();
    if let Some(table) = table.as_ref().filter(|_| own.is_some()) {
        unused.extend(unused_parameters(sources, table, keys::EXPRESSION, &of_force, is_used));
    }
    if load.is_some() == has_load {
        let faults = unused_parameters(sources, &dry, keys::LOAD, &of_load, is_in_load);
        // Without a load, there is no expression beside which they would be kept.
        if has_load { unused.extend(faults) } else { faults.for_each(|(_, fault)| sources.report(fault)) }
    }
    if own.is_some() == table.is_some() && load.is_some() == has_load {
        for (NamedSeries { name, .. }, place) in inputs.iter().filter(|(input, _)| !is_used(&input.name)) {
            let remedy = format!("use `{name}` in `force.expression` or `friction.load`, or remove it");
            sources.report(sources.fault(*place, format!("`{INPUT}{name}` is not used in any expression"), remedy));
        }
    }
    let absorbed = own.as_ref().and_then(Expression::linear).and_then(|linear| with(oscillator, linear));
    let written = own.clone().map(|expression| WrittenForce { expression, without: absorbed.map(|_| oscillator) });
    let oscillator = absorbed.unwrap_or(oscillator);
    let own = own.filter(|_| absorbed.is_none());
    let is_sided = own.as_ref().is_some_and(|own| own.reversed().is_some());
    let is_plain = friction[0] == friction[1] && friction[0].static_force.is_finite();
    let force = if load.is_some() || is_sided || !is_plain {
        let [own, load] = [own, load].map(|given| given.map(by_direction));
        Some(Force::with_friction(own.unwrap_or_else(|| [0; 2].map(|_| Force::none())), load, friction))
    } else {
        own.map(Force::new)
    };
    Forced { oscillator, force, written, unused }
}

/// An expression forwards and backwards.
fn by_direction(expression: Expression) -> [Force; 2] {
    let backwards = expression.reversed().unwrap_or_else(|| expression.clone());
    [expression, backwards].map(Force::new)
}

/// The expression at a key, if it is there and sound, which may contain these parameters and inputs.
fn expression(
    sources: &Sources<'_>,
    table: &Fields<'_>,
    key: Key,
    parameters: &[Parameter],
    inputs: &[(NamedSeries, Option<Place>)],
) -> Option<Expression> {
    let place = table.place_of(key.name)?;
    let text = table.lines_if_sound(key)?;
    // Line breaks and tabs are spaces, each in the same place.
    let line = text.replace(['\n', '\r', '\t'], " ");
    let named: Vec<(String, f64)> = parameters.iter().map(|(name, value, _)| (name.clone(), *value)).collect();
    let measured: Vec<NamedSeries> = inputs.iter().map(|(input, _)| input.clone()).collect();
    match Expression::with_inputs(line.trim_end(), &named, &measured) {
        Ok(expression) => Some(expression),
        Err(ExpressionError { parameter: Some(wrong), problem, remedy, .. }) => {
            let input = inputs.iter().find(|(input, _)| input.name == wrong);
            let parameter = || (place_of(&wrong, parameters), table.dotted(keys::PARAMETERS.name));
            let (place, key) = input.map_or_else(parameter, |(_, place)| (*place, keys::INPUT.name.to_string()));
            sources.report(sources.fault(place, problem, remedy).of(&key));
            None
        }
        Err(error) => {
            sources.report(fault(sources, place, &text, error).of(&table.dotted(key.name)));
            None
        }
    }
}

fn place_of(name: &str, parameters: &[Parameter]) -> Option<Place> {
    parameters.iter().rev().find(|(other, ..)| other == name).and_then(|(_, _, place)| *place)
}

/// The parameters that are not used by the expression at this key, each with its fault.
fn unused_parameters<'a>(
    sources: &'a Sources<'_>,
    table: &Fields<'_>,
    key: Key,
    parameters: &'a [Parameter],
    is_used: impl Fn(&str) -> bool + 'a,
) -> impl Iterator<Item = (String, Box<Fault>)> + 'a {
    let (home, expression) = (table.dotted(keys::PARAMETERS.name), table.dotted(key.name));
    let is_override = sources.is_override(table.place_of(key.name));
    let all = if is_override { format!(", or all with `--set '{home}={{}}'`") } else { String::new() };
    parameters.iter().filter(move |(name, ..)| !is_used(name)).map(move |(name, ..)| {
        let problem = format!("`{home}.{name}` is not used in the expression");
        let remedy = format!("use `{name}` in `{expression}`, or remove it{all}");
        (name.clone(), sources.fault(place_of(name, parameters), problem, remedy))
    })
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
    match sources.within(place, text, start..end) {
        Some(inside) => sources.fault(Some(inside), problem, remedy),
        None if text.is_empty() => sources.fault(Some(place), problem, remedy),
        None => {
            let mut fault = sources.fault(Some(place), problem, remedy);
            let characters = |bytes: std::ops::Range<usize>| text.get(bytes).map_or(0, |part| part.chars().count());
            fault.excerpt = Some(underlined(text, characters(0..start), characters(start..end)).join("\n"));
            fault
        }
    }
}
