//! The discrete variational inequality exactly as the paper writes it: one path, plain arithmetic,
//! and a branch for every case.
//!
//! The fast kernel must give the same cascade from the same normals.

use stickslip::model::{Event, EventKind, InitialNoise, Problem, Sign};
use stickslip::noise::Transition;

/// Simulates one path for `steps` steps of length `h`. If there is noise, `normal` is called for
/// one standard normal number per step, and once before the first step for a stationary start.
/// Events are passed to `on_event`. Returns x and x' at the end.
pub fn reference_path(
    model: &Problem,
    h: f64,
    steps: u64,
    mut normal: impl FnMut() -> f64,
    mut on_event: impl FnMut(Event),
) -> (f64, f64) {
    let Problem {
        oscillator,
        friction,
        temperature,
        initial_displacement,
        initial_velocity,
        ..
    } = model;
    let (h_over_m, f_s, f_d) = (
        h / oscillator.mass,
        friction.static_force,
        friction.dynamic_force,
    );
    let noise = temperature.effective_noise();
    let transition = noise.map(|noise| Transition::new(noise.relaxation_rate, noise.diffusion, h));
    let mut eta = match noise {
        None => 0.0,
        Some(noise) => match noise.initial {
            InitialNoise::At(v) => v,
            InitialNoise::Stationary => noise.stationary_sd() * normal(),
        },
    };
    let rho = noise.map_or(0.0, |noise| noise.intensity);
    let force = |n: u64, x: f64, v: f64, eta: f64| {
        let time = n as f64 * h;
        model.total_force(time, temperature.deterministic(time) + rho * eta, x, v)
    };

    let (mut x, mut v) = (*initial_displacement, *initial_velocity);
    let mut b = force(0, x, v, eta);
    let mut is_static = v == 0.0 && b.abs() <= f_s;
    if !is_static {
        let direction = Sign::of(if v == 0.0 { b } else { v });
        on_event(Event {
            kind: EventKind::SlipStarted(direction),
            time: 0.0,
            displacement: x,
            force: b,
        });
    }
    for n in 0..steps {
        let s = v + h_over_m * b;
        let next_v = if s.abs() <= h_over_m * f_s {
            0.0
        } else {
            s - (h_over_m * f_d).copysign(s)
        };
        let next_x = x + h * v;
        if let Some(transition) = &transition {
            eta = transition.next(eta, normal());
        }
        let next_b = force(n + 1, next_x, next_v, eta);

        if is_static && next_v != 0.0 {
            is_static = false;
            let kind = EventKind::SlipStarted(Sign::of(next_v));
            on_event(Event {
                kind,
                time: n as f64 * h,
                displacement: x,
                force: b,
            });
        } else if !is_static && (next_v == 0.0 || v * next_v < 0.0) {
            is_static = next_v == 0.0 && next_b.abs() <= f_s;
            let kind = match (is_static, next_v == 0.0) {
                (true, _) => EventKind::StickEntered,
                (false, true) => EventKind::SubPhaseBoundary(Sign::of(next_b)),
                (false, false) => EventKind::SubPhaseBoundary(Sign::of(next_v)),
            };
            on_event(Event {
                kind,
                time: (n + 1) as f64 * h,
                displacement: next_x,
                force: next_b,
            });
        }
        (x, v, b) = (next_x, next_v, next_b);
    }
    (x, v)
}
