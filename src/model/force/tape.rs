//! An expression as a list of operations on slots, each of which holds a value of every path.
//!
//! Equal operations are carried out once, and a slot is reused as soon as its value is no longer
//! needed. The choice of an operation is made once for several registers.

use super::error::ExpressionError;
use super::operation::{Binary, Unary, each, exponential, greatest, least, power, sign};
use super::tree::{DIRECTION, Formula, INPUT, Term};
use crate::lanes::{Lanes, ROW};
use crate::model::Series;
use std::collections::HashMap;
use std::sync::Arc;

/// The maximum number of slots of an expression.
const MAX_SLOTS: usize = 32;

/// Registers of a slot where many paths are computed, so that the choice of an operation costs
/// little.
const REGISTERS: usize = 16;

/// What a step does with the slots a and b and the number n.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Code {
    /// n
    Number,
    Unary(Unary),
    Add,
    /// a + n
    AddNumber,
    Sub,
    /// n - a
    SubFrom,
    Mul,
    /// a * n
    MulNumber,
    /// (a * b) + n, with two roundings
    MulAddNumber,
    /// (a * n) + b, with two roundings
    MulNumberAdd,
    Div,
    /// a / n
    DivBy,
    /// n / a
    DivInto,
    Min,
    Max,
    Power,
}

/// One operation. Its slots are below `MAX_SLOTS`.
#[derive(Clone, Copy, Debug)]
struct Step {
    code: Code,
    a: u8,
    b: u8,
    to: u8,
    number: f64,
}

/// A compiled expression.
#[derive(Clone, Debug)]
pub(super) struct Tape {
    steps: Vec<Step>,
    /// The slots of x, x' and t, if they are used.
    variables: [Option<u8>; 3],
    /// The slots of inputs, with their numbers and samples.
    inputs: Vec<(u8, usize, Arc<Series>)>,
    result: u8,
    slots: usize,
}

impl Tape {
    /// Compiles a tree for slips in a direction, 1 or -1.
    pub fn new(formula: &Formula, direction: f64) -> Result<Tape, ExpressionError> {
        let mut values = Values::default();
        let mut of_node: Vec<Operand> = Vec::with_capacity(formula.nodes.len());
        for operation in &formula.nodes {
            of_node.push(match operation.term {
                Term::Variable(DIRECTION) => Operand::Number(direction),
                term => values.term(term, &of_node),
            });
        }
        let result = of_node.last().map_or(0, |root| values.slot(*root));
        values.allocate(result, &formula.inputs).ok_or_else(|| {
            let place = 0..formula.nodes.last().map_or(0, |root| root.place.end);
            let problem =
                format!("the expression needs more than {MAX_SLOTS} intermediate values at once");
            ExpressionError::new(place, problem, "reduce the nesting")
        })
    }

    /// Takes other samples of the inputs.
    pub fn replace_inputs(&mut self, inputs: &[Arc<Series>]) {
        for (_, number, samples) in &mut self.inputs {
            *samples = inputs[*number].clone();
        }
    }

    /// The value of the expression in the lanes of a register.
    #[inline(always)]
    pub fn value<L: Lanes>(&self, x: L, velocity: L, time: L) -> L {
        // Few slots are initialised faster than many.
        match self.slots {
            0..=4 => self.value_with::<L, 4>(x, velocity, time),
            5..=8 => self.value_with::<L, 8>(x, velocity, time),
            _ => self.value_with::<L, MAX_SLOTS>(x, velocity, time),
        }
    }

    /// The same with `S` slots, a power of two.
    #[inline(always)]
    fn value_with<L: Lanes, const S: usize>(&self, x: L, velocity: L, time: L) -> L {
        let mut slots = [[L::splat(0.0)]; S];
        for (slot, variable) in self.variables.iter().zip([x, velocity, time]) {
            if let Some(slot) = slot {
                slots[*slot as usize & (S - 1)] = [variable];
            }
        }
        for (slot, _, input) in &self.inputs {
            slots[*slot as usize & (S - 1)] = [sampled(input, time)];
        }
        self.run(&mut slots);
        slots[self.result as usize & (S - 1)][0]
    }

