//! The report of a run: a row for each statistic, with its interval, its bias and its unit.

use super::remarks::remarks;
use super::{
    Cell, Column, FOR_PEOPLE, Format, INTERVAL, Report, Row, RunInfo, TEXT, Table, of_estimate,
    of_step,
};
use crate::output::numbers::{Digits, counted, significant};
use stickslip::engine::{Provenance, Status};
use stickslip::scenario::{Period, PeriodSource};
use stickslip::scheme::Timeline;
use stickslip::stats::{Bias, Dimension, Estimate, Statistic, Summary};

/// The statistics that a table has.
#[derive(Clone, Copy, Debug)]
pub enum ShownStatistics<'a> {
    /// The paper's questions: sticks, slips, sub-phases, the share of time at rest, displacement
    /// and drift.
    First,
    /// Everything that the run has measured.
    All,
    /// These, in this order.
    These(&'a [Statistic]),
}

/// What the paper asks. Of a body without a spring, the displacements come first.
pub(super) const FIRST: [Statistic; 9] = [
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

impl<'a> ShownStatistics<'a> {
    /// The chosen statistics, given the main ones and all.
    pub fn of(self, first: &'a [Statistic], all: &'a [Statistic]) -> &'a [Statistic] {
        match self {
            ShownStatistics::First => first,
            ShownStatistics::All => all,
            ShownStatistics::These(statistics) => statistics,
        }
    }
}

/// The report of these statistics, with all remarks or only those that nobody must miss.
pub fn run(summary: &Summary, info: &RunInfo, chosen: ShownStatistics, has_notes: bool) -> Report {
    let Provenance {
        title,
        scheme,
        step,
        seed,
        paths,
        antithetic,
        units,
        ..
    } = &info.provenance;
    let step = of_step(*step);
    let paths = counted(
        if info.status == Status::Ended {
            summary.completed_paths
        } else {
            *paths
        },
        "path",
    );
    let pairs = if *antithetic {
        " in antithetic pairs"
    } else {
        ""
    };
    let mut first = FIRST;
    first.sort_by_key(|of| info.is_free && of.dimension() != Dimension::LENGTH);
    let rows = chosen.of(&first, &summary.asked).iter().map(|statistic| {
        let e = summary.estimate(*statistic);
        let cells = cells(e, summary.has_bias())
            .into_iter()
            .chain([statistic.dimension().label(units).into()]);
        let absence = summary
            .absence(e)
            .map(String::from)
            .or_else(|| of_period(summary, *statistic, info.period));
        Row {
            why: absence.unwrap_or_default(),
            ..Row::of(statistic.name(), cells)
        }
    });
    let table = Table {
        columns: columns(),
        rows: rows.collect(),
        ..Table::default()
    };
    Report {
        title: title.clone(),
        about: format!("{scheme}{step}, seed {seed}, {paths}{pairs}"),
        tables: vec![table],
        remarks: remarks(summary, info, has_notes),
        ..Report::default()
    }
}

/// The columns of [`cells`] between a statistic and its unit. Intervals show standard errors, and
/// what is corrected follows from the bias.
fn columns() -> Vec<Column> {
    let [estimate, standard_error, low, high] = of_estimate();
    let corrected = Column::of("estimate_corrected", "corrected").not_in(&[Format::Narrow]);
    let ends = ["low", "high"]
        .map(|end| Column::of(format!("estimate_corrected_{end}"), "").not_in(FOR_PEOPLE));
    let [low_corrected, high_corrected] = ends;
    vec![
        Column::of("statistic", "statistic"),
        estimate,
        standard_error.not_in(TEXT),
        low,
        high,
        Column::of("bias", "bias"),
        Column::of("bias_uncertainty", "+-"),
        corrected,
        low_corrected,
        high_corrected,
        Column::unit("unit"),
    ]
}

