//! A run has the same bits however it is cut into parts, and in whatever order the parts are
//! simulated.

use proptest::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;
use stickslip::config::Override;
use stickslip::engine::Run;
use stickslip::ensemble::{BLOCK_SIZE, Plan, Stops};
use stickslip::model::{Event, EventKind};
use stickslip::noise::AddressedDraws;
use stickslip::scenario::Scenario;
use stickslip::scheme::DiscreteVi;
use stickslip::stats::{
    AuxiliaryObserver, BlockResult, PathMeans, PathState, RunTotals, Statistic, Summary, Tallied,
    Tally,
};
use stickslip::sums::Measurement;

const BLOCKS: u64 = 23;

/// A scene with noise, seven forcing periods, a burn-in of more than one of them, and 31 rows. The
/// last block is not full.
fn scenario() -> Scenario {
    let set = [
        "time.end=60",
        "time.step=0.05",
        "time.output_step=2",
        "record.paths=false",
        "statistics.after=10",
        "temperature.harmonics.0.angular_frequency=0.8",
    ];
    let set: Vec<Override> = set
        .iter()
        .map(|text| Override::set(text).expect("well formed"))
        .collect();
    let text = stickslip::config::shipped("rho025").expect("shipped").text;
    let mut scenario = Scenario::parse("rho025", text, &set).expect("sound");
    scenario.ensemble.paths = BLOCKS * BLOCK_SIZE - 100;
    scenario
}

fn plan() -> &'static Plan {
    static PLAN: OnceLock<Plan> = OnceLock::new();
    PLAN.get_or_init(|| scenario().plan())
}

fn blocks() -> &'static [BlockResult] {
    static SIMULATED: OnceLock<Vec<BlockResult>> = OnceLock::new();
    SIMULATED.get_or_init(|| (0..BLOCKS).map(|k| plan().block(k)).collect())
}

fn empty() -> RunTotals {
    RunTotals::empty(plan().model(), plan().timeline(), &plan().record)
}

/// Every number of a summary as bits, so that NaN equals NaN, and 0 does not equal -0.
fn bits(summary: &Summary) -> Vec<u64> {
    let mut all = vec![summary.completed_paths];
    all.extend(&summary.diverged);
    for e in &summary.estimates {
        all.extend([e.estimate, e.standard_error, e.low, e.high].map(f64::to_bits));
    }
    let bands = &summary.bands;
    let mut curves = vec![&bands.static_probability_ends];
    for band in [&bands.displacement, &bands.velocity, &bands.temperature] {
        all.extend(
            band.mean
                .iter()
                .chain(&band.sd)
                .chain(&band.quantiles)
                .map(|x| x.to_bits()),
        );
        curves.extend([&band.mean_ends, &band.sd_ends, &band.quantile_ends]);
    }
    all.extend(bands.static_probability.iter().map(|x| x.to_bits()));
    all.extend(
        summary
            .periods
            .mean
            .iter()
            .chain(&summary.periods.variance)
            .map(|x| x.to_bits()),
    );
    let transient = summary.transient.expect("a burn-in");
    all.extend([transient.sticks, transient.slips]);
    all.extend([transient.displacement.estimate, transient.displacement.high].map(f64::to_bits));
    let (sticks, first) = (&summary.stick_durations, &summary.first_sticks);
    all.extend(
        sticks
            .histogram
            .counts
            .iter()
            .chain(&sticks.censored_counts),
    );
    all.extend(
        sticks
            .survival
            .iter()
            .chain(&sticks.quantiles)
            .chain(&sticks.histogram.edges)
            .map(|x| x.to_bits()),
    );
    let (periods, phases) = (&summary.periods, &summary.sub_phases);
    all.extend(&phases.counts);
    all.extend(phases.shares.iter().map(|x| x.to_bits()));
    curves.extend([&sticks.survival_ends, &sticks.quantile_ends]);
    curves.extend([
        &phases.share_ends,
        &periods.mean_ends,
        &periods.variance_ends,
    ]);
    all.extend(
        curves
            .iter()
            .flat_map(|ends| ends.low.iter().chain(&ends.high))
            .map(|x| x.to_bits()),
    );
    all.extend([
        sticks.completed,
        sticks.censored,
        first.completed,
        first.censored,
        phases.censored,
    ]);
    all
}

