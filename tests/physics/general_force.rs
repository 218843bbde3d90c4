//! Any force: bodies without a spring, with negative damping or on a belt, and forces of the user's
//! own, against closed forms and against an independent program.

use crate::common::{Keep, timeline};
use stick_slip::lanes::InstructionSet;
use stick_slip::model::*;
use stick_slip::scenario::Scenario;
use stick_slip::scheme::{DiscreteSimulation, Scheme, Simulate as _, Timeline, reference_path};
use stick_slip::stats::{Statistic, Summary};
use stick_slip::engine::Run;

/// A scenario from its tables.
#[track_caller]
fn scenario(text: &str) -> Scenario {
    Scenario::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// The events of the one path without noise.
fn events(scenario: &Scenario) -> Vec<Event> {
    let mut keep = Keep::lanes(1);
    let simulation = scenario.scheme.simulation(&scenario.model, &scenario.timeline());
    assert_eq!(simulation.simulate(1, &[0], &mut keep), Vec::<usize>::new());
    keep.events.remove(0)
}

/// m = K = 1, without noise.
fn body(friction: [f64; 2], x0: f64, end: f64, more: &str) -> String {
    let [f_s, f_d] = friction;
    format!(
        "oscillator = {{ mass = 1, stiffness = 1, force_per_temperature = 1 }}
         friction = {{ static = {f_s:?}, dynamic = {f_d:?} }}
         initial = {{ displacement = {x0:?} }}
         time = {{ end = {end:?} }}
         scheme = {{ kind = \"event-driven\" }}
         {more}"
    )
}

/// A belt of speed V, seen from the belt: settled sticks last 2 (f_s - f_d)/(K V), slips 2 (pi -
/// atan((f_s - f_d) w0/(K V)))/w0, and the body jumps by V times their sum.
#[test]
fn a_body_on_a_belt_sticks_and_slips_with_the_period_of_the_closed_form() {
    let belt = scenario(&body([1.2, 1.0], 0.0, 100.0, "temperature = { trend = 0.1 }"));
    let events = events(&belt);
    let settled = &events[10..];
    assert!(settled.len() > 10);
    let slip = 2.0 * (std::f64::consts::PI - (0.2f64 / 0.1).atan());
    for pair in settled.windows(2) {
        let (took, way) = (pair[1].time - pair[0].time, pair[1].displacement - pair[0].displacement);
        let (duration, jump) = if pair[0].kind == EventKind::StickEntered { (4.0, 0.0) } else { (slip, 0.1 * (4.0 + slip)) };
        assert!((took - duration).abs() < 1e-11 && (way - jump).abs() < 1e-11, "{pair:?}");
    }
    assert!((slip - 4.068_887_871_591_405).abs() < 1e-14);
}

/// On a belt the force grows at the rate K V, so that a stick that begins with the force b lasts (f_s -
/// b)/(K V), whatever the thresholds.
#[test]
fn a_stick_on_a_belt_lasts_as_long_as_the_force_takes_to_grow() {
    for (f_s, f_d, damping, v) in [(1.7, 0.4, 0.0, 0.3), (2.0, 1.9, 0.1, 0.05), (1.0, 0.0, 0.0, 0.2)] {
        let text = body([f_s, f_d], 0.3, 200.0, &format!("temperature = {{ trend = {v} }}"));
        let text = text.replace("stiffness = 1,", &format!("stiffness = 1, damping = {damping},"));
        let events = events(&scenario(&text));
        let sticks = events.windows(2).filter(|pair| pair[0].kind == EventKind::StickEntered);
        let mut count = 0;
        for pair in sticks {
            let wanted = (f_s - pair[0].force) / v;
            assert!((pair[1].time - pair[0].time - wanted).abs() < 1e-10, "{pair:?}");
            count += 1;
        }
        assert!(count > 5, "{count}");
    }
}

/// The amplitude of the settled motion without sticks under the force 6 cos wt, with f = 1.
fn settled_amplitude(w: f64, damping: f64, end: f64, force: &str) -> f64 {
    let harmonic = format!("temperature = {{ harmonics = [{{ amplitude = 6, angular_frequency = {w} }}] }}");
    let text = body([1.0, 1.0], 0.0, end, &format!("{harmonic}\n{force}"));
    let text = text.replace("stiffness = 1,", &format!("stiffness = 1, damping = {damping},"));
    let events = events(&scenario(&text));
    let last: Vec<f64> = events.iter().rev().take(2).map(|event| event.displacement).collect();
    0.5 * (last[0] - last[1]).abs()
}

/// Den Hartog, Trans. ASME 53 (1930): X = P sqrt(V^2 - (f/P)^2 U^2) without damping, V = 1/(1 - r^2), U
/// = tan(pi/(2 r))/r. With damping, the half-period problem was solved to 16 digits.
#[test]
fn a_forced_body_settles_to_the_amplitude_of_den_hartog() {
    for (w, damping, amplitude, end, most) in [
        (1.5, 0.1, 4.303_857_833_795_083_5, 400.0, 1e-11),
        (1.5, 0.0, 4.659_041_389_241_64, 20_000.0, 1e-6),
        (1.2, 0.0, 13.276_974_424_498_324, 20_000.0, 1e-5),
    ] {
        let found = settled_amplitude(w, damping, end, "");
        assert!((found - amplitude).abs() < most, "w = {w}, alpha = {damping}: {found} {amplitude}");
    }
    // The same with the damping as a force of the user's own. It is followed to a tolerance.
    let own = "force = { expression = \"-0.2*xdot + 0*abs(xdot)\" }";
    let found = settled_amplitude(1.5, 0.0, 400.0, own);
    assert!((found - 4.303_857_833_795_083_5).abs() < 1e-9, "{found}");
}

/// Negative damping and friction: from below A = (f_d/K) (q + 1)/(q - 1), q = exp(-pi z/sqrt(1 - z^2)),
/// the body comes to rest, and from above it runs away.
#[test]
fn a_body_with_negative_damping_runs_away_beyond_its_unstable_cycle() {
    const CYCLE: f64 = 12.742_671_918_388_782;
    let from = |x0: f64, damping: &str, force: &str| {
        let text = body([1.0, 1.0], x0, 400.0, force).replace("stiffness = 1,", &format!("stiffness = 1,{damping}"));
        scenario(&text)
    };
    let below = from(CYCLE * (1.0 - 1e-9), " damping = -0.05,", "");
    assert!((below.model.runaway_amplitude(0.0).expect("negative damping") - CYCLE).abs() < 1e-13);
    for (damping, own) in [(" damping = -0.05,", ""), ("", "force = { expression = \"0.1*xdot + 0*abs(xdot)\" }")] {
        let inside = events(&from(CYCLE * (1.0 - 1e-9), damping, own));
        let last = inside.last().expect("slips");
        assert_eq!(last.kind, EventKind::StickEntered, "{last:?}");
        let outside = events(&from(CYCLE * (1.0 + 1e-9), damping, own));
        let far = outside.iter().map(|event| event.displacement.abs()).fold(0.0, f64::max);
        assert!(far > 100.0 && outside.iter().all(|event| event.kind != EventKind::StickEntered), "{far}");
    }
}

/// A path that runs away until its numbers do not fit is diverged, in every scheme that allows it.
#[test]
fn a_path_that_runs_away_is_counted_as_diverged() {
    let text = body([1.0, 1.0], 20.0, 10_000.0, "").replace("stiffness = 1,", "stiffness = 1, damping = -0.05,");
    let grows = scenario(&format!("{text}\nensemble = {{ paths = 3 }}"));
    let noisy = format!("{text}\ntemperature = {{ noise = {{ intensity = 0.1 }} }}\nensemble = {{ paths = 3 }}");
    let mut schemes = vec![grows.clone(), scenario(&noisy)];
    schemes.push(grows.with_scheme(stick_slip::scheme::DiscreteVi { step: 0.05 }).expect("whole steps"));
    for scenario in schemes {
        let simulation = scenario.scheme.simulation(&scenario.model, &scenario.timeline());
        assert_eq!(simulation.simulate(1, &[0, 1, 2], &mut ()), [0, 1, 2], "{}", scenario.scheme);
    }
}

/// A cubic spring released at x = 3 with f = 1, and drag against a constant force without a spring. The
/// digits are from the integral of the energy, and from the closed form of the motion.
#[test]
fn a_slip_of_a_cubic_spring_and_a_fall_against_drag_have_their_closed_forms() {
    let spring = "force = { expression = \"-k3*x^3\", parameters = { k3 = 0.5 } }";
    let first = events(&scenario(&body([1.0, 1.0], 3.0, 10.0, spring)))[1];
    assert!((first.displacement + 2.594_562_116_631_153).abs() < 1e-11, "{first:?}");
    assert!((first.time - 1.594_630_367_679_260_4).abs() < 1e-11, "{first:?}");

    let drag = "temperature = { offset = 3 }\nforce = { expression = \"-0.5*xdot*abs(xdot)\" }";
    let falls = body([1.0, 1.0], 0.0, 4.0, drag).replace("stiffness = 1,", "stiffness = 0,");
    let falls = scenario(&format!("{falls}\nensemble = {{ paths = 1 }}"));
    let mut keep = Keep::lanes(1);
    falls.scheme.simulation(&falls.model, &timeline(4.0, 4.0)).simulate(1, &[0], &mut keep);
    let (_, x, v, ..) = keep.rows[0][1];
    assert!((x - 6.614_376_451_625_901).abs() < 1e-10 && (v - 1.998_658_599_478_134).abs() < 1e-10, "{x} {v}");
}

/// A body without a spring under a constant force, with and without damping, has its closed form, in
/// every scheme: x = a t^2/2, or (a/(2 gamma)) (t - (1 - e^{-2 gamma t})/(2 gamma)).
#[test]
fn a_body_without_a_spring_falls() {
    for gamma in [0.0, 0.3, 20.0] {
        let text = body([1.0, 0.5], 0.0, 10.0, "temperature = { offset = 1.5 }");
        let text = text.replace("stiffness = 1,", &format!("stiffness = 0, damping = {gamma},"));
        let falls = scenario(&text);
        let wanted = if gamma == 0.0 {
            50.0
        } else {
            (10.0 + (-20.0 * gamma).exp_m1() / (2.0 * gamma)) / (2.0 * gamma)
        };
        let end = |scheme: Scheme, model: &Model| {
            let mut keep = Keep::lanes(1);
            scheme.simulation(model, &timeline(10.0, 10.0)).simulate(1, &[0], &mut keep);
            keep.rows[0][1].1
        };
        let exact = end(falls.scheme, &falls.model);
        assert!((exact / wanted - 1.0).abs() < 1e-12, "gamma = {gamma}: {exact} {wanted}");
        for kind in [stick_slip::scheme::Kind::DiscreteVi, stick_slip::scheme::Kind::CorrectedVi] {
            let [coarse, fine] = [1e-2, 5e-3].map(|h| end(kind.with(h), &falls.model));
            let extrapolated = 2.0 * fine - coarse;
            assert!((extrapolated / wanted - 1.0).abs() < 1e-3, "gamma = {gamma}: {extrapolated} {wanted}");
        }
    }
}

/// A constant and a trend give the same path as a series of two samples, and a constant the same as a
/// harmonic of frequency zero, in every scheme, with noise too.
#[test]
fn a_line_is_the_series_of_its_ends() {
    for noise in ["", ", noise = { intensity = 0.3 }"] {
        for scheme in ["event-driven", "discrete-vi", "corrected-vi"] {
            let with = |temperature: &str| {
                let text = body([1.2, 1.0], 0.0, 20.0, &format!("temperature = {{ {temperature}{noise} }}"));
                let text = text.replace("\"event-driven\"", &format!("\"{scheme}\"")).replace("{ end", "{ step = 0.01, end");
                let mut scenario = scenario(&text);
                if temperature.is_empty() {
                    let series = Series::new(vec![0.0, 20.0], vec![0.5, 6.5]).expect("a series");
                    scenario.model.temperature.series = Some(std::sync::Arc::new(series));
                }
                let mut keep = Keep::lanes(3);
                scenario.scheme.simulation(&scenario.model, &timeline(20.0, 0.7)).simulate(1, &[0, 1, 2], &mut keep);
                keep
            };
            let [line, series] = ["offset = 0.5, trend = 0.3", ""].map(with);
            for (a, b) in line.events.iter().zip(&series.events) {
                assert!(a.len() == b.len() && a.len() > 2, "{scheme}{noise}");
            }
            let rows = line.rows.iter().flatten().zip(series.rows.iter().flatten());
            for (a, b) in rows {
                assert!((a.1 - b.1).abs() < 1e-9 && (a.3 - b.3).abs() < 1e-9, "{scheme}{noise}: {a:?} {b:?}");
            }
        }
    }
}

/// The scenes of general_force.csv.
const SCENES: [(&str, &str); 5] = [
    (
        "cubic spring",
        "oscillator.dilatation = 6
         force.expression = \"-0.02*x^3\"
         temperature.harmonics = [{ amplitude = 1, angular_frequency = 0.25 }]
         initial.displacement = 4",
    ),
    (
        "belt with Stribeck friction",
        "oscillator.dilatation = 1
         force.expression = \"0.3*(1-exp(-abs(xdot)/0.2))*sign(xdot) - 0.05*xdot\"
         friction = { static = 1.3, dynamic = 1.1 }
         temperature.trend = 0.5
         temperature.noise.intensity = 0.3
         initial.displacement = 0",
    ),
    (
        "van der Pol with friction",
        "oscillator.dilatation = 4
         force.expression = \"(0.3 - 0.05*x^2)*xdot\"
         friction = { static = 0.8, dynamic = 0.5 }
         temperature.harmonics = [{ amplitude = 0.5, angular_frequency = 0.6 }]
         temperature.noise.intensity = 0.15
         initial.displacement = 1.5",
    ),
    (
        "stop at 3",
        "oscillator.dilatation = 6
         force.expression = \"-20*max(x - 3, 0)\"
         temperature.harmonics = [{ amplitude = 1, angular_frequency = 0.25 }]
         initial.displacement = 3.14",
    ),
    (
        "belt",
        "oscillator.dilatation = 1
         temperature.trend = 0.3
         initial.displacement = 0",
    ),
];

/// A scene of the table; what it does not give is that of the paper's noisy scene.
fn noisy(scene: &str) -> Scenario {
    let text = SCENES.iter().find(|(name, _)| *name == scene).expect("a scene").1;
    let mut text = format!("oscillator.mass = 1\noscillator.stiffness = 1\n{text}\ntime = {{ end = 60, output_step = 30 }}\n");
    if !text.contains("friction") {
        text.push_str("friction = { static = 1.2, dynamic = 1.0 }\n");
    }
    if !text.contains("intensity") {
        text.push_str("temperature.noise.intensity = 0.25\n");
    }
    scenario(&format!("{text}scheme.kind = \"event-driven\"\n"))
}

/// The statistics of a scenario with this scheme and number of paths.
fn summary(scenario: &Scenario, scheme: Scheme, paths: u64) -> Summary {
    let mut scenario = scenario.with_scheme(scheme).expect("goes together");
    scenario.ensemble.paths = paths;
    Run::new(&scenario).threads(2).simulate().expect("a run").summary
}

/// The name of each statistic of a scene in the table, with its value and standard error.
fn table(scene: &str) -> Vec<(&'static str, f64, f64)> {
    let rows = include_str!("../reference/general_force.csv").lines();
    let of_scene = rows.filter_map(|row| row.strip_prefix(scene)?.strip_prefix(','));
    let read = |row: &'static str| {
        let mut cells = row.split(',');
        let mut next = || cells.next().expect("four cells");
        (next(), next().parse().expect("a number"), next().parse().expect("a number"))
    };
    of_scene.map(read).collect()
}
