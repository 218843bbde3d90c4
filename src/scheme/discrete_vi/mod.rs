//! The paper's discrete variational inequality: one explicit step for all phases.
//!
//! ```text
//! X_0 = x0, V_0 = 0, t_n = n h
//! X_{n+1} = X_n + h V_n
//! S_n     = V_n + (h/m) b(X_n, V_n, t_n)
//! V_{n+1} = 0                               if |S_n| <= (h/m) f_s
//!         = S_n - (h/m) f_d sign(S_n)       otherwise
//! ```
//!
//! (paper, section 3.1.) With f_d = f_s the last line is [`crate::model::prox`] at S_n, the solution of the discrete
//! variational inequality. The noise between t_n and t_{n+1} is the exact Ornstein-Uhlenbeck transition.
//!
//! Paths are stepped many side by side ([`kernel`]); what turns a velocity into phases is rare, and scalar ([`reading`]).
//! The scheme is first order in h where nothing random decides, and of order 1/2 in every statistic of sticks when there is
//! noise: a stick exit is a barrier looked at only every h. The corrected scheme mends most of that at no cost: it leaves
//! stick at [`corrected_exit`], f_s less [`monitoring_shift`], and moves with the new velocity, X_{n+1} = X_n + h V_{n+1}.

mod kernel;
mod reading;

use self::kernel::{Kernel, Paths, RUN};
use self::reading::Reader;
use super::{Observer, Snapshot, Timeline};
use crate::lanes::InstructionSet;
use crate::model::{Friction, HarmonicClock, InitialNoise, Model, Phase};
use crate::noise::LaneStreams;

/// How far beyond the greatest displacement the exact model can be thought to reach a path may go before it counts as diverged.
const DIVERGENCE_MARGIN: f64 = 10.0;

/// How many stationary standard deviations of v that greatest displacement allows for.
const NOISE_REACH: f64 = 10.0;

/// The discrete variational inequality on one model with one step.
#[derive(Clone, Debug)]
pub struct DiscreteVi {
    model: Model,
    timeline: Timeline,
    h: f64,
    clock: HarmonicClock,
    refinement: usize,
    /// Steps between the instants at which paths can be observed.
    observed_every: u64,
    is_corrected: bool,
    instructions: InstructionSet,
}

impl DiscreteVi {
    /// For steps of length `h`, of which the stops of the timeline are taken to be whole multiples: each is observed at
    /// the nearest t_n.
    pub fn new(model: &Model, timeline: &Timeline, h: f64) -> Self {
        DiscreteVi {
            model: model.clone(),
            timeline: *timeline,
            h,
            clock: HarmonicClock::new(&model.temperature.harmonics, h),
            refinement: 1,
            observed_every: 1,
            is_corrected: false,
            instructions: InstructionSet::detect(),
        }
    }

    /// The corrected scheme: order 1 instead of 1/2 in the statistics of sticks. Sound while [`monitoring_shift`] is small against f_s.
    pub fn corrected(model: &Model, timeline: &Timeline, h: f64) -> Self {
        DiscreteVi { is_corrected: true, ..DiscreteVi::new(model, timeline, h) }
    }

    /// The same, each step fed the noise of `refinement` >= 1 steps of h/refinement: v passes through the values it has in the scheme with
    /// that shorter step and the same seed, path by path. So the schemes with steps h, 2h, 4h are simulated on one realisation.
    pub fn fed_by_finer(self, refinement: usize) -> Self {
        DiscreteVi { refinement, ..self }
    }

    /// The same, each stop of the timeline rounded to a whole multiple of `steps` >= 1 steps. So schemes with different steps look at
    /// their paths at the same instants.
    pub fn observed_every(self, steps: u64) -> Self {
        DiscreteVi { observed_every: steps, ..self }
    }

    /// The same on another instruction set; the results are the same bits.
    pub fn with_instructions(self, instructions: InstructionSet) -> Self {
        DiscreteVi { instructions, ..self }
    }

    /// h.
    pub fn step(&self) -> f64 {
        self.h
    }

