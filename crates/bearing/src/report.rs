//! Reports of a bearing: its calibration, the weather, and its future years.

use crate::calibration::{
    Calibration, CalibrationMethod, Lag, ParameterEstimate, Quantity, SearchStart, Values,
};
use crate::forecast::{Forecast, ForecastQuantity, YEAR};
use crate::weather::WeatherFit;
use stickslip_data::Start;
use stickslip_report::{Cell, Column, Format, NO_TEXT, Report, Row, Table, columns};
use stickslip_text::numbers::{grouped, percent, significant, time};

/// The report of a calibration, in the units of a scenario, or for a page in millimetres.
pub fn calibration(title: &str, calibration: &Calibration, is_page: bool) -> Report {
    let level = percent(calibration.question.level);
    let columns = vec![
        Column::of("quantity", "").not_in(&[Format::Html]),
        Column::of("words", "quantity").not_in(NOT_IN_PAGE),
        Column::of("symbol", if is_page { "symbol" } else { "" }),
        Column::of("estimate", "estimate"),
        Column::of("low", format!("{level} from")).not_in(&[Format::Html]),
        Column::of("high", "to").not_in(&[Format::Html]),
        Column::of("range", format!("{level} range")).not_in(NOT_IN_PAGE),
        Column::unit("").not_in(&[Format::Html]),
    ];
    let row = |quantity: &Quantity| {
        let ParameterEstimate {
            estimate,
            low,
            high,
        } = calibration.estimate(*quantity);
        let (factor, unit) = if is_page {
            for_people(quantity.unit())
        } else {
            (1.0, quantity.unit().into())
        };
        let numbers = Cell::all(
            [estimate, low, high].map(|number| factor * number),
            factor * (high - low) / 4.0,
        );
        let range = range(&numbers[1], &numbers[2]);
        let words = with_unit(quantity.words(), &unit);
        let names = [words.as_str(), quantity.symbol()].map(Cell::from);
        let last = [range, unit.as_str().into()];
        Row::of(quantity.key(), names.into_iter().chain(numbers).chain(last))
    };
    let rows = Quantity::ALL.iter().map(row).collect();
    let of_100 = significant(100.0 * calibration.question.level, 4);
    let below = format!(
        "The interval contains the true value in {of_100} of 100 records, if the model holds for the bearing."
    );
    let has_starts = !calibration.starts.is_empty();
    Report {
        title: title.into(),
        tables: std::iter::once(Table {
            columns,
            rows,
            below,
            ..Table::default()
        })
        .chain(has_starts.then(|| starts(calibration)))
        .collect(),
        remarks: sources(calibration),
        ..Report::default()
    }
}

/// The formats that leave out columns only for pages.
const NOT_IN_PAGE: &[Format] = &[Format::Text, Format::Narrow, Format::Csv, Format::Paper];

/// The name of a quantity, with its unit.
fn with_unit(words: &str, unit: &str) -> String {
    match unit {
        "" => words.into(),
        unit => format!("{words} ({unit})"),
    }
}

/// The two ends of a range in one cell.
fn range(low: &Cell, high: &Cell) -> Cell {
    match low.number.is_some_and(f64::is_finite) {
        true => format!("{} to {}", low.text, high.text).as_str().into(),
        false => "".into(),
    }
}

