//! The step itself, for many paths in lanes: the hot loop.

mod forced;

use super::corrected_exit;
use crate::lanes::{InstructionSet, LaneProgram, Lanes};
use crate::model::{Force, Problem, Sign, Temperature};
use crate::noise::{LaneNormals, LaneStreams, Transition};
use std::f64::consts::SQRT_2;

/// Steps between two readings of the turns, enough to make reading cheap.
pub(super) const RUN: usize = 256;

/// Lanes that are stepped together, so that the latency of one register is hidden by the work on
/// the others: two registers of eight lanes, or four of four.
const GROUP: usize = 16;
/// Lanes that are stepped together without noise, in registers of eight lanes. A step then has less
/// work to hide the latency, and more registers are free.
const WIDE: usize = 32;

/// Lanes are padded to a multiple of the widest register.
const PADDING: usize = 8;

/// The coefficients of the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficients {
    /// h, the time step
    pub h: f64,
    /// h/m
    pub h_over_m: f64,
    /// -K
    pub minus_stiffness: f64,
    /// -2 alpha
    pub minus_two_alpha: f64,
    /// K beta rho unit: the force per unit of v/unit
    pub noise_force: f64,
    /// e^{-theta h}
    pub decay: f64,
    /// (h/m) f_s
    pub static_impulse: f64,
    /// (h/m) f_d
    pub dynamic_impulse: f64,
    /// (h/m) times the force that ends a stick: f_s, or less if the scheme is corrected
    pub exit_impulse: f64,
}

impl Coefficients {
    fn new(model: &Problem, h: f64, is_corrected: bool, noise: &NoiseScale) -> Self {
        let Problem {
            oscillator,
            friction,
            ..
        } = model;
        let exit_force = if is_corrected {
            corrected_exit(model, h)
        } else {
            friction.static_force
        };
        Coefficients {
            h,
            h_over_m: h / oscillator.mass,
            minus_stiffness: -oscillator.stiffness,
            minus_two_alpha: -2.0 * oscillator.damping,
            noise_force: oscillator.force_per_temperature() * noise.temperature,
            decay: noise.decay,
            static_impulse: h / oscillator.mass * friction.static_force,
            dynamic_impulse: h / oscillator.mass * friction.dynamic_force,
            exit_impulse: h / oscillator.mass * exit_force,
        }
    }
}

/// The noise v, measured in a unit of its own. The lanes draw normals divided by sqrt(2), chi =
/// xi/sqrt(2). With
///
/// ```text
/// unit = sqrt(2) increment_sd,    (v/unit)' = decay (v/unit) + chi
/// ```
///
/// a step of v/unit takes one operation fewer than a step of v.
///
/// A step may use the noise of `refinement` shorter steps. Its increment is then composed of
/// theirs, and the unit is that of the shorter step, so v takes the same values for every
/// refinement.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseScale {
    /// e^{-theta h}
    pub decay: f64,
    /// The number of normals in the increment of one step.
    refinement: usize,
    /// e^{-theta h/refinement}
    shorter_decay: f64,
    /// sqrt(2) times the standard deviation of the increment of v in a step of h/refinement; 1
    /// where this is zero.
    pub unit: f64,
    /// rho unit: the temperature per unit of v/unit.
    pub temperature: f64,
    /// Whether the noise is random: rho and sigma are above zero.
    pub draws: bool,
}

impl NoiseScale {
    pub(super) fn new(temperature: &Temperature, h: f64, refinement: usize) -> Self {
        let Some(noise) = temperature.effective_noise() else {
            return NoiseScale {
                decay: 0.0,
                refinement,
                shorter_decay: 0.0,
                unit: 1.0,
                temperature: 0.0,
                draws: false,
            };
        };
        let over = |h: f64| Transition::new(noise.relaxation_rate, noise.diffusion, h);
        let Transition {
            decay: shorter_decay,
            increment_sd,
        } = over(h / refinement as f64);
        let draws = increment_sd > 0.0;
        let unit = if draws { increment_sd * SQRT_2 } else { 1.0 };
        let temperature = noise.intensity * unit;
        NoiseScale {
            decay: over(h).decay,
            refinement,
            shorter_decay,
            unit,
            temperature,
            draws,
        }
    }

