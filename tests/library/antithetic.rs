//! Antithetic pairs: the paths of a pair, and intervals whose independent unit is the pair.
//!
//! Each statistical test states its null hypothesis, sample size and false-alarm rate, and has a
//! fixed seed.

use stickslip::ensemble::{BLOCK_SIZE, Plan};
use stickslip::model::Event;
use stickslip::noise::{AddressedDraws, LaneStreams, MAX_NORMAL_ERROR, MIRROR, Stream};
use stickslip::scenario::Scenario;
use stickslip::scheme::{
    CorrectedVi, DiscreteVi, Instant, Kind, Observer, Scheme, Simulate as _, Snapshot,
};
use stickslip::stats::{Record, RunTotals, Statistic, Summary};

/// The scenario `rho025` in antithetic pairs, with this scheme, up to this time.
fn scenario(scheme: impl Into<Scheme>, end: f64, paths: u64, seed: u64) -> Scenario {
    let mut scenario = Scenario::shipped("rho025").expect("shipped");
    (scenario.time.end, scenario.time.output_step) = (end, end / 4.0);
    scenario.ensemble.paths = paths;
    scenario.ensemble.seed = seed;
    scenario.ensemble.antithetic = true;
    scenario.with_scheme(scheme).expect("goes together")
}

fn of_kind(kind: Kind) -> Scheme {
    kind.with(if kind.has_step() { 0.01 } else { 1e-3 })
}

/// The random words y and -y - 1 differ from opposite numbers in one bit of 63, so they stand for
/// normals of opposite sign, up to twice the error of the normals.
#[test]
fn a_mirror_image_has_the_same_normals_with_the_other_sign() {
    for (seed, path) in [(1, 0), (7, 4710), (u64::MAX, 1 << 39)] {
        let [mut one, mut other] =
            [path, path | MIRROR].map(|path| AddressedDraws::new(seed, path));
        let [mut stream, mut mirrored] = [path, path | MIRROR].map(|path| Stream::new(seed, path));
        for _ in 0..1000 {
            let sums = [
                one.normal() + other.normal(),
                one.normal_pair()[1] + other.normal_pair()[1],
                stream.normal() + mirrored.normal(),
                stream.normal_pair()[1] + mirrored.normal_pair()[1],
            ];
            assert!(
                sums.iter().all(|sum| sum.abs() <= 2.0 * MAX_NORMAL_ERROR),
                "{sums:?}"
            );
            assert_eq!(one.uniform(), other.uniform());
            assert_eq!(stream.uniform(), mirrored.uniform());
        }
    }
}

/// The lanes of the kernel draw the same normals as the streams, for mirror images as well.
#[test]
fn lanes_draw_what_the_streams_of_mirror_images_draw() {
    let paths = [4, 4 | MIRROR, 6, 6 | MIRROR, 8];
    let mut lanes = LaneStreams::new(3, &paths, 8);
    let rows = lanes.normals(2, stickslip::lanes::InstructionSet::detect());
    for (lane, &path) in paths.iter().enumerate() {
        assert_eq!(
            [rows[lane], rows[8 + lane]],
            Stream::new(3, path).normal_pair(),
            "lane {lane}"
        );
    }
}

/// Keeps the events of every lane, and T at every row of the output grid.
#[derive(Default)]
struct Seen {
    events: Vec<Vec<Event>>,
    temperature: Vec<(f64, Vec<f64>)>,
}

impl Observer for Seen {
    fn event(&mut self, lane: usize, event: Event) {
        self.events
            .resize(self.events.len().max(lane + 1), Vec::new());
        self.events[lane].push(event);
    }

    fn snapshot(&mut self, instant: Instant, s: Snapshot<'_>) {
        if let Instant::Output(_) = instant {
            self.temperature.push((s.time, s.temperature.to_vec()));
        }
    }
}

