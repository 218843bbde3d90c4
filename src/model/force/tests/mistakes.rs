//! Texts that are not expressions.

use super::super::{Expression, Scales, beyond_hold, force_warnings, steepest};
use super::parameters;
use crate::model::{Drive, Oscillator};
use proptest::prelude::*;

/// A wrong text, the part of it that is marked, the problem, and the remedy or a part of it.
const WRONG: [(&str, &str, &str, &str); 47] = [
    ("", "", "the expression is empty", "0 for no force"),
    ("  ", "  ", "the expression is empty", "0 for no force"),
    (
        "mu*xdto",
        "xdto",
        "unknown name `xdto`",
        "write `xdot`; available are x, xdot, t, direction, pi, the parameters mu, vs and the functions abs, sign, min, \
         max, sqrt, exp, log, sin, cos, tan, atan, tanh",
    ),
    ("q*x", "q", "unknown name `q`", "available are x,"),
    ("-v", "v", "unknown name `v`", "write `xdot`;"),
    ("-dx", "dx", "unknown name `dx`", "write `xdot`;"),
    ("X", "X", "unknown name `X`", "write `x`;"),
    ("ln(x)", "ln", "unknown name `ln`", "write `log`;"),
    ("pow(x, 2)", "pow", "unknown name `pow`", "write `^`;"),
    (
        "2*x'",
        "x'",
        "unexpected `x'` in an expression",
        "write `xdot` for the velocity",
    ),
    (
        "-ẋ",
        "ẋ",
        "unexpected `ẋ` in an expression",
        "write `xdot` for the velocity",
    ),
    (
        "x**2",
        "**",
        "`**` is not an operator",
        "write `^` for a power",
    ),
    ("2×x", "×", "unexpected `×` in an expression", "write `*`"),
    ("x²", "²", "unexpected `²` in an expression", "write `^2`"),
    (
        "x > 0",
        ">",
        "unexpected `>` in an expression",
        "comparisons are not supported: use max, min or sign",
    ),
    (
        "x == 0",
        "=",
        "unexpected `=` in an expression",
        "comparisons are not supported: use max, min or sign",
    ),
    (
        "x $ 0",
        "$",
        "unexpected `$` in an expression",
        "use numbers, names",
    ),
    ("π*x", "π", "unexpected `π` in an expression", "write `pi`"),
    (
        "sinh(x)",
        "sinh",
        "unknown name `sinh`",
        "write `(exp(x) - exp(-x))/2` for sinh(x);",
    ),
    (
        "log10(x)",
        "log10",
        "unknown name `log10`",
        "write `log(x)/log(10)` for the decimal",
    ),
    (
        "if(x, 1, 2)",
        "if",
        "unknown name `if`",
        "use max, min or sign",
    ),
    ("sni(x)", "sni", "unknown name `sni`", "write `sin`;"),
    (
        "1e*x",
        "1e",
        "`1e` is not a number",
        "as in 1000, 0.5 or 1e-3",
    ),
    (
        "1_000",
        "1_000",
        "`1_000` is not a number",
        "as in 1000, 0.5 or 1e-3",
    ),
    (
        "0x10*x",
        "0x10",
        "`0x10` is not a number",
        "as in 1000, 0.5 or 1e-3",
    ),
    (
        "2x",
        "2x",
        "an operator is missing between two values",
        "write `2*x` for a product",
    ),
    (
        "sin(2 x)",
        "2 x",
        "an operator is missing between two values",
        "write `2*x` for a product",
    ),
    (
        "(x)(t)",
        ")(",
        "an operator is missing between two values",
        "write `(..)*(..)` for a product",
    ),
    (
        "x(2)",
        "x(",
        "an operator is missing between two values",
        "write `x*(..)` for a product",
    ),
    (
        "1.2.3",
        "1.2.3",
        "`1.2.3` is not a number",
        "as in 1000, 0.5 or 1e-3",
    ),
    (
        "sin x",
        "sin",
        "the function `sin` has no parentheses",
        "write `sin(x)`, for example",
    ),
    (
        "sin()",
        "sin()",
        "`sin` takes one argument, not 0",
        "write `sin(x)`, for example",
    ),
    (
        "1 + sin(x, t)",
        "sin(x, t)",
        "`sin` takes one argument, not 2",
        "write `sin(x)`, for example",
    ),
    (
        "max(x)",
        "max(x)",
        "`max` takes two arguments or more, not 1",
        "write `max(x, 0)`, for example",
    ),
    (
        "2*(x + (t)",
        "(",
        "this parenthesis is not closed",
        "add the closing `)`",
    ),
    (
        "sin(x",
        "(",
        "this parenthesis is not closed",
        "add the closing `)`",
    ),
    (
        "x + t)",
        ")",
        "this parenthesis has no opening one",
        "remove it",
    ),
    (
        "x*()",
        ")",
        "a value is missing before `)`",
        "write a number, a name or a parenthesis after `(`",
    ),
    (
        "1,5*x",
        ",",
        "a comma stands outside the arguments of a function",
        "write a point in a number, as in 0.5",
    ),
    (
        "x + ",
        "",
        "a value is missing at the end of the expression",
        "write a number, a name or a parenthesis after `+`",
    ),
    ("x*/2", "/", "a value is missing before `/`", "after `*`"),
    (
        "*x",
        "*",
        "a value is missing before `*`",
        "begin with a number",
    ),
    (
        "x + 1e999",
        "1e999",
        "the number is too large",
        "write a number below 1.8e308",
    ),
    (
        "x + 1/0",
        "1/0",
        "`1/0` is infinite",
        "write a constant that has a finite value",
    ),
    (
        "1 + x/(mu - 0.3)",
        "x/(mu - 0.3)",
        "`x/(mu - 0.3)` divides by 0",
        "write a divisor other than 0",
    ),
    (
        "x + sqrt(-1)",
        "sqrt(-1)",
        "`sqrt(-1)` is not a number",
        "write a constant that has a finite value",
    ),
    (
        "x + (1 - 1)^-1",
        "(1 - 1)^-1",
        "`(1 - 1)^-1` is infinite",
        "write a constant that has a finite value",
    ),
];

