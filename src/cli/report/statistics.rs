//! The table of statistics: a row for each, with its interval, its bias and its unit.

use super::bias::{bias_cells, corrected_cell};
use crate::cli::numbers::{Digits, significant, wrapped};
use crate::cli::table::{TableRow, aligned};
use crate::cli::terminal::columns;
use stick_slip::scenario::{Period, PeriodSource, Units};
use stick_slip::scheme::Timeline;
use stick_slip::stats::{Estimate, Statistic, Summary};

/// The statistics that a table has.
#[derive(Clone, Copy, Debug)]
pub enum Chosen<'a> {
    /// What the paper asks: sticks, slips, sub-phases, the share of time at rest, displacement and
    /// drift.
    First,
    /// Everything that the run has measured.
    All,
    /// These, in this order.
    These(&'a [Statistic]),
}

/// What the paper asks.
const FIRST: [Statistic; 9] = [
    Statistic::StickDurationMean,
    Statistic::SticksPerPath,
    Statistic::SlipsPerPath,
    Statistic::SubPhasesMean,
    Statistic::SubPhasesMultipleShare,
    Statistic::StickingFraction,
    Statistic::DisplacementEndMean,
    Statistic::DisplacementEndSd,
    Statistic::DriftVelocity,
];

impl<'a> Chosen<'a> {
    /// The statistics, of those that the run has measured.
    pub fn of(self, summary: &'a Summary) -> &'a [Statistic] {
        match self {
            Chosen::First => &FIRST,
            Chosen::All => &summary.asked,
            Chosen::These(statistics) => statistics,
        }
    }
}

/// The rows of the table, headings first. What does not exist has the reason.
pub fn rows(summary: &Summary, units: &Units, chosen: Chosen, period: Option<Period>) -> Vec<TableRow> {
    table(summary, units, chosen, period).into_iter().map(StatisticLine::with_reason).collect()
}

/// The table as text, at most as wide as the terminal, without standard errors, which intervals
/// show.
pub(super) fn statistics(summary: &Summary, units: &Units, chosen: Chosen, period: Option<Period>) -> String {
    let lines = shown(summary, units, chosen, period);
    let columns = columns();
    let full: Vec<TableRow> = lines.iter().cloned().map(StatisticLine::with_reason).collect();
    let is_narrow = columns.is_some_and(|columns| columns < width(&full));
    let (rows, reasons) = footnotes(lines, is_narrow);
    match columns {
        Some(columns) => narrowed(rows, columns) + &reasons,
        None => aligned(&rows, if width(&rows) > LINE { " " } else { GAP }) + &reasons,
    }
}

/// The lines that the text has, without standard errors.
fn shown(summary: &Summary, units: &Units, chosen: Chosen, period: Option<Period>) -> Vec<StatisticLine> {
    let mut lines = table(summary, units, chosen, period);
    for line in &mut lines {
        line.row.cells.remove(STANDARD_ERROR);
    }
    lines
}

/// A row whose note is a unit, and the reason why a number in it is missing.
#[derive(Clone)]
struct StatisticLine {
    row: TableRow,
    reason: Option<String>,
}

impl StatisticLine {
    /// The row with a remark in brackets behind its unit.
    fn with(mut self, remark: &str) -> TableRow {
        self.row.note = format!("{} ({remark})", self.row.note).trim_start().to_string();
        self.row
    }