    /// Draws the next increment of v/unit.
    #[inline(always)]
    fn increment<L: Lanes, const R: usize>(&self, normals: &mut LaneNormals<L, R>) -> [L; R] {
        if !self.draws {
            return [L::splat(0.0); R];
        }
        let mut joined = normals.draw();
        for _ in 1..self.refinement {
            let chi = normals.draw();
            for r in 0..R {
                joined[r] = L::splat(self.shorter_decay).mul_add(joined[r], chi[r]);
            }
        }
        joined
    }
}

/// Displacements, velocities and noise of the paths. Unused lanes at the end fill the last
/// register.
#[derive(Clone, Debug)]
pub(super) struct Paths {
    pub displacement: Vec<f64>,
    pub velocity: Vec<f64>,
    /// v/unit
    pub noise: Vec<f64>,
}

impl Paths {
    /// The number of lanes for `paths` paths: whole registers.
    pub(super) fn padded(paths: usize) -> usize {
        paths.next_multiple_of(PADDING)
    }

    /// One path.
    pub(super) fn point(&self, lane: usize) -> State {
        State {
            x: self.displacement[lane],
            v: self.velocity[lane],
            noise: self.noise[lane],
        }
    }

    /// All paths at this x and x', and the given v(0)/unit.
    pub(super) fn at(displacement: f64, velocity: f64, noise: &[f64]) -> Self {
        let all = |value: f64| vec![value; noise.len()];
        Paths {
            displacement: all(displacement),
            velocity: all(velocity),
            noise: noise.to_vec(),
        }
    }
}

/// A step in which the velocity of a path becomes zero, leaves zero, or changes sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    pub lane: usize,
    /// The number of the step within the run.
    pub step: usize,
    pub before: State,
    pub after: State,
}

/// The kernel for one scene. Terms that the scene does not have are compiled out.
#[derive(Clone, Debug)]
pub(super) struct Kernel {
    pub coefficients: Coefficients,
    pub noise: NoiseScale,
    has_noise: bool,
    is_corrected: bool,
    /// g, unless it is a function of t alone, which is a part of the forcing.
    own: Option<Force>,
    instructions: InstructionSet,
}

impl Kernel {
    pub(super) fn new(
        model: &Problem,
        own: Option<Force>,
        h: f64,
        refinement: usize,
        is_corrected: bool,
        instructions: InstructionSet,
    ) -> Self {
        let noise = NoiseScale::new(&model.temperature, h, refinement);
        Kernel {
            coefficients: Coefficients::new(model, h, is_corrected, &noise),
            noise,
            has_noise: model.temperature.effective_noise().is_some(),
            is_corrected,
            own,
            instructions,
        }
    }

    /// b(X, V, t) without g, rounded as in the lanes; `forcing` is K beta times the harmonics at t.
    fn linear_force(&self, at: &State, forcing: f64) -> f64 {
        Splat::new(&self.coefficients).force::<true>(at, forcing)
    }

    /// g of these forces at t_n.
    fn user_force(&self, force: &Force, at: &State, n: u64) -> f64 {
        force.at(
            self.instructions,
            at.x,
            at.v,
            n as f64 * self.coefficients.h,
        )
    }

    /// b at rest with the forces that decide at the two thresholds, rounded as in the lanes.
    pub(super) fn pulls(&self, at: &State, forcing: f64, n: u64) -> [f64; 2] {
        let b = self.linear_force(at, forcing);
        self.own.as_ref().map_or([b; 2], |own| {
            own.in_stick()
                .map(|force| b + self.user_force(force, at, n))
        })
    }

    /// The direction in which friction lets these pulls go, up to an impulse. It is rounded as the
    /// step rounds it. Pulls that are not numbers are not held.
    pub(super) fn let_go(&self, [up, down]: [f64; 2], impulse: f64) -> Option<Sign> {
        let h_over_m = self.coefficients.h_over_m;
        if h_over_m * up <= impulse && h_over_m * down >= -impulse {
            return None;
        }
        Some(if h_over_m * down < -impulse {
            Sign::Negative
        } else {
            Sign::Positive
        })
    }

    /// Whether a body at rest in a stick moves in the next step. With a load, the corrected scheme lets
    /// go a body that friction in motion would still brake; it then stays.
    pub(super) fn leaves(&self, at: &State, forcing: f64, n: u64) -> bool {
        let Coefficients {
            h_over_m,
            exit_impulse,
            dynamic_impulse,
            ..
        } = self.coefficients;
        let pulls = self.pulls(at, forcing, n);
        let Some(own) = self.own.as_ref().filter(|own| own.sides().is_some()) else {
            return self.let_go(pulls, exit_impulse).is_some();
        };
        let b = self.linear_force(at, forcing);
        [Sign::Positive, Sign::Negative]
            .into_iter()
            .zip(pulls)
            .any(|(sign, pull)| {
                let drive = b + self.user_force(own.in_slip(sign), at, n);
                let [held, driven] = [pull, drive].map(|force| sign.value() * (h_over_m * force));
                // Forces that are not numbers hold nothing.
                let is_held = held <= exit_impulse || driven <= dynamic_impulse;
                !is_held
            })
    }

