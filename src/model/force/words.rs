//! The names that an expression may contain.

use super::error::ExpressionError;
use super::operation::{Binary, Unary};
use super::tree::{DIRECTION, TIME, X, XDOT};
use crate::model::NamedSeries;
use std::ops::Range;
use stickslip_text::excerpt::short;

/// The maximum number of parameters of an expression.
const MAX_PARAMETERS: usize = 64;
/// The maximum number of characters of a parameter's name.
const MAX_NAME: usize = 40;

/// What a function does.
#[derive(Clone, Copy, Debug)]
pub(super) enum Function {
    /// It takes one argument.
    Of(Unary),
    /// It takes two arguments or more.
    Among(Binary),
}

const VARIABLES: [(&str, usize); 4] = [
    ("x", X),
    ("xdot", XDOT),
    ("t", TIME),
    ("direction", DIRECTION),
];

const FUNCTIONS: &[(&str, Function)] = &[
    ("abs", Function::Of(Unary::Abs)),
    ("sign", Function::Of(Unary::Sign)),
    ("min", Function::Among(Binary::Min)),
    ("max", Function::Among(Binary::Max)),
    ("sqrt", Function::Of(Unary::Sqrt)),
    ("exp", Function::Of(Unary::Exp)),
    ("log", Function::Of(Unary::Log)),
    ("sin", Function::Of(Unary::Sin)),
    ("cos", Function::Of(Unary::Cos)),
    ("tan", Function::Of(Unary::Tan)),
    ("atan", Function::Of(Unary::Atan)),
    ("tanh", Function::Of(Unary::Tanh)),
];

/// Replacements for names that users write but that are unknown in expressions.
const HINTS: &[(&[&str], &str)] = &[
    (&["v", "dx", "dxdt", "velocity"], "write `xdot`"),
    (&["displacement", "position"], "write `x`"),
    (&["time"], "write `t`"),
    (&["sgn", "signum"], "write `sign`"),
    (&["ln"], "write `log`"),
    (&["arctan"], "write `atan`"),
    (&["fabs"], "write `abs`"),
    (&["minimum"], "write `min`"),
    (&["maximum"], "write `max`"),
    (&["pow"], "write `^`"),
    (&["e"], "write `exp(1)`"),
    (&["sinh"], "write `(exp(x) - exp(-x))/2` for sinh(x)"),
    (&["cosh"], "write `(exp(x) + exp(-x))/2` for cosh(x)"),
    (
        &["log10", "lg"],
        "write `log(x)/log(10)` for the decimal logarithm",
    ),
    (&["log2"], "write `log(x)/log(2)` for log2(x)"),
    (&["log1p"], "write `log(1 + x)` for log1p(x)"),
    (&["expm1"], "write `exp(x) - 1` for expm1(x)"),
    (
        &["asin", "arcsin"],
        "write `atan(x/sqrt(1 - x^2))` for asin(x)",
    ),
    (
        &["acos", "arccos"],
        "write `pi/2 - atan(x/sqrt(1 - x^2))` for acos(x)",
    ),
    (&["sqr", "square"], "write `x^2` for the square of x"),
    (
        &["cbrt"],
        "write `sign(x)*abs(x)^(1/3)` for the cube root of x",
    ),
    (
        &[
            "if",
            "where",
            "else",
            "then",
            "and",
            "or",
            "heaviside",
            "step",
            "piecewise",
            "theta",
        ],
        CASES,
    ),
];

/// What to write in place of the temperature.
const SUPPORT: &str = "a force cannot depend on the temperature; `V*t`, with a parameter V, describes a belt \
                       or a pulled spring, as in `k3*(V*t - x)^3`";

/// What to write in place of a comparison.
pub(super) const CASES: &str =
    "use max, min or sign, as in `-k*max(x - 3, 0)` for a spring beyond 3";

/// The names known in an expression in addition to those of the language.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names<'a> {
    pub parameters: &'a [(String, f64)],
    pub inputs: &'a [NamedSeries],
}

impl<'a> Names<'a> {
    /// All names, each with its kind.
    fn all(self) -> impl Iterator<Item = (&'a str, &'static str)> {
        let parameters = self
            .parameters
            .iter()
            .map(|(name, _)| (name.as_str(), "parameter"));
        parameters.chain(
            self.inputs
                .iter()
                .map(|input| (input.name.as_str(), "input")),
        )
    }
}

/// What a name stands for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Meaning {
    Number(f64),
    Parameter(usize),
    Input(usize),
    Variable(usize),
    Function(Function),
}

fn reserved(name: &str) -> Option<Meaning> {
    let variable = || {
        VARIABLES
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, i)| Meaning::Variable(*i))
    };
    let function = || {
        FUNCTIONS
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, of)| Meaning::Function(*of))
    };
    let pi = (name == "pi").then_some(Meaning::Number(std::f64::consts::PI));
    pi.or_else(variable).or_else(function)
}

