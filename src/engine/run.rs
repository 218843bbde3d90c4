//! The run itself: blocks are simulated, handed on, summed and looked at, until something ends it.

use super::ending::{Endings, Look};
use super::{BiasReport, EndedBy, Outcome, Progress, Sink, SinkError, Status};
use crate::bias::NoBias;
use crate::ensemble::{Delivered, Plan};
use crate::scenario::Scenario;
use crate::stats::{Companion, Goal, Measurement, Overlap, RunTotals, Summary, Tallied, Tally};
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// A run of a scenario, set up by the methods below and started by [`Run::simulate`].
///
/// The outcome is a function of the scenario and the goals: threads, progress and sinks change no bit of it. Only a time
/// limit and a stop from outside depend on the machine, and they end a run after some block whose number is in the outcome.
///
/// ```
/// use stick_slip::engine::Run;
/// use stick_slip::scenario::Scenario;
/// use stick_slip::stats::Statistic;
///
/// let mut scenario = Scenario::shipped("rho025")?;
/// scenario.ensemble.paths = 1_000;
/// let outcome = Run::of(&scenario).threads(2).simulate()?;
/// let mean = outcome.summary.estimate(Statistic::StickDurationMean);
/// assert!(mean.low < mean.estimate && mean.estimate < mean.high);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Run<'a> {
    scenario: &'a Scenario,
    paths: u64,
    threads: usize,
    endings: Endings,
    with_bias: bool,
    stop: Option<&'a AtomicBool>,
    progress: Option<&'a mut dyn Progress>,
    sinks: Vec<&'a mut dyn Sink>,
}

/// Why a run has no outcome.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A sink failed. What it was handed before is its own.
    #[error(transparent)]
    Sink(#[from] SinkError),
    /// A block was delivered twice: a flaw of this program.
    #[error("a flaw in the program: {0}")]
    Overlap(#[from] Overlap),
}

impl<'a> Run<'a> {
    /// Of all paths that the scenario asks for, on one thread a core, with an estimate of the bias of the step.
    pub fn of(scenario: &'a Scenario) -> Self {
        Run {
            scenario,
            paths: scenario.ensemble.paths,
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            endings: Endings::default(),
            with_bias: true,
            stop: None,
            progress: None,
            sinks: Vec::new(),
        }
    }

    /// The same paths on so many threads. No bit depends on it.
    pub fn threads(self, threads: usize) -> Self {
        Run { threads: threads.max(1), ..self }
    }

    /// At most so many paths, whatever the scenario asks for; whole pairs where they are antithetic.
    pub fn paths(self, paths: u64) -> Self {
        let is_paired = self.scenario.ensemble.antithetic;
        Run { paths: if is_paired { paths.next_multiple_of(2) } else { paths }, ..self }
    }

    /// End at the first block after which every goal is reached.
    pub fn until(mut self, goals: Vec<Goal>) -> Self {
        self.endings.goals = goals;
        self
    }

    /// End after the block in which this much time is up.
    pub fn within(mut self, time: Option<Duration>) -> Self {
        self.endings.max_time = time;
        self
    }

    /// Do not estimate the bias of the step, which takes up to an eighth of the time.
    pub fn without_bias(self) -> Self {
        Run { with_bias: false, ..self }
    }

    /// Finish the blocks in flight and end when this flag is raised.
    pub fn stopped_by(self, stop: &'a AtomicBool) -> Self {
        Run { stop: Some(stop), ..self }
    }

    /// Tell somebody how far the run has come.
    pub fn told(self, progress: &'a mut dyn Progress) -> Self {
        Run { progress: Some(progress), ..self }
    }

    /// Hand every finished block, and the outcome, to a sink. There may be several.
    pub fn into_sink(mut self, sink: &'a mut dyn Sink) -> Self {
        self.sinks.push(sink);
        self
    }

    /// Simulate it.
    pub fn simulate(self) -> Result<Outcome, RunError> {
        self.simulate_beside(&())
    }

    /// Simulate it with a statistic of the caller's own folded beside the program's.
    pub fn tallied<T: Tally<N>, const N: usize>(self, tally: &T) -> Result<Outcome<Measurement>, RunError> {
        let outcome = self.simulate_beside(&Tallied(tally))?;
        let estimate = tally.estimate(&outcome.tally);
        Ok(outcome.with_tally(estimate))
    }

    fn simulate_beside<C: Companion>(mut self, companion: &C) -> Result<Outcome<C::Sums>, RunError> {
        let start = Instant::now();
        let never = AtomicBool::new(false);
        let stop = self.stop.unwrap_or(&never);
        let mut nobody = ();
        let progress = self.progress.take().unwrap_or(&mut nobody);
        let plan = Plan { paths: self.paths, ..self.scenario.plan() };
        let mut totals = RunTotals::with(companion.empty(), plan.model(), plan.timeline());
        for sink in &mut self.sinks {
            sink.begin(self.scenario, plan.paths)?;
        }

        let mut ended_by = None;
        let deliver = |block: Delivered<C::Sums>| -> Result<ControlFlow<()>, RunError> {
            let Delivered { index, result, beside } = block;
            let done = result.first_path + result.paths;
            self.sinks.iter_mut().try_for_each(|sink| sink.block(&result))?;
            totals.push_with(index, result.totals, beside)?;
            if let Some(statistic) = progress.watches() {
                progress.estimate(&totals.estimate(statistic));
            }
            Ok(match self.endings.look(index + 1, &totals, start) {
                Look::GoOn(needed) => {
                    progress.paths(done, needed.unwrap_or(plan.paths).min(plan.paths));
                    ControlFlow::Continue(())
                }
                Look::Stop(reason) => {
                    ended_by = Some(reason);
                    ControlFlow::Break(())
                }
            })
        };
        let completed = plan.run_beside(companion, self.threads, stop, deliver)?;

        let status = match ended_by {
            Some(_) => Status::Ended,
            None if completed == plan.paths => Status::Complete,
            None => Status::Interrupted,
        };
        let is_reached = status != Status::Interrupted && !matches!(ended_by, Some(EndedBy::Hopeless(_)));
        let missed = if is_reached { self.endings.missed(&totals, completed) } else { Vec::new() };
        let mut summary = totals.totals().summary();
        let bias =
            if self.with_bias { self.add_bias(completed, stop, progress, &mut summary) } else { BiasReport::default() };
        let seconds = start.elapsed().as_secs_f64();
        let (paths, threads) = (plan.paths, self.threads);
        let mut outcome = Outcome { summary, status, paths, ended_by, missed, bias, threads, seconds, tally: () };
        for sink in &mut self.sinks {
            sink.finish(&outcome)?;
        }
        outcome.seconds = start.elapsed().as_secs_f64();
        Ok(outcome.with_tally(totals.own()))
    }

    /// Estimate the bias of the step from some of the paths that the run came to, and add it to the summary.
    fn add_bias(
        &self,
        paths: u64,
        stop: &AtomicBool,
        progress: &mut dyn Progress,
        summary: &mut Summary,
    ) -> BiasReport {
        let start = Instant::now();
        let mut estimate = || -> Result<(), NoBias> {
            let plan = self.scenario.bias_plan(paths)?;
            progress.estimating_bias();
            let biases = plan.estimate(summary, self.threads, stop)?;
            summary.set_biases(&biases);
            Ok(())
        };
        let absence = estimate().err();
        BiasReport { seconds: start.elapsed().as_secs_f64(), absence }
    }
}