    /// The instruction set in use.
    pub fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// Simulate these paths of the ensemble with this seed. Returns the lanes of the paths that diverged: whose |x| is not a
    /// number below [`divergence_bound`]. What the observer saw of them is worthless.
    pub fn simulate<O: Observer>(&self, seed: u64, paths: &[u64], observer: &mut O) -> Vec<usize> {
        let kernel = Kernel::new(&self.model, self.h, self.refinement, self.is_corrected, self.instructions);
        let mut streams = LaneStreams::new(seed, paths, Paths::padded(paths.len()));
        let paths = paths.len();
        let bound = divergence_bound(&self.model, self.timeline.end);
        let to_force = self.model.oscillator.stiffness * self.model.oscillator.dilatation;
        let noise = self.initial_noise(kernel.noise.kick, &mut streams, paths);
        let mut state = Paths::at_rest(self.model.initial_displacement, &noise);
        let mut harmonics = [0.0; RUN + 1];
        let mut forcing = [0.0; RUN + 1];
        self.clock.fill(0, &mut harmonics[..1]);
        forcing[0] = to_force * harmonics[0];
        let mut reader = Reader::start(&kernel, &state, forcing[0], paths, observer);
        let mut diverged = vec![false; paths];
        let mut sampled = Samples::default();
        let mut turns = Vec::new();

        let mut n = 0u64;
        for stop in self.timeline.stops() {
            let grid = self.h * self.observed_every as f64;
            let target = (stop.time / grid).round() as u64 * self.observed_every;
            while n < target {
                let steps = RUN.min((target - n) as usize);
                self.clock.fill(n, &mut harmonics[..=steps]);
                for (force, harmonic) in forcing.iter_mut().zip(&harmonics[..=steps]) {
                    *force = to_force * harmonic;
                }
                kernel.advance(&forcing[..=steps], &mut streams, &mut state, &mut turns);
                reader.read(&kernel, n, &forcing, &turns, observer);
                // all at once first: hardly ever is there one to name
                let is_in_reach = |x: &f64| x.abs() <= bound;
                if !state.displacement[..paths].iter().fold(true, |all, x| all & is_in_reach(x)) {
                    for (diverged, x) in diverged.iter_mut().zip(&state.displacement) {
                        *diverged |= !is_in_reach(x);
                    }
                }
                n += steps as u64;
                harmonics[0] = harmonics[steps];
            }
            let snapshot =
                sampled.take(&state, reader.phases(), harmonics[0], kernel.noise.temperature, n as f64 * self.h);
            observer.snapshot(stop.instant, snapshot);
        }
        (0..paths).filter(|&lane| diverged[lane]).collect()
    }

    /// v(0)/kick of each lane.
    fn initial_noise(&self, kick: f64, streams: &mut LaneStreams, paths: usize) -> Vec<f64> {
        let lanes = Paths::padded(paths);
        match self.model.temperature.noise {
            None => vec![0.0; lanes],
            Some(noise) => match noise.initial {
                InitialNoise::At(v) => vec![v / kick; lanes],
                InitialNoise::Stationary => {
                    let sd = noise.stationary_sd() / kick;
                    streams.normals(1, self.instructions).into_iter().map(|z| sd * z).collect()
                }
            },
        }
    }
}

/// -zeta(1/2) / sqrt(2 pi): by how many standard deviations of a step a random walk overshoots a barrier, in the mean.
const OVERSHOOT: f64 = 0.582_597_157_939_010_7;

/// What looking at a barrier only every h amounts to, as a force: 0.5826 K beta rho sigma sqrt(h). Lowering the threshold by it gives
/// the exit time of continuous monitoring up to o(sqrt(h)) (Broadie, Glasserman, Kou, Math. Finance 7 (1997); for moving barriers
/// Gobet, Menozzi, Stoch. Proc. Appl. 120 (2010)).
pub fn monitoring_shift(model: &Model, h: f64) -> f64 {
    let Model { oscillator, temperature, .. } = model;
    let noise = temperature.noise.map_or(0.0, |noise| noise.intensity * noise.diffusion);
    OVERSHOOT * oscillator.stiffness * oscillator.dilatation.abs() * noise * h.sqrt()
}

/// The force at which the corrected scheme leaves a stick: f_s less [`monitoring_shift`], and never below f_d. A body let go at |b| < f_d
/// would be driven by |b| - f_d, against b, where friction holds it; so what f_s - f_d has no room for is not corrected.
pub fn corrected_exit(model: &Model, h: f64) -> f64 {
    let Friction { static_force, dynamic_force } = model.friction;
    (static_force - monitoring_shift(model, h)).max(dynamic_force)
}

/// The displacement beyond which a path of the scheme has left every solution of the model behind.
///
/// The undamped oscillator without friction obeys |x(t)| <= |x0| + (1 + w0 t) sup |beta T|; friction and damping only take
/// energy. The bound is ten times that at t_end, with ten stationary standard deviations of the noise, plus ten f_s/K.
pub fn divergence_bound(model: &Model, end: f64) -> f64 {
    let oscillator = &model.oscillator;
    let reach = oscillator.dilatation.abs() * model.temperature.reach(NOISE_REACH);
    let growth = 1.0 + oscillator.natural_frequency() * end;
    let stuck = model.friction.static_force / oscillator.stiffness;
    (DIVERGENCE_MARGIN * (model.initial_displacement.abs() + growth * reach + stuck)).min(f64::MAX)
}

/// The buffers a snapshot is shown from.
#[derive(Default)]
struct Samples {
    temperature: Vec<f64>,
    is_static: Vec<bool>,
}

impl Samples {
    fn take<'a>(
        &'a mut self,
        state: &'a Paths,
        phases: &[Phase],
        harmonic: f64,
        noise: f64,
        time: f64,
    ) -> Snapshot<'a> {
        let paths = phases.len();
        self.temperature.clear();
        self.temperature.extend(state.noise[..paths].iter().map(|v| harmonic + noise * v));
        self.is_static.clear();
        self.is_static.extend(phases.iter().map(|phase| *phase == Phase::Static));
        Snapshot {
            time,
            displacement: &state.displacement[..paths],
            velocity: &state.velocity[..paths],
            temperature: &self.temperature,
            is_static: &self.is_static,
        }
    }
}
