//! Values.

use super::super::operation::exponential as exp;
use super::super::{Expression, Force, ForceLaw, Linear};
use super::{expression, parameters};
use crate::lanes::{InstructionSet, Lanes};
use proptest::prelude::*;

type Plain = fn(f64, f64, f64) -> f64;

const MU: f64 = 0.3;
const VS: f64 = 0.1;

/// Expressions, and the same in Rust.
const SAME: [(&str, Plain); 34] = [
    ("1", |_, _, _| 1.0),
    ("-x^2", |x, _, _| -(x * x)),
    ("(-x)^2", |x, _, _| x * x),
    ("x^-2", |x, _, _| 1.0 / (x * x)),
    ("x^3", |x, _, _| x * (x * x)),
    ("x^0", |_, _, _| 1.0),
    ("x^0.5", |x, _, _| libm::pow(x, 0.5)),
    ("2^x", |x, _, _| libm::pow(2.0, x)),
    ("2^-x^2", |x, _, _| libm::pow(2.0, -(x * x))),
    ("x^2^3", |x, _, _| ((x * x) * (x * x)) * ((x * x) * (x * x))),
    ("abs(x)^xdot", |x, v, _| libm::pow(x.abs(), v)),
    ("1 - x - xdot", |x, v, _| (1.0 - x) - v),
    ("8/x/2", |x, _, _| (8.0 / x) / 2.0),
    ("x/2*3", |x, _, _| (x / 2.0) * 3.0),
    ("1 + 2*x", |x, _, _| 1.0 + 2.0 * x),
    ("2*-x", |x, _, _| 2.0 * -x),
    ("-+-x", |x, _, _| x),
    (".5*x + 1e-3*xdot", |x, v, _| 0.5 * x + 1e-3 * v),
    ("pi*x*xdot*t", |x, v, t| std::f64::consts::PI * x * v * t),
    ("sign(x) + 2*sign(xdot)", |x, v, _| {
        signum(x) + 2.0 * signum(v)
    }),
    ("min(x, xdot, t)", |x, v, t| x.min(v).min(t)),
    ("max(x, 1, xdot)", |x, v, _| x.max(1.0).max(v)),
    ("sqrt(abs(x))", |x, _, _| x.abs().sqrt()),
    ("exp(-x) - log(t)", |x, _, t| exp(-x) - libm::log(t)),
    ("sin(x)*cos(xdot)", |x, v, _| libm::sin(x) * libm::cos(v)),
    ("tan(x) + atan(xdot)", |x, v, _| {
        libm::tan(x) + libm::atan(v)
    }),
    ("tanh(xdot/vs)", |_, v, _| libm::tanh(v / VS)),
    ("mu*(1 - exp(-abs(xdot)/vs))*sign(xdot)", |_, v, _| {
        MU * (1.0 - exp(-v.abs() / VS)) * signum(v)
    }),
    ("(mu - 0.05*x^2)*xdot", |x, v, _| (MU - 0.05 * (x * x)) * v),
    ("-20*max(x - 3, 0)", |x, _, _| -20.0 * (x - 3.0).max(0.0)),
    ("1.5*cos(2*t) - x^3", |x, _, t| {
        1.5 * libm::cos(2.0 * t) - x * (x * x)
    }),
    ("sin(x + 1)*sin(x + 1) - (1 + x)", |x, _, _| {
        libm::sin(x + 1.0) * libm::sin(x + 1.0) - (1.0 + x)
    }),
    ("x*mu + xdot*vs - (xdot*x + 3)", |x, v, _| {
        x * MU + v * VS - (v * x + 3.0)
    }),
    ("x/(1 + xdot/(1 + t/(1 + x)))", |x, v, t| {
        x / (1.0 + v / (1.0 + t / (1.0 + x)))
    }),
];