    fn with_reason(mut self) -> TableRow {
        match self.reason.take() {
            Some(reason) => self.with(&reason),
            None => self.row,
        }
    }
}

/// The rows with letters in the place of reasons, and each reason once as a footnote. A reason that
/// only one row has stays in its row, unless it is long or the terminal is too narrow.
fn footnotes(lines: Vec<StatisticLine>, is_narrow: bool) -> (Vec<TableRow>, String) {
    let all: Vec<String> = lines.iter().filter_map(|line| line.reason.clone()).collect();
    let is_shared = |reason: &String| all.iter().filter(|other| *other == reason).count() > 1;
    let mut below: Vec<String> = Vec::new();
    let mut row = |line: StatisticLine| match &line.reason {
        Some(reason) if is_narrow || reason.len() > LONG || is_shared(reason) => {
            if !below.contains(reason) {
                below.push(reason.clone());
            }
            let number = below.iter().position(|known| known == reason).unwrap_or_default();
            line.with(&mark(number).to_string())
        }
        _ => line.with_reason(),
    };
    let rows = lines.into_iter().map(&mut row).collect();
    let numbered = below.iter().enumerate();
    (rows, numbered.map(|(number, reason)| wrapped(&format!("({}) {reason}", mark(number)), "    ")).collect())
}

/// A reason of more letters than this has no room in its row.
const LONG: usize = 40;

/// The mark of a footnote: a, b, c, ... There are fewer reasons than letters.
fn mark(number: usize) -> char {
    (b'a'..=b'z').nth(number).map_or('z', char::from)
}

/// The space between two columns.
const GAP: &str = "  ";

/// The columns that are left out of a table that is too wide, in this order. Their numbers follow
/// from the columns that stay.
const SPARE: [&str; 1] = ["corrected"];

/// The place of the standard error in a row.
const STANDARD_ERROR: usize = 2;

/// The longest line where there is no terminal, in characters, if narrow gaps make it fit.
const LINE: usize = 80;

/// The length of the longest line of a table.
fn width(table: &[TableRow]) -> usize {
    aligned(table, GAP).lines().map(|line| line.chars().count()).max().unwrap_or(0)
}

/// The table as text, without the columns that do not fit.
fn narrowed(mut table: Vec<TableRow>, columns: usize) -> String {
    if width(&table) <= columns {
        return aligned(&table, GAP);
    }
    let mut left_out = Vec::new();
    for heading in SPARE {
        let place = table.first().and_then(|row| row.cells.iter().position(|cell| cell == heading));
        if let Some(place) = place.filter(|_| width(&table) > columns) {
            left_out.push(heading);
            table.iter_mut().filter(|row| place < row.cells.len()).for_each(|row| drop(row.cells.remove(place)));
        }
    }
    let note = format!("(no room for {}; a wider terminal and --json show it)", left_out.join(" and "));
    let gap = if width(&table) > columns { " " } else { GAP };
    aligned(&table, gap) + &if left_out.is_empty() { String::new() } else { wrapped(&note, "") }
}

/// The lines of the statistics, headings first.
fn table(summary: &Summary, units: &Units, chosen: Chosen, period: Option<Period>) -> Vec<StatisticLine> {
    let has_bias = summary.has_bias();
    let estimates = || chosen.of(summary).iter().map(|statistic| summary.estimate(*statistic));
    let labels: Vec<String> = estimates().map(|e| e.statistic.dimension().label(units)).collect();
    let headings = headings(has_bias, labels.iter().any(|label| !label.is_empty()));
    let of = |(e, note): (&Estimate, String)| {
        let reason = summary.absence(e).map(String::from).or_else(|| of_period(summary, e.statistic, period));
        StatisticLine { row: row(e, has_bias).noted(note), reason }
    };
    let lines = estimates().zip(labels).map(of);
    std::iter::once(StatisticLine { row: headings, reason: None }).chain(lines).collect()
}

/// What the period is from which the numbers at its ends follow, where no forcing sets it or the run
/// has few of them.
fn of_period(summary: &Summary, statistic: Statistic, period: Option<Period>) -> Option<String> {
    let is_of_periods = matches!(statistic, Statistic::DriftVelocity | Statistic::DiffusionCoefficient);
    let Period { length, source } = period.filter(|_| is_of_periods)?;
    let counted = summary.counted_periods();
    if (1..Timeline::FEWEST_PERIODS).contains(&counted) {
        let plural = if counted == 1 { "" } else { "s" };
        let least = Timeline::FEWEST_PERIODS;
        return Some(format!("of {counted} whole period{plural}; below {least} it may be a transient"));
    }
    let is_preset = source == PeriodSource::Share;
    is_preset.then(|| format!("from the ends of periods P = {}, {}", significant(length, 4), source.words()))
}

/// The headings.
fn headings(has_bias: bool, has_unit: bool) -> TableRow {
    let headings: &[&str] = match has_bias {
        true => &["estimate", "std. error", "95 % from", "to", "bias", "+-", "corrected"],
        false => &["estimate", "std. error", "95 % from", "to"],
    };
    TableRow::labelled("statistic", headings.iter().copied()).noted(if has_unit { "unit" } else { "" })
}

/// The row of one statistic, with as many digits as its standard error justifies.
fn row(e: &Estimate, has_bias: bool) -> TableRow {
    let digits = Digits::of(e.estimate, e.standard_error);
    let has_interval = e.low.is_finite() && e.high.is_finite();
    let mut cells = digits.show_all([e.estimate, e.standard_error]).to_vec();
    cells.extend(if has_interval { digits.show_all([e.low, e.high]) } else { ["none".into(), String::new()] });
    if has_bias {
        cells.extend(bias_cells(e.bias));
        cells.push(corrected_cell(e));
    }
    TableRow::labelled(e.statistic.name(), cells)
}

#[cfg(test)]
mod tests {
    use super::super::RunInfo;
    use super::super::sample::{info, info_in, reason, row, set, summary, table};
    use super::Chosen;
    use stick_slip::scenario::{Period, PeriodSource, Units};
    use stick_slip::stats::{Bias, Estimate, Statistic};