/// With v(0) = 0 the noises of paths 2k and 2k + 1 add up to zero, wherever the draws do not depend
/// on events, and the even path is that of a run without pairs. A replay of each path has the same
/// bits. In the schemes without steps the rows are ends of macro steps.
#[test]
fn the_paths_of_a_pair_see_the_noise_and_its_mirror_image() {
    for &kind in Kind::ALL {
        let paired = scenario(of_kind(kind), 20.0, 512, 5);
        let plan = paired.plan();
        let alone = Plan {
            antithetic: false,
            ..plan.clone()
        };
        let (pairs, single) = (plan.block(1), alone.block(1));
        let (pairs_x, single_x) = (
            pairs.rows.path_columns.expect("kept"),
            single.rows.path_columns.expect("kept"),
        );
        let mut mirrored = 0;
        for lane in 0..BLOCK_SIZE as usize {
            let replayed = plan
                .replay(BLOCK_SIZE + lane as u64)
                .rows
                .path_columns
                .expect("kept");
            assert_eq!(
                replayed.displacement_end[0], pairs_x.displacement_end[lane],
                "{kind:?}, {lane}"
            );
            assert_eq!(
                replayed.friction_work[0], pairs_x.friction_work[lane],
                "{kind:?}, {lane}"
            );
            let is_even = lane % 2 == 0;
            assert!(
                !is_even || pairs_x.displacement_end[lane] == single_x.displacement_end[lane],
                "{kind:?}, {lane}"
            );
            mirrored += usize::from(
                !is_even && pairs_x.displacement_end[lane] != single_x.displacement_end[lane],
            );
        }
        assert!(mirrored > 100, "{kind:?}: {mirrored} of 128");
        let mut seen = Seen::default();
        assert!(
            plan.simulation
                .simulate(5, &[8, 8 | MIRROR, 10, 10 | MIRROR], &mut seen)
                .is_empty()
        );
        for (time, temperature) in &seen.temperature {
            for pair in temperature.chunks(2) {
                let sum = pair[0] + pair[1] - 2.0 * (0.25 * time).cos();
                assert!(sum.abs() < 1e-6, "{kind:?}, t = {time}: {pair:?}");
                assert!(
                    *time == 0.0 || (pair[0] - pair[1]).abs() > 1e-6,
                    "{kind:?}, t = {time}: {pair:?}"
                );
            }
        }
    }
}

/// Parts of a run of pairs that are written, read and joined have the bits of the whole run, for
/// any number of threads.
#[test]
fn pairs_are_summed_to_the_same_bits_in_any_parts() {
    let plan = scenario(CorrectedVi { step: 0.05 }, 20.0, 1100, 2).plan();
    let whole = plan.run(1);
    // The summaries are compared as text, because NaN does not equal itself.
    let same = |a: &Summary, b: &Summary| assert_eq!(format!("{a:?}"), format!("{b:?}"));
    same(&plan.run(2), &whole);
    let empty = || RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
    let part = |blocks: std::ops::Range<u64>| {
        let mut part = empty();
        blocks.for_each(|k| part.push(k, plan.block(k).totals).expect("once"));
        empty().read(&part.to_bytes()).expect("what was written")
    };
    let mut joined = part(3..5);
    joined.merge(part(0..3)).expect("apart");
    same(&joined.totals().summary(), &whole);
}

/// If one path of a pair diverges, neither is in the statistics, and both are listed. The step is
/// so long that some paths diverge and others do not.
#[test]
fn a_pair_is_left_out_as_a_whole() {
    let mut paired = scenario(of_kind(Kind::EventDriven), 60.0, 512, 2);
    paired
        .model
        .temperature
        .noises
        .first_mut()
        .expect("noise")
        .intensity = 1.5;
    let plan = paired
        .with_scheme(DiscreteVi { step: 0.3 })
        .expect("goes together")
        .plan();
    let alone = Plan {
        antithetic: false,
        ..plan.clone()
    }
    .run(1)
    .diverged;
    let summary = plan.run(1);
    let lost = &summary.diverged;
    println!("{} of 512 lost, {} without pairs", lost.len(), alone.len());
    assert!((20..500).contains(&lost.len()));
    assert!(
        lost.chunks(2)
            .all(|pair| pair.len() == 2 && pair[0] % 2 == 0 && pair[1] == pair[0] + 1),
        "{lost:?}"
    );
    assert!(
        alone
            .iter()
            .filter(|path| *path % 2 == 0)
            .all(|path| lost.contains(path))
    );
    assert!(
        summary
            .estimate(Statistic::DisplacementEndMean)
            .low
            .is_finite()
    );
}

/// How many of 1000 intervals hold the truth.
struct Held {
    what: String,
    times: u32,
    truth: f64,
}

