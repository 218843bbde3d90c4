//! The report of a sweep: a table for each statistic, the gain from common seeds, and elasticities
//! sorted by size.

use super::run::{bias_cells, estimate_cells};
use super::{
    Cell, Column, FOR_PEOPLE, Format, NO_TEXT, Report, Row, ShownStatistics, Table, of_estimate,
    of_step,
};
use crate::output::numbers::{counted, duration, grouped, some_of};
use std::path::Path;
use stickslip::stats::Statistic;
use stickslip::study::sweep::{
    AxisValue, AxisValues, Design, Paired, Point, Seeds, Sweep, SweepAxis, SweepQuestion,
};

/// A gain below this is reported: common seeds are then hardly better than independent ones.
const LOW_GAIN: f64 = 2.0;

/// The statistics that are printed if none is named.
const USUAL: [Statistic; 3] = [
    Statistic::StickDurationMean,
    Statistic::SubPhasesMultipleShare,
    Statistic::StickingFraction,
];

/// The report of these statistics of a sweep that is in this file.
pub fn sweep(sweep: &Sweep, chosen: ShownStatistics, file: &Path) -> Report {
    let asked = asked(sweep);
    let shown = chosen.of(&USUAL, &asked);
    let question = &sweep.question;
    let step = of_step(question.scenario.scheme.step());
    let paths = paths_of_each(question).map_or_else(String::new, |each| format!(", {each}"));
    let tables = shown.iter().flat_map(|statistic| match &question.design {
        Design::Star { keys, .. } => {
            let points = Table {
                not_in: FOR_PEOPLE,
                ..points(sweep, *statistic)
            };
            vec![elasticities(sweep, keys, *statistic), points]
        }
        Design::Grid(_) | Design::Zip(_) => vec![points(sweep, *statistic)],
    });
    let keys = keys(&question.design);
    let varied: Vec<&str> = keys.iter().map(|(key, _)| key.as_str()).collect();
    let seconds: f64 = sweep
        .points
        .iter()
        .flatten()
        .map(|point| point.seconds)
        .sum();
    Report {
        // The title may name a value that the sweep varies.
        title: format!(
            "{} (varied: {})",
            question.scenario.title,
            varied.join(", ")
        ),
        about: format!(
            "{}{step}{paths}, {} seeds",
            question.scenario.scheme.name(),
            question.seeds.name()
        ),
        tables: tables.chain(gains(sweep)).collect(),
        remarks: vec![
            (
                "time",
                format!(
                    "{} of CPU for {} points",
                    duration(seconds),
                    grouped(sweep.done() as u64)
                ),
            ),
            ("file", file.display().to_string()),
        ],
        ..Report::default()
    }
}

/// The number of paths of each point, if it is the same for all.
pub fn paths_of_each(question: &SweepQuestion) -> Option<String> {
    let first = question.points[0].ensemble.paths;
    let is_same = question
        .points
        .iter()
        .all(|point| point.ensemble.paths == first);
    is_same.then(|| format!("{} at each point", counted(first, "path")))
}

