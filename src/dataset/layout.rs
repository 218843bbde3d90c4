//! Every dimension and variable of a run, in one table for writers and readers: name, axes, unit
//! and meaning. The columns of single paths are declared where they are stored
//! ([`crate::stats::PathColumns`], [`crate::stats::EventColumns`],
//! [`crate::stats::TrajectoryRows`]).

pub use crate::stats::column::{BARE_DIMENSION, Described, Unit, Variable, variable};

use crate::stats::Dimension;

/// Declares variables together with the list of all of them, so that the list is complete.
#[doc(hidden)]
#[macro_export]
macro_rules! table {
    ($list:ident: $type:ty; $($constant:ident = $value:expr;)*) => {
        $(pub const $constant: $type = $value;)*
        /// All of them.
        #[cfg(test)]
        pub const $list: &[$type] = &[$($constant),*];
    };
    ($($rows:tt)*) => {
        $crate::table! { ALL: Variable; $($rows)* }
    };
}
pub use table;

/// The coordinate of a dimension, which has the name of the dimension.
#[doc(hidden)]
#[macro_export]
macro_rules! coordinate {
    ($name:literal, $unit:expr, $meaning:expr) => {
        $crate::dataset::layout::variable($name, &[$name], $unit, $meaning)
    };
}
pub use coordinate;

/// A variable with the interval of each of its values.
#[derive(Clone, Copy, Debug)]
pub struct WithInterval {
    pub value: Variable,
    /// Along `bound` first.
    pub interval: Variable,
}

impl WithInterval {
    const fn with(mut self, attributes: &'static [(&'static str, &'static str)]) -> WithInterval {
        self.value = self.value.with(attributes);
        self
    }
}

/// A variable with its intervals, which may be those of another quantity.
macro_rules! measured {
    ($name:expr, [$($axis:literal),*], $unit:expr, $what:expr) => {
        measured!($name, [$($axis),*], $unit, $what, interval of the $what)
    };
    ($name:expr, [$($axis:literal),*], $unit:expr, $what:expr, interval of the $of:expr) => {
        WithInterval {
            value: variable($name, &[$($axis),*], $unit, $what),
            interval: variable(concat!($name, "_interval"), &["bound", $($axis),*], $unit,
                concat!("95 % confidence interval of the ", $of)),
        }
    };
}

/// The upper edges of bins, which are the coordinate of their dimension, and the lower ones.
macro_rules! bins {
    ($upper:literal, $lower:literal, $unit:expr, $of:literal) => {
        [
            coordinate!($upper, $unit, concat!("upper edge of the bin of the ", $of)),
            variable(
                $lower,
                &[$upper],
                $unit,
                concat!("lower edge of the bin of the ", $of, ", inclusive"),
            ),
        ]
    };
}

const SPECTRUM_OF_LENGTH: Unit = Unit::Of(Dimension {
    length: 2,
    time: 1,
    ..Dimension::ONE
});
const SPECTRUM_OF_VELOCITY: Unit = Unit::Of(Dimension {
    length: 2,
    time: -1,
    ..Dimension::ONE
});

const PER_STATISTIC: &[(&str, &str)] = &[("coordinates", "statistic_long_name statistic_unit")];
const WITH_ERRORS: &[(&str, &str)] = &[
    PER_STATISTIC[0],
    (
        "ancillary_variables",
        "standard_error interval_low interval_high bias bias_uncertainty bias_order",
    ),
];

/// A number of each statistic.
const fn of_statistic(name: &'static str, meaning: &'static str) -> Variable {
    variable(name, &["statistic"], Unit::None, meaning).with(PER_STATISTIC)
}

const OF_BIN: &[&str] = &["law", "law_bin"];
const PER_BIN: &[(&str, &str)] = &[("coordinates", "law_lower law_upper")];

