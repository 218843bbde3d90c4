//! An expression as a tree of operations, and its algebraic properties.

use super::operation::{Binary, Unary, whole_power};
use crate::model::Series;
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

    /// [c, a, b], if the whole is c + a x + b x' for all x, x' and t.
    pub fn affine(&self) -> Option<[f64; 3]> {
        let mut forms: Vec<Option<[f64; 3]>> = Vec::with_capacity(self.nodes.len());
        for operation in &self.nodes {
            forms.push(affine(operation.term, &forms));
        }
        // 0 is added so that no coefficient is -0.
        forms.pop()?.map(|form| form.map(|number| number + 0.0))
    }
}

fn affine(term: Term, forms: &[Option<[f64; 3]>]) -> Option<[f64; 3]> {
    let constant = |node: usize| {
        forms[node]
            .filter(|form| form[1..] == [0.0; 2])
            .map(|form| form[0])
    };
    let form = match term {
        Term::Number(number) => [number, 0.0, 0.0],
        Term::Variable(X) => [0.0, 1.0, 0.0],
        Term::Variable(XDOT) => [0.0, 0.0, 1.0],
        Term::Variable(_) => return None,
        Term::Unary(Unary::Negative, a) => forms[a]?.map(|number| -number),
        Term::Unary(unary, a) => [unary.function()(constant(a)?), 0.0, 0.0],
        Term::Whole(a, power) => [whole_power(constant(a)?, power), 0.0, 0.0],
        Term::Binary(binary @ (Binary::Add | Binary::Sub), a, b) => {
            let (a, b) = (forms[a]?, forms[b]?);
            [0, 1, 2].map(|i| binary.of(a[i], b[i]))
        }
        Term::Binary(Binary::Mul, a, b) => match (constant(a), constant(b)) {
            (Some(factor), _) => forms[b]?.map(|number| factor * number),
            (_, Some(factor)) => forms[a]?.map(|number| number * factor),
            _ => return None,
        },
        Term::Binary(Binary::Div, a, b) => {
            let divisor = constant(b)?;
            forms[a]?.map(|number| number / divisor)
        }
        Term::Binary(binary, a, b) => [binary.of(constant(a)?, constant(b)?), 0.0, 0.0],
    };
    form.iter().all(|number| number.is_finite()).then_some(form)
}
