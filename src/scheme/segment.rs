//! The motion of a path between its events, segment by segment, for an observer that follows it.
//!
//! A scheme divides the motion where it is known: an event-driven path at its steps and their
//! bisections, a path without noise where its closed form is close to a polynomial, a path with a
//! step at its steps. Segments do not depend on the instants of observation, so an observer of part
//! of the time takes part of a segment.

/// A segment of the motion of one path within a sub-phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// When it begins, a time.
    pub start: f64,
    /// How long it lasts, a time.
    pub length: f64,
    /// x at its start, a length.
    pub displacement: f64,
    /// The change of x, a length with the sign of x'. It is separate from x, because it may be less
    /// than the rounding of x.
    pub way: f64,
    /// x' at both ends, a length per time.
    pub velocity: [f64; 2],
    /// The motion in between.
    pub along: Along,
}

/// The motion of a body in a [`Segment`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Along {
    /// x is the quintic that has x, x' and x'' of both ends. Under noise it is the mean of x given
    /// these.
    Smooth {
        /// x'' at both ends, a length per time squared.
        acceleration: [f64; 2],
        /// T, in units of temperature, if the scheme keeps it constant; none if it varies.
        temperature: Option<f64>,
    },
    /// A step of a scheme with a step: all forces are those at its start.
    Step {
        /// T at the start, in units of temperature.
        temperature: f64,
    },
}

/// Halvings until a place in a segment has all its digits.
const HALVINGS: usize = 52;

impl Segment {
    /// When it ends.
    pub fn end(&self) -> f64 {
        self.start + self.length
    }

    /// x and x' at a time from its start on. After its end the body is at rest. A time that differs
    /// from the end by rounding counts as the end.
    pub fn state(&self, time: f64) -> [f64; 2] {
        let behind = time - self.end();
        let rounding = 4.0 * f64::EPSILON * time;
        if behind < -rounding {
            let [way, velocity, _] = self.at((time - self.start) / self.length);
            return [self.displacement + way, velocity];
        }
        let velocity = if behind > rounding {
            0.0
        } else {
            self.velocity[1]
        };
        [self.displacement + self.way, velocity]
    }

    /// The distance from the start, x' and x'' at a place, as a part of the length from 0 to 1. In
    /// a step these are the ones of the start.
    pub fn at(&self, part: f64) -> [f64; 3] {
        let Segment {
            length: h,
            way,
            velocity: [v0, _],
            ..
        } = *self;
        let Along::Smooth {
            acceleration: [a0, _],
            ..
        } = self.along
        else {
            return [part * way, v0, 0.0];
        };
        let x = self.quintic();
        let v = derivative(&x);
        let [x, v, a] = [x, v, derivative(&v)].map(|of| value(&of, part));
        if h > 0.0 {
            [x, v / h, a / (h * h)]
        } else {
            [part * way, v0, a0]
        }
    }

    /// The distance from the start as a polynomial in the place, by its coefficients.
    fn quintic(&self) -> Polynomial {
        let Segment {
            length: h,
            way,
            velocity: [v0, v1],
            ..
        } = *self;
        let Along::Smooth {
            acceleration: [a0, a1],
            ..
        } = self.along
        else {
            return [0.0, way, 0.0, 0.0, 0.0, 0.0];
        };
        // In units of the length: x'' at the start, and the correction for the other end.
        let bend = h * h * a0;
        let [d, e, f] = [
            way - h * v0 - 0.5 * bend,
            h * (v1 - v0) - bend,
            h * h * (a1 - a0),
        ];
        let [p, q, r] = [
            10.0 * d - 4.0 * e + 0.5 * f,
            7.0 * e - 15.0 * d - f,
            6.0 * d - 3.0 * e + 0.5 * f,
        ];
        [0.0, h * v0, 0.5 * bend, p, q, r]
    }

    /// x and x' as polynomials, for a segment of some length.
    pub fn course(&self) -> Course {
        let mut x = self.quintic();
        let v = derivative(&x).map(|coefficient| coefficient / self.length);
        x[0] = self.displacement;
        let [start, end] = self.velocity;
        Course {
            polynomials: [x, v],
            ends: [[x[0], start], [x[0] + self.way, end]],
        }
    }

    /// The place between the ends at which |x'| is largest up to a place, if x'' = 0 there.
    pub fn fastest(&self, until: f64) -> Option<f64> {
        let Along::Smooth {
            acceleration: [first, _],
            ..
        } = self.along
        else {
            return None;
        };
        let direction = self.direction();
        if !(direction * first > 0.0 && direction * self.at(until)[2] < 0.0) {
            return None;
        }
        let (mut low, mut high) = (0.0, until);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if direction * self.at(middle)[2] > 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        Some(low)
    }

