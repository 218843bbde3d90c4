//! Several files as one table: the statistics of each, and their differences from the first file.

use super::run::FIRST;
use super::{Cell, Column, INTERVAL, Report, Row, RunInfo, ShownStatistics, Table, of_step};
use crate::output::numbers::counted;
use stickslip::engine::Provenance;
use stickslip::stats::{Statistic, Summary};

/// The report, in which files have the letters a, b, c, ... Differences are taken from the first
/// file, and their errors are those of independent runs.
pub fn comparison(summaries: &[&Summary], infos: &[RunInfo], chosen: ShownStatistics) -> Report {
    let letters: Vec<String> = (0..infos.len()).map(letter).collect();
    let about = letters.iter().zip(infos).map(|(letter, info)| {
        let Provenance {
            scheme,
            step,
            seed,
            paths,
            ..
        } = &info.provenance;
        let step = of_step(*step);
        format!(
            "{letter:<3}{}: {scheme}{step}, seed {seed}, {}",
            info.file,
            counted(*paths, "path")
        )
    });
    let of = |name: String| {
        let error = Column::of(format!("{name} error"), "std. error");
        [Column::of(name.clone(), name), error]
    };
    let mut columns = vec![Column::of("statistic", "statistic")];
    columns.extend(of(letters[0].clone()));
    for letter in &letters[1..] {
        columns.extend(
            of(letter.clone())
                .into_iter()
                .chain(of(format!("{letter} - {}", letters[0]))),
        );
        columns.push(Column::of(format!("{letter} differs"), ""));
    }
    let mut asked: Vec<Statistic> = Vec::new();
    for statistic in summaries
        .iter()
        .flat_map(|summary| chosen.of(&FIRST, &summary.asked))
    {
        if !asked.contains(statistic) {
            asked.push(*statistic);
        }
    }
    let row = |statistic: Statistic| {
        let of = |summary: &&Summary| {
            (
                summary.estimate(statistic).estimate,
                summary.estimate(statistic).standard_error,
            )
        };
        let (first, error) = of(&summaries[0]);
        let mut cells = Cell::all([first, error], error).to_vec();
        for (other, other_error) in summaries[1..].iter().map(of) {
            let (difference, both) = (other - first, error.hypot(other_error));
            cells.extend(Cell::all([other, other_error], other_error));
            cells.extend(Cell::all([difference, both], both));
            cells.push(
                if difference.abs() > INTERVAL * both {
                    "*"
                } else {
                    ""
                }
                .into(),
            );
        }
        Row::of(statistic.name(), cells)
    };
    let rows = asked.into_iter().map(row).collect();
    let table = Table {
        columns,
        rows,
        below: legend(infos, &letters),
        ..Table::default()
    };
    Report {
        title: about.collect::<Vec<_>>().join("\n"),
        tables: vec![table],
        ..Report::default()
    }
}

/// The label of file i: a, b, ..., z, then numbers.
fn letter(i: usize) -> String {
    let letter = u8::try_from(i)
        .ok()
        .filter(|i| *i < 26)
        .map(|i| char::from(b'a' + i));
    letter.map_or_else(|| format!("{}", i + 1), String::from)
}

/// States what the errors of the differences assume.
fn legend(infos: &[RunInfo], letters: &[String]) -> String {
    let mut legend =
        "errors of differences assume independent runs; * marks differences above 1.96 standard \
                      errors, expected by chance in one of twenty"
            .to_string();
    let first = &infos[0].provenance;
    let same = letters
        .iter()
        .zip(infos)
        .skip(1)
        .filter(|(_, info)| info.provenance.seed == first.seed);
    let same: Vec<&str> = same.map(|(letter, _)| letter.as_str()).collect();
    if !same.is_empty() {
        legend += &format!(
            ". {} and {} have the same seed: if they also share their noise (same scheme, or discrete-vi and \
             corrected-vi, at the same step), the errors of differences are overestimated; use `mc sweep` \
             for exact errors, or --seed for independent runs",
            letters[0],
            same.join(", ")
        );
    }
    let differs = |other: &Provenance| other.scheme != first.scheme || other.step != first.step;
    if infos.iter().any(|info| differs(&info.provenance)) {
        legend.push_str(". Differences include the biases of the steps");
    }
    legend
}

#[cfg(test)]
mod tests {
    use super::super::sample_tests::{info, row, set, summary};
    use super::*;
    use crate::report::text;

    /// 3 +- 0.03 and 4 +- 0.04 differ by 1 +- 0.05, which is significant. The difference of 3 and
    /// 3.05 is not.
    #[test]
    fn differences_have_the_errors_of_independent_runs() {
        let (mut a, mut b) = (summary(), summary());
        for (summary, value, error) in [(&mut a, 3.0, 0.03), (&mut b, 4.0, 0.04)] {
            set(summary, Statistic::SubPhasesMean, value);
            summary.estimates[Statistic::SubPhasesMean.index()].standard_error = error;
        }
        set(&mut b, Statistic::JumpMean, f64::NAN);
        let provenance = Provenance {
            seed: 2,
            ..info().provenance
        };
        let other = RunInfo {
            provenance,
            ..info()
        };
        let table = text(&comparison(
            &[&a, &b, &a],
            &[info(), other, info()],
            ShownStatistics::All,
        ));
        let cells: Vec<&str> = row(&table, "sub_phases_mean")
            .split_whitespace()
            .skip(1)
            .collect();
        assert_eq!(
            cells,
            [
                "3.000", "0.030", "4.000", "0.040", "1.000", "0.050", "*", "3.000", "0.030",
                "0.000", "0.042"
            ]
        );
        let cells: Vec<&str> = row(&table, "slips_per_path")
            .split_whitespace()
            .skip(1)
            .collect();
        assert!(!cells.contains(&"*"), "{table}");
        assert!(row(&table, "jump_mean").contains("none"), "{table}");
        let legend = table.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(legend.contains("a and c have the same seed"), "{table}");
    }
}
