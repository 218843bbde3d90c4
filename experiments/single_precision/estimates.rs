//! The quantities that the experiment compares: four statistics, each with the contribution of
//! every path.

use crate::prototype::Cascade;

/// An estimate, and the contribution of each path to it to first order.
pub struct Estimate {
    pub name: &'static str,
    pub value: f64,
    pub parts: Vec<f64>,
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The standard error of a mean over paths.
pub fn standard_error(parts: &[f64]) -> f64 {
    let centre = mean(parts);
    let squares: Vec<f64> = parts.iter().map(|part| (part - centre).powi(2)).collect();
    (mean(&squares) / (parts.len() - 1) as f64).sqrt()
}

pub fn estimates(h: f64, end: f64, paths: &[Cascade]) -> [Estimate; 4] {
    let each = |read: &dyn Fn(&Cascade) -> f64| -> Vec<f64> { paths.iter().map(read).collect() };
    let (sticks, times) = (each(&|c| c.sticks as f64), each(&|c| c.stick_steps as f64 * h));
    let sticks_mean = mean(&sticks);
    let duration = mean(&times) / sticks_mean;
    let durations = times.iter().zip(&sticks).map(|(time, n)| (time - duration * n) / sticks_mean).collect();
    let shares = each(&|c| c.static_steps as f64 * h / end);
    let x_mean = mean(&each(&|c| c.x_end));
    let squares = each(&|c| (c.x_end - x_mean).powi(2));
    let sd = mean(&squares).sqrt();
    [
        Estimate { name: "stick_duration_mean", value: duration, parts: durations },
        Estimate { name: "sticks_per_path", value: sticks_mean, parts: sticks },
        Estimate { name: "sticking_fraction", value: mean(&shares), parts: shares },
        Estimate { name: "displacement_end_sd", value: sd, parts: squares.iter().map(|s| s / (2.0 * sd)).collect() },
    ]
}
