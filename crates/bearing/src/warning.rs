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

/// A kind of warning: its name, when it appears, what to do, and its false alarms in the 620 sound records
/// of the page.
pub struct WarningKind(
    pub &'static str,
    pub &'static str,
    pub &'static str,
    pub &'static str,
);

/// The false alarms of warnings that follow directly from the record or the options.
const EXACT: &str = "–";

/// All kinds: those of a calibration, of a model of the temperature, and of a forecast.
#[rustfmt::skip]
pub const WARNINGS: &[WarningKind] = &[
    WarningKind("no_shear_stiffness", "without K_BP no force is estimated", "give `bearing.stiffness`", EXACT),
    WarningKind("no_slips", "no slip is visible; least squares, without intervals", "measure longer", EXACT),
    WarningKind("poor_fit", "model and measurement differ by more than a slip", "measure each bearing and its own temperature", "0"),
    WarningKind("large_dilatation", "beta exceeds that of two kilometres of steel", "check the unit of the displacement", EXACT),
    WarningKind("gap_not_identified", "the standard error of f_s - f_d exceeds a quarter of it, or slips explain under 90 % of the motion", "measure longer, or with less noise", "4"),
    WarningKind("few_slips", "fewer than 18 slips", "measure longer", EXACT),
    WarningKind("sparse_samples", "T moves by more than 0.75 G between samples", "sample more often: 14 of 20 intervals of f_s held", EXACT),
    WarningKind("scatter", "slip sizes differ by 20 % more than noise explains", "use the estimates as means; the interval of f_s - f_d is too narrow", "0"),
    WarningKind("friction_changes", "A changes by more than 5 % over the year or the record", "measure for years; estimates are for the mean", "0"),
    WarningKind("temperature_elsewhere", "T at slips scatters more than in synthetic records", "put the thermometer on the steel", "0"),
    WarningKind("repeated_values", "the thermometer repeats each value; only the first is used", "store new values more often", "0"),
    WarningKind("saturated", "readings stay at the largest or smallest value", "remove them, and move the sensor", "0"),
    WarningKind("lag", "a lag was estimated and used", "give the lag if it is known", "0"),
    WarningKind("lag_beyond", "a lag of two days or more fits best; none was used", "measure the temperature of the steel", "0"),
    WarningKind("other_lag", "another lag fits better than the given one", "leave out the lag", "0 of 20"),
    WarningKind("clocks", "T of other minutes or hours fits better than any lag", "correct the clock", "0"),
    WarningKind("zero_set", "the sensor jumps where no slip does; the step was fitted", "check the sensor's log", "0"),
    WarningKind("zero_drift", "the sensor drifts; the drift was fitted", "check the sensor", "0"),
    WarningKind("mirrored", "z falls as T rises, so its sign was changed", "reverse the sign of z0", EXACT),
    WarningKind("one_process", "the samples do not determine a second noise process", "measure longer", EXACT),
    WarningKind("held_memory", "the correlation time of the slow noise is held at a tenth of the record", "measure longer", EXACT),
    WarningKind("smooth_temperature", "T is smoother than air, and modelled as lagged air", "nothing, if the thermometer is on steel", "0 of 20"),
    WarningKind("memory_varies", "the fast noise has another correlation time in fewer samples", "use the forecast with care", "0 of 20"),
    WarningKind("record_unlike_forecast", "the record has more or fewer slips than 99.8 % of simulated records", "do not use the intervals", "0.2 %"),
    WarningKind("draws_redrawn", "unphysical parameters were drawn again", "measure longer", EXACT),
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
