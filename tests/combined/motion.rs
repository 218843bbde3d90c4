//! The schemes without a step against a plain integrator of the equation of motion on the same
//! noise, and against the recursion of the paper.

use super::equivalents::{assert_alike, events, keep};
use super::scene::{Scene, ask};
use crate::common::{Keep, OutputRow};
use stickslip::engine::Run;
use stickslip::model::{Event, EventKind, Phase, Sign};
use stickslip::scheme::{Kind, Observer, Segment, Simulate as _};
use stickslip::stats::{PassageLevels, Record, Statistic, Summary};

/// Steps of the integrator.
const SPACING: f64 = 1e-4;

/// The equation of motion of a scene.
struct Motion<'a> {
    scene: &'a Scene,
    stiffness: f64,
    damping: f64,
    /// What the scheme adds to f_s where f_s = f_d under noise.
    raised: f64,
}

/// x, x', and the works of friction, damping and g.
type State = [f64; 5];

/// A time and the force of the noise then.
type Instant = (f64, f64);

impl Motion<'_> {
    /// All forces at rest but noise and friction, as a body feels them that is to move in this
    /// direction; in no direction, the mean of both.
    fn at_rest(&self, e: f64, x: f64, t: f64) -> f64 {
        let own = |e: f64| self.scene.own(e, x, 0.0, t);
        let own = if e == 0.0 {
            0.5 * (own(1.0) + own(-1.0))
        } else {
            own(e)
        };
        self.scene.gain() * self.scene.temperature(t) - self.stiffness * x + own
    }

    fn holds(&self, e: f64, x: f64, t: f64) -> f64 {
        let f_s = self.scene.friction[usize::from(e < 0.0)][0];
        f_s * self.scene.load(e, x, 0.0, t) + self.raised
    }

    fn rate(&self, e: f64, [x, v, ..]: State, (t, noise): Instant) -> State {
        let scene = self.scene;
        let own = scene.own(e, x, v, t);
        let brakes = scene.friction[usize::from(e < 0.0)][1] * scene.load(e, x, v, t);
        let driven = scene.gain() * scene.temperature(t) + noise;
        let force = driven + own - self.stiffness * x - 2.0 * self.damping * v - e * brakes;
        [
            v,
            force / scene.mass,
            brakes * v.abs(),
            2.0 * self.damping * v * v,
            own * v,
        ]
    }

    /// A step of the classical Runge-Kutta rule, in which the noise is a straight line.
    fn step(&self, e: f64, state: State, [from, to]: [Instant; 2]) -> State {
        let h = to.0 - from.0;
        let at = |part: f64, rates: State| {
            let moved: State = std::array::from_fn(|i| state[i] + part * h * rates[i]);
            self.rate(
                e,
                moved,
                (from.0 + part * h, from.1 + part * (to.1 - from.1)),
            )
        };
        let k1 = at(0.0, [0.0; 5]);
        let k2 = at(0.5, k1);
        let k3 = at(0.5, k2);
        let k4 = at(1.0, k3);
        std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }
}

/// The times at which the integrator stops, with the force of the noise: under noise the rows at
/// which T is known, and otherwise a grid with the samples, where slopes jump.
fn instants(scene: &Scene, rows: &[OutputRow]) -> Vec<Instant> {
    if scene.is_random() {
        let noise = |row: &OutputRow| scene.gain() * (row.3 - scene.temperature(row.0));
        return rows.iter().map(|row| (row.0, noise(row))).collect();
    }
    let samples = [&scene.series, &scene.input]
        .into_iter()
        .flatten()
        .flat_map(|(times, _)| times);
    let steps = (scene.end / (2.0 * SPACING)) as usize;
    let grid = (0..=steps).map(|i| 2.0 * SPACING * i as f64);
    let mut times: Vec<f64> = grid
        .chain(samples.copied().filter(|t| *t <= scene.end))
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times.into_iter().map(|t| (t, 0.0)).collect()
}

/// How far a scheme is from the integrator: what a stick exceeds its limits by, how far its end is
/// from the threshold, x' where the body stops, x there, and x' against the direction of a slip.
#[derive(Debug, Default)]
struct Off {
    held: f64,
    exit: f64,
    speed: f64,
    place: f64,
    against: f64,
}