#[test]
fn every_mistake_has_its_place_and_its_remedy() {
    for (text, marked, problem, remedy) in WRONG {
        let error = Expression::parse(text, &parameters()).expect_err(text);
        assert_eq!(
            (&text[error.start..error.end], error.problem.as_str()),
            (marked, problem),
            "{text}"
        );
        assert!(error.remedy.contains(remedy), "{text}: {}", error.remedy);
    }
    let open = Expression::parse("2*(x + (t)", &parameters()).expect_err("open");
    assert_eq!(open.start, 2, "the parenthesis that is open");
}

#[test]
fn no_hint_changes_the_meaning() {
    for text in ["d*x", "x2", "xx", "tanh2(x)", "atan2(x, t)", "max3(x, t)"] {
        let remedy = Expression::parse(text, &[]).expect_err(text).remedy;
        assert!(remedy.starts_with("available are"), "{text}: {remedy}");
    }
}

#[test]
fn a_parameter_has_a_name_and_a_value_of_its_own() {
    let problem = |parameters: &[(&str, f64)]| {
        let parameters: Vec<_> = parameters
            .iter()
            .map(|(name, value)| (name.to_string(), *value))
            .collect();
        Expression::parse("x", &parameters)
            .expect_err("a wrong parameter")
            .problem
    };
    assert_eq!(
        problem(&[("sin", 1.0)]),
        "must not contain the reserved name `sin`"
    );
    assert_eq!(
        problem(&[("xdot", 1.0)]),
        "must not contain the reserved name `xdot`"
    );
    for name in ["", "1a", "a b", "μ", "k.3", &"a".repeat(41)] {
        assert!(
            problem(&[(name, 1.0)]).ends_with("cannot be the name of a parameter"),
            "{name}"
        );
    }
    assert_eq!(
        problem(&[("a", 1.0), ("a", 2.0)]),
        "two parameters are called `a`"
    );
    assert_eq!(problem(&[("a", f64::NAN)]), "the parameter `a` is NaN");
    assert_eq!(
        problem(&[("a", 1.0); 65]),
        "65 parameters; at most 64 are supported"
    );
    assert!(Expression::parse("v*_a1", &[("v".into(), 1.0), ("_a1".into(), 2.0)]).is_ok());
}

#[test]
fn what_is_too_large_says_by_how_much() {
    let problem = |text: &str| {
        Expression::parse(text, &[])
            .err()
            .map(|error| error.problem)
    };
    let nested = |n: usize| format!("{}x{}", "(".repeat(n), ")".repeat(n));
    assert_eq!(problem(&nested(64)), None);
    let too_deep = Some("more than 64 nested parentheses, signs and powers".to_string());
    assert_eq!(problem(&nested(65)), too_deep);
    assert_eq!(problem(&nested(900)), too_deep);
    assert_eq!(problem(&format!("{}x", "-".repeat(1900))), too_deep);
    assert_eq!(problem(&vec!["x"; 900].join("^")), too_deep);
    assert_eq!(problem(&"sin(".repeat(400)), too_deep);
    assert_eq!(problem(&vec!["x"; 401].join("+")), None);
    assert_eq!(
        problem(&vec!["x"; 402].join("+")),
        Some("the expression has more than 400 operations".into())
    );
    assert_eq!(
        problem(&" ".repeat(2001)),
        Some("the expression has 2001 bytes, more than 2000".into())
    );
    let tower = (1..60).fold("x".to_string(), |inner, i| format!("sin({i}*x)+({inner})"));
    assert_eq!(
        problem(&tower),
        Some("the expression needs more than 32 intermediate values at once".into())
    );
}

proptest! {
    #[test]
    fn no_text_makes_the_parser_panic(text in "\\PC{0,60}|[-+*/^(),. 0-9a-zμ']{0,80}") {
        let _ = Expression::parse(&text, &parameters());
    }

    #[test]
    fn no_words_make_the_parser_or_the_scan_panic(
        words in prop::collection::vec(proptest::sample::select(vec![
            "x", "xdot", "t", "mu", "1e308", "2", "0", "+", "-", "*", "/", "^", "(", ")", ",", "sin(", "log(", "sign(",
            "max(", "sqrt(", "tan(", "x)", "- 1",
        ]), 0..24)
    ) {
        let text = words.concat();
        match Expression::parse(&text, &parameters()) {
            Ok(expression) => {
                let scales = Scales { displacement: 1.0, velocity: 1.0, end: 10.0 };
                let found = force_warnings(&expression, scales);
                let body = Oscillator { mass: 1.0, stiffness: 1.0, damping: 0.1, drive: Drive::Force(0.0) };
                let steepest = steepest(&expression, scales, &body);
                prop_assert!(steepest.stiffness >= 0.0 && steepest.damping >= 0.0, "{steepest:?}");
                beyond_hold(&expression, scales, &body, 0.0);
                prop_assert!(found.iter().all(|warning| text.get(warning.start..warning.end).is_some()));
            }
            Err(error) => prop_assert!(text.get(error.start..error.end).is_some(), "{error:?}"),
        }
    }
}