    #[test]
    fn the_table_shows_every_statistic_to_two_digits_of_its_error() {
        let table = table(&summary(), &info());
        for statistic in summary().asked.iter().copied() {
            row(&table, statistic.name());
        }
        let cells: Vec<&str> = row(&table, "stick_duration_mean").split_whitespace().collect();
        assert_eq!(cells, ["stick_duration_mean", "0.53857", "0.53805", "0.53909"]);
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
        let cells = |name| row(&table, name).split_whitespace().skip(4).map(str::to_string).collect::<Vec<_>>();
        assert_eq!(cells("stick_duration_mean"), ["0.096", "0.031", "0.444"]);
        assert_eq!(cells("sticks_per_path"), ["none"]);
        // A bias smaller than its uncertainty is not corrected.
        assert_eq!(cells("slips_per_path"), ["0.03", "0.10"]);
        assert!(table.lines().take(20).all(|line| line.chars().count() <= 80), "{table}");
    }

    #[test]
    fn a_narrow_terminal_leaves_out_what_follows_from_the_rest() {
        let mut summary = summary();
        summary.estimates[0].bias = Some(Bias { estimate: 0.0955, uncertainty: 0.0311, order: Some(0.58) });
        let (rows, _) = super::footnotes(super::shown(&summary, &Units::default(), Chosen::All, None), true);
        let wide = super::narrowed(rows.clone(), 200);
        assert_eq!(wide, super::aligned(&rows, super::GAP));
        let narrow = super::narrowed(rows, 70);
        assert!(narrow.lines().all(|line| line.chars().count() <= 70), "{narrow}");
        let cells: Vec<&str> = row(&narrow, "stick_duration_mean").split_whitespace().collect();
        assert_eq!(cells[..4], ["stick_duration_mean", "0.53857", "0.53805", "0.53909"], "{narrow}");
        assert!(narrow.contains("no room for corrected"), "{narrow}");
    }

    #[test]
    fn units_get_a_column_where_they_have_labels() {
        let (time, length, force) = ("s".to_string(), "m".to_string(), "N".to_string());
        let units = Units { time, length, force, temperature: String::new() };
        let table = table(&summary(), &info_in(units));
        let unit = |name| row(&table, name).rsplit("  ").next().unwrap_or_default();
        assert_eq!(unit("stick_duration_mean"), "s");
        assert_eq!(unit("drift_velocity"), "m/s");
        assert_eq!(unit("diffusion_coefficient"), "m^2/s");
        assert_eq!(unit("friction_work_mean"), "N m");
        // A label of a unit may contain brackets, which are not the brackets of a reason.
        let units = Units { length: "(mm)".to_string(), ..Units::default() };
        assert!(row(&super::super::sample::table(&self::summary(), &info_in(units)), "jump_mean").ends_with("(mm)"));
    }

