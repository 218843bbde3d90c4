//! The page of a bearing: what a calibration found, and what a forecast expects, in words for
//! readers who did not make them.

use super::page::{Page, Section};
use crate::cli::calibrate_report::sources;
use crate::cli::document::JsonWarning;
use crate::cli::numbers::{Digits, grouped, percent, significant, time};
use crate::cli::table::TableRow;
use stick_slip::bearing::calibration::{Calibration, ParameterEstimate, Quantity};
use stick_slip::bearing::forecast::YEAR;
use stick_slip::figure::{Only, Style, Subject};
use stick_slip::store::StoredCalibration;

/// What neither fit nor forecast knows of.
const LEFT_OUT: &str = "Traffic, wind and brakes, which move a bearing faster than the weather does; wear, which changes friction; \
                        and a climate that is not that of the record. Movements that they cause add to the sliding path.";

/// The page of a calibration. `before` are parts that precede it, with warnings of their own.
pub fn page(stored: &StoredCalibration, before: Vec<Section>, warnings: Vec<JsonWarning>) -> String {
    let StoredCalibration { title, scenario_text, calibration, .. } = stored;
    let own = stored.warnings.iter().map(|(name, text)| JsonWarning { name: name.clone(), text: text.clone() });
    let pictures = ["calibration", "loops"].into_iter().filter_map(|name| {
        let subject = Subject::Calibration { title, calibration };
        Only::named(name).ok()?.draw(&subject, &Style::default()).ok().map(Section::Picture)
    });
    let level = percent(calibration.question.level);
    let meaning = format!("The truth lies between the two ends with {level}, if the bearing is as the model says.");
    let found = [
        Section::Words("What the record shows", seen(calibration)),
        Section::Table("What the bearing is", parameters(calibration), meaning),
    ];
    let parts = before.into_iter().chain(found).chain(pictures);
    let ends = [
        Section::Words("What is not in it", LEFT_OUT.to_string()),
        Section::Lines("How it was found", sources(calibration)),
    ];
    let page = Page {
        title,
        about: about(calibration),
        warnings: own.chain(warnings).collect(),
        parts: parts.chain(ends).collect(),
        scenario: scenario_text,
        provenance: vec![("program", super::program(stored.other_program.as_deref()))],
    };
    page.html()
}

/// Length and time of the record.
fn about(calibration: &Calibration) -> String {
    let record = &calibration.record;
    let last = record.times.last().copied().unwrap_or(0.0);
    let length = format!("{} samples in {}", grouped(record.times.len() as u64), time(last));
    match record.start.map(|start| (start, start.after(last))) {
        Some((start, Some(end))) => {
            let [start, end] = [start, end].map(|instant| instant.to_string().split('T').take(1).collect::<String>());
            format!("{length}, from {start} to {end}")
        }
        _ => length,
    }
}

/// Slips and sliding path of the record, and what they are in a year.
fn seen(calibration: &Calibration) -> String {
    let length = calibration.record.times.last().copied().unwrap_or(0.0);
    // A jump of z is (1 - kappa) of the slip of x, since the bearing is sheared less behind it.
    let jumps: f64 = calibration.slips.iter().map(|slip| slip.jump.abs()).sum();
    let path = jumps / (1.0 - calibration.estimate(Quantity::Shear).estimate);
    let slips = calibration.slips.len();
    let a_year = |number: f64| significant(number * YEAR / length, 3);
    format!(
        "{} slips were seen in {}, as many as {} in a year. Together they are {} mm of sliding path, as much as {} mm in a year.",
        grouped(slips as u64),
        time(length),
        a_year(slips as f64),
        significant(1e3 * path, 3),
        a_year(1e3 * path)
    )
}

fn parameters(calibration: &Calibration) -> Vec<TableRow> {
    let level = percent(calibration.question.level);
    let mut rows = vec![TableRow::labelled("", ["symbol", "estimate", &format!("{level} from"), "to"]).noted("unit")];
    rows.extend(Quantity::ALL.iter().map(|quantity| {
        let ParameterEstimate { estimate, low, high } = calibration.estimate(*quantity);
        let numbers = Digits::of(estimate, (high - low) / 4.0).show_all([estimate, low, high]);
        let cells = std::iter::once(quantity.symbol().to_string()).chain(numbers);
        TableRow::labelled(quantity.words(), cells).noted(quantity.unit().replace('1', ""))
    }));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use stick_slip::bearing::calibration::SeenSlip;

    /// With kappa = 1/2 the sensor shows half of each slip: two jumps of 10 mm are 40 mm of path.
    #[test]
    fn the_sliding_path_is_that_of_the_body() {
        let mut calibration = Calibration::default();
        calibration.estimates[Quantity::Shear as usize].estimate = 0.5;
        calibration.record.times = vec![0.0, YEAR];
        let slip = |jump| SeenSlip { time: 1.0, temperature: 0.0, jump, is_usual: true };
        calibration.slips = vec![slip(0.01), slip(-0.01)];
        assert!(seen(&calibration).contains("Together they are 40 mm of sliding path"), "{}", seen(&calibration));
    }
}
