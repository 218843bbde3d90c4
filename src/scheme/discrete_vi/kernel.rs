//! The step itself, many paths side by side: the hot loop.

use super::monitoring_shift;
use crate::lanes::{InstructionSet, LaneProgram, Lanes};
use crate::model::{Model, Temperature};
use crate::noise::{LaneStreams, Transition};

/// Steps between two looks at what happened: enough to keep the look cheap, few enough for the normals of a group to stay in
/// the first-level cache (64 steps of 32 lanes are 16 KiB).
pub(super) const RUN: usize = 64;

/// Lanes stepped together, so that one register's latency hides behind the others' work: four registers of eight lanes, eight of four.
const GROUP: usize = 32;

/// Lanes are padded to a multiple of the widest register.
const PADDING: usize = 8;

/// The numbers of the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficients {
    /// h
    pub h: f64,
    /// h/m
    pub h_over_m: f64,
    /// -K
    pub minus_stiffness: f64,
    /// -2 alpha
    pub minus_two_alpha: f64,
    /// K beta rho kick: the force per unit of v/kick
    pub noise_force: f64,
    /// e^{-theta h}
    pub decay: f64,
    /// (h/m) f_s
    pub static_impulse: f64,
    /// (h/m) f_d
    pub dynamic_impulse: f64,
    /// (h/m) f_s at zero velocity, lowered if the scheme is corrected
    pub exit_impulse: f64,
}

impl Coefficients {
    fn new(model: &Model, h: f64, is_corrected: bool, noise: &NoiseScale) -> Self {
        let Model { oscillator, friction, .. } = model;
        let exit_shift = if is_corrected { monitoring_shift(model, h) } else { 0.0 };
        Coefficients {
            h,
            h_over_m: h / oscillator.mass,
            minus_stiffness: -oscillator.stiffness,
            minus_two_alpha: -2.0 * oscillator.damping,
            noise_force: oscillator.stiffness * oscillator.dilatation * noise.temperature,
            decay: noise.decay,
            static_impulse: h / oscillator.mass * friction.static_force,
            dynamic_impulse: h / oscillator.mass * friction.dynamic_force,
            exit_impulse: h / oscillator.mass * (friction.static_force - exit_shift),
        }
    }

    /// b(X, V, t), rounded as the lanes round it; `forcing` is K beta times the harmonics at t.
    pub(super) fn force(&self, at: &Point, forcing: f64) -> f64 {
        let temperature_force = self.noise_force.mul_add(at.noise, forcing);
        let b = self.minus_stiffness.mul_add(at.displacement, temperature_force);
        self.minus_two_alpha.mul_add(at.velocity, b)
    }
}

/// The noise of a step in units of its own increment: v/kick obeys (v/kick)' = decay (v/kick) + xi, one operation fewer.
///
/// A step may be fed the noise of `refinement` shorter ones. Its increment is then theirs, joined, and kick is that of the shorter
/// step: v passes through the same values, whatever the refinement.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseScale {
    /// e^{-theta h}
    pub decay: f64,
    /// How many normals make the increment of a step.
    refinement: usize,
    /// e^{-theta h/refinement}
    shorter_decay: f64,
    /// kick, the sd of the increment of v in a step of h/refinement; 1 where nothing is added.
    pub kick: f64,
    /// rho kick: the temperature per unit of v/kick.
    pub temperature: f64,
    /// Whether the noise moves at random: rho and sigma above zero.
    pub draws: bool,
}

impl NoiseScale {
    pub(super) fn new(temperature: &Temperature, h: f64, refinement: usize) -> Self {
        let Some(noise) = temperature.noise else {
            return NoiseScale {
                decay: 0.0,
                refinement,
                shorter_decay: 0.0,
                kick: 1.0,
                temperature: 0.0,
                draws: false,
            };
        };
        let over = |h: f64| Transition::new(noise.relaxation_rate, noise.diffusion, h);
        let Transition { decay: shorter_decay, kick } = over(h / refinement as f64);
        let draws = kick > 0.0;
        let kick = if draws { kick * std::f64::consts::SQRT_2 } else { 1.0 };
        let temperature = noise.intensity * kick;
        NoiseScale { decay: over(h).decay, refinement, shorter_decay, kick, temperature, draws }
    }

