//! Every dimension and variable of a run, in one table for writers and readers: name, axes, unit
//! and meaning. The columns of single paths are declared where they are kept
//! ([`crate::stats::PathColumns`], [`crate::stats::EventColumns`],
//! [`crate::stats::TrajectoryRows`]).

pub(crate) use crate::stats::column::{BARE_DIMENSION, Described, Unit, Variable, variable};

/// Declares the variables together with the list of all of them, so that the list is complete.
macro_rules! table {
    ($($constant:ident = $value:expr;)*) => {
        $(pub(crate) const $constant: Variable = $value;)*
        /// Every variable, in the order of the documentation.
        #[cfg(test)]
        pub(crate) const ALL: &[&Variable] = &[$(&$constant),*];
    };
}

/// Declares the two ends of the interval of each variable, and the list of all such pairs.
macro_rules! ends {
    ($($constant:ident = $name:literal, $axes:expr, $unit:expr, $what:literal;)*) => {
        $(pub(crate) const $constant: [Variable; 2] = [
            variable(concat!($name, "_low"), $axes, $unit, concat!("lower end of the 95 % confidence interval of the ", $what)),
            variable(concat!($name, "_high"), $axes, $unit, concat!("upper end of the 95 % confidence interval of the ", $what)),
        ];)*
        /// Every pair of ends.
        #[cfg(test)]
        pub(crate) const ALL_ENDS: &[&[Variable; 2]] = &[$(&$constant),*];
    };
}

const PER_STATISTIC: &[(&str, &str)] = &[("coordinates", "statistic_long_name statistic_unit")];
const PER_BIN: &[(&str, &str)] = &[("coordinates", "duration_bin_lower")];

