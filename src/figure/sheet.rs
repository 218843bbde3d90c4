//! A sheet: a legend, and panels below each other with their frames aligned.

use super::kit::{Colour, Drawing, Rect, Stroke};
use super::legend::{LegendEntry, draw_legend};
use super::panel::Panel;
use super::theme::{LINE, Style};

/// The space at the edge of a sheet.
const EDGE: f64 = 4.0;
/// The space between panels that share an axis (`CLOSE`), and between other panels (`APART`).
const CLOSE: f64 = 9.0;
const APART: f64 = 13.0;

/// The sheet, with a legend for all panels and those of single panels. It counts the notes of the panels
/// that found no space.
pub fn sheet(style: &Style, title: &str, legend: &[LegendEntry], panels: &[Panel]) -> Drawing {
    let palette = style.palette();
    let width = style.points();
    let mut items = Vec::new();
    let left = panels.iter().map(Panel::margin).fold(0.0, f64::max) + EDGE;
    let right = EDGE + 6.0;
    let mut y = EDGE;
    let put = |key: &[LegendEntry], y: f64, items: &mut Vec<_>| {
        draw_legend(key, [left.min(30.0), y], width - left.min(30.0) - EDGE, style, items)
    };
    y += put(legend, y, &mut items);
    y += if panels.iter().any(|panel| panel.letter.is_some()) { 9.0 } else { 6.0 };
    let mut missing = 0;
    for panel in panels {
        y += put(&panel.key, y, &mut items);
        let frame = Rect { x: left, y, width: (width - left - right).max(20.0), height: panel.height };
        let drawn = panel.draw(frame, palette);
        items.extend(drawn.items);
        missing += drawn.left_out;
        y = frame.bottom() + panel.footing() + if panel.is_labelled { APART } else { CLOSE };
    }
    y -= APART;
    Drawing {
        width,
        height: y + EDGE,
        background: palette.background,
        title: title.to_string(),
        items,
        left_out: missing,
    }
}

/// The stroke of a solid curve in this colour.
pub fn solid(colour: Colour) -> Stroke {
    Stroke::solid(colour, LINE)
}
