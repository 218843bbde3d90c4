//! A legend: samples and their meanings.

use super::kit::{Align, Colour, Item, Label, Outline, Rect, Stroke};
use super::mark::Mark;
use super::theme::{LETTERS, Style};

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
    /// The height of a row of a legend.
    pub const ROW: f64 = 11.5;

    /// The entry of a curve.
    pub fn line(stroke: Stroke, label: impl Into<Label>) -> Self {
        LegendEntry {
            stroke: Some(stroke),
            ..LegendEntry::words(label)
        }
    }

    /// The entry of an area.
    pub fn area(fill: Colour, label: impl Into<Label>) -> Self {
        LegendEntry {
            fill: Some(fill),
            ..LegendEntry::words(label)
        }
    }

    /// The entry of a mark.
    pub fn mark(mark: Mark, colour: Colour, label: impl Into<Label>) -> Self {
        LegendEntry {
            mark: Some((mark, colour)),
            ..LegendEntry::words(label)
        }
    }

    /// An entry of words alone.
    pub fn words(label: impl Into<Label>) -> Self {
        LegendEntry {
            stroke: None,
            fill: None,
            mark: None,
            label: label.into(),
        }
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

    /// The entry, continued in further rows if it is wider than this.
    fn wrapped(&self, width: f64) -> Vec<LegendEntry> {
        let mut labels = self
            .label
            .wrapped((width - self.sample()) / LETTERS)
            .into_iter();
        let first = labels.next().map(|label| LegendEntry {
            label,
            ..self.clone()
        });
        first
            .into_iter()
            .chain(labels.map(LegendEntry::words))
            .collect()
    }

    fn width(&self) -> f64 {
        self.sample() + LETTERS * self.label.width()
    }
}

/// The space between entries of a legend.
const BETWEEN: f64 = 12.0;

/// Draws the legend in as many rows as it needs, and returns its height.
pub fn draw_legend(
    legend: &[LegendEntry],
    [x, y]: [f64; 2],
    width: f64,
    style: &Style,
    items: &mut Vec<Item>,
) -> f64 {
    let palette = style.palette();
    let mut rows: Vec<Vec<&LegendEntry>> = Vec::new();
    let mut used = f64::INFINITY;
    let legend: Vec<LegendEntry> = legend
        .iter()
        .flat_map(|entry| entry.wrapped(width))
        .collect();
    for entry in &legend {
        if used + BETWEEN + entry.width() > width {
            rows.push(Vec::new());
            used = -BETWEEN;
        }
        used += BETWEEN + entry.width();
        rows.last_mut().expect("there is a row by now").push(entry);
    }
    for (n, row) in rows.iter().enumerate() {
        let middle = y + (n as f64 + 0.5) * LegendEntry::ROW;
        let mut at = x;
        for entry in row {
            let (from, to) = (at, at + entry.sample() - 4.0);
            if let Some(fill) = entry.fill {
                let area = Rect {
                    x: from,
                    y: middle - 3.2,
                    width: to - from,
                    height: 6.4,
                };
                items.push(Item::filled(Outline::rect(area), fill));
            }
            if let Some(stroke) = &entry.stroke {
                items.push(Item::stroked(
                    Outline::line(&[[from, middle], [to, middle]]),
                    stroke.clone(),
                ));
            }
            if let Some((mark, colour)) = entry.mark {
                items.extend(mark.draw([(from + to) / 2.0, middle], colour, palette.background));
            }
            let baseline = [at + entry.sample(), middle + 0.36 * LETTERS];
            items.push(Item::words(
                entry.label.clone(),
                baseline,
                Align::Start,
                LETTERS,
                palette.ink,
            ));
            at += entry.width() + BETWEEN;
        }
    }
    rows.len() as f64 * LegendEntry::ROW
}
