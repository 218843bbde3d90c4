//! Simulating the points of a sweep: the blocks of paths of all points share one set of threads.
//!
//! The work is one list of pieces, point after point: the blocks of a point, then its bias
//! estimate. Threads take pieces from this list as they become free, so no thread is idle at a
//! point with few paths or at the end of a point. Pieces are delivered in order, and the sums of a
//! point are formed along the same tree as in a run.

use super::{Point, Sweep, SweepQuestion};
use crate::bias::{AuxiliaryRun, NoBias};
use crate::engine::Progress;
use crate::ensemble::{BLOCK_SIZE, Delivered, Plan, in_order_while};
use crate::scenario::{Ensemble, Scenario};
use crate::scheme::Simulate as _;
use crate::stats::{
    AuxiliaryObserver as _, BlockResult, Grouping, Groups, LimitCycle, Record, RunTotals,
};
use crate::study::clock::thread_seconds;
use crate::sums::{Overlap, Replicate};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Simulates a sweep. Set its fields, then call [`SweepSimulation::run`].
pub struct SweepSimulation<'a> {
    /// Number of threads; no bit of the results depends on it.
    pub threads: usize,
    /// When raised, no further pieces are begun. A point that is not complete by then is left out.
    pub stop: &'a AtomicBool,
    /// Receives the number of paths that are done.
    pub progress: &'a mut dyn Progress,
    /// Receives the number of a point and each of its blocks in order, with events. The sweep ends
    /// when it breaks.
    pub blocks: Option<BlockReceiver<'a>>,
}

/// See [`SweepSimulation::blocks`].
pub type BlockReceiver<'a> = &'a mut (dyn FnMut(usize, &BlockResult) -> ControlFlow<()> + Send);

/// Why a sweep ended before its last point.
#[derive(Debug, thiserror::Error)]
pub enum SweepEnd<E> {
    /// The function that receives the finished points failed.
    #[error(transparent)]
    Receiver(E),
    /// A block was delivered twice, which is a bug in this program.
    #[error("internal error: {0}")]
    Overlap(#[from] Overlap),
}

/// A point that has to be simulated.
struct Job<'a> {
    point: usize,
    scenario: &'a Scenario,
    /// The number of its first piece in the list of all pieces.
    first: u64,
    blocks: u64,
    has_bias: bool,
    has_events: bool,
    /// Created with the first piece of the point, and dropped after its last.
    setup: Mutex<Option<Arc<PointSetup>>>,
}

impl Job<'_> {
    fn setup(&self) -> Arc<PointSetup> {
        let mut setup = self.setup.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(
            setup.get_or_insert_with(|| Arc::new(PointSetup::of(self.scenario, self.has_events))),
        )
    }

    fn drop_setup(&self) {
        *self.setup.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// Piece number k of the point: a block, or its bias estimate after the last one. `None` if a
    /// block was stopped.
    fn make(&self, k: u64, stop: &AtomicBool) -> Option<Made> {
        if k < self.blocks {
            let setup = self.setup();
            return Some(Made::Block(Box::new(setup.plan.block_with_auxiliary(
                k,
                &setup.grouping,
                stop,
            )?)));
        }
        let plan = self.scenario.bias_plan(self.scenario.ensemble.paths);
        Some(Made::Bias(Box::new(
            plan.and_then(|plan| plan.simulate(1, stop)),
        )))
    }

    /// The sums before the first piece.
    fn nothing_yet(&self) -> Growing {
        let setup = self.setup();
        let (model, timeline) = (setup.plan.model(), setup.plan.timeline());
        Growing {
            totals: RunTotals::with(setup.grouping.empty(), model, timeline, &setup.plan.record),
            seconds: 0.0,
        }
    }
}

/// The points that are not done, and the number of their pieces.
fn jobs<'a>(
    question: &'a SweepQuestion,
    done: &[Option<Point>],
    has_events: bool,
) -> (Vec<Job<'a>>, u64) {
    let mut jobs: Vec<Job> = Vec::new();
    let mut pieces = 0;
    for (point, scenario) in question
        .points
        .iter()
        .enumerate()
        .filter(|(i, _)| done[*i].is_none())
    {
        let blocks = scenario.ensemble.paths.div_ceil(BLOCK_SIZE);
        let has_bias = question.with_bias && scenario.bias_plan(scenario.ensemble.paths).is_ok();
        jobs.push(Job {
            point,
            scenario,
            first: pieces,
            blocks,
            has_bias,
            has_events,
            setup: Mutex::new(None),
        });
        pieces += blocks + u64::from(has_bias);
    }
    (jobs, pieces)
}