    /// b(X, V, t_n), rounded as in the lanes; `forcing` is K beta times the harmonics at t_n.
    pub(super) fn force(&self, at: &State, forcing: f64, n: u64) -> f64 {
        let b = self.linear_force(at, forcing);
        self.own
            .as_ref()
            .map_or(b, |own| b + self.user_force(own, at, n))
    }

    /// Takes every path through `forcing.len() - 1` <= RUN steps from t_n on, where `forcing[i]` is
    /// K beta times the harmonics at the i-th instant. Writes the turns of these steps to `turns`;
    /// those of one lane are in time order.
    pub(super) fn advance(
        &self,
        n: u64,
        forcing: &[f64],
        streams: &mut LaneStreams,
        paths: &mut Paths,
        turns: &mut Vec<Turn>,
    ) {
        turns.clear();
        let work = Work {
            n,
            forcing,
            streams,
            paths,
            turns,
        };
        match (self.own.is_some(), self.has_noise, self.is_corrected) {
            (false, false, false) => self.run::<false, false, false>(work),
            (false, false, true) => self.run::<false, false, true>(work),
            (false, true, false) => self.run::<false, true, false>(work),
            (false, true, true) => self.run::<false, true, true>(work),
            (true, false, false) => self.run::<true, false, false>(work),
            (true, false, true) => self.run::<true, false, true>(work),
            (true, true, false) => self.run::<true, true, false>(work),
            (true, true, true) => self.run::<true, true, true>(work),
        }
    }

    fn run<const OWN: bool, const NOISE: bool, const CORRECTED: bool>(&self, work: Work<'_>) {
        let mut run = LaneRun::<OWN, NOISE, CORRECTED> {
            kernel: self,
            c: &self.coefficients,
            scale: &self.noise,
            work,
        };
        self.instructions.run(&mut run);
    }
}

/// The steps to take, and the paths that take them.
struct Work<'a> {
    /// The number of the first step.
    n: u64,
    forcing: &'a [f64],
    streams: &'a mut LaneStreams,
    paths: &'a mut Paths,
    turns: &'a mut Vec<Turn>,
}

struct LaneRun<'a, const OWN: bool, const NOISE: bool, const CORRECTED: bool> {
    kernel: &'a Kernel,
    c: &'a Coefficients,
    scale: &'a NoiseScale,
    work: Work<'a>,
}

impl<const OWN: bool, const NOISE: bool, const CORRECTED: bool> LaneProgram
    for LaneRun<'_, OWN, NOISE, CORRECTED>
{
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        if OWN {
            return self.advance_forced::<L>();
        }
        let lanes = self.work.paths.noise.len();
        let mut lane = 0;
        while lane < lanes {
            lane += match (L::WIDTH, lanes - lane) {
                (8, WIDE..) if !NOISE => self.advance_group::<L, { WIDE / 8 }>(lane),
                (8, GROUP..) => self.advance_group::<L, { GROUP / 8 }>(lane),
                (8, _) => self.advance_group::<L, 1>(lane),
                (4, GROUP..) => self.advance_group::<L, { GROUP / 4 }>(lane),
                (4, _) => self.advance_group::<L, 2>(lane),
                (_, _) => self.advance_group::<L, 8>(lane),
            };
        }
    }
}