/// Where the numbers come from.
fn sources(calibration: &Calibration) -> Vec<(&'static str, String)> {
    let record = &calibration.record;
    let samples = record
        .readings
        .iter()
        .filter(|reading| reading.is_finite())
        .count();
    let samples = grouped(samples as u64);
    let last = record.times.last().copied().unwrap_or(0.0);
    let day = |instant: Start| instant.to_string().split('T').take(1).collect::<String>();
    let dates = record.start.and_then(|start| {
        Some(format!(
            ", from {} to {}",
            day(start),
            day(start.after(last)?)
        ))
    });
    let slips = calibration.slips.len();
    let usual = calibration
        .slips
        .iter()
        .filter(|slip| slip.is_usual)
        .count();
    let method = match calibration.question.method {
        CalibrationMethod::Err => "least squares",
        _ if calibration.slips.is_empty() => "least squares",
        _ => "slips",
    };
    let between = match calibration.roughness {
        0.0 => "is interpolated linearly".to_string(),
        roughness => {
            let gained = significant((3600.0 * roughness).sqrt(), 3);
            format!(
                "varies like weather, with a standard deviation of {gained} K in an hour; slips begin between samples"
            )
        }
    };
    let correlation = |hours: f64| {
        let found = calibration
            .residuals
            .autocorrelation
            .iter()
            .find(|(delay, _)| *delay == hours);
        found.map_or_else(
            || "none".to_string(),
            |(_, correlation)| significant(*correlation, 2),
        )
    };
    let rest = significant(calibration.residuals.rms, 3);
    let (hour, day) = (correlation(1.0), correlation(24.0));
    let method = format!("{method}; intervals: synthetic records");
    let rest = format!(
        "{rest} m (root mean square of measurement minus model); correlation {hour} after an hour, {day} after a day"
    );
    let repairs = Some(record.repairs.join("; ")).filter(|repairs| !repairs.is_empty());
    let mut sources = vec![
        (
            "data",
            format!(
                "{samples} samples in {}{}",
                time(last),
                dates.unwrap_or_default()
            ),
        ),
        (
            "slips",
            format!("{slips} detected, {usual} of them isolated and of typical size"),
        ),
        ("method", method),
        ("lag", lag(calibration)),
        (
            "moves",
            format!("the temperature between samples {between}"),
        ),
        ("rest", rest),
    ];
    sources.splice(1..1, repairs.map(|repairs| ("repairs", repairs)));
    sources
}

/// The lag, in minutes, and where it comes from.
fn lag(calibration: &Calibration) -> String {
    let minutes = |seconds: f64| significant(seconds / 60.0, 3);
    let ParameterEstimate {
        estimate,
        low,
        high,
    } = calibration.lag;
    match (calibration.question.lag, &calibration.lag_profile) {
        (Lag::Known(known), _) => format!("{} min, as given", minutes(known)),
        (Lag::Auto, Some(_)) if estimate > 0.0 => {
            format!(
                "{} min ({} to {}), estimated",
                minutes(estimate),
                minutes(low),
                minutes(high)
            )
        }
        (Lag::Auto, Some(_)) => "none: no lag describes the record clearly better".to_string(),
        (Lag::Auto, None) => "none: without slips it cannot be estimated".to_string(),
    }
}

/// The table of the paper: the result from each starting point of the least squares, and the
/// scatter of these results.
fn starts(calibration: &Calibration) -> Table {
    const COLUMNS: [Quantity; 6] = [
        Quantity::Offset,
        Quantity::Stiffness,
        Quantity::Dynamic,
        Quantity::Static,
        Quantity::Dilatation,
        Quantity::Displacement,
    ];
    let symbols = COLUMNS.map(Quantity::symbol).into_iter();
    let columns = ["start"]
        .into_iter()
        .chain(symbols)
        .chain(["err"])
        .map(|name| Column::of(name, name))
        .collect();
    let values = calibration.start_values();
    let column = |quantity: &Quantity| {
        values
            .iter()
            .map(|values| values[*quantity as usize])
            .collect::<Vec<f64>>()
    };
    let cell = |x: f64| {
        if x.is_finite() {
            format!("{x:.5e}")
        } else {
            "none".to_string()
        }
    };
    let of_start = |(i, (values, start)): (usize, (&Values, &SearchStart))| {
        let cells = COLUMNS
            .iter()
            .map(|quantity| cell(values[*quantity as usize]))
            .chain([cell(start.err)]);
        Row::of((i + 1).to_string(), cells)
    };
    let mut rows: Vec<Row> = values
        .iter()
        .zip(&calibration.starts)
        .enumerate()
        .map(of_start)
        .collect();
    let moments = |values: &[f64]| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
        [mean, variance.sqrt(), variance.sqrt() / mean.abs()]
    };
    let errs: Vec<f64> = calibration.starts.iter().map(|start| start.err).collect();
    let all: Vec<[f64; 3]> = COLUMNS
        .iter()
        .map(column)
        .chain([errs])
        .map(|values| moments(&values))
        .collect();
    for (k, name) in ["mean", "sd", "CV"].into_iter().enumerate() {
        rows.push(Row::of(name, all.iter().map(|moments| cell(moments[k]))));
    }
    let below = "The scatter of the starts shows how well the search finds the minimum, but not how far the \
                 minimum is from the truth.";
    let heading = "Least-squares starts (err in m²):".into();
    Table {
        heading,
        columns,
        rows,
        below: below.into(),
        not_in: NO_TEXT,
    }
}