/// The data that all pieces of a point share.
struct PointSetup {
    plan: Plan,
    grouping: Grouping,
}

impl PointSetup {
    fn of(scenario: &Scenario, has_events: bool) -> Self {
        // The output grid is omitted, because it is not stored and no event depends on it.
        let timeline = scenario.timeline().without_rows();
        let simulation = scenario.scheme.simulation(&scenario.model, &timeline);
        let Ensemble {
            paths,
            seed,
            antithetic,
        } = scenario.ensemble;
        let unit = if antithetic {
            Replicate::Pair
        } else {
            Replicate::Path
        };
        let record = Record {
            events: has_events,
            ..scenario.record.of_no_path()
        };
        let grouping = Grouping::new(simulation.model(), simulation.timeline(), &record, unit);
        PointSetup {
            plan: Plan {
                simulation,
                record,
                seed,
                paths,
                antithetic,
            },
            grouping,
        }
    }
}

/// A finished piece of work, with the CPU seconds that it took.
struct JobDone {
    job: usize,
    seconds: f64,
    made: Made,
}

enum Made {
    Block(Box<Delivered<Groups>>),
    Bias(Box<Result<AuxiliaryRun, NoBias>>),
}

/// The sums of the point whose pieces are being delivered.
struct Growing {
    totals: RunTotals<Groups>,
    seconds: f64,
}

impl SweepSimulation<'_> {
    /// Simulate all points of a sweep that are not done, and call `receive` after each point.
    /// Fails if `receive` fails.
    pub fn run<E: Send>(
        self,
        sweep: &mut Sweep,
        mut receive: impl FnMut(&Sweep) -> Result<(), E> + Send,
    ) -> Result<(), SweepEnd<E>> {
        let SweepSimulation {
            threads,
            stop,
            progress,
            mut blocks,
        } = self;
        let question = sweep.question.clone();
        let (jobs, pieces) = jobs(&question, &sweep.points, blocks.is_some());
        let paths = jobs.iter().map(|job| job.scenario.ensemble.paths).sum();
        let make = |index: u64| {
            let start = thread_seconds();
            let job = jobs.partition_point(|job| job.first <= index) - 1;
            let made = jobs[job].make(index - jobs[job].first, stop)?;
            Some(JobDone {
                job,
                seconds: thread_seconds() - start,
                made,
            })
        };
        let mut growing: Option<Growing> = None;
        let mut done = 0;
        let deliver = |piece: JobDone| -> Result<ControlFlow<()>, SweepEnd<E>> {
            let job = &jobs[piece.job];
            let here = growing.get_or_insert_with(|| job.nothing_yet());
            here.seconds += piece.seconds;
            let mut auxiliary_run = None;
            match piece.made {
                Made::Block(block) => {
                    let Delivered {
                        index,
                        result,
                        auxiliary_sums,
                    } = *block;
                    done += result.rows.paths;
                    progress.paths(done, paths);
                    if let Some(blocks) = &mut blocks
                        && blocks(job.point, &result).is_break()
                    {
                        return Ok(ControlFlow::Break(()));
                    }
                    here.totals
                        .push_with(index, result.totals, auxiliary_sums)?;
                    if job.has_bias || index + 1 < job.blocks {
                        return Ok(ControlFlow::Continue(()));
                    }
                }
                Made::Bias(made) => match *made {
                    Err(_) if stop.load(Ordering::Relaxed) => return Ok(ControlFlow::Break(())),
                    made => auxiliary_run = made.ok(),
                },
            }
            let Some(here) = growing.take() else {
                return Ok(ControlFlow::Continue(()));
            };
            sweep.points[job.point] = Some(here.point(job.scenario, auxiliary_run));
            job.drop_setup();
            receive(sweep).map_err(SweepEnd::Receiver)?;
            Ok(ControlFlow::Continue(()))
        };
        in_order_while(pieces, threads, stop, make, deliver)?;
        Ok(())
    }
}

impl Growing {
    fn point(self, scenario: &Scenario, auxiliary_run: Option<AuxiliaryRun>) -> Point {
        let start = thread_seconds();
        let Growing { totals, seconds } = self;
        let run = totals.totals();
        let mut summary = run.summary();
        if let Some(auxiliary_run) = auxiliary_run {
            summary.set_biases(&auxiliary_run.of(&summary));
        }
        let without = totals.own().without(&run);
        Point {
            completed_paths: summary.completed_paths,
            diverged_paths: summary.diverged.len() as u64,
            estimates: summary.estimates,
            cycle: LimitCycle::of(scenario),
            seconds: seconds + (thread_seconds() - start),
            without,
        }
    }
}