fn signum(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

const VALUES: [f64; 9] = [0.0, 1.0, -1.0, 0.3, -2.7, 1e-9, 40.0, -1e5, 3.25];

/// Whether two numbers have the same bits, or both are none.
fn agree(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

#[test]
fn an_expression_has_the_bits_of_the_same_formula_in_rust() {
    for (text, plain) in SAME {
        let force = Force::new(expression(text));
        for (i, x) in VALUES.into_iter().enumerate() {
            for velocity in VALUES {
                let time = VALUES[(i + 3) % 9].abs();
                let g = force.at(InstructionSet::detect(), x, velocity, time);
                let expected = plain(x, velocity, time);
                // The order of two zeros is left open by `min` of Rust.
                let is_same = agree(g, expected) || (g == 0.0 && expected == 0.0);
                assert!(
                    is_same,
                    "{text} at {x}, {velocity}, {time}: {g} is not {expected}"
                );
            }
        }
    }
}

/// Checks that g of many paths is that of each of them, on every instruction set and in blocks of
/// every size.
fn check_lanes(force: &Force, time: f64) -> Result<(), TestCaseError> {
    let x: Vec<f64> = (0..248)
        .map(|i| VALUES[i % 9] + (i / 9) as f64 * 0.125)
        .collect();
    let velocity: Vec<f64> = (0..248).map(|i| VALUES[(i * 5 + 2) % 9]).collect();
    for set in InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available())
    {
        for lanes in [8, 16, 64, 248] {
            let mut g = vec![0.0; lanes];
            force.fill(set, &x[..lanes], &velocity[..lanes], time, &mut g);
            for (i, g) in g.into_iter().enumerate() {
                let one = force.at(set, x[i], velocity[i], time);
                prop_assert!(
                    agree(g, one),
                    "lane {i} of {lanes} on {}: {g} is not {one}",
                    set.name()
                );
            }
        }
    }
    Ok(())
}

#[test]
fn lanes_have_the_bits_of_a_scalar_in_blocks_of_every_size() {
    for (text, _) in SAME {
        check_lanes(&Force::new(expression(text)), 0.7)
            .unwrap_or_else(|error| panic!("{text}: {error}"));
    }
}

/// A law that is written in Rust.
#[derive(Debug)]
struct Cubic;

impl ForceLaw for Cubic {
    #[inline(always)]
    fn value<L: Lanes>(&self, x: L, velocity: L, _: L) -> L {
        x * x * x - velocity * 0.5
    }

    fn depends_on_time(&self) -> bool {
        false
    }
}

#[test]
fn a_law_in_rust_is_a_force() {
    let force = Force::new(Cubic);
    assert_eq!(force.at(InstructionSet::detect(), 2.0, 1.0, 0.0), 7.5);
    check_lanes(&force, 0.0).expect("the same bits");
    assert!(!force.depends_on_time() && force.expression().is_none());
    assert_eq!(force, force.clone());
    assert_ne!(force, Force::new(Cubic));
}

#[test]
fn equal_expressions_are_equal_forces() {
    let force = |text, mu| {
        Force::new(Expression::parse(text, &[("mu".into(), mu)]).expect("an expression"))
    };
    assert_eq!(force("mu*x", 1.0), force("mu*x", 1.0));
    assert_ne!(force("mu*x", 1.0), force("mu*x", 2.0));
    assert_ne!(force("mu*x", 1.0), force("mu*xdot", 1.0));
}

#[test]
fn time_and_unused_names_are_known() {
    assert!(expression("sin(t)").uses_time() && !expression("x*mu").uses_time());
    assert!(expression("mu*x*vs^0").unused_names().next().is_none());
    assert_eq!(expression("vs").unused_names().collect::<Vec<_>>(), ["mu"]);
}

#[test]
fn a_linear_force_is_known_by_algebra() {
    let linear = |text| {
        expression(text).linear().map(
            |Linear {
                 displacement,
                 velocity,
             }| (displacement, velocity),
        )
    };
    assert_eq!(linear("-0.5*x - 2*mu*xdot"), Some((-0.5, -0.6)));
    assert_eq!(linear("0"), Some((0.0, 0.0)));
    assert_eq!(linear("x - x + 3*xdot"), Some((0.0, 3.0)));
    assert_eq!(linear("(x + xdot)/4"), Some((0.25, 0.25)));
    assert_eq!(linear("-(1 - x) + exp(x - x)"), Some((1.0, 0.0)));
    for text in [
        "x^2",
        "abs(x)",
        "x*t",
        "t",
        "1",
        "x + 1",
        "x*xdot",
        "1/x",
        "x/(x - x)",
        "min(x, xdot)",
        "1e300*x*1e300",
    ] {
        assert_eq!(linear(text), None, "{text}");
    }
}

/// A tree, whose text has no parentheses that it does not need.
#[derive(Clone, Debug)]
enum Sample {
    Number(f64),
    Variable(usize),
    Negative(Box<Sample>),
    Operator(char, Box<(Sample, Sample)>),
    Call(&'static str, Vec<Sample>),
}

impl Sample {
    fn any() -> impl Strategy<Value = Sample> {
        let numbers = vec![0.0, 1.0, 2.0, 3.0, 0.1, 7.25, 1e-3, 64.0, 65.0];
        let leaf = prop_oneof![
            proptest::sample::select(numbers).prop_map(Sample::Number),
            (0..3usize).prop_map(Sample::Variable)
        ];
        leaf.prop_recursive(6, 40, 3, |inner| {
            let operators = proptest::sample::select(&['+', '-', '*', '/', '^'][..]);
            let ones = ["abs", "sign", "sqrt", "exp", "log", "sin", "cos", "tan", "atan", "tanh"];
            let call = (proptest::sample::select(ones.to_vec()), inner.clone());
            let among = proptest::sample::select(vec!["min", "max"]);
            prop_oneof![
                1 => inner.clone().prop_map(|a| Sample::Negative(Box::new(a))),
                6 => (operators, inner.clone(), inner.clone()).prop_map(|(c, a, b)| Sample::Operator(c, Box::new((a, b)))),
                2 => call.prop_map(|(name, a)| Sample::Call(name, vec![a])),
                1 => (among, prop::collection::vec(inner, 2..4)).prop_map(|(name, all)| Sample::Call(name, all)),
            ]
        })
    }

    /// How tightly the outermost operation binds.
    fn level(&self) -> u32 {
        match self {
            Sample::Operator('+' | '-', _) => 1,
            Sample::Operator('*' | '/', _) => 2,
            Sample::Negative(_) => 3,
            Sample::Operator(..) => 4,
            _ => 5,
        }
    }

    /// The text, in parentheses if it binds less tightly than `least`.
    fn text(&self, least: u32) -> String {
        let text = match self {
            Sample::Number(number) => number.to_string(),
            Sample::Variable(i) => ["x", "xdot", "t"][*i].to_string(),
            Sample::Negative(a) => format!("-{}", a.text(3)),
            Sample::Operator('^', of) => format!("{}^{}", of.0.text(5), of.1.text(3)),
            Sample::Operator(c, of) => format!(
                "{} {c} {}",
                of.0.text(self.level()),
                of.1.text(self.level() + 1)
            ),
            Sample::Call(name, all) => {
                format!(
                    "{name}({})",
                    all.iter().map(|a| a.text(0)).collect::<Vec<_>>().join(", ")
                )
            }
        };
        if self.level() < least {
            format!("({text})")
        } else {
            text
        }
    }

    fn is_constant(&self) -> bool {
        match self {
            Sample::Number(_) => true,
            Sample::Variable(_) => false,
            Sample::Negative(a) => a.is_constant(),
            Sample::Operator('^', of) if of.1.is_constant() && of.1.value([0.0; 3]) == 0.0 => true,
            Sample::Operator(_, of) => of.0.is_constant() && of.1.is_constant(),
            Sample::Call(_, all) => all.iter().all(Sample::is_constant),
        }
    }

    fn value(&self, at: [f64; 3]) -> f64 {
        match self {
            Sample::Number(number) => *number,
            Sample::Variable(i) => at[*i],
            Sample::Negative(a) => -a.value(at),
            Sample::Operator(c, of) => {
                let (a, b) = (of.0.value(at), of.1.value(at));
                match c {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ if of.1.is_constant() && b.fract() == 0.0 && b.abs() <= 64.0 => whole(a, b),
                    _ => libm::pow(a, b),
                }
            }
            Sample::Call(name, all) => {
                let values: Vec<f64> = all.iter().map(|a| a.value(at)).collect();
                let (first, rest) = values.split_first().expect("an argument");
                let choose = |is_first: fn(f64, f64) -> bool| {
                    rest.iter().fold(*first, |a, b| match () {
                        _ if a.is_nan() || b.is_nan() => f64::NAN,
                        _ if is_first(a, *b) => a,
                        _ => *b,
                    })
                };
                match *name {
                    "min" => choose(|a, b| a < b),
                    "max" => choose(|a, b| a > b),
                    "abs" => first.abs(),
                    "sign" if *first == 0.0 || first.is_nan() => first.abs(),
                    "sign" => first.signum(),
                    "sqrt" => first.sqrt(),
                    "exp" => exp(*first),
                    "log" => libm::log(*first),
                    "sin" => libm::sin(*first),
                    "cos" => libm::cos(*first),
                    "tan" => libm::tan(*first),
                    "atan" => libm::atan(*first),
                    _ => libm::tanh(*first),
                }
            }
        }
    }
}

/// a^b by squaring: the powers of a whose exponents are those of two that b consists of, from the
/// lowest on.
fn whole(a: f64, b: f64) -> f64 {
    let squares = std::iter::successors(Some(a), |a| Some(a * a))
        .take(7)
        .enumerate();
    let needed = squares
        .filter(|(i, _)| b.abs() as u32 >> i & 1 == 1)
        .map(|(_, square)| square);
    let product = needed
        .reduce(|product, square| product * square)
        .unwrap_or(1.0);
    if b < 0.0 { 1.0 / product } else { product }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn the_tape_of_any_tree_has_the_bits_of_the_tree(sample in Sample::any()) {
        let text = sample.text(0);
        match Expression::parse(&text, &parameters()) {
            Ok(expression) => {
                let force = Force::new(expression);
                for (i, x) in VALUES.into_iter().enumerate() {
                    let at = [x, VALUES[(i * 2 + 1) % 9], VALUES[(i + 4) % 9].abs()];
                    let (g, expected) = (force.at(InstructionSet::detect(), at[0], at[1], at[2]), sample.value(at));
                    prop_assert!(agree(g, expected), "{text} at {at:?}: {g} is not {expected}");
                }
                check_lanes(&force, 0.7)?;
            }
            // The constants in it need not have a value.
            Err(error) => {
                let is_of_a_constant = error.remedy.contains("finite value") || error.problem.ends_with("divides by 0");
                prop_assert!(is_of_a_constant, "{text}: {error}");
            }
        }
    }
}

/// e^x differs from that of `libm` by at most two roundings, for 100 000 exponents; it overflows,
/// vanishes and is not a number where that is.
#[test]
fn the_exponential_is_that_of_libm() {
    for i in -50_000..50_000 {
        let x = f64::from(i) * 0.014_142_135;
        let (found, exact) = (exp(x), libm::exp(x));
        assert!(
            (found - exact).abs() <= 2.0 * f64::EPSILON * exact,
            "{x}: {found:e} {exact:e}"
        );
    }
    for x in [
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        709.5,
        710.0,
        -745.0,
        0.0,
    ] {
        assert_eq!(exp(x).to_bits(), libm::exp(x).to_bits(), "{x}");
    }
}