/// A path of the integrator between the events of the scheme.
struct Check<'a> {
    motion: Motion<'a>,
    instants: Vec<Instant>,
    off: Off,
    works: [f64; 3],
    fastest: f64,
    slips: u32,
}

impl Check<'_> {
    fn noise_at(&self, event: &Event) -> Instant {
        if !self.motion.scene.is_random() {
            return (event.time, 0.0);
        }
        let rest = self.motion.at_rest(0.0, event.displacement, event.time);
        let moving = if event.time == 0.0 {
            self.motion.scene.v0
        } else {
            0.0
        };
        let damped = -2.0 * self.motion.damping * moving;
        let own = if moving == 0.0 {
            0.0
        } else {
            let scene = self.motion.scene;
            let e = moving.signum();
            scene.own(e, event.displacement, moving, 0.0)
                - 0.5
                    * (scene.own(1.0, event.displacement, 0.0, 0.0)
                        + scene.own(-1.0, event.displacement, 0.0, 0.0))
        };
        (event.time, event.force - rest - damped - own)
    }

    /// Between the event at which a phase began and that at which it ends.
    fn phase(&mut self, began: Option<Event>, end: Option<Event>) {
        let start = began.map_or(0.0, |event| event.time);
        let until = end.map_or(self.motion.scene.end, |event| event.time);
        let first = self.instants.partition_point(|at| at.0 <= start);
        let last = self.instants.partition_point(|at| at.0 < until).max(first);
        let inside = self.instants[first..last].to_vec();
        let x = began.map_or(self.motion.scene.x0, |event| event.displacement);
        match began.map(|event| event.kind) {
            None | Some(EventKind::StickEntered) => self.stick(x, &inside, end),
            Some(EventKind::SlipStarted(sign) | EventKind::SubPhaseBoundary(sign)) => {
                let at = self.noise_at(&began.expect("an event"));
                self.slip(sign.value(), (at, x), &inside, end);
            }
        }
    }

    fn stick(&mut self, x: f64, inside: &[Instant], end: Option<Event>) {
        let beyond = |e: f64, (t, noise): Instant| {
            e * (self.motion.at_rest(e, x, t) + noise) - self.motion.holds(e, x, t)
        };
        let mut held = self.off.held;
        for at in inside {
            held = held.max(beyond(1.0, *at)).max(beyond(-1.0, *at));
        }
        let mut exit = self.off.exit;
        if let Some(event) = end
            && let EventKind::SlipStarted(sign) = event.kind
            && event.time > 0.0
        {
            exit = exit.max(beyond(sign.value(), self.noise_at(&event)).abs());
        }
        (self.off.held, self.off.exit) = (held, exit);
    }

    fn slip(&mut self, e: f64, (at, x): (Instant, f64), inside: &[Instant], end: Option<Event>) {
        let v = if at.0 == 0.0 {
            self.motion.scene.v0
        } else {
            0.0
        };
        let (mut state, mut here) = ([x, v, 0.0, 0.0, 0.0], at);
        let stop = end.map(|event| self.noise_at(&event));
        let close = (stop.is_none() && here.0 < self.motion.scene.end).then(|| {
            (
                self.motion.scene.end,
                inside.last().map_or(at.1, |last| last.1),
            )
        });
        for there in inside.iter().copied().chain(stop).chain(close) {
            if there.0 > here.0 {
                state = self.motion.step(e, state, [here, there]);
                here = there;
            }
            self.off.against = self.off.against.max(-e * state[1]);
            self.fastest = self.fastest.max(e * state[1]);
        }
        (0..3).for_each(|i| self.works[i] += state[2 + i]);
        if let Some(stop) = end {
            self.off.speed = self.off.speed.max(state[1].abs());
            self.off.place = self.off.place.max((state[0] - stop.displacement).abs());
            self.slips += 1;
        }
    }
}

