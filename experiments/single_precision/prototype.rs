//! The discrete scheme on plain arrays of `f32` or `f64`, which the compiler vectorises.

use crate::kicks::Kicks;
use std::ops::{Mul, Neg};
use stick_slip::lanes::{InstructionSet, LaneProgram, Lanes};
use stick_slip::model::{HarmonicClock, Model};
use stick_slip::noise::Transition;

/// The number of paths that are stepped together.
pub const LANES: usize = 32;
/// The number of steps for which forcing and noise are computed at once.
pub const RUN: usize = 64;

/// `f32` or `f64`.
pub trait Real: Copy + PartialOrd + Mul<Output = Self> + Neg<Output = Self> + From<i16> + Into<f64> {
    fn of(value: f64) -> Self;
    fn mul_add(self, factor: Self, term: Self) -> Self;
    fn next_up(self) -> Self;
}

macro_rules! real {
    ($f:ident) => {
        impl Real for $f {
            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $f
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                $f::mul_add(self, factor, term)
            }
            fn next_up(self) -> Self {
                $f::next_up(self)
            }
        }
    };
}
real!(f32);
real!(f64);

/// One number for each path, in whole cache lines.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct Row<F>(pub [F; LANES]);

/// The coefficients of the step, as in `docs/model.md`. The noise is in units of its increment,
/// v/kick.
struct Coefficients<F> {
    h: F,
    h_over_m: F,
    minus_stiffness: F,
    noise_force: F,
    decay: F,
    static_impulse: F,
    dynamic_impulse: F,
}

/// The state of `LANES` paths. While a velocity keeps its sign, V' = keep S + push, for S between
/// `least` and `most`.
#[repr(align(64))]
struct Paths<F> {
    x: [F; LANES],
    v: [F; LANES],
    noise: [F; LANES],
    keep: [F; LANES],
    push: [F; LANES],
    least: [F; LANES],
    most: [F; LANES],
    cascades: [Cascade; LANES],
}

/// The numbers that are computed from a path.
#[derive(Clone, Copy, Default)]
pub struct Cascade {
    /// The step at which the present stick began.
    stuck_since: Option<u64>,
    /// The completed sticks without the first, and the steps that they took.
    pub sticks: u64,
    pub stick_steps: u64,
    pub static_steps: u64,
    /// A hash of the steps at which sticks begin and end.
    pub signature: u64,
    pub x_end: f64,
}

impl Cascade {
    /// A stick begins or ends at step n.
    fn toggle(&mut self, n: u64) {
        self.signature = (self.signature ^ n).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
        self.stuck_since = match self.stuck_since {
            None => Some(n),
            Some(since) => {
                self.static_steps += n - since;
                if since > 0 {
                    self.sticks += 1;
                    self.stick_steps += n - since;
                }
                None
            }
        };
    }
}

impl<F: Real> Paths<F> {
    /// Paths that start at rest, in a stick.
    fn new(c: &Coefficients<F>, x: f64) -> Self {
        let (zero, fs) = ([F::of(0.0); LANES], c.static_impulse);
        let cascade = Cascade { stuck_since: Some(0), ..Cascade::default() };
        let (least, most) = ([-fs; LANES], [fs; LANES]);
        Paths {
            x: [F::of(x); LANES],
            v: zero,
            noise: zero,
            keep: zero,
            push: zero,
            least,
            most,
            cascades: [cascade; LANES],
        }
    }

    /// Lane i has left its bounds in step n. This sets its velocity by the general formula, its new
    /// bounds, and the counts that change.
    #[cold]
    #[inline(never)]
    fn turn(&mut self, c: &Coefficients<F>, i: usize, s: F, n: u64, next_forcing: F) {
        let (zero, one, fs, fd) = (F::of(0.0), F::of(1.0), c.static_impulse, c.dynamic_impulse);
        (self.keep[i], self.push[i], self.least[i], self.most[i]) = if s > fs {
            (one, -fd, fs.next_up(), F::of(f64::INFINITY))
        } else if s < -fs {
            (one, fd, F::of(f64::NEG_INFINITY), -fs.next_up())
        } else {
            (zero, zero, -fs, fs)
        };
        self.v[i] = self.keep[i].mul_add(s, self.push[i]);
        let impulse =
            c.h_over_m * c.minus_stiffness.mul_add(self.x[i], c.noise_force.mul_add(self.noise[i], next_forcing));
        let (is_zero, holds) = (self.v[i] == zero, -fs <= impulse && impulse <= fs);
        match self.cascades[i].stuck_since {
            Some(_) if !is_zero => self.cascades[i].toggle(n),
            None if is_zero && holds => self.cascades[i].toggle(n + 1),
            _ => {}
        }
    }
}

