//! White noise by its name, against the stationary laws of de Gennes, *J. Stat. Phys.* 119 (2005).

use super::measures::{body, run, scenario};
use stickslip::stats::Statistic;

/// The mean of |x'| under white noise of strength D, friction f and damping alpha.
fn mean_speed(strength: f64, friction: f64, damping: f64, theta: &str) -> [f64; 2] {
    let (after, end) = (10.0, 60.0);
    let more = format!(
        "temperature.noise = {{ kind = \"white\", strength = {strength:?}{theta} }}
         ensemble = {{ paths = 150, seed = 9 }}
         scheme = {{ kind = \"event-driven\" }}"
    );
    let scene = scenario(&body(
        [0.0, damping],
        [friction; 2],
        [end, after, end],
        &more,
    ));
    let speed = *run(&scene).estimate(Statistic::SlidingPathRate);
    [speed.estimate, speed.standard_error]
}

/// p(x') ~ exp(-(alpha x'^2 + f |x'|)/D), so that the mean of |x'| is D/f without damping, and by
/// quadrature with it. Null: the scheme has this law but for the tolerance of 0.1 %. Sample size: 150
/// paths of 50. False-alarm rate: 4 standard errors, 1 in 16 000 each; these are 1 %, and a strength
/// that is 2 times too large makes the mean larger by a half or more.
#[test]
fn a_body_in_white_noise_has_the_speed_of_its_stationary_law() {
    for (strength, friction, damping) in [(0.5, 1.0, 0.0), (0.5, 0.3, 1.0)] {
        let weight = |v: f64| (-(damping * v * v + friction * v) / strength).exp();
        let nodes = (0..400_000).map(|i| 1e-4 * (f64::from(i) + 0.5));
        let [mass, mean] = nodes.fold([0.0; 2], |[mass, mean], v| {
            [mass + weight(v), mean + v * weight(v)]
        });
        let [found, error] = mean_speed(strength, friction, damping, "");
        println!("{found:.4} +- {error:.4}, {:.4}", mean / mass);
        assert!(
            (found - mean / mass).abs() < 4.0 * error + 0.002 * found,
            "{found} +- {error}, {}",
            mean / mass
        );
    }
}

/// What is simulated has the strength D = (rho sigma/theta)^2/2, and forgets in the tolerance, 0.001,
/// of the shortest time in which the body does: by friction D/f^2, by the spring 1/w0, or by damping
/// m/(2 alpha).
#[test]
fn white_noise_forgets_far_faster_than_the_body() {
    for (strength, friction, [stiffness, damping], memory) in [
        (0.5, 1.0, [0.0, 0.25], 0.5),
        (0.5, 0.3, [0.0, 1.0], 0.5),
        (0.5, 0.3, [16.0, 0.5], 0.25),
        (0.5, 0.0, [1.0, 2.5], 0.2),
    ] {
        let more = format!(
            "temperature.noise = {{ kind = \"white\", strength = {strength:?} }}
             scheme = {{ kind = \"event-driven\" }}"
        );
        let scene = scenario(&body(
            [stiffness, damping],
            [friction; 2],
            [60.0, 10.0, 60.0],
            &more,
        ));
        let noise = scene.model.temperature.noises[0];
        let found = (noise.intensity * noise.diffusion / noise.relaxation_rate).powi(2) / 2.0;
        assert!((found / strength - 1.0).abs() < 1e-12, "{noise:?}");
        assert!(
            (noise.relaxation_rate * memory / 1e3 - 1.0).abs() < 1e-12,
            "{noise:?}, {memory}"
        );
    }
}

/// The error is of order 1/theta: a slow noise moves the body less, and runs at theta and 4 theta
/// extrapolate to D/f. Null: (4 b - a)/3 is off by less than 4 of its standard errors.
#[test]
fn two_runs_extrapolate_to_white_noise() {
    let [slow, fast] =
        [20, 80].map(|theta| mean_speed(0.5, 1.0, 0.0, &format!(", relaxation_rate = {theta}")));
    let limit = (4.0 * fast[0] - slow[0]) / 3.0;
    println!("{slow:?} {fast:?} {limit}");
    assert!(0.5 - slow[0] > 6.0 * slow[1], "{slow:?}");
    assert!(
        (limit - 0.5).abs() < 4.0 * (4.0 * fast[1]).hypot(slow[1]) / 3.0,
        "{limit}"
    );
}
