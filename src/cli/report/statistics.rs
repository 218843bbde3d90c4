//! The table of statistics: a row each, with its interval, its bias and its unit.

use super::absence::absence;
use super::bias::{bias_cells, corrected_cell};
use crate::cli::numbers::Digits;
use crate::cli::table::{Row, aligned};
use stick_slip::scenario::Units;
use stick_slip::stats::{Estimate, Summary};

/// The table, row by row, the headings first.
pub fn cells(summary: &Summary, units: &Units) -> Vec<Vec<String>> {
    let rows = table(summary, units);
    rows.into_iter().map(|Row { cells, note }| cells.into_iter().chain([note]).collect()).collect()
}

/// The rows of statistics under their headings.
pub(super) fn statistics(summary: &Summary, units: &Units) -> String {
    aligned(&table(summary, units), "  ")
}

fn table(summary: &Summary, units: &Units) -> Vec<Row> {
    let has_bias = summary.has_bias();
    let labels: Vec<String> = summary.estimates.iter().map(|e| e.statistic.dimension().label(units)).collect();
    let mut rows = vec![headings(has_bias, labels.iter().any(|label| !label.is_empty()))];
    for (e, label) in summary.estimates.iter().zip(labels) {
        let note = match absence(e, summary) {
            Some(reason) => format!("{label} ({reason})").trim_start().to_string(),
            None => label,
        };
        rows.push(Row { note, ..row(e, has_bias) });
    }
    rows
}

/// The interval is two columns under one heading, its ends.
fn headings(has_bias: bool, has_unit: bool) -> Row {
    let headings: &[&str] = match has_bias {
        true => &["estimate", "std. error", "95 % interval", "", "bias", "+-", "corrected"],
        false => &["estimate", "std. error", "95 % interval", ""],
    };
    let note = if has_unit { "unit".to_string() } else { String::new() };
    Row { note, ..Row::labelled("statistic", headings.iter().map(|heading| heading.to_string())) }
}

/// One statistic, with the digits that its standard error leaves it.
fn row(e: &Estimate, has_bias: bool) -> Row {
    let digits = Digits::of(e.estimate, e.standard_error);
    let has_interval = e.low.is_finite() && e.high.is_finite();
    let mut cells = vec![digits.show(e.estimate), digits.show(e.standard_error)];
    cells.extend(if has_interval { [e.low, e.high].map(|x| digits.show(x)) } else { ["none".into(), String::new()] });
    if has_bias {
        cells.extend(bias_cells(e.bias));
        cells.push(corrected_cell(e));
    }
    Row::labelled(e.statistic.name(), cells)
}

#[cfg(test)]
mod tests {
    use super::super::sample::{info, row, summary};
    use super::super::{RunInfo, table};
    use stick_slip::scenario::Units;
    use stick_slip::stats::{Bias, Statistic};

    #[test]
    fn the_table_shows_every_statistic_to_two_digits_of_its_error() {
        let table = table(&summary(), &info());
        for statistic in Statistic::ALL {
            row(&table, statistic.name());
        }
        let cells: Vec<&str> = row(&table, "stick_duration_mean").split_whitespace().collect();
        assert_eq!(cells, ["stick_duration_mean", "0.53857", "0.00027", "0.53805", "0.53909"]);
        let ends: Vec<usize> = table.lines().skip(3).take(17).map(|line| line.trim_end().len()).collect();
        assert!(ends[1..].iter().all(|end| *end == ends[1]), "the columns are aligned:\n{table}");
        assert!(!table.contains("bias") && !table.contains("diverged"), "{table}");
    }

    #[test]
    fn known_bias_gets_a_column() {
        let mut summary = summary();
        summary.estimates[0].bias = Some(Bias { estimate: 0.0955, uncertainty: 0.0311, order: Some(0.58) });
        let index = Statistic::SlipsPerPath.index();
        summary.estimates[index].bias = Some(Bias { estimate: 0.03, uncertainty: 0.1, order: None });
        let table = table(&summary, &info());
        let cells = |name| row(&table, name).split_whitespace().skip(5).map(str::to_string).collect::<Vec<_>>();
        assert_eq!(cells("stick_duration_mean"), ["0.096", "0.031", "0.444"]);
        assert_eq!(cells("sticks_per_path"), ["none"]);
        // Within its uncertainty there is nothing to take off.
        assert_eq!(cells("slips_per_path"), ["0.03", "0.10"]);
        assert!(table.lines().take(20).all(|line| line.chars().count() <= 120), "{table}");
    }

    #[test]
    fn units_get_a_column_where_they_have_labels() {
        let (time, length, force) = ("s".to_string(), "m".to_string(), "N".to_string());
        let units = Units { time, length, force, temperature: String::new() };
        let table = table(&summary(), &RunInfo { units, ..info() });
        let unit = |name| row(&table, name).rsplit("  ").next().unwrap_or_default();
        assert_eq!(unit("stick_duration_mean"), "s");
        assert_eq!(unit("drift_velocity"), "m/s");
        assert_eq!(unit("diffusion_coefficient"), "m^2/s");
        assert_eq!(unit("friction_work_mean"), "N m");
    }
}
