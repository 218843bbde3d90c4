//! The run itself: its options, its beginning and its end. [`super::course`] is the part in
//! between.

use super::alarm::Alarm;
use super::course::{Course, Elapsed};
use super::ending::Endings;
use super::{Asked, BiasReport, EndedBy, Outcome, Part, Progress, RunError, Sink, Status};
use crate::bias::NoBias;
use crate::ensemble::{Flaw, MOST_THREADS, Plan, check_threads, guarded};
use crate::model::Problem;
use crate::scenario::Scenario;
use crate::scheme::{CheckError, Scheme};
use crate::stats::{
    AuxiliaryObserver, Goal, LimitCycle, Record, RunTotals, Summary, Tallied, Tally,
};
use crate::sums::{Measurement, Merge};
use std::borrow::Cow;
use std::mem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A run of a scenario, set up by the methods below and started by [`Run::simulate`].
///
/// The outcome is a function of the scenario and of the options of the run: its bits do not depend
/// on threads, progress or sinks. Only a time limit and a stop by the caller depend on the machine.
/// They end a run after some block, and the outcome contains the number of its paths.
///
/// ```
/// use stickslip::engine::Run;
/// use stickslip::scenario::Scenario;
/// use stickslip::stats::Statistic;
///
/// let mut scenario = Scenario::shipped("rho025")?;
/// scenario.ensemble.paths = 1_000;
/// let outcome = Run::of(&scenario).threads(2).simulate()?;
/// let mean = outcome.summary.estimate(Statistic::StickDurationMean);
/// assert!(mean.low < mean.estimate && mean.estimate < mean.high);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Run<'a> {
    scenario: Cow<'a, Scenario>,
    asked: Asked,
    threads: usize,
    stop: Option<&'a AtomicBool>,
    progress: Option<&'a mut dyn Progress>,
    sinks: Vec<&'a mut dyn Sink>,
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

impl Run<'_> {
    /// A run of this model until t = 0: [`Run::end`] sets its end, and the methods below what else
    /// differs from [`Scenario::new`].
    ///
    /// ```
    /// use stickslip::prelude::*;
    ///
    /// let model = Problem::oscillator(1.0, 1.0)
    ///     .dilatation(6.0)
    ///     .friction(1.2, 1.0)
    ///     .temperature(Temperature::harmonic(1.0, 0.25).with(OrnsteinUhlenbeck::new(0.25, 1.0, 1.0)))
    ///     .force(|x, _v, _t| -0.02 * x.powi(3))
    ///     .start(6.0, 0.0);
    /// let outcome = Run::new(model).scheme(EventDriven::default()).paths(500).end(20.0).seed(1).simulate()?;
    /// println!("{}", outcome[Statistic::StickDurationMean]);
    /// assert!(Run::new(Problem::free(-1.0)).end(1.0).simulate().is_err());
    /// # Ok::<(), RunError>(())
    /// ```
    pub fn new(model: Problem) -> Self {
        Run::with(Cow::Owned(Scenario::new(model, 0.0)))
    }
}

impl<'a> Run<'a> {
    /// A run of all paths of the scenario, on one thread for each core, with an estimate of the
    /// bias of the step.
    pub fn of(scenario: &'a Scenario) -> Self {
        Run::with(Cow::Borrowed(scenario))
    }

    fn with(scenario: Cow<'a, Scenario>) -> Self {
        Run {
            asked: Asked {
                with_bias: true,
                ..Asked::paths(scenario.ensemble.paths)
            },
            threads: std::thread::available_parallelism()
                .map_or(1, usize::from)
                .min(MOST_THREADS),
            stop: None,
            progress: None,
            sinks: Vec::new(),
            scenario,
        }
    }

    /// The scenario of the run.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Choose the scheme, and an output grid of about 120 rows that suits it.
    pub fn scheme(mut self, scheme: impl Into<Scheme>) -> Self {
        let end = self.scenario.time.end;
        self.scenario.to_mut().set_span(end, scheme.into());
        self
    }