impl<const OWN: bool, const NOISE: bool, const CORRECTED: bool> LaneRun<'_, OWN, NOISE, CORRECTED> {
    /// Takes `R` registers of paths, beginning at `lane`, through the whole run. Returns the number
    /// of lanes.
    #[inline(always)]
    fn advance_group<L: Lanes, const R: usize>(&mut self, lane: usize) -> usize {
        let at = |r: usize| lane + r * L::WIDTH;
        let c = Splat::<L>::new(self.c);
        // These are plain loops, because closures would not be compiled for the instruction set.
        let mut state = [State::load::<NOISE>(self.work.paths, lane); R];
        for (r, state) in state.iter_mut().enumerate() {
            *state = State::load::<NOISE>(self.work.paths, at(r));
        }
        let mut regimes = [c.regime(state[0].v); R];
        for (regime, state) in regimes.iter_mut().zip(&state) {
            *regime = c.regime(state.v);
        }

        let mut normals = if NOISE {
            Some(self.work.streams.take::<L, R>(lane))
        } else {
            None
        };
        let every_lane = (1 << L::WIDTH) - 1;

        for (n, &forcing) in self.work.forcing[..self.work.forcing.len() - 1]
            .iter()
            .enumerate()
        {
            let chi = match &mut normals {
                Some(normals) => self.scale.increment(normals),
                None => [L::splat(0.0); R],
            };
            let forcing = L::splat(forcing);
            let mut s = [forcing; R];
            let mut same = L::always();
            for r in 0..R {
                s[r] = c.impulse(c.force::<NOISE>(&state[r], forcing), &state[r]);
                same = regimes[r].holds(s[r], same);
            }
            if L::bitmask(same) == every_lane {
                for r in 0..R {
                    let next_v = regimes[r].velocity(s[r]);
                    state[r] = c.next::<NOISE, CORRECTED>(&state[r], next_v, chi[r]);
                }
            } else {
                for r in 0..R {
                    let next_v = c.settle(s[r], c.beyond(s[r], state[r].v));
                    let turned = every_lane ^ L::bitmask(regimes[r].holds(s[r], L::always()));
                    if turned != 0 {
                        // The state is computed here a second time, so that both states are in
                        // registers only where there is a turn.
                        let next = c.next::<NOISE, CORRECTED>(&state[r], next_v, chi[r]);
                        note(self.work.turns, at(r), n, turned, &state[r], &next);
                        regimes[r] = c.regime(next_v);
                    }
                    state[r] = c.next::<NOISE, CORRECTED>(&state[r], next_v, chi[r]);
                }
            }
        }
        for (r, state) in state.iter().enumerate() {
            state.store::<NOISE>(self.work.paths, at(r));
        }
        if let Some(normals) = &normals {
            self.work.streams.put(lane, normals);
        }
        R * L::WIDTH
    }
}

/// X, V and v/unit of one path, or of the paths in a register, at one instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct State<L = f64> {
    pub x: L,
    pub v: L,
    pub noise: L,
}

impl<L: Lanes> State<L> {
    #[inline(always)]
    fn load<const NOISE: bool>(paths: &Paths, lane: usize) -> Self {
        State {
            x: L::load(&paths.displacement[lane..]),
            v: L::load(&paths.velocity[lane..]),
            noise: if NOISE {
                L::load(&paths.noise[lane..])
            } else {
                L::splat(0.0)
            },
        }
    }

    #[inline(always)]
    fn store<const NOISE: bool>(&self, paths: &mut Paths, lane: usize) {
        self.x.store(&mut paths.displacement[lane..]);
        self.v.store(&mut paths.velocity[lane..]);
        if NOISE {
            self.noise.store(&mut paths.noise[lane..]);
        }
    }

    #[inline(always)]
    fn spill(&self) -> Spilled {
        let mut spilled = Spilled([[0.0; PADDING]; 3]);
        self.x.store(&mut spilled.0[0]);
        self.v.store(&mut spilled.0[1]);
        self.noise.store(&mut spilled.0[2]);
        spilled
    }
}

