//! Violations of the paper's assumptions about a force: no jumps except friction, local Lipschitz
//! continuity, and at most linear growth.
//!
//! The search is numerical, at fixed points. It detects violations at the scales of a scenario, and
//! proves nothing.

mod growth;
mod jumps;
mod probe;
mod slopes;

use super::expression::Expression;
use crate::model::Oscillator;
use probe::Probe;
pub use slopes::Steepest;
use std::collections::HashSet;

/// The range in which a force is examined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// The largest |x|.
    pub displacement: f64,
    /// The largest |x'|.
    pub velocity: f64,
    /// The last t; the first is 0.
    pub end: f64,
}

/// A place in an expression that violates an assumption of the schemes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForceWarning {
    /// The first byte of the place in the text.
    pub start: usize,
    /// The byte after the place.
    pub end: usize,
    /// What the force does there, in one sentence.
    pub sentence: String,
}

/// Warnings about a force, in the order of its text. A place has at most one warning about its
/// value and one about its growth, and places with the same warning are represented by the first.
pub fn force_warnings(force: &Expression, scales: Scales) -> Vec<ForceWarning> {
    let mut probe = probe(force, scales);
    let mut all = jumps::found(&mut probe);
    all.extend(growth::found(&mut probe));
    all.sort_by_key(|(node, _)| probe.formula.nodes[*node].place.start);
    let mut said = HashSet::new();
    all.retain(|(_, sentence)| said.insert(sentence.clone()));
    let place = |node: usize| probe.formula.nodes[node].place.clone();
    all.into_iter()
        .map(|(node, sentence)| ForceWarning {
            start: place(node).start,
            end: place(node).end,
            sentence,
        })
        .collect()
}

/// The stiffness and damping of a force on this body.
pub fn steepest(force: &Expression, scales: Scales, body: &Oscillator) -> Steepest {
    slopes::found(&mut probe(force, scales), body)
}

/// Where a force drives this body outward at any distance, or adds energy to it at any speed, in
/// one sentence; none if that is not found. The body slides under this friction f_d.
pub fn beyond_hold(
    force: &Expression,
    scales: Scales,
    body: &Oscillator,
    dynamic_force: f64,
) -> Option<String> {
    growth::beyond_hold(&mut probe(force, scales), body, dynamic_force)
}

fn probe(force: &Expression, scales: Scales) -> Probe<'_> {
    let sound = |scale: f64| {
        if scale.is_finite() && scale > 0.0 {
            scale
        } else {
            1.0
        }
    };
    let end = if force.uses_time() && scales.end.is_finite() {
        scales.end.max(0.0)
    } else {
        0.0
    };
    let scales = [sound(scales.displacement), sound(scales.velocity), end];
    Probe {
        formula: force.formula(),
        scales,
        values: Vec::new(),
    }
}