    /// The value of the expression for many paths at one time.
    #[inline(always)]
    pub fn fill<L: Lanes>(&self, x: &[f64], velocity: &[f64], time: L, g: &mut [f64]) {
        let whole = x.len() - x.len() % (REGISTERS * L::WIDTH);
        if whole > 0 {
            let (x, velocity, g) = (&x[..whole], &velocity[..whole], &mut g[..whole]);
            match self.slots {
                0..=4 => self.fill_blocks::<L, 4>(x, velocity, time, g),
                5..=8 => self.fill_blocks::<L, 8>(x, velocity, time, g),
                _ => self.fill_blocks::<L, MAX_SLOTS>(x, velocity, time, g),
            }
        }
        for from in (whole..x.len()).step_by(L::WIDTH) {
            self.value(L::load(&x[from..]), L::load(&velocity[from..]), time)
                .store(&mut g[from..]);
        }
    }

    /// The same for blocks of several registers, with `S` slots, a power of two.
    #[inline(always)]
    fn fill_blocks<L: Lanes, const S: usize>(
        &self,
        x: &[f64],
        velocity: &[f64],
        time: L,
        g: &mut [f64],
    ) {
        let mut slots = [[L::splat(0.0); REGISTERS]; S];
        let [of_x, of_velocity, of_time] = self
            .variables
            .map(|slot| slot.map(|slot| slot as usize & (S - 1)));
        for from in (0..x.len()).step_by(REGISTERS * L::WIDTH) {
            for (slot, values) in [(of_x, x), (of_velocity, velocity)] {
                let Some(slot) = slot else { continue };
                for (register, values) in slots[slot]
                    .iter_mut()
                    .zip(values[from..].chunks_exact(L::WIDTH))
                {
                    *register = L::load(values);
                }
            }
            if let Some(slot) = of_time {
                slots[slot] = [time; REGISTERS];
            }
            for (slot, _, input) in &self.inputs {
                slots[*slot as usize & (S - 1)] = [sampled(input, time); REGISTERS];
            }
            self.run(&mut slots);
            let results = &slots[self.result as usize & (S - 1)];
            for (result, g) in results.iter().zip(g[from..].chunks_exact_mut(L::WIDTH)) {
                result.store(g);
            }
        }
    }

    /// Carries out the operations on `S` slots, a power of two.
    #[inline(always)]
    fn run<L: Lanes, const R: usize, const S: usize>(&self, slots: &mut [[L; R]; S]) {
        for step in &self.steps {
            let (a, b, to) = (
                step.a as usize & (S - 1),
                step.b as usize & (S - 1),
                step.to as usize & (S - 1),
            );
            let n = L::splat(step.number);
            macro_rules! set {
                (|$a:ident $(, $b:ident)?| $value:expr) => {
                    for r in 0..R {
                        let $a = slots[a][r];
                        $(let $b = slots[b][r];)?
                        slots[to][r] = $value;
                    }
                };
            }
            match step.code {
                Code::Number => slots[to] = [n; R],
                Code::Unary(Unary::Negative) => set!(|a| -a),
                Code::Unary(Unary::Abs) => set!(|a| a.abs()),
                Code::Unary(Unary::Sign) => set!(|a| sign(a)),
                Code::Unary(Unary::Sqrt) => set!(|a| a.sqrt()),
                Code::Unary(Unary::Exp) => set!(|a| exponential(a)),
                Code::Unary(elementary) => {
                    let function = elementary.function();
                    set!(|a| each(a, function));
                }
                Code::Add => set!(|a, b| a + b),
                Code::AddNumber => set!(|a| a + n),
                Code::Sub => set!(|a, b| a - b),
                Code::SubFrom => set!(|a| n - a),
                Code::Mul => set!(|a, b| a * b),
                Code::MulNumber => set!(|a| a * n),
                Code::MulAddNumber => set!(|a, b| a * b + n),
                Code::MulNumberAdd => set!(|a, b| a * n + b),
                Code::Div => set!(|a, b| a / b),
                Code::DivBy => set!(|a| a / n),
                Code::DivInto => set!(|a| n / a),
                Code::Min => set!(|a, b| least(a, b)),
                Code::Max => set!(|a, b| greatest(a, b)),
                Code::Power => set!(|a, b| power(a, b)),
            }
        }
    }
}