/// One statistic at every point and, if the points form a line, its difference to the next point.
fn points(sweep: &Sweep, statistic: Statistic) -> Table {
    let design = &sweep.question.design;
    // Neighbouring files are not close to each other.
    let has_numbers = |axis: &SweepAxis| matches!(axis.values, AxisValues::Numbers(_));
    let is_line = design.along().len() == 1 && design.axes().iter().all(has_numbers);
    let keys = keys(design);
    let has_bias = sweep
        .points
        .iter()
        .flatten()
        .any(|point| point.estimates[statistic.index()].bias.is_some());
    let row = |(p, point): (usize, &Option<Point>)| {
        let settings = design.settings(p);
        let value = |key: &str| {
            settings
                .iter()
                .find(|setting| setting.key == key)
                .map(|setting| &setting.value)
        };
        let mut cells: Vec<Cell> = keys
            .iter()
            .map(|(key, _)| match value(key) {
                Some(AxisValue::Number(x)) => Cell::significant(*x, 12),
                Some(AxisValue::File(file)) => file.as_str().into(),
                None => Cell::default(),
            })
            .collect();
        cells.push(statistic.name().into());
        let Some(point) = point else {
            cells.push(Cell::missing("missing"));
            return Row {
                cells,
                why: String::new(),
            };
        };
        let e = &point.estimates[statistic.index()];
        cells.extend(estimate_cells(e));
        cells.extend(if has_bias {
            bias_cells(e.bias)
        } else {
            Default::default()
        });
        cells.extend(if is_line {
            to_next(sweep.difference(p, 0, statistic))
        } else {
            Default::default()
        });
        cells.push(
            statistic
                .dimension()
                .label(&sweep.question.scenario.units)
                .into(),
        );
        Row {
            cells,
            why: String::new(),
        }
    };
    let rows = sweep.points.iter().enumerate().map(row).collect();
    let unit = statistic.dimension().label(&sweep.question.scenario.units);
    let unit = match unit.as_str() {
        "" => unit,
        _ => format!(" ({unit})"),
    };
    Table {
        heading: format!("{}{unit}", statistic.name()),
        columns: point_columns(&keys),
        rows,
        ..Table::default()
    }
}

/// The keys that differ between points, with their names.
fn keys(design: &Design) -> Vec<(String, String)> {
    match design {
        Design::Star { keys, .. } => keys
            .iter()
            .map(|(key, _)| (key.clone(), key.clone()))
            .collect(),
        _ => design
            .axes()
            .iter()
            .map(|axis| (axis.key.clone(), axis.name.clone()))
            .collect(),
    }
}

fn point_columns(keys: &[(String, String)]) -> Vec<Column> {
    let mut columns: Vec<Column> = keys
        .iter()
        .map(|(key, name)| Column::of(key, name))
        .collect();
    columns.extend([in_joined(Column::of("statistic", "statistic"))]);
    columns.extend(of_estimate());
    let rest = [
        ("bias", "bias"),
        ("bias_uncertainty", "+-"),
        ("to_next", "to the next"),
        ("to_next_error", "std. error"),
    ];
    columns.extend(super::columns(rest));
    columns.extend([Column::of("gain", "gain"), in_joined(Column::unit("unit"))]);
    columns
}

/// The difference to the next point, its error, and the gain.
fn to_next(difference: Option<Paired>) -> [Cell; 3] {
    difference.map_or_else(
        Default::default,
        |Paired {
             measurement: m,
             gain,
         }| {
            let [difference, error] = Cell::all([m.estimate, m.standard_error], m.standard_error);
            [difference, error, gain_cell(gain)]
        },
    )
}

/// A column that repeats what the heading of a table says.
fn in_joined(column: Column) -> Column {
    column.not_in(&[Format::Text, Format::Narrow, Format::Html])
}

fn gain_cell(gain: f64) -> Cell {
    if gain.is_finite() {
        Cell::significant(gain, 2)
    } else {
        Cell::missing("none")
    }
}

/// The statistics that every point reports.
fn asked(sweep: &Sweep) -> Vec<Statistic> {
    Statistic::asked_by(&sweep.question.scenario.record)
}

/// The gain from common seeds for the differences of neighbouring points, for each statistic. The
/// gain is the variance with independent seeds over that with common ones.
fn gains(sweep: &Sweep) -> Option<Table> {
    let along = sweep.question.design.along();
    let gains = |statistic: &Statistic| -> Vec<f64> {
        (0..along.len())
            .map(|dimension| sweep.gain(dimension, *statistic))
            .collect()
    };
    let all = asked(sweep)
        .into_iter()
        .map(|statistic| (statistic.name(), gains(&statistic)));
    let rows: Vec<Row> = all
        .filter(|(_, gains)| gains.iter().any(|gain| gain.is_finite()))
        .map(|(name, gains)| Row::of(name, gains.into_iter().map(gain_cell)))
        .collect();
    let columns = ["gain along"]
        .into_iter()
        .chain(along)
        .map(|name| Column::of(name, name))
        .collect();
    let below = "gain: variance of a difference of neighbours with independent seeds, divided by its actual \
        variance";
    let is_common = sweep.question.seeds == Seeds::Common && !rows.is_empty();
    is_common.then(|| Table {
        columns,
        rows,
        below: below.into(),
        not_in: NO_TEXT,
        ..Table::default()
    })
}

