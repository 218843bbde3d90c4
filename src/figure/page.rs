//! All figures of a subject on one sheet, in two columns.

use super::kit::{Align, Drawing, Item, Label};
use super::subject::Subject;
use super::theme::{LETTERS, SMALL, Style};
use super::{FIGURES, overview};

/// The space between figures.
const GAP: f64 = 14.0;
/// The space at the edge of the sheet.
const EDGE: f64 = 8.0;
/// The size of the letters of the heading.
const HEADING: f64 = 11.0;

/// The sheet, with a heading and a line of text below it. None if no figure of the subject can be
/// drawn.
pub fn page(subject: &Subject, style: &Style, heading: &str, line: &str) -> Option<Drawing> {
    let figures = FIGURES.iter().filter(|figure| figure.name != overview::FIGURE.name);
    let scenes: Vec<Drawing> = figures.filter_map(|figure| figure.draw(subject, style).ok()).collect();
    let columns = scenes.len().min(2);
    if columns == 0 {
        return None;
    }
    let palette = style.palette();
    let width = columns as f64 * style.points() + (columns as f64 - 1.0) * GAP + 2.0 * EDGE;
    let mut items = Vec::new();
    let mut top = EDGE;
    for (words, size, is_bold) in [(heading, HEADING, true), (line, SMALL, false)] {
        let label = |text: &str| if is_bold { Label::bold(text) } else { Label::verbatim(text) };
        for row in wrapped(words, |text| size * label(text).width() <= width - 2.0 * EDGE) {
            top += 1.3 * size;
            items.push(Item::words(label(&row), [EDGE, top], Align::Start, size, palette.ink));
        }
    }
    top += LETTERS;
    let mut ends = [top; 2];
    let left_out = scenes.iter().map(|scene| scene.left_out).sum();
    for scene in scenes {
        let column = usize::from(columns > 1 && ends[1] < ends[0]);
        let by = [EDGE + column as f64 * (style.points() + GAP), ends[column]];
        ends[column] += scene.height + GAP;
        items.push(Item::Moved { by, items: scene.items });
    }
    let height = ends[0].max(ends[1]) - GAP + EDGE;
    Some(Drawing { width, height, background: palette.background, title: heading.to_string(), items, left_out })
}

/// The words in rows that fit. A word that is too long for a row has a row of its own.
fn wrapped(text: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut rows: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match rows.last_mut() {
            Some(row) if fits(&format!("{row} {word}")) => {
                row.push(' ');
                row.push_str(word);
            }
            _ => rows.push(word.to_string()),
        }
    }
    rows
}
