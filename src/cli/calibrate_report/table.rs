//! A calibration as a table for people.

use crate::cli::numbers::{Digits, grouped, percent, significant, time, wrapped};
use crate::cli::table::{TableRow, aligned};
use stick_slip::bearing::calibration::{Calibration, CalibrationMethod, Lag, ParameterEstimate, Quantity, SearchStart};

const GAP: &str = "  ";

/// The table, with the remarks below it.
pub fn table(title: &str, calibration: &Calibration) -> String {
    let mut parts = vec![format!("{title}\n"), aligned(&quantities(calibration), GAP), sources(calibration)];
    if !calibration.starts.is_empty() {
        parts.push(starts(calibration));
    }
    parts.join("\n")
}

/// The rows of what was calibrated, headings first.
pub fn quantities(calibration: &Calibration) -> Vec<TableRow> {
    let level = percent(calibration.question.level);
    let headings = TableRow::labelled("", ["", "estimate", &format!("{level} from"), "to"]);
    let rows = Quantity::ALL.iter().map(|quantity| row(*quantity, calibration.estimate(*quantity)));
    std::iter::once(headings).chain(rows).collect()
}

fn row(quantity: Quantity, ParameterEstimate { estimate, low, high }: ParameterEstimate) -> TableRow {
    let numbers = Digits::of(estimate, (high - low) / 4.0).show_all([estimate, low, high]);
    let cells = std::iter::once(quantity.symbol().to_string()).chain(numbers);
    TableRow::labelled(quantity.key(), cells).noted(quantity.unit())
}

/// Where the numbers come from, in lines that begin with a term.
pub fn sources(calibration: &Calibration) -> String {
    let record = &calibration.record;
    let samples = record.readings.iter().filter(|reading| reading.is_finite()).count();
    let samples = grouped(samples as u64);
    let length = time(record.times.last().copied().unwrap_or(0.0));
    let slips = calibration.slips.len();
    let usual = calibration.slips.iter().filter(|slip| slip.is_usual).count();
    let method = match calibration.question.method {
        CalibrationMethod::Err => "least squares",
        _ if calibration.slips.is_empty() => "least squares",
        _ => "slips",
    };
    let minutes = |seconds: f64| significant(seconds / 60.0, 3);
    let ParameterEstimate { estimate, low, high } = calibration.lag;
    let lag = match (calibration.question.lag, &calibration.lag_profile) {
        (Lag::Known(known), _) => format!("{} min, as given", minutes(known)),
        (Lag::Auto, Some(_)) if estimate > 0.0 => {
            format!("{} min ({} to {}), estimated", minutes(estimate), minutes(low), minutes(high))
        }
        (Lag::Auto, Some(profile)) => format!(
            "none: the most likely one, {} min, raises twice the log-likelihood by {}, and 15 is required",
            minutes(profile.likeliest),
            significant(profile.gain, 2)
        ),
        (Lag::Auto, None) => "none: without slips it cannot be estimated".to_string(),
    };
    let between = match calibration.roughness {
        0.0 => "in straight lines".to_string(),
        roughness => {
            let gained = significant((3600.0 * roughness).sqrt(), 3);
            format!("as weather, with a standard deviation of {gained} K in an hour; slips begin between samples")
        }
    };
    let correlation = |hours: f64| {
        let found = calibration.residuals.autocorrelation.iter().find(|(delay, _)| *delay == hours);
        found.map_or_else(|| "none".to_string(), |(_, correlation)| significant(*correlation, 2))
    };
    let rest = significant(calibration.residuals.rms, 3);
    let (hour, day) = (correlation(1.0), correlation(24.0));
    format!(
        "data    {samples} samples in {length}\n\
         slips   {slips} seen, {usual} of them alone and of the usual size\n\
         method  {method}; intervals: blocks of three days weighted at random\n\
         lag     {lag}\n\
         moves   the temperature moves between samples {between}\n\
         rest    {rest} m (root mean square of measurement less model); correlation {hour} after an hour, {day} after a day\n"
    )
}

/// The table of the paper: the result from each starting point of the least squares, and the
/// scatter of these results.
fn starts(calibration: &Calibration) -> String {
    const COLUMNS: [Quantity; 6] = [
        Quantity::Offset,
        Quantity::Stiffness,
        Quantity::Dynamic,
        Quantity::Static,
        Quantity::Dilatation,
        Quantity::Displacement,
    ];
    let head = COLUMNS.iter().map(|quantity| quantity.symbol().to_string()).chain(["err".to_string()]);
    let mut rows = vec![TableRow::labelled("start", head)];
    let values = calibration.start_values();
    let column = |quantity: &Quantity| values.iter().map(|values| values[*quantity as usize]).collect::<Vec<f64>>();
    let cell = |x: f64| if x.is_finite() { format!("{x:.5e}") } else { "none".to_string() };
    for (i, (values, SearchStart { err, .. })) in values.iter().zip(&calibration.starts).enumerate() {
        let cells = COLUMNS.iter().map(|quantity| cell(values[*quantity as usize])).chain([cell(*err)]);
        rows.push(TableRow::labelled((i + 1).to_string(), cells));
    }
    let moments = |values: &[f64]| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
        [mean, variance.sqrt(), variance.sqrt() / mean.abs()]
    };
    let errs: Vec<f64> = calibration.starts.iter().map(|start| start.err).collect();
    let all: Vec<[f64; 3]> = COLUMNS.iter().map(column).chain([errs]).map(|values| moments(&values)).collect();
    for (k, name) in ["mean", "sd", "CV"].into_iter().enumerate() {
        rows.push(TableRow::labelled(name, all.iter().map(|moments| cell(moments[k]))));
    }
    let legend = "The scatter of the starts shows how well the search finds the minimum. It says nothing of \
                  how far the minimum is from the truth.";
    format!("Starts of the least squares (err in m2):\n{}{}", aligned(&rows, GAP), wrapped(legend, ""))
}
