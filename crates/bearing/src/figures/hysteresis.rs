//! Displacement against temperature, as measured and as modelled. A bearing that sticks draws
//! loops.

use super::measured::{Measured, thinned};
use stickslip_figure::{
    Absent, Axis, LegendEntry, Panel, Sheet, Stroke, Style, Subject, THIN, range_of, sheet,
};

/// Draws the figure.
pub fn draw(subject: &Subject, style: &Style) -> Result<Sheet, Absent> {
    let of = Measured::of(subject)?;
    let palette = style.palette();
    let temperatures = of.numbers("temperature");
    let curve = |readings: &[f64]| -> Vec<[f64; 2]> {
        // One logger has no samples at the times of the other.
        let own: Vec<usize> = (0..readings.len())
            .filter(|i| readings[*i].is_finite())
            .collect();
        thinned(0..own.len())
            .map(|i| [temperatures[own[i]], 1e3 * readings[own[i]]])
            .collect()
    };
    let [measured, modelled] =
        ["displacement", "displacement_modelled"].map(|name| curve(of.numbers(name)));
    let range = |k: usize| range_of(measured.iter().chain(&modelled).map(|point| point[k]));
    let (warmth, height) = (range(0), range(1));
    let panel = |points: Vec<[f64; 2]>, stroke: Stroke| {
        let x = Axis::around(warmth, "temperature *T*", "°C");
        let mut panel = Panel::new(x, Axis::around(height, "*z*", "mm"), 130.0);
        panel.line(points, stroke);
        panel
    };
    let [first, second] = [palette.first, palette.second].map(|colour| Stroke::solid(colour, 0.3));
    let above = panel(measured, first).above_another();
    let below = panel(modelled, second);
    let legend = [
        LegendEntry::line(Stroke::solid(palette.first, THIN), "measured"),
        LegendEntry::line(Stroke::solid(palette.second, THIN), "model"),
    ];
    Ok(sheet(
        &format!("Loops: {}", of.title),
        legend,
        [above, below],
    ))
}
