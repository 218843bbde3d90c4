//! The discrete scheme in the form that an engine without damping and corrections would have, with
//! noise and without it. It steps as the kernel does: groups of 16 lanes (32 without noise) through
//! runs of 256 steps. It computes the forcing and checks for divergence as often as the kernel, and
//! counts the ends of sticks.

use std::hint::black_box;
use stickslip::lanes::{InstructionSet, LaneProgram, Lanes};
use stickslip::model::HarmonicClock;
use stickslip::noise::{LaneStreams, Transition};

/// The first lane of each register in which some path turned, and the velocities of its lanes.
type Turns = Vec<(usize, [f64; 8])>;

const LANES: usize = 256;
const RUN: usize = 256;
/// Beyond this displacement a path is lost.
const BOUND: f64 = 1e3;

/// The parameters of the step, with the names that [`stickslip::model::Problem`] has.
#[derive(Clone, Copy)]
pub struct Scene {
    pub h: f64,
    pub mass: f64,
    pub stiffness: f64,
    pub static_force: f64,
    pub dynamic_force: f64,
    /// K beta.
    pub forcing: f64,
    /// K beta rho, theta, sigma.
    pub noise: Option<(f64, f64, f64)>,
}

/// The state of 256 paths.
struct Stripped<'a> {
    scene: Scene,
    clock: &'a HarmonicClock,
    steps: usize,
    /// K beta times the harmonics, at the instants of a run.
    forcing: [f64; RUN + 1],
    streams: Option<LaneStreams>,
    x: Vec<f64>,
    v: Vec<f64>,
    noise: Vec<f64>,
    is_static: Vec<bool>,
    turns: Turns,
    /// The number of sticks that have ended.
    sticks: u64,
    is_lost: bool,
}

/// Counts the sticks that end in `steps` steps of 256 paths that start at rest with a relaxed
/// spring. T is that of the clock, plus the noise. None if a path is lost.
pub fn count_sticks(
    set: InstructionSet,
    scene: Scene,
    clock: &HarmonicClock,
    steps: usize,
) -> Option<u64> {
    let mut start = [0.0];
    clock.fill(0, &mut start);
    let paths: Vec<u64> = (0..LANES as u64).collect();
    let mut all = Stripped {
        scene,
        clock,
        steps,
        forcing: [0.0; RUN + 1],
        streams: scene.noise.map(|_| LaneStreams::new(1, &paths, LANES)),
        x: vec![start[0] * scene.forcing / scene.stiffness; LANES],
        v: vec![0.0; LANES],
        noise: vec![0.0; LANES],
        is_static: vec![true; LANES],
        turns: Vec::new(),
        sticks: 0,
        is_lost: false,
    };
    set.run(&mut all);
    (!all.is_lost).then_some(all.sticks)
}

impl LaneProgram for Stripped<'_> {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        assert_eq!(L::WIDTH, 8, "written for AVX-512");
        for n in (0..self.steps).step_by(RUN) {
            let steps = RUN.min(self.steps - n);
            self.clock.fill(n as u64, &mut self.forcing[..=steps]);
            for forcing in &mut self.forcing[..=steps] {
                *forcing *= self.scene.forcing;
            }
            if self.streams.is_some() {
                for lane in (0..LANES).step_by(2 * L::WIDTH) {
                    self.noisy::<L, 2>(lane, steps);
                }
            } else {
                for lane in (0..LANES).step_by(4 * L::WIDTH) {
                    self.plain::<L, 4>(lane, steps);
                }
            }
            self.read();
            self.is_lost |= !self.x.iter().fold(true, |all, x| all & (x.abs() <= BOUND));
        }
    }
}

/// The step as long as nothing turns: V' = S + push in the lanes that move, 0 in the others, valid
/// while S is between `least` and `most`.
#[derive(Clone, Copy)]
struct Regime<L: Lanes> {
    moves: L::Mask,
    push: L,
    least: L,
    most: L,
}

#[inline(always)]
fn regime<L: Lanes>(v: L, fs: f64, fd: L) -> Regime<L> {
    let zero = L::splat(0.0);
    let (up, down) = (v.gt(zero), v.lt(zero));
    Regime {
        moves: L::or(up, down),
        push: L::either(up, zero.sub(fd), down, fd),
        least: v.where_zero(
            L::splat(-fs),
            L::either(
                up,
                L::splat(fs.next_up()),
                down,
                L::splat(f64::NEG_INFINITY),
            ),
        ),
        most: v.where_zero(
            L::splat(fs),
            L::either(up, L::splat(f64::INFINITY), down, L::splat(-fs.next_up())),
        ),
    }
}

#[inline(always)]
fn settle<L: Lanes>(s: L, fs: f64, fd: L) -> L {
    L::either(
        s.gt(L::splat(fs)),
        s.sub(fd),
        s.lt(L::splat(-fs)),
        s.add(fd),
    )
}

/// V' of a register of which some lane of the group turns. If some lane of this register does, its
/// velocities are kept in `turns`.
#[inline(always)]
fn turn<L: Lanes>(
    s: L,
    v: L,
    now: &mut Regime<L>,
    (fs, fd): (f64, L),
    turns: &mut Turns,
    lane: usize,
) -> L {
    let next = settle(s, fs, fd);
    let turned = 255 ^ L::bitmask(s.not_beyond(now.least, now.most, L::always()));
    if turned != 0 {
        keep(turns, lane, turned, &spill(v), &spill(next));
        *now = regime(next, fs, fd);
    }
    next
}

