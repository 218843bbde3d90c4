//! An expression as a tree of operations, and its algebraic properties.

use super::operation::{Binary, Unary, whole_power};
use crate::model::{Harmonic, Series};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;
use std::sync::Arc;

/// The variables in the order in which they are passed.
pub(super) const X: usize = 0;
pub(super) const XDOT: usize = 1;
pub(super) const TIME: usize = 2;
/// The direction in which the body slips, or would slip. It is not passed, but compiled into a
/// tape.
pub(super) const DIRECTION: usize = 3;
/// The first measured input. Inputs are not passed, but follow from the time.
pub(super) const INPUT: usize = 4;

/// The number of times after 0 at which rates are computed, and the time over which each is taken,
/// as a fraction of the whole.
const LOOKS: u32 = 16;
const APART: f64 = 1e-6;

/// A number, a variable, or an operation on other nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Term {
    Number(f64),
    Variable(usize),
    Unary(Unary, usize),
    Binary(Binary, usize, usize),
    /// A whole power, neither 0 nor 1.
    Whole(usize, i32),
}

/// A term and its place in the text.
#[derive(Clone, Debug)]
pub(super) struct Operation {
    pub term: Term,
    pub place: Range<usize>,
}

/// The nodes of a tree. Every operation follows its operands, and the last one is the root.
#[derive(Clone, Debug, Default)]
pub(super) struct Formula {
    pub nodes: Vec<Operation>,
    pub inputs: Vec<Arc<Series>>,
}

impl Formula {
    /// Computes every node, in order.
    pub fn evaluate(&self, at: [f64; 3], values: &mut Vec<f64>) {
        values.clear();
        for operation in &self.nodes {
            let value = match operation.term {
                Term::Number(number) => number,
                Term::Variable(DIRECTION) => 1f64.copysign(at[XDOT]),
                Term::Variable(variable @ ..INPUT) => at[variable],
                Term::Variable(input) => self.inputs[input - INPUT].at(at[TIME]),
                Term::Unary(unary, a) => unary.function()(values[a]),
                Term::Binary(binary, a, b) => binary.of(values[a], values[b]),
                Term::Whole(a, power) => whole_power(values[a], power),
            };
            values.push(value);
        }
    }

    pub fn uses(&self, variable: usize) -> bool {
        self.nodes
            .iter()
            .any(|operation| operation.term == Term::Variable(variable))
    }

    /// The fastest change with t of the argument of a sine, a cosine or a tangent, at some times
    /// from 0 to `end`, for a body at rest at 0 or 1: the rate of an oscillation.
    pub fn fastest_rate(&self, end: f64) -> f64 {
        let (mut before, mut after, mut fastest) = (Vec::new(), Vec::new(), 0.0);
        let dt = end * APART;
        for i in 0..=LOOKS {
            let t = end * f64::from(i) / f64::from(LOOKS);
            for x in [0.0, 1.0] {
                self.evaluate([x, 0.0, t], &mut before);
                self.evaluate([x, 0.0, t + dt], &mut after);
                for operation in &self.nodes {
                    let Term::Unary(Unary::Sin | Unary::Cos | Unary::Tan, of) = operation.term
                    else {
                        continue;
                    };
                    // NaN is not a rate.
                    fastest = f64::max(fastest, (after[of] - before[of]).abs() / dt);
                }
            }
        }
        if fastest.is_finite() { fastest } else { 0.0 }
    }

    /// The inputs that the tree contains.
    pub fn used_inputs(&self) -> impl Iterator<Item = &Arc<Series>> {
        self.inputs
            .iter()
            .enumerate()
            .filter(|(i, _)| self.uses(INPUT + i))
            .map(|(_, input)| input)
    }

    /// Whether the whole is this variable times a number, plus terms without it.
    pub fn adds(&self, variable: usize) -> bool {
        let mut forms: Vec<Option<Affine>> = Vec::with_capacity(self.nodes.len());
        // For each node, whether the variable is a term of it; none if it is anything else.
        let mut terms: Vec<Option<bool>> = Vec::with_capacity(self.nodes.len());
        for operation in &self.nodes {
            let is_number = |node: usize| {
                let form = forms[node].as_ref();
                form.is_some_and(|form| form.constant().is_some())
            };
            let is_free = |node: usize| terms[node] == Some(false);
            let term = match operation.term {
                Term::Number(_) => Some(false),
                Term::Variable(other) => Some(other == variable),
                Term::Unary(Unary::Negative, a) => terms[a],
                Term::Binary(Binary::Add | Binary::Sub, a, b) => {
                    terms[a].zip(terms[b]).map(|(a, b)| a || b)
                }
                Term::Binary(Binary::Mul | Binary::Div, a, b) if is_number(b) => terms[a],
                Term::Binary(Binary::Mul, a, b) if is_number(a) => terms[b],
                Term::Unary(_, a) | Term::Whole(a, _) => is_free(a).then_some(false),
                Term::Binary(_, a, b) => (is_free(a) && is_free(b)).then_some(false),
            };
            terms.push(term);
            forms.push(affine(operation.term, &forms));
        }
        terms.pop().flatten() == Some(true)
    }

