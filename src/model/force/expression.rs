//! A force as a text such as `-k3*x^3 + mu*sign(xdot)`.

use super::error::ExpressionError;
use super::law::ForceLaw;
use super::parse::parse;
use super::pulses::pulses;
use super::tape::Tape;
use super::tree::{DIRECTION, Formula, INPUT, TIME, X, XDOT};
use super::words::Names;
use crate::lanes::Lanes;
use crate::model::{NamedSeries, Series, Temperature};
use std::sync::Arc;
use stickslip_text::excerpt::short;

/// A force g(x, x', t) as a text in x, xdot and t, with the values of its parameters.
///
/// The language has numbers, `pi`, the operators `+ - * / ^`, parentheses, and the functions abs,
/// sign, min, max, sqrt, exp, log, sin, cos, tan, atan and tanh. The variable `direction`, in which
/// the body slips or would slip, is 1 until the expression is [reversed](Expression::reversed). An
/// input is a measured function of t, linear between its samples.
#[derive(Clone, Debug)]
pub struct Expression {
    text: String,
    parameters: Vec<(String, f64)>,
    inputs: Vec<NamedSeries>,
    /// Whether the text uses each parameter, and then each input.
    used: Vec<bool>,
    formula: Formula,
    tape: Tape,
    /// The operations where the body slips backwards, if they differ.
    backwards: Option<Tape>,
}

/// A force g = a x + b x'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// a, a force per length.
    pub displacement: f64,
    /// b, a force per velocity.
    pub velocity: f64,
}

impl Expression {
    /// Reads a text that may name the parameters.
    pub fn parse(text: &str, parameters: &[(String, f64)]) -> Result<Expression, ExpressionError> {
        Expression::with_inputs(text, parameters, &[])
    }

