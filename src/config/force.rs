//! A user-defined force, from `[force]`.

use super::error::Diagnostic;
use super::fields::Fields;
use super::keys::{self, Key};
use super::source::{Place, Sources};
use super::tree::PARAMETERS;
use crate::model::{Expression, ExpressionError, Force, Friction, NamedSeries, Oscillator};
use crate::scenario::{INPUT, Measured, WrittenForce};
use stickslip_text::excerpt::underlined;

/// A body with the force of `[force]`.
pub(super) struct Forced {
    /// The body, with a linear force in its stiffness and its damping.
    pub oscillator: Oscillator,
    /// The force, unless it is linear and friction constant.
    pub force: Option<Force>,
    /// The force as written, and the body without it.
    pub written: Option<WrittenForce>,
    /// The parameters with their values.
    pub parameters: Vec<(String, f64)>,
    /// For each parameter that does not occur in any expression, the error to report if no number
    /// names it either.
    pub unused: Vec<(String, Box<Diagnostic>)>,
}

/// The names that every expression may contain, each with its place.
struct Scope {
    parameters: Vec<(String, f64)>,
    inputs: Vec<NamedSeries>,
    places: Vec<(String, Option<Place>)>,
}

/// Read `[force]`, if present, and everything that makes friction variable: its load, and different
/// values forwards and backwards.
pub(super) fn force(
    sources: &Sources<'_>,
    root: &Fields<'_>,
    oscillator: Oscillator,
    friction: [Friction; 2],
    inputs: &[(Measured, Option<Place>)],
) -> Forced {
    let table = root.table_if_present("force");
    let dry = root.table("friction");
    let scope = Scope::read(root, inputs);
    let is_sound = scope.check(sources);
    let has_load = dry.place_of(keys::LOAD.name).is_some();
    let expression = |table: &Fields<'_>, key: Key| {
        is_sound
            .then(|| scope.expression(sources, table, key))
            .flatten()
    };
    let load = expression(&dry, keys::LOAD);
    let own = table.as_ref().and_then(|table| {
        if table.place_of(keys::EXPRESSION.name).is_none() {
            let remedy = "add `expression = \"-k3*x^3\"`: g(x, xdot, t), added to b";
            sources.report(table.missing_text(keys::EXPRESSION, remedy));
        }
        expression(table, keys::EXPRESSION)
    });
    let is_complete = is_sound && own.is_some() == table.is_some() && load.is_some() == has_load;
    let unused = if is_complete {
        let is_override = ["force.expression", "friction.load"]
            .into_iter()
            .any(|key| sources.is_override(root.place_of(key)));
        let envelopes = inputs.iter().filter_map(|(input, _)| {
            let random = input.random.as_ref();
            random.and_then(|random| random.envelope.as_ref())
        });
        let expressions: Vec<&Expression> = own.iter().chain(&load).chain(envelopes).collect();
        scope.unused(sources, &expressions, is_override)
    } else {
        Vec::new()
    };
    let absorbed = own
        .as_ref()
        .and_then(Expression::linear)
        .and_then(|linear| oscillator.with(linear));
    let written = own.clone().map(|expression| WrittenForce {
        expression,
        without: absorbed.map(|_| oscillator),
    });
    let own = own.filter(|_| absorbed.is_none());
    Forced {
        oscillator: absorbed.unwrap_or(oscillator),
        force: total(own, load, friction),
        written,
        parameters: scope.parameters,
        unused,
    }
}

/// The force of these expressions; none if there are none and friction is constant.
fn total(
    own: Option<Expression>,
    load: Option<Expression>,
    friction: [Friction; 2],
) -> Option<Force> {
    let is_sided = own.as_ref().is_some_and(|own| own.reversed().is_some());
    let is_plain = friction[0] == friction[1] && friction[0].static_force.is_finite();
    if load.is_none() && !is_sided && is_plain {
        return own.map(Force::new);
    }
    let [own, load] = [own, load].map(|given| given.map(by_direction));
    Some(Force::with_friction(
        own.unwrap_or_else(|| [0; 2].map(|_| Force::none())),
        load,
        friction,
    ))
}

/// An expression forwards and backwards.
fn by_direction(expression: Expression) -> [Force; 2] {
    let backwards = expression.reversed().unwrap_or_else(|| expression.clone());
    [expression, backwards].map(Force::new)
}