    #[test]
    fn a_number_that_does_not_exist_says_why() {
        let mut summary = summary();
        summary.stick_durations.completed = 0;
        summary.first_sticks.completed = 0;
        summary.sub_phases.counts = vec![];
        summary.periods.time.truncate(1);
        for (statistic, why) in [
            (Statistic::StickDurationMean, "no stick ended, the first one apart"),
            (Statistic::FirstStickDurationMean, "no first stick ended"),
            (Statistic::SubPhasesMean, "no slip was completed"),
            (Statistic::JumpAbsMean, "no slip was completed"),
            (Statistic::DriftVelocity, "needs the ends of two periods"),
            (Statistic::PeriodDisplacementCorrelation, "needs the ends of three periods"),
        ] {
            set(&mut summary, statistic, f64::NAN);
            let table = table(&summary, &info());
            assert!(
                row(&table, statistic.name()).contains(" none") && reason(&table, statistic.name()) == why,
                "{table}"
            );
        }
    }

    /// The first table has what the paper asks, and a table of chosen statistics these in their order.
    #[test]
    fn a_table_has_the_statistics_that_are_asked_for() {
        let chosen = [Statistic::JumpMean, Statistic::StickDurationMean];
        let names = |chosen| -> Vec<String> {
            let rows = super::rows(&summary(), &Units::default(), chosen, None);
            rows.into_iter().skip(1).map(|row| row.cells[0].clone()).collect()
        };
        assert_eq!(names(Chosen::These(&chosen)), ["jump_mean", "stick_duration_mean"]);
        assert_eq!((names(Chosen::First).len(), names(Chosen::All).len()), (9, summary().asked.len()));
    }

    /// A drift says of how few periods it is, or that nothing but the length of the run sets P.
    #[test]
    fn a_drift_says_what_its_periods_are() {
        let drift = |count: usize, source| {
            let mut summary = summary();
            summary.periods.time = (1..=count).map(|n| 25.0 * n as f64).collect();
            let info = RunInfo { period: Some(Period { length: 25.0, source }), ..info() };
            reason(&table(&summary, &info), "drift_velocity").to_string()
        };
        assert_eq!(drift(2, PeriodSource::Forcing), "of 1 whole period; below 3 it may be a transient");
        assert_eq!(drift(4, PeriodSource::Forcing), "");
        assert_eq!(
            drift(10, PeriodSource::Share),
            "from the ends of periods P = 25, a tenth of the time that is counted"
        );
    }

    #[test]
    fn paths_that_agree_by_chance_have_no_interval_and_the_table_says_why() {
        let mut summary = summary();
        for e in summary.estimates.iter_mut().filter(|e| e.statistic == Statistic::SlipsPerPath) {
            *e = Estimate { estimate: 0.0, standard_error: 0.0, low: 0.0, high: f64::INFINITY, ..*e };
        }
        let table = table(&summary, &info());
        assert!(row(&table, "slips_per_path").contains("none"), "{table}");
        assert_eq!(reason(&table, "slips_per_path"), "all paths agree");
    }

    #[test]
    fn one_path_has_estimates_without_intervals() {
        let mut summary = summary();
        summary.completed_paths = 1;
        set(&mut summary, Statistic::SticksPerPath, 4.0);
        let table = table(&summary, &info());
        assert!(row(&table, "sticks_per_path").contains("4.000000"), "{table}");
        assert_eq!(reason(&table, "sticks_per_path"), "an interval needs two paths");
        assert_eq!(table.matches("an interval needs two paths").count(), 1, "said once:\n{table}");
    }
}
