//! The motion of a path between its events, piece by piece, for an observer that follows it.
//!
//! A scheme cuts the motion where it knows it: an event-driven path at its own steps and at what
//! it bisected them to, a path without noise where its closed form is close to a polynomial, a
//! path with a step at its steps. No piece depends on the instants at which a path is observed.

/// A piece of the motion of one path within a sub-phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glide {
    /// When it begins, a time.
    pub start: f64,
    /// How long it lasts, a time.
    pub length: f64,
    /// x at its start, a length.
    pub displacement: f64,
    /// How far x gets, a length with the sign of x'. It is kept apart from x, of which it may be
    /// less than the last digit.
    pub way: f64,
    /// x' at both ends, a length per time.
    pub velocity: [f64; 2],
    /// What the body does in between.
    pub along: Along,
}

/// What a body does in a [`Glide`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Along {
    /// x is the quintic that has x, x' and x'' of both ends. Under noise it is the mean of x given
    /// these.
    Smooth {
        /// x'' at both ends, a length per time squared.
        acceleration: [f64; 2],
    },
    /// A step of a scheme with a step: all forces are those at its start.
    Step {
        /// T at the start, in units of temperature.
        temperature: f64,
    },
}

/// Halvings until a place in a glide has all its digits.
const HALVINGS: usize = 52;

impl Glide {
    /// When it ends.
    pub fn end(&self) -> f64 {
        self.start + self.length
    }

    /// The distance from the start, x' and x'' at a place, as a part of the length from 0 to 1. In
    /// a step these are the ones of the start.
    pub fn at(&self, part: f64) -> [f64; 3] {
        let Glide { length: h, way, velocity: [v0, v1], .. } = *self;
        let Along::Smooth { acceleration: [a0, a1] } = self.along else { return [part * way, v0, 0.0] };
        // In units of the length: x'' at the start, and what the other end demands beyond it.
        let (s, bend) = (part, h * h * a0);
        let [d, e, f] = [way - h * v0 - 0.5 * bend, h * (v1 - v0) - bend, h * h * (a1 - a0)];
        let [p, q, r] = [10.0 * d - 4.0 * e + 0.5 * f, 7.0 * e - 15.0 * d - f, 6.0 * d - 3.0 * e + 0.5 * f];
        let x = s * (h * v0 + s * (0.5 * bend + s * (p + s * (q + s * r))));
        let v = h * v0 + s * (bend + s * (3.0 * p + s * (4.0 * q + s * 5.0 * r)));
        let a = bend + s * (6.0 * p + s * (12.0 * q + s * 20.0 * r));
        if h > 0.0 { [x, v / h, a / (h * h)] } else { [part * way, v0, a0] }
    }

    /// The largest |x'| up to a place: at an end, or where x'' = 0.
    pub fn largest_speed(&self, until: f64) -> f64 {
        let [_, v, last] = self.at(until);
        let ends = self.velocity[0].abs().max(v.abs());
        let Along::Smooth { acceleration: [first, _] } = self.along else { return ends };
        let direction = if self.way < 0.0 { -1.0 } else { 1.0 };
        if !(direction * first > 0.0 && direction * last < 0.0) {
            return ends;
        }
        let (mut low, mut high) = (0.0, until);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if direction * self.at(middle)[2] > 0.0 { low = middle } else { high = middle }
        }
        // Where a glide is very short its polynomial is rounding, which this bounds.
        let most = ends + self.length * first.abs().max(last.abs());
        ends.max((direction * self.at(low)[1]).min(most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = t^5 - 2 t^2 + 3 t from t = 0.5 on for a time of 2: a quintic is itself.
    #[test]
    fn a_quintic_is_followed_exactly() {
        let x = |t: f64| [t.powi(5) - 2.0 * t * t + 3.0 * t, 5.0 * t.powi(4) - 4.0 * t + 3.0, 20.0 * t.powi(3) - 4.0];
        let [[x0, v0, a0], [x1, v1, a1]] = [x(0.5), x(2.5)];
        let along = Along::Smooth { acceleration: [a0, a1] };
        let glide = Glide { start: 0.5, length: 2.0, displacement: x0, way: x1 - x0, velocity: [v0, v1], along };
        for part in [0.0, 0.25, 0.7, 1.0] {
            let ([way, v, a], [wanted, wanted_v, wanted_a]) = (glide.at(part), x(0.5 + 2.0 * part));
            assert!((x0 + way - wanted).abs() < 1e-12 && (v - wanted_v).abs() < 1e-12 && (a - wanted_a).abs() < 1e-11);
        }
    }

    /// x' = 3 t - 3 t^2/2 on [0, 2] is largest at t = 1, and largest at 1/2 if it is only followed
    /// until then.
    #[test]
    fn the_largest_speed_lies_where_the_acceleration_vanishes() {
        for sign in [1.0, -1.0] {
            let along = Along::Smooth { acceleration: [3.0 * sign, -3.0 * sign] };
            let glide =
                Glide { start: 0.0, length: 2.0, displacement: 9.0, way: 2.0 * sign, velocity: [0.0; 2], along };
            assert!((glide.largest_speed(1.0) - 1.5).abs() < 1e-15);
            assert!((glide.largest_speed(0.25) - 1.125).abs() < 1e-15);
        }
    }
}
