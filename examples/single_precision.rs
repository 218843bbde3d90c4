//! What single precision and cheaper normals would gain the discrete scheme, and what they would do to its numbers.
//!
//!     cargo run --release --example single_precision
//!
//! A prototype steps `scenarios/rho025.toml` on plain arrays of `f32` or `f64`, from which the compiler makes registers. It prints ns a
//! path-step beside the crate's kernel; then what changes if both precisions are given the same normals, path by path; then what other
//! normals change. Half a minute.

use std::array::from_fn;
use std::error::Error;
use std::hint::black_box;
use std::ops::{Mul, Neg};
use std::sync::LazyLock;
use std::time::Instant as Clock;
use stick_slip::config::Override;
use stick_slip::lanes::{InstructionSet, LaneProgram, Lanes};
use stick_slip::model::{Event, HarmonicClock, Model};
use stick_slip::noise::{LaneStreams, Stream, Transition, standard_normal};
use stick_slip::scenario::Scenario;
use stick_slip::scheme::{DiscreteSimulation, Instant, Observer, Simulate as _, Snapshot};

const LANES: usize = 32;
const RUN: usize = 64;

/// `f32` or `f64`.
trait Real: Copy + PartialOrd + Mul<Output = Self> + Neg<Output = Self> + From<i16> + Into<f64> {
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

/// One number a path, in whole cache lines.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Row<F>([F; LANES]);

/// Where the numbers xi of mean 0 and variance 1 come from, for `RUN` steps at a time.
trait Kicks<F> {
    fn new(seed: u64, paths: &[u64]) -> Self;
    fn fill(&mut self, tile: &mut [Row<F>; RUN]);
}

/// The normals of the crate, exact to 4e-9.
struct Own(LaneStreams);

impl<F: Real> Kicks<F> for Own {
    fn new(seed: u64, paths: &[u64]) -> Self {
        Own(LaneStreams::new(seed, paths, LANES))
    }
    #[inline(always)]
    fn fill(&mut self, tile: &mut [Row<F>; RUN]) {
        let normals = self.0.normals(RUN, InstructionSet::detect());
        for (row, normals) in tile.iter_mut().zip(normals.chunks_exact(LANES)) {
            for (xi, normal) in row.0.iter_mut().zip(normals) {
                *xi = F::of(*normal);
            }
        }
    }
}

/// xoshiro128+, one a lane.
#[repr(align(64))]
struct Words([[u32; LANES]; 4]);

impl Words {
    fn new(seed: u64, paths: &[u64]) -> Self {
        let states: [_; LANES] = from_fn(|i| Stream::new(seed, paths[i]).state());
        Words(from_fn(|word| from_fn(|i| (states[i][word] >> 32) as u32)))
    }
    #[inline(always)]
    fn next(&mut self) -> [u32; LANES] {
        let mut drawn = [0; LANES];
        let [a, b, c, d] = &mut self.0;
        for i in 0..LANES {
            drawn[i] = a[i].wrapping_add(d[i]);
            let t = b[i] << 9;
            let d_b = d[i] ^ b[i];
            let c_a = c[i] ^ a[i];
            b[i] ^= c_a;
            a[i] ^= d_b;
            c[i] = c_a ^ t;
            d[i] = d_b.rotate_left(11);
        }
        drawn
    }
}

/// Normals by inversion in single precision: [`standard_normal`] as lines on 64 cells an octave; 32 bits, out to 6.2 sigma.
struct Inverse(Words);

/// Middle and slope of each cell, numbered by the exponent and upper mantissa bits of y as an `f32`, 1 <= y <= 2^31.
static LINES: LazyLock<[[f32; 2048]; 2]> = LazyLock::new(|| {
    let mut lines = [[0.0; 2048]; 2];
    for upper in 127u32 << 6..158 << 6 {
        let y = |upper: u32| f64::from(f32::from_bits(upper << 17));
        let z = |y: f64| standard_normal(((y * 4_294_967_296.0) as u64).min(i64::MAX as u64));
        let (near, far) = (z(y(upper + 1)), z(y(upper)));
        let middle = z(0.5 * (y(upper) + y(upper + 1)));
        lines[0][upper as usize % 2048] = (0.5 * middle + 0.25 * (near + far)) as f32;
        lines[1][upper as usize % 2048] = (near - far) as f32;
    }
    lines
});

impl Kicks<f32> for Inverse {
    fn new(seed: u64, paths: &[u64]) -> Self {
        Inverse(Words::new(seed, paths))
    }
    #[inline(always)]
    fn fill(&mut self, tile: &mut [Row<f32>; RUN]) {
        let [level, slope] = &*LINES;
        for row in tile {
            for (xi, drawn) in row.0.iter_mut().zip(self.0.next()) {
                let y = (drawn as i32 as f32).to_bits();
                let cell = (y >> 17) as usize % 2048;
                let place = f32::from_bits(y & 0x1_ffff | 64f32.to_bits()) - 64.5;
                let z = slope[cell].mul_add(place, level[cell]);
                *xi = f32::from_bits(z.to_bits() ^ y & 1 << 31);
            }
        }
    }
}

/// Sums of four bytes: three moments of a normal, excess kurtosis -0.3, nothing beyond 3.5 sigma.
struct Bytes(Words);

impl<F: Real> Kicks<F> for Bytes {
    fn new(seed: u64, paths: &[u64]) -> Self {
        Bytes(Words::new(seed, paths))
    }
    #[inline(always)]
    fn fill(&mut self, tile: &mut [Row<F>; RUN]) {
        let per_sd = F::of(1.0 / (4.0 * 65535.0 / 12.0f64).sqrt());
        for row in tile {
            for (xi, drawn) in row.0.iter_mut().zip(self.0.next()) {
                let pairs = (drawn & 0x00ff_00ff) + (drawn >> 8 & 0x00ff_00ff);
                *xi = F::from(((pairs & 0xffff) + (pairs >> 16)) as i16 - 510) * per_sd;
            }
        }
    }
}

/// The numbers of the step, as in `docs/model.md`; noise is v/kick.
struct Coefficients<F> {
    h: F,
    h_over_m: F,
    minus_stiffness: F,
    noise_force: F,
    decay: F,
    static_impulse: F,
    dynamic_impulse: F,
}

/// `LANES` paths. While a velocity keeps its sign, V' = keep S + push, S from `least` to `most`.
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

/// What is read off a path.
#[derive(Clone, Copy, Default)]
struct Cascade {
    /// The step at which the present stick began.
    stuck_since: Option<u64>,
    /// Completed sticks but the first, and the steps they took.
    sticks: u64,
    stick_steps: u64,
    static_steps: u64,
    /// A hash of the steps at which sticks begin and end.
    signature: u64,
    x_end: f64,
}

impl Cascade {
    /// Stick begins, or ends.
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
    /// At rest, in stick.
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

