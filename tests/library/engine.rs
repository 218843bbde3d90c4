//! The run as a library: at which block a goal ends it, what sinks and progress observers receive,
//! and how an error ends it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use stickslip::config::Override;
use stickslip::engine::{
    EndedBy, Hopeless, Memory, MissedGoal, Outcome, Progress, Run, RunError, Sink, SinkError,
    Status,
};
use stickslip::ensemble::BLOCK_SIZE;
use stickslip::noise::AddressedDraws;
use stickslip::scenario::Scenario;
use stickslip::stats::{BlockResult, Goal, PathMeans, PathState, Statistic, Tally, Verdict};
use stickslip::sums::Measurement;
use stickslip_files::store::{FileSink, Unfinished};

fn scenario(paths: u64, set: &[&str]) -> Scenario {
    let mut all = vec!["time.end=20", "time.step=0.02", "time.output_step=5"];
    all.extend(set);
    let set: Vec<Override> = all
        .iter()
        .map(|text| Override::set(text).expect("well formed"))
        .collect();
    let text = stickslip::config::shipped("rho025").expect("shipped").text;
    let mut scenario = Scenario::parse("rho025", text, &set).expect("sound");
    scenario.ensemble.paths = paths;
    scenario
}

fn goal(text: &str) -> Goal {
    text.parse().expect("a goal")
}

/// Every estimate with all its digits. As text, a number that does not exist equals itself.
fn shown(outcome: &Outcome) -> String {
    format!("{:?}", outcome.summary.estimates)
}

#[test]
fn a_run_that_a_goal_ends_is_the_run_of_so_many_paths() {
    let scenario = scenario(100 * BLOCK_SIZE, &[]);
    let until = || {
        vec![
            goal("stick_duration_mean < 1%"),
            goal("sticks_per_path < 0.02"),
        ]
    };
    let ended = Run::of(&scenario)
        .until(until())
        .threads(2)
        .simulate()
        .expect("no sink");
    let Some(EndedBy::Goals { blocks, goals }) = &ended.ended_by else {
        panic!("{:?}", ended.ended_by)
    };
    assert_eq!(
        (ended.status, goals.len(), ended.missed.len()),
        (Status::Ended, 2, 0)
    );
    assert_eq!(ended.summary.completed_paths, blocks * BLOCK_SIZE);
    assert!((5..90).contains(blocks), "{blocks}");
    let fixed = Run::of(&scenario)
        .paths(blocks * BLOCK_SIZE)
        .threads(3)
        .simulate()
        .expect("no sink");
    assert_eq!(fixed.status, Status::Complete);
    assert_eq!(shown(&fixed), shown(&ended));
    // With one block less, both goals would not be reached.
    let short = Run::of(&scenario)
        .paths((blocks - 1) * BLOCK_SIZE)
        .until(until())
        .simulate()
        .expect("no sink");
    assert_eq!(short.status, Status::Complete);
    assert!(
        !short.missed.is_empty()
            && short
                .missed
                .iter()
                .all(|missed| missed.paths_needed() > Some(missed.paths))
    );
}

/// 2560 paths with twice the permitted error need four times as many, and 5 % more: 10752, which
/// are 42 blocks.
#[test]
fn paths_needed_grow_with_the_square_of_the_error() {
    let missed = MissedGoal {
        goal: goal("stick_duration_mean < 0.1"),
        paths: 2560,
        verdict: Verdict::Ahead(4.0),
    };
    assert_eq!(missed.paths_needed(), Some(42 * BLOCK_SIZE));
}

#[test]
fn a_goal_that_cannot_be_reached_ends_the_run_and_says_why() {
    let no_slip = scenario(
        1 << 20,
        &["friction.static=1e6", "time.end=1", "time.output_step=1"],
    );
    let outcome = Run::of(&no_slip)
        .until(vec![goal("stick_duration_mean < 1%")])
        .simulate()
        .expect("no sink");
    let Some(EndedBy::Hopeless(Hopeless::Missing { statistic, paths })) = outcome.ended_by else {
        panic!()
    };
    assert_eq!(
        (statistic, paths),
        (Statistic::StickDurationMean, 64 * BLOCK_SIZE)
    );
    let far = scenario(1 << 20, &["time.end=1", "time.output_step=1"]);
    let outcome = Run::of(&far)
        .until(vec![goal("displacement_end_mean < 1e-9")])
        .simulate()
        .expect("no sink");
    assert!(
        matches!(outcome.ended_by, Some(EndedBy::Hopeless(Hopeless::TooFar { needed, .. })) if needed > 1e12)
    );
}

