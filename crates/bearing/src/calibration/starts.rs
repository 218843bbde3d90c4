//! The paper's least-squares fit from several starts.

use super::bearing::Response;
use super::evolve;
use super::hold::row;
use super::motion::Motion;
use super::objective::FitObjective;
use super::quantity::{Quantity, values};
use super::question::CalibrationQuestion;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use stickslip::ensemble::in_order;

/// The box in which A, G and xi(0) are searched: the interval of each.
pub type Search = [[f64; 2]; 3];

/// The box around a motion computed from slips, with the standard deviations of A and G. It is wide
/// enough to contain the minimum almost certainly. The ends of the intervals of A and G are
/// positive.
pub fn around(motion: &Motion, [reach, jump]: [f64; 2]) -> Search {
    let Motion {
        reach: a,
        jump: g,
        start,
    } = *motion;
    let [reach, jump] = [reach, jump].map(|sd| if sd.is_nan() { 0.0 } else { sd });
    let a_away = (4.0 * reach).clamp(0.08 * a, 0.9 * a);
    let g_away = (4.0 * jump).clamp(0.2 * g, 0.95 * g);
    [
        [a - a_away, a + a_away],
        [g - g_away, g + g_away],
        [start - 1.2 * g - a_away, start + 1.2 * g + a_away],
    ]
}

/// The box around a guessed motion.
pub fn around_guess(motion: &Motion) -> Search {
    let Motion {
        reach: a,
        jump: g,
        start,
    } = *motion;
    let g = if g > 0.0 { g } else { 0.1 * a };
    [
        [0.3 * a, 3.0 * a],
        [0.1 * g, 4.0 * g],
        [start - 1.5 * a, start + 1.5 * a],
    ]
}

/// The result of one start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchStart {
    /// err divided by the measured time: the mean square of model minus measurement.
    pub err: f64,
    /// The response at that minimum.
    pub response: Response,
}

/// Run all starts of a question on these threads. Each is an independent search with its own random
/// numbers. Stopped searches are left out.
pub fn starts(
    objective: &FitObjective,
    search: &Search,
    question: &CalibrationQuestion,
    threads: usize,
    stop: &AtomicBool,
) -> Vec<SearchStart> {
    let motion = |[reach, jump, start]: [f64; 3]| Motion {
        reach,
        jump: jump.min(2.0 * reach),
        start,
    };
    let shear = question.shear_stiffness.unwrap_or(1.0);
    let best = |motion: &Motion| {
        if question.held.is_empty() {
            return objective.of(motion);
        }
        let rows: Vec<_> = question
            .held
            .iter()
            .map(|held| row(held, motion, shear))
            .collect();
        objective.held(motion, &rows)
    };
    let outside = |response: &Response| {
        let values = values(response, Some(shear));
        let far = |(quantity, [low, high]): &(Quantity, [f64; 2])| {
            let value = values[*quantity as usize];
            (low - value).max(value - high).max(0.0) / (high - low)
        };
        question.bounds.iter().map(far).sum::<f64>()
    };
    let value = |x: &[f64; 3]| {
        let motion = motion(*x);
        let (err, sensor) = best(&motion);
        if question.bounds.is_empty() {
            err
        } else {
            err * (1.0 + 100.0 * outside(&Response { motion, sensor }))
        }
    };
    // xi moves on the lattice xi(0) + n G. A start shifted by G gives the same motion once both
    // bodies have slipped.
    let leap = |[reach, jump, start]: [f64; 3], direction: f64| {
        [reach, jump, start + jump.copysign(direction)]
    };
    let make = |number: u64| {
        let (at, _) = evolve::lowest(search, number, leap, value, || stop.load(Ordering::Relaxed))?;
        let (err, sensor) = best(&motion(at));
        Some(SearchStart {
            err: err / objective.duration(),
            response: Response {
                motion: motion(at),
                sensor,
            },
        })
    };
    let mut all = Vec::new();
    let deliver = |start: Option<SearchStart>| {
        all.extend(start);
        Ok::<_, Infallible>(ControlFlow::Continue(()))
    };
    let _ = in_order(question.starts.into(), threads, stop, make, deliver);
    all
}
