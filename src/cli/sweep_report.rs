//! The report of a sweep for people: a table for each statistic, the gain from common seeds, and
//! elasticities sorted by size.

use crate::cli::numbers::{Digits, counted, duration, grouped, significant, some_of, with_error, wrapped};
use crate::cli::report::bias_cells;
use crate::cli::table::{TableRow, aligned};
use std::fmt::Write as _;
use std::path::Path;
use stick_slip::stats::{Estimate, Statistic};
use stick_slip::study::sweep::{Design, Paired, Seeds, Sweep};

/// The space between two columns.
const GAP: &str = "  ";

/// The most points that are printed. The file holds all of them.
pub const MOST_ROWS: usize = 100;

/// A gain below this is worth a remark: common seeds are then hardly better than independent ones.
const LOW_GAIN: f64 = 2.0;

/// The statistics that are printed if none is named.
const USUAL: [Statistic; 3] =
    [Statistic::StickDurationMean, Statistic::SubPhasesMultipleShare, Statistic::StickingFraction];

/// The report as text.
pub fn table(sweep: &Sweep, named: &[Statistic], output: &Path) -> String {
    let shown = if named.is_empty() { &USUAL } else { named };
    let scenario = &sweep.question.scenario;
    let step = scenario.scheme.step().map_or(String::new(), |h| format!(", step {h:?}"));
    let mut text = format!("{}\n{}{step}", scenario.title, scenario.scheme.name());
    let first = sweep.question.points[0].ensemble.paths;
    if sweep.question.points.iter().all(|point| point.ensemble.paths == first) {
        let _ = write!(text, ", {} at each point", counted(first, "path"));
    }
    let _ = writeln!(text, ", {} seeds", sweep.question.seeds.name());
    let is_star = matches!(sweep.question.design, Design::Star { .. });
    for (statistic, mut rows) in tables(sweep, shown) {
        let more = if is_star { 0 } else { rows.len().saturating_sub(1 + MOST_ROWS) };
        rows.truncate(rows.len() - more);
        let name = if is_star { String::new() } else { format!("{}\n", statistic.name()) };
        let _ = write!(text, "\n{name}{}", aligned(&rows, GAP));
        if more > 0 {
            let _ = writeln!(text, "... and {} more points in the file", grouped(more as u64));
        }
    }
    if !is_star && sweep.question.seeds == Seeds::Common {
        text.push_str(&gains(sweep));
    }
    let seconds: f64 = sweep.points.iter().flatten().map(|point| point.seconds).sum();
    let _ = writeln!(text, "\ntime    {} of CPU for {} points", duration(seconds), grouped(sweep.done() as u64));
    let _ = writeln!(text, "file    {}", output.display());
    text
}

/// The tables of the usual statistics.
pub fn usual(sweep: &Sweep) -> Vec<(Statistic, Vec<TableRow>)> {
    tables(sweep, &USUAL)
}

/// The rows of a table for each of these statistics, headings first.
fn tables(sweep: &Sweep, shown: &[Statistic]) -> Vec<(Statistic, Vec<TableRow>)> {
    let rows = |statistic: Statistic| match &sweep.question.design {
        Design::Star { keys, .. } => elasticities(sweep, keys, statistic),
        Design::Grid(_) | Design::Zip(_) => points(sweep, statistic),
    };
    shown.iter().map(|statistic| (*statistic, rows(*statistic))).collect()
}

/// The rows of these statistics, or else of the usual ones, as one table, headings first. The first
/// column names the statistic.
pub fn rows(sweep: &Sweep, named: &[Statistic]) -> Vec<TableRow> {
    let shown = if named.is_empty() { &USUAL } else { named };
    let named = |(n, (statistic, mut rows)): (usize, (Statistic, Vec<TableRow>))| {
        for (i, row) in rows.iter_mut().enumerate() {
            row.cells.insert(0, if i == 0 { "statistic".into() } else { statistic.name().to_string() });
        }
        rows.into_iter().skip(usize::from(n > 0))
    };
    tables(sweep, shown).into_iter().enumerate().flat_map(named).collect()
}

/// One statistic at every point and, if the points form a line, its difference to the next point.
fn points(sweep: &Sweep, statistic: Statistic) -> Vec<TableRow> {
    let design = &sweep.question.design;
    let is_line = design.along().len() == 1;
    let names = design.axes().iter().map(|axis| axis.name.clone());
    let has_bias = sweep.points.iter().flatten().any(|point| point.estimates[statistic.index()].bias.is_some());
    let mut headings: Vec<String> = names.collect();
    headings.extend(["estimate", "std. error", "95 % from", "to"].map(String::from));
    if has_bias {
        headings.extend(["bias", "+-"].map(String::from));
    }
    if is_line {
        headings.extend(["to the next", "std. error", "gain"].map(String::from));
    }
    let mut rows = vec![TableRow { cells: headings, ..TableRow::default() }];
    for (p, point) in sweep.points.iter().enumerate() {
        let mut cells: Vec<String> = design.settings(p).iter().map(|setting| significant(setting.value, 12)).collect();
        match point {
            None => cells.push("missing".into()),
            Some(point) => cells.extend(estimate_cells(&point.estimates[statistic.index()], has_bias)),
        }
        if let Some(paired) = sweep.difference(p, 0, statistic).filter(|_| is_line) {
            cells.extend(paired_cells(&paired));
        }
        rows.push(TableRow { cells, ..TableRow::default() });
    }
    rows
}

