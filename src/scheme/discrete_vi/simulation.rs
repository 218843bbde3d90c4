//! The discrete scheme on one model, corrected or not: many paths in lanes, observed on a timeline.

use super::kernel::{Kernel, Paths, RUN, Turn};
use super::reading::GridReader;
use crate::lanes::InstructionSet;
use crate::model::{Force, HarmonicClock, InitialNoise, LARGEST, Problem};
use crate::noise::LaneStreams;
use crate::scheme::{Along, Instant, Observer, Segment, Simulate, Simulated, Snapshot, Timeline};

/// A path counts as diverged beyond this multiple of the largest displacement to be expected of the
/// exact model.
const DIVERGENCE_MARGIN: f64 = 10.0;

/// The same multiple under a user-defined force, for a displacement to which that force only
/// adds its size at the start.
const OWN_FORCE_MARGIN: f64 = 1e6;

/// The number of stationary standard deviations of v that are included in that largest
/// displacement.
const FARTHEST_NOISE_SDS: f64 = 10.0;

/// The discrete variational inequality on one model with one step, corrected or not.
#[derive(Clone, Debug)]
pub struct DiscreteSimulation {
    model: Problem,
    timeline: Timeline,
    h: f64,
    clock: HarmonicClock,
    /// g, if it is a function of t alone: a part of the forcing, the same for all paths.
    of_time: Option<Force>,
    /// The displacement beyond which a path counts as diverged.
    bound: f64,
    refinement: usize,
    /// The number of steps between the instants at which paths can be observed.
    observed_every: u64,
    is_corrected: bool,
    instructions: InstructionSet,
}

impl DiscreteSimulation {
    /// The scheme with steps of length `h`. Each stop of the timeline is observed at the t_n that
    /// is nearest to it.
    pub fn new(model: &Problem, timeline: &Timeline, h: f64) -> Self {
        DiscreteSimulation {
            model: model.clone(),
            timeline: *timeline,
            h,
            clock: HarmonicClock::of(&model.temperature, h),
            bound: divergence_bound(model, timeline.end),
            of_time: model.force.clone().filter(Force::is_of_time_alone),
            refinement: 1,
            observed_every: 1,
            is_corrected: false,
            instructions: InstructionSet::detect(),
        }
    }

    /// The corrected scheme ([`super::CorrectedVi`]) with steps of length `h`.
    pub fn corrected(model: &Problem, timeline: &Timeline, h: f64) -> Self {
        DiscreteSimulation {
            is_corrected: true,
            ..DiscreteSimulation::new(model, timeline, h)
        }
    }

    /// The same simulation on another instruction set. The results have the same bits.
    pub fn with_instructions(self, instructions: InstructionSet) -> Self {
        DiscreteSimulation {
            instructions,
            ..self
        }
    }

    /// The instruction set in use.
    pub fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// v(0)/unit of each lane.
    fn initial_noise(&self, unit: f64, streams: &mut LaneStreams, paths: usize) -> Vec<f64> {
        let lanes = Paths::padded(paths);
        match self.model.temperature.effective_noise() {
            None => vec![0.0; lanes],
            Some(noise) => match noise.initial {
                InitialNoise::At(v) => vec![v / unit; lanes],
                InitialNoise::Stationary => {
                    let sd = noise.stationary_sd() / unit;
                    streams
                        .normals(1, self.instructions)
                        .into_iter()
                        .map(|z| sd * z)
                        .collect()
                }
            },
        }
    }

    /// Writes the forces at t_n, t_{n+1}, ..., which are the same for all paths, where T without noise
    /// has these values.
    fn fill_forcing(&self, n: u64, temperature: &[f64], forcing: &mut [f64]) {
        let gain = self.model.oscillator.force_per_temperature();
        for ((n, to), temperature) in (n..).zip(forcing).zip(temperature) {
            *to = gain * temperature;
            if let Some(force) = &self.of_time {
                *to += force.at(self.instructions, 0.0, 0.0, n as f64 * self.h);
            }
        }
    }

    /// Reports step n of all moving paths: their states before it, which of them were static there,
    /// and their states after it.
    fn report_step(
        &self,
        n: u64,
        (before, is_static): (Paths, Vec<bool>),
        after: &Paths,
        temperature: impl Fn(f64) -> f64,
        observer: &mut dyn Observer,
    ) {
        for lane in (0..is_static.len()).filter(|&lane| !is_static[lane]) {
            let (at, to) = (before.point(lane), after.point(lane));
            let along = Along::Step {
                temperature: temperature(at.noise),
            };
            let (start, length, velocity) = (n as f64 * self.h, self.h, [at.v, to.v]);
            observer.segment(
                lane,
                &Segment {
                    start,
                    length,
                    displacement: at.x,
                    way: to.x - at.x,
                    velocity,
                    along,
                },
            );
        }
    }
}

