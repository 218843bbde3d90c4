//! The first zero of a smooth function, with guaranteed detection.
//!
//! Let g(r) >= 0 and |g''| <= M on [r, r + H]. Taylor's theorem gives g(r + u) >= g + g' u - M
//! u^2/2, which is positive for every u below its positive root
//!
//! ```text
//! u* = 2 g / (sqrt(g'^2 + 2 M g) - g')
//! ```
//!
//! So no zero lies in [r, r + min(u*, H)), and the search may continue at its right end. Repeating
//! this never passes a zero, unlike a search on a grid, which may be too coarse. Near a simple
//! zero, u* is a Newton step from the left (quadratic convergence); near a double zero each step
//! still reduces the distance by a fixed factor. The search ends where g <= 0 or where u* is below
//! the resolution of r. For the first zero of several functions, the step is the smallest of their
//! u*.

use super::super::work::{Resolved, Unresolved, WorkLeft};

/// A function g at one point, and a bound of its second derivative ahead of this point.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// g.
    pub value: f64,
    /// g'.
    pub slope: f64,
    /// M at this point: |g''| at a distance u ahead is at most bend + bend_growth u.
    pub bend: f64,
    /// The growth of M with the distance; see `bend`.
    pub bend_growth: f64,
    /// The distance up to which the bound holds, which may be infinite.
    pub holds_for: f64,
}

/// The first zero at or after `start` of any of several functions and the index of that function;
/// none if there is no zero up to `end`.
///
/// `span` is the time over which one bound of the second derivative is used. A search takes some
/// ten evaluations per oscillation of g, each of which is counted in `work`.
pub fn first_root<const N: usize>(
    mut jets: impl FnMut(f64) -> [Jet; N],
    start: f64,
    end: f64,
    span: f64,
    work: &mut WorkLeft,
) -> Resolved<Option<(f64, usize)>> {
    let mut r = start;
    loop {
        if r > end {
            return Ok(None);
        }
        work.spend()?;
        let (step, nearest) = jets(r)
            .iter()
            .enumerate()
            .map(|(i, g)| {
                (
                    if g.value <= 0.0 {
                        0.0
                    } else {
                        g.positive_for(span)
                    },
                    i,
                )
            })
            .fold((f64::INFINITY, 0), |a, b| {
                if b.0 < a.0 || b.0.is_nan() { b } else { a }
            });
        if step.is_nan() || (step.is_infinite() && end.is_infinite()) {
            return Err(Unresolved::NoNumber);
        }
        let next = r + step;
        if next - r <= f64::EPSILON * r {
            return Ok(Some((next, nearest)));
        }
        r = next;
    }
}

impl Jet {
    /// A distance ahead up to which g is certainly positive.
    fn positive_for(&self, span: f64) -> f64 {
        // The bound is used over a distance of at least `span`, or the longer one over which it
        // doubles.
        let window = if self.bend_growth > 0.0 {
            span.max(self.bend / self.bend_growth)
        } else {
            f64::INFINITY
        };
        let window = window.min(self.holds_for);
        let bend = if window < f64::INFINITY {
            self.bend + self.bend_growth * window
        } else {
            self.bend
        };
        let step = safe_step(self.value, self.slope, bend);
        // `min` is not used here, because it would hide a NaN.
        if step > window { window } else { step }
    }
}

/// u*: the distance up to which g is positive; infinite if g can never reach zero. Each branch is
/// the form without cancellation for its sign of the slope.
pub fn safe_step(value: f64, slope: f64, bend: f64) -> f64 {
    let root = (slope * slope + 2.0 * bend * value).sqrt();
    if slope <= 0.0 {
        if value == 0.0 {
            0.0
        } else {
            2.0 * value / (root - slope)
        }
    } else {
        (root + slope) / bend
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dip_of_any_depth_is_found_or_passed_according_to_its_sign() {
        // g = 1 + lift - cos(3 (r - 40)) + 1e-3 (r - 40)^2 has its minimum, `lift`, at r = 40. For
        // small lift < 0 its two zeros are so close together that a search on a grid of any usual
        // spacing misses them.
        for (lift, found) in [(1e-13, false), (-1e-13, true), (1e-6, false), (-1e-6, true)] {
            let g = |r: f64| {
                [Jet {
                    value: 1.0 + lift - (3.0 * (r - 40.0)).cos() + 1e-3 * (r - 40.0).powi(2),
                    slope: 3.0 * (3.0 * (r - 40.0)).sin() + 2e-3 * (r - 40.0),
                    bend: 9.0 + 2e-3,
                    bend_growth: 0.0,
                    holds_for: f64::INFINITY,
                }]
            };
            let root = first_root(g, 0.0, 100.0, 1.0, &mut WorkLeft::new(10_000)).expect("bounded");
            assert_eq!(root.is_some(), found, "{lift}");
            if let Some((r, _)) = root {
                // The zero to the left of the minimum is where 4.5 u^2 = -lift.
                assert!(
                    (r - (40.0 - (-lift / 4.5).sqrt())).abs() < 1e-2 * (-lift / 4.5f64).sqrt(),
                    "{r}"
                );
            }
        }
    }

    #[test]
    fn simple_zeros_are_exact_to_rounding() {
        let cosine = |r: f64| {
            [Jet {
                value: r.cos(),
                slope: -r.sin(),
                bend: 1.0,
                bend_growth: 0.0,
                holds_for: f64::INFINITY,
            }]
        };
        let root = first_root(cosine, 0.0, 9.0, 1.0, &mut WorkLeft::new(100));
        let (root, _) = root.expect("bounded").expect("before the end");
        assert!(
            (root - std::f64::consts::FRAC_PI_2).abs() <= 4e-16,
            "{root}"
        );
    }
}