    /// The largest |x'| up to a place: at an end, or where x'' = 0.
    pub fn largest_speed(&self, until: f64) -> f64 {
        let [_, v, last] = self.at(until);
        let ends = self.velocity[0].abs().max(v.abs());
        let Some(place) = self.fastest(until) else {
            return ends;
        };
        // The polynomial of a very short segment is rounding, which this bounds.
        let most = ends + self.length * self.at(0.0)[2].abs().max(last.abs());
        ends.max((self.direction() * self.at(place)[1]).min(most))
    }

    /// The sign of x'.
    fn direction(&self) -> f64 {
        if self.way < 0.0 { -1.0 } else { 1.0 }
    }
}

/// The coefficients of a polynomial, from that of the constant on.
type Polynomial = [f64; 6];

/// The value of a polynomial.
fn value(of: &Polynomial, s: f64) -> f64 {
    of.iter()
        .rev()
        .fold(0.0, |sum, coefficient| sum * s + coefficient)
}

/// The value of a polynomial and its slope.
fn value_and_slope(of: &Polynomial, s: f64) -> [f64; 2] {
    of.iter()
        .rev()
        .fold([0.0; 2], |[value, slope], coefficient| {
            [value * s + coefficient, slope * s + value]
        })
}

fn derivative(of: &Polynomial) -> Polynomial {
    std::array::from_fn(|i| {
        of.get(i + 1)
            .map_or(0.0, |coefficient| (i + 1) as f64 * coefficient)
    })
}

/// The place between `from` and `to` at which a polynomial that is monotone there passes a value, by
/// Newton's method within a bracket. It depends on nothing else.
fn passes(of: &Polynomial, wanted: f64, [from, to]: [f64; 2]) -> f64 {
    let mut shifted = *of;
    shifted[0] -= wanted;
    let [first, last] = [from, to].map(|s| value(&shifted, s));
    let (mut low, mut high) = (from, to);
    let mut s = from + (to - from) * (first / (first - last)).clamp(0.0, 1.0);
    for _ in 0..HALVINGS {
        let [here, slope] = value_and_slope(&shifted, s);
        if (here < 0.0) == (last > first) {
            low = s
        } else {
            high = s
        }
        let newton = s - here / slope;
        let next = if low <= newton && newton <= high {
            newton
        } else {
            0.5 * (low + high)
        };
        let step = (next - s).abs();
        s = next;
        // The next step would be about its square.
        if step < 1e-8 {
            break;
        }
    }
    s.clamp(from, to)
}

/// x and x' in a segment.
#[derive(Clone, Debug)]
pub struct Course {
    polynomials: [Polynomial; 2],
    /// (x, x') at both ends, with all their digits.
    ends: [[f64; 2]; 2],
}

impl Course {
    /// (x, x') at a place.
    pub fn at(&self, place: f64) -> [f64; 2] {
        match place {
            0.0 => self.ends[0],
            1.0 => self.ends[1],
            _ => self.polynomials.each_ref().map(|of| value(of, place)),
        }
    }

    /// The place at which x (0) or x' (1), which is monotone between these places, passes a value.
    pub fn passes(&self, variable: usize, value: f64, between: [f64; 2]) -> f64 {
        passes(&self.polynomials[variable], value, between)
    }

    /// `from`, `to`, and the places in between at which x or x' turns. Between two zeros of its
    /// derivative a polynomial has one zero at most, so they follow from the fourth derivative of x
    /// on, which is linear.
    pub fn turns(&self, [from, to]: [f64; 2]) -> Turns {
        let mut chain = [self.polynomials[1]; 4];
        (1..4).for_each(|i| chain[i] = derivative(&chain[i - 1]));
        let mut turns = Turns {
            places: [from; 9],
            count: 1,
        };
        // Mostly neither turns: x'' lies between its four Bernstein coefficients.
        let [a, b, c, d, ..] = chain[1];
        let hull = [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c + d];
        let [start, end] = self.ends.map(|state| state[1]);
        if start * end >= 0.0 && (hull.iter().all(|x| *x > 0.0) || hull.iter().all(|x| *x < 0.0)) {
            turns.push(to);
            return turns;
        }
        for (order, of) in chain.iter().enumerate().rev() {
            let below = std::mem::replace(
                &mut turns,
                Turns {
                    places: [from; 9],
                    count: 1,
                },
            );
            let mut left = from;
            for right in below.rest().iter().copied().chain([to]) {
                if (value(of, left) < 0.0) != (value(of, right) < 0.0) {
                    turns.push(passes(of, 0.0, [left, right]));
                }
                left = right;
            }
            // x turns where x' = 0, and x' where x'' = 0.
            if order == 0 {
                below.rest().iter().for_each(|place| turns.push(*place));
            }
        }
        turns.push(to);
        turns.places[..turns.count].sort_unstable_by(f64::total_cmp);
        turns
    }
}