    /// Reads a text that may name the parameters, and inputs.
    ///
    /// ```
    /// use stickslip::lanes::InstructionSet;
    /// use stickslip::model::{Expression, Force, NamedSeries, Series};
    ///
    /// let ag = NamedSeries { name: "ag".into(), series: Series::new(vec![0.0, 1.0], vec![0.0, 3.0])?.into() };
    /// let force = Force::new(Expression::with_inputs("-m*ag", &[("m".into(), 2.0)], &[ag])?);
    /// assert_eq!(force.at(InstructionSet::detect(), 0.0, 0.0, 0.5), -3.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_inputs(
        text: &str,
        parameters: &[(String, f64)],
        inputs: &[NamedSeries],
    ) -> Result<Expression, ExpressionError> {
        let (formula, used) = parse(text, Names { parameters, inputs })?;
        let tape = Tape::new(&formula, 1.0)?;
        let backwards = formula
            .uses(DIRECTION)
            .then(|| Tape::new(&formula, -1.0))
            .transpose()?;
        let (text, parameters, inputs) = (text.to_string(), parameters.to_vec(), inputs.to_vec());
        Ok(Expression {
            text,
            parameters,
            inputs,
            used,
            formula,
            tape,
            backwards,
        })
    }

    /// The text as written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The beginning of the text, for messages.
    pub fn shown(&self) -> String {
        short(&self.text)
    }

    /// The parameters and inputs that the text does not name.
    pub fn unused_names(&self) -> impl Iterator<Item = &str> {
        let parameters = self.parameters.iter().map(|(name, _)| name.as_str());
        let names = parameters.chain(self.inputs.iter().map(|input| input.name.as_str()));
        names
            .zip(&self.used)
            .filter(|(_, is_used)| !**is_used)
            .map(|(name, _)| name)
    }

    /// The coefficients, if g = a x + b x' for all x, x' and t. This is found by algebra: there are no
    /// false positives, but some forms of such a force are not recognised, such as `abs(x) *
    /// sign(x)`.
    pub fn linear(&self) -> Option<Linear> {
        let (constant, linear) = self.driven()?;
        let is_constant = constant.is_constant() && constant.offset == 0.0;
        is_constant.then_some(linear)
    }

    /// F and a x + b x', if g = F(t) + a x + b x' for all x, x' and t, where F is the sum of a line,
    /// harmonics and inputs: a temperature that acts as a force. This is found like
    /// [`Expression::linear`].
    pub fn driven(&self) -> Option<(Temperature, Linear)> {
        let form = self.formula.affine()?;
        // 0 is added so that no coefficient is -0.
        let [offset, displacement, velocity, trend] = form.linear.map(|number| number + 0.0);
        let inputs = form.inputs.iter();
        let inputs = inputs.map(|(i, factor)| (*factor, &*self.formula.inputs[*i]));
        let inputs: Vec<(f64, &Series)> = inputs.collect();
        let drive = Temperature {
            offset,
            trend,
            harmonics: form.harmonics,
            series: (!inputs.is_empty()).then(|| Arc::new(Series::sum(&inputs))),
            ..Temperature::default()
        };
        let linear = Linear {
            displacement,
            velocity,
        };
        Some((drive, linear))
    }

    /// The value of an expression of t alone.
    pub fn of_time(&self, t: f64) -> f64 {
        self.tape.value::<f64>(0.0, 0.0, t)
    }

    /// The same expression of other samples, for the inputs that `found` knows by their names.
    pub fn with_samples(&self, found: &dyn Fn(&str) -> Option<Arc<Series>>) -> Expression {
        let mut other = self.clone();
        let series = self.inputs.iter().zip(&mut other.inputs);
        for ((input, to), of_tree) in series.zip(&mut other.formula.inputs) {
            if let Some(series) = found(&input.name) {
                to.series = series.clone();
                *of_tree = series;
            }
        }
        let inputs = &other.formula.inputs;
        other.tape.replace_inputs(inputs);
        other
            .backwards
            .iter_mut()
            .for_each(|tape| tape.replace_inputs(inputs));
        other
    }

    /// Whether the text names this input.
    pub fn uses_input(&self, name: &str) -> bool {
        let number = self.inputs.iter().position(|input| input.name == name);
        number.is_some_and(|number| self.formula.uses(INPUT + number))
    }

    /// Whether this input is a term of the whole, at most times a number, and occurs nowhere else.
    pub fn adds_input(&self, name: &str) -> bool {
        let number = self.inputs.iter().position(|input| input.name == name);
        number.is_some_and(|number| self.formula.adds(INPUT + number))
    }

    /// Whether g is a function of t alone.
    pub fn is_of_time_alone(&self) -> bool {
        ![X, XDOT, DIRECTION]
            .into_iter()
            .any(|variable| self.formula.uses(variable))
    }

    /// The expression where the body slips backwards; none if the text does not name `direction`.
    pub fn reversed(&self) -> Option<Expression> {
        Some(Expression {
            tape: self.backwards.clone()?,
            ..self.clone()
        })
    }

    /// Whether the text names t, or an input.
    pub fn uses_time(&self) -> bool {
        self.formula.uses(TIME) || self.formula.used_inputs().next().is_some()
    }

    /// The operations.
    pub(super) fn formula(&self) -> &Formula {
        &self.formula
    }
}

/// Two expressions are equal if they have the same text, the same parameters and the same inputs.
impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
            && self.parameters == other.parameters
            && self.inputs == other.inputs
    }
}

impl ForceLaw for Expression {
    #[inline(always)]
    fn value<L: Lanes>(&self, x: L, velocity: L, time: L) -> L {
        self.tape.value(x, velocity, time)
    }

    #[inline(always)]
    fn fill<L: Lanes>(&self, x: &[f64], velocity: &[f64], time: L, g: &mut [f64]) {
        self.tape.fill(x, velocity, time, g);
    }

    fn depends_on_time(&self) -> bool {
        self.uses_time()
    }

    fn fastest_rate(&self, end: f64) -> f64 {
        self.formula.fastest_rate(end)
    }

    fn kinks(&self, end: f64, step: f64) -> Vec<f64> {
        let inputs = self
            .formula
            .used_inputs()
            .flat_map(|input| input.times())
            .copied();
        let at_rest = |t: f64| self.tape.value::<f64>(0.0, 0.0, t);
        let pulses = if self.formula.uses(TIME) {
            pulses(at_rest, end, step)
        } else {
            Vec::new()
        };
        inputs.chain(pulses).collect()
    }
}
