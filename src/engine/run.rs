//! The run itself: blocks are simulated, passed to the sinks, summed and judged, until all are done
//! or something ends the run earlier.

use super::alarm::Alarm;
use super::crew::Threads;
use super::ending::{Endings, Look};
use super::{Asked, BiasReport, Crew, EndedBy, Moment, Outcome, Part, Portion, Progress, RunError, Sink, Status, Work};
use crate::bias::NoBias;
use crate::ensemble::{BLOCK_SIZE, MOST_THREADS, check_threads};
use crate::scenario::Scenario;
use crate::stats::{Companion as _, Goal, RunTotals, Summary, Tallied, Tally};
use crate::sums::{Measurement, Merge};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A run of a scenario, set up by the methods below and started by [`Run::simulate`].
///
/// The outcome is a function of the scenario and of what is asked of the run: its bits do not
/// depend on threads, progress or sinks. Only a time limit and a stop by the caller depend on the
/// machine. They end a run after some block, and the outcome contains the number of its paths.
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
    asked: Asked,
    threads: usize,
    stop: Option<&'a AtomicBool>,
    progress: Option<&'a mut dyn Progress>,
    sinks: Vec<&'a mut dyn Sink>,
    crew: Option<&'a dyn Crew>,
}

/// The state from which a run can be continued.
#[derive(Clone, Debug)]
pub struct SoFar {
    /// The sums of the blocks that are done.
    pub totals: RunTotals,
    /// Wall-clock time spent on them.
    pub spent: Duration,
}

/// The estimate of the bias takes at most this share of the time of the paths, including a margin.
/// A time limit is divided accordingly.
const BIAS_SHARE: f64 = 0.15;

impl<'a> Run<'a> {
    /// A run of all paths that the scenario asks for, on one thread for each core, with an estimate
    /// of the bias of the step.
    pub fn of(scenario: &'a Scenario) -> Self {
        Run {
            scenario,
            asked: Asked { with_bias: true, ..Asked::paths(scenario.ensemble.paths) },
            threads: std::thread::available_parallelism().map_or(1, usize::from).min(MOST_THREADS),
            stop: None,
            progress: None,
            sinks: Vec::new(),
            crew: None,
        }
    }

    /// What is asked of the run besides its scenario.
    pub fn question(&self) -> Asked {
        self.asked.clone()
    }

    /// Simulate on this many threads, 1 to [`MOST_THREADS`]. No bit of the results depends on this
    /// number.
    pub fn threads(self, threads: usize) -> Self {
        Run { threads, ..self }
    }

    /// Replace everything that is asked of the run by what was asked when it was begun.
    pub fn asked(self, asked: Asked) -> Self {
        Run { asked, ..self }
    }

    /// Simulate at most this many paths, whatever the scenario asks for. The number is rounded up
    /// to whole pairs if paths are antithetic.
    pub fn paths(mut self, paths: u64) -> Self {
        let is_paired = self.scenario.ensemble.antithetic;
        self.asked.paths = if is_paired { paths.next_multiple_of(2) } else { paths };
        self
    }

    /// Simulate only this part of the run.
    pub fn part(mut self, part: Option<Part>) -> Self {
        self.asked.part = part;
        self
    }

    /// End the run after the first block at which every goal is reached.
    pub fn until(mut self, goals: Vec<Goal>) -> Self {
        self.asked.goals = goals;
        self
    }

    /// End the run such that the paths and the estimate of the bias together keep this limit of
    /// wall-clock time.
    pub fn within(mut self, time: Option<Duration>) -> Self {
        self.asked.max_time = time;
        self
    }

    /// Do not estimate the bias of the step. The estimate takes up to an eighth of the time of the
    /// run.
    pub fn without_bias(mut self) -> Self {
        self.asked.with_bias = false;
        self
    }

    /// End the run when this flag is set. Unfinished blocks then get a moment to be completed.
    pub fn stopped_by(self, stop: &'a AtomicBool) -> Self {
        Run { stop: Some(stop), ..self }
    }

    /// Report how far the run has come.
    pub fn with_progress(self, progress: &'a mut dyn Progress) -> Self {
        Run { progress: Some(progress), ..self }
    }