table! {
    STATISTIC = coordinate!("statistic", Unit::None, "name of the statistic");
    STATISTIC_LONG_NAME = variable("statistic_long_name", &["statistic"], Unit::None, "meaning of the statistic");
    STATISTIC_UNIT = variable("statistic_unit", &["statistic"], Unit::None, "unit of the statistic");
    ESTIMATE = of_statistic("estimate", "estimate").with(WITH_ERRORS);
    STANDARD_ERROR = of_statistic("standard_error", "standard error of the estimate, with paths as \
        independent units");
    INTERVAL_LOW = of_statistic("interval_low", "lower end of the 95 % confidence interval");
    INTERVAL_HIGH = of_statistic("interval_high", "upper end of the 95 % confidence interval");
    BIAS = of_statistic("bias", "estimated discretisation bias, missing if unknown");
    BIAS_UNCERTAINTY = of_statistic("bias_uncertainty", "95 % uncertainty of the discretisation bias");
    BIAS_ORDER = of_statistic("bias_order", "observed order p of the bias in the time step, as in C h^p, \
        missing if unknown");
    ESTIMATE_CORRECTED = of_statistic("estimate_corrected", "estimate with the known bias removed, missing if \
        unknown");
    ESTIMATE_CORRECTED_LOW = of_statistic("estimate_corrected_low", "lower end of the 95 % interval of the corrected estimate");
    ESTIMATE_CORRECTED_HIGH = of_statistic("estimate_corrected_high", "upper end of the 95 % interval of the corrected estimate");

    BOUND = coordinate!("bound", Unit::None, "end of an interval");

    TIME = coordinate!("time", Unit::TIME, "time");
    QUANTILE = coordinate!("quantile", Unit::ONE, "quantile level");

    SERIES_TIME = coordinate!("series_time", Unit::TIME, "time of a sample of the measured temperature");
    SERIES_TEMPERATURE = variable("series_temperature", &["series_time"], Unit::TEMPERATURE, "measured temperature");

    INPUT = coordinate!("input", Unit::None, "name of a measured input");
    INPUT_SAMPLE = coordinate!("input_sample", Unit::ONE, "number of the input of a sample, from 0");
    INPUT_TIME = variable("input_time", &["input_sample"], Unit::TIME, "time of a sample");
    INPUT_VALUE = variable("input_value", &["input_sample"], Unit::None, "measured value, in the unit of its input");

    JOINT_DENSITY = variable("joint_density", &["joint_displacement_bin", "joint_velocity_bin"],
        Unit::Of(Dimension { time: 1, length: -2, ..Dimension::ONE }),
        "joint density of displacement and velocity in motion over the counted time");

    LAW = coordinate!("law", Unit::None, "name of the distribution");
    LAW_LONG_NAME = variable("law_long_name", &["law"], Unit::None, "description of the quantity");
    LAW_UNIT = variable("law_unit", &["law"], Unit::None, "unit of the quantity");
    LAW_BIN = coordinate!("law_bin", Unit::ONE, "number of the bin");
    LAW_LOWER = variable("law_lower", OF_BIN, Unit::None, "lower edge of the bin, inclusive");
    LAW_UPPER = variable("law_upper", OF_BIN, Unit::None, "upper edge of the bin, missing if the distribution \
        has fewer bins");
    LAW_COUNT = variable("law_count", OF_BIN, Unit::ONE,
        "values of completed phases, without the first stick of each path").with(PER_BIN);
    LAW_CENSORED_COUNT = variable("law_censored_count", OF_BIN, Unit::ONE,
        "phases still running at the end, by their value so far").with(PER_BIN);
    LAW_COMPLETED = variable("law_completed", &["law"], Unit::ONE, "completed phases");
    LAW_CENSORED = variable("law_censored", &["law"], Unit::ONE, "phases still running at the end");

    LEVEL = coordinate!("level", Unit::LENGTH, "distance from the initial displacement");

    LAG = coordinate!("lag", Unit::TIME, "lag of the autocovariance");
    FREQUENCY = coordinate!("frequency", Unit::Of(Dimension { time: -1, ..Dimension::ONE }),
        "angular frequency of the power spectrum");
    SPECTRUM_SEGMENTS = variable("spectrum_segments", &[], Unit::ONE,
        "number of segments of the output grid over which autocovariance and spectrum are averaged");
    LINE_FREQUENCY = coordinate!("line_frequency", Unit::Of(Dimension { time: -1, ..Dimension::ONE }),
        "angular frequency of a harmonic of the forcing");
    DISPLACEMENT_LINE = variable("displacement_line", &["line_frequency"], Unit::LENGTH,
        "amplitude of the mean displacement at the harmonic");
    VELOCITY_LINE = variable("velocity_line", &["line_frequency"], Unit::VELOCITY,
        "amplitude of the mean velocity at the harmonic");

    SUB_PHASE = coordinate!("sub_phase", Unit::ONE,
        "number of sub-phases of a dynamic phase; the last entry includes all larger numbers");

    PERIOD = coordinate!("period", Unit::ONE, "number of whole periods P");
    DRIFT_LIMIT = variable("drift_velocity_limit", &[], Unit::VELOCITY,
        "long-run drift velocity, if determined by the spring and the temperature trend");
    PERIOD_TIME = variable("period_time", &["period"], Unit::TIME, "end of the period");

    TRANSIENT_END = variable("transient_end", &[], Unit::TIME, "start of the counted time");
    TRANSIENT_DISPLACEMENT_ERROR = variable("transient_displacement_error", &[], Unit::LENGTH,
        "standard error of the mean displacement in the burn-in, with paths as independent units");

    CYCLE_NUMBER = coordinate!("cycle_number", Unit::None, "name of a property of the cycle");
    CYCLE = variable("cycle", &["cycle_number"], Unit::None,
        "long-term motion of a deterministic scenario, missing if no state recurs");
    SECTION_STATE = coordinate!("section_state", Unit::ONE, "number of the state in the section");
    SECTION = variable("section", &["section_state"], Unit::LENGTH,
        "displacement minus its drift at the ends of the last forcing periods, or at the starts \
            of the last slips; missing if there are fewer");

    FIRST_STICK_COMPLETED = variable("first_stick_duration_completed", &[], Unit::ONE,
        "completed first sticks");
    FIRST_STICK_CENSORED = variable("first_stick_duration_censored", &[], Unit::ONE,
        "first sticks still running at the end");
    SUB_PHASE_COUNT = variable("sub_phase_count", &["sub_phase"], Unit::ONE,
        "number of completed dynamic phases with k sub-phases");
    SUB_PHASE_CENSORED = variable("sub_phase_censored", &[], Unit::ONE,
        "dynamic phases still running at the end");
    TRANSIENT_STICKS = variable("transient_sticks", &[], Unit::ONE,
        "completed sticks that began in the burn-in, without the first of each path");
    TRANSIENT_SLIPS = variable("transient_slips", &[], Unit::ONE,
        "completed dynamic phases that began in the burn-in");
    DIVERGED_PATH = coordinate!("diverged_path", Unit::ONE,
        "numbers of the paths that diverged or were given up, excluded from all statistics");

    PART_STATE = coordinate!("part_state", Unit::None,
        "state of a part of a run, used by mc merge");

    PATH = coordinate!("path", Unit::ONE, "path number").with(&[("standard_name", "realization")]);
    EVENT = coordinate!("event", Unit::None, BARE_DIMENSION);
    TRAJECTORY_BEARING = variable("trajectory_bearing_displacement", &["trajectory", "time"], Unit::LENGTH,
        "displacement shown by a sensor at the bearing");
}

