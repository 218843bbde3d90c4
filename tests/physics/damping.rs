//! Works and speeds without noise at any damping: closed forms of swings, the balance of energy, and
//! forces that do nothing or damp.

use super::measures::{run, scenario};
use std::f64::consts::PI;
use stickslip::stats::{Statistic, Summary};

/// Damping ratios alpha/(m w0), up to the critical one and from there on.
const WEAK: [f64; 4] = [0.0, 0.1, 0.7, 1.0 - 1e-9];
const STRONG: [f64; 6] = [1.0, 1.0 + 1e-9, 1.1, 3.0, 50.0, 1e4];

fn ratios() -> impl Iterator<Item = f64> {
    WEAK.into_iter().chain(STRONG)
}

/// Masses with w0 = 4, 1 and 1/8 at K = 4, so that m w0 is exact.
const MASSES: [f64; 3] = [0.25, 4.0, 256.0];

fn of(summary: &Summary, statistic: Statistic) -> f64 {
    summary.estimate(statistic).estimate
}

/// K = 4, c = 1 and f_d = 1, with works and speeds.
fn text(scheme: &str, [mass, alpha]: [f64; 2], [f_s, x0, end]: [f64; 3], more: &str) -> String {
    format!(
        "oscillator = {{ mass = {mass:?}, stiffness = 4, damping = {alpha:?}, force_per_temperature = 1 }}
         friction = {{ static = {f_s:?}, dynamic = 1 }}
         initial.displacement = {x0:?}
         time.end = {end:?}
         record = {{ energy = true, density = true }}
         statistics.levels = [1.0]
         ensemble.paths = 1
         scheme.kind = \"{scheme}\"
         {more}"
    )
}

/// Of a swing from rest towards an equilibrium at the distance Y: the work of damping in units of
/// K Y^2/2, and the largest speed in units of Y w0, which is e^{-gamma r} where x'' = 0.
fn swing(ratio: f64) -> [f64; 2] {
    if ratio < 1.0 {
        let root = ((1.0 - ratio) * (1.0 + ratio)).sqrt();
        let overshoot = (-PI * ratio / root).exp();
        let turn = root.atan2(ratio) / root;
        [1.0 - overshoot * overshoot, (-ratio * turn).exp()]
    } else if ratio == 1.0 {
        [1.0, (-1f64).exp()]
    } else {
        let root = ((ratio - 1.0) * (ratio + 1.0)).sqrt();
        [1.0, (-ratio * (ratio + root).ln() / root).exp()]
    }
}

/// However heavy the body, and however fast its velocity settles: a swing dissipates what the spring
/// loses. The quasi-static swings have Y = (f_s - f_d)/K, that of the event-driven body Y = (f_s +
/// 1e-9 - f_d)/K, and at and above critical damping it takes all the run.
#[test]
fn a_swing_takes_the_energy_of_its_spring_at_any_damping() {
    for (mass, ratio) in MASSES
        .into_iter()
        .flat_map(|m| ratios().map(move |r| (m, r)))
    {
        let w0 = (4.0 / mass).sqrt();
        let body = [mass, ratio * mass * w0];
        let [work, speed] = swing(ratio);
        // After this many 1/w0, e^{-2 |l1| t} is below 1e-11.
        let slow = 2.0 * ratio.max(1.0);
        let forced = "temperature.harmonics = [{ amplitude = 7, angular_frequency = 1e-9 }]";
        for (scheme, scene, forcing) in [
            (
                "event-driven",
                [11.0, -(11.0 + 1e-9) / 4.0, 13.0 * slow / w0],
                "",
            ),
            ("quasi-static", [1.2, 1.7, 3e9], forced),
        ] {
            let summary = run(&scenario(&text(scheme, body, scene, forcing)));
            let slips = of(&summary, Statistic::SlipsPerPath).max(1.0);
            let distance = (scene[0] - 1.0) / 4.0;
            let found = [Statistic::DampingWorkMean, Statistic::LargestSpeedMean]
                .map(|statistic| of(&summary, statistic));
            let wanted = [
                slips * work * 2.0 * distance * distance,
                speed * distance * w0,
            ];
            println!("{scheme}, m = {mass}, {ratio}: {slips} slips, {found:?} {wanted:?}");
            for (found, wanted) in found.into_iter().zip(wanted) {
                assert!(
                    (found - wanted).abs() <= 1e-9 * wanted,
                    "{scheme}, m = {mass}, {ratio}: {found} {wanted}"
                );
            }
        }
    }
}