/// Some places in a segment, ascending.
#[derive(Clone, Debug)]
pub struct Turns {
    places: [f64; 9],
    count: usize,
}

impl Turns {
    fn push(&mut self, place: f64) {
        self.places[self.count] = place;
        self.count += 1;
    }

    /// All but the first.
    fn rest(&self) -> &[f64] {
        &self.places[1..self.count]
    }

    /// Each place with the next.
    pub fn pairs(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.places[..self.count]
            .windows(2)
            .map(|pair| [pair[0], pair[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = t^5 - 2 t^2 + 3 t from t = 0.5 on for a time of 2: a quintic is itself.
    #[test]
    fn a_quintic_is_followed_exactly() {
        let x = |t: f64| {
            [
                t.powi(5) - 2.0 * t * t + 3.0 * t,
                5.0 * t.powi(4) - 4.0 * t + 3.0,
                20.0 * t.powi(3) - 4.0,
            ]
        };
        let [[x0, v0, a0], [x1, v1, a1]] = [x(0.5), x(2.5)];
        let along = Along::Smooth {
            acceleration: [a0, a1],
            temperature: None,
        };
        let segment = Segment {
            start: 0.5,
            length: 2.0,
            displacement: x0,
            way: x1 - x0,
            velocity: [v0, v1],
            along,
        };
        for part in [0.0, 0.25, 0.7, 1.0] {
            let ([way, v, a], [wanted, wanted_v, wanted_a]) =
                (segment.at(part), x(0.5 + 2.0 * part));
            assert!(
                (x0 + way - wanted).abs() < 1e-12
                    && (v - wanted_v).abs() < 1e-12
                    && (a - wanted_a).abs() < 1e-11
            );
        }
    }

    /// x = (t - 1)^2 (t - 3)^2 (t + 1) turns at 1 and 3 and twice more, and x' where x'' = 0: every
    /// place is found, x is monotone between two of them, and passes a value where it has it.
    #[test]
    fn a_glide_is_cut_where_it_turns() {
        let x = |t: f64| (t - 1.0).powi(2) * (t - 3.0).powi(2) * (t + 1.0);
        let expanded = [9.0, -15.0, -2.0, 14.0, -7.0, 1.0];
        let v = derivative(&expanded);
        let a = derivative(&v);
        let [t0, t1] = [-0.9, 3.5];
        let ends = |of: &Polynomial| [t0, t1].map(|t| value(of, t));
        let along = Along::Smooth {
            acceleration: ends(&a),
            temperature: None,
        };
        let (displacement, way) = (x(t0), x(t1) - x(t0));
        let segment = Segment {
            start: t0,
            length: t1 - t0,
            displacement,
            way,
            velocity: ends(&v),
            along,
        };
        let course = segment.course();
        let time = |place: f64| t0 + (t1 - t0) * place;
        let turns: Vec<f64> = course
            .turns([0.0, 1.0])
            .pairs()
            .map(|pair| time(pair[1]))
            .collect();
        let steep = |of: &Polynomial| turns.iter().filter(|t| value(of, **t).abs() < 1e-9).count();
        assert_eq!((turns.len(), steep(&v), steep(&a)), (8, 4, 3), "{turns:?}");
        for [p, q] in course.turns([0.1, 0.95]).pairs() {
            let [low, high] = [p, q].map(|place| x(time(place)));
            for share in [0.01, 0.3, 0.99] {
                let wanted = low + share * (high - low);
                let place = course.passes(0, wanted, [p, q]);
                assert!(
                    p <= place && place <= q && (x(time(place)) - wanted).abs() < 1e-11,
                    "{wanted}"
                );
            }
        }
    }

    /// x' = 3 t - 3 t^2/2 on [0, 2] is largest at t = 1, and largest at 1/2 if it is only followed
    /// until then.
    #[test]
    fn the_largest_speed_lies_where_the_acceleration_vanishes() {
        for sign in [1.0, -1.0] {
            let along = Along::Smooth {
                acceleration: [3.0 * sign, -3.0 * sign],
                temperature: None,
            };
            let segment = Segment {
                start: 0.0,
                length: 2.0,
                displacement: 9.0,
                way: 2.0 * sign,
                velocity: [0.0; 2],
                along,
            };
            assert!((segment.largest_speed(1.0) - 1.5).abs() < 1e-15);
            assert!((segment.largest_speed(0.25) - 1.125).abs() < 1e-15);
        }
    }
}
