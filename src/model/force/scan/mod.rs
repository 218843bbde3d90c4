//! Where a force departs from what the paper assumes of it: that friction is its only jump, that it
//! is locally Lipschitz, and that it grows at most linearly.
//!
//! The search is numerical, at fixed points. It finds what shows at the scales of a scene, and
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

/// How far a force is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// The largest |x|.
    pub displacement: f64,
    /// The largest |x'|.
    pub velocity: f64,
    /// The last t; the first is 0.
    pub end: f64,
}

/// A place in an expression that the schemes are not made for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForceWarning {
    /// The first byte of the place in the text.
    pub start: usize,
    /// The byte behind the place.
    pub end: usize,
    /// What the force does there, in one sentence.
    pub sentence: String,
}

/// What is doubtful about a force, in the order of its text. A place has one warning of its value
/// and one of its growth at most, and places with the same warning are represented by the first.
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

/// How stiff a force is on this body, and how strongly it damps.
pub fn steepest(force: &Expression, scales: Scales, body: &Oscillator) -> Steepest {
    slopes::found(&mut probe(force, scales), body)
}

/// Where a force drives this body outward however far it is, or adds energy to it however fast it
/// is, in one sentence; none where that does not show. The body slides under this friction f_d.
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
