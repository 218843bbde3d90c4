//! The straightforward loop: one path after the other, with normals from the ziggurat of
//! rand_distr.

use crate::{BETA, F_D, F_S, H, RHO, Totals, W, X0};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use std::ops::Range;

/// Simulates a range of paths, each with a generator `R` that is seeded by its number.
pub fn paths<R: Rng + SeedableRng>(steps: usize, range: Range<usize>) -> Totals {
    let forcing: Vec<f64> = (0..=steps).map(|n| BETA * (W * H * n as f64).cos()).collect();
    let (decay, increment_sd) = ((-H).exp(), (-(-2.0 * H).exp_m1() / 2.0).sqrt());
    let mut total = Totals::default();
    for path in range {
        let mut rng = R::seed_from_u64(path as u64);
        let (mut x, mut v, mut e, mut b) = (X0, 0.0f64, 0.0, forcing[0] - X0);
        let (mut stuck, mut entry) = (b.abs() <= F_S, 0);
        for n in 0..steps {
            let s = v + H * b;
            let v_next = if s.abs() <= H * F_S { 0.0 } else { s - (H * F_D).copysign(s) };
            x += H * v;
            let xi: f64 = StandardNormal.sample(&mut rng);
            e = decay * e + increment_sd * xi;
            b = forcing[n + 1] + BETA * RHO * e - x;
            if stuck {
                if v_next != 0.0 {
                    stuck = false;
                    if entry > 0 {
                        total.sticks += 1.0;
                        total.stick_steps += (n - entry) as f64;
                    }
                }
            } else if v_next == 0.0 && b.abs() <= F_S {
                stuck = true;
                entry = n + 1;
            } else if v * v_next <= 0.0 && v != 0.0 {
                total.turns += 1.0;
            }
            v = v_next;
        }
        total.x += x;
        total.x2 += x * x;
    }
    total
}