/// Slips and sliding path of the record, in total and per year.
pub fn seen(calibration: &Calibration) -> String {
    let length = calibration.record.times.last().copied().unwrap_or(0.0);
    // A jump of z is (1 - kappa) of the slip of x, because the shear of the bearing decreases in a
    // slip.
    let jumps: f64 = calibration.slips.iter().map(|slip| slip.jump.abs()).sum();
    let path = jumps / (1.0 - calibration.estimate(Quantity::Shear).estimate);
    let slips = calibration.slips.len();
    let a_year = |number: f64| significant(number * YEAR / length, 3);
    format!(
        "{} slips were detected in {}, a rate of {} in a year. Their sliding path is {} mm in total, or {} mm in a year.",
        grouped(slips as u64),
        time(length),
        a_year(slips as f64),
        significant(1e3 * path, 3),
        a_year(1e3 * path)
    )
}

/// The factor and the unit in which people read a quantity: lengths of a bearing in millimetres.
fn millimetres(unit: &str) -> (f64, String) {
    match unit {
        "m" | "m/K" => (1e3, format!("m{unit}")),
        _ => (1.0, unit.replace('1', "")),
    }
}

/// The same for a page, with forces in kilonewtons.
fn for_people(unit: &str) -> (f64, String) {
    match unit {
        "N" => (1e-3, "kN".into()),
        "N/m" => (1e-6, "MN/m".into()),
        unit => millimetres(unit),
    }
}

/// The report of the true values of synthetic measurements.
pub fn truth(values: &Values) -> Report {
    let row = |quantity: &Quantity| {
        let value = values[*quantity as usize];
        let value = if value.is_finite() {
            Cell::significant(value, 7)
        } else {
            Cell::missing("none")
        };
        Row::of(quantity.key(), [quantity.symbol().into(), value])
    };
    let columns = ["quantity", "symbol", "value"]
        .map(|name| Column::of(name, ""))
        .to_vec();
    let rows = Quantity::ALL.iter().map(row).collect();
    Report {
        tables: vec![Table {
            columns,
            rows,
            ..Table::default()
        }],
        ..Report::default()
    }
}

/// The first sentences of the page of a forecast.
pub fn typical_year(found: &Forecast) -> String {
    let level = |quantity| found.levels.iter().find(|level| level.quantity == quantity);
    let shown = |quantity: ForecastQuantity, factor: f64| {
        let level = level(quantity)?;
        let [low, high] = level.year_interval.map(|end| significant(factor * end, 3));
        let value = significant(factor * level.expected, 3);
        Some(move |unit: &str| format!("{value}{unit} ({low} to {high})"))
    };
    let path = shown(ForecastQuantity::SlidingPath, 1e3).map(|path| path(" mm"));
    let slips = shown(ForecastQuantity::Slips, 1.0).map(|slips| slips(""));
    let force = shown(ForecastQuantity::Force, 1e-3).map_or(String::new(), |force| {
        format!("; the largest force on the pier is {}", force(" kN"))
    });
    format!(
        "In a typical year the bearing slides {} in {} slips{force}. These are means over the \
         simulated years; the numbers in parentheses are the {} range of one year.",
        path.unwrap_or_default(),
        slips.unwrap_or_default(),
        percent(found.question.level)
    )
}

