//! A sheet: panels with their frames aligned, under a legend for all of them. The panels are below
//! each other or, without such a legend, side by side.

use super::kit::{Align, Colour, Drawing, Item, Label, Rect, Stroke};
use super::legend::{LegendEntry, draw_legend};
use super::panel::Panel;
use super::theme::{GAP, LETTERS, LINE, Style};

/// A figure before it is drawn.
#[derive(Clone, Debug)]
pub struct Sheet {
    title: String,
    legend: Vec<LegendEntry>,
    panels: Vec<Panel>,
    /// Whether the panels are side by side.
    is_row: bool,
}

/// The space at the edge of a sheet.
const EDGE: f64 = 4.0;
/// The space between panels that share an axis (`CLOSE`), and between other panels (`APART`).
const CLOSE: f64 = 10.0;
const APART: f64 = 13.0;
/// The space between a legend and the frame below it.
const UNDER: f64 = 4.0;
/// The size of the letter of a panel, and the space between its foot and the frame.
const LETTER: f64 = 1.1 * LETTERS;
const FOOT: f64 = 3.0;

/// A sheet with a legend for all panels.
pub fn sheet(
    title: &str,
    legend: impl Into<Vec<LegendEntry>>,
    panels: impl Into<Vec<Panel>>,
) -> Sheet {
    Sheet {
        title: title.to_string(),
        legend: legend.into(),
        panels: panels.into(),
        is_row: false,
    }
}

/// The letter of the panel with this number, counted from 0; none behind Z.
fn letter(number: usize) -> Option<char> {
    (b'A'..=b'Z').nth(number).map(char::from)
}

impl Sheet {
    /// The same panels, side by side over two columns.
    pub fn in_a_row(self) -> Sheet {
        Sheet {
            is_row: true,
            ..self
        }
    }

    /// The number of panels, without scales of colours, which are the last ones.
    pub fn panel_count(&self) -> usize {
        self.panels.iter().filter(|panel| !panel.is_scale).count()
    }

    /// The sheet with one of its panels alone, without a letter. If it has no such panel, the
    /// letters of those that it has are returned.
    pub fn only(mut self, asked: char) -> Result<Sheet, String> {
        let number = (0..self.panel_count()).find(|number| letter(*number) == Some(asked));
        let Some(number) = number else {
            let last = letter(self.panel_count() - 1).unwrap_or('Z');
            return Err(if last == 'A' {
                "A".to_string()
            } else {
                format!("A to {last}")
            });
        };
        let mut panel = self.panels.swap_remove(number);
        panel.is_labelled = true;
        self.panels.retain(|panel| panel.is_scale);
        self.panels.insert(0, panel);
        Ok(self)
    }

    /// The sum of the heights of the frames.
    pub fn frames(&self) -> f64 {
        self.panels.iter().map(|panel| panel.height).sum()
    }

    /// The sheet by itself. Its panels have letters if there are several.
    pub fn alone(&self, style: &Style) -> Drawing {
        self.draw(style, (self.panel_count() > 1).then_some(0), 1.0)
    }

    /// The sheet with frames that are `stretch` times as high, and with letters from this number
    /// on. It counts the notes of the panels that found no space.
    pub fn draw(&self, style: &Style, letters: Option<usize>, stretch: f64) -> Drawing {
        if self.is_row && self.panel_count() > 1 {
            return self.draw_row(style, letters, stretch);
        }
        let palette = style.palette();
        let width = style.points();
        let panels: Vec<Panel> = self
            .panels
            .iter()
            .map(|panel| panel.stretched(stretch))
            .collect();
        let mut items = Vec::new();
        let left = panels.iter().map(Panel::margin).fold(0.0, f64::max) + EDGE;
        let right = EDGE + 6.0;
        let mut y = EDGE;
        let put = |key: &[LegendEntry], y: f64, items: &mut Vec<_>| {
            draw_legend(
                key,
                [left.min(30.0), y],
                width - left.min(30.0) - EDGE,
                style,
                items,
            )
        };
        y += put(&self.legend, y, &mut items);
        // Below a legend of its own, a panel needs no further space for its letter.
        let is_keyed = panels.first().is_some_and(|panel| !panel.key.is_empty());
        y += if letters.is_some() && !is_keyed {
            LETTER
        } else {
            UNDER
        };
        let mut missing = 0;
        for (number, panel) in panels.iter().enumerate() {
            let key = put(&panel.key, y, &mut items);
            let foot = if key > 0.0 {
                y + 0.5 * LegendEntry::ROW + 0.36 * LETTERS
            } else {
                y - FOOT
            };
            let letters = letters.filter(|_| !panel.is_scale);
            if let Some(letter) = letters.and_then(|first| letter(first + number)) {
                let label = Label::bold(&letter.to_string());
                items.push(Item::words(
                    label,
                    [EDGE, foot],
                    Align::Start,
                    LETTER,
                    palette.ink,
                ));
            }
            y += if key > 0.0 { key + UNDER } else { 0.0 };
            let frame = Rect {
                x: left,
                y,
                width: (width - left - right).max(20.0),
                height: panel.height,
            };
            missing += panel.draw(frame, palette, &mut items);
            y = frame.bottom() + panel.footing() + if panel.is_labelled { APART } else { CLOSE };
        }
        y -= APART;
        Drawing {
            width,
            height: y + EDGE,
            background: palette.background,
            title: self.title.clone(),
            items,
            left_out: missing,
        }
    }

    /// The panels side by side, with the lower ends of their frames aligned.
    fn draw_row(&self, style: &Style, letters: Option<usize>, stretch: f64) -> Drawing {
        let palette = style.palette();
        // As wide as a page.
        let width = 2.0 * style.points() + GAP;
        let each = width / self.panel_count() as f64;
        let narrow = Style {
            width: style.width * each / style.points(),
            ..*style
        };
        let drawn =
            |panel: &Panel| sheet(&self.title, [], [panel.clone()]).draw(&narrow, None, stretch);
        let drawn: Vec<Drawing> = self.panels.iter().map(drawn).collect();
        let height = drawn.iter().map(|one| one.height).fold(0.0, f64::max);
        let mut items = Vec::new();
        for (number, one) in drawn.iter().enumerate() {
            let left = number as f64 * each;
            if let Some(letter) = letters.and_then(|first| letter(first + number)) {
                let at = [left + EDGE, EDGE + UNDER + LETTER];
                let label = Label::bold(&letter.to_string());
                items.push(Item::words(label, at, Align::Start, LETTER, palette.ink));
            }
            items.push(Item::Moved {
                by: [left, height - one.height],
                items: one.items.clone(),
            });
        }
        Drawing {
            width,
            height,
            background: palette.background,
            title: self.title.clone(),
            items,
            left_out: drawn.iter().map(|one| one.left_out).sum(),
        }
    }
}

/// The stroke of a solid curve in this colour.
pub fn solid(colour: Colour) -> Stroke {
    Stroke::solid(colour, LINE)
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;

    /// A panel by itself has the numbers of its horizontal axis, even where it shares them.
    #[test]
    fn a_panel_is_named_by_its_letter() {
        let axis = || Axis::linear([0.0, 1.0], "x", "");
        let panels = [84.0, 60.0].map(|height| Panel::new(axis(), axis(), height).above_another());
        let two = sheet("two", [], panels);
        let second = two.clone().only('B').expect("there is one");
        assert!(
            second.panel_count() == 1 && second.panels[0].is_labelled && second.frames() == 60.0
        );
        assert_eq!(two.only('C').map(|_| ()), Err("A to B".to_string()));
    }
}
