//! All warnings of calibrations, temperature models and forecasts, in one table, which
//! docs/bearing/calibration.md shows.

use std::fmt;

/// A warning about a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CalibrationWarning {
    pub(crate) name: &'static str,
    pub(crate) text: String,
}

impl CalibrationWarning {
    /// The name in files and for programs.
    pub fn name(&self) -> &'static str {
        self.name
    }
}

/// The warning in a sentence or two, for people.
impl fmt::Display for CalibrationWarning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A kind of warning: its name, when it appears, what to do, and its number of false alarms in the
/// sound records of the table.
pub struct WarningKind(
    pub &'static str,
    pub &'static str,
    pub &'static str,
    pub &'static str,
);

/// The false alarms of warnings that follow directly from the record or the options.
const EXACT: &str = "none possible";

/// All kinds: those of a calibration, of a model of the temperature, and of a forecast.
#[rustfmt::skip]
pub const WARNINGS: &[WarningKind] = &[
    WarningKind("no_shear_stiffness", "K_BP is not given, so no force is estimated", "give `bearing.stiffness`", EXACT),
    WarningKind("no_slips", "no slips are visible; the least-squares estimates are given, without intervals", "measure for longer", EXACT),
    WarningKind("poor_fit", "model and measurement differ by more than the jump of a slip", "measure each bearing and its temperature separately", "0 of 419"),
    WarningKind("large_dilatation", "beta corresponds to more than two kilometres of steel", "check the unit of the displacement", EXACT),
    WarningKind("gap_not_identified", "the standard error of f_s - f_d exceeds a quarter of it, or slips explain less than 90 % of the motion", "measure for longer, or use a sensor with less noise", "4 of 419"),
    WarningKind("few_slips", "fewer than 18 slips", "measure for longer", EXACT),
    WarningKind("sparse_samples", "the temperature changes by more than three quarters of G from one sample to the next", "sample more often: f_s may be 1 % off, beyond its interval", EXACT),
    WarningKind("scatter", "the sizes of slips differ by 20 % more than noise explains", "use the estimates as means; the interval of f_s - f_d is too narrow", "0 of 419"),
    WarningKind("friction_changes", "A changes by more than 5 % over the record; a forecast draws friction from this range", "measure for years", "0 of 419"),
    WarningKind("temperature_elsewhere", "the temperatures of slips scatter more than those of synthetic records", "put the thermometer on the steel", "0 of 419"),
    WarningKind("saturated", "readings stay at the largest or the smallest value", "remove these readings, and move the sensor", "0 of 419"),
    WarningKind("lag", "a lag of the steel was estimated and used", "give `--lag` if it is known", "0 of 419"),
    WarningKind("lag_beyond", "a lag of two days or more fits best, and was not used", "measure the temperature of the steel", "0 of 419"),
    WarningKind("other_lag", "a lag was given, but another one fits better", "use `--lag auto`", "0 of 20"),
    WarningKind("clocks", "the temperature some minutes or hours earlier or later fits better than any lag; up to 55 minutes are corrected", "correct the clock", "0 of 419"),
    WarningKind("zero_set", "the sensor reading jumps without a slip; the step was fitted", "check the log of the sensor", "0 of 419"),
    WarningKind("zero_drift", "the sensor drifts; the drift was fitted", "check the sensor", "0 of 419"),
    WarningKind("mirrored", "the displacement falls as the temperature rises, so its sign was changed", "reverse the sign of z0", EXACT),
    WarningKind("one_process", "the samples do not determine a second noise process", "measure for longer", EXACT),
    WarningKind("held_memory", "the correlation time of the slow noise is kept near a tenth of \
                                the record", "measure for longer", EXACT),
    WarningKind("smooth_temperature", "the temperature is smoother than that of air; it is modelled as air temperature with a lag", "nothing, if the thermometer is on steel", "0 of 20"),
    WarningKind("memory_varies", "the fast noise has a different correlation time in a subset of \
                                  the samples", "use the forecast with care", "0 of 20"),
    WarningKind("record_unlike_forecast", "the record has more or fewer slips than 99.8 % of simulated records", "do not use the intervals", "0.2 %"),
    WarningKind("draws_redrawn", "some sampled parameter sets were unphysical and were drawn again", "measure for longer", EXACT),
];

/// A named warning of a kind in the table.
pub(crate) fn named(name: &'static str, text: String) -> (String, String) {
    debug_assert!(WARNINGS.iter().any(|kind| kind.0 == name), "{name}");
    (name.to_string(), text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of the page is this one, row by row.
    #[test]
    fn the_page_has_this_table_of_warnings() {
        let row = |WarningKind(name, when, remedy, rate): &WarningKind| {
            format!("| `{name}` | {when} | {remedy} | {rate} |\n")
        };
        let table: String = WARNINGS.iter().map(row).collect();
        let page = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/bearing/calibration.md"
        );
        let page = std::fs::read_to_string(page).expect("the page");
        assert!(
            page.contains(&table),
            "put this into docs/bearing/calibration.md:\n{table}"
        );
    }
}