    /// The increments of the next `steps` steps, in units of kick, for the lanes from `lane` on.
    #[inline(always)]
    fn fill<L: Lanes>(&self, streams: &mut LaneStreams, lane: usize, steps: usize, tile: &mut [f64], stride: usize) {
        match self.refinement {
            1 => streams.fill_normals::<L>(lane, steps, tile, stride),
            n => streams.fill_joined_normals::<L>(lane, steps, (n, self.shorter_decay), tile, stride),
        }
    }
}

/// Positions, velocities and noise of the paths; padded with lanes that nobody looks at.
#[derive(Clone, Debug)]
pub(super) struct Paths {
    pub displacement: Vec<f64>,
    pub velocity: Vec<f64>,
    /// v/kick
    pub noise: Vec<f64>,
}

impl Paths {
    /// Lanes for so many paths.
    pub(super) fn padded(paths: usize) -> usize {
        paths.next_multiple_of(PADDING)
    }

    /// All at x0 with zero velocity, and the given v(0)/kick.
    pub(super) fn at_rest(displacement: f64, noise: &[f64]) -> Self {
        Paths { displacement: vec![displacement; noise.len()], velocity: vec![0.0; noise.len()], noise: noise.to_vec() }
    }
}

/// X, V and v/kick of one path at one instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub displacement: f64,
    pub velocity: f64,
    pub noise: f64,
}

/// A step at which a velocity came to zero, left it, or changed sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    pub lane: usize,
    /// The step went from t_{start + step} to the next.
    pub step: usize,
    pub before: Point,
    pub after: Point,
}

/// The stepper for one scene, with what the scene does not have left out.
#[derive(Clone, Debug)]
pub(super) struct Kernel {
    pub coefficients: Coefficients,
    pub noise: NoiseScale,
    has_noise: bool,
    has_damping: bool,
    is_corrected: bool,
    instructions: InstructionSet,
}

impl Kernel {
    pub(super) fn new(
        model: &Model,
        h: f64,
        refinement: usize,
        is_corrected: bool,
        instructions: InstructionSet,
    ) -> Self {
        let noise = NoiseScale::new(&model.temperature, h, refinement);
        Kernel {
            coefficients: Coefficients::new(model, h, is_corrected, &noise),
            noise,
            has_noise: model.temperature.noise.is_some(),
            has_damping: model.oscillator.damping != 0.0,
            is_corrected,
            instructions,
        }
    }

    /// Step every path through `forcing.len() - 1` <= RUN steps; `forcing[n]` is K beta times the harmonics at the n-th
    /// instant. Leaves the turns in `scratch`, those of one lane in time order.
    pub(super) fn advance(&self, forcing: &[f64], streams: &mut LaneStreams, paths: &mut Paths, scratch: &mut Scratch) {
        scratch.turns.clear();
        match (self.has_noise, self.has_damping, self.is_corrected) {
            (false, false, false) => self.run::<false, false, false>(forcing, streams, paths, scratch),
            (false, false, true) => self.run::<false, false, true>(forcing, streams, paths, scratch),
            (false, true, false) => self.run::<false, true, false>(forcing, streams, paths, scratch),
            (false, true, true) => self.run::<false, true, true>(forcing, streams, paths, scratch),
            (true, false, false) => self.run::<true, false, false>(forcing, streams, paths, scratch),
            (true, false, true) => self.run::<true, false, true>(forcing, streams, paths, scratch),
            (true, true, false) => self.run::<true, true, false>(forcing, streams, paths, scratch),
            (true, true, true) => self.run::<true, true, true>(forcing, streams, paths, scratch),
        }
    }

    fn run<const NOISE: bool, const DAMPING: bool, const CORRECTED: bool>(
        &self,
        forcing: &[f64],
        streams: &mut LaneStreams,
        paths: &mut Paths,
        scratch: &mut Scratch,
    ) {
        let (c, scale) = (&self.coefficients, &self.noise);
        self.instructions.run(&mut Run::<NOISE, DAMPING, CORRECTED> { c, scale, forcing, streams, paths, scratch });
    }
}

