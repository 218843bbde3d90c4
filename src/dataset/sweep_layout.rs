//! Every variable of a sweep. The dimensions of the design, which are those of its axes or `point`,
//! come before the axes given here.

use super::layout::{Unit, Variable, coordinate, table, variable};

/// The axis of variables with one value per statistic. The writer puts the dimensions of the design
/// before it.
const STATISTIC: &[&str] = &["statistic"];

table! {
    GROUP = coordinate!("group", Unit::ONE, "paths with this number modulo the number of groups");
    ALONG = coordinate!("along", Unit::None, "dimension along which neighbouring points are compared");
    POINT = coordinate!("point", Unit::ONE, "number of the point");
    POINT_KEY = variable("point_key", &["point"], Unit::None, "key that is changed at the point, none at the centre");
    POINT_VALUE = variable("point_value", &["point"], Unit::None, "value of that key");
    KEY = coordinate!("key", Unit::None, "key of the scenario");
    KEY_VALUE = variable("key_value", &["key"], Unit::None, "value of the key at the centre");

    ESTIMATE_WITHOUT = variable("estimate_without", &["group", "statistic"], Unit::None,
        "estimate from all paths except those of the group");

    POINT_STATUS = variable("point_status", &[], Unit::None, "whether the point is done")
        .flags(&[0, 1, 2], &[("flag_meanings", "missing complete lost")]);
    POINT_COMPLETED_PATHS = variable("point_completed_paths", &[], Unit::ONE, "paths simulated to the end");
    POINT_DIVERGED_PATHS = variable("point_diverged_paths", &[], Unit::ONE, "number of those that diverged or \
        were given up");
    POINT_SEED = variable("point_seed", &[], Unit::ONE, "seed of the paths of the point");
    POINT_END = variable("point_end", &[], Unit::TIME, "end of the simulation at the point");
    POINT_SECONDS = variable("point_seconds", &[], Unit::Seconds, "CPU time of the point");
}

/// The variables with one value per statistic of each difference.
pub const PER_DIFFERENCE: [Variable; 5] = [
    variable(
        "difference",
        STATISTIC,
        Unit::None,
        "estimate at the next point along the dimension minus the \
        one here",
    ),
    variable(
        "difference_error",
        STATISTIC,
        Unit::None,
        "standard error of the difference, with the noise shared by the points",
    ),
    variable(
        "difference_low",
        STATISTIC,
        Unit::None,
        "lower end of the 95 % confidence interval of the difference",
    ),
    variable(
        "difference_high",
        STATISTIC,
        Unit::None,
        "upper end of the 95 % confidence interval of the difference",
    ),
    variable(
        "difference_gain",
        STATISTIC,
        Unit::ONE,
        "variance of the difference with independent seeds, \
        divided by its actual variance",
    ),
];

/// The variables with one value per statistic of each elasticity.
pub const PER_ELASTICITY: [Variable; 5] = [
    variable(
        "elasticity",
        STATISTIC,
        Unit::ONE,
        "relative change of the estimate per relative change of the key",
    ),
    variable(
        "elasticity_error",
        STATISTIC,
        Unit::ONE,
        "standard error of the elasticity",
    ),
    variable(
        "elasticity_low",
        STATISTIC,
        Unit::ONE,
        "lower end of the 95 % confidence interval of the elasticity",
    ),
    variable(
        "elasticity_high",
        STATISTIC,
        Unit::ONE,
        "upper end of the 95 % confidence interval of the elasticity",
    ),
    variable(
        "elasticity_gain",
        STATISTIC,
        Unit::ONE,
        "variance of the elasticity with independent seeds, \
        divided by its actual variance",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::sweep::RESERVED;
    use std::collections::BTreeSet;

    fn all() -> impl Iterator<Item = &'static Variable> {
        use crate::dataset::{layout, summary};
        const OF_CYCLE: [Variable; 4] = [
            layout::CYCLE_NUMBER,
            layout::SECTION_STATE,
            layout::CYCLE,
            layout::SECTION,
        ];
        let of_runs = OF_CYCLE
            .iter()
            .chain(&summary::PER_STATISTIC)
            .chain(&summary::CORRECTED);
        ALL.iter()
            .chain(of_runs)
            .chain(&PER_DIFFERENCE)
            .chain(&PER_ELASTICITY)
    }

    /// An axis with one of these names could not be written.
    #[test]
    fn the_names_of_the_file_are_those_that_no_axis_may_take() {
        let mut names: BTreeSet<&str> = all().map(|variable| variable.name).collect();
        names.extend(["statistic", "statistic_long_name", "statistic_unit"]);
        assert_eq!(names, RESERVED.into_iter().collect());
    }

    #[test]
    fn the_documentation_names_every_variable() {
        let text = include_str!("../../docs/output-format.md");
        for variable in all() {
            // The page leaves the ends of an interval out.
            let of = variable
                .name
                .strip_suffix("_low")
                .or_else(|| variable.name.strip_suffix("_high"));
            let is_there = |name: &str| text.contains(&format!("`{name}`"));
            assert!(
                is_there(variable.name) || of.is_some_and(is_there),
                "{}",
                variable.name
            );
        }
    }
}