fn estimate_cells(e: &Estimate, has_bias: bool) -> Vec<String> {
    let numbers = [e.estimate, e.standard_error, e.low, e.high];
    let mut cells = Digits::of(e.estimate, e.standard_error).show_all(numbers).to_vec();
    if has_bias {
        cells.extend(bias_cells(e.bias));
    }
    cells
}

/// A number, its standard error, and the gain from common seeds.
fn paired_cells(Paired { measurement, gain }: &Paired) -> [String; 3] {
    let [estimate, error] = with_error(measurement.estimate, measurement.standard_error);
    [estimate, error, gain_cell(*gain)]
}

fn gain_cell(gain: f64) -> String {
    if gain.is_finite() { significant(gain, 2) } else { "none".into() }
}

/// The statistics that every point reports.
fn asked(sweep: &Sweep) -> Vec<Statistic> {
    Statistic::asked_by(&sweep.question.scenario.record)
}

/// The gain from common seeds for the differences of neighbouring points, for each statistic. The
/// gain is the variance with independent seeds over that with common ones.
fn gains(sweep: &Sweep) -> String {
    let along = sweep.question.design.along();
    let mut rows = vec![TableRow::labelled("gain along", along.iter().map(|name| name.to_string()))];
    for statistic in asked(sweep) {
        let gains: Vec<f64> = (0..along.len()).map(|dimension| sweep.gain(dimension, statistic)).collect();
        if gains.iter().any(|gain| gain.is_finite()) {
            rows.push(TableRow::labelled(statistic.name(), gains.into_iter().map(gain_cell)));
        }
    }
    if rows.len() == 1 {
        return String::new();
    }
    let legend = "gain: the variance that a difference of neighbours would have with independent seeds, over the one that it has";
    format!("\n{}{}", aligned(&rows, GAP), wrapped(legend, ""))
}

/// The elasticities of one statistic, sorted from the largest to the smallest.
fn elasticities(sweep: &Sweep, keys: &[(String, f64)], statistic: Statistic) -> Vec<TableRow> {
    let headings = ["value", "elasticity", "std. error", "95 % from", "to", "gain"];
    let mut rows = vec![TableRow::labelled(statistic.name(), headings)];
    let paired = |key: usize| sweep.elasticity(key, statistic).unwrap_or(Paired::NOTHING);
    let mut order: Vec<(usize, Paired)> = (0..keys.len()).map(|key| (key, paired(key))).collect();
    let size =
        |paired: &Paired| Some(paired.measurement.estimate.abs()).filter(|size| size.is_finite()).unwrap_or(-1.0);
    order.sort_by(|a, b| size(&b.1).total_cmp(&size(&a.1)));
    for (key, paired) in order {
        let (name, value) = &keys[key];
        let m = paired.measurement;
        let numbers = [m.estimate, m.standard_error, m.low, m.high];
        let mut cells = vec![significant(*value, 6)];
        cells.extend(Digits::of(m.estimate, m.standard_error).show_all(numbers));
        cells.push(gain_cell(paired.gain));
        let note = if m.estimate.is_nan() { "(the statistic does not exist, or may be zero)" } else { "" };
        rows.push(TableRow::labelled(name, cells).noted(note));
    }
    rows
}

/// Remarks that a reader should know before relying on the numbers.
pub fn remarks(sweep: &Sweep) -> Vec<String> {
    let mut remarks = Vec::new();
    let diverged: u64 = sweep.points.iter().flatten().map(|point| point.diverged_paths).sum();
    if diverged > 0 {
        let points = sweep.points.iter().flatten().filter(|point| point.diverged_paths > 0).count();
        remarks.push(format!(
            "{} paths at {points} of {} points diverged or were given up, and are in no statistic",
            grouped(diverged),
            sweep.points.len()
        ));
    }
    if sweep.question.seeds == Seeds::Independent {
        return remarks;
    }
    for (dimension, name) in sweep.question.design.along().into_iter().enumerate() {
        let is_low = |statistic: &Statistic| sweep.gain(dimension, *statistic) < LOW_GAIN;
        let low: Vec<&str> = asked(sweep).into_iter().filter(is_low).map(Statistic::name).collect();
        if !low.is_empty() {
            remarks.push(format!(
                "common seeds hardly sharpen differences along {name} (gain below {LOW_GAIN}) in {} of {} statistics: {}; closer \
                 values do, and --independent makes the errors of points independent",
                low.len(),
                asked(sweep).len(),
                some_of(&low)
            ));
        }
    }
    remarks
}
