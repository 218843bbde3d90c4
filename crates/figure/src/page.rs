//! All figures of a subject on one page, in two columns of the same height.

use super::kit::{Align, Drawing, Item, Label};
use super::only::Only;
use super::sheet::Sheet;
use super::subject::{Absent, Figure, Subject};
use super::theme::{GAP, LETTERS, SMALL, Style};
use stickslip::stats::Statistic;

/// The space at the edge of the page.
const EDGE: f64 = 8.0;
/// The size of the letters of the heading.
const HEADING: f64 = 11.0;
/// The frames of the shorter column become at most this many times as high.
const MOST_STRETCH: f64 = 2.0;

/// The figures that no page has: the panels of an overview are in the other figures, and a section
/// simulates every point of a sweep again.
const APART: [&str; 2] = ["overview", "section"];

/// Why there is no page.
#[derive(Clone, Debug)]
pub enum NoPage {
    /// The figure that belongs to the subject cannot be drawn from it.
    Without(&'static Figure, Absent),
    /// Nothing belongs to the subject.
    Empty,
    /// A label has this name, which is neither that of a statistic nor one of these keys.
    Label(String, String),
}

/// One figure or panel of a subject, or else the page of all of these figures that it has.
///
/// # Errors
///
/// It cannot be drawn, or a label names nothing that is at its axes.
pub fn draw(
    only: Option<Only>,
    figures: impl Iterator<Item = &'static Figure>,
    subject: &Subject,
    style: &Style,
) -> Result<Drawing, NoPage> {
    let known: Vec<&str> = match subject {
        Subject::Sweep { sweeps, .. } => sweeps
            .iter()
            .flat_map(|(_, sweep)| sweep.question.design.names())
            .collect(),
        _ => Vec::new(),
    };
    let is_known = |name: &str| known.contains(&name) || Statistic::from_name(name).is_some();
    if let Some((name, _)) = style.labels.iter().find(|(name, _)| !is_known(name)) {
        return Err(NoPage::Label(name.clone(), known.join(", ")));
    }
    match only {
        Some(only) => only
            .draw(subject, style)
            .map_err(|absent| NoPage::Without(only.figure, absent)),
        None => page(figures, subject, style),
    }
}

/// The page, with a heading and a line of text below it. The letters of panels run through it,
/// down the first column and then down the second.
///
/// # Errors
///
/// No figure of the subject can be drawn.
pub fn page(
    figures: impl Iterator<Item = &'static Figure>,
    subject: &Subject,
    style: &Style,
) -> Result<Drawing, NoPage> {
    let sheets = sheets(figures, subject, style)?;
    let columns = columns(sheets, style);
    let palette = style.palette();
    let width = columns.len() as f64 * (style.points() + GAP) - GAP + 2.0 * EDGE;
    let (heading, line) = subject.heading(style);
    let heading = style.title.map_or(heading, String::from);
    let mut items = Vec::new();
    let mut top = EDGE;
    for (words, size, is_bold) in [(&heading, HEADING, true), (&line, SMALL, false)] {
        let label = |text: &str| {
            if is_bold {
                Label::bold(text)
            } else {
                Label::verbatim(text)
            }
        };
        for row in wrapped(words, |text| {
            size * label(text).width() <= width - 2.0 * EDGE
        }) {
            top += 1.3 * size;
            items.push(Item::words(
                label(&row),
                [EDGE, top],
                Align::Start,
                size,
                palette.ink,
            ));
        }
    }
    top += LETTERS;
    let several = columns
        .iter()
        .flat_map(|column| &column.sheets)
        .map(Sheet::panel_count)
        .sum::<usize>()
        > 1;
    let full = columns
        .iter()
        .map(|column| column.height)
        .fold(0.0, f64::max);
    let (mut height, mut letter, mut left_out) = (0.0, 0, 0);
    for (number, column) in columns.iter().enumerate() {
        let stretch = 1.0 + (full - column.height) / column.frames.max(1.0);
        let mut end = top;
        for sheet in &column.sheets {
            let drawn = sheet.draw(style, several.then_some(letter), stretch.min(MOST_STRETCH));
            letter += sheet.panel_count();
            left_out += drawn.left_out;
            let by = [EDGE + number as f64 * (style.points() + GAP), end];
            items.push(Item::Moved {
                by,
                items: drawn.items,
            });
            end += drawn.height + GAP;
        }
        height = f64::max(height, end - GAP + EDGE);
    }
    Ok(Drawing {
        width,
        height,
        background: palette.background,
        title: heading,
        items,
        left_out,
    })
}

/// The figures of the page that can be drawn from the subject.
fn sheets(
    figures: impl Iterator<Item = &'static Figure>,
    subject: &Subject,
    style: &Style,
) -> Result<Vec<Sheet>, NoPage> {
    let figures = figures.filter(|figure| !APART.contains(&figure.name));
    let mut sheets = Vec::new();
    let mut without = NoPage::Empty;
    for figure in figures {
        match (figure.draws)(subject, style) {
            Ok(sheet) => sheets.push(sheet),
            Err(Absent::Elsewhere(_)) => {}
            Err(absent) => without = NoPage::Without(figure, absent),
        }
    }
    if sheets.is_empty() {
        Err(without)
    } else {
        Ok(sheets)
    }
}

/// Figures below each other.
#[derive(Default)]
struct FigureColumn {
    sheets: Vec<Sheet>,
    /// The height, and the part of it that frames take.
    height: f64,
    frames: f64,
}

/// The figures in the two columns that are most alike in height, or a single figure in one.
fn columns(sheets: Vec<Sheet>, style: &Style) -> Vec<FigureColumn> {
    let height = |sheet: &Sheet| sheet.draw(style, Some(0), 1.0).height + GAP;
    let heights: Vec<f64> = sheets.iter().map(height).collect();
    // The bits of a choice say which figures the second column has; the first figure is never among
    // them.
    let longest = |choice: &usize| {
        let mut sums = [0.0; 2];
        heights
            .iter()
            .enumerate()
            .for_each(|(number, height)| sums[choice >> number & 1] += height);
        f64::max(sums[0], sums[1])
    };
    let choices = (0..1 << sheets.len()).step_by(2);
    let best = choices
        .min_by(|one, other| longest(one).total_cmp(&longest(other)))
        .unwrap_or(0);
    let mut columns = [FigureColumn::default(), FigureColumn::default()];
    for (number, (sheet, height)) in sheets.into_iter().zip(&heights).enumerate() {
        let column = &mut columns[best >> number & 1];
        column.height += height;
        column.frames += sheet.frames();
        column.sheets.push(sheet);
    }
    columns
        .into_iter()
        .filter(|column| !column.sheets.is_empty())
        .collect()
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