    /// Simulate until this time, on an output grid of about 120 rows.
    pub fn end(mut self, end: f64) -> Self {
        let scheme = self.scenario.scheme;
        self.scenario.to_mut().set_span(end, scheme);
        self
    }

    /// Set the seed.
    pub fn seed(mut self, seed: u64) -> Self {
        self.scenario.to_mut().ensemble.seed = seed;
        self
    }

    /// Set what is recorded of single paths.
    pub fn record(mut self, record: Record) -> Self {
        self.scenario.to_mut().record = record;
        self
    }

    /// The options of the run in addition to its scenario.
    pub fn question(&self) -> Asked {
        self.asked.clone()
    }

    /// Simulate on this many threads, 1 to [`MOST_THREADS`]. No bit of the results depends on this
    /// number.
    pub fn threads(self, threads: usize) -> Self {
        Run { threads, ..self }
    }

    /// Replace all options of the run by those with which it was begun.
    pub fn asked(self, asked: Asked) -> Self {
        Run { asked, ..self }
    }

    /// Simulate at most this many paths, whatever the number in the scenario. The number is rounded
    /// up to whole pairs if paths are antithetic.
    pub fn paths(mut self, paths: u64) -> Self {
        let is_paired = self.scenario.ensemble.antithetic;
        self.asked.paths = if is_paired {
            paths.next_multiple_of(2)
        } else {
            paths
        };
        if let Cow::Owned(scenario) = &mut self.scenario {
            scenario.ensemble.paths = self.asked.paths;
        }
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

    /// Limit the wall-clock time of the paths and the estimate of the bias together.
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

    /// End the run when this flag is set. Unfinished blocks then get a short time to be completed.
    pub fn stopped_by(self, stop: &'a AtomicBool) -> Self {
        Run {
            stop: Some(stop),
            ..self
        }
    }

    /// Report the progress of the run.
    pub fn with_progress(self, progress: &'a mut dyn Progress) -> Self {
        Run {
            progress: Some(progress),
            ..self
        }
    }

    /// Pass every finished block, and the outcome, to this sink. There may be several sinks.
    pub fn into_sink(mut self, sink: &'a mut dyn Sink) -> Self {
        self.sinks.push(sink);
        self
    }

    /// Values that were set in memory are checked; a scenario that is borrowed was checked before.
    fn check(&self) -> Result<(), CheckError> {
        match &self.scenario {
            Cow::Owned(scenario) => scenario.check_all(),
            Cow::Borrowed(_) => Ok(()),
        }
    }

    /// x and x' of one path of the ensemble at these times, between 0 and the end of the run, without
    /// its statistics, to about ten digits of the rows of a recorded path.
    ///
    /// ```
    /// use stickslip::prelude::*;
    ///
    /// let problem = Problem::oscillator(1.0, 1.0).start(1.0, 0.0);
    /// let [[x, v]] = Run::new(problem).end(4.0).motion(0, &[2.0])?[..] else { unreachable!() };
    /// assert!((x - 2f64.cos()).abs() + (v + 2f64.sin()).abs() < 1e-8);
    /// # Ok::<(), RunError>(())
    /// ```
    pub fn motion(&self, path: u64, times: &[f64]) -> Result<Vec<[f64; 2]>, RunError> {
        self.check()?;
        let plan = self.scenario.plan();
        let Some(motion) = plan.motion(path) else {
            let why = plan.why_lost(path, &AtomicBool::new(false));
            let why = why.map_or_else(|| "it diverges".to_string(), |why| why.to_string());
            return Err(RunError::Lost { path, why });
        };
        // Before the first segment and behind each, the body is at rest.
        let state = |time: &f64| {
            let next = motion.partition_point(|segment| segment.start <= *time);
            match next.checked_sub(1) {
                Some(last) => motion[last].state(*time),
                None => [plan.model().initial_displacement, 0.0],
            }
        };
        Ok(times.iter().map(state).collect())
    }

    /// Simulate the run.
    pub fn simulate(self) -> Result<Outcome, RunError> {
        self.check()?;
        let so_far = SoFar {
            totals: RunTotals::empty(
                &self.scenario.model,
                &self.scenario.timeline(),
                &self.scenario.record,
            ),
            spent: Duration::ZERO,
        };
        self.go_on(so_far)
    }

    /// Simulate the rest of a run. The outcome has the same bits as that of an uninterrupted run.
    pub fn go_on(self, so_far: SoFar) -> Result<Outcome, RunError> {
        Ok(self.simulate_beside(&(), so_far.totals, so_far.spent)?.0)
    }

    /// Simulate the run, and compute a user-defined statistic in addition to those of the program.
    pub fn tallied<T: Tally<N>, const N: usize>(
        self,
        tally: &T,
    ) -> Result<(Outcome, Measurement), RunError> {
        self.check()?;
        let tallied = Tallied {
            tally,
            seed: self.scenario.ensemble.seed,
        };
        let Scenario { model, record, .. } = &*self.scenario;
        let totals = RunTotals::with(tallied.empty(), model, &self.scenario.timeline(), record);
        let (outcome, means) = self.simulate_beside(&tallied, totals, Duration::ZERO)?;
        Ok((outcome, tally.estimate(&means)))
    }

    /// Simulate the blocks that `totals` do not contain, with an auxiliary that observes each of
    /// them.
    fn simulate_beside<C: AuxiliaryObserver>(
        mut self,
        auxiliary: &C,
        totals: RunTotals<C::Sums>,
        spent: Duration,
    ) -> Result<(Outcome, C::Sums), RunError> {
        check_threads(self.threads)?;
        let clock = Elapsed::after(spent);
        let endings = self.endings();
        let never = AtomicBool::new(false);
        let mut nobody = ();
        let stop = self.stop.unwrap_or(&never);
        let progress = self.progress.take().unwrap_or(&mut nobody);
        let left = [endings.time, self.asked.max_time]
            .map(|limit| limit.map(|limit| limit.saturating_sub(spent)));
        let alarm = Alarm::new(stop, left);
        let sinks = self.begin_sinks()?;
        let mut session = Session {
            run: &self,
            plan: self.asked.plan(&self.scenario),
            stop,
            alarm: &alarm,
            course: Course {
                asked: &self.asked,
                endings: &endings,
                halt: &alarm.halt,
                clock,
                progress,
                sinks,
                totals,
                ended_by: None,
                broken: None,
                is_taking: false,
            },
            flaw: None,
        };
        let blocks = session.simulate_blocks(auxiliary)?;
        let mut summary = session.course.totals.totals().summary();
        let bias = session.estimate_bias(&mut summary);
        session.finish(blocks, summary, bias)
    }

    /// Let the sinks begin, and take them.
    fn begin_sinks(&mut self) -> Result<Vec<&'a mut dyn Sink>, RunError> {
        let mut sinks = mem::take(&mut self.sinks);
        for sink in &mut sinks {
            sink.begin(&self.scenario, &self.asked)
                .map_err(|error| RunError::Sink {
                    error,
                    outcome: None,
                })?;
        }
        Ok(sinks)
    }

