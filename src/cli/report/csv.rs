//! Statistics as comma-separated values (RFC 4180): a line for each statistic of each file, or of
//! each point of a sweep.

use crate::cli::table::quoted;
use stick_slip::scenario::Units;
use stick_slip::stats::{Estimate, Statistic};
use stick_slip::study::sweep::Sweep;

/// The columns with the numbers of a statistic.
const NUMBERS: [&str; 9] = [
    "estimate",
    "standard_error",
    "low",
    "high",
    "bias",
    "bias_uncertainty",
    "estimate_corrected",
    "estimate_corrected_low",
    "estimate_corrected_high",
];

/// A table to which files are added one by one.
pub struct Csv {
    /// The statistics that it has; all if none is named.
    named: Vec<Statistic>,
    /// The keys of the scenario in which points of sweeps differ, in the order in which they first
    /// appeared.
    keys: Vec<String>,
    lines: Vec<CsvLine>,
}

struct CsvLine {
    file: String,
    /// The keys that are set for this line, and their values.
    at: Vec<(String, f64)>,
    statistic: &'static str,
    unit: String,
    numbers: [f64; NUMBERS.len()],
}

impl Csv {
    /// A table of these statistics, or of all if none is named.
    pub fn of(named: &[Statistic]) -> Self {
        Csv { named: named.to_vec(), keys: Vec::new(), lines: Vec::new() }
    }

    /// Adds the statistics of one file, or of one point of a sweep, where `at` holds the keys that
    /// are set at that point.
    pub fn add(&mut self, file: &str, at: &[(String, f64)], estimates: impl Iterator<Item = Estimate>, units: &Units) {
        for (key, _) in at {
            if !self.keys.contains(key) {
                self.keys.push(key.clone());
            }
        }
        let named = estimates.filter(|e| self.named.is_empty() || self.named.contains(&e.statistic));
        self.lines.extend(named.map(|e| CsvLine {
            file: file.to_string(),
            at: at.to_vec(),
            statistic: e.statistic.name(),
            unit: e.statistic.dimension().label(units),
            numbers: numbers(&e),
        }));
    }

    /// Adds the points of a sweep that are done.
    pub fn add_sweep(&mut self, file: &str, sweep: &Sweep) {
        let done = sweep.points.iter().enumerate().filter_map(|(p, point)| Some((p, point.as_ref()?)));
        for (p, point) in done {
            let settings = sweep.question.design.settings(p).into_iter();
            let at: Vec<(String, f64)> = settings.map(|setting| (setting.key, setting.value)).collect();
            let scenario = &sweep.question.scenario;
            let asked = point.estimates.iter().filter(|e| e.statistic.is_asked_by(&scenario.record));
            self.add(file, &at, asked.copied(), &scenario.units);
        }
    }

    /// The whole table with its headings. A missing number is an empty cell, and the end of an
    /// interval without a bound is `inf`.
    pub fn text(&self) -> String {
        let keys = self.keys.iter().map(String::as_str);
        let headings = ["file"].into_iter().chain(keys).chain(["statistic", "unit"]).chain(NUMBERS);
        let mut text = line(headings.map(String::from));
        for CsvLine { file, at, statistic, unit, numbers } in &self.lines {
            let of_key = |key: &String| at.iter().find(|(set, _)| set == key).map_or(f64::NAN, |(_, value)| *value);
            let keys = self.keys.iter().map(|key| number(of_key(key)));
            let words = [statistic.to_string(), unit.clone()];
            let cells = [file.clone()].into_iter().chain(keys).chain(words).chain(numbers.map(number));
            text.push_str(&line(cells));
        }
        text
    }
}

fn numbers(e: &Estimate) -> [f64; NUMBERS.len()] {
    let bias = e.bias.map_or([f64::NAN; 2], |bias| [bias.estimate, bias.uncertainty]);
    let corrected = e.corrected().map_or([f64::NAN; 3], |c| [c.estimate, c.low, c.high]);
    let plain = [e.estimate, e.standard_error, e.low, e.high];
    let mut all = plain.into_iter().chain(bias).chain(corrected);
    std::array::from_fn(|_| all.next().unwrap_or(f64::NAN))
}

/// The shortest decimal number that reads back as the same double.
fn number(x: f64) -> String {
    if x.is_nan() { String::new() } else { format!("{x:?}") }
}

fn line(cells: impl Iterator<Item = String>) -> String {
    cells.map(|cell| quoted(&cell)).collect::<Vec<_>>().join(",") + "\n"
}

#[cfg(test)]
mod tests {
    use super::super::sample::{info, set, summary};
    use super::*;
    use stick_slip::stats::Bias;

    #[test]
    fn a_line_has_every_digit_and_a_file_of_any_name() {
        let mut summary = summary();
        set(&mut summary, Statistic::DriftVelocity, f64::NAN);
        summary.estimates[0].estimate = 0.1 + 0.2;
        summary.estimates[0].bias = Some(Bias { estimate: 0.05, uncertainty: 0.01, order: None });
        summary.estimates[1].high = f64::INFINITY;
        let mut csv = Csv::of(&[]);
        csv.add("a, \"b\".h5", &[], summary.reported().copied(), &info().provenance.units);
        csv.add(
            "point.h5",
            &[("friction.static".to_string(), 1.25)],
            summary.estimates[..1].iter().copied(),
            &info().provenance.units,
        );
        let text = csv.text();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2 + summary.asked.len());
        assert!(lines[0].starts_with("file,friction.static,statistic,unit,estimate,standard_error,low,high,bias,"));
        assert!(lines[1].starts_with("\"a, \"\"b\"\".h5\",,stick_duration_mean,,0.30000000000000004,"), "{}", lines[1]);
        let cells = |line: &str| line.rsplitn(10, ',').map(String::from).collect::<Vec<_>>();
        assert_eq!(cells(lines[1])[3..5], ["0.01", "0.05"]);
        assert_eq!(cells(lines[2])[5], "inf");
        let drift = 1 + Statistic::DriftVelocity.index();
        assert_eq!(cells(lines[drift])[8], "", "{}", lines[drift]);
        assert!(lines[22].starts_with("point.h5,1.25,stick_duration_mean,"));
    }
}