table! {
    ALL_BINS: [Variable; 2];
    VELOCITY_BIN = bins!("velocity_bin", "velocity_bin_lower", Unit::VELOCITY, "velocity");
    DISPLACEMENT_BIN = bins!("displacement_bin", "displacement_bin_lower", Unit::LENGTH, "displacement");
    JOINT_DISPLACEMENT_BIN =
        bins!("joint_displacement_bin", "joint_displacement_bin_lower", Unit::LENGTH, "displacement in the joint density");
    JOINT_VELOCITY_BIN = bins!("joint_velocity_bin", "joint_velocity_bin_lower", Unit::VELOCITY, "velocity in the joint density");
}

table! {
    ALL_MEASURED: WithInterval;

    STATIC_PROBABILITY = measured!("static_probability", ["time"], Unit::ONE,
        "probability of being in a static phase");
    LAW_SURVIVAL = measured!("law_survival", ["law", "law_bin"], Unit::ONE,
        "probability that a value exceeds the upper edge of the bin (Kaplan-Meier)").with(PER_BIN);
    LAW_QUANTILE = measured!("law_quantile", ["law", "quantile"], Unit::None, "quantiles of the completed values");

    DISPLACEMENT_DENSITY = measured!("displacement_density", ["displacement_bin"],
        Unit::Of(Dimension { length: -1, ..Dimension::ONE }),
        "density of the displacement over the counted time").with(&[("coordinates", "displacement_bin_lower")]);
    VELOCITY_DENSITY = measured!("velocity_density", ["velocity_bin"],
        Unit::Of(Dimension { time: 1, length: -1, ..Dimension::ONE }),
        "density of the velocity in motion over the counted time").with(&[("coordinates", "velocity_bin_lower")]);
    PASSAGE_SURVIVAL = measured!("passage_survival", ["level", "time"], Unit::ONE,
        "probability that the displacement has not yet reached this distance from the start");
    REST_SHARE = measured!("rest_share", [], Unit::ONE,
        "fraction of the counted time at rest");
    DISPLACEMENT_AUTOCOVARIANCE = measured!("displacement_autocovariance", ["lag"], Unit::AREA,
        "autocovariance of the displacement about its mean over paths");
    VELOCITY_AUTOCOVARIANCE = measured!("velocity_autocovariance", ["lag"],
        Unit::Of(Dimension { length: 2, time: -2, ..Dimension::ONE }),
        "autocovariance of the velocity about its mean over paths");
    DISPLACEMENT_SPECTRUM = measured!("displacement_spectrum", ["frequency"], SPECTRUM_OF_LENGTH,
        "two-sided power spectrum of the displacement about its mean over paths");
    VELOCITY_SPECTRUM = measured!("velocity_spectrum", ["frequency"], SPECTRUM_OF_VELOCITY,
        "two-sided power spectrum of the velocity about its mean over paths");

    SUB_PHASE_SHARE = measured!("sub_phase_share", ["sub_phase"], Unit::ONE,
        "fraction of completed dynamic phases with k sub-phases",
        interval of the "probability that a completed dynamic phase has k sub-phases");

    TRANSIENT_DISPLACEMENT = measured!("transient_displacement", [], Unit::LENGTH,
        "mean displacement in the burn-in",
        interval of the "mean displacement in the burn-in");

    DISPLACEMENT_PERIOD_MEAN = measured!("displacement_period_mean", ["period"], Unit::LENGTH,
        "mean of the displacement since the start, at the end of the period").with(&[("coordinates", "period_time")]);
    DISPLACEMENT_PERIOD_VARIANCE = measured!("displacement_period_variance", ["period"], Unit::AREA,
        "variance of the displacement at the end of the period").with(&[("coordinates", "period_time")]);
}

