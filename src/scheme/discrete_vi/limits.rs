//! The steps that can be computed with doubles: the products of a step with mass, forces and noise
//! must be doubles with all their digits.

use crate::model::{InitialNoise, Problem, can_be_computed_with};
use crate::noise::Transition;
use crate::scheme::CheckError;

/// Checks that h/m and its products with the friction forces are finite, and not so small that
/// digits are lost.
pub(super) fn check_step(model: &Problem, h: f64, end: f64) -> Result<(), CheckError> {
    let h_over_m = h / model.oscillator.mass;
    let usable = |x: f64| x == 0.0 || x.is_normal();
    let thresholds = [model.friction.static_force, model.friction.dynamic_force];
    let is_usable = h.is_normal()
        && h_over_m.is_normal()
        && thresholds
            .iter()
            .all(|f| usable(*f) && (*f == 0.0 || (h_over_m * f).is_normal()))
        && (h_over_m * model.largest_force(end)).is_finite();
    if is_usable {
        return Ok(());
    }
    let problem = format!(
        "gives h/m = {h_over_m:e} or a threshold h f_s/m outside the range of double precision"
    );
    Err(CheckError::new(
        &[("time.step", h)],
        problem,
        "choose units in which mass, forces and step are closer to 1",
    ))
}

/// Checks that v can be counted in increments of one step: the increments must be doubles with all
/// their digits, and so must v(0) in units of them.
pub(super) fn check_increments(model: &Problem, h: f64) -> Result<(), CheckError> {
    let Some(noise) = model
        .temperature
        .effective_noise()
        .filter(|noise| noise.diffusion > 0.0)
    else {
        return Ok(());
    };
    let increment = Transition::new(noise.relaxation_rate, noise.diffusion, h).increment_sd;
    let start = if let InitialNoise::At(v) = noise.initial {
        v.abs()
    } else {
        noise.stationary_sd()
    };
    if increment.is_normal() && can_be_computed_with(&[start / increment]) {
        return Ok(());
    }
    let problem = format!(
        "moves v by {increment:e} per step h = {h:?}, too little to resolve against its start {start:e}"
    );
    let remedy = "set `diffusion = 0` to let v relax from v(0), raise it, or choose `scheme.kind = \"event-driven\"`";
    Err(CheckError::new(
        &[("temperature.noise.diffusion", noise.diffusion)],
        problem,
        remedy,
    ))
}

/// Checks that the noise is one process that runs on from step to step. The kernels carry one v per
/// path, and would be slower for every scene if they carried two. Nor do the steps end at the
/// samples at which noise may be pinned.
pub(super) fn check_noise(model: &Problem) -> Result<(), CheckError> {
    if model.temperature.has_two_noises() {
        let problem = "there are two noises; schemes with a time step support one".to_string();
        let remedy = "choose `scheme.kind = \"event-driven\"` or `scheme.kind = \"quasi-static\"`, or remove one of them";
        return Err(CheckError::new(
            &[("temperature.noise", 2.0)],
            problem,
            remedy,
        ));
    }
    if !(model.temperature.is_pinned && model.temperature.is_random()) {
        return Ok(());
    }
    let problem = "`temperature.noise.pinned` = true is not supported by schemes with a time step"
        .to_string();
    let remedy = "choose `scheme.kind = \"event-driven\"` or `scheme.kind = \"quasi-static\"`";
    Err(CheckError::new(&[], problem, remedy))
}