/// The elasticities of one statistic, sorted from the largest to the smallest.
fn elasticities(sweep: &Sweep, keys: &[(String, f64)], statistic: Statistic) -> Table {
    let [_, standard_error, low, high] = of_estimate();
    let [key, of_statistic, value, elasticity, gain] =
        ["key", "statistic", "value", "elasticity", "gain"].map(|name| Column::of(name, name));
    let columns = vec![
        key,
        in_joined(of_statistic),
        value,
        elasticity,
        standard_error,
        low,
        high,
        gain,
    ];
    let paired = |key: usize| sweep.elasticity(key, statistic).unwrap_or(Paired::NOTHING);
    let mut order: Vec<(usize, Paired)> = (0..keys.len()).map(|key| (key, paired(key))).collect();
    let size = |paired: &Paired| {
        Some(paired.measurement.estimate.abs())
            .filter(|size| size.is_finite())
            .unwrap_or(-1.0)
    };
    order.sort_by(|a, b| size(&b.1).total_cmp(&size(&a.1)));
    let row = |(
        key,
        Paired {
            measurement: m,
            gain,
        },
    ): (usize, Paired)| {
        let (name, value) = &keys[key];
        let numbers = Cell::all(
            [m.estimate, m.standard_error, m.low, m.high],
            m.standard_error,
        );
        let cells = [statistic.name().into(), Cell::significant(*value, 6)]
            .into_iter()
            .chain(numbers)
            .chain([gain_cell(gain)]);
        let why = if m.estimate.is_nan() {
            "the statistic does not exist, or may be zero"
        } else {
            ""
        };
        Row {
            why: why.into(),
            ..Row::of(name.as_str(), cells)
        }
    };
    let rows = order.into_iter().map(row).collect();
    Table {
        heading: statistic.name().into(),
        columns,
        rows,
        not_in: &[Format::Csv],
        ..Table::default()
    }
}

/// What a reader should know before relying on the numbers.
pub fn warnings(sweep: &Sweep) -> Vec<String> {
    let diverged: u64 = sweep
        .points
        .iter()
        .flatten()
        .map(|point| point.diverged_paths)
        .sum();
    let points = sweep
        .points
        .iter()
        .flatten()
        .filter(|point| point.diverged_paths > 0)
        .count();
    let (lost, of) = (grouped(diverged), sweep.points.len());
    let lost = format!(
        "{lost} paths at {points} of {of} points diverged or were given up, excluded from all \
        statistics"
    );
    let along = sweep.question.design.along().into_iter().enumerate();
    let hardly = along.filter(|_| sweep.question.seeds == Seeds::Common).filter_map(|(dimension, name)| {
        let is_low = |statistic: &Statistic| sweep.gain(dimension, *statistic) < LOW_GAIN;
        let low: Vec<&str> = asked(sweep).into_iter().filter(is_low).map(Statistic::name).collect();
        (!low.is_empty()).then(|| {
            format!(
                "common seeds barely reduce the errors of differences along {name} (gain below {LOW_GAIN}) in \
                 {} of {} statistics: {}; use closer values, or --independent for independent errors of \
                 points",
                low.len(),
                asked(sweep).len(),
                some_of(&low)
            )
        })
    });
    (diverged > 0)
        .then_some(lost)
        .into_iter()
        .chain(hardly)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::sums::Measurement;

    #[test]
    fn the_difference_to_the_next_point_keeps_its_sign() {
        let measurement = Measurement {
            estimate: -2.0,
            standard_error: 0.25,
            low: -2.5,
            high: -1.5,
        };
        let gain = 3.0;
        let cells = to_next(Some(Paired { measurement, gain }));
        assert_eq!(cells.map(|cell| cell.number), [-2.0, 0.25, 3.0].map(Some));
    }
}
