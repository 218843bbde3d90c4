//! A force at single points, and descriptions of it.

use super::super::tree::{Formula, TIME, X, XDOT};

/// A node of the expression, and a sentence about it.
pub(super) type Found = (usize, String);

/// Computes an expression at single points.
pub(super) struct Probe<'a> {
    pub formula: &'a Formula,
    pub scales: [f64; 3],
    pub values: Vec<f64>,
}

impl Probe<'_> {
    /// g at a point. The values of all nodes stay in `values`.
    pub fn at(&mut self, point: [f64; 3]) -> f64 {
        self.formula.evaluate(point, &mut self.values);
        self.values.last().copied().unwrap_or(0.0)
    }

    /// The times at which g is examined: these parts of the duration, and the extremes of inputs.
    pub fn instants(&self, parts: &[f64]) -> Vec<f64> {
        let end = self.scales[TIME];
        if end == 0.0 {
            return vec![0.0];
        }
        let extremes = self
            .formula
            .used_inputs()
            .flat_map(|input| input.extremes())
            .filter(|t| *t <= end);
        parts
            .iter()
            .map(|part| part * end)
            .chain(extremes)
            .collect()
    }

    /// The coordinates of a point that matter, in words.
    pub fn words(&self, point: [f64; 3]) -> String {
        let uses =
            |i| self.formula.uses(i) || (i == TIME && self.formula.used_inputs().next().is_some());
        let names = [("x", X), ("xdot", XDOT), ("t", TIME)]
            .into_iter()
            .filter(|(_, i)| uses(*i));
        names
            .map(|(name, i)| format!("{name} = {}", short(point[i])))
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// A number with four digits.
pub(super) fn short(number: f64) -> String {
    // 0 is added so that -0 is not written.
    let rounded = format!("{number:.3e}").parse().unwrap_or(number) + 0.0;
    match rounded.abs() {
        size if size == 0.0 || (1e-4..1e6).contains(&size) || !size.is_finite() => {
            rounded.to_string()
        }
        _ => format!("{rounded:e}"),
    }
}
