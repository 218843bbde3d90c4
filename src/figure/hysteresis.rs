//! Displacement against temperature, as measured and as modelled. A bearing that sticks draws
//! loops.

use super::calibration::thinned;
use super::theme::THIN;
use super::{Absent, Axis, Drawing, Figure, Label, LegendEntry, Panel, Stroke, Style, Subject, range_of, sheet};

/// The figure.
pub const FIGURE: Figure =
    Figure { name: "loops", shows: "displacement against temperature, measured and modelled", draws: draw };

fn draw(subject: &Subject, style: &Style) -> Result<Drawing, Absent> {
    let (title, calibration) = subject.calibration()?;
    let palette = style.palette();
    let record = &calibration.record;
    let curve = |readings: &[f64]| -> Vec<[f64; 2]> {
        thinned(0..record.times.len()).map(|i| [record.temperatures[i], 1e3 * readings[i]]).collect()
    };
    let (measured, modelled) = (curve(&record.readings), curve(&calibration.modelled));
    let range = |k: usize| range_of(measured.iter().chain(&modelled).map(|point| point[k]));
    let wider = |[low, high]: [f64; 2]| [low - 0.04 * (high - low), high + 0.04 * (high - low)];
    let (warmth, height) = (wider(range(0)), wider(range(1)));
    let panel = |letter: char, points: Vec<[f64; 2]>, stroke: Stroke| {
        let x = Axis::linear(warmth, Label::new("temperature *T*"), "°C");
        let mut panel = Panel::new(x, Axis::linear(height, Label::new("*z*"), "mm"), 130.0).lettered(letter);
        panel.line(points, stroke);
        panel
    };
    let [first, second] = [palette.first, palette.second].map(|colour| Stroke::solid(colour, 0.3));
    let above = panel('a', measured, first).above_another();
    let below = panel('b', modelled, second);
    let legend = [
        LegendEntry::line(Stroke::solid(palette.first, THIN), "measured"),
        LegendEntry::line(Stroke::solid(palette.second, THIN), "model"),
    ];
    Ok(sheet(style, &format!("Loops: {title}"), &legend, &[above, below]))
}
