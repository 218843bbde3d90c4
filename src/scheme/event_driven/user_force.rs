//! A user-defined force g(x, x', t), with the instructions that evaluate it, or none.

use crate::lanes::InstructionSet;
use crate::model::{Force, Hold, Problem, Sign};

/// The g of a scene; 0 where there is none.
#[derive(Clone, Debug)]
pub struct UserForce(Option<(Force, InstructionSet)>);

impl UserForce {
    pub fn of(model: &Problem) -> Self {
        UserForce(
            model
                .force
                .clone()
                .map(|force| (force, InstructionSet::detect())),
        )
    }

    #[inline(always)]
    pub fn is_some(&self) -> bool {
        self.0.is_some()
    }

    /// Whether friction has a load, or g a direction.
    #[inline(always)]
    pub fn has_load(&self) -> bool {
        self.0
            .as_ref()
            .is_some_and(|(force, _)| force.sides().is_some())
    }

    /// Whether g, or the limit of b, depends on t.
    pub fn depends_on_time(&self) -> bool {
        self.0
            .as_ref()
            .is_some_and(|(force, _)| force.depends_on_time())
    }

    /// The fastest angular frequency at which g, or the limit of b, oscillates in t until `end`.
    pub fn fastest_rate(&self, end: f64) -> f64 {
        self.0
            .as_ref()
            .map_or(0.0, |(force, _)| force.fastest_rate(end))
    }

    /// The kinks of g from 0 to `end`, among them what steps of this length would pass by.
    pub fn kinks(&self, end: f64, step: f64) -> Vec<f64> {
        self.0
            .as_ref()
            .map_or(Vec::new(), |(force, _)| force.kinks(end, step))
    }

    /// g(x, x', t) in a slip in this direction, or where the body moves as its velocity says.
    #[inline(always)]
    pub fn at(&self, direction: Option<Sign>, x: f64, velocity: f64, time: f64) -> f64 {
        match (&self.0, direction) {
            (Some((force, set)), Some(direction)) => {
                force.in_slip(direction).at(*set, x, velocity, time)
            }
            (Some((force, set)), None) => force.at(*set, x, velocity, time),
            (None, _) => 0.0,
        }
    }

    /// g in a slip in this direction at eight places and times.
    #[inline(always)]
    pub fn at_each(
        &self,
        direction: Sign,
        x: &[f64; 8],
        velocity: &[f64; 8],
        time: &[f64; 8],
    ) -> [f64; 8] {
        match &self.0 {
            Some((force, set)) => force.in_slip(direction).at_each(*set, x, velocity, time),
            None => [0.0; 8],
        }
    }

    /// g(x, 0, t) in a stick, and how much the limits of b and -b differ from f_s.
    #[inline(always)]
    pub fn hold(&self, x: f64, time: f64) -> Hold {
        self.0
            .as_ref()
            .map_or(Hold::default(), |(force, set)| force.hold(*set, x, time))
    }
}
