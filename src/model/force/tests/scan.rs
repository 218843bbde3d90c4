//! What is doubtful about forces.

use super::super::{Scales, beyond_hold, force_warnings, steepest};
use super::expression;
use crate::model::{Drive, Oscillator};
use std::time::Instant;

/// The warnings about a force, each with the part of the text that it is about.
fn found(text: &str) -> Vec<String> {
    let all = force_warnings(
        &expression(text),
        Scales {
            displacement: 2.0,
            velocity: 1.5,
            end: 30.0,
        },
    );
    all.into_iter()
        .map(|warning| {
            format!(
                "{}: {}",
                &text[warning.start..warning.end],
                warning.sentence
            )
        })
        .collect()
}

#[test]
fn a_force_that_the_paper_allows_has_no_doubts() {
    for text in [
        "0",
        "-3*x + 0.2*xdot",
        "mu*(1 - exp(-abs(xdot)/vs))*sign(xdot)",
        "mu*(1 - exp(-abs(xdot)/1e-4))*sign(xdot)",
        "x*sign(x)",
        "xdot*sign(xdot - 0.5) - 0.5*sign(xdot - 0.5)",
        "sign(x)*max(abs(x) - 1, 0)",
        "-20*max(x - 1, 0)",
        "20*max(x - 30, 0)",
        "-x^3",
        "(0.3 - 0.05*x^2)*xdot",
        "-xdot*abs(xdot)",
        "tanh(xdot/1e-3)",
        "sin(3*x)*cos(t)",
        "1/(1 + x^2)",
        "1/(1e-3 + abs(x))",
        "sqrt(1 + x^2)",
        "log(3 + x)",
        "exp(-x^2)",
        "-exp(x)",
        "x^3*exp(-abs(x))",
        "-x^3 + 0.2*x^2*cos(t)",
        "sqrt(x^2)",
        "x/max(abs(x), 0.01)",
    ] {
        assert_eq!(found(text), [""; 0], "{text}");
    }
}

#[test]
fn a_jump_is_found_where_it_is() {
    assert_eq!(found("sign(x)"), ["sign(x): the force jumps by 2 at x = 0"]);
    assert_eq!(
        found("-mu*sign(xdot)"),
        ["sign(xdot): the force jumps by 0.6 at xdot = 0"]
    );
    assert_eq!(
        found("mu/(1 + abs(xdot)/vs)*sign(xdot)"),
        ["sign(xdot): the force jumps by 0.6 at xdot = 0"]
    );
    assert_eq!(
        found("x/abs(x)"),
        ["x/abs(x): the force jumps by 2 at x = 0"]
    );
    assert_eq!(
        found("x + sign(x - 0.7)"),
        ["sign(x - 0.7): the force jumps by 2 at x = 0.7"]
    );
    assert_eq!(
        found("3*sign(sin(t/9))"),
        ["sign(sin(t/9)): the force jumps by 6 at t = 28.27"]
    );
    assert_eq!(
        found("(1 + xdot)*sign(x*x)"),
        [""; 0],
        "a point is not a jump"
    );
    assert_eq!(
        found("sign(xdot - 0.3*x)"),
        ["sign(xdot - 0.3*x): the force jumps by 2 at x = 0, xdot = 0"]
    );
}

#[test]
fn what_has_no_bound_or_no_value_is_found() {
    assert_eq!(
        found("sin(x)/x"),
        ["sin(x)/x: the force has no value at x = 0"]
    );
    assert_eq!(
        found("1/x"),
        ["1/x: the force grows without bound at x = 0"]
    );
    assert_eq!(
        found("x^-2"),
        ["x^-2: the force grows without bound at x = 0"]
    );
    assert_eq!(
        found("1/(x - 0.3)^2"),
        ["1/(x - 0.3)^2: the force grows without bound at x = 0.3"]
    );
    assert_eq!(
        found("tan(x)"),
        ["tan(x): the force grows without bound at x = -1.571"]
    );
    assert_eq!(
        found("sqrt(x)"),
        ["sqrt(x): the force has no value at x = -2"]
    );
    assert_eq!(
        found("sqrt(abs(x))*sign(x)"),
        ["sqrt(abs(x)): the slope of the force is unbounded at x = 0"]
    );
    assert_eq!(
        found("log(x + 1)"),
        ["log(x + 1): the force has no value at x = -2"]
    );
    assert_eq!(
        found("sqrt(1.5 - x)"),
        ["sqrt(1.5 - x): the force has no value at x = 1.562"]
    );
    assert_eq!(
        found("sqrt(10-t)"),
        ["sqrt(10-t): the force has no value at t = 24.9"]
    );
    assert_eq!(
        found("x^0.333"),
        ["x^0.333: the force has no value at x = -2"]
    );
    assert_eq!(
        found("exp(900*x)")[0],
        "exp(900*x): the force is infinite at x = 0.8125"
    );
    assert_eq!(
        found("log(-3 - x^2)"),
        ["log(-3 - x^2): the force has no value at x = -2"]
    );
    assert_eq!(
        found("1/xdot + 1/xdot"),
        ["1/xdot: the force grows without bound at xdot = 0"]
    );
}

