//! The residuals of a calibrated model: over time, their correlation, and the results of the
//! starting points of the least squares.

use super::calibration::{DAY, thinned};
use super::theme::{Palette, THIN};
use super::{
    Absent, Axis, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, calendar, sheet,
};
use stickslip_bearing::calibration::{Calibration, Quantity};

/// A distance beyond both ends of an axis of errors in percent.
const TALL: f64 = 1e6;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (title, calibration) = subject.calibration()?;
    let palette = style.palette();
    let mut panels = vec![
        against_time(calibration, palette),
        correlation(calibration, palette),
    ];
    if !calibration.starts.is_empty() {
        let interval = "interval of the estimate of *f*_{s}/*K*";
        panels.push(starts(calibration, palette).keyed([
            LegendEntry::mark(Mark::Circle, palette.second, "least-squares start"),
            LegendEntry::area(palette.wide, interval),
        ]));
    }
    Ok(sheet(&format!("Residuals: {title}"), [], panels))
}

fn against_time(calibration: &Calibration, palette: &Palette) -> Panel {
    let record = &calibration.record;
    let days = record.times.last().copied().unwrap_or(0.0) / DAY;
    let residual = |i: usize| {
        [
            record.times[i] / DAY,
            1e3 * (record.readings[i] - calibration.modelled[i]),
        ]
    };
    let left: Vec<[f64; 2]> = thinned(0..record.times.len()).map(residual).collect();
    let time = calendar::time([0.0, days], record.start);
    let millimetres = Axis::around(left.iter().map(|point| point[1]), "measured − model", "mm");
    let mut panel = Panel::new(time, millimetres, 84.0);
    panel.line(left, Stroke::solid(palette.first, 0.4));
    panel.level(0.0, Stroke::solid(palette.faint, 0.4));
    panel
}

fn correlation(calibration: &Calibration, palette: &Palette) -> Panel {
    let correlation: Vec<[f64; 2]> = calibration
        .residuals
        .autocorrelation
        .iter()
        .map(|(hours, r)| [hours / 24.0, *r])
        .collect();
    let delay = Axis::linear([0.0, 5.2], "delay", "d");
    let axis = Axis::around(
        correlation.iter().map(|point| point[1]).chain([0.0]),
        "autocorrelation",
        "",
    );
    let mut panel = Panel::new(delay, axis, 60.0);
    panel.level(0.0, Stroke::solid(palette.faint, 0.4));
    correlation
        .iter()
        .for_each(|point| panel.mark(*point, Mark::Disc, palette.first));
    panel.line(correlation, Stroke::solid(palette.first, THIN));
    panel
}

/// The results of the starting points, beside the interval of the estimate.
fn starts(calibration: &Calibration, palette: &Palette) -> Panel {
    let starts = &calibration.starts;
    let best = starts
        .iter()
        .map(|start| start.err)
        .fold(f64::INFINITY, f64::min);
    let ways: Vec<f64> = calibration
        .start_values()
        .iter()
        .map(|values| 1e3 * values[Quantity::StaticWay as usize])
        .collect();
    let above: Vec<f64> = starts
        .iter()
        .map(|start| 100.0 * (start.err / best - 1.0))
        .collect();
    let chosen = calibration.estimate(Quantity::StaticWay);
    let ends = [1e3 * chosen.low, 1e3 * chosen.high];
    let x = Axis::around(ways.iter().copied().chain(ends), "*f*_{s}/*K*", "mm");
    let y = Axis::around(
        above.iter().copied().chain([0.0, 0.2]),
        "err above the best",
        "%",
    );
    let mut panel = Panel::new(x, y, 74.0);
    // The interval belongs to the horizontal axis alone, so it has the height of the panel.
    if let [Some(low), Some(high)] = ends.map(|end| end.is_finite().then_some(end)) {
        panel.bar([low, -TALL], [high, TALL], palette.wide);
    }
    ways.iter()
        .zip(&above)
        .for_each(|(way, above)| panel.mark([*way, *above], Mark::Circle, palette.second));
    panel
}
