//! The crate differential-equations: the scheme is a drift for its Euler method, and the counters
//! are further components.
//!
//! As with diffrax, the change by the scheme in a step is divided by h first, the noise is Euler's,
//! and a stick is entered where |b_n| instead of |b_{n+1}| is within f_s, because the drift does
//! not know the end of its own step.

use differential_equations::prelude::*;
use nalgebra::SVector;
use peers::{BETA, F_D, F_S, H, RHO, Totals, W, X0};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// (x, v, e, stuck, entry, sticks, stick time, turns).
type State = SVector<f64, 8>;

/// The source of the noise. The solver holds the state.
struct Oscillator(Xoshiro256PlusPlus);

impl SDE<f64, State> for Oscillator {
    fn drift(&self, t: f64, y: &State, dy: &mut State) {
        let (x, v, e, stuck, entry) = (y[0], y[1], y[2], y[3] > 0.5, y[4]);
        let b = BETA * ((W * t).cos() + RHO * e) - x;
        let s = v + H * b;
        let v_next = if s.abs() <= H * F_S { 0.0 } else { s - (H * F_D).copysign(s) };
        *dy = State::zeros();
        (dy[0], dy[1], dy[2]) = (v, (v_next - v) / H, -e);
        if stuck {
            if v_next != 0.0 {
                dy[3] = -y[3] / H;
                if entry > H / 2.0 {
                    (dy[5], dy[6]) = (1.0 / H, (t - entry) / H);
                }
            }
        } else if v_next == 0.0 && b.abs() <= F_S {
            (dy[3], dy[4]) = ((1.0 - y[3]) / H, (t + H - entry) / H);
        } else if v * v_next <= 0.0 && v.abs() > 1e-12 {
            // v + h (0 - v)/h is zero only up to rounding.
            dy[7] = 1.0 / H;
        }
    }

    fn diffusion(&self, _t: f64, _y: &State, dy: &mut State) {
        *dy = State::zeros();
        dy[2] = 1.0;
    }

    fn noise(&mut self, dt: f64, dw: &mut State) {
        *dw = State::zeros();
        let xi: f64 = StandardNormal.sample(&mut self.0);
        dw[2] = dt.sqrt() * xi;
    }
}

fn main() {
    peers::measure(|steps, range| {
        let end = steps as f64 * H;
        let mut total = Totals::default();
        for path in range {
            let mut oscillator = Oscillator(Xoshiro256PlusPlus::seed_from_u64(path as u64));
            let mut start = State::zeros();
            (start[0], start[3]) = (X0, 1.0);
            let euler = ExplicitRungeKutta::euler(H).max_steps(steps + 100);
            let solution = IVP::sde(&mut oscillator, 0.0, end, start).t_eval([end]).method(euler).solve().expect("a solution");
            let y = solution.y.last().expect("a state at the end");
            total.x += y[0];
            total.x2 += y[0] * y[0];
            total.sticks += y[5].round();
            total.stick_steps += y[6] / H;
            total.turns += y[7].round();
        }
        total
    });
}