/// A goal that any number of paths reaches is checked after four blocks, and not before, because
/// the standard error of fewer paths is itself not known well enough. The goal is in fact reached
/// after the first block, so it is the time of the check that ends the run after four.
#[test]
fn a_goal_is_first_looked_at_after_four_blocks() {
    let scenario = scenario(20 * BLOCK_SIZE, &[]);
    let until = || vec![goal("sticks_per_path < 50%")];
    let one = Run::of(&scenario)
        .paths(BLOCK_SIZE)
        .until(until())
        .without_bias()
        .simulate()
        .expect("no sink");
    assert_eq!((one.status, one.missed.len()), (Status::Complete, 0));
    for threads in [1, 3] {
        let run = Run::of(&scenario)
            .until(until())
            .threads(threads)
            .without_bias();
        let ended = run.simulate().expect("no sink");
        assert!(
            matches!(ended.ended_by, Some(EndedBy::Goals { blocks: 4, .. })),
            "{:?}",
            ended.ended_by
        );
        assert_eq!(ended.summary.completed_paths, 4 * BLOCK_SIZE);
    }
}

/// There are so many paths, 3e9 steps, that no machine simulates them in a tenth of a second, but
/// so few that a run without the limit would still end and fail the test.
#[test]
fn a_time_limit_ends_a_run_that_has_goals_as_well() {
    let scenario = scenario(12_000 * BLOCK_SIZE, &[]);
    let run = Run::of(&scenario).until(vec![goal("stick_duration_mean < 0.005%")]);
    let outcome = run
        .within(Some(Duration::from_millis(100)))
        .without_bias()
        .simulate()
        .expect("no sink");
    let Some(EndedBy::TimeLimit { blocks }) = outcome.ended_by else {
        panic!("{:?}", outcome.ended_by)
    };
    assert_eq!(outcome.summary.completed_paths, blocks * BLOCK_SIZE);
    assert_eq!((outcome.status, outcome.missed.len()), (Status::Ended, 1));
}

/// Keeps the progress that a run reports.
#[derive(Default)]
struct Reported(Vec<(u64, u64)>, usize);

impl Progress for Reported {
    fn paths(&mut self, done: u64, expected: u64) {
        self.0.push((done, expected));
    }

    fn estimating_bias(&mut self) {
        self.1 += 1;
    }
}

#[test]
fn progress_and_every_sink_see_each_block_once_and_in_order() {
    let scenario = scenario(5 * BLOCK_SIZE - 7, &[]);
    let (mut reported, mut one, mut two) =
        (Reported::default(), Memory::default(), Memory::default());
    let run = Run::of(&scenario)
        .threads(3)
        .with_progress(&mut reported)
        .into_sink(&mut one)
        .into_sink(&mut two);
    let outcome = run.simulate().expect("memory holds it");
    let firsts = |memory: &Memory| {
        memory
            .blocks
            .iter()
            .map(|block| block.rows.first_path)
            .collect::<Vec<_>>()
    };
    assert_eq!(firsts(&one), [0, 256, 512, 768, 1024]);
    assert_eq!(firsts(&two), firsts(&one));
    assert_eq!(
        reported.0,
        [256, 512, 768, 1024, 1273].map(|done| (done, 1273))
    );
    assert_eq!((reported.1, outcome.bias.absence.is_none()), (1, true));
    let columns = one
        .blocks
        .iter()
        .filter_map(|block| block.rows.path_columns.as_ref());
    let ends: Vec<f64> = columns
        .flat_map(|columns| columns.displacement_end.clone())
        .collect();
    let mean = ends.iter().sum::<f64>() / ends.len() as f64;
    let estimate = outcome
        .summary
        .estimate(Statistic::DisplacementEndMean)
        .estimate;
    // Both numbers are sums of 1273 numbers below 20, in different orders.
    assert!((mean - estimate).abs() < 1e-12, "{mean} {estimate}");
}

/// A sink that accepts two blocks and then fails.
struct Full(usize);

#[derive(Debug, thiserror::Error)]
#[error("no room for a third block")]
struct NoRoom;

impl Sink for Full {
    fn block(&mut self, _: &BlockResult) -> Result<(), SinkError> {
        self.0 += 1;
        if self.0 > 2 {
            Err(Box::new(NoRoom))
        } else {
            Ok(())
        }
    }

    fn finish(&mut self, _: &Outcome) -> Result<(), SinkError> {
        panic!("a run that failed has no outcome")
    }
}

#[test]
fn the_first_error_of_a_sink_ends_the_run() {
    let scenario = scenario(50 * BLOCK_SIZE, &[]);
    let (mut before, mut full) = (Memory::default(), Full(0));
    let error = Run::of(&scenario)
        .threads(2)
        .into_sink(&mut before)
        .into_sink(&mut full)
        .simulate()
        .unwrap_err();
    let RunError::Sink { error, outcome } = error else {
        panic!("{error}")
    };
    assert!(outcome.expect("it had begun").summary.completed_paths > 0);
    assert!(error.downcast_ref::<NoRoom>().is_some());
    assert_eq!((before.blocks.len(), full.0), (3, 3));
}

