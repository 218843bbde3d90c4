//! A scheme on one model, ready to simulate: on the model itself, or, where it has random inputs, on
//! that of each path.

use super::columns::StateColumns;
use super::{
    Instant, Observer, OfScheme, Scheme, Segment, Simulate, Simulated, Snapshot, Timeline,
};
use crate::model::{Event, Problem};

/// A scheme on one model and one timeline, ready to simulate paths.
#[derive(Clone, Debug)]
pub struct Simulation {
    scheme: Scheme,
    of_scheme: OfScheme,
    options: Options,
}

/// What was asked of a simulation, for those of single paths.
#[derive(Clone, Copy, Debug)]
struct Options {
    refinement: usize,
    observed_every: u64,
    row_stride: usize,
    work_limit: Option<u64>,
}

impl Options {
    /// A simulation with all of them.
    fn apply(self, to: OfScheme) -> OfScheme {
        let asked = to
            .fed_by_finer(self.refinement)
            .observed_every(self.observed_every)
            .with_additional_rows(self.row_stride);
        match self.work_limit {
            Some(limit) => asked.with_work_limit(limit),
            None => asked,
        }
    }
}

impl Scheme {
    /// The scheme on this model, observed on this timeline.
    pub fn simulation(self, model: &Problem, timeline: &Timeline) -> Simulation {
        Simulation {
            scheme: self,
            of_scheme: self.of_scheme(model, timeline),
            options: Options {
                refinement: 1,
                observed_every: 1,
                row_stride: 1,
                work_limit: None,
            },
        }
    }
}

impl Simulation {
    /// The simulation of one path, and its model.
    fn of_path(&self, seed: u64, path: u64) -> (Problem, OfScheme) {
        let timeline = self.timeline();
        let model = self.model().realised(seed, path, timeline.end, self.step());
        let of_scheme = self.scheme.of_scheme(&model, timeline);
        (model, self.options.apply(of_scheme))
    }

    fn with(self, options: Options) -> Self {
        Simulation {
            of_scheme: options.apply(self.of_scheme),
            options,
            ..self
        }
    }
}

impl Simulate for Simulation {
    fn model(&self) -> &Problem {
        self.of_scheme.model()
    }

    fn timeline(&self) -> &Timeline {
        self.of_scheme.timeline()
    }

    /// With random inputs, the paths are simulated one after the other, and reported together.
    fn simulate_counting(
        &self,
        seed: u64,
        paths: &[u64],
        observer: &mut dyn Observer,
    ) -> Simulated {
        if self.model().random.is_empty() {
            return self.of_scheme.simulate_counting(seed, paths, observer);
        }
        let mut all = Simulated::default();
        let mut kept = KeptPaths::new(observer, paths.len());
        for (lane, path) in paths.iter().enumerate() {
            if kept.is_stopped() {
                return all;
            }
            let (model, simulation) = self.of_path(seed, *path);
            kept.observer.realised(lane, &model);
            kept.begin();
            let of_path = simulation.simulate_counting(seed, &[*path], &mut kept);
            all.evaluations += of_path.evaluations;
            all.why = all.why.or(of_path.why);
            if !of_path.lost.is_empty() {
                all.lost.push(lane);
            }
        }
        // A path that was stopped is not complete.
        if !kept.is_stopped() {
            kept.report();
        }
        all
    }

    fn step(&self) -> Option<f64> {
        self.of_scheme.step()
    }

    fn vectorised_paths(&self) -> usize {
        match self.model().random.is_empty() {
            true => self.of_scheme.vectorised_paths(),
            false => 1,
        }
    }

    fn kernel(&self) -> String {
        match self.model().random.is_empty() {
            true => self.of_scheme.kernel(),
            false => "path by path, each with its own inputs".to_string(),
        }
    }

    fn fed_by_finer(self, refinement: usize) -> Self {
        let options = self.options;
        self.with(Options {
            refinement,
            ..options
        })
    }

    fn observed_every(self, steps: u64) -> Self {
        let options = self.options;
        self.with(Options {
            observed_every: steps,
            ..options
        })
    }

    fn with_additional_rows(self, row_stride: usize) -> Self {
        let options = self.options;
        self.with(Options {
            row_stride,
            ..options
        })
    }

    fn with_work_limit(self, limit: u64) -> Self {
        let options = self.options;
        self.with(Options {
            work_limit: Some(limit),
            ..options
        })
    }
}

/// What happens to a path between two states.
enum Happened {
    Event(Event),
    Segment(Segment),
}

/// Keeps what is reported of one path after the other, and reports it as that of paths that move
/// together.
struct KeptPaths<'a> {
    observer: &'a mut dyn Observer,
    follows: bool,
    paths: usize,
    /// What happened to each path, and how much of it before each instant.
    happened: Vec<(Vec<Happened>, Vec<usize>)>,
    /// The instants with their times, and the states of the paths there, path after path.
    instants: Vec<(Instant, f64)>,
    states: Vec<StateColumns>,
}

impl<'a> KeptPaths<'a> {
    fn new(observer: &'a mut dyn Observer, paths: usize) -> Self {
        KeptPaths {
            follows: observer.follows(),
            observer,
            paths,
            happened: Vec::new(),
            instants: Vec::new(),
            states: Vec::new(),
        }
    }

    /// Begin with the next path.
    fn begin(&mut self) {
        self.happened.push((Vec::new(), Vec::new()));
    }

    fn path(&mut self) -> &mut (Vec<Happened>, Vec<usize>) {
        let last = self.happened.len() - 1;
        &mut self.happened[last]
    }

    /// Report everything in order of time.
    fn report(self) {
        let mut begun = vec![0; self.happened.len()];
        let observer = self.observer;
        let mut tell = |observer: &mut dyn Observer, lane: usize, until: usize| {
            for happened in &self.happened[lane].0[begun[lane]..until] {
                match happened {
                    Happened::Event(event) => observer.event(lane, *event),
                    Happened::Segment(segment) => observer.segment(lane, segment),
                }
            }
            begun[lane] = until;
        };
        for (k, ((instant, time), states)) in self.instants.iter().zip(&self.states).enumerate() {
            for (lane, (_, until)) in self.happened.iter().enumerate() {
                tell(observer, lane, until[k]);
            }
            observer.snapshot(*instant, states.snapshot(*time));
        }
        for (lane, (happened, _)) in self.happened.iter().enumerate() {
            tell(observer, lane, happened.len());
        }
    }
}

impl Observer for KeptPaths<'_> {
    fn event(&mut self, _: usize, event: Event) {
        self.path().0.push(Happened::Event(event));
    }

    fn follows(&self) -> bool {
        self.follows
    }

    fn segment(&mut self, _: usize, segment: &Segment) {
        self.path().0.push(Happened::Segment(*segment));
    }

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        let (happened, before) = self.path();
        before.push(happened.len());
        let k = before.len() - 1;
        if k == self.instants.len() {
            self.instants.push((instant, s.time));
            self.states.push(StateColumns::new(self.paths));
        }
        let seen = (
            s.displacement[0],
            s.velocity[0],
            s.temperature[0],
            s.is_static[0],
        );
        self.states[k].set(self.happened.len() - 1, seen);
    }

    fn is_stopped(&self) -> bool {
        self.observer.is_stopped()
    }
}
