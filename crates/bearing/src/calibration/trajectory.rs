//! The motion of a body under a temperature, in short steps.

use super::air::Air;
use super::bearing::Response;
use super::course::Course;
use super::motion::Motion;
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

/// A body whose friction may change over time and from slip to slip.
#[derive(Clone, Debug)]
pub struct Body {
    /// The motion at present; its start is xi.
    pub motion: Motion,
    /// Relative standard deviation of f_s from slip to slip.
    scatter: f64,
    /// f_s of the next slip relative to its mean.
    share: f64,
}

impl Body {
    /// A body with this motion at first, and this relative standard deviation of f_s.
    pub fn new(motion: Motion, scatter: f64) -> Self {
        Body {
            motion,
            scatter,
            share: 1.0,
        }
    }

    /// Change the motion where the body is.
    pub fn adopt(&mut self, motion: Motion) {
        let start = self.motion.start;
        self.motion = Motion { start, ..motion };
    }

    /// The largest distance of T from xi before the next slip.
    pub fn reach(&self) -> f64 {
        (self.share * self.motion.reach).max(self.motion.kinetic_reach())
    }

    /// Slip as often as needed after the temperature has moved to this value without turning; returns
    /// the number of slips, and the largest distance of T from xi before one.
    #[inline(always)]
    pub fn follow(&mut self, temperature: f64, friction: &mut Stream) -> (f64, f64) {
        let Motion {
            reach, jump, start, ..
        } = self.motion;
        if self.scatter == 0.0 {
            self.motion.start = self.motion.next(start, temperature);
            let moved = (self.motion.start - start).abs();
            return match moved > 0.0 && jump > 0.0 {
                true => (libm::round(moved / jump), reach),
                false => (0.0, 0.0),
            };
        }
        let (mut slips, mut farthest) = (0.0, 0.0_f64);
        while (temperature - self.motion.start).abs() > self.reach() {
            let reach = self.reach();
            let slip = 2.0 * (reach - self.motion.kinetic_reach());
            self.motion.start += slip.copysign(temperature - self.motion.start);
            slips += 1.0;
            farthest = farthest.max(reach);
            self.share = 1.0 + self.scatter * friction.normal();
        }
        (slips, farthest)
    }
}

/// The motion of a body whose friction has this course, whose steel is `lag` seconds behind the air, and whose f_s has the relative
/// standard deviation `scatter` from slip to slip. `friction` draws f_s, and `between` the
/// temperature between the times of the air, in steps of at most `longest` seconds.
///
/// Between two known temperatures, a rough one is a Brownian bridge; it is drawn in steps, and the
/// extreme temperature within a step has its exact law. Across a gap it is linear.
pub fn trajectory(
    (response, course): (&Response, &Course),
    air: &Air,
    lag: f64,
    scatter: f64,
    longest: f64,
    [mut friction, mut between]: [Stream; 2],
) -> Trajectory {
    let Air {
        times,
        temperatures,
        stride,
        roughness,
    } = air;
    let mut body = Body::new(response.motion, scatter);
    let mut slips = 0.0;
    let mut trajectory = Trajectory::default();
    let mut gaps = starts(times).into_iter().skip(1).peekable();
    let usual = interval(times);
    let mut steel = temperatures.first().copied().unwrap_or(0.0);
    for i in 0..times.len() {
        body.adopt(course.motion(&response.motion, times[i]));
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
                        let reached =
                            farthest([a, b], rough * step, body.motion.start, &mut between);
                        slips += body.follow(reached, &mut friction).0;
                    }
                    steel = b;
                }
                slips += body.follow(steel, &mut friction).0;
                a = b;
            }
        } else {
            slips += body.follow(steel, &mut friction).0;
        }
        if i.is_multiple_of(*stride) {
            trajectory.steel.push(steel);
            trajectory.positions.push(body.motion.start);
        }
    }
    trajectory.slips = slips as u64;
    trajectory
}

/// The highest value of a Brownian bridge between two values, or the lowest one if the bridge is
/// below `centre`; `gain` is the variance gained from one end to the other.
pub fn farthest([a, b]: [f64; 2], gain: f64, centre: f64, random: &mut Stream) -> f64 {
    let beyond = ((b - a) * (b - a) - 2.0 * gain * libm::log(random.uniform())).sqrt();
    0.5 * (a + b + beyond.copysign(0.5 * (a + b) - centre))
}