struct Run<'a, F, K> {
    c: &'a Coefficients<F>,
    n: u64,
    forcing: &'a [F],
    paths: &'a mut Paths<F>,
    kicks: &'a mut K,
}

impl<F: Real, K: Kicks<F>> LaneProgram for Run<'_, F, K> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let Run { c, forcing, paths, .. } = self;
        let mut tile = [Row([F::of(0.0); LANES]); RUN];
        self.kicks.fill(&mut tile);
        for (k, xi) in tile[..forcing.len() - 1].iter().enumerate() {
            let mut s = Row([F::of(0.0); LANES]);
            let mut left = false;
            for i in 0..LANES {
                let b = c.minus_stiffness.mul_add(paths.x[i], c.noise_force.mul_add(paths.noise[i], forcing[k]));
                s.0[i] = c.h_over_m.mul_add(b, paths.v[i]);
                left |= (s.0[i] < paths.least[i]) | (s.0[i] > paths.most[i]);
                paths.x[i] = c.h.mul_add(paths.v[i], paths.x[i]);
                paths.v[i] = paths.keep[i].mul_add(s.0[i], paths.push[i]);
                paths.noise[i] = c.decay.mul_add(paths.noise[i], xi.0[i]);
            }
            if left {
                let mut turned = 0u32;
                for i in 0..LANES {
                    turned |= u32::from(s.0[i] < paths.least[i] || s.0[i] > paths.most[i]) << i;
                }
                while turned != 0 {
                    let i = turned.trailing_zeros() as usize;
                    paths.turn(c, i, s.0[i], self.n + k as u64, forcing[k + 1]);
                    turned &= turned - 1;
                }
            }
        }
    }
}

/// Simulates `steps` steps of the paths 0 to `paths` - 1, where `paths` is a multiple of `LANES`.
pub fn simulate<F: Real, K: Kicks<F>>(model: &Model, h: f64, steps: u64, seed: u64, paths: u64) -> Vec<Cascade> {
    let (oscillator, noise) = (&model.oscillator, model.temperature.noise.expect("a noisy scene"));
    let Transition { decay, increment_sd: kick } = Transition::new(noise.relaxation_rate, noise.diffusion, h);
    let to_force = oscillator.stiffness * oscillator.dilatation;
    let c = Coefficients {
        h: F::of(h),
        h_over_m: F::of(h / oscillator.mass),
        minus_stiffness: F::of(-oscillator.stiffness),
        noise_force: F::of(to_force * noise.intensity * kick),
        decay: F::of(decay),
        static_impulse: F::of(h / oscillator.mass * model.friction.static_force),
        dynamic_impulse: F::of(h / oscillator.mass * model.friction.dynamic_force),
    };
    let clock = HarmonicClock::new(&model.temperature.harmonics, h);
    let numbers: Vec<u64> = (0..paths).collect();
    let mut groups: Vec<(Paths<F>, K)> =
        numbers.chunks(LANES).map(|p| (Paths::new(&c, model.initial_displacement), K::new(seed, p))).collect();
    let mut harmonics = [0.0; RUN + 1];
    for n in (0..steps).step_by(RUN) {
        let run = RUN.min((steps - n) as usize);
        clock.fill(n, &mut harmonics[..=run]);
        let forcing = harmonics.map(|harmonic| F::of(to_force * harmonic));
        for (paths, kicks) in &mut groups {
            InstructionSet::detect().run(&mut Run { c: &c, n, forcing: &forcing[..=run], paths, kicks });
        }
    }
    let ended = groups.into_iter().flat_map(|(paths, _)| {
        let cascade = move |i: usize| {
            let cascade = paths.cascades[i];
            let last = cascade.stuck_since.map_or(0, |since| steps - since);
            Cascade { static_steps: cascade.static_steps + last, x_end: paths.x[i].into(), ..cascade }
        };
        (0..LANES).map(cascade)
    });
    ended.collect()
}