/// The numbers of a statistic, with as many digits as its standard error justifies.
fn cells(e: &Estimate, has_bias: bool) -> Vec<Cell> {
    let mut cells = estimate_cells(e).to_vec();
    cells.extend(if has_bias {
        bias_cells(e.bias)
    } else {
        Default::default()
    });
    cells.extend(corrected_cells(e));
    cells
}

/// An estimate, its standard error and its interval, if it has one.
pub(super) fn estimate_cells(e: &Estimate) -> [Cell; 4] {
    let mut cells = Cell::all(
        [e.estimate, e.standard_error, e.low, e.high],
        e.standard_error,
    );
    if !(e.low.is_finite() && e.high.is_finite()) {
        cells[2].text = "none".into();
        cells[3].text.clear();
    }
    // Without an error there is nothing to say about an interval; the reason stands beside it.
    if !e.standard_error.is_finite() {
        cells[1..].iter_mut().for_each(|cell| cell.text.clear());
    }
    cells
}

/// A bias and its uncertainty, to two digits of the uncertainty; `none` where the bias is not
/// known.
pub(super) fn bias_cells(bias: Option<Bias>) -> [Cell; 2] {
    match bias {
        Some(Bias {
            estimate,
            uncertainty,
            ..
        }) => Cell::all([estimate, uncertainty], uncertainty),
        None => [Cell::missing("none"), Cell::missing("")],
    }
}

/// The corrected estimate to two digits of its own error, and its interval. Empty if the correction
/// does not improve the estimate.
pub(super) fn corrected_cells(e: &Estimate) -> [Cell; 3] {
    let Some(c) = e.corrected() else {
        return [""; 3].map(Cell::missing);
    };
    let digits = Digits::of(c.estimate, (c.high - c.low) / 2.0 / INTERVAL);
    let is_better = e.bias.is_some_and(|bias| bias.weight() > 0.0);
    let text = |x| {
        if is_better {
            digits.show(x)
        } else {
            String::new()
        }
    };
    [c.estimate, c.low, c.high].map(|x| Cell::number(x, text(x)))
}

