//! From a text to a tree, by recursive descent. Operations on numbers are carried out.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = ("+" | "-") signed | power
//! power   = atom [ "^" signed ]
//! atom    = number | name | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```

use super::error::ExpressionError;
use super::operation::{Binary, Unary, whole_power};
use super::token::{Token, TokenKind, tokens};
use super::tree::{Formula, INPUT, Operation, Term};
use super::words::{Function, Meaning, Names, check, meaning};
use std::ops::Range;
use stickslip_text::excerpt::short;

/// The maximum number of bytes of an expression.
const MAX_BYTES: usize = 2000;
/// The maximum nesting of parentheses, signs and powers.
const MAX_NESTING: usize = 64;
/// The maximum number of operations of an expression.
const MAX_OPERATIONS: usize = 400;
/// The largest exponent that is replaced by multiplications.
const MAX_WHOLE: f64 = 64.0;

type Outcome<T> = Result<T, ExpressionError>;

/// Reads a text. Returns the tree, and which parameters and then which inputs it contains.
pub(super) fn parse(text: &str, names: Names<'_>) -> Outcome<(Formula, Vec<bool>)> {
    check(names)?;
    if text.len() > MAX_BYTES {
        let problem = format!(
            "the expression has {} bytes, more than {MAX_BYTES}",
            text.len()
        );
        return Err(ExpressionError::new(
            0..text.len(),
            problem,
            "write it shorter",
        ));
    }
    let inputs = names
        .inputs
        .iter()
        .map(|input| input.series.clone())
        .collect();
    let formula = Formula {
        inputs,
        ..Formula::default()
    };
    let used = vec![false; names.parameters.len() + names.inputs.len()];
    let mut parser = Parser {
        text,
        names,
        tokens: tokens(text)?,
        next: 0,
        formula,
        used,
        operations: 0,
        nesting: 0,
    };
    if parser.kind() == TokenKind::End {
        return Err(ExpressionError::new(
            0..text.len(),
            "the expression is empty",
            "write one, or 0 for no force",
        ));
    }
    parser.sum()?;
    match parser.kind() {
        TokenKind::End => Ok((parser.formula, parser.used)),
        _ => Err(parser.unexpected(None)),
    }
}

struct Parser<'a> {
    text: &'a str,
    names: Names<'a>,
    tokens: Vec<Token>,
    next: usize,
    formula: Formula,
    used: Vec<bool>,
    operations: usize,
    nesting: usize,
}

/// A part of the text that has been read: its node, and its place with its parentheses.
struct ReadPart {
    node: usize,
    place: Range<usize>,
}