#[test]
fn a_raised_flag_leaves_the_first_blocks() {
    struct StopAfter<'a>(&'a AtomicBool);
    impl Progress for StopAfter<'_> {
        fn paths(&mut self, done: u64, _: u64) {
            if done >= 3 * BLOCK_SIZE {
                self.0.store(true, Ordering::Relaxed);
            }
        }
    }
    let scenario = scenario(1000 * BLOCK_SIZE, &[]);
    let stop = AtomicBool::new(false);
    let mut progress = StopAfter(&stop);
    let outcome = Run::of(&scenario)
        .threads(2)
        .stopped_by(&stop)
        .with_progress(&mut progress)
        .simulate()
        .expect("no sink");
    let blocks = outcome.summary.completed_paths / BLOCK_SIZE;
    assert_eq!(outcome.status, Status::Interrupted);
    // Each of two threads may be eight blocks ahead.
    assert!((3..=3 + 2 * 8).contains(&blocks), "{blocks}");
    let whole = Run::of(&scenario)
        .paths(blocks * BLOCK_SIZE)
        .without_bias()
        .simulate()
        .expect("no sink");
    assert_eq!(shown(&whole), shown(&outcome));
}

/// A statistic that panics at the path which ends with this displacement.
struct Planned(f64);

impl Tally<1> for Planned {
    type Path = ();

    fn start(&self, _: AddressedDraws) {}

    fn row(&self, (): &mut (), state: PathState) {
        assert!(state.displacement != self.0, "planned");
    }

    fn end(&self, (): (), _: PathState) -> [f64; 1] {
        [0.0]
    }

    fn estimate(&self, paths: &PathMeans<1>) -> Measurement {
        paths.mean(0)
    }
}

/// What a panic leaves of a run is what Ctrl-C leaves: the blocks before are saved, and the run that
/// is continued from there has the bits of one that was never interrupted.
#[test]
fn a_panic_of_a_thread_keeps_the_blocks_before() {
    let (scenario, folder) = (
        scenario(5 * BLOCK_SIZE, &["record.paths=true", "record.events=true"]),
        tempfile::tempdir().expect("a folder"),
    );
    let target = |name: &str| folder.path().join(name);
    let ends = scenario
        .plan()
        .replay(3 * BLOCK_SIZE + 17)
        .rows
        .path_columns
        .expect("they are recorded");
    let planned = Planned(ends.displacement_end[0]);
    for threads in [1, 2] {
        let file = target(&format!("{threads}.h5"));
        let mut sink = FileSink::new(&file, false);
        let failed = Run::of(&scenario)
            .threads(threads)
            .into_sink(&mut sink)
            .tallied(&planned)
            .map(drop);
        let Err(RunError::Flaw { flaw, outcome }) = failed else {
            panic!("{failed:?}")
        };
        assert_eq!(flaw.message, "planned");
        assert_eq!(flaw.doing, "in the simulation of paths 768 to 1023");
        assert!(flaw.place.starts_with("tests/library/engine.rs:"), "{flaw}");
        assert_eq!(
            (outcome.status, outcome.summary.completed_paths),
            (Status::Interrupted, 3 * BLOCK_SIZE)
        );
        drop(sink);
        let left = FileSink::go_on(&file, false)
            .expect("it is saved")
            .expect("it is not finished");
        let Unfinished {
            question,
            so_far,
            mut sink,
        } = left;
        assert_eq!(sink.saved_paths(), 3 * BLOCK_SIZE);
        let whole = Run::of(&scenario)
            .asked(question.asked)
            .into_sink(&mut sink)
            .go_on(so_far)
            .expect("it goes on");
        let uncut = Run::of(&scenario).simulate().expect("no sink");
        assert_eq!(shown(&whole), shown(&uncut));
    }
}

/// A body that a spring drags at the speed V sticks and slips about the end of the spring with the
/// amplitude A = sqrt(((f_s - f_d)/K)^2 + m V^2/K): a slip begins at f_s/K with the speed V, and
/// swings about f_d/K.
#[test]
fn the_cycle_of_a_dragged_body_has_its_closed_amplitude() {
    let text = "oscillator = { mass = 1, stiffness = 1, dilatation = 1 }
        friction = { static = 1.2, dynamic = 1 }
        temperature.trend = 0.3
        initial.displacement = 0
        time.end = 100
        scheme.kind = \"event-driven\"
        ensemble.paths = 1";
    let scenario = Scenario::parse("dragged", text, &[]).expect("sound");
    let run = Run::of(&scenario).simulate().expect("no sink");
    let cycle = run.summary.cycle.expect("one path without noise");
    let wanted = 0.2_f64.hypot(0.3);
    assert!(
        (cycle.amplitude - wanted).abs() < 1e-6,
        "{}",
        cycle.amplitude
    );
}

/// The body starts where the spring and T(0) balance, and a scene without periods compares x ten
/// times in its counted time.
#[test]
fn a_start_and_a_period_that_are_not_given_follow_from_the_rest() {
    let text = "oscillator = { mass = 1, stiffness = 2, dilatation = 3 }
        friction = { static = 1.2, dynamic = 1 }
        temperature = { offset = 0.5, trend = 0.1 }
        initial.displacement = \"balanced\"
        time.end = 120
        statistics.after = 20
        scheme.kind = \"event-driven\"";
    let scenario = Scenario::parse("balanced", text, &[]).expect("sound");
    assert_eq!(scenario.model.initial_displacement, 1.5);
    assert_eq!(scenario.period().map(|period| period.length), Some(10.0));
}
