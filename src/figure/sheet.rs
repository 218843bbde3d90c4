//! A sheet: a legend, and panels below each other with their frames aligned.

use super::kit::{Align, Colour, Drawing, Item, Label, Outline, Rect, Stroke};
use super::panel::{Mark, Panel};
use super::theme::{LETTERS, LINE, SMALL, Style};

/// An entry of a legend: a sample, and what it stands for.
#[derive(Clone, Debug)]
pub struct LegendEntry {
    /// The stroke, if the entry is a curve.
    pub stroke: Option<Stroke>,
    /// The colour, if the entry is a filled area.
    pub fill: Option<Colour>,
    /// The mark, if the entry is or has one.
    pub mark: Option<(Mark, Colour)>,
    /// What the entry stands for.
    pub label: Label,
}

impl LegendEntry {
    /// The entry of a curve.
    pub fn line(stroke: Stroke, label: &str) -> Self {
        LegendEntry { stroke: Some(stroke), fill: None, mark: None, label: Label::new(label) }
    }

    /// The entry of an area.
    pub fn area(fill: Colour, label: &str) -> Self {
        LegendEntry { stroke: None, fill: Some(fill), mark: None, label: Label::new(label) }
    }

    /// The entry of a mark.
    pub fn mark(mark: Mark, colour: Colour, label: &str) -> Self {
        LegendEntry { stroke: None, fill: None, mark: Some((mark, colour)), label: Label::new(label) }
    }

    /// An entry of words alone.
    pub fn words(label: Label) -> Self {
        LegendEntry { stroke: None, fill: None, mark: None, label }
    }

    fn sample(&self) -> f64 {
        match (&self.stroke, self.fill, self.mark) {
            (None, None, None) => 0.0,
            (None, None, Some(_)) => 9.0,
            (None, Some(_), _) => 15.0,
            (Some(stroke), ..) if stroke.dash.is_empty() => 16.0,
            (Some(_), ..) => 22.0,
        }
    }

    fn width(&self) -> f64 {
        self.sample() + LETTERS * self.label.width()
    }
}

/// The space at the edge of a sheet.
const EDGE: f64 = 4.0;
/// The space between entries of a legend.
const BETWEEN: f64 = 12.0;
/// The height of a row of a legend.
const ROW: f64 = 11.5;
/// The space between panels that share an axis (`CLOSE`), and between other panels (`APART`).
const CLOSE: f64 = 9.0;
const APART: f64 = 13.0;

/// The sheet. If notes of the panels found no space, a line below the panels gives their number.
pub fn sheet(style: &Style, title: &str, legend: &[LegendEntry], panels: &[Panel]) -> Drawing {
    let palette = style.palette();
    let width = style.points();
    let mut items = Vec::new();
    let left = panels.iter().map(Panel::margin).fold(0.0, f64::max) + EDGE;
    let right = EDGE + 6.0;
    let mut y = EDGE;
    y += draw_legend(legend, [left.min(30.0), y], width - left.min(30.0) - EDGE, style, &mut items);
    y += if panels.iter().any(|panel| panel.letter.is_some()) { 9.0 } else { 6.0 };
    let mut missing = 0;
    for panel in panels {
        let frame = Rect { x: left, y, width: (width - left - right).max(20.0), height: panel.height };
        let drawn = panel.draw(frame, palette);
        items.extend(drawn.items);
        missing += drawn.left_out;
        y = frame.bottom() + panel.footing() + if panel.is_labelled { APART } else { CLOSE };
    }
    y -= APART;
    if missing > 0 {
        y += SMALL + 4.0;
        let words = Label::verbatim(&format!("{missing} labels have no room"));
        items.push(Item::words(words, [width - right, y], Align::End, SMALL, palette.faint));
    }
    Drawing { width, height: y + EDGE, background: palette.background, title: title.to_string(), items }
}

/// Draws the legend in as many rows as it needs, and returns its height.
fn draw_legend(legend: &[LegendEntry], [x, y]: [f64; 2], width: f64, style: &Style, items: &mut Vec<Item>) -> f64 {
    let palette = style.palette();
    let mut rows: Vec<Vec<&LegendEntry>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in legend {
        if used + BETWEEN + entry.width() > width {
            rows.push(Vec::new());
            used = -BETWEEN;
        }
        used += BETWEEN + entry.width();
        rows.last_mut().expect("there is a row by now").push(entry);
    }
    for (n, row) in rows.iter().enumerate() {
        let middle = y + (n as f64 + 0.5) * ROW;
        let mut at = x;
        for entry in row {
            let (from, to) = (at, at + entry.sample() - 4.0);
            if let Some(fill) = entry.fill {
                let area = Rect { x: from, y: middle - 3.2, width: to - from, height: 6.4 };
                items.push(Item::filled(Outline::rect(area), fill));
            }
            if let Some(stroke) = &entry.stroke {
                items.push(Item::stroked(Outline::line(&[[from, middle], [to, middle]]), stroke.clone()));
            }
            if let Some((mark, colour)) = entry.mark {
                items.extend(mark.draw([(from + to) / 2.0, middle], colour, palette.background));
            }
            let baseline = [at + entry.sample(), middle + 0.36 * LETTERS];
            items.push(Item::words(entry.label.clone(), baseline, Align::Start, LETTERS, palette.ink));
            at += entry.width() + BETWEEN;
        }
    }
    rows.len() as f64 * ROW
}

/// The stroke of a solid curve in this colour.
pub fn solid(colour: Colour) -> Stroke {
    Stroke::solid(colour, LINE)
}