fn whole() -> &'static [u64] {
    static WHOLE: OnceLock<Vec<u64>> = OnceLock::new();
    WHOLE.get_or_init(|| {
        bits(
            &Run::of(&scenario())
                .threads(1)
                .without_bias()
                .simulate()
                .expect("no sink")
                .summary,
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Contiguous parts, completed in a random order, some of them written as bytes and read back.
    #[test]
    fn parts_in_any_order_come_to_the_bits_of_the_whole_run(
        cuts in prop::collection::vec(0..=BLOCKS, 0..7),
        order in prop::collection::vec(any::<u32>(), 8),
        through_bytes in prop::collection::vec(any::<bool>(), 8),
    ) {
        let mut ends = cuts;
        ends.extend([0, BLOCKS]);
        ends.sort_unstable();
        let mut parts: Vec<(u32, RunTotals)> = ends.windows(2).zip(&order).map(|(cut, &rank)| {
            let mut part = empty();
            (cut[0]..cut[1]).for_each(|k| part.push(k, blocks()[k as usize].totals.clone()).expect("each block once"));
            (rank, part)
        }).collect();
        parts.sort_by_key(|(rank, _)| *rank);
        let mut joined = empty();
        for ((_, part), through_bytes) in parts.into_iter().zip(through_bytes) {
            let part = if through_bytes { empty().read(&part.to_bytes()).expect("as written") } else { part };
            joined.merge(part).expect("the parts do not overlap");
        }
        prop_assert_eq!(joined.blocks(), vec![0..BLOCKS]);
        prop_assert_eq!(bits(&joined.totals().summary()), whole());
        // A goal is judged by the same numbers that the end of the run reports.
        for statistic in Statistic::ALL {
            let (early, late) = (joined.estimate(statistic), joined.totals().estimate(statistic));
            prop_assert_eq!([early.estimate, early.low].map(f64::to_bits), [late.estimate, late.low].map(f64::to_bits));
        }
    }
}

#[test]
fn any_number_of_threads_comes_to_the_same_bits() {
    let scenario = scenario();
    for threads in [1, 2, 3, 8, 17, 32] {
        let outcome = Run::of(&scenario)
            .threads(threads)
            .without_bias()
            .simulate()
            .expect("no sink");
        assert_eq!(bits(&outcome.summary), whole(), "{threads} threads");
    }
}

/// Counts the slips of a path, and sums the squares of the times at which they begin.
struct Slips;

impl Tally<2> for Slips {
    type Path = [f64; 2];

    fn start(&self, _: AddressedDraws) -> [f64; 2] {
        [0.0; 2]
    }

    fn event(&self, [count, squares]: &mut [f64; 2], event: &Event) {
        if let EventKind::SlipStarted(_) = event.kind {
            *count += 1.0;
            *squares += event.time * event.time;
        }
    }

    fn end(&self, path: [f64; 2], _: PathState) -> [f64; 2] {
        path
    }

    fn estimate(&self, paths: &PathMeans<2>) -> Measurement {
        paths.ratio(1, 0)
    }
}

/// A tally of one's own counts the slips that begin in each path. It must agree with the statistics
/// of the program: completed slips plus slips that are cut off at the end. If no slip is cut off,
/// the standard error agrees as well; the interval of the program is symmetric on another scale.
#[test]
fn a_tally_has_the_same_bits_in_parallel_and_sees_all_events() {
    struct Count;
    impl Tally<1> for Count {
        type Path = f64;

        fn start(&self, _: AddressedDraws) -> f64 {
            0.0
        }

        fn event(&self, slips: &mut f64, event: &Event) {
            *slips += f64::from(u8::from(event.kind == EventKind::StickEntered));
        }

        fn end(&self, slips: f64, _: PathState) -> [f64; 1] {
            [slips]
        }

        fn estimate(&self, paths: &PathMeans<1>) -> Measurement {
            paths.mean(0)
        }
    }
    let scenario = scenario();
    // A tally includes the burn-in, unlike the statistics of the program.
    let mut whole = scenario.clone();
    whole.statistics.after = 0.0;
    let (outcome, own) = Run::of(&whole)
        .threads(2)
        .without_bias()
        .tallied(&Count)
        .expect("no sink");
    let program = outcome.summary.estimate(Statistic::SlipsPerPath);
    assert_eq!(own.estimate.to_bits(), program.estimate.to_bits());
    assert_eq!(
        own.standard_error.to_bits(),
        program.standard_error.to_bits()
    );

    let ratio = |threads| {
        Run::of(&scenario)
            .threads(threads)
            .without_bias()
            .tallied(&Slips)
            .expect("no sink")
            .1
    };
    let one = ratio(1);
    assert!(one.low < one.estimate && one.estimate < one.high);
    assert_eq!(ratio(7), one);
    // The same in parts that are joined along the tree.
    let tallied = Tallied {
        tally: &Slips,
        seed: scenario.ensemble.seed,
    };
    let mut joined = RunTotals::with(
        tallied.empty(),
        plan().model(),
        plan().timeline(),
        &plan().record,
    );
    let deliver = |block: stickslip::ensemble::Delivered<PathMeans<2>>| {
        joined.push_with(block.index, block.result.totals, block.auxiliary_sums)?;
        Ok::<_, stickslip::sums::Overlap>(std::ops::ControlFlow::Continue(()))
    };
    let never = AtomicBool::new(false);
    let stops = Stops {
        stop: &never,
        halt: &never,
    };
    plan()
        .run_beside(&tallied, 0..BLOCKS, 2, stops, deliver)
        .expect("each block once");
    assert_eq!(Slips.estimate(&joined.own()), one);
}

/// The size of a state is as documented. The nodes of the tree are counted after 2^k - 1 blocks,
/// when every level holds one. What is counted exactly, in one copy whatever the number of blocks,
/// is measured after so many paths that all of it is in bins.
#[test]
fn the_state_of_a_run_is_as_small_as_promised() {
    for (rows, node_bytes, exact_bytes) in
        [(121_u64, 10_000, 6_500_000), (10_000, 760_000, 65_000_000)]
    {
        let mut scenario = scenario();
        scenario.time.output_step = scenario.time.end / (rows - 1) as f64;
        scenario.scheme = DiscreteVi {
            step: scenario.time.output_step,
        }
        .into();
        let plan = scenario.plan();
        assert_eq!(plan.timeline().rows() as u64, rows);
        let empty = || RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
        let state = |blocks: u64| {
            let mut totals = empty();
            let nothing =
                || stickslip::stats::Totals::empty(plan.model(), plan.timeline(), &plan.record);
            (0..blocks).for_each(|k| totals.push(k, nothing()).expect("each block once"));
            totals.to_bytes().len()
        };
        let (one, all) = (state(1), state(127));
        let node = (all - one) / 6;
        println!("{rows} rows: a node takes {node} bytes");
        assert!(node <= node_bytes, "{rows}: {node}");

        let mut totals = empty();
        for k in 0..16 {
            totals
                .push(k, plan.block(k).totals)
                .expect("each block once");
            if [1, 4, 16].contains(&(k + 1)) {
                let nodes = (k + 1).count_ones() as usize;
                let exact = totals.to_bytes().len() - nodes * node;
                println!(
                    "{rows} rows, {} paths: what is counted exactly takes {exact} bytes",
                    (k + 1) * BLOCK_SIZE
                );
                assert!(exact <= exact_bytes, "{rows}: {exact}");
            }
        }
    }
}