table! {
    STATISTIC = variable("statistic", &["statistic"], Unit::None, "name of the statistic");
    STATISTIC_LONG_NAME = variable("statistic_long_name", &["statistic"], Unit::None, "what the statistic is");
    STATISTIC_UNIT = variable("statistic_unit", &["statistic"], Unit::None, "unit of the statistic");
    ESTIMATE = variable("estimate", &["statistic"], Unit::None, "estimate").with(PER_STATISTIC);
    STANDARD_ERROR = variable("standard_error", &["statistic"], Unit::None,
        "standard error of the estimate, the path being the independent unit").with(PER_STATISTIC);
    INTERVAL_LOW = variable("interval_low", &["statistic"], Unit::None,
        "lower end of the 95 % confidence interval").with(PER_STATISTIC);
    INTERVAL_HIGH = variable("interval_high", &["statistic"], Unit::None,
        "upper end of the 95 % confidence interval").with(PER_STATISTIC);
    BIAS = variable("bias", &["statistic"], Unit::None,
        "estimated discretisation bias, missing where unknown").with(PER_STATISTIC);
    BIAS_UNCERTAINTY = variable("bias_uncertainty", &["statistic"], Unit::None,
        "95 % uncertainty of the discretisation bias").with(PER_STATISTIC);
    BIAS_ORDER = variable("bias_order", &["statistic"], Unit::None,
        "observed order p of the bias in the time step, as in C h^p, missing where unknown").with(PER_STATISTIC);
    ESTIMATE_CORRECTED = variable("estimate_corrected", &["statistic"], Unit::None,
        "estimate with its bias removed as far as it is known, missing where unknown").with(PER_STATISTIC);
    ESTIMATE_CORRECTED_LOW = variable("estimate_corrected_low", &["statistic"], Unit::None,
        "lower end of the 95 % interval of the corrected estimate").with(PER_STATISTIC);
    ESTIMATE_CORRECTED_HIGH = variable("estimate_corrected_high", &["statistic"], Unit::None,
        "upper end of the 95 % interval of the corrected estimate").with(PER_STATISTIC);

    TIME = variable("time", &["time"], Unit::TIME, "time").with(&[("axis", "T")]);
    QUANTILE = variable("quantile", &["quantile"], Unit::ONE, "quantile level");
    DISPLACEMENT_MEAN = variable("displacement_mean", &["time"], Unit::LENGTH, "mean of the displacement");
    DISPLACEMENT_SD = variable("displacement_sd", &["time"], Unit::LENGTH, "standard deviation of the displacement");
    DISPLACEMENT_QUANTILE = variable("displacement_quantile", &["quantile", "time"], Unit::LENGTH,
        "quantiles of the displacement");
    VELOCITY_MEAN = variable("velocity_mean", &["time"], Unit::VELOCITY, "mean of the velocity");
    VELOCITY_SD = variable("velocity_sd", &["time"], Unit::VELOCITY, "standard deviation of the velocity");
    VELOCITY_QUANTILE = variable("velocity_quantile", &["quantile", "time"], Unit::VELOCITY,
        "quantiles of the velocity");
    TEMPERATURE_MEAN = variable("temperature_mean", &["time"], Unit::TEMPERATURE, "mean of the temperature");
    TEMPERATURE_SD = variable("temperature_sd", &["time"], Unit::TEMPERATURE, "standard deviation of the temperature");
    TEMPERATURE_QUANTILE = variable("temperature_quantile", &["quantile", "time"], Unit::TEMPERATURE,
        "quantiles of the temperature");
    STATIC_PROBABILITY = variable("static_probability", &["time"], Unit::ONE, "probability of being in a static phase");

    SERIES_TIME = variable("series_time", &["series_time"], Unit::TIME, "time of a sample of the measured temperature");
    SERIES_TEMPERATURE = variable("series_temperature", &["series_time"], Unit::TEMPERATURE, "measured temperature");

    DURATION_BIN = variable("duration_bin", &["duration_bin"], Unit::TIME, "upper edge of the stick duration bin");
    DURATION_BIN_LOWER = variable("duration_bin_lower", &["duration_bin"], Unit::TIME,
        "lower edge of the stick duration bin, itself inside the bin");
    STICK_DURATION_COUNT = variable("stick_duration_count", &["duration_bin"], Unit::ONE,
        "completed sticks, the first of each path left out").with(PER_BIN);
    STICK_DURATION_CENSORED_COUNT = variable("stick_duration_censored_count", &["duration_bin"], Unit::ONE,
        "sticks still running at the end, by their duration so far, the first of each path left out").with(PER_BIN);
    STICK_DURATION_SURVIVAL = variable("stick_duration_survival", &["duration_bin"], Unit::ONE,
        "probability that a stick lasts beyond the upper edge of the bin (Kaplan-Meier)").with(PER_BIN);
    STICK_DURATION_QUANTILE = variable("stick_duration_quantile", &["quantile"], Unit::TIME,
        "quantiles of the completed stick durations");
    STICK_DURATION_COMPLETED = variable("stick_duration_completed", &[], Unit::ONE,
        "completed sticks, the first of each path left out");
    STICK_DURATION_CENSORED = variable("stick_duration_censored", &[], Unit::ONE,
        "sticks still running at the end, the first of each path left out");
    FIRST_STICK_COMPLETED = variable("first_stick_duration_completed", &[], Unit::ONE, "first sticks that ended");
    FIRST_STICK_CENSORED = variable("first_stick_duration_censored", &[], Unit::ONE,
        "first sticks still running at the end");

    SUB_PHASE = variable("sub_phase", &["sub_phase"], Unit::ONE,
        "sub-phases of a dynamic phase; the last entry stands for this many or more");
    SUB_PHASE_COUNT = variable("sub_phase_count", &["sub_phase"], Unit::ONE,
        "completed dynamic phases with so many sub-phases");
    SUB_PHASE_SHARE = variable("sub_phase_share", &["sub_phase"], Unit::ONE,
        "share of the completed dynamic phases that have so many sub-phases");
    SUB_PHASE_CENSORED = variable("sub_phase_censored", &[], Unit::ONE, "dynamic phases still running at the end");

    PERIOD = variable("period", &["period"], Unit::ONE, "number of whole forcing periods");
    PERIOD_TIME = variable("period_time", &["period"], Unit::TIME, "end of the forcing period");
    DISPLACEMENT_PERIOD_MEAN = variable("displacement_period_mean", &["period"], Unit::LENGTH,
        "mean of the displacement since the start, at the end of the period").with(&[("coordinates", "period_time")]);
    DISPLACEMENT_PERIOD_VARIANCE = variable("displacement_period_variance", &["period"], Unit::AREA,
        "variance of the displacement at the end of the period").with(&[("coordinates", "period_time")]);

    TRANSIENT_END = variable("transient_end", &[], Unit::TIME, "time from which on statistics count");
    TRANSIENT_STICKS = variable("transient_sticks", &[], Unit::ONE,
        "completed sticks that began before that, the first of each path left out");
    TRANSIENT_SLIPS = variable("transient_slips", &[], Unit::ONE, "completed dynamic phases that began before that");
    TRANSIENT_DISPLACEMENT = variable("transient_displacement", &[], Unit::LENGTH,
        "mean displacement from the start to that time");
    TRANSIENT_DISPLACEMENT_ERROR = variable("transient_displacement_error", &[], Unit::LENGTH,
        "standard error of that mean, the path being the independent unit");

    DIVERGED_PATH = variable("diverged_path", &["diverged_path"], Unit::ONE,
        "numbers of the paths that diverged or were given up, which are in no statistic");

    PART_STATE = variable("part_state", &["part_state"], Unit::None,
        "state of a part of a run, from which mc merge joins it to the others");

    PATH = variable("path", &["path"], Unit::ONE, "path number");
    EVENT = variable("event", &["event"], Unit::None, BARE_DIMENSION);
    TRAJECTORY_BEARING = variable("trajectory_bearing_displacement", &["trajectory", "time"], Unit::LENGTH,
        "displacement that a sensor at the bearing shows");
}