    /// Pass every finished block, and the outcome, to this sink. There may be several sinks.
    pub fn into_sink(mut self, sink: &'a mut dyn Sink) -> Self {
        self.sinks.push(sink);
        self
    }

    /// Let a crew of several processes simulate the paths, each process on the given number of
    /// threads. No bit of the results depends on this. A run with a statistic of the caller's own
    /// does not use the crew, and is simulated in this process.
    pub fn with_crew(self, crew: &'a dyn Crew) -> Self {
        Run { crew: Some(crew), ..self }
    }

    /// Simulate the run.
    pub fn simulate(self) -> Result<Outcome, RunError> {
        let so_far = SoFar {
            totals: RunTotals::with((), &self.scenario.model, &self.scenario.timeline()),
            spent: Duration::ZERO,
        };
        self.go_on(so_far)
    }

    /// Simulate the rest of a run. The outcome has the same bits as that of a run which was never
    /// interrupted.
    pub fn go_on(self, so_far: SoFar) -> Result<Outcome, RunError> {
        let crew = self.crew.unwrap_or(&Threads(&()));
        self.simulate_by(crew, so_far.totals, so_far.spent)
    }

    /// Simulate the run, and compute a statistic of the caller's own beside those of the program.
    pub fn tallied<T: Tally<N>, const N: usize>(self, tally: &T) -> Result<Outcome<Measurement>, RunError> {
        let tallied = Tallied(tally);
        let totals = RunTotals::with(tallied.empty(), &self.scenario.model, &self.scenario.timeline());
        let outcome = self.simulate_by(&Threads(&tallied), totals, Duration::ZERO)?;
        let estimate = tally.estimate(&outcome.tally);
        Ok(outcome.with_tally(estimate))
    }

