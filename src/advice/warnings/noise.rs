//! Warnings about stick exits under noise: checked only once per step, corrected for this, or
//! resolved only down to a limit.

use super::case::Case;
use super::noisy_step::NoisyStep;
use crate::scheme::Resolution;
use stickslip_text::numbers::short;

pub(super) fn against_stick_band(case: &Case) -> Option<String> {
    let step = case.checked.as_ref()?;
    step.crosses_stick_band().then(|| {
        format!(
            "the step {} is long compared with {}, the time in which the noise crosses the stick band, \
             (f_s/(K beta rho sigma))^2: stick counts and durations will be inaccurate",
            short(step.h),
            short(step.crossing_time)
        )
    })
}

/// Relative to f_s, the shift above which second-order errors of the corrected scheme become
/// visible.
const LARGE_SHIFT: f64 = 0.2;

/// The correction of the stick exit is not small relative to f_s.
pub(super) fn large_shift(case: &Case) -> Option<String> {
    let step = case.corrected.as_ref()?;
    let (shift, static_force) = (step.shift, step.friction.static_force);
    (shift > LARGE_SHIFT * static_force).then(|| {
        format!(
            "the corrected stick exit lowers f_s = {} by {}, which is not small: stick durations may be off \
             by several percent. The shift falls like sqrt(h); `scheme.kind = \"event-driven\"` needs no correction",
            short(static_force),
            short(shift)
        )
    })
}

pub(super) fn incomplete_correction(case: &Case) -> Option<String> {
    let step = case.corrected.as_ref()?;
    step.exceeds_gap().then(|| {
        let remedy = if step.gap() > 0.0 {
            let largest_step = step.h * (step.gap() / step.shift).powi(2);
            format!(
                "Choose time.step below {}, or `scheme.kind = \"event-driven\"`",
                short(largest_step)
            )
        } else {
            "No step is short enough; `scheme.kind = \"event-driven\"` needs no correction"
                .to_string()
        };
        format!(
            "the corrected stick exit would lower f_s by {}, but not below f_d, and f_s - f_d is \
             only {}: the correction is incomplete, and sticks are too long. {remedy}",
            short(step.shift),
            short(step.gap())
        )
    })
}

pub(super) fn equal_friction(case: &Case) -> Option<String> {
    case.noisy_step().is_some_and(NoisyStep::has_equal_friction).then(|| {
        "f_s = f_d under noise: slips have all sizes down to zero, so the number of sticks grows \
         without bound as the step decreases. Stick counts and durations depend on the step, \
         which their error bars do not include; sticking fraction and positions converge"
            .to_string()
    })
}

/// Relative error of the mean stick duration, divided by sqrt(h / crossing time). It was measured
/// between h = 0.001 and 0.02 in the scene with rho = 0.25 and forcing 1/4 (1.7 to 1.9). For other
/// scenarios it is only a guide.
const STICK_BIAS: f64 = 1.8;
/// The relative bias below which not to warn.
const SMALL_BIAS: f64 = 0.01;

/// A relative bias in percent, as a guide.
fn percent(relative: f64) -> String {
    short((relative * 100.0).round().max(1.0))
}

/// The scheme checks only once per step whether a stick has ended, which causes an error of order
/// sqrt(h). It does not apply if stick durations are meaningless at this step.
pub(super) fn stick_exit_bias(case: &Case) -> Option<String> {
    let step = case.checked.as_ref()?;
    let means_something = !step.has_equal_friction() && !step.crosses_stick_band();
    let relative = STICK_BIAS * (step.h / step.crossing_time).sqrt();
    (means_something && relative > SMALL_BIAS).then(|| {
        format!(
            "the scheme checks only once per step whether a stick has ended, so sticks are too long, by \
             roughly {} % on average. The error falls like sqrt(h) and is not part of the confidence \
             intervals. `scheme.kind = \"corrected-vi\"` has a smaller error, of order h, and `scheme.kind = \"event-driven\"` \
             has none",
            percent(relative)
        )
    })
}

/// Relative error of the mean stick duration of the corrected scheme, divided by h / return time,
/// and the value of h / return time above which it no longer grows. They were measured between h =
/// 0.000625 and 0.02 in the same scene (0.15 to 0.18 below 0.3; 8 % at 0.01 and at 0.02).
const CORRECTED_BIAS: f64 = 0.17;
const CORRECTED_BIAS_GROWS_TO: f64 = 0.5;

/// The error of the corrected scheme itself, which is of order h. It does not apply if stick
/// durations are meaningless, or if the error of an incomplete correction is larger.
pub(super) fn corrected_bias(case: &Case) -> Option<String> {
    let step = case.corrected.as_ref()?;
    let is_corrected = !step.has_equal_friction() && !step.exceeds_gap();
    let relative = CORRECTED_BIAS * (step.h / step.return_time).min(CORRECTED_BIAS_GROWS_TO);
    (is_corrected && relative > SMALL_BIAS).then(|| {
        format!(
            "the corrected scheme makes sticks too short, by roughly {} % on average. The error falls like h \
             and is not part of the confidence intervals. `scheme.kind = \"event-driven\"` has none",
            percent(relative)
        )
    })
}

/// The step is longer than the time in which a slip that has just begun may reverse. If f_s = f_d,
/// every step is, which another warning reports.
pub(super) fn micro_slips(case: &Case) -> Option<String> {
    let step = case.noisy_step()?;
    (!step.has_equal_friction() && step.h > step.return_time).then(|| {
        format!(
            "slips shorter than the step are missed: under this noise a slip can reverse within ((f_s - \
             f_d)/(K beta rho sigma))^2 = {}, and the step is {}",
            short(step.return_time),
            short(step.h)
        )
    })
}

/// f_s = f_d, or nearly so, under noise: the numbers and durations of sticks depend on the
/// resolution of a scheme without a step.
pub(super) fn unresolved(case: &Case) -> Option<String> {
    let is_exact = case.step.is_none() && case.slip.is_none();
    let Resolution {
        static_force,
        shortest_slip,
    } = case.derived.resolution?;
    is_exact.then(|| {
        format!(
            "f_s and f_d are equal, or nearly so, under noise: slips have all sizes down to zero. \
             Slips shorter than about {} are not resolved, and f_s = {static_force:?} is \
             simulated. Stick counts and durations depend on that resolution, which is set by \
             scheme.tolerance and not included in their error bars; sticking fraction and \
             positions converge",
            short(shortest_slip)
        )
    })
}

/// White noise is approximated by a fast OU process.
pub(super) fn white(case: &Case) -> Option<String> {
    let share = match case
        .scenario
        .written
        .white_noise?
        .share(&case.scenario.model)
    {
        Some(share) => format!("{} of the shortest velocity relaxation time", short(share)),
        None => "an unknown share of the velocity relaxation time".to_string(),
    };
    let theta = case
        .scenario
        .model
        .temperature
        .noises
        .first()?
        .relaxation_rate;
    Some(format!(
        "white noise is approximated by noise with correlation time 1/theta = {}, {share}: statistics have a \
         relative error of this order. Under true white noise the body never sticks, so sticks and slips depend on \
         theta (`temperature.noise.relaxation_rate`); compare runs at theta and 4 theta to estimate the limit",
        short(1.0 / theta)
    ))
}
