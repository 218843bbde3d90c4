//! A user-defined force g(x, x', t), which is added to b in m x'' + F(x') = b(x, x', t) + g(x, x',
//! t).
//!
//! It is either an [`Expression`], read from a text and compiled to a tape of operations, or a
//! [`ForceLaw`] that is written in Rust. Either is evaluated for many paths at once, with the same
//! bits on every instruction set.

mod error;
mod expression;
mod function;
mod law;
mod operation;
mod parse;
mod pulses;
mod scan;
mod sides;
mod tape;
#[cfg(test)]
mod tests;
mod token;
mod tree;
mod words;

pub use error::ExpressionError;
pub use expression::{Expression, Linear};
pub use law::ForceLaw;
pub use scan::{ForceWarning, Scales, Steepest, beyond_hold, force_warnings, steepest};
pub use sides::{Hold, Sides};

use super::Series;
use crate::lanes::{InstructionSet, LaneProgram, Lanes};
use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

/// A force of any kind, with the friction by direction if it is not constant. Clones share it.
#[derive(Clone, Debug)]
pub struct Force {
    law: Arc<dyn AnyLaw>,
    sides: Option<Arc<Sides>>,
}

impl Force {
    /// The force that follows a law.
    pub fn new(law: impl ForceLaw + 'static) -> Self {
        Force::of(Arc::new(law), None)
    }

    fn of(law: Arc<dyn AnyLaw>, sides: Option<Arc<Sides>>) -> Self {
        Force { law, sides }
    }

    /// g at one place and time.
    pub fn at(&self, instructions: InstructionSet, x: f64, velocity: f64, time: f64) -> f64 {
        self.law.at(instructions, x, velocity, time)
    }

    /// g of many paths at one time. The slices must have one length, a multiple of 8.
    pub fn fill(
        &self,
        instructions: InstructionSet,
        x: &[f64],
        velocity: &[f64],
        time: f64,
        g: &mut [f64],
    ) {
        assert!(
            x.len() == velocity.len() && x.len() == g.len() && x.len().is_multiple_of(8),
            "slices of one length, a multiple of 8"
        );
        self.law.fill(instructions, x, velocity, time, g);
    }

    /// g at eight places and times at once, hardly slower than at one.
    pub fn at_each(
        &self,
        instructions: InstructionSet,
        x: &[f64; 8],
        velocity: &[f64; 8],
        time: &[f64; 8],
    ) -> [f64; 8] {
        self.law.at_each(instructions, [x, velocity, time])
    }

    /// Whether g, or the load of friction, depends on t.
    pub fn depends_on_time(&self) -> bool {
        self.in_stick()[0].law.depends_on_time()
    }

    /// The fastest angular frequency at which g, or the load of friction, oscillates in t, from 0
    /// to `end`; 0 where it does not.
    pub fn fastest_rate(&self, end: f64) -> f64 {
        self.in_stick()[0].law.fastest_rate(end)
    }

    /// The times at which the slope of g, or of the load of friction, in t may jump, and from 0 to
    /// `end` those at which they peak for less than a step of this length, in order.
    pub fn kinks(&self, end: f64, step: f64) -> Vec<f64> {
        let mut kinks = self.in_stick()[0].law.kinks(end, step);
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        kinks
    }

    /// The same force of other samples, for the inputs that `found` knows by their names.
    pub(crate) fn with_samples(&self, found: &dyn Fn(&str) -> Option<Arc<Series>>) -> Force {
        let other = |force: &Force| match force.expression() {
            Some(expression) => Force::new(expression.with_samples(found)),
            None => force.clone(),
        };
        match &self.sides {
            None => other(self),
            Some(sides) => sides.map(other),
        }
    }

    /// Whether g is known to be a function of t alone, under constant friction.
    pub fn is_of_time_alone(&self) -> bool {
        let expression = self.expression().filter(|_| self.sides.is_none());
        expression.is_some_and(Expression::is_of_time_alone)
    }

