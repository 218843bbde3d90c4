//! A user-defined force g(x, x', t), with the instructions that evaluate it, or none.

use crate::lanes::{InstructionSet, Lanes, ROW};
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

    /// g in a slip in this direction at these places and times of one path, or of several in lanes.
    #[inline(always)]
    pub fn at_points<L: Lanes>(&self, direction: Sign, at: [&[L]; 3], g: &mut [L]) {
        let Some((force, set)) = &self.0 else { return };
        let (force, points) = (force.in_slip(direction), at[0].len());
        // Eight numbers are evaluated at once; the last point fills what is left of them.
        let together = ROW / L::WIDTH;
        for from in (0..points).step_by(together) {
            let mut numbers = [[0.0; ROW]; 3];
            for (numbers, values) in numbers.iter_mut().zip(at) {
                for i in 0..together {
                    values[(from + i).min(points - 1)].store(&mut numbers[i * L::WIDTH..]);
                }
            }
            let [x, velocity, time] = &numbers;
            let all = force.at_each(*set, x, velocity, time);
            for i in 0..together.min(points - from) {
                g[from + i] = L::load(&all[i * L::WIDTH..]);
            }
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