impl Simulate for DiscreteSimulation {
    fn model(&self) -> &Problem {
        &self.model
    }

    fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    fn step(&self) -> Option<f64> {
        Some(self.h)
    }

    fn kernel(&self) -> String {
        format!("{} lanes", self.instructions.name())
    }

    /// v of each path takes the same values as in the scheme with the shorter step and the same
    /// seed.
    fn fed_by_finer(self, refinement: usize) -> Self {
        DiscreteSimulation { refinement, ..self }
    }

    fn observed_every(self, steps: u64) -> Self {
        DiscreteSimulation {
            observed_every: steps,
            ..self
        }
    }

    /// A path is lost if it diverges: if |x| exceeds [`divergence_bound`] or is not a number.
    fn simulate_counting(
        &self,
        seed: u64,
        paths: &[u64],
        observer: &mut dyn Observer,
    ) -> Simulated {
        let mut walk = Walk::start(self, seed, paths, observer);
        for stop in self.timeline.stops() {
            let grid = self.h * self.observed_every as f64;
            let target = (stop.time / grid).round() as u64 * self.observed_every;
            while walk.n < target {
                if observer.is_stopped() {
                    return Simulated::default();
                }
                walk.advance(target, observer);
            }
            walk.snapshot(stop.instant, observer);
        }
        Simulated {
            lost: walk.lost(),
            ..Simulated::default()
        }
    }
}

/// Many paths advanced from step to step.
struct Walk<'a> {
    simulation: &'a DiscreteSimulation,
    kernel: Kernel,
    streams: LaneStreams,
    paths: usize,
    /// The step at which the paths are.
    n: u64,
    state: Paths,
    /// T without noise, and the force of it, at the instants of a run of steps; the first is t_n.
    harmonics: [f64; RUN + 1],
    forcing: [f64; RUN + 1],
    reader: GridReader,
    turns: Vec<Turn>,
    diverged: Vec<bool>,
    temperature: Vec<f64>,
    is_static: Vec<bool>,
}

impl<'a> Walk<'a> {
    fn start(
        simulation: &'a DiscreteSimulation,
        seed: u64,
        paths: &[u64],
        observer: &mut dyn Observer,
    ) -> Self {
        let model = &simulation.model;
        let is_forced = simulation.of_time.is_none();
        let kernel = Kernel::new(
            model,
            model.force.clone().filter(|_| is_forced),
            simulation.h,
            simulation.refinement,
            simulation.is_corrected,
            simulation.instructions,
        );
        let mut streams = LaneStreams::new(seed, paths, Paths::padded(paths.len()));
        let paths = paths.len();
        let noise = simulation.initial_noise(kernel.noise.unit, &mut streams, paths);
        let state = Paths::at(model.initial_displacement, model.initial_velocity, &noise);
        let mut harmonics = [0.0; RUN + 1];
        let mut forcing = [0.0; RUN + 1];
        simulation.clock.fill(0, &mut harmonics[..1]);
        simulation.fill_forcing(0, &harmonics[..1], &mut forcing);
        Walk {
            reader: GridReader::start(&kernel, &state, forcing[0], paths, observer),
            diverged: vec![false; paths],
            turns: Vec::new(),
            temperature: Vec::new(),
            is_static: Vec::new(),
            n: 0,
            simulation,
            kernel,
            streams,
            paths,
            state,
            harmonics,
            forcing,
        }
    }

    /// Takes a run of steps, at most to `target`, and reports what happens in it.
    fn advance(&mut self, target: u64, observer: &mut dyn Observer) {
        let Walk {
            simulation,
            kernel,
            streams,
            n,
            state,
            harmonics,
            forcing,
            reader,
            turns,
            ..
        } = self;
        let follows = observer.follows();
        let steps = if follows {
            1
        } else {
            RUN.min((target - *n) as usize)
        };
        simulation.clock.fill(*n, &mut harmonics[..=steps]);
        simulation.fill_forcing(*n, &harmonics[..=steps], forcing);
        let before = follows.then(|| {
            let is_static = reader.statics(kernel, state, forcing[0], *n).collect();
            (state.clone(), is_static)
        });
        kernel.advance(*n, &forcing[..=steps], streams, state, turns);
        reader.read(kernel, *n, forcing, turns, observer);
        if let Some(before) = before {
            let temperature = |noise: f64| harmonics[0] + kernel.noise.temperature * noise;
            simulation.report_step(*n, before, state, temperature, observer);
        }
        *n += steps as u64;
        (harmonics[0], forcing[0]) = (harmonics[steps], forcing[steps]);
        self.note_divergence();
    }