/// The work of the temperature, of damping and of friction are integrals of their own.
#[test]
fn the_balance_of_energy_closes_at_any_damping() {
    for (mass, ratio) in MASSES
        .into_iter()
        .flat_map(|m| ratios().map(move |r| (m, r)))
    {
        let body = [mass, ratio * 2.0 * mass.sqrt()];
        for (scheme, w, x0, after) in [
            ("event-driven", 0.25, 0.0, 0.1),
            ("event-driven", 0.01, -1.0, 3.0),
            ("quasi-static", 1e-9, 0.1, 0.0),
        ] {
            let forced = format!(
                "temperature.harmonics = [{{ amplitude = 7, angular_frequency = {w:?} }}]
                 statistics.after = {after:?}"
            );
            let scene = text(scheme, body, [1.2, x0, 15.0 / w], &forced);
            let summary = run(&scenario(&scene));
            let [residual, friction] = [Statistic::EnergyResidualMean, Statistic::FrictionWorkMean]
                .map(|statistic| of(&summary, statistic));
            println!(
                "{scheme}, w = {w}, m = {mass}, {ratio}: {:e}",
                residual / friction
            );
            assert!(
                friction > 0.0 && residual.abs() < 1e-9 * friction,
                "{scheme}, w = {w}, m = {mass}, {ratio}: {residual} of {friction}"
            );
        }
    }
}

/// A force that is too weak to move anything selects the scheme for general forces. A force -c x' is
/// a damping alpha = c/2, whose work counts as that of the force.
#[test]
fn a_force_that_does_nothing_changes_no_work_or_speed() {
    let forced = "temperature.harmonics = [{ amplitude = 7, angular_frequency = 0.25 }]\n";
    for (mass, ratio) in MASSES
        .into_iter()
        .flat_map(|m| ratios().map(move |r| (m, r)))
    {
        let alpha = ratio * 2.0 * mass.sqrt();
        let works = |alpha: f64, force: &str| {
            let more = format!("{forced}{force}");
            let summary = run(&scenario(&text(
                "event-driven",
                [mass, alpha],
                [1.2, 0.0, 15.0],
                &more,
            )));
            let [of_damping, of_force] = [Statistic::DampingWorkMean, Statistic::UserForceWorkMean]
                .map(|statistic| of(&summary, statistic));
            let others = [
                Statistic::LargestSpeedMean,
                Statistic::FrictionWorkMean,
                Statistic::TemperatureWorkMean,
                Statistic::DisplacementEndMean,
                Statistic::SlipsPerPath,
            ]
            .map(|statistic| of(&summary, statistic));
            // Without a force its work is absent.
            let damping = of_damping - if of_force.is_nan() { 0.0 } else { of_force };
            (damping, others)
        };
        let wanted = works(alpha, "");
        for (alpha, force) in [
            (alpha, "force.expression = \"-1e-30*x^3\"".to_string()),
            (
                0.0,
                format!(
                    "force.expression = \"-{:?}*xdot - 1e-30*xdot^3\"",
                    2.0 * alpha
                ),
            ),
        ] {
            let found = works(alpha, &force);
            println!("m = {mass}, {ratio}, {force}: {found:?} {wanted:?}");
            let pairs = found.1.into_iter().zip(wanted.1);
            for (found, wanted) in pairs.chain([(found.0, wanted.0)]) {
                assert!(
                    (found - wanted).abs() <= 1e-9 * wanted.abs().max(1e-9),
                    "m = {mass}, {ratio}, {force}: {found} {wanted}"
                );
            }
        }
    }
}
