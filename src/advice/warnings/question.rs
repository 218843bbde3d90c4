//! Warnings about the scenario itself, whatever the scheme.

use super::case::Case;
use crate::advice::amplitude::NEVER_SD;
use crate::model::Drive;
use crate::scenario::{MAX_PERIODS, PeriodSource};
use crate::scheme::Timeline;
use stickslip_text::numbers::short;

/// The force |b| cannot reach the static friction f_s.
pub(super) fn never_slips(case: &Case) -> Option<String> {
    let model = &case.scenario.model;
    let largest = model.force_bound(NEVER_SD, case.scenario.time.end);
    // A user-defined force that depends on time is not known at every time.
    let is_known = !model.has_load()
        && !model
            .force
            .as_ref()
            .is_some_and(|force| force.depends_on_time());
    (is_known && largest <= model.friction.static_force && model.initial_velocity == 0.0).then(|| {
        format!(
            "the body never slips: |b| is at most {}, which does not exceed f_s. Every stick is \
             censored",
            short(largest)
        )
    })
}

pub(super) fn identical_paths(case: &Case) -> Option<String> {
    let paths = case.scenario.ensemble.paths;
    (!case.scenario.model.is_random() && paths > 1).then(|| {
        format!(
            "the scenario is deterministic: all {paths} paths are identical, and ensemble.paths \
            = 1 is enough"
        )
    })
}

pub(super) fn no_dilatation(case: &Case) -> Option<String> {
    let temperature = &case.scenario.model.temperature;
    let is_known =
        !temperature.harmonics.is_empty() || temperature.series.is_some() || temperature.has_line();
    let has_temperature = temperature.effective_noise().is_some() || is_known;
    let oscillator = &case.scenario.model.oscillator;
    (oscillator.force_per_temperature() == 0.0 && has_temperature).then(|| match oscillator.drive {
        Drive::Dilatation(beta) if beta != 0.0 => {
            "K beta = 0 without a spring: the temperature has no effect on the motion. Use \
             `oscillator.force_per_temperature` instead of `oscillator.dilatation`"
                .to_string()
        }
        Drive::Dilatation(_) => {
            "dilatation = 0: the temperature has no effect on the motion".to_string()
        }
        Drive::Force(_) => {
            "force_per_temperature = 0: the temperature has no effect on the motion".to_string()
        }
    })
}

/// There are too few periods to distinguish a drift from a transient.
pub(super) fn few_periods(case: &Case) -> Option<String> {
    let (timeline, fewest) = (case.scenario.timeline(), Timeline::FEWEST_PERIODS);
    let counted = timeline.counted_periods();
    let period = timeline.period.filter(|_| timeline.end > 0.0)?;
    (counted < fewest).then(|| {
        let what = match counted {
            0 => "no whole period is counted, so drift_velocity, diffusion_coefficient and the statistics \
                  from period to period will be absent"
                .to_string(),
            n => format!(
                "drift_velocity and diffusion_coefficient are estimated from {n} whole period{}, without the \
                 first of the run; with fewer than {fewest}, a drift cannot be distinguished from a \
                 transient",
                if n == 1 { "" } else { "s" },
            ),
        };
        let enough = (timeline.first_period() + fewest) as f64 * period;
        format!("{what}. Choose `time.end` = {} or more", short(enough))
    })
}

/// There are too many periods to record x at each of them.
pub(super) fn many_periods(case: &Case) -> Option<String> {
    let (derived, end) = (&case.derived, case.scenario.time.end);
    derived.period.is_some_and(|period| end / period.length > MAX_PERIODS as f64).then(|| {
        format!(
            "the run has {:e} periods, and x is recorded at the ends of at most {MAX_PERIODS}: drift_velocity \
             and diffusion_coefficient will be absent. Choose `statistics.period` = {} or more",
            derived.whole_periods,
            short(end / MAX_PERIODS as f64)
        )
    })
}

/// The harmonics have no common period, so x is compared at different phases.
pub(super) fn no_common_period(case: &Case) -> Option<String> {
    let temperature = &case.scenario.model.temperature;
    let is_moving = temperature
        .harmonics
        .iter()
        .any(|h| h.angular_frequency > 0.0 && h.amplitude != 0.0);
    let is_share = case
        .derived
        .period
        .is_some_and(|period| period.source == PeriodSource::Share);
    (temperature.series.is_none() && is_moving && is_share).then(|| {
        "the harmonics have no common period, so x is compared at different phases, which affects \
         drift_velocity, diffusion_coefficient and the period-to-period statistics. Choose \
         `statistics.period` close to whole cycles of the strongest harmonics"
            .to_string()
    })
}