/// An input at the times in the lanes. Neighbours often have the same time.
#[inline(always)]
fn sampled<L: Lanes>(input: &Series, time: L) -> L {
    let (mut lanes, mut last) = ([0.0; ROW], (f64::NAN, f64::NAN));
    time.store(&mut lanes);
    for lane in &mut lanes[..L::WIDTH] {
        if *lane != last.0 {
            last = (*lane, input.at(*lane));
        }
        *lane = last.1;
    }
    L::load(&lanes)
}

/// A number, or the index of a value.
#[derive(Clone, Copy, Debug)]
enum Operand {
    Number(f64),
    Value(usize),
}

/// A value: a variable, or an operation on other values and the bits of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Source {
    Variable(usize),
    Operation(Code, usize, usize, u64),
}

/// The values of an expression, each of them once, in an order in which they can be computed.
#[derive(Default)]
struct Values {
    all: Vec<Source>,
    known: HashMap<Source, usize>,
}

impl Values {
    fn value(&mut self, source: Source) -> usize {
        let next = self.all.len();
        let index = *self.known.entry(source).or_insert(next);
        if index == next {
            self.all.push(source);
        }
        index
    }

    /// A value that needs no number, or only one besides values. Unused operands are 0.
    fn operation(&mut self, code: Code, a: usize, b: usize, number: f64) -> Operand {
        Operand::Value(self.value(Source::Operation(code, a, b, number.to_bits())))
    }

    fn slot(&mut self, operand: Operand) -> usize {
        match operand {
            Operand::Value(index) => index,
            Operand::Number(number) => {
                self.value(Source::Operation(Code::Number, 0, 0, number.to_bits()))
            }
        }
    }

    fn term(&mut self, term: Term, of_node: &[Operand]) -> Operand {
        match term {
            Term::Number(number) => Operand::Number(number),
            Term::Variable(variable) => Operand::Value(self.value(Source::Variable(variable))),
            Term::Unary(unary, a) => {
                let a = self.slot(of_node[a]);
                self.operation(Code::Unary(unary), a, a, 0.0)
            }
            Term::Binary(binary, a, b) => self.binary(binary, of_node[a], of_node[b]),
            Term::Whole(a, power) => self.whole(of_node[a], power),
        }
    }

    fn binary(&mut self, binary: Binary, a: Operand, b: Operand) -> Operand {
        use Operand::{Number, Value};
        let (code, a, b, number) = match (binary, a, b) {
            (Binary::Add, Value(a), Number(n)) | (Binary::Add, Number(n), Value(a)) => {
                (Code::AddNumber, a, a, n)
            }
            (Binary::Sub, Value(a), Number(n)) => (Code::AddNumber, a, a, -n),
            (Binary::Sub, Number(n), Value(a)) => (Code::SubFrom, a, a, n),
            (Binary::Mul, Value(a), Number(n)) | (Binary::Mul, Number(n), Value(a)) => {
                (Code::MulNumber, a, a, n)
            }
            (Binary::Div, Value(a), Number(n)) => (Code::DivBy, a, a, n),
            (Binary::Div, Number(n), Value(a)) => (Code::DivInto, a, a, n),
            (binary, a, b) => {
                let (a, b) = (self.slot(a), self.slot(b));
                match binary {
                    // Either order has the same bits.
                    Binary::Add => (Code::Add, a.min(b), a.max(b), 0.0),
                    Binary::Mul => (Code::Mul, a.min(b), a.max(b), 0.0),
                    Binary::Sub => (Code::Sub, a, b, 0.0),
                    Binary::Div => (Code::Div, a, b, 0.0),
                    Binary::Min => (Code::Min, a, b, 0.0),
                    Binary::Max => (Code::Max, a, b, 0.0),
                    Binary::Power => (Code::Power, a, b, 0.0),
                }
            }
        };
        self.operation(code, a, b, number)
    }

    /// A whole power in the multiplications of [`super::operation::whole_power`].
    fn whole(&mut self, a: Operand, power: i32) -> Operand {
        let (mut square, mut rest, mut product) = (a, power.unsigned_abs(), None);
        loop {
            if rest & 1 == 1 {
                product = Some(
                    product.map_or(square, |product| self.binary(Binary::Mul, product, square)),
                );
            }
            rest >>= 1;
            match (rest, product) {
                (0, Some(product)) if power < 0 => {
                    return self.binary(Binary::Div, Operand::Number(1.0), product);
                }
                (0, product) => return product.unwrap_or(square),
                _ => square = self.binary(Binary::Mul, square, square),
            }
        }
    }