/// The meaning of a name in an expression that knows these names.
pub(super) fn meaning(
    name: &str,
    place: &Range<usize>,
    names: Names<'_>,
) -> Result<Meaning, ExpressionError> {
    let parameter = || {
        names
            .parameters
            .iter()
            .position(|(known, _)| known == name)
            .map(Meaning::Parameter)
    };
    let input = || {
        names
            .inputs
            .iter()
            .position(|known| known.name == name)
            .map(Meaning::Input)
    };
    reserved(name)
        .or_else(parameter)
        .or_else(input)
        .ok_or_else(|| {
            let hint = hint(name, names).map_or(String::new(), |hint| format!("{hint}; "));
            let remedy = format!("{hint}available are {}", known(names));
            ExpressionError::new(
                place.clone(),
                format!("unknown name `{}`", short(name)),
                remedy,
            )
        })
}

/// What to write in place of a name.
fn hint(name: &str, names: Names<'_>) -> Option<String> {
    let word = name.to_lowercase();
    if name == "T" {
        return Some(SUPPORT.to_string());
    }
    if let Some((_, hint)) = HINTS
        .iter()
        .find(|(names, _)| names.contains(&word.as_str()))
    {
        return Some(hint.to_string());
    }
    nearest(&word, names).map(|right| format!("write `{right}`"))
}

#[cfg(not(feature = "toml"))]
fn nearest<'a>(_word: &str, _names: Names<'a>) -> Option<&'a str> {
    None
}

/// The name of which a word is probably a misspelling. A name with something added, as x2 or sinh,
/// probably means something else.
#[cfg(feature = "toml")]
fn nearest<'a>(word: &str, names: Names<'a>) -> Option<&'a str> {
    /// The similarity (1 for equal words) from which a name is suggested.
    const ALIKE: f64 = 0.75;
    /// The minimum length of a name that may be a misspelling of another.
    const LONG: usize = 3;
    let own = VARIABLES
        .iter()
        .map(|(name, _)| *name)
        .chain(FUNCTIONS.iter().map(|(name, _)| *name))
        .chain(["pi"]);
    let all = own.chain(names.all().map(|(name, _)| name));
    let near = all.filter_map(|name| {
        let known = name.to_lowercase();
        let likeness = strsim::jaro_winkler(word, &known);
        let slips = strsim::osa_distance(word, &known);
        let is_near =
            word.len() >= LONG && (slips <= 1 || likeness >= ALIKE) && !word.contains(&known);
        (known == word || is_near).then_some((slips, -likeness, name))
    });
    near.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))
        .map(|(_, _, name)| name)
}

fn known(names: Names<'_>) -> String {
    let list = |names: Vec<&str>| names.join(", ");
    let named = |kind: &str| {
        let named: Vec<&str> = names
            .all()
            .filter(|(_, of)| *of == kind)
            .map(|(name, _)| name)
            .collect();
        match named.len() {
            0 => String::new(),
            1 => format!(", the {kind} {}", named[0]),
            _ => format!(", the {kind}s {}", list(named)),
        }
    };
    format!(
        "x, xdot, t, direction, pi{}{} and the functions {}",
        named("parameter"),
        named("input"),
        list(FUNCTIONS.iter().map(|(name, _)| *name).collect())
    )
}

/// Checks that parameters and inputs have distinct names, and parameters have values.
pub(super) fn check(names: Names<'_>) -> Result<(), ExpressionError> {
    let fault = |name: &str, problem: String, remedy: &str| {
        Err(ExpressionError::of_parameter(name, problem, remedy))
    };
    if let Some((name, _)) = names.parameters.get(MAX_PARAMETERS) {
        let problem = format!(
            "{} parameters; at most {MAX_PARAMETERS} are supported",
            names.parameters.len()
        );
        return fault(name, problem, "replace some parameters by their values");
    }
    for (i, (name, kind)) in names.all().enumerate() {
        let shown = short(name);
        let is_name = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            && !name.starts_with(|c: char| c.is_ascii_digit())
            && (1..=MAX_NAME).contains(&name.len());
        if !is_name {
            let remedy = format!(
                "write letters from a to z, digits and _, at most {MAX_NAME}, and no digit first"
            );
            return fault(
                name,
                format!(
                    "`{shown}` cannot be the name of a{} {kind}",
                    if kind == "input" { "n" } else { "" }
                ),
                &remedy,
            );
        }
        if reserved(name).is_some() {
            return fault(
                name,
                format!("must not contain the reserved name `{shown}`"),
                "give it another name",
            );
        }
        if let Some((_, other)) = names.all().take(i).find(|(other, _)| *other == name) {
            let both = if other == kind {
                format!("two {kind}s are")
            } else {
                format!("a {other} and an {kind} are")
            };
            return fault(
                name,
                format!("{both} called `{shown}`"),
                "give them different names",
            );
        }
    }
    for (name, value) in names.parameters {
        let shown = short(name);
        if !value.is_finite() {
            return fault(
                name,
                format!("the parameter `{shown}` is {value}"),
                "write a finite number",
            );
        }
    }
    Ok(())
}