    fn note_divergence(&mut self) {
        // All lanes are tested together first, because a path hardly ever diverges.
        let bound = self.simulation.bound;
        let is_bounded = |x: &f64| x.abs() <= bound;
        if !self.state.displacement[..self.paths]
            .iter()
            .fold(true, |all, x| all & is_bounded(x))
        {
            for (diverged, x) in self.diverged.iter_mut().zip(&self.state.displacement) {
                *diverged |= !is_bounded(x);
            }
        }
        // A user-defined force may be NaN, which the displacement shows a step later.
        if self.simulation.model.force.is_some() {
            for (diverged, v) in self.diverged.iter_mut().zip(&self.state.velocity) {
                *diverged |= !v.is_finite();
            }
        }
    }

    fn snapshot(&mut self, instant: Instant, observer: &mut dyn Observer) {
        let Walk {
            kernel,
            paths,
            n,
            state,
            harmonics,
            forcing,
            temperature,
            is_static,
            ..
        } = self;
        is_static.clear();
        is_static.extend(self.reader.statics(kernel, state, forcing[0], *n));
        temperature.clear();
        temperature.extend(
            state.noise[..*paths]
                .iter()
                .map(|v| harmonics[0] + kernel.noise.temperature * v),
        );
        let snapshot = Snapshot {
            time: *n as f64 * self.simulation.h,
            displacement: &state.displacement[..*paths],
            velocity: &state.velocity[..*paths],
            temperature,
            is_static,
        };
        observer.snapshot(instant, snapshot);
    }

    /// The lanes of the paths that have diverged.
    fn lost(mut self) -> Vec<usize> {
        for &lane in &self.reader.forceless {
            self.diverged[lane] = true;
        }
        if self.simulation.model.force.is_some() {
            let last = self.forcing[0];
            for (lane, diverged) in self.diverged.iter_mut().enumerate() {
                let pulls = self.kernel.pulls(&self.state.point(lane), last, self.n);
                *diverged |= !pulls.iter().all(|pull| pull.is_finite());
            }
        }
        (0..self.paths)
            .filter(|&lane| self.diverged[lane])
            .collect()
    }
}

/// The displacement beyond which a path of the scheme counts as diverged, a length.
///
/// The undamped oscillator without friction obeys |x(t)| <= |x0| + (1 + w0 t) sup |beta T|, and the
/// body without a spring |x(t)| <= |x0| + t^2 sup |c T|/(2 m). Friction and damping only take
/// energy away; negative damping lets x grow by e^{2 |gamma| t}. The bound is ten times this value
/// at t_end, where T includes ten stationary standard deviations of the noise, plus ten f_s/K; with
/// negative damping it is at most 1e100.
///
/// The range of motion under a user-defined force is unknown. With one, its largest value at x0 and
/// rest is part of the force, a typical length is part of x, and the bound is a million times the
/// result, at most 1e100.
pub fn divergence_bound(model: &Problem, end: f64) -> f64 {
    let Problem {
        oscillator,
        friction,
        ..
    } = model;
    let thermal =
        oscillator.force_per_temperature().abs() * model.temperature.bound(FARTHEST_NOISE_SDS, end);
    let force = thermal + model.largest_at_start(end).0;
    let driven = if oscillator.stiffness > 0.0 {
        let growth = 1.0 + oscillator.natural_frequency() * end;
        let run_up = model.initial_velocity.abs() / oscillator.natural_frequency();
        growth * (force / oscillator.stiffness)
            + friction.static_force / oscillator.stiffness
            + run_up
    } else {
        (force + friction.static_force) / oscillator.mass * end * end / 2.0
            + model.initial_velocity.abs() * end
    };
    let growth = libm::exp(-2.0 * oscillator.damping_rate().min(0.0) * end);
    let reach = model.initial_displacement.abs() + driven;
    match model.force {
        None if growth > 1.0 => (DIVERGENCE_MARGIN * growth * reach).min(LARGEST),
        None => (DIVERGENCE_MARGIN * reach).min(f64::MAX),
        Some(_) => (OWN_FORCE_MARGIN * growth * (reach + model.length_scale(end))).min(LARGEST),
    }
}
