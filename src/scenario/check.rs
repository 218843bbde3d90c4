//! Consistency checks. The range of each single value is checked when it is read.

use super::TEMPERATURE_SERIES;
use super::limits::MAX_PHASE;
use super::time::check_end;
use super::{Ensemble, Scenario, Statistics};
use crate::model::{
    Drive, Friction, Harmonic, InitialNoise, LARGEST, OrnsteinUhlenbeck, Problem, Series,
    Temperature, can_be_computed_with, is_jump,
};
use crate::scheme::{CheckError, Scheme, divergence_bound};
use stickslip_text::numbers::short;

/// Samples this close, as a share of the whole series, are two values at the same time.
const CLOSEST: f64 = 1e-12;

impl Scenario {
    /// Check that the values are consistent. Each of them must already be in its range.
    pub fn check(&self) -> Result<(), CheckError> {
        self.check_errors().into_iter().next().map_or(Ok(()), Err)
    }

    /// All inconsistent values, as far as each can be checked independently.
    pub(crate) fn check_errors(&self) -> Vec<CheckError> {
        let Scenario {
            model,
            time,
            scheme,
            statistics,
            ensemble,
            ..
        } = self;
        let mut found: Vec<CheckError> = Vec::new();
        found.extend(friction(model));
        found.extend(model.temperature.noises.iter().filter_map(noise));
        found.extend(third_noise(&model.temperature));
        found.extend(self.check_white_noise());
        found.extend(pinned(&model.temperature));
        if found.is_empty() {
            found.extend(forces(model, time.end));
        }
        found.extend(self.series());
        found.extend(check_end(*scheme, time.end));
        // These use many values, so they are meaningful only if the previous checks pass.
        if found.is_empty() {
            let so_far = phases(model, time.end).or_else(|| check_extent(model, time.end));
            let so_far = so_far.or_else(|| scheme.check(model, time.end).err());
            found.extend(so_far.or_else(|| time.check_rows(*scheme)));
        }
        found.extend(statistics.check(time.end));
        found.extend(ensemble.check());
        found.extend(self.check_random());
        found
            .into_iter()
            .map(|check_error| self.as_written(check_error))
            .collect()
    }

    /// A measured temperature and every input need samples up to t_end that are not too close.
    fn series(&self) -> Option<CheckError> {
        let end = self.time.end;
        let temperature = self
            .model
            .temperature
            .series
            .iter()
            .filter(|_| {
                !self
                    .model
                    .random
                    .iter()
                    .any(|of| of.name == TEMPERATURE_SERIES)
            })
            .map(|series| ("the measured temperature".into(), series));
        let all: Vec<(String, _)> = temperature.chain(self.inputs()).collect();
        let close = |series: &Series| {
            Some(
                series
                    .times()
                    .windows(2)
                    .find(|t| t[1] - t[0] < CLOSEST * series.end() && !is_jump(t))?[1],
            )
        };
        if let Some((what, time)) = all
            .iter()
            .find_map(|(what, series)| Some((what, close(series)?)))
        {
            let problem = format!(
                "{what} has a sample at {time:e} that is within {CLOSEST:e} of its length from the one before"
            );
            return Some(CheckError::new(
                &[],
                problem,
                "remove one of these samples, or move them apart",
            ));
        }
        let (what, series) = all.into_iter().find(|(_, series)| end > series.end())?;
        let problem = format!(
            "`time.end` = {end:?} is beyond the last sample of {what}, at {:?}",
            series.end()
        );
        let remedy = "lower `time.end`, or leave it out to end with the series";
        Some(CheckError::new(&[("time.end", end)], problem, remedy))
    }

    /// The same scenario with another scheme. It is an error if the step or the tolerance of that
    /// scheme is inconsistent with the rest.
    ///
    /// ```
    /// use stickslip::scenario::Scenario;
    /// use stickslip::scheme::{CorrectedVi, EventDriven, Kind};
    ///
    /// let scenario = Scenario::shipped("rho025")?;
    /// let exact = scenario.with_scheme(EventDriven { tolerance: 1e-3 })?;
    /// assert_eq!((exact.scheme.kind(), exact.scheme.step()), (Kind::EventDriven, None));
    /// assert_eq!(exact.scheme.to_string(), "event-driven tolerance 0.001");
    /// // 60 is not a whole number of steps of 0.07: refused, with the nearest that are.
    /// assert!(scenario.with_scheme(CorrectedVi { step: 0.07 }).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_scheme(&self, scheme: impl Into<Scheme>) -> Result<Scenario, CheckError> {
        let changed = Scenario {
            scheme: scheme.into(),
            ..self.clone()
        };
        changed.check()?;
        Ok(changed)
    }
}