/// Null hypothesis: over runs of 200 pairs, each with another seed, the intervals of every
/// statistic hold its truth in 95 % of the runs. The truth is that of 2e6 paths without pairs,
/// whose own error adds 1 % to the scatter of the runs. Sample size: 1000 seeds, of which 950 +- 7
/// hold. Bounds: four standard deviations and 10 more, because 200 pairs are few for a skewed
/// statistic. False-alarm rate: 1e-4 for each statistic. Intervals that count path by path (a
/// quantile, P(static)) are conservative; for them the test only requires 912 or more.
///
/// If the path instead of the pair were the unit, the interval of the mean of x(t_end) would always
/// hold the truth.
#[test]
fn intervals_hold_whose_unit_is_the_pair() {
    let scheme = CorrectedVi { step: 0.05 };
    let truth = {
        let mut scenario = scenario(scheme, 30.0, 2_000_000, 77);
        scenario.ensemble.antithetic = false;
        scenario.plan().run(2)
    };
    let exact = [
        Statistic::DisplacementEndMean,
        Statistic::DisplacementEndSd,
        Statistic::StickDurationMean,
        Statistic::StickDurationSd,
        Statistic::FirstStickDurationMean,
        Statistic::SticksPerPath,
        Statistic::SlipsPerPath,
        Statistic::SubPhasesMean,
        Statistic::StickingFraction,
        Statistic::JumpMean,
        Statistic::JumpAbsMean,
        Statistic::FrictionWorkMean,
    ];
    let curve = |summary: &Summary| {
        let x = &summary.bands.displacement;
        // The index of the median at the last of five rows.
        let median = 2 * 5 + 4;
        [
            (
                "mean of x",
                x.mean[4],
                [x.mean_ends.low[4], x.mean_ends.high[4]],
            ),
            ("sd of x", x.sd[4], [x.sd_ends.low[4], x.sd_ends.high[4]]),
            (
                "median of x",
                x.quantiles[[2, 4]],
                [x.quantile_ends.low[median], x.quantile_ends.high[median]],
            ),
            ("P(static)", summary.bands.static_probability[4], {
                let ends = &summary.bands.static_probability_ends;
                [ends.low[4], ends.high[4]]
            }),
        ]
    };
    let mut held: Vec<Held> = (exact
        .iter()
        .map(|s| (s.name().to_string(), truth.estimate(*s).estimate)))
    .chain(curve(&truth).map(|(what, truth, _)| (what.to_string(), truth)))
    .map(|(what, truth)| Held {
        what,
        times: 0,
        truth,
    })
    .collect();
    for seed in 0..1000 {
        let summary = scenario(scheme, 30.0, 400, 1000 + seed).plan().run(1);
        let estimates = exact
            .iter()
            .map(|&s| summary.estimate(s))
            .map(|e| [e.low, e.high]);
        let ends = estimates.chain(curve(&summary).map(|(_, _, ends)| ends));
        for (held, [low, high]) in held.iter_mut().zip(ends) {
            held.times += u32::from(low <= held.truth && held.truth <= high);
        }
    }
    for (i, Held { what, times, .. }) in held.iter().enumerate() {
        println!("{what:<28} {times}");
        // Means over pairs have an upper bound as well; the other intervals are conservative.
        let is_exact = i <= exact.len();
        assert!(
            *times >= 912 && (!is_exact || *times <= 983),
            "{what}: {times} of 1000"
        );
    }
}

/// The gain from pairs in `rho025`: the variance of an estimate from as many paths without pairs
/// divided by that with pairs, which is 1/(1 + r) if r is the correlation of the paths of a pair.
/// Null hypothesis: 6.7 for the mean of x(60), 1 for sticks, and a loss for the first stick. Sample
/// size: 20 000 paths to t_end = 60, seed 3, so that the gains of means are known to 3 %.
/// False-alarm rate: below 1e-6, since the bounds are five and more standard deviations away.
#[test]
fn pairs_gain_where_paths_mirror_each_other() {
    let gain = |statistic: Statistic| {
        let run = |antithetic: bool| {
            let mut scenario = scenario(of_kind(Kind::EventDriven), 60.0, 20_000, 3);
            scenario.ensemble.antithetic = antithetic;
            scenario.plan().run(2)
        };
        static RUNS: std::sync::OnceLock<[Summary; 2]> = std::sync::OnceLock::new();
        let [alone, paired] = RUNS.get_or_init(|| [run(false), run(true)]);
        let error = |summary: &Summary| summary.estimate(statistic).standard_error;
        (error(alone) / error(paired)).powi(2)
    };
    for statistic in Statistic::asked_by(&Record::NOTHING) {
        println!("{:<28} {:.2}", statistic.name(), gain(statistic));
    }
    let means = gain(Statistic::DisplacementEndMean);
    assert!((5.5..8.0).contains(&means), "{means}");
    let sticks = gain(Statistic::SticksPerPath);
    assert!((0.8..1.25).contains(&sticks), "{sticks}");
    let first = gain(Statistic::FirstStickDurationMean);
    assert!((0.6..0.9).contains(&first), "{first}");
}
