//! A slip step under a force g(x, x', t) of the user's own.
//!
//! All other forces are linear, and their step is exact ([`SlipStep`]). g stands in it as a constant,
//! where eps f_d stands, and the end of the step is corrected for what g does in the step:
//!
//! ```text
//! trial        x, x' in the middle and at the end of the step without noise, from g at its start;
//!              the step is halved until g bends little on that way: |g0 - 2 g_m + g1| <= bend (forces)
//! draw         the linear step with g = g_m of the trial
//! correct      g at the drawn end, and in the middle of the quintic between both ends; then
//!              x += x_g ((g0 + 2 g_m)/3 - g),  x' += v_g ((g0 + 4 g_m + g1)/6 - g)
//! ```
//!
//! x_g and v_g are the responses of x and x' to a constant force over the step, and the weights those
//! of Simpson's rule for a force that acts on x early and on x' throughout. The length follows from
//! the state at the start alone, so that it does not depend on the noise that is then drawn, and the
//! law of what is drawn is not changed. The noise moves x and x' in the middle of a step off the
//! quintic by a random amount of mean zero, so the error of g by this is of order 3/2 in a step, and
//! of order 2 in the law of the path.

use super::path::Path;
use super::slip::Slip;
use crate::scheme::event_driven::law::first_stop::middle;
use crate::scheme::event_driven::law::scene::Scene;
use crate::scheme::event_driven::law::slip_step::{SlipPoint, SlipStep};
use crate::scheme::event_driven::work::Unresolved;

/// g along one slip.
pub(super) struct OwnForce {
    /// g at the start of the step.
    here: f64,
    /// The constant that stands for g in the step.
    pub push: f64,
    /// b at the start of the step.
    start_force: f64,
    /// How many times the usual step was halved last.
    halvings: usize,
}

impl OwnForce {
    /// g where a path is; none if there is no g.
    #[inline(always)]
    pub fn new(scene: &Scene, time: f64, path: &Path<f64>) -> Option<Self> {
        scene.has_own_force().then(|| {
            let here = scene.own_force(path.displacement, path.motion, time);
            OwnForce { here, push: here, start_force: path.force, halvings: 0 }
        })
    }

    /// The longest step from here on which g bends little, when this much of the cell remains, and
    /// whether it ends with the cell.
    #[inline(always)]
    pub fn step_towards<'s>(
        &mut self,
        slip: &'s Slip<'_>,
        remaining: f64,
        path: &mut Path<f64>,
        partial: &'s mut SlipStep,
    ) -> Result<(&'s SlipStep, bool), Unresolved> {
        let Scene { oscillator, friction, .. } = &slip.noisy.scene;
        let finest = slip.noisy.halved.len() - 1;
        let mut halvings = self.halvings.saturating_sub(1);
        // Halvings that leave more than what remains of the cell change nothing.
        while halvings < finest && slip.noisy.halved[halvings + 1].length() >= remaining {
            halvings += 1;
        }
        let acceleration = (path.force - slip.friction()) / oscillator.mass;
        let (x, v, time) = (path.displacement, path.motion, slip.time(path));
        loop {
            path.work.spend()?;
            let h = slip.noisy.halved[halvings].length().min(remaining);
            let way = |t: f64| (x + t * (v + 0.5 * t * acceleration), v + t * acceleration);
            let ((xm, vm), (x1, v1)) = (way(0.5 * h), way(h));
            let middle = slip.noisy.scene.own_force(xm, vm, time + 0.5 * h);
            let end = slip.noisy.scene.own_force(x1, v1, time + h);
            let forces = friction.static_force + path.force.abs() + self.here.abs();
            let bend = (self.here - 2.0 * middle + end).abs();
            if bend <= slip.noisy.most_bend * forces || halvings == finest {
                self.push = middle;
                break;
            }
            halvings += 1;
        }
        (self.halvings, self.start_force) = (halvings, path.force);
        Ok(slip.at_most(&slip.noisy.halved[halvings], remaining, partial))
    }

    /// Corrects the end of a step that was drawn with the constant for g, and b there.
    #[inline(always)]
    pub fn correct(&mut self, slip: &Slip<'_>, step: &SlipStep, start: SlipPoint, path: &mut Path<f64>) {
        let scene = &slip.noisy.scene;
        let (h, time, mass) = (step.length(), slip.time(path), scene.oscillator.mass);
        let end = scene.own_force(path.displacement, path.motion, time);
        let friction = slip.friction();
        let accelerations = [self.start_force - friction, path.force + end - friction].map(|force| force / mass);
        let (xm, vm) = middle(h, [start.x, path.displacement], [start.v, path.motion], accelerations);
        let middle = scene.own_force(xm, vm, time - 0.5 * h);
        let on_x = (self.here + 2.0 * middle) / 3.0 - self.push;
        let on_v = (self.here + 4.0 * middle + end) / 6.0 - self.push;
        let (dx, dv) = (step.transition.x[3] * on_x, step.transition.v[3] * on_v);
        path.displacement += dx;
        path.motion += dv;
        self.here = scene.own_force(path.displacement, path.motion, time);
        let body = &scene.oscillator;
        path.force += self.here - body.stiffness * dx - 2.0 * body.damping * dv;
    }
}