/// The period at whose ends these numbers are taken, if no forcing sets it or the run has few of
/// them.
fn of_period(summary: &Summary, statistic: Statistic, period: Option<Period>) -> Option<String> {
    let is_of_periods = matches!(
        statistic,
        Statistic::DriftVelocity | Statistic::DiffusionCoefficient
    );
    let Period { length, source } = period.filter(|_| is_of_periods)?;
    let (periods, least) = (summary.counted_periods(), Timeline::FEWEST_PERIODS);
    if (1..least).contains(&periods) {
        let periods = counted(periods as u64, "whole period");
        return Some(format!("of {periods}; below {least} it may be a transient"));
    }
    let is_preset = source == PeriodSource::Share;
    is_preset.then(|| {
        format!(
            "from the ends of periods P = {}, {}",
            significant(length, 4),
            source.words()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::RunInfo;
    use super::super::sample_tests::{info, info_in, reason, row, set, summary, table};
    use super::super::text::of_table;
    use super::ShownStatistics;
    use stickslip::scenario::{Period, PeriodSource, Units};
    use stickslip::stats::{Bias, Estimate, Statistic};

    #[test]
    fn the_table_shows_every_statistic_to_two_digits_of_its_error() {
        let table = table(&summary(), &info());
        for statistic in summary().asked.iter().copied() {
            row(&table, statistic.name());
        }
        let cells: Vec<&str> = row(&table, "stick_duration_mean")
            .split_whitespace()
            .collect();
        assert_eq!(
            cells,
            ["stick_duration_mean", "0.53857", "0.53805", "0.53909"]
        );
        let ends: Vec<usize> = table
            .lines()
            .skip(3)
            .take(17)
            .map(|line| line.trim_end().len())
            .collect();
        assert!(
            ends[1..].iter().all(|end| *end == ends[1]),
            "the columns are aligned:\n{table}"
        );
        assert!(
            !table.contains("bias") && !table.contains("diverged"),
            "{table}"
        );
    }

    #[test]
    fn known_bias_gets_a_column() {
        let mut summary = summary();
        summary.estimates[0].bias = Some(Bias {
            estimate: 0.0955,
            uncertainty: 0.0311,
            order: Some(0.58),
        });
        let index = Statistic::SlipsPerPath.index();
        summary.estimates[index].bias = Some(Bias {
            estimate: 0.03,
            uncertainty: 0.1,
            order: None,
        });
        let table = table(&summary, &info());
        let cells = |name| {
            row(&table, name)
                .split_whitespace()
                .skip(4)
                .map(str::to_string)
                .collect::<Vec<_>>()
        };
        assert_eq!(cells("stick_duration_mean"), ["0.096", "0.031", "0.444"]);
        assert_eq!(cells("sticks_per_path"), ["none"]);
        // A bias smaller than its uncertainty is not corrected.
        assert_eq!(cells("slips_per_path"), ["0.03", "0.10"]);
        assert!(
            table
                .lines()
                .take(20)
                .all(|line| line.chars().count() <= 80),
            "{table}"
        );
    }

    #[test]
    fn a_narrow_terminal_leaves_out_what_follows_from_the_rest() {
        let mut summary = summary();
        summary.estimates[0].bias = Some(Bias {
            estimate: 0.0955,
            uncertainty: 0.0311,
            order: Some(0.58),
        });
        let table = &super::run(&summary, &info(), ShownStatistics::All, false).tables[0];
        let [wide, narrow] = [200, 70].map(|columns| of_table(table, Some(columns)));
        assert!(
            wide.contains("corrected") && !wide.contains("no room"),
            "{wide}"
        );
        assert!(
            narrow.lines().all(|line| line.chars().count() <= 70),
            "{narrow}"
        );
        let cells: Vec<&str> = row(&narrow, "stick_duration_mean")
            .split_whitespace()
            .collect();
        assert_eq!(
            cells[..4],
            ["stick_duration_mean", "0.53857", "0.53805", "0.53909"],
            "{narrow}"
        );
        assert!(
            narrow.contains("not all columns fit") && !narrow.contains("corrected"),
            "{narrow}"
        );
    }

    #[test]
    fn units_get_a_column_where_they_have_labels() {
        let (time, length, force) = ("s".to_string(), "m".to_string(), "N".to_string());
        let units = Units {
            time,
            length,
            force,
            temperature: String::new(),
        };
        let table = table(&summary(), &info_in(units));
        let unit = |name| row(&table, name).rsplit("  ").next().unwrap_or_default();
        assert_eq!(unit("stick_duration_mean"), "s");
        assert_eq!(unit("drift_velocity"), "m/s");
        assert_eq!(unit("diffusion_coefficient"), "m²/s");
        assert_eq!(unit("friction_work_mean"), "N m");
        // A label of a unit may contain brackets, which are not the brackets of a reason.
        let units = Units {
            length: "(mm)".to_string(),
            ..Units::default()
        };
        assert!(
            row(
                &super::super::sample_tests::table(&self::summary(), &info_in(units)),
                "jump_mean"
            )
            .ends_with("(mm)")
        );
    }

    #[test]
    fn a_number_that_does_not_exist_says_why() {
        let mut summary = summary();
        summary.stick_durations.completed = 0;
        summary.first_sticks.completed = 0;
        summary.sub_phases.counts = vec![];
        summary.periods.time.truncate(1);
        for (statistic, why) in [
            (
                Statistic::StickDurationMean,
                "no stick after the first ended",
            ),
            (Statistic::FirstStickDurationMean, "no first stick ended"),
            (Statistic::SubPhasesMean, "no slip was completed"),
            (Statistic::JumpAbsMean, "no slip was completed"),
            (Statistic::DriftVelocity, "needs the ends of two periods"),
            (
                Statistic::PeriodDisplacementCorrelation,
                "needs the ends of three periods",
            ),
        ] {
            set(&mut summary, statistic, f64::NAN);
            let table = table(&summary, &info());
            assert!(
                row(&table, statistic.name()).contains(" none")
                    && reason(&table, statistic.name()) == why,
                "{table}"
            );
        }
    }

    /// The first table has what the paper asks, and a table of chosen statistics these in their order.
    #[test]
    fn a_table_has_the_statistics_that_are_asked_for() {
        let chosen = [Statistic::JumpMean, Statistic::StickDurationMean];
        let names = |chosen| -> Vec<String> {
            let rows = &super::run(&summary(), &info(), chosen, false).tables[0].rows;
            rows.iter().map(|row| row.cells[0].text.clone()).collect()
        };
        assert_eq!(
            names(ShownStatistics::These(&chosen)),
            ["jump_mean", "stick_duration_mean"]
        );
        assert_eq!(
            (
                names(ShownStatistics::First).len(),
                names(ShownStatistics::All).len()
            ),
            (9, summary().asked.len())
        );
    }

    /// The table of a body without a spring begins with its displacement.
    #[test]
    fn a_sliding_block_is_reported_by_its_displacement() {
        let info = RunInfo {
            is_free: true,
            ..info()
        };
        let rows = &super::run(&summary(), &info, ShownStatistics::First, false).tables[0].rows;
        let names: Vec<&str> = rows.iter().map(|row| row.cells[0].text.as_str()).collect();
        assert_eq!(names[..2], ["displacement_end_mean", "displacement_end_sd"]);
        assert_eq!((names[2], names.len()), ("stick_duration_mean", 9));
    }

    /// A drift says of how few periods it is, or that nothing but the length of the run sets P.
    #[test]
    fn a_drift_says_what_its_periods_are() {
        let drift = |count: usize, source| {
            let mut summary = summary();
            summary.periods.time = (1..=count).map(|n| 25.0 * n as f64).collect();
            let info = RunInfo {
                period: Some(Period {
                    length: 25.0,
                    source,
                }),
                ..info()
            };
            reason(&table(&summary, &info), "drift_velocity").to_string()
        };
        assert_eq!(
            drift(2, PeriodSource::Forcing),
            "of 1 whole period; below 3 it may be a transient"
        );
        assert_eq!(drift(4, PeriodSource::Forcing), "");
        assert_eq!(
            drift(10, PeriodSource::Share),
            "from the ends of periods P = 25, a tenth of the counted time"
        );
    }

    #[test]
    fn chance_agreement_has_no_interval_but_a_reason() {
        let mut summary = summary();
        for e in summary
            .estimates
            .iter_mut()
            .filter(|e| e.statistic == Statistic::SlipsPerPath)
        {
            *e = Estimate {
                estimate: 0.0,
                standard_error: 0.0,
                low: 0.0,
                high: f64::INFINITY,
                ..*e
            };
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
        assert!(
            row(&table, "sticks_per_path").contains("4.000000"),
            "{table}"
        );
        assert_eq!(
            reason(&table, "sticks_per_path"),
            "an interval needs two paths"
        );
        assert_eq!(
            table.matches("an interval needs two paths").count(),
            1,
            "said once:\n{table}"
        );
    }

    /// The corrected cells are the value minus the bias, between its ends, for a program as well.
    #[test]
    fn corrected_cells_are_in_order() {
        let bias = Bias {
            estimate: 2.0,
            uncertainty: 1.0,
            order: None,
        };
        let e = Estimate {
            statistic: Statistic::SticksPerPath,
            estimate: 10.0,
            standard_error: 0.5,
            low: 9.25,
            high: 10.75,
            bias: Some(bias),
        };
        let numbers = super::corrected_cells(&e).map(|cell| cell.number);
        assert_eq!(numbers, [8.125, 6.75, 9.25].map(Some));
    }
}