ends! {
    DISPLACEMENT_MEAN_ENDS = "displacement_mean", &["time"], Unit::LENGTH, "mean of the displacement";
    DISPLACEMENT_SD_ENDS = "displacement_sd", &["time"], Unit::LENGTH, "standard deviation of the displacement";
    DISPLACEMENT_QUANTILE_ENDS = "displacement_quantile", &["quantile", "time"], Unit::LENGTH,
        "quantiles of the displacement";
    VELOCITY_MEAN_ENDS = "velocity_mean", &["time"], Unit::VELOCITY, "mean of the velocity";
    VELOCITY_SD_ENDS = "velocity_sd", &["time"], Unit::VELOCITY, "standard deviation of the velocity";
    VELOCITY_QUANTILE_ENDS = "velocity_quantile", &["quantile", "time"], Unit::VELOCITY, "quantiles of the velocity";
    TEMPERATURE_MEAN_ENDS = "temperature_mean", &["time"], Unit::TEMPERATURE, "mean of the temperature";
    TEMPERATURE_SD_ENDS = "temperature_sd", &["time"], Unit::TEMPERATURE, "standard deviation of the temperature";
    TEMPERATURE_QUANTILE_ENDS = "temperature_quantile", &["quantile", "time"], Unit::TEMPERATURE,
        "quantiles of the temperature";
    STATIC_PROBABILITY_ENDS = "static_probability", &["time"], Unit::ONE, "probability of being in a static phase";

    STICK_DURATION_COUNT_ENDS = "stick_duration_count", &["duration_bin"], Unit::ONE,
        "expected number of sticks in the bin, among as many completed ones";
    STICK_DURATION_CENSORED_COUNT_ENDS = "stick_duration_censored_count", &["duration_bin"], Unit::ONE,
        "expected number of sticks still running at the end in the bin, in as many paths";
    STICK_DURATION_SURVIVAL_ENDS = "stick_duration_survival", &["duration_bin"], Unit::ONE,
        "probability that a stick lasts beyond the upper edge of the bin";
    STICK_DURATION_QUANTILE_ENDS = "stick_duration_quantile", &["quantile"], Unit::TIME,
        "quantiles of the completed stick durations";
    STICK_DURATION_COMPLETED_ENDS = "stick_duration_completed", &[], Unit::ONE,
        "expected number of completed sticks in as many paths";
    STICK_DURATION_CENSORED_ENDS = "stick_duration_censored", &[], Unit::ONE,
        "expected number of sticks still running at the end in as many paths";
    FIRST_STICK_COMPLETED_ENDS = "first_stick_duration_completed", &[], Unit::ONE,
        "expected number of first sticks that ended in as many paths";
    FIRST_STICK_CENSORED_ENDS = "first_stick_duration_censored", &[], Unit::ONE,
        "expected number of first sticks still running at the end in as many paths";

    SUB_PHASE_COUNT_ENDS = "sub_phase_count", &["sub_phase"], Unit::ONE,
        "expected number of dynamic phases with so many sub-phases, among as many completed ones";
    SUB_PHASE_SHARE_ENDS = "sub_phase_share", &["sub_phase"], Unit::ONE,
        "probability that a completed dynamic phase has so many sub-phases";
    SUB_PHASE_CENSORED_ENDS = "sub_phase_censored", &[], Unit::ONE,
        "expected number of dynamic phases still running at the end in as many paths";

    TRANSIENT_STICKS_ENDS = "transient_sticks", &[], Unit::ONE,
        "expected number of sticks that began in the burn-in";
    TRANSIENT_SLIPS_ENDS = "transient_slips", &[], Unit::ONE,
        "expected number of dynamic phases that began in the burn-in";
    TRANSIENT_DISPLACEMENT_ENDS = "transient_displacement", &[], Unit::LENGTH, "mean displacement in the burn-in";
    DISPLACEMENT_PERIOD_MEAN_ENDS = "displacement_period_mean", &["period"], Unit::LENGTH,
        "mean of the displacement since the start, at the end of the period";
    DISPLACEMENT_PERIOD_VARIANCE_ENDS = "displacement_period_variance", &["period"], Unit::AREA,
        "variance of the displacement at the end of the period";
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_name_is_used_once_and_every_axis_has_a_coordinate() {
        let all: Vec<&str> = ALL.iter().copied().chain(ALL_ENDS.iter().copied().flatten()).map(|v| v.name).collect();
        assert_eq!(all.iter().collect::<HashSet<_>>().len(), all.len());
        for axis in ALL.iter().flat_map(|variable| variable.axes) {
            assert!(ALL.iter().any(|v| v.name == *axis && v.is_coordinate()), "{axis}");
        }
    }

    #[test]
    fn the_ends_of_an_interval_have_the_axes_and_the_unit_of_what_lies_between() {
        for [low, high] in ALL_ENDS {
            let stem = low.name.strip_suffix("_low").expect("a lower end");
            assert_eq!(high.name.strip_suffix("_high"), Some(stem));
            let of = ALL.iter().find(|variable| variable.name == stem).unwrap_or_else(|| panic!("{stem}"));
            for end in [low, high] {
                assert_eq!((end.axes, end.unit), (of.axes, of.unit), "{}", end.name);
            }
        }
    }

    #[test]
    fn the_documentation_names_every_variable() {
        let text = include_str!("../../docs/output-format.md");
        for variable in ALL.iter().copied().chain(ALL_ENDS.iter().copied().flatten()) {
            assert!(
                text.contains(&format!("`{}`", variable.name)),
                "{} is not in docs/output-format.md",
                variable.name
            );
        }
    }
}