fn check<'a>(scene: &'a Scene) -> Check<'a> {
    let scenario = scene.scenario();
    let is_random = scene.is_random();
    let kept = keep(
        scene,
        &[0],
        if is_random {
            SPACING
        } else {
            scene.output_step
        },
    );
    let [stiffness, damping] = scene.body();
    let raised = scenario.resolution().map_or(0.0, |to| {
        to.static_force - scenario.model.friction.static_force
    });
    let motion = Motion {
        scene,
        stiffness,
        damping,
        raised,
    };
    let instants = instants(scene, &kept.rows[0]);
    let mut check = Check {
        motion,
        instants,
        off: Off::default(),
        works: [0.0; 3],
        fastest: scene.v0.abs(),
        slips: 0,
    };
    let mut began = None;
    for end in kept.events[0].iter().copied().map(Some).chain([None]) {
        check.phase(began, end);
        began = end;
    }
    check
}

/// The works and the largest speed of path 0, from the start on.
fn summary(scene: &Scene) -> Summary {
    let mut scenario = scene.scenario();
    scenario.statistics.after = 0.0;
    (scenario.ensemble.paths, scenario.ensemble.antithetic) = (1, false);
    scenario.record = Record {
        energy: true,
        levels: PassageLevels::of(&[1.0]),
        ..Record::NOTHING
    };
    let run = Run::of(&scenario).threads(1).without_bias();
    run.simulate().expect("no sink fails").summary
}

/// From each event of a slip a plain integrator of the equation of motion comes to the next one: it
/// is at rest where and when `event-driven` says. In sticks friction holds the body, and each ends
/// where the force is that of the threshold in the direction of the slip. The works of friction, of
/// damping and of g, and the largest speed, are those along this motion.
///
/// The rule is of order 4, so that 1e-8 is left without noise. Under noise, which is known at 1e5
/// times, what it does in between leaves about SPACING^{3/2} of it in x', and thus a few 1e-4.
#[test]
fn every_event_is_that_of_a_plain_integrator() {
    ask(|scene| {
        let both = [scene.without_noise(), scene.clone()];
        for scene in both.iter().take(1 + usize::from(scene.is_random())) {
            let scene = scene.in_scheme(Kind::EventDriven).expect("suits");
            let Check {
                off,
                works,
                fastest,
                slips,
                ..
            } = check(&scene);
            let exact = 1e-9;
            // White noise is an order of magnitude stronger than the others.
            let speed = match (scene.is_random(), &scene.white) {
                (false, _) => 1e-8,
                (true, None) => 1e-3,
                (true, Some(_)) => 5e-3,
            };
            let summary = summary(&scene);
            println!("{}: {slips} slips, {off:?}", scene.name);
            assert!(
                off.held < exact && off.exit < exact,
                "{}: {off:?}",
                scene.name
            );
            let most = off.speed.max(off.place).max(off.against);
            assert!(most < speed, "{}: {off:?}", scene.name);
            let of = [
                Statistic::FrictionWorkMean,
                Statistic::DampingWorkMean,
                Statistic::UserForceWorkMean,
                Statistic::LargestSpeedMean,
            ];
            assert_farthest(&scene, &summary);
            let scale = works[0] + works[1].abs() + works[2].abs();
            for (statistic, wanted) in of.into_iter().zip([works[0], works[1], works[2], fastest]) {
                let found = summary.estimate(statistic).estimate;
                let allowed = speed * (1.0 + if statistic == of[3] { fastest } else { scale });
                // The integrator knows the speed at its steps only, and the scheme follows the mean
                // of the motion between two states that it has drawn.
                let between = match (statistic == of[3], scene.is_random()) {
                    (false, _) => 0.0,
                    (true, false) => 1e-6,
                    (true, true) => 0.02 * fastest,
                };
                assert!(
                    (found - wanted).abs() <= allowed + between,
                    "{}: {} is {found}, not {wanted}",
                    scene.name,
                    statistic.name()
                );
            }
        }
    });
}

/// The largest displacement from the start is at an event or at the end.
fn assert_farthest(scene: &Scene, summary: &Summary) {
    let end = summary.estimate(Statistic::DisplacementEndMean).estimate;
    let found = events(scene);
    let places = found.iter().map(|event| event.displacement);
    let ways = places.chain([end]).map(|x| (x - scene.x0).abs());
    let wanted = ways.fold(0.0, f64::max);
    let found = summary
        .estimate(Statistic::LargestDisplacementMean)
        .estimate;
    assert!(
        (found - wanted).abs() < 1e-9,
        "{}: {found}, not {wanted}",
        scene.name
    );
}

