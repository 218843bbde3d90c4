//! What an expression means, what it says of a text that is none, and what is doubtful about a
//! force.

mod language;
mod mistakes;
mod scan;

use super::Expression;

/// The parameters of the expressions in the tests.
fn parameters() -> Vec<(String, f64)> {
    vec![("mu".into(), 0.3), ("vs".into(), 0.1)]
}

fn expression(text: &str) -> Expression {
    Expression::parse(text, &parameters()).unwrap_or_else(|error| panic!("{text}: {error}"))
}