/// The first sentences of the page of a calibration.
pub fn found(calibration: &Calibration) -> String {
    let shown = |quantity: Quantity, factor: f64, unit: &str| {
        let of = calibration.estimate(quantity);
        let [value, low, high] =
            [of.estimate, of.low, of.high].map(|number| significant(factor * number, 3));
        format!("{value} {unit} ({low} to {high})")
    };
    let hold = match calibration.estimate(Quantity::Static).estimate.is_finite() {
        true => shown(Quantity::Static, 1e-3, "kN"),
        false => format!(
            "{} of restrained movement",
            shown(Quantity::StaticWay, 1e3, "mm")
        ),
    };
    format!(
        "The joint moves {} per kelvin. The bearing sticks up to a friction force of {hold} and \
         then slips. The numbers in parentheses are {} intervals.",
        shown(Quantity::Dilatation, 1e3, "mm"),
        percent(calibration.question.level)
    )
}

/// The symbols on the page of a bearing.
pub const SYMBOLS: &str = "z is the reading of the displacement sensor at the bearing, and T is \
                           the temperature. F is the friction force in the bearing: at rest it is \
                           at most f_s, the static friction; while the bearing slides it is f_d, \
                           the dynamic friction. K is the stiffness of the structure against this \
                           movement, and beta is the movement of the joint per kelvin.";

/// The columns of a forecast.
fn forecast_columns(level: &str, is_page: bool) -> Vec<Column> {
    let only_text = &[Format::Html];
    let [name, expected, low, high, least, most] = columns([
        ("in_a_year", "in a year"),
        ("expected", if is_page { "mean" } else { "expected" }),
        ("low", "from"),
        ("high", "to"),
        ("year_low", "year from"),
        ("year_high", "year to"),
    ]);
    vec![
        name,
        expected,
        low.not_in(only_text),
        high.not_in(only_text),
        least.not_in(only_text),
        most.not_in(only_text),
        Column::of("range", format!("{level} range of the mean")).not_in(NOT_IN_PAGE),
        Column::of("year_range", format!("{level} range of one year")).not_in(NOT_IN_PAGE),
        Column::unit("").not_in(only_text),
    ]
}

/// The report of a forecast; for a page in words for readers who did not make it.
pub fn forecast(title: &str, found: &Forecast, is_page: bool) -> Report {
    let columns = forecast_columns(&percent(found.question.level), is_page);
    let row = |label: String, value: f64, ranges: [[f64; 2]; 2], unit: &str| {
        let (factor, unit) = if is_page {
            for_people(unit)
        } else {
            millimetres(unit)
        };
        let label = if is_page {
            with_unit(&label, &unit)
        } else {
            label
        };
        let [[low, high], [least, most]] = ranges;
        let numbers = [value, low, high, least, most].map(|number| factor * number);
        let mut cells = Cell::all(numbers, factor * (high - low) / 4.0).to_vec();
        let ranges = [range(&cells[1], &cells[2]), range(&cells[3], &cells[4])];
        cells[3..]
            .iter_mut()
            .filter(|_| least.is_nan())
            .for_each(|cell| cell.text.clear());
        let last = ranges.into_iter().chain([unit.as_str().into()]);
        Row::of(label, cells.into_iter().chain(last))
    };
    let levels = found.levels.iter().map(|level| {
        let ranges = [level.expected_interval, level.year_interval];
        row(
            words(level.quantity, found.question.share),
            level.expected,
            ranges,
            level.quantity.unit(),
        )
    });
    let returns = found.return_levels.iter().map(|level| {
        let label = format!("|z| exceeded in one of {} years", level.years);
        row(label, level.expected, [level.interval, [f64::NAN; 2]], "m")
    });
    let [mean, year] = match is_page {
        true => ["in the first range", "in the second"],
        false => [
            "between `from` and `to`",
            "between `year from` and `year to`",
        ],
    };
    let below = format!(
        "For {0} of 100 records like this one, the mean of many years lies {mean}; {0} of 100 single years lie {year}.",
        significant(100.0 * found.question.level, 4)
    );
    let years: usize = found.years.iter().map(Vec::len).sum();
    let years = format!(
        "{}, with {} draws of the parameters, scaled to the mean of years with the estimated ones",
        grouped(years as u64),
        found.years.len()
    );
    let (heading, rows) = ("One year".into(), levels.chain(returns).collect());
    Report {
        title: title.into(),
        tables: vec![Table {
            heading,
            columns,
            rows,
            below,
            ..Table::default()
        }],
        remarks: vec![("years", years)],
        ..Report::default()
    }
}