impl Ensemble {
    /// Antithetic paths come in pairs, so their number must be even.
    fn check(&self) -> Option<CheckError> {
        let paths = self.paths;
        if !self.antithetic || paths.is_multiple_of(2) {
            return None;
        }
        let problem = format!(
            "`ensemble.antithetic` needs an even number of paths, and `ensemble.paths` = \
            {paths} is odd"
        );
        let remedy = format!("write `paths = {}`", paths + 1);
        Some(CheckError::new(
            &[("ensemble.paths", paths as f64)],
            problem,
            remedy,
        ))
    }
}

impl Statistics {
    /// after < t_end, or after = 0 for no burn-in.
    fn check(&self, end: f64) -> Option<CheckError> {
        let after = self.after;
        if after == 0.0 || after < end {
            return None;
        }
        let problem = format!(
            "`statistics.after` = {after:?} leaves nothing to count before `time.end` = {end:?}"
        );
        let remedy = "lower `statistics.after`, or raise `time.end` to several periods beyond it";
        Some(CheckError::new(
            &[("statistics.after", after), ("time.end", end)],
            problem,
            remedy,
        ))
    }
}

/// f_d <= f_s, in each direction.
fn friction(model: &Problem) -> Option<CheckError> {
    let [forward, backward] = model.friction_by_direction();
    let is_forward = forward.dynamic_force > forward.static_force;
    let Friction {
        static_force: f_s,
        dynamic_force: f_d,
    } = if is_forward { forward } else { backward };
    if f_d <= f_s {
        return None;
    }
    let problem =
        format!("`friction.dynamic` = {f_d:?} must not exceed `friction.static` = {f_s:?}");
    let remedy = "lower `friction.dynamic` or raise `friction.static`";
    Some(CheckError::new(
        &[("friction.dynamic", f_d), ("friction.static", f_s)],
        problem,
        remedy,
    ))
}

/// The stationary standard deviations of v and of rho v are neither too large nor subnormal.
fn noise(noise: &OrnsteinUhlenbeck) -> Option<CheckError> {
    let sd = noise.stationary_sd();
    if can_be_computed_with(&[noise.intensity * sd, sd])
        && (noise.diffusion == 0.0 || sd.is_normal())
    {
        return None;
    }
    let about = [
        ("temperature.noise.diffusion", noise.diffusion),
        ("temperature.noise.relaxation_rate", noise.relaxation_rate),
    ];
    let problem = "gives a stationary sd of v, sigma / sqrt(2 theta), or of rho v, outside the range of \
        double precision";
    Some(CheckError::new(
        &about,
        problem,
        "choose units in which relaxation rate and diffusion are closer to 1",
    ))
}

/// There are at most two noises.
fn third_noise(temperature: &Temperature) -> Option<CheckError> {
    let third = temperature.noises.get(2)?;
    let remedy =
        "keep two of them, or merge those with similar relaxation rates (their variances add)";
    let problem = "is a third noise; at most two are supported";
    Some(CheckError::new(
        &[("temperature.noise.2.intensity", third.intensity)],
        problem,
        remedy,
    ))
}

/// K/m, alpha/m, b and b/m are neither too small nor too large for a double.
fn forces(model: &Problem, end: f64) -> Option<CheckError> {
    let Problem {
        oscillator,
        initial_displacement,
        ..
    } = model;
    let mass = ("oscillator.mass", oscillator.mass);
    let stiffness = ("oscillator.stiffness", oscillator.stiffness);
    if oscillator.stiffness > 0.0 && !oscillator.natural_frequency().powi(2).is_normal() {
        let problem = format!(
            "gives K/m = {:e}, outside the range of double precision",
            oscillator.stiffness / oscillator.mass
        );
        let remedy = "choose units in which mass and stiffness are closer to 1";
        return Some(CheckError::new(&[stiffness, mass], problem, remedy));
    }
    let rate = oscillator.damping_rate();
    if rate.abs() > LARGEST {
        let problem = format!("gives alpha/m = {rate:e}, which must not exceed 1e100");
        let remedy = "choose units in which mass and damping are closer to 1";
        return Some(CheckError::new(
            &[("oscillator.damping", oscillator.damping), mass],
            problem,
            remedy,
        ));
    }
    let largest = model.largest_force(end);
    let acceleration = largest / oscillator.mass;
    if can_be_computed_with(&[largest, acceleration]) {
        return None;
    }
    let (own, time) = model.largest_at_start(end);
    if own > 0.5 * largest || !own.is_finite() {
        let text = model
            .force
            .as_ref()
            .map_or(String::new(), |force| force.shown());
        let problem = format!(
            "`force.expression` = \"{}\" {} at x = {initial_displacement:?} (x0), xdot = 0, t = {time:?}, and \
             b/m reaches {}, which must not exceed {LARGEST:e}",
            text,
            if own.is_finite() {
                format!("has the size {}", short(own))
            } else {
                "is infinite".to_string()
            },
            short(acceleration)
        );
        let remedy = "write a force that is smaller there, or choose units in which mass and forces are closer to 1";
        return Some(CheckError::new(
            &[("force.expression", f64::NAN)],
            problem,
            remedy,
        ));
    }
    let problem = format!(
        "lets the force b = K (beta T - x) reach {largest:e} and b/m {acceleration:e}, which must not exceed \
         {LARGEST:e}"
    );
    let remedy = "lower the stiffness, dilatation, temperature or displacement, or change units";
    // The largest factor is named first, because it is most probably wrong.
    let drive = match oscillator.drive {
        Drive::Dilatation(beta) => ("oscillator.dilatation", beta),
        Drive::Force(c) => ("oscillator.force_per_temperature", c),
    };
    let mut factors = [
        stiffness,
        drive,
        ("initial.displacement", *initial_displacement),
    ];
    factors.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    Some(CheckError::new(&factors, problem, remedy))
}