/// Memory that one run leaves to the next.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    /// The normals of a group, `[step][lane]`; zeros if there is nothing to draw.
    tile: Vec<f64>,
    /// What turned.
    pub turns: Vec<Turn>,
}

impl Scratch {
    pub(super) fn new() -> Self {
        Scratch { tile: vec![0.0; RUN * GROUP], turns: Vec::new() }
    }
}

struct Run<'a, const NOISE: bool, const DAMPING: bool, const CORRECTED: bool> {
    c: &'a Coefficients,
    scale: &'a NoiseScale,
    forcing: &'a [f64],
    streams: &'a mut LaneStreams,
    paths: &'a mut Paths,
    scratch: &'a mut Scratch,
}

impl<const NOISE: bool, const DAMPING: bool, const CORRECTED: bool> LaneProgram for Run<'_, NOISE, DAMPING, CORRECTED> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        let lanes = self.paths.noise.len();
        let mut lane = 0;
        while lane < lanes {
            let left = lanes - lane;
            lane += match (L::WIDTH, left) {
                (8, GROUP..) => self.advance_group::<L, { GROUP / 8 }>(lane),
                (8, 16..) => self.advance_group::<L, 2>(lane),
                (8, _) => self.advance_group::<L, 1>(lane),
                (_, GROUP..) => self.advance_group::<L, { GROUP / 4 }>(lane),
                (_, 16..) => self.advance_group::<L, 4>(lane),
                (_, _) => self.advance_group::<L, 2>(lane),
            };
        }
    }
}

impl<const NOISE: bool, const DAMPING: bool, const CORRECTED: bool> Run<'_, NOISE, DAMPING, CORRECTED> {
    /// `R` registers of paths, beginning at `lane`, through the whole run. Returns how many lanes that are.
    #[inline(always)]
    fn advance_group<L: Lanes, const R: usize>(&mut self, lane: usize) -> usize {
        let steps = self.forcing.len() - 1;
        let stride = R * L::WIDTH;
        let Scratch { tile, turns } = &mut *self.scratch;
        if NOISE && self.scale.draws {
            for r in 0..R {
                self.scale.fill::<L>(self.streams, lane + r * L::WIDTH, steps, &mut tile[r * L::WIDTH..], stride);
            }
        }
        let at = |r: usize| lane + r * L::WIDTH;
        let c = Splat::<L>::new(self.c);
        let mut x: [L; R] = std::array::from_fn(|r| L::load(&self.paths.displacement[at(r)..]));
        let mut v: [L; R] = std::array::from_fn(|r| L::load(&self.paths.velocity[at(r)..]));
        let mut noise: [L; R] = std::array::from_fn(|r| L::load(&self.paths.noise[at(r)..]));
        let mut directions: [u32; R] = [0; R];
        for r in 0..R {
            directions[r] = join::<L>(v[r].gt(L::splat(0.0)), v[r].lt(L::splat(0.0)));
        }

        for (n, (&forcing, xi)) in self.forcing[..steps].iter().zip(tile.chunks_exact(stride)).enumerate() {
            for r in 0..R {
                let xi = L::load(&xi[r * L::WIDTH..]);
                let next = c.step::<NOISE, DAMPING, CORRECTED>(x[r], v[r], noise[r], L::splat(forcing), xi);
                let difference = directions[r] ^ next.directions;
                if difference != 0 {
                    let turned = (difference | difference >> L::WIDTH) & ((1 << L::WIDTH) - 1);
                    note(turns, at(r), n, turned, [x[r], v[r], noise[r]], [next.x, next.v, next.noise]);
                    directions[r] = next.directions;
                }
                (x[r], v[r], noise[r]) = (next.x, next.v, next.noise);
            }
        }
        for r in 0..R {
            x[r].store(&mut self.paths.displacement[at(r)..]);
            v[r].store(&mut self.paths.velocity[at(r)..]);
            noise[r].store(&mut self.paths.noise[at(r)..]);
        }
        stride
    }
}