    /// The whole as a form that is linear in x, x' and the inputs, if it is one for all x, x' and t.
    pub fn affine(&self) -> Option<Affine> {
        let mut forms: Vec<Option<Affine>> = Vec::with_capacity(self.nodes.len());
        for operation in &self.nodes {
            let form = affine(operation.term, &forms);
            forms.push(form.filter(Affine::is_finite));
        }
        forms.pop()?
    }
}

/// c + a x + b x' + d t + harmonics + inputs, each with a factor.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Affine {
    /// c, a, b and d.
    pub linear: [f64; 4],
    pub harmonics: Vec<Harmonic>,
    /// The number of an input, and its factor.
    pub inputs: Vec<(usize, f64)>,
}

impl Affine {
    fn of(linear: [f64; 4]) -> Self {
        Affine {
            linear,
            ..Affine::default()
        }
    }

    fn is_finite(&self) -> bool {
        let harmonics = self.harmonics.iter().map(|h| h.amplitude);
        let factors = harmonics.chain(self.inputs.iter().map(|(_, factor)| *factor));
        self.linear.into_iter().chain(factors).all(f64::is_finite)
    }

    /// c, if nothing else is there.
    fn constant(&self) -> Option<f64> {
        let is_constant = self.linear[1..] == [0.0; 3] && !self.has_functions();
        is_constant.then_some(self.linear[0])
    }

    /// Whether there are harmonics or inputs.
    fn has_functions(&self) -> bool {
        !self.harmonics.is_empty() || !self.inputs.is_empty()
    }

    /// Every number changed by a function that is linear.
    fn map(&self, by: impl Fn(f64) -> f64) -> Affine {
        let mut form = self.clone();
        form.linear = form.linear.map(&by);
        form.harmonics
            .iter_mut()
            .for_each(|h| h.amplitude = by(h.amplitude));
        form.inputs
            .iter_mut()
            .for_each(|(_, factor)| *factor = by(*factor));
        form.harmonics.retain(|h| h.amplitude != 0.0);
        form.inputs.retain(|(_, factor)| *factor != 0.0);
        form
    }

    fn plus(mut self, other: Affine, binary: Binary) -> Affine {
        let other = if binary == Binary::Sub {
            other.map(|number| -number)
        } else {
            other
        };
        self.linear = std::array::from_fn(|i| self.linear[i] + other.linear[i]);
        self.harmonics.extend(other.harmonics);
        self.inputs.extend(other.inputs);
        self
    }

    /// cos(c + d t + phase), if this is c + d t.
    fn cos(&self, phase: f64) -> Option<Affine> {
        let [c, a, b, d] = self.linear;
        let is_line = [a, b] == [0.0; 2] && !self.has_functions() && d != 0.0;
        let harmonic = Harmonic {
            amplitude: 1.0,
            angular_frequency: d.abs(),
            phase: (c + phase) * d.signum(),
        };
        is_line.then(|| Affine {
            harmonics: vec![harmonic],
            ..Affine::default()
        })
    }
}

fn affine(term: Term, forms: &[Option<Affine>]) -> Option<Affine> {
    let form = |node: usize| forms[node].as_ref();
    let constant = |node: usize| form(node)?.constant();
    let number = |number: f64| Affine::of([number, 0.0, 0.0, 0.0]);
    Some(match term {
        Term::Number(value) => number(value),
        Term::Variable(X) => Affine::of([0.0, 1.0, 0.0, 0.0]),
        Term::Variable(XDOT) => Affine::of([0.0, 0.0, 1.0, 0.0]),
        Term::Variable(TIME) => Affine::of([0.0, 0.0, 0.0, 1.0]),
        Term::Variable(DIRECTION) => return None,
        Term::Variable(input) => Affine {
            inputs: vec![(input - INPUT, 1.0)],
            ..Affine::default()
        },
        Term::Unary(Unary::Negative, a) => form(a)?.map(|number| -number),
        Term::Unary(unary, a) => match (unary, constant(a)) {
            (_, Some(argument)) => number(unary.function()(argument)),
            (Unary::Cos, None) => form(a)?.cos(0.0)?,
            (Unary::Sin, None) => form(a)?.cos(-FRAC_PI_2)?,
            _ => return None,
        },
        Term::Whole(a, power) => number(whole_power(constant(a)?, power)),
        Term::Binary(binary @ (Binary::Add | Binary::Sub), a, b) => {
            form(a)?.clone().plus(form(b)?.clone(), binary)
        }
        Term::Binary(Binary::Mul, a, b) => match (constant(a), constant(b)) {
            (Some(factor), _) => form(b)?.map(|number| factor * number),
            (_, Some(factor)) => form(a)?.map(|number| number * factor),
            _ => return None,
        },
        Term::Binary(Binary::Div, a, b) => {
            let divisor = constant(b)?;
            form(a)?.map(|number| number / divisor)
        }
        Term::Binary(binary, a, b) => number(binary.of(constant(a)?, constant(b)?)),
    })
}