/// The coefficients, one copy per lane, so that they stay in registers.
struct Splat<L> {
    h: L,
    h_over_m: L,
    minus_stiffness: L,
    minus_two_alpha: L,
    noise_force: L,
    decay: L,
    static_impulse: L,
    dynamic_impulse: L,
    exit_impulse: L,
    minus_static_impulse: L,
    minus_exit_impulse: L,
    /// The smallest impulse that does not stop the body.
    slip_impulse: L,
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
            dynamic_impulse: L::splat(c.dynamic_impulse),
            exit_impulse: L::splat(c.exit_impulse),
            minus_static_impulse: L::splat(-c.static_impulse),
            minus_exit_impulse: L::splat(-c.exit_impulse),
            slip_impulse: L::splat(c.static_impulse.next_up()),
        }
    }

    /// b = K (beta T - X) - 2 alpha V, without g.
    #[inline(always)]
    fn force<const NOISE: bool>(&self, at: &State<L>, forcing: L) -> L {
        let mut b = forcing;
        if NOISE {
            b = self.noise_force.mul_add(at.noise, b);
        }
        b = self.minus_stiffness.mul_add(at.x, b);
        self.minus_two_alpha.mul_add(at.v, b)
    }

    /// S = V + (h/m) b
    #[inline(always)]
    fn impulse(&self, b: L, at: &State<L>) -> L {
        self.h_over_m.mul_add(b, at.v)
    }

    /// Where S > (h/m) f_s, and where S < -(h/m) f_s. The corrected scheme lowers f_s, but only
    /// where the body is at rest.
    #[inline(always)]
    fn beyond(&self, s: L, v: L) -> (L::Mask, L::Mask) {
        let most = v.where_zero(self.exit_impulse, self.static_impulse);
        let least = v.where_zero(self.minus_exit_impulse, self.minus_static_impulse);
        (s.gt(most), s.lt(least))
    }

    /// The discrete variational inequality: V' = 0 if |S| <= (h/m) f_s, else S - (h/m) f_d sign(S).
    #[inline(always)]
    fn settle(&self, s: L, (up, down): (L::Mask, L::Mask)) -> L {
        let fd = self.dynamic_impulse;
        L::either(up, s.sub(fd), down, s.add(fd))
    }

    /// The step as it is for velocities that keep the sign of v; there it agrees with
    /// [`Splat::settle`].
    #[inline(always)]
    fn regime(&self, v: L) -> Regime<L> {
        let (zero, fd) = (L::splat(0.0), self.dynamic_impulse);
        let (up, down) = (v.gt(zero), v.lt(zero));
        Regime {
            moves: L::or(up, down),
            push: L::either(up, zero.sub(fd), down, fd),
            least: v.where_zero(
                self.minus_exit_impulse,
                L::either(up, self.slip_impulse, down, L::splat(f64::NEG_INFINITY)),
            ),
            most: v.where_zero(
                self.exit_impulse,
                L::either(
                    up,
                    L::splat(f64::INFINITY),
                    down,
                    zero.sub(self.slip_impulse),
                ),
            ),
        }
    }

    /// The state at the next instant, where V is V'.
    #[inline(always)]
    fn next<const NOISE: bool, const CORRECTED: bool>(
        &self,
        at: &State<L>,
        next_v: L,
        chi: L,
    ) -> State<L> {
        State {
            // X' = X + h V, corrected: X + h V'
            x: self.h.mul_add(if CORRECTED { next_v } else { at.v }, at.x),
            v: next_v,
            // (v/unit)' = e^{-theta h} (v/unit) + chi
            noise: if NOISE {
                self.decay.mul_add(at.noise, chi)
            } else {
                at.noise
            },
        }
    }
}

/// The step while each lane keeps sliding up, sliding down or sticking: V' = S + push in the lanes
/// that move, and 0 in the others, as long as S lies between `least` and `most`.
#[derive(Clone, Copy)]
struct Regime<L: Lanes> {
    moves: L::Mask,
    push: L,
    least: L,
    most: L,
}

impl<L: Lanes> Regime<L> {
    /// The lanes of `among` whose regime does not change.
    #[inline(always)]
    fn holds(&self, s: L, among: L::Mask) -> L::Mask {
        s.not_beyond(self.least, self.most, among)
    }

    #[inline(always)]
    fn velocity(&self, s: L) -> L {
        s.add_where(self.push, self.moves)
    }
}

/// Records the lanes that turned in a step.
#[inline(always)]
fn note<L: Lanes>(
    turns: &mut Vec<Turn>,
    lane: usize,
    step: usize,
    turned: u32,
    before: &State<L>,
    after: &State<L>,
) {
    keep(turns, lane, step, turned, &before.spill(), &after.spill());
}

#[cold]
#[inline(never)]
fn keep(
    turns: &mut Vec<Turn>,
    lane: usize,
    step: usize,
    mut turned: u32,
    before: &Spilled,
    after: &Spilled,
) {
    let point = |Spilled([x, v, noise]): &Spilled, i: usize| State {
        x: x[i],
        v: v[i],
        noise: noise[i],
    };
    while turned != 0 {
        let i = turned.trailing_zeros() as usize;
        turns.push(Turn {
            lane: lane + i,
            step,
            before: point(before, i),
            after: point(after, i),
        });
        turned &= turned - 1;
    }
}

/// The state of a register in memory. Its alignment makes the compiler align the stack of the loop,
/// so that the registers that are spilled there do not lie across two cache lines.
#[repr(align(64))]
struct Spilled([[f64; PADDING]; 3]);