impl Scope {
    /// The parameters and the inputs of a scenario.
    fn read(root: &Fields<'_>, inputs: &[(Measured, Option<Place>)]) -> Self {
        let (mut parameters, mut named, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for (name, value, place) in root.numbers(keys::PARAMETERS) {
            parameters.push((name.clone(), value));
            places.push((name, place));
        }
        for (of, place) in inputs {
            let Some(name) = of.input() else { continue };
            named.push(NamedSeries {
                name: name.to_string(),
                series: of.series.clone(),
            });
            places.push((name.to_string(), *place));
        }
        Scope {
            parameters,
            inputs: named,
            places,
        }
    }

    /// Whether all their names are valid in expressions; an invalid name is reported.
    fn check(&self, sources: &Sources<'_>) -> bool {
        let Err(ExpressionError {
            parameter,
            problem,
            remedy,
            ..
        }) = self.parse("0")
        else {
            return true;
        };
        let wrong = parameter.unwrap_or_default();
        // The second of two equal names is reported.
        let place = self
            .places
            .iter()
            .rev()
            .find(|(name, _)| *name == wrong)
            .and_then(|(_, place)| *place);
        let is_input = self.inputs.iter().any(|input| input.name == wrong);
        let key = if is_input {
            keys::INPUT.name
        } else {
            PARAMETERS
        };
        sources.report(sources.diagnostic(place, problem, remedy).of(key));
        false
    }

    /// The error of each parameter that does not occur in any expression. Unused inputs are
    /// reported immediately.
    fn unused(
        &self,
        sources: &Sources<'_>,
        expressions: &[&Expression],
        is_override: bool,
    ) -> Vec<(String, Box<Diagnostic>)> {
        let is_used = |name: &str| {
            expressions
                .iter()
                .any(|of| of.unused_names().all(|unused| unused != name))
        };
        let all = if is_override {
            ", or all with `parameters = {}`"
        } else {
            ""
        };
        let mut unused = Vec::new();
        for (name, place) in self.places.iter().filter(|(name, _)| !is_used(name)) {
            let written = format!("use `{name}` in `force.expression` or `friction.load`");
            if self.parameters.iter().any(|(known, _)| known == name) {
                let remedy = format!("{written}, name it in place of a number, or remove it{all}");
                let problem = format!("`{PARAMETERS}.{name}` is not used");
                unused.push((name.clone(), sources.diagnostic(*place, problem, remedy)));
            } else {
                let problem = format!("`{INPUT}{name}` is not used in any expression");
                sources.report(sources.diagnostic(
                    *place,
                    problem,
                    format!("{written}, or remove it"),
                ));
            }
        }
        unused
    }

    fn parse(&self, text: &str) -> Result<Expression, ExpressionError> {
        Expression::with_inputs(text, &self.parameters, &self.inputs)
    }

    /// The expression at a key, if present and valid.
    fn expression(
        &self,
        sources: &Sources<'_>,
        table: &Fields<'_>,
        key: Key,
    ) -> Option<Expression> {
        let place = table.place_of(key.name)?;
        let text = table.lines_if_sound(key)?;
        // Line breaks and tabs are spaces, each in the same place.
        let read = self.parse(text.replace(['\n', '\r', '\t'], " ").trim_end());
        sources.or_report(
            read.map_err(|error| {
                diagnostic(sources, place, &text, error).of(&table.dotted(key.name))
            }),
        )
    }
}

/// The error for an expression, at its place inside the text of the scenario if known, and
/// otherwise with an excerpt of the expression.
fn diagnostic(
    sources: &Sources<'_>,
    place: Place,
    text: &str,
    error: ExpressionError,
) -> Box<Diagnostic> {
    let ExpressionError {
        start,
        end,
        problem,
        remedy,
        ..
    } = error;
    match sources.within(place, text, start..end) {
        Some(inside) => sources.diagnostic(Some(inside), problem, remedy),
        None if text.is_empty() => sources.diagnostic(Some(place), problem, remedy),
        None => {
            let mut diagnostic = sources.diagnostic(Some(place), problem, remedy);
            let characters = |bytes: std::ops::Range<usize>| {
                text.get(bytes).map_or(0, |part| part.chars().count())
            };
            diagnostic.excerpt =
                Some(underlined(text, characters(0..start), characters(start..end)).join("\n"));
            diagnostic
        }
    }
}
