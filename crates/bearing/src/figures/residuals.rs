//! The residuals of a calibrated model: over time, their correlation, and the least-squares results
//! from all starting points.

use super::calendar;
use super::measured::{DAY, Measured, thinned};
use crate::calibration::Quantity;
use stickslip_figure::{
    Absent, Axis, LegendEntry, Mark, Palette, Panel, Sheet, Stroke, Style, Subject, THIN, sheet,
};

/// A distance beyond both ends of an axis of errors in percent.
const TALL: f64 = 1e6;

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let of = Measured::of(subject)?;
    let palette = style.palette();
    let mut panels = vec![against_time(of, palette), correlation(of, palette)];
    if !of.numbers("start_err").is_empty() {
        let interval = "interval of the estimate of *f*_{s}/*K*";
        panels.push(starts(of, palette).keyed([
            LegendEntry::mark(Mark::Circle, palette.second, "least-squares start"),
            LegendEntry::area(palette.wide, interval),
        ]));
    }
    Ok(sheet(&format!("Residuals: {}", of.title), [], panels))
}

fn against_time(of: Measured, palette: &Palette) -> Panel {
    let [times, readings, modelled] =
        ["time", "displacement", "displacement_modelled"].map(|name| of.numbers(name));
    let residual = |i: usize| [times[i] / DAY, 1e3 * (readings[i] - modelled[i])];
    let left: Vec<[f64; 2]> = thinned(0..times.len()).map(residual).collect();
    let time = calendar::time([0.0, of.days()], of.start());
    let millimetres = Axis::around(left.iter().map(|point| point[1]), "measured − model", "mm");
    let mut panel = Panel::new(time, millimetres, 84.0);
    panel.line(left, Stroke::solid(palette.first, 0.4));
    panel.level(0.0, Stroke::solid(palette.faint, 0.4));
    panel
}

fn correlation(of: Measured, palette: &Palette) -> Panel {
    let hours = of.numbers("delay").iter();
    let correlation: Vec<[f64; 2]> = hours
        .zip(of.numbers("residual_autocorrelation"))
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

/// The results from the starting points, next to the interval of the estimate.
fn starts(of: Measured, palette: &Palette) -> Panel {
    let errs = of.numbers("start_err");
    let best = errs.iter().copied().fold(f64::INFINITY, f64::min);
    let way = Quantity::StaticWay as usize;
    let ways: Vec<f64> = of
        .numbers("start_value")
        .chunks_exact(Quantity::ALL.len())
        .map(|values| 1e3 * values[way])
        .collect();
    let above: Vec<f64> = errs.iter().map(|err| 100.0 * (err / best - 1.0)).collect();
    let ends = ["interval_low", "interval_high"].map(|name| of.numbers(name));
    let ends = ends.map(|values| 1e3 * values.get(way).copied().unwrap_or(f64::NAN));
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