/// The largest stiffness and damping of a force on a body with m = 1 and K = 1, where the body may
/// move by 2.
fn steepness(text: &str) -> (f64, f64, String) {
    let drive = Drive::Dilatation(0.0);
    let body = Oscillator {
        mass: 1.0,
        stiffness: 1.0,
        damping: 0.0,
        drive,
    };
    let found = steepest(
        &expression(text),
        Scales {
            displacement: 2.0,
            velocity: 2.0,
            end: 30.0,
        },
        &body,
    );
    let place = if found.stiffness > 0.0 {
        found.stiffest
    } else {
        found.most_damped
    };
    (found.stiffness, found.damping, place)
}

/// The energy of the body is 2.
#[test]
fn the_steepest_slope_is_found_where_the_body_can_get() {
    let near = |text: &str, stiffness: f64, damping: f64| {
        let found = steepness(text);
        let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-4 * b;
        assert!(
            is_near(found.0, stiffness) && is_near(found.1, damping),
            "{text}: {found:?}"
        );
        found.2
    };
    assert_eq!(near("0.3*x + 2*xdot", 0.0, 0.0), "");
    near("-1e5*max(x - 1.3, 0)", 1e5, 0.0);
    assert_eq!(near("-30*tanh((x - 0.77)/1e-3)", 3e4, 0.0), "x = 0.77");
    assert_eq!(near("-tanh((xdot + 0.5)/1e-3)", 0.0, 500.0), "xdot = -0.5");
    near("-x*max(t - 10, 0)", 14.9, 0.0);
    near("-4*sign(x) - 3*sign(xdot)", 0.0, 0.0);
    near("-1e5*max(x - 2.5, 0)", 0.0, 0.0);
    // x^2/2 + 25 x^4 = 2 at x = 0.52, and the interval there ends at 0.5625.
    near("-100*x^3", 300.0 * 0.5625 * 0.5625, 0.0);
}

#[test]
fn a_force_that_nothing_holds_is_found() {
    let drive = Drive::Dilatation(0.0);
    let body = Oscillator {
        mass: 1.0,
        stiffness: 1.0,
        damping: 0.1,
        drive,
    };
    let scales = Scales {
        displacement: 2.0,
        velocity: 2.0,
        end: 30.0,
    };
    let found = |text: &str| beyond_hold(&expression(text), scales, &body, 0.5);
    let outward = "[force] pushes outward more than the spring pulls back, as at";
    let energy = "[force] adds more energy than damping and friction dissipate, as at";
    assert_eq!(found("2*x"), Some(format!("{outward} x = 20")));
    assert_eq!(found("x*t"), Some(format!("{outward} x = 20, t = 3.9")));
    assert_eq!(
        found("0.3*xdot - 1e-9*x^3"),
        Some(format!("{energy} x = 0, xdot = 20"))
    );
    for text in [
        "0.5*x",
        "-x^3",
        "x^3",
        "9.81",
        "x*exp(-x^2)",
        "0.1*xdot",
        "(0.3 - 0.05*x^2)*xdot",
        "0.5*xdot*cos(t)",
    ] {
        assert_eq!(found(text), None, "{text}");
    }
    // Friction that falls with the speed gives back no more than there is of it (Stribeck), and a
    // push that is stronger than friction drives the body away where no damping takes it up.
    let undamped = Oscillator {
        damping: 0.0,
        ..body
    };
    let pushed = |text: &str| beyond_hold(&expression(text), scales, &undamped, 0.5);
    assert_eq!(pushed("0.5*sign(xdot)*(1 - 1/(1 + 3*abs(xdot)))"), None);
    assert_eq!(
        pushed("0.6*sign(xdot)"),
        Some(format!("{energy} xdot = 20"))
    );
}

#[test]
fn growth_that_does_not_confine_is_found() {
    let outward = "the force pushes outward and grows faster than linearly: it is";
    let energy = "the force adds energy and grows faster than linearly: it is";
    assert_eq!(found("x^3"), [format!("x^3: {outward} 8e9 at x = 2000")]);
    assert_eq!(
        found("x - 0.1*x + x^2"),
        [format!("x^2: {outward} 4.002e6 at x = 2000")]
    );
    assert_eq!(
        found("-x + 0.1*xdot^3"),
        [format!(
            "0.1*xdot^3: {energy} 3.375e8 at x = 0, xdot = 1500"
        )]
    );
    assert_eq!(
        found("exp(x)"),
        [format!("exp(x): {outward} 4.852e8 at x = 20")]
    );
    assert_eq!(
        found("x^2*xdot"),
        [format!("x^2*xdot: {energy} 6e9 at x = 2000, xdot = 1500")]
    );
    assert_eq!(
        found("x^3*cos(t)"),
        [format!("x^3*cos(t): {outward} 8e9 at x = 2000, t = 0")]
    );
}

/// The expression is as long as one may be.
#[test]
fn a_search_ends_soon() {
    let text = vec!["sign(x+t)*tan(xdot*t)"; 57].join("+");
    let start = Instant::now();
    let _ = found(&text);
    assert!(start.elapsed().as_secs_f64() < 5.0, "{:?}", start.elapsed());
}