/// The phases of all harmonics keep their digits up to t_end.
fn phases(model: &Problem, end: f64) -> Option<CheckError> {
    for (i, harmonic) in model
        .temperature
        .harmonics
        .iter()
        .enumerate()
        .filter(|(_, one)| one.amplitude != 0.0)
    {
        let Harmonic {
            angular_frequency: w,
            phase,
            ..
        } = *harmonic;
        let key = format!("temperature.harmonics.{i}");
        if phase.abs() > MAX_PHASE {
            let problem = format!(
                "`{key}.phase` = {phase:?} is above {MAX_PHASE:e}, where a phase loses its precision"
            );
            return Some(CheckError::new(
                &[],
                problem,
                format!("write the equivalent `phase = {:?}`", reduced(phase)),
            ));
        }
        let turned = w * end;
        if turned > MAX_PHASE {
            let problem = format!(
                "`time.end` = {end:?} lets w t reach {turned:e}, with `{key}.angular_frequency` = {w:?}; \
                 above {MAX_PHASE:e} the phase of the forcing loses its precision"
            );
            let remedy = "lower `time.end` or the frequency, or write `amplitude = 0`";
            return Some(CheckError::new(&[("time.end", end)], problem, remedy));
        }
    }
    None
}

/// The same phase between -pi and pi.
pub(crate) fn reduced(phase: f64) -> f64 {
    let (sin, cos) = libm::sincos(phase);
    libm::atan2(sin, cos)
}

/// Pinned noise needs a series of samples, must be the only noise, and is zero at the first sample.
fn pinned(temperature: &Temperature) -> Option<CheckError> {
    let noise = temperature
        .noises
        .first()
        .filter(|_| temperature.is_pinned)?;
    let (problem, remedy) = if temperature.series.is_none() {
        (
            "but there is no [temperature.series] to pin the noise to",
            "remove it, or add [temperature.series]",
        )
    } else if temperature.noises.len() > 1 {
        (
            "but there are two noises",
            "keep the faster one; the other hardly moves between samples",
        )
    } else if !matches!(noise.initial, InitialNoise::At(0.0)) {
        let problem = "so v is zero at the first sample, but `temperature.noise.initial` is not";
        (
            problem,
            "remove `temperature.noise.initial`, or set it to 0",
        )
    } else {
        return None;
    };
    let key = "temperature.noise.pinned";
    Some(CheckError::new(
        &[(key, 1.0)],
        format!("`{key}` = true, {problem}"),
        remedy,
    ))
}

/// |x| and |x'| stay small enough for a double up to `end`.
fn check_extent(model: &Problem, end: f64) -> Option<CheckError> {
    // The bound is that of motion without friction, because friction does not drive the body.
    // Negative damping does, but friction may confine the motion, and paths that run away are
    // counted.
    let mut free = model.clone();
    (free.friction.static_force, free.force) = (0.0, None);
    free.oscillator.damping = free.oscillator.damping.max(0.0);
    let extent = divergence_bound(&free, end);
    let rate = if model.oscillator.stiffness > 0.0 {
        model.oscillator.natural_frequency()
    } else {
        2.0 / end.max(1.0)
    };
    let speed = extent * rate;
    if can_be_computed_with(&[extent, speed]) {
        return None;
    }
    let problem = format!(
        "lets |x| grow towards {extent:e} and |x'| towards {speed:e}, which must not exceed {LARGEST:e}"
    );
    let remedy = "choose units in which displacements, times and forces are closer to 1, or lower `time.end`";
    Some(CheckError::new(&[("time.end", end)], problem, remedy))
}