    /// Joins each product that only a sum uses with this sum: a step of a polynomial is then one
    /// operation.
    fn join(&mut self) {
        let mut uses = vec![0; self.all.len()];
        for (_, a, b) in self.operations() {
            uses[a] += 1;
            uses[b] += usize::from(b != a);
        }
        for i in 0..self.all.len() {
            let product = |value: usize| match self.all[value] {
                Source::Operation(code, a, b, bits) if uses[value] == 1 => Some((code, a, b, bits)),
                _ => None,
            };
            let Source::Operation(code, a, b, bits) = self.all[i] else {
                continue;
            };
            let joined = match (code, product(a), product(b)) {
                (Code::AddNumber, Some((Code::Mul, a, b, _)), _) => {
                    Some((Code::MulAddNumber, a, b, bits))
                }
                (Code::Add, Some((Code::MulNumber, a, _, bits)), _) => {
                    Some((Code::MulNumberAdd, a, b, bits))
                }
                (Code::Add, _, Some((Code::MulNumber, b, _, bits))) => {
                    Some((Code::MulNumberAdd, b, a, bits))
                }
                _ => None,
            };
            if let Some((code, a, b, bits)) = joined {
                self.all[i] = Source::Operation(code, a, b, bits);
            }
        }
    }

    /// The index and the operands of each operation that has any.
    fn operations(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        self.all
            .iter()
            .enumerate()
            .filter_map(|(i, source)| match *source {
                Source::Operation(code, a, b, _) if code != Code::Number => Some((i, a, b)),
                _ => None,
            })
    }

    /// Where each value is used last; none for a value that has been joined with another one.
    fn last_uses(&self, result: usize) -> Vec<Option<usize>> {
        let mut last = vec![None; self.all.len()];
        last[result] = Some(self.all.len());
        let operations: Vec<_> = self.operations().collect();
        for (i, a, b) in operations.into_iter().rev() {
            if last[i].is_some() {
                last[a] = last[a].max(Some(i));
                last[b] = last[b].max(Some(i));
            }
        }
        last
    }

    /// The tape that computes these values, unless it needs too many slots.
    fn allocate(mut self, result: usize, inputs: &[Arc<Series>]) -> Option<Tape> {
        self.join();
        let last_use = self.last_uses(result);
        let mut tape = Tape {
            steps: Vec::new(),
            variables: [None; 3],
            inputs: Vec::new(),
            result: 0,
            slots: 0,
        };
        let mut free: Vec<u8> = (0..MAX_SLOTS as u8).rev().collect();
        let mut slot_of: Vec<u8> = vec![0; self.all.len()];
        // Variables are there from the beginning.
        for (i, source) in self.all.iter().enumerate() {
            if let Source::Variable(variable) = source {
                slot_of[i] = free.pop()?;
                match variable.checked_sub(INPUT) {
                    Some(input) => {
                        tape.inputs.push((slot_of[i], input, inputs[input].clone()));
                    }
                    None => tape.variables[*variable] = Some(slot_of[i]),
                }
            }
        }
        for (i, source) in self.all.iter().enumerate() {
            let Source::Operation(code, a, b, bits) = *source else {
                continue;
            };
            if last_use[i].is_none() {
                continue;
            }
            if code != Code::Number {
                free.extend((last_use[a] == Some(i)).then_some(slot_of[a]));
                free.extend((last_use[b] == Some(i) && b != a).then_some(slot_of[b]));
            }
            slot_of[i] = free.pop()?;
            let (a, b, to) = (slot_of[a], slot_of[b], slot_of[i]);
            tape.steps.push(Step {
                code,
                a,
                b,
                to,
                number: f64::from_bits(bits),
            });
        }
        tape.result = slot_of[result];
        let used = tape
            .steps
            .iter()
            .map(|step| step.to)
            .chain(tape.variables.into_iter().flatten());
        let used = used.chain(tape.inputs.iter().map(|(slot, ..)| *slot));
        tape.slots = used.max().map_or(1, |highest| highest as usize + 1);
        Some(tape)
    }
}