    fn endings(&self) -> Endings {
        let Asked {
            paths,
            goals,
            max_time,
            with_bias,
            ..
        } = &self.asked;
        let has_bias = *with_bias && max_time.is_some() && self.scenario.bias_plan(*paths).is_ok();
        let share = if has_bias { 1.0 + BIAS_SHARE } else { 1.0 };
        Endings {
            goals: goals.clone(),
            time: max_time.map(|time| time.div_f64(share)),
        }
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
        BiasReport {
            seconds: start.elapsed().as_secs_f64(),
            absence,
        }
    }
}

/// A run in this process, from the blocks that are left to the outcome.
struct Session<'r, 's, X> {
    run: &'r Run<'s>,
    plan: Plan,
    /// Set by the caller.
    stop: &'r AtomicBool,
    alarm: &'r Alarm<'r>,
    course: Course<'r, 's, X>,
    /// A panic, which ends the run as well.
    flaw: Option<Flaw>,
}

impl<X: Merge + Clone + Send> Session<'_, '_, X> {
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn has_failed(&self) -> bool {
        self.course.broken.is_some() || self.flaw.is_some()
    }

    fn is_whole(&self, blocks: u64) -> bool {
        blocks >= self.run.asked.blocks().end
    }

    /// Simulate the blocks that are left. Returns the end of those that are done.
    fn simulate_blocks<C: AuxiliaryObserver<Sums = X>>(
        &mut self,
        auxiliary: &C,
    ) -> Result<u64, RunError> {
        let left = self.course.left();
        let (plan, threads, alarm) = (&self.plan, self.run.threads, self.alarm);
        let course = &mut self.course;
        let done = alarm.watching(|| {
            let deliver = |block| course.deliver(block);
            guarded(|| plan.run_beside(auxiliary, left.clone(), threads, alarm.stops(), deliver))
        });
        let blocks = match done {
            Ok(done) => left.start + done?,
            Err(flaw) => {
                self.flaw = Some(flaw);
                self.course.done()
            }
        };
        if !self.is_whole(blocks)
            && self.course.ended_by.is_none()
            && !self.has_failed()
            && !self.is_stopped()
        {
            // The only remaining reason to give up blocks is the time limit.
            self.course.ended_by = Some(EndedBy::TimeLimit { blocks });
        }
        self.course.settle(blocks);
        Ok(blocks)
    }