/// Pinned noise is zero at every sample.
#[test]
fn pinned_noise_is_zero_at_the_samples() {
    ask(|scene| {
        if !scene.is_pinned {
            return;
        }
        for scheme in [Kind::EventDriven, Kind::QuasiStatic] {
            let Some(scene) = scene.in_scheme(scheme) else {
                continue;
            };
            let (times, _) = scene.series.as_ref().expect("samples");
            for sample in [times[1], times[2], times[times.len() / 2]] {
                let row = keep(&scene, &[0], sample).rows[0][1];
                let off = row.3 - scene.temperature(sample);
                assert!(off.abs() < 1e-9, "{}: {row:?} is off by {off}", scene.name);
            }
        }
    });
}

/// T is that of its formula at every row.
fn assert_temperature(scene: &Scene) -> Keep {
    let kept = keep(scene, &[0], 0.02);
    for row in &kept.rows[0] {
        let off = row.3 - scene.temperature(row.0);
        assert!(off.abs() < 5e-3, "{}: {row:?} is off by {off}", scene.name);
    }
    kept
}

/// Under noise of no size, which the schemes simulate by other code than none, T is that of its
/// formula at every row, and the path is that without noise, where f_s exceeds f_d by enough that no
/// short slips come of it. At an event, the noise takes up what the tolerance leaves of its time.
#[test]
fn noise_of_no_size_changes_nothing() {
    const SIZE: f64 = 1e-9;
    ask(|scene| {
        for scheme in [Kind::EventDriven, Kind::QuasiStatic] {
            let short = Scene {
                end: 2.5,
                after: 0.0,
                ..scene.clone()
            };
            let Some(mut scene) = short.in_scheme(scheme).filter(Scene::is_random) else {
                continue;
            };
            let without = scene.without_noise();
            scene.tolerance = 1e-5;
            for ([rho, ..], _) in &mut scene.noises {
                *rho *= SIZE;
            }
            if let Some([strength, _]) = &mut scene.white {
                *strength *= SIZE * SIZE;
            }
            let kept = assert_temperature(&scene);
            // So steep that T would be wrong within a macro step without it.
            let trend = 5.0;
            assert_temperature(&Scene {
                trend,
                ..scene.clone()
            });
            if scene.kind("friction") == "gap" {
                assert_alike(&scene.name, &kept.events[0], &events(&without), 5e-3);
            }
        }
    });
}

/// Every slip of `quasi-static` lasts half a swing, and moves the body by (1 + q) (|b| - f_d)/K in the
/// direction of b, where |b| is f_s unless the slip begins outside of the stick band. From a
/// damping ratio of 1 on there is no overshoot. In sticks friction holds the body.
#[test]
fn the_slips_of_the_recursion_are_those_of_the_paper() {
    ask(|scene| {
        for scene in [scene.without_noise(), scene.clone()] {
            let Some(scene) = scene.in_scheme(Kind::QuasiStatic) else {
                continue;
            };
            let [k, alpha] = scene.body();
            let [f_s, f_d] = scene.friction[0];
            let w0 = (k / scene.mass).sqrt();
            let zeta = alpha / scene.mass / w0;
            let root = (1.0 - zeta * zeta).max(0.0).sqrt();
            let q = if zeta < 1.0 {
                (-std::f64::consts::PI * zeta / root).exp()
            } else {
                0.0
            };
            let found = events(&scene);
            let pull = |x: f64, t: f64| scene.gain() * scene.temperature(t) - k * x;
            for event in &found {
                let b = pull(event.displacement, event.time);
                assert!(
                    scene.is_random() || (event.force - b).abs() < 1e-9,
                    "{}: {event:?}, not {b}",
                    scene.name
                );
            }
            for (i, pair) in found.windows(2).enumerate() {
                let [begin, end] = [pair[0], pair[1]];
                let sign = match begin.kind {
                    EventKind::StickEntered => continue,
                    EventKind::SlipStarted(sign) | EventKind::SubPhaseBoundary(sign) => sign,
                };
                assert_eq!(sign, Sign::of(begin.force), "{}", scene.name);
                let from = if begin.time == 0.0 || begin.kind != EventKind::SlipStarted(sign) {
                    begin.force.abs()
                } else {
                    let is_empty = i > 0 && found[i - 1].time == begin.time;
                    let beyond = begin.force.abs() - f_s;
                    assert!(
                        beyond.abs() < 1e-9 || (is_empty && beyond > 0.0),
                        "{}: {begin:?}",
                        scene.name
                    );
                    f_s
                };
                let way = sign.value() * (1.0 + q) * (from - f_d) / k;
                let off = end.displacement - begin.displacement - way;
                assert!(off.abs() < 1e-9, "{}: {pair:?}, not {way}", scene.name);
                let lasts = std::f64::consts::PI / (w0 * root);
                assert!(
                    zeta >= 1.0 - 1e-9 || (end.time - begin.time - lasts).abs() < 1e-9,
                    "{}: {pair:?}, not {lasts}",
                    scene.name
                );
            }
            for row in keep(&scene, &[0], 0.05).rows.remove(0) {
                let b = scene.gain() * row.3 - k * row.1;
                assert!(!row.4 || b.abs() <= f_s + 1e-9, "{}: {row:?}", scene.name);
                let off = row.3 - scene.temperature(row.0);
                assert!(
                    scene.is_random() || off.abs() < 1e-12,
                    "{}: {row:?}",
                    scene.name
                );
            }
        }
    });
}