/// The coefficients, one copy a lane, so that they stay in registers.
struct Splat<L> {
    h: L,
    h_over_m: L,
    minus_stiffness: L,
    minus_two_alpha: L,
    noise_force: L,
    decay: L,
    static_impulse: L,
    minus_static_impulse: L,
    dynamic_impulse: L,
    exit_impulse: L,
    minus_exit_impulse: L,
}

impl<L: Lanes> Splat<L> {
    #[inline(always)]
    fn new(c: &Coefficients) -> Self {
        Splat {
            h: L::splat(c.h),
            h_over_m: L::splat(c.h_over_m),
            minus_stiffness: L::splat(c.minus_stiffness),
            minus_two_alpha: L::splat(c.minus_two_alpha),
            noise_force: L::splat(c.noise_force),
            decay: L::splat(c.decay),
            static_impulse: L::splat(c.static_impulse),
            minus_static_impulse: L::splat(-c.static_impulse),
            dynamic_impulse: L::splat(c.dynamic_impulse),
            exit_impulse: L::splat(c.exit_impulse),
            minus_exit_impulse: L::splat(-c.exit_impulse),
        }
    }

    /// One step of the discrete variational inequality.
    #[inline(always)]
    fn step<const NOISE: bool, const DAMPING: bool, const CORRECTED: bool>(
        &self,
        x: L,
        v: L,
        noise: L,
        forcing: L,
        xi: L,
    ) -> Next<L> {
        // b = K (beta T - X) - 2 alpha V
        let mut b = forcing;
        if NOISE {
            b = self.noise_force.mul_add(noise, b);
        }
        b = self.minus_stiffness.mul_add(x, b);
        if DAMPING {
            b = self.minus_two_alpha.mul_add(v, b);
        }
        // S = V + (h/m) b
        let s = self.h_over_m.mul_add(b, v);
        // V' = 0 if |S| <= (h/m) f_s, else S - (h/m) f_d sign(S)
        let (mut most, mut least) = (self.static_impulse, self.minus_static_impulse);
        if CORRECTED {
            // f_s lowered in the test that leaves stick only
            most = v.where_zero(self.exit_impulse, most);
            least = v.where_zero(self.minus_exit_impulse, least);
        }
        let (up, down) = (s.gt(most), s.lt(least));
        let fd = self.dynamic_impulse;
        let next_v = L::either(up, s.sub(fd), down, s.add(fd));
        // X' = X + h V, corrected: X + h V'
        let next_x = self.h.mul_add(if CORRECTED { next_v } else { v }, x);
        // v' = e^{-theta h} v + kick xi
        let next_noise = if NOISE { self.decay.mul_add(noise, xi) } else { noise };
        Next { x: next_x, v: next_v, noise: next_noise, directions: join::<L>(up, down) }
    }
}

struct Next<L> {
    x: L,
    v: L,
    noise: L,
    directions: u32,
}

/// Which lanes move up, and above those bits, which move down.
#[inline(always)]
fn join<L: Lanes>(up: L::Mask, down: L::Mask) -> u32 {
    L::bitmask(up) | L::bitmask(down) << L::WIDTH
}

/// Keep the turned lanes of a step.
#[cold]
#[inline(always)]
fn note<L: Lanes>(turns: &mut Vec<Turn>, lane: usize, step: usize, turned: u32, before: [L; 3], after: [L; 3]) {
    let spill = |lanes: [L; 3]| {
        lanes.map(|lanes| {
            let mut values = [0.0; PADDING];
            lanes.store(&mut values);
            values
        })
    };
    keep(turns, lane, step, turned, &spill(before), &spill(after));
}

#[inline(never)]
fn keep(turns: &mut Vec<Turn>, lane: usize, step: usize, turned: u32, before: &Spilled, after: &Spilled) {
    let point = |[displacement, velocity, noise]: &Spilled, i: usize| Point {
        displacement: displacement[i],
        velocity: velocity[i],
        noise: noise[i],
    };
    for i in (0..PADDING).filter(|i| turned >> i & 1 == 1) {
        turns.push(Turn { lane: lane + i, step, before: point(before, i), after: point(after, i) });
    }
}

type Spilled = [[f64; PADDING]; 3];