impl Stripped<'_> {
    #[inline(always)]
    fn noisy<L: Lanes, const R: usize>(&mut self, lane: usize, steps: usize) {
        let Scene {
            h,
            mass,
            stiffness,
            static_force,
            dynamic_force,
            noise,
            ..
        } = self.scene;
        let (Some((force, theta, sigma)), Some(streams)) = (noise, &mut self.streams) else {
            return;
        };
        let Transition {
            decay,
            increment_sd,
        } = Transition::new(theta, sigma, h);
        let (decay, noise_force) = (
            L::splat(decay),
            L::splat(force * increment_sd * std::f64::consts::SQRT_2),
        );
        let (fs, fd) = (h / mass * static_force, L::splat(h / mass * dynamic_force));
        let (h_over_m, h, minus_stiffness) =
            (L::splat(h / mass), L::splat(h), L::splat(-stiffness));
        let (mut x, mut v, mut noise) = ([h; R], [h; R], [h; R]);
        let mut regimes = [regime(h, fs, fd); R];
        for r in 0..R {
            let at = lane + r * L::WIDTH;
            (x[r], v[r], noise[r]) = (
                L::load(&self.x[at..]),
                L::load(&self.v[at..]),
                L::load(&self.noise[at..]),
            );
            regimes[r] = regime(v[r], fs, fd);
        }
        let mut normals = streams.take::<L, R>(lane);
        for &forcing in &self.forcing[..steps] {
            let xi = normals.draw();
            let mut s = [h; R];
            let mut same = L::always();
            for r in 0..R {
                let b =
                    minus_stiffness.mul_add(x[r], noise_force.mul_add(noise[r], L::splat(forcing)));
                s[r] = h_over_m.mul_add(b, v[r]);
                same = s[r].not_beyond(regimes[r].least, regimes[r].most, same);
            }
            let all = L::bitmask(same) == 255;
            for r in 0..R {
                let next = if all {
                    s[r].add_where(regimes[r].push, regimes[r].moves)
                } else {
                    turn(
                        s[r],
                        v[r],
                        &mut regimes[r],
                        (fs, fd),
                        &mut self.turns,
                        lane + r * L::WIDTH,
                    )
                };
                x[r] = h.mul_add(v[r], x[r]);
                v[r] = next;
                noise[r] = decay.mul_add(noise[r], xi[r]);
            }
        }
        streams.put(lane, &normals);
        for r in 0..R {
            let at = lane + r * L::WIDTH;
            x[r].store(&mut self.x[at..]);
            v[r].store(&mut self.v[at..]);
            noise[r].store(&mut self.noise[at..]);
        }
    }

    #[inline(always)]
    fn plain<L: Lanes, const R: usize>(&mut self, lane: usize, steps: usize) {
        let Scene {
            h,
            mass,
            stiffness,
            static_force,
            dynamic_force,
            ..
        } = self.scene;
        let (fs, fd) = (h / mass * static_force, L::splat(h / mass * dynamic_force));
        let (h_over_m, h, minus_stiffness) =
            (L::splat(h / mass), L::splat(h), L::splat(-stiffness));
        let (mut x, mut v) = ([h; R], [h; R]);
        let mut regimes = [regime(h, fs, fd); R];
        for r in 0..R {
            let at = lane + r * L::WIDTH;
            (x[r], v[r]) = (L::load(&self.x[at..]), L::load(&self.v[at..]));
            regimes[r] = regime(v[r], fs, fd);
        }
        for &forcing in &self.forcing[..steps] {
            let mut s = [h; R];
            let mut same = L::always();
            for r in 0..R {
                s[r] = h_over_m.mul_add(minus_stiffness.mul_add(x[r], L::splat(forcing)), v[r]);
                same = s[r].not_beyond(regimes[r].least, regimes[r].most, same);
            }
            let all = L::bitmask(same) == 255;
            for r in 0..R {
                let next = if all {
                    s[r].add_where(regimes[r].push, regimes[r].moves)
                } else {
                    turn(
                        s[r],
                        v[r],
                        &mut regimes[r],
                        (fs, fd),
                        &mut self.turns,
                        lane + r * L::WIDTH,
                    )
                };
                x[r] = h.mul_add(v[r], x[r]);
                v[r] = next;
            }
        }
        for r in 0..R {
            let at = lane + r * L::WIDTH;
            x[r].store(&mut self.x[at..]);
            v[r].store(&mut self.v[at..]);
        }
    }

    /// Counts the sticks that end: where a velocity leaves zero. Every zero counts as a stick.
    fn read(&mut self) {
        for (lane, velocities) in self.turns.drain(..) {
            for (is_static, v) in self.is_static[lane..].iter_mut().zip(velocities) {
                self.sticks += u64::from(*is_static && v != 0.0);
                *is_static = v == 0.0;
            }
        }
    }
}

#[repr(align(64))]
struct Spilled([f64; 8]);

#[inline(always)]
fn spill<L: Lanes>(v: L) -> Spilled {
    let mut spilled = Spilled([0.0; 8]);
    v.store(&mut spilled.0);
    spilled
}

#[cold]
#[inline(never)]
fn keep(turns: &mut Turns, lane: usize, turned: u32, before: &Spilled, after: &Spilled) {
    black_box((turned, before));
    turns.push((lane, after.0));
}