/// The name of a quantity in the table for people.
fn words(quantity: ForecastQuantity, share: f64) -> String {
    match quantity {
        ForecastQuantity::SlidingPath => "sliding path".to_string(),
        ForecastQuantity::Slips => "slips".to_string(),
        ForecastQuantity::Range => "range of z".to_string(),
        ForecastQuantity::Greatest => "largest |z|".to_string(),
        ForecastQuantity::Loaded => format!("share of time with |F| above {} f_s", share),
        ForecastQuantity::Force => "largest force |F| on the pier".to_string(),
    }
}

/// The report of a fit to a measured temperature.
pub fn weather(found: &WeatherFit) -> Report {
    let row = |name: &str, value: f64, error: f64, unit: String| {
        let [value, _] = Cell::all([value, error], error);
        Row::of(name, [value, Cell::significant(error, 2), unit.into()])
    };
    let mut rows = vec![row(
        "mean",
        found.mean().0,
        found.mean().1,
        "degrees".into(),
    )];
    rows.extend(found.cycles().iter().map(|cycle| {
        let name = format!(
            "amplitude, period {} d",
            significant(cycle.period / 86_400.0, 5)
        );
        row(
            &name,
            cycle.amplitude,
            cycle.error,
            format!("K, phase {}", significant(cycle.phase, 4)),
        )
    }));
    for process in found.processes() {
        let sd = process.sd;
        rows.push(row(
            "standard deviation of weather",
            sd,
            sd * process.sd_error,
            "K".into(),
        ));
        let hours = 1.0 / process.relaxation_rate / 3600.0;
        rows.push(row(
            "  correlation time",
            hours,
            hours * process.rate_error,
            "h".into(),
        ));
    }
    let smoothing = found.smoothing().map(|(tau, error)| (tau / 3600.0, error));
    rows.extend(
        smoothing.map(|(tau, error)| row("smoothing time constant", tau, tau * error, "h".into())),
    );
    let white = match found.white {
        0.0 => "none: adding it does not raise the likelihood".to_string(),
        white => format!(
            "{} K in every sample, not part of the weather",
            significant(white, 3)
        ),
    };
    let [name, estimate, error] = columns([
        ("quantity", ""),
        ("estimate", "estimate"),
        ("standard_error", "standard error"),
    ]);
    Report {
        tables: vec![Table {
            columns: vec![name, estimate, error, Column::unit("")],
            rows,
            ..Table::default()
        }],
        remarks: vec![
            (
                "data",
                format!(
                    "{} samples in {}",
                    grouped(found.samples as u64),
                    time(found.duration)
                ),
            ),
            ("sensor", white),
            ("log L", format!("{:.1}", found.log_likelihood)),
        ],
        ..Report::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::SeenSlip;

    /// With kappa = 1/2 the sensor shows half of each slip: two jumps of 10 mm are 40 mm of path.
    #[test]
    fn the_sliding_path_is_that_of_the_body() {
        let mut calibration = Calibration::default();
        calibration.estimates[Quantity::Shear as usize].estimate = 0.5;
        calibration.record.times = vec![0.0, YEAR];
        let slip = |jump| SeenSlip {
            time: 1.0,
            temperature: 0.0,
            jump,
            is_usual: true,
        };
        calibration.slips = vec![slip(0.01), slip(-0.01)];
        assert!(
            seen(&calibration).contains("sliding path is 40 mm in total"),
            "{}",
            seen(&calibration)
        );
    }
}