/// Mean, standard deviation and quantiles of a quantity on the output grid.
macro_rules! band {
    ($mean:literal, $sd:literal, $quantile:literal, $unit:expr, $of:literal) => {
        [
            measured!($mean, ["time"], $unit, concat!("mean of the ", $of)),
            measured!(
                $sd,
                ["time"],
                $unit,
                concat!("standard deviation of the ", $of)
            ),
            measured!(
                $quantile,
                ["quantile", "time"],
                $unit,
                concat!("quantiles of the ", $of)
            ),
        ]
    };
}

pub const DISPLACEMENT: [WithInterval; 3] = band!(
    "displacement_mean",
    "displacement_sd",
    "displacement_quantile",
    Unit::LENGTH,
    "displacement"
);
pub const VELOCITY: [WithInterval; 3] = band!(
    "velocity_mean",
    "velocity_sd",
    "velocity_quantile",
    Unit::VELOCITY,
    "velocity"
);
pub const TEMPERATURE: [WithInterval; 3] = band!(
    "temperature_mean",
    "temperature_sd",
    "temperature_quantile",
    Unit::TEMPERATURE,
    "temperature"
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::column::Columns;
    use crate::stats::{EventColumns, PathColumns, TrajectoryRows};
    use std::collections::HashSet;

    /// Every variable of a run.
    fn all() -> Vec<Variable> {
        let measured = ALL_MEASURED
            .iter()
            .chain([DISPLACEMENT, VELOCITY, TEMPERATURE].as_flattened());
        let kept = [
            PathColumns::VARIABLES,
            EventColumns::VARIABLES,
            TrajectoryRows::VARIABLES,
        ]
        .concat();
        let measured = measured.flat_map(|of| [of.value, of.interval]);
        let bins = ALL_BINS.as_flattened();
        ALL.iter()
            .chain(bins)
            .copied()
            .chain(measured)
            .chain(kept.into_iter().map(|(of, _)| of))
            .collect()
    }

    #[test]
    fn every_name_is_used_once_and_every_axis_has_a_coordinate() {
        let all = all();
        assert_eq!(
            all.iter().map(|of| of.name).collect::<HashSet<_>>().len(),
            all.len()
        );
        for axis in all.iter().flat_map(|variable| variable.axes) {
            assert!(
                all.iter().any(|v| v.name == *axis && *v.axes == [v.name]),
                "{axis}"
            );
        }
    }

    #[test]
    fn the_documentation_names_every_variable() {
        let text = include_str!("../../docs/output-format.md");
        for variable in all() {
            // The page leaves the intervals out.
            let name = variable
                .name
                .strip_suffix("_interval")
                .unwrap_or(variable.name);
            let name = name
                .strip_suffix("_low")
                .or_else(|| name.strip_suffix("_high"))
                .unwrap_or(name);
            let is_there = [variable.name, name]
                .iter()
                .any(|name| text.contains(&format!("`{name}`")));
            assert!(
                is_there,
                "{} is not in docs/output-format.md",
                variable.name
            );
        }
    }
}
