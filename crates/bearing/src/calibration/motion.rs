//! The quasi-static motion of the bearing in kelvin, sample by sample.
//!
//! The body has no mass and is at x = beta xi. It rests while |T - xi| <= A. When T goes beyond
//! that, the body slips by G towards T:
//!
//! ```text
//! A = f_s/(K beta)             the temperature difference that friction holds
//! G = 2 (f_s - f_d)/(K beta)   the size of one slip
//! ```
//!
//! A slip takes a tenth of a second, and the temperature is assumed to be linear from sample to
//! sample. So from one sample to the next there are n = ceil((|T - xi| - A)/G) slips towards T,
//! with T at the later sample. This is exact and has no discretisation error. With G = 0 the body
//! is dragged along at the distance A (the play operator).

/// The parameters of the motion: A, G and xi(0).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// A = f_s/(K beta) in kelvin: the largest distance of T from xi.
    pub reach: f64,
    /// G = 2 (f_s - f_d)/(K beta) in kelvin: the size of one slip, from 0 to 2 A.
    pub jump: f64,
    /// xi(0) in kelvin, on the scale of the thermometer.
    pub start: f64,
}

impl Motion {
    /// f_d/(K beta) in kelvin: A - G/2.
    pub fn kinetic_reach(&self) -> f64 {
        self.reach - 0.5 * self.jump
    }

    /// The same motion from sample to sample, where levels are closer by this many kelvin, so that
    /// samples cross them as often as the temperature between them crosses the original ones.
    pub fn at_samples(&self, overlooked: f64) -> Motion {
        Motion {
            reach: (self.reach - overlooked).max(0.0),
            ..*self
        }
    }

    /// xi after the temperature has moved to this value without turning.
    #[inline(always)]
    pub fn next(&self, xi: f64, temperature: f64) -> f64 {
        let away = temperature - xi;
        let beyond = away.abs() - self.reach;
        if beyond <= 0.0 {
            xi
        } else if self.jump > 0.0 {
            xi + (ceil(beyond / self.jump) * self.jump).copysign(away)
        } else {
            xi + beyond.copysign(away)
        }
    }

    /// xi at each of these temperatures, one after the other.
    pub fn follow(&self, temperatures: &[f64]) -> Vec<f64> {
        let mut xi = self.start;
        let step = |temperature: &f64| {
            xi = self.next(xi, *temperature);
            xi
        };
        temperatures.iter().map(step).collect()
    }
}

/// The smallest whole number not below x > 0. It avoids `f64::ceil`, which is a function call on
/// older processors.
#[inline(always)]
fn ceil(x: f64) -> f64 {
    // 2^52, from which on every double is a whole number.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    if x >= WHOLE {
        return x;
    }
    let below = x as i64 as f64;
    if below < x { below + 1.0 } else { below }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAVE: [f64; 9] = [0.0, 1.5, 2.5, 4.75, 2.0, -3.0, -1.0, 4.0, 0.0];

    /// Compared with slips taken one at a time, as the paper defines them: x + 2 eps (f_s - f_d)/K.
    #[test]
    fn many_slips_at_once_are_slips_one_after_another() {
        let motion = Motion {
            reach: 2.0,
            jump: 0.75,
            start: 0.0,
        };
        let mut xi = 0.0_f64;
        let mut slow = Vec::new();
        for temperature in WAVE {
            while (temperature - xi).abs() > motion.reach {
                xi += motion.jump.copysign(temperature - xi);
            }
            slow.push(xi);
        }
        assert_eq!(motion.follow(&WAVE), slow);
        assert_eq!(slow, [0.0, 0.0, 0.75, 3.0, 3.0, -1.5, -1.5, 2.25, 1.5]);
    }

    /// Without a gap the body is dragged: it rests while |T - xi| < A, and follows T at the
    /// distance A otherwise.
    #[test]
    fn without_a_gap_it_is_the_play_operator() {
        let play = Motion {
            reach: 2.0,
            jump: 0.0,
            start: 0.0,
        };
        assert_eq!(
            play.follow(&WAVE),
            [0.0, 0.0, 0.5, 2.75, 2.75, -1.0, -1.0, 2.0, 2.0]
        );
        let nearly = Motion { jump: 1e-9, ..play };
        let apart = |(a, b): (f64, f64)| (a - b).abs();
        let far = nearly
            .follow(&WAVE)
            .into_iter()
            .zip(play.follow(&WAVE))
            .map(apart)
            .fold(0.0, f64::max);
        assert!(far <= 1e-9, "{far}");
    }
}