    /// The beginning of the expression, for messages.
    pub fn shown(&self) -> String {
        self.expression()
            .map_or("a law".to_string(), Expression::shown)
    }

    /// The expression, if the force is one.
    pub fn expression(&self) -> Option<&Expression> {
        self.law.as_any().downcast_ref()
    }
}

/// Two forces are equal if they are the same object, or equal expressions.
impl PartialEq for Force {
    fn eq(&self, other: &Self) -> bool {
        let is_same = || {
            self.expression()
                .is_some_and(|expression| Some(expression) == other.expression())
        };
        let are_none = || self.is_none() && other.is_none();
        match (self.sides(), other.sides()) {
            (None, None) => Arc::ptr_eq(&self.law, &other.law) || are_none() || is_same(),
            (Some(sides), Some(others)) => sides.agrees(others),
            _ => false,
        }
    }
}

/// A law of erased type.
trait AnyLaw: Debug + Send + Sync {
    fn at(&self, instructions: InstructionSet, x: f64, velocity: f64, time: f64) -> f64;
    fn at_each(&self, instructions: InstructionSet, at: [&[f64; 8]; 3]) -> [f64; 8];
    fn fill(
        &self,
        instructions: InstructionSet,
        x: &[f64],
        velocity: &[f64],
        time: f64,
        g: &mut [f64],
    );
    fn depends_on_time(&self) -> bool;
    fn fastest_rate(&self, end: f64) -> f64;
    fn kinks(&self, end: f64, step: f64) -> Vec<f64>;
    fn as_any(&self) -> &dyn Any;
}

impl<F: ForceLaw + 'static> AnyLaw for F {
    fn at(&self, instructions: InstructionSet, x: f64, velocity: f64, time: f64) -> f64 {
        let mut program = One {
            law: self,
            at: [x, velocity, time],
            g: 0.0,
        };
        instructions.run_single(&mut program);
        program.g
    }

    fn at_each(&self, instructions: InstructionSet, at: [&[f64; 8]; 3]) -> [f64; 8] {
        let mut program = Eight {
            law: self,
            at,
            g: [0.0; 8],
        };
        instructions.run(&mut program);
        program.g
    }

    fn fill(
        &self,
        instructions: InstructionSet,
        x: &[f64],
        velocity: &[f64],
        time: f64,
        g: &mut [f64],
    ) {
        instructions.run(&mut Many {
            law: self,
            x,
            velocity,
            time,
            g,
        });
    }

    fn depends_on_time(&self) -> bool {
        ForceLaw::depends_on_time(self)
    }

    fn fastest_rate(&self, end: f64) -> f64 {
        ForceLaw::fastest_rate(self, end)
    }

    fn kinks(&self, end: f64, step: f64) -> Vec<f64> {
        ForceLaw::kinks(self, end, step)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// Evaluates a law at one place, in a single lane but with the instructions of many.
struct One<'a, F> {
    law: &'a F,
    at: [f64; 3],
    g: f64,
}

impl<F: ForceLaw> LaneProgram for One<'_, F> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let [x, velocity, time] = self.at;
        self.g = self.law.value::<f64>(x, velocity, time);
    }
}

/// Evaluates a law at eight places and times.
struct Eight<'a, F> {
    law: &'a F,
    at: [&'a [f64; 8]; 3],
    g: [f64; 8],
}

impl<F: ForceLaw> LaneProgram for Eight<'_, F> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let [x, velocity, time] = self.at;
        for from in (0..8).step_by(L::WIDTH) {
            let g = self.law.value(
                L::load(&x[from..]),
                L::load(&velocity[from..]),
                L::load(&time[from..]),
            );
            g.store(&mut self.g[from..]);
        }
    }
}

/// Evaluates a law for many paths.
struct Many<'a, F> {
    law: &'a F,
    x: &'a [f64],
    velocity: &'a [f64],
    time: f64,
    g: &'a mut [f64],
}

impl<F: ForceLaw> LaneProgram for Many<'_, F> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        self.law
            .fill(self.x, self.velocity, L::splat(self.time), self.g);
    }
}