impl Parser<'_> {
    fn kind(&self) -> TokenKind {
        self.tokens[self.next].kind
    }

    fn place(&self) -> Range<usize> {
        self.tokens[self.next].place.clone()
    }

    /// The place of the next token, which is consumed if it is this symbol.
    fn take(&mut self, symbol: char) -> Option<Range<usize>> {
        let place = (self.kind() == TokenKind::Symbol(symbol)).then(|| self.place());
        self.next += usize::from(place.is_some());
        place
    }

    fn sum(&mut self) -> Outcome<ReadPart> {
        self.chain([('+', Binary::Add), ('-', Binary::Sub)], Self::product)
    }

    fn product(&mut self) -> Outcome<ReadPart> {
        self.chain([('*', Binary::Mul), ('/', Binary::Div)], Self::signed)
    }

    fn chain(
        &mut self,
        operators: [(char, Binary); 2],
        part: fn(&mut Self) -> Outcome<ReadPart>,
    ) -> Outcome<ReadPart> {
        let mut left = part(self)?;
        while let Some((_, binary)) = operators
            .into_iter()
            .find(|(symbol, _)| self.take(*symbol).is_some())
        {
            let right = part(self)?;
            left = self.binary(binary, left, right)?;
        }
        Ok(left)
    }

    fn signed(&mut self) -> Outcome<ReadPart> {
        let plus = self.take('+');
        let is_negative = plus.is_none();
        let Some(sign) = plus.or_else(|| self.take('-')) else {
            return self.power();
        };
        let part = self.nested(sign.clone(), Self::signed)?;
        let place = sign.start..part.place.end;
        if !is_negative {
            return Ok(ReadPart { place, ..part });
        }
        self.unary(Unary::Negative, part.node, place)
    }

    fn power(&mut self) -> Outcome<ReadPart> {
        let base = self.atom()?;
        let Some(operator) = self.take('^') else {
            return Ok(base);
        };
        let exponent = self.nested(operator, Self::signed)?;
        let place = base.place.start..exponent.place.end;
        match self.formula.nodes[exponent.node].term {
            Term::Number(power) if power.fract() == 0.0 && power.abs() <= MAX_WHOLE => {
                self.count(&place)?;
                self.formula.nodes.truncate(exponent.node);
                self.whole(base, power as i32, place)
            }
            _ => self.binary(Binary::Power, base, exponent),
        }
    }

    fn atom(&mut self) -> Outcome<ReadPart> {
        let place = self.place();
        match self.kind() {
            TokenKind::Number(number) => {
                self.next += 1;
                Ok(self.push(Term::Number(number), place))
            }
            TokenKind::Name => {
                self.next += 1;
                self.name(place)
            }
            TokenKind::Symbol('(') => {
                self.next += 1;
                let inner = self.nested(place.clone(), Self::sum)?;
                let close = self
                    .take(')')
                    .ok_or_else(|| self.unexpected(Some(&place)))?;
                Ok(ReadPart {
                    place: place.start..close.end,
                    ..inner
                })
            }
            _ => Err(self.missing()),
        }
    }

    fn name(&mut self, place: Range<usize>) -> Outcome<ReadPart> {
        let name = &self.text[place.clone()];
        let term = match meaning(name, &place, self.names)? {
            Meaning::Number(number) => Term::Number(number),
            Meaning::Variable(variable) => Term::Variable(variable),
            Meaning::Parameter(i) => {
                self.used[i] = true;
                Term::Number(self.names.parameters[i].1)
            }
            Meaning::Input(i) => {
                self.used[self.names.parameters.len() + i] = true;
                Term::Variable(INPUT + i)
            }
            Meaning::Function(function) => return self.call(function, place),
        };
        Ok(self.push(term, place))
    }

    fn call(&mut self, function: Function, name: Range<usize>) -> Outcome<ReadPart> {
        let word = &self.text[name.clone()];
        let Some(open) = self.take('(') else {
            let problem = format!("the function `{word}` has no parentheses");
            return Err(ExpressionError::new(
                name,
                problem,
                format!("write `{word}(x)`, for example"),
            ));
        };
        let close = match self.take(')') {
            Some(close) => return Err(arity(function, word, 0, name.start..close.end)),
            None => open.clone(),
        };
        let (mut whole, mut count) = (
            ReadPart {
                node: 0,
                place: close,
            },
            0,
        );
        loop {
            let argument = self.nested(open.clone(), Self::sum)?;
            count += 1;
            whole = match function {
                Function::Among(binary) if count > 1 => self.binary(binary, whole, argument)?,
                _ => argument,
            };
            if self.take(',').is_none() {
                break;
            }
        }
        let close = self.take(')').ok_or_else(|| self.unexpected(Some(&open)))?;
        let place = name.start..close.end;
        match function {
            Function::Of(unary) if count == 1 => self.unary(unary, whole.node, place),
            Function::Among(_) if count > 1 => {
                self.formula.nodes[whole.node].place = place.clone();
                Ok(ReadPart {
                    node: whole.node,
                    place,
                })
            }
            _ => Err(arity(function, word, count, place)),
        }
    }

    /// Reads a part that is inside another one.
    fn nested(
        &mut self,
        place: Range<usize>,
        part: fn(&mut Self) -> Outcome<ReadPart>,
    ) -> Outcome<ReadPart> {
        self.nesting += 1;
        if self.nesting > MAX_NESTING {
            let problem = format!("more than {MAX_NESTING} nested parentheses, signs and powers");
            return Err(ExpressionError::new(place, problem, "reduce the nesting"));
        }
        let piece = part(self)?;
        self.nesting -= 1;
        Ok(piece)
    }

    fn push(&mut self, term: Term, place: Range<usize>) -> ReadPart {
        self.formula.nodes.push(Operation {
            term,
            place: place.clone(),
        });
        ReadPart {
            node: self.formula.nodes.len() - 1,
            place,
        }
    }

    fn count(&mut self, place: &Range<usize>) -> Outcome<()> {
        self.operations += 1;
        if self.operations > MAX_OPERATIONS {
            let problem = format!("the expression has more than {MAX_OPERATIONS} operations");
            return Err(ExpressionError::new(place.clone(), problem, "shorten it"));
        }
        Ok(())
    }

    fn number(&self, node: usize) -> Option<f64> {
        match self.formula.nodes[node].term {
            Term::Number(number) => Some(number),
            _ => None,
        }
    }

    fn unary(&mut self, unary: Unary, a: usize, place: Range<usize>) -> Outcome<ReadPart> {
        self.count(&place)?;
        match self.number(a) {
            Some(number) => self.fold(a, unary.function()(number), place),
            None => Ok(self.push(Term::Unary(unary, a), place)),
        }
    }

    fn binary(&mut self, binary: Binary, a: ReadPart, b: ReadPart) -> Outcome<ReadPart> {
        let place = a.place.start..b.place.end;
        self.count(&place)?;
        match (self.number(a.node), self.number(b.node)) {
            (None, Some(0.0)) if binary == Binary::Div => {
                let problem = format!("`{}` divides by 0", short(&self.text[place.clone()]));
                Err(ExpressionError::new(
                    place,
                    problem,
                    "write a divisor other than 0",
                ))
            }
            (Some(left), Some(right)) => self.fold(a.node, binary.of(left, right), place),
            _ => Ok(self.push(Term::Binary(binary, a.node, b.node), place)),
        }
    }

    fn whole(&mut self, base: ReadPart, power: i32, place: Range<usize>) -> Outcome<ReadPart> {
        let number = self.number(base.node);
        match power {
            0 => {
                // The operands of the base are the nodes before it.
                let first = self.first(base.node);
                self.fold(first, 1.0, place)
            }
            1 => Ok(ReadPart { place, ..base }),
            _ => match number {
                Some(number) => self.fold(base.node, whole_power(number, power), place),
                None => Ok(self.push(Term::Whole(base.node, power), place)),
            },
        }
    }

    /// The first of the nodes that a node consists of.
    fn first(&self, mut node: usize) -> usize {
        loop {
            match self.formula.nodes[node].term {
                Term::Number(_) | Term::Variable(_) => return node,
                Term::Unary(_, a) | Term::Binary(_, a, _) | Term::Whole(a, _) => node = a,
            }
        }
    }

    /// Replaces the nodes from this one on by a number.
    fn fold(&mut self, from: usize, number: f64, place: Range<usize>) -> Outcome<ReadPart> {
        if !number.is_finite() {
            let what = if number.is_nan() {
                "not a number"
            } else {
                "infinite"
            };
            let problem = format!("`{}` is {what}", short(&self.text[place.clone()]));
            return Err(ExpressionError::new(
                place,
                problem,
                "write a constant that has a finite value",
            ));
        }
        self.formula.nodes.truncate(from);
        Ok(self.push(Term::Number(number), place))
    }

    /// The error that no value begins at the next token.
    fn missing(&self) -> ExpressionError {
        let place = self.place();
        let last = self
            .next
            .checked_sub(1)
            .map(|last| &self.text[self.tokens[last].place.clone()]);
        let remedy = match last {
            Some(last) => format!(
                "write a number, a name or a parenthesis after `{}`",
                short(last)
            ),
            None => "begin with a number, a name, a sign or a parenthesis".into(),
        };
        match self.kind() {
            TokenKind::End => ExpressionError::new(
                place,
                "a value is missing at the end of the expression",
                remedy,
            ),
            _ => {
                let problem = format!("a value is missing before `{}`", &self.text[place.clone()]);
                ExpressionError::new(place, problem, remedy)
            }
        }
    }

    /// The error that neither an operator nor the end follows a value.
    fn unexpected(&self, open: Option<&Range<usize>>) -> ExpressionError {
        let place = self.place();
        match (self.kind(), open) {
            (TokenKind::End, Some(open)) => ExpressionError::new(
                open.clone(),
                "this parenthesis is not closed",
                "add the closing `)`",
            ),
            (TokenKind::Symbol(')'), _) => ExpressionError::new(
                place,
                "this parenthesis has no opening one",
                "remove it, or add the opening `(`",
            ),
            (TokenKind::Symbol(','), _) => {
                let remedy =
                    "write a point in a number, as in 0.5; only min and max have several arguments";
                ExpressionError::new(
                    place,
                    "a comma stands outside the arguments of a function",
                    remedy,
                )
            }
            _ => {
                let left = self.tokens[self.next - 1].place.clone();
                let show = |place: &Range<usize>| match &self.text[place.clone()] {
                    "(" | ")" => "(..)".into(),
                    word => short(word),
                };
                let remedy = format!("write `{}*{}` for a product", show(&left), show(&place));
                ExpressionError::new(
                    left.start..place.end,
                    "an operator is missing between two values",
                    remedy,
                )
            }
        }
    }
}

fn arity(function: Function, word: &str, count: usize, place: Range<usize>) -> ExpressionError {
    let (takes, example) = match function {
        Function::Of(_) => ("one argument", "x"),
        Function::Among(_) => ("two arguments or more", "x, 0"),
    };
    ExpressionError::new(
        place,
        format!("`{word}` takes {takes}, not {count}"),
        format!("write `{word}({example})`, for example"),
    )
}