/// Keeps the motion and the events of each path in the order in which they arrive.
struct Kept(Vec<(Vec<Event>, Vec<Segment>)>);

impl Observer for Kept {
    fn event(&mut self, lane: usize, event: Event) {
        self.0[lane].0.push(event);
    }

    fn follows(&self) -> bool {
        true
    }

    fn segment(&mut self, lane: usize, segment: &Segment) {
        self.0[lane].1.push(*segment);
    }
}

/// The motion of a path leads from each event to the next without a gap, in time, x and x': it begins
/// at an event at which the body moves off or turns, and ends at one at which it stops or turns, or
/// beyond the end.
#[test]
fn dense_output_has_no_gaps() {
    ask(|scene| {
        for scene in scene.in_each_scheme() {
            let scenario = scene.scenario();
            let mut kept = Kept(vec![Default::default(); 3]);
            let simulation = scenario
                .scheme
                .simulation(&scenario.model, &scenario.timeline());
            assert!(
                simulation
                    .simulate(scene.seed, &[0, 1, 2], &mut kept)
                    .is_empty()
            );
            for (events, segments) in &kept.0 {
                assert_no_gaps(&scene, events, segments);
            }
        }
    });
}

fn assert_no_gaps(scene: &Scene, events: &[Event], segments: &[Segment]) {
    let Scene { name, end, .. } = scene;
    let at_event = |time: f64, x: f64| {
        let is_here = |event: &Event| {
            (event.time - time).abs() < 1e-9 && (event.displacement - x).abs() < 1e-9
        };
        events.iter().any(is_here)
    };
    // (t, x, x') at which the motion may begin and end.
    let mut last: Option<[f64; 3]> = None;
    for segment in segments.iter().filter(|segment| segment.start < *end) {
        let from = [segment.start, segment.displacement, segment.velocity[0]];
        let goes_on =
            last.is_some_and(|last| from.iter().zip(last).all(|(a, b)| (a - b).abs() < 1e-9));
        let ends = last.is_none_or(|[t, x, _]| at_event(t, x));
        assert!(
            goes_on || (ends && at_event(from[0], from[1])),
            "{name}: {last:?} {from:?}"
        );
        last = Some([
            segment.end(),
            segment.displacement + segment.way,
            segment.velocity[1],
        ]);
    }
    let Some([t, x, _]) = last else {
        return;
    };
    assert!(t > end - 1e-9 || at_event(t, x), "{name}: {last:?}");
    let is_moving = events
        .last()
        .is_some_and(|event| matches!(event.kind.phase(), Phase::Slip(_)));
    assert!(
        !is_moving || t > end - 1e-9,
        "{name}: the last slip is followed until {t}"
    );
}
