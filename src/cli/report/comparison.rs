//! Several files as one table: the statistics of each, and their differences from the first file.

use super::{Chosen, RunInfo};
use crate::cli::numbers::{counted, with_error, wrapped};
use crate::cli::table::{TableRow, aligned};
use std::fmt::Write as _;
use stick_slip::engine::Provenance;
use stick_slip::stats::{Statistic, Summary};

/// Half the width of a 95 % interval, in standard errors.
const INTERVAL: f64 = 1.96;

/// The table for people. Differences are taken from the first file, and their errors are those of
/// independent runs.
pub fn comparison(summaries: &[&Summary], infos: &[RunInfo], chosen: Chosen) -> String {
    let mut text = String::new();
    let letters: Vec<String> = (0..infos.len()).map(letter).collect();
    for (letter, info) in letters.iter().zip(infos) {
        let Provenance { scheme, step, seed, paths, .. } = &info.provenance;
        let step = step.map_or(String::new(), |h| format!(", step {h:?}"));
        let paths = counted(*paths, "path");
        let _ = writeln!(text, "{letter:<3}{}: {scheme}{step}, seed {seed}, {paths}", info.file);
    }
    let _ = writeln!(text, "\n{}", aligned(&compared(summaries, chosen), "  "));
    text.push_str(&wrapped(&legend(infos, &letters), ""));
    text
}

/// The rows of the table, headings first. The files have the letters a, b, c, ...
pub fn compared(summaries: &[&Summary], chosen: Chosen) -> Vec<TableRow> {
    let letters: Vec<String> = (0..summaries.len()).map(letter).collect();
    let mut headings = vec![letters[0].clone(), "std. error".to_string()];
    for letter in &letters[1..] {
        let difference = format!("{letter} - {}", letters[0]);
        headings.extend([letter, "std. error", &difference, "std. error", ""].map(String::from));
    }
    let mut rows = vec![TableRow::labelled("statistic", headings)];
    let mut asked: Vec<Statistic> = Vec::new();
    for statistic in summaries.iter().flat_map(|summary| chosen.of(summary)) {
        if !asked.contains(statistic) {
            asked.push(*statistic);
        }
    }
    for statistic in asked {
        let first = summaries[0].estimate(statistic);
        let mut cells = with_error(first.estimate, first.standard_error).to_vec();
        for summary in &summaries[1..] {
            let other = summary.estimate(statistic);
            let difference = other.estimate - first.estimate;
            let error = first.standard_error.hypot(other.standard_error);
            cells.extend(with_error(other.estimate, other.standard_error));
            cells.extend(with_error(difference, error));
            cells.push(if difference.abs() > INTERVAL * error { "*".into() } else { String::new() });
        }
        rows.push(TableRow::labelled(statistic.name(), cells));
    }
    rows
}

/// The label of file i: a, b, ..., z, then numbers.
fn letter(i: usize) -> String {
    let letter = u8::try_from(i).ok().filter(|i| *i < 26).map(|i| char::from(b'a' + i));
    letter.map_or_else(|| format!("{}", i + 1), String::from)
}

/// States what the errors of the differences assume.
fn legend(infos: &[RunInfo], letters: &[String]) -> String {
    let mut legend = "errors of differences are those of independent runs; * marks a difference beyond 1.96 \
                      of them, which chance alone produces once in twenty"
        .to_string();
    let first = &infos[0].provenance;
    let same = letters.iter().zip(infos).skip(1).filter(|(_, info)| info.provenance.seed == first.seed);
    let same: Vec<&str> = same.map(|(letter, _)| letter.as_str()).collect();
    if !same.is_empty() {
        let _ = write!(
            legend,
            ". {} and {} have the same seed: if they share their noise as well (one scheme, or discrete-vi \
             and corrected-vi, at one step), differences are more certain than these errors say; `mc sweep` \
             computes their errors, and --seed makes runs independent",
            letters[0],
            same.join(", ")
        );
    }
    let differs = |other: &Provenance| other.scheme != first.scheme || other.step != first.step;
    if infos.iter().any(|info| differs(&info.provenance)) {
        legend.push_str(". Differences contain the biases of the steps");
    }
    legend
}

#[cfg(test)]
mod tests {
    use super::super::sample::{info, row, set, summary};
    use super::*;

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
        let provenance = Provenance { seed: 2, ..info().provenance };
        let other = RunInfo { provenance, ..info() };
        let table = comparison(&[&a, &b, &a], &[info(), other, info()], Chosen::All);
        let cells: Vec<&str> = row(&table, "sub_phases_mean").split_whitespace().skip(1).collect();
        assert_eq!(
            cells,
            ["3.000", "0.030", "4.000", "0.040", "1.000", "0.050", "*", "3.000", "0.030", "0.000", "0.042"]
        );
        let cells: Vec<&str> = row(&table, "slips_per_path").split_whitespace().skip(1).collect();
        assert!(!cells.contains(&"*"), "{table}");
        assert!(row(&table, "jump_mean").contains("none"), "{table}");
        let legend = table.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(legend.contains("a and c have the same seed"), "{table}");
    }
}