    /// Estimate the bias of the step, if requested and nothing has failed.
    fn estimate_bias(&mut self, summary: &mut Summary) -> BiasReport {
        let asked = &self.run.asked;
        if self.has_failed() || !asked.with_bias || asked.part.is_some() {
            return BiasReport::default();
        }
        // The alarm checks the flag only from time to time, so it is checked here as well.
        let end = &self.alarm.end;
        end.fetch_or(self.is_stopped(), Ordering::Relaxed);
        let paths = summary.completed_paths;
        let progress = &mut *self.course.progress;
        let estimate = || self.run.add_bias(paths, end, progress, summary);
        match self.alarm.watching(|| guarded(estimate)) {
            Ok(report) => report,
            Err(flaw) => {
                self.flaw = Some(flaw);
                BiasReport::default()
            }
        }
    }

    fn status(&self, blocks: u64, bias: &BiasReport) -> Status {
        match self.course.ended_by {
            _ if self.has_failed()
                || bias.absence == Some(NoBias::Stopped) && self.is_stopped() =>
            {
                Status::Interrupted
            }
            Some(_) => Status::Ended,
            None if !self.is_whole(blocks) => Status::Interrupted,
            None if self.run.asked.part.is_some() => Status::Part,
            None => Status::Complete,
        }
    }

    /// Pass the outcome to the sinks, and return it.
    fn finish(
        self,
        blocks: u64,
        mut summary: Summary,
        bias: BiasReport,
    ) -> Result<(Outcome, X), RunError> {
        // It takes one more path, which an interrupted run does not simulate.
        if self.course.broken.is_none() && !self.is_stopped() {
            summary.cycle = LimitCycle::of(&self.run.scenario);
        }
        let status = self.status(blocks, &bias);
        let mut course = self.course;
        let ended_by = course.ended_by.take();
        let is_reached =
            status != Status::Interrupted && !matches!(ended_by, Some(EndedBy::Hopeless(_)));
        let missed = if is_reached {
            course
                .endings
                .missed(&course.totals, summary.completed_paths)
        } else {
            Vec::new()
        };
        let mut outcome = Outcome {
            summary,
            status,
            paths: self.plan.paths,
            part: self.run.asked.part,
            ended_by,
            missed,
            bias,
            threads: self.run.threads,
            seconds: course.clock.spent().as_secs_f64(),
            units: self.run.scenario.units.clone(),
        };
        course.finish(&outcome);
        outcome.seconds = course.clock.spent().as_secs_f64();
        match (course.broken, self.flaw) {
            (Some(error), _) => Err(RunError::Sink {
                error,
                outcome: Some(Box::new(outcome)),
            }),
            (None, Some(flaw)) => Err(RunError::Flaw {
                flaw,
                outcome: Box::new(outcome),
            }),
            (None, None) => Ok((outcome, course.totals.own())),
        }
    }
}