    fn simulate_by<X: Merge + Clone + Send>(
        mut self,
        crew: &dyn Crew<X>,
        mut totals: RunTotals<X>,
        spent: Duration,
    ) -> Result<Outcome<X>, RunError> {
        check_threads(self.threads)?;
        let start = Instant::now();
        let before = spent;
        let spent = move || before + start.elapsed();
        let never = AtomicBool::new(false);
        let stop = self.stop.unwrap_or(&never);
        let mut nobody = ();
        let progress = self.progress.take().unwrap_or(&mut nobody);
        let plan = self.asked.plan(self.scenario);
        let endings = self.endings();
        let left = [endings.time, self.asked.max_time].map(|limit| limit.map(|limit| limit.saturating_sub(before)));
        let alarm = Alarm::new(stop, left);
        for sink in &mut self.sinks {
            sink.begin(self.scenario, &self.asked).map_err(|error| RunError::Sink { error, outcome: None })?;
        }

        let asked = self.asked.blocks();
        let paths_before = |end: u64| (end * BLOCK_SIZE).min(plan.paths).saturating_sub(asked.start * BLOCK_SIZE);
        let counts = totals.counts().clone();
        // Blocks are done in order, so those that are done are the first ones.
        let first = totals.blocks().last().map_or(asked.start, |done| done.end);
        let look = |blocks: u64, totals: &RunTotals<X>| match endings.look(blocks, totals, spent()) {
            // A run of which all blocks are done needs no more time.
            Look::Stop(EndedBy::TimeLimit { blocks }) if blocks == asked.end => Look::GoOn(None),
            look => look,
        };
        // An earlier process may have reached the end of the run, and was interrupted before it
        // could finish.
        let mut ended_by = match look(first, &totals) {
            Look::Stop(reason) if first > asked.start => Some(reason),
            _ => None,
        };
        let left = if ended_by.is_some() { first..first } else { first..asked.end };
        let own_paths = self.asked.own_paths();
        // Each sink would need an outlet of its own, so there is one only if there is a single
        // sink.
        let outlet = if let [sink] = self.sinks.as_mut_slice() { sink.outlet() } else { None };
        let mut broken = None;
        let mut deliver = |portion: Portion<X>| -> Result<ControlFlow<()>, RunError> {
            let end = portion.end();
            let done = paths_before(end);
            let mut results = portion.results().iter();
            let handed = results.try_for_each(|block| self.sinks.iter_mut().try_for_each(|sink| sink.block(block)));
            let handed = handed.and_then(|()| {
                let mut receipts = portion.receipts().iter();
                receipts.try_for_each(|one| self.sinks.iter_mut().try_for_each(|sink| sink.left_in_outlet(one)))
            });
            portion.add_to(&mut totals, &counts)?;
            let moment = Moment { spent: spent(), paths: done, is_last: false, state: &|| totals.to_bytes() };
            let saved = handed.and_then(|()| self.sinks.iter_mut().try_for_each(|sink| sink.save(&moment)));
            if let Err(error) = saved {
                broken = Some(error);
                alarm.halt.store(true, Ordering::Relaxed);
                return Ok(ControlFlow::Break(()));
            }
            if let Some(statistic) = progress.watches() {
                progress.estimate(&totals.estimate(statistic));
            }
            Ok(match look(end, &totals) {
                Look::GoOn(needed) => {
                    progress.paths(done, needed.unwrap_or(own_paths).min(own_paths));
                    ControlFlow::Continue(())
                }
                Look::Stop(reason) => {
                    ended_by = Some(reason);
                    alarm.halt.store(true, Ordering::Relaxed);
                    ControlFlow::Break(())
                }
            })
        };
        let work = Work {
            scenario: self.scenario,
            asked: &self.asked,
            plan: &plan,
            blocks: left,
            threads: self.threads,
            stops: alarm.stops(),
            outlet,
        };
        let blocks = first + alarm.watching(|| crew.simulate(&work, &mut deliver))?;
        let is_whole = blocks >= asked.end;
        let is_stopped = || stop.load(Ordering::Relaxed);
        if !is_whole && ended_by.is_none() && broken.is_none() && !is_stopped() {
            // Only the time limit remains as a reason for which blocks were given up.
            ended_by = Some(EndedBy::TimeLimit { blocks });
        }
        totals.settle();
        let moment =
            Moment { spent: spent(), paths: paths_before(blocks), is_last: true, state: &|| totals.to_bytes() };
        if broken.is_none() {
            broken = self.sinks.iter_mut().try_for_each(|sink| sink.save(&moment)).err();
        }

        let mut summary = totals.totals().summary();
        let bias = match broken {
            None if self.asked.with_bias && self.asked.part.is_none() => {
                // The alarm looks at the flag only from time to time, so it is checked here as
                // well.
                alarm.end.fetch_or(is_stopped(), Ordering::Relaxed);
                alarm.watching(|| self.add_bias(summary.completed_paths, &alarm.end, progress, &mut summary))
            }
            _ => BiasReport::default(),
        };
        let status = match ended_by {
            _ if broken.is_some() || bias.absence == Some(NoBias::Stopped) && is_stopped() => Status::Interrupted,
            Some(_) => Status::Ended,
            None if !is_whole => Status::Interrupted,
            None if self.asked.part.is_some() => Status::Part,
            None => Status::Complete,
        };
        let is_reached = status != Status::Interrupted && !matches!(ended_by, Some(EndedBy::Hopeless(_)));
        let missed = if is_reached { endings.missed(&totals, summary.completed_paths) } else { Vec::new() };
        let seconds = spent().as_secs_f64();
        let (paths, part, threads) = (plan.paths, self.asked.part, crew.threads(self.threads));
        let mut outcome = Outcome { summary, status, paths, part, ended_by, missed, bias, threads, seconds, tally: () };
        if broken.is_none() {
            broken = self.sinks.iter_mut().try_for_each(|sink| sink.finish(&outcome)).err();
        }
        outcome.seconds = spent().as_secs_f64();
        match broken {
            Some(error) => Err(RunError::Sink { error, outcome: Some(Box::new(outcome)) }),
            None => Ok(outcome.with_tally(totals.own())),
        }
    }

    fn endings(&self) -> Endings {
        let Asked { paths, goals, max_time, with_bias, .. } = &self.asked;
        let has_bias = *with_bias && max_time.is_some() && self.scenario.bias_plan(*paths).is_ok();
        let share = if has_bias { 1.0 + BIAS_SHARE } else { 1.0 };
        Endings { goals: goals.clone(), time: max_time.map(|time| time.div_f64(share)) }
    }

    /// Estimate the bias of the step from some of the simulated paths, and add it to the summary.
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
