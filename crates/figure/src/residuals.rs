//! The residuals of a calibrated model: over time, their correlation, and the results of the
//! starting points of the least squares.

use super::calibration::{DAY, thinned};
use super::theme::THIN;
use super::{
    Absent, Axis, LegendEntry, Mark, Panel, Sheet, Stroke, Style, Subject, calendar, sheet,
};
use stickslip_bearing::calibration::Quantity;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let (title, calibration) = subject.calibration()?;
    let palette = style.palette();
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
    let mut against_time = Panel::new(time, millimetres, 84.0);
    against_time.line(left, Stroke::solid(palette.first, 0.4));
    against_time.level(0.0, Stroke::solid(palette.faint, 0.4));

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
    let mut memory = Panel::new(delay, axis, 60.0);
    memory.level(0.0, Stroke::solid(palette.faint, 0.4));
    correlation
        .iter()
        .for_each(|point| memory.mark(*point, Mark::Disc, palette.first));
    memory.line(correlation, Stroke::solid(palette.first, THIN));

    let mut panels = vec![against_time, memory];
    let mut legend = Vec::new();
    if !calibration.starts.is_empty() {
        let best = calibration
            .starts
            .iter()
            .map(|start| start.err)
            .fold(f64::INFINITY, f64::min);
        let values = calibration.start_values();
        let ways: Vec<f64> = values
            .iter()
            .map(|values| 1e3 * values[Quantity::StaticWay as usize])
            .collect();
        let above: Vec<f64> = calibration
            .starts
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
        let mut starts = Panel::new(x, y, 74.0);
        ways.iter()
            .zip(&above)
            .for_each(|(way, above)| starts.mark([*way, *above], Mark::Circle, palette.second));
        starts.interval_across(0.1, ends, palette.first);
        panels.push(starts);
        legend.push(LegendEntry::mark(
            Mark::Circle,
            palette.second,
            "least-squares start",
        ));
        legend.push(LegendEntry::line(
            Stroke::solid(palette.first, 1.0),
            "interval of the estimate",
        ));
    }
    Ok(sheet(&format!("Residuals: {title}"), legend, panels))
}