    /// Lane i has left its bounds in step n: its velocity in the general form, its new bounds, and what that means.
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

/// So many steps of the paths 0 to `paths` - 1, a multiple of `LANES`.
fn simulate<F: Real, K: Kicks<F>>(model: &Model, h: f64, steps: u64, seed: u64, paths: u64) -> Vec<Cascade> {
    let (oscillator, noise) = (&model.oscillator, model.temperature.noise.expect("a noisy scene"));
    let Transition { decay, kick } = Transition::new(noise.relaxation_rate, noise.diffusion, h);
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

/// An estimate, and what each path adds to it to first order.
struct Estimate {
    name: &'static str,
    value: f64,
    parts: Vec<f64>,
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Of a mean over paths.
fn standard_error(parts: &[f64]) -> f64 {
    let centre = mean(parts);
    let squares: Vec<f64> = parts.iter().map(|part| (part - centre).powi(2)).collect();
    (mean(&squares) / (parts.len() - 1) as f64).sqrt()
}

fn estimates(h: f64, end: f64, paths: &[Cascade]) -> [Estimate; 4] {
    let each = |read: &dyn Fn(&Cascade) -> f64| -> Vec<f64> { paths.iter().map(read).collect() };
    let (sticks, times) = (each(&|c| c.sticks as f64), each(&|c| c.stick_steps as f64 * h));
    let sticks_mean = mean(&sticks);
    let duration = mean(&times) / sticks_mean;
    let durations = times.iter().zip(&sticks).map(|(time, n)| (time - duration * n) / sticks_mean).collect();
    let shares = each(&|c| c.static_steps as f64 * h / end);
    let x_mean = mean(&each(&|c| c.x_end));
    let squares = each(&|c| (c.x_end - x_mean).powi(2));
    let sd = mean(&squares).sqrt();
    [
        Estimate { name: "stick_duration_mean", value: duration, parts: durations },
        Estimate { name: "sticks_per_path", value: sticks_mean, parts: sticks },
        Estimate { name: "sticking_fraction", value: mean(&shares), parts: shares },
        Estimate { name: "displacement_end_sd", value: sd, parts: squares.iter().map(|s| s / (2.0 * sd)).collect() },
    ]
}

/// Hears nothing: what the kernel costs alone.
struct Deaf;

impl Observer for Deaf {
    fn event(&mut self, lane: usize, event: Event) {
        black_box((lane, event));
    }
    fn snapshot(&mut self, _: Instant, snapshot: Snapshot<'_>) {
        black_box(snapshot.displacement);
    }
}

/// ns a path-step, the least of 40 rounds in which the programs take turns.
fn time(h: f64) -> Result<(), Box<dyn Error>> {
    const PATHS: u64 = 256;
    const STEPS: u64 = 12_000;
    let set = [Override::set(&format!("time.step={h}"))?, Override::set(&format!("time.end={}", h * STEPS as f64))?];
    let scenario = Scenario::read("scenarios/rho025.toml".as_ref(), &set)?;
    let (model, paths) = (&scenario.model, (0..PATHS).collect::<Vec<u64>>());
    let kernel = DiscreteSimulation::new(model, &scenario.timeline(), h);
    let programs: [(&str, &dyn Fn()); 6] = [
        ("kernel", &|| drop(black_box(kernel.simulate(1, &paths, &mut Deaf)))),
        ("f64, its normals", &|| drop(black_box(simulate::<f64, Own>(model, h, STEPS, 1, PATHS)))),
        ("f64, four bytes", &|| drop(black_box(simulate::<f64, Bytes>(model, h, STEPS, 1, PATHS)))),
        ("f32, its normals", &|| drop(black_box(simulate::<f32, Own>(model, h, STEPS, 1, PATHS)))),
        ("f32, inversion", &|| drop(black_box(simulate::<f32, Inverse>(model, h, STEPS, 1, PATHS)))),
        ("f32, four bytes", &|| drop(black_box(simulate::<f32, Bytes>(model, h, STEPS, 1, PATHS)))),
    ];
    let mut least = [f64::INFINITY; 6];
    for _ in 0..40 {
        for (least, (_, program)) in least.iter_mut().zip(&programs) {
            let start = Clock::now();
            program();
            *least = least.min(start.elapsed().as_secs_f64() * 1e9 / (PATHS * STEPS) as f64);
        }
    }
    println!("h = {h}");
    for (ns, (name, _)) in least.iter().zip(&programs) {
        println!("  {name:20} {ns:6.3} ns   kernel / this {:5.2}", least[0] / ns);
    }
    Ok(())
}

/// Both precisions on the same normals.
fn compare_precision(model: &Model, h: f64, end: f64, paths: u64) {
    let steps = (end / h).round() as u64;
    let double = simulate::<f64, Own>(model, h, steps, 1, paths);
    let single = simulate::<f32, Own>(model, h, steps, 1, paths);
    let differing = |read: fn(&Cascade) -> u64| double.iter().zip(&single).filter(|(d, s)| read(d) != read(s)).count();
    let (cascades, counts) = (differing(|c| c.signature), differing(|c| c.sticks));
    println!(
        "h = {h}, t_end = {end}, {paths} paths: {cascades} cascades differ, {counts} in the number of their sticks"
    );
    for (d, s) in estimates(h, end, &double).iter().zip(&estimates(h, end, &single)) {
        let change: Vec<f64> = d.parts.iter().zip(&s.parts).map(|(d, s)| s - d).collect();
        let (error, of_change) = (standard_error(&d.parts), standard_error(&change));
        println!(
            "  {:20} {:9.5} +- {error:.5}   f32 - f64 {:+.1e} +- {of_change:.1e}",
            d.name,
            d.value,
            s.value - d.value
        );
    }
}

/// Other normals, hence other paths: independent ensembles.
fn compare_normals(model: &Model, h: f64, paths: u64) {
    let (end, steps) = (60.0, (60.0 / h).round() as u64);
    let own = estimates(h, end, &simulate::<f64, Own>(model, h, steps, 1, paths));
    println!("h = {h}, t_end = {end}, {paths} paths");
    for (name, others) in [
        ("f32, inversion", simulate::<f32, Inverse>(model, h, steps, 2, paths)),
        ("f64, four bytes", simulate::<f64, Bytes>(model, h, steps, 3, paths)),
    ] {
        for (own, other) in own.iter().zip(&estimates(h, end, &others)) {
            let error = standard_error(&own.parts).hypot(standard_error(&other.parts));
            println!("  {name}: {:20} {:9.5} {:+.5} +- {error:.5}", own.name, own.value, other.value - own.value);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    for h in [0.01, 0.001] {
        time(h)?;
    }
    let model = Scenario::read("scenarios/rho025.toml".as_ref(), &[])?.model;
    for (h, paths) in [(0.04, 8192), (0.01, 8192), (1e-3, 4096), (1e-4, 1024), (1e-5, 256), (1e-6, 32)] {
        compare_precision(&model, h, 60.0, paths);
    }
    compare_precision(&model, 0.01, 6000.0, 512);
    for (h, paths) in [(0.04, 131_072), (0.01, 65_536), (1e-3, 16_384)] {
        compare_normals(&model, h, paths);
    }
    Ok(())
}
