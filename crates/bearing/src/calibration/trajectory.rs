//! The motion of a body under a temperature, in short steps.

use super::air::Air;
use super::bearing::Response;
use super::samples::{interval, starts};
use stickslip::noise::Stream;

/// The longest step for a rough temperature, in seconds, by default.
pub const STEP: f64 = 60.0;

/// The maximum number of steps between two known temperatures.
const MOST_STEPS: f64 = 10_000.0;

/// The body and its steel at the samples of the thermometer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// The temperature of the steel.
    pub steel: Vec<f64>,
    /// xi, the position of the body in kelvin.
    pub positions: Vec<f64>,
    /// Number of slips.
    pub slips: u64,
}

/// A body whose friction may change from slip to slip.
struct Body<'a> {
    response: &'a Response,
    scatter: f64,
    friction: Stream,
    xi: f64,
    reach: f64,
    slips: u64,
}

impl Body<'_> {
    /// Slip as often as needed after the temperature has moved to this value without turning.
    fn follow(&mut self, temperature: f64) {
        let motion = &self.response.motion;
        if self.scatter == 0.0 {
            let next = motion.next(self.xi, temperature);
            if motion.jump > 0.0 {
                self.slips += ((next - self.xi) / motion.jump).abs().round() as u64;
            }
            self.xi = next;
            return;
        }
        let kinetic = motion.kinetic_reach();
        while (temperature - self.xi).abs() > self.reach {
            self.xi += (2.0 * (self.reach - kinetic)).copysign(temperature - self.xi);
            self.slips += 1;
            let drawn = motion.reach * (1.0 + self.scatter * self.friction.normal());
            self.reach = drawn.max(kinetic);
        }
    }
}

/// The motion of a body whose steel is `lag` seconds behind the air, and whose f_s has the relative
/// standard deviation `scatter` from slip to slip. `friction` draws f_s, and `between` the
/// temperature between the times of the air, in steps of at most `longest` seconds.
///
/// Between two known temperatures, a rough one is a Brownian bridge; it is drawn in steps, and the
/// extreme temperature within a step has its exact law. Across a gap it is linear.
pub fn trajectory(
    response: &Response,
    air: &Air,
    lag: f64,
    scatter: f64,
    longest: f64,
    [friction, mut between]: [Stream; 2],
) -> Trajectory {
    let Air {
        times,
        temperatures,
        stride,
        roughness,
    } = air;
    let motion = response.motion;
    let mut body = Body {
        response,
        scatter,
        friction,
        xi: motion.start,
        reach: motion.reach,
        slips: 0,
    };
    let mut trajectory = Trajectory::default();
    let mut gaps = starts(times).into_iter().skip(1).peekable();
    let usual = interval(times);
    let mut steel = temperatures.first().copied().unwrap_or(0.0);
    for i in 0..times.len() {
        if i > 0 {
            let (h, mut a) = (times[i] - times[i - 1], temperatures[i - 1]);
            let is_gap = gaps.next_if_eq(&i).is_some();
            let rough = if is_gap || usual.is_nan() {
                0.0
            } else {
                *roughness
            };
            let steps = if rough > 0.0 {
                (h / longest).ceil().clamp(1.0, MOST_STEPS)
            } else {
                1.0
            };
            if is_gap && lag > 0.0 {
                // As in a measured record, the steel has the temperature of the air after a gap.
                a = temperatures[i];
                steel = a;
            }
            let step = h / steps;
            for k in 0..steps as u64 {
                let left = steps - k as f64;
                let mean = a + (temperatures[i] - a) / left;
                let b = if left > 1.5 {
                    mean + (rough * step * (1.0 - 1.0 / left)).sqrt() * between.normal()
                } else {
                    temperatures[i]
                };
                if lag > 0.0 {
                    let rise = lag * (b - a) / step;
                    steel = b - rise + (steel - a + rise) * libm::exp(-step / lag);
                } else {
                    if rough > 0.0 {
                        body.follow(farthest([a, b], rough * step, body.xi, &mut between));
                    }
                    steel = b;
                }
                body.follow(steel);
                a = b;
            }
        } else {
            body.follow(steel);
        }
        if i.is_multiple_of(*stride) {
            trajectory.steel.push(steel);
            trajectory.positions.push(body.xi);
        }
    }
    trajectory.slips = body.slips;
    trajectory
}

/// The highest value of a Brownian bridge between two values, or the lowest one if the bridge is
/// below `centre`; `gain` is the variance gained from one end to the other.
pub fn farthest([a, b]: [f64; 2], gain: f64, centre: f64, random: &mut Stream) -> f64 {
    let beyond = ((b - a) * (b - a) - 2.0 * gain * libm::log(random.uniform())).sqrt();
    0.5 * (a + b + beyond.copysign(0.5 * (a + b) - centre))
}
