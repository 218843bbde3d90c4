//! Results for people: what is known of a result is a [`Report`], which is made once for each kind of
//! result, and each writer writes any of them.
//!
//! ```text
//! run, comparison, sweep, trade, bearing   what is known of each kind of result
//! remarks, info, citation                  parts of that of a run
//! text, paper, html                        the writers: for a terminal; CSV, Markdown and LaTeX; for a browser
//! page.html, style.css                     the skeleton of a page, with {placeholders}, and its style
//! json                                     a run and a calibration as JSON for programs
//! ```

pub mod bearing;
mod citation;
mod comparison;
pub mod html;
mod info;
pub mod json;
mod paper;
mod remarks;
mod run;
#[cfg(test)]
mod sample_tests;
mod sweep;
mod text;
mod trade;

pub use citation::citation;
pub use comparison::comparison;
pub use info::RunInfo;
pub use paper::{comma_separated, latex, markdown};
pub use remarks::{found, lost};
pub use run::{Chosen, run};
pub use sweep::{paths_of_each, sweep, warnings};
pub use text::{aligned, text};
pub use trade::{costs, trade, without_answer};

use crate::output::numbers::{Digits, significant};

/// What is known of a result.
#[derive(Clone, Debug, Default)]
pub struct Report {
    pub title: String,
    /// Lines below the title.
    pub about: String,
    pub tables: Vec<Table>,
    /// Commands to be pasted, each in one line.
    pub commands: Vec<String>,
    /// Labels, and what is to be said besides the tables.
    pub remarks: Vec<(&'static str, String)>,
}

/// A table. A column without any text is shown to programs only.
#[derive(Clone, Debug, Default)]
pub struct Table {
    pub heading: String,
    pub columns: Vec<Column>,
    pub rows: Vec<Row>,
    /// A sentence below it.
    pub below: String,
    /// The formats that leave it out.
    pub not_in: &'static [Format],
}

/// What the cells of a column are.
#[derive(Clone, Debug)]
pub struct Column {
    /// The name for programs.
    name: String,
    /// The heading for people.
    words: String,
    /// Whether it stands to the left, as words do.
    is_left: bool,
    /// The formats that leave it out.
    not_in: &'static [Format],
}

/// One row of a table.
#[derive(Clone, Debug)]
pub struct Row {
    pub cells: Vec<Cell>,
    /// Why a number in it is missing, or what is to be said of it.
    pub why: String,
}

/// A text with the digits that people need, and the number that it stands for, if it is one.
#[derive(Clone, Debug, Default)]
pub struct Cell {
    text: String,
    number: Option<f64>,
}

/// The formats in which reports are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Text,
    /// Text for a terminal that is too narrow for it.
    Narrow,
    Csv,
    /// Markdown and LaTeX.
    Paper,
    Html,
}

/// The formats that people read.
const FOR_PEOPLE: &[Format] = &[Format::Text, Format::Narrow, Format::Paper, Format::Html];
/// All but text.
const NO_TEXT: &[Format] = &[Format::Csv, Format::Paper, Format::Html];
const TEXT: &[Format] = &[Format::Text, Format::Narrow];

/// Half the width of a 95 % interval of a normal distribution, in standard errors.
const INTERVAL: f64 = 1.96;

impl Column {
    /// A column of numbers.
    fn of(name: impl Into<String>, words: impl Into<String>) -> Self {
        Column {
            name: name.into(),
            words: words.into(),
            is_left: false,
            not_in: &[],
        }
    }

    /// The column of units.
    fn unit(words: &str) -> Self {
        Column {
            is_left: true,
            ..Column::of("unit", words)
        }
    }

    fn not_in(self, formats: &'static [Format]) -> Self {
        Column {
            not_in: formats,
            ..self
        }
    }
}

/// Columns of numbers, each with its name for programs and its heading for people.
fn columns<const N: usize>(named: [(&str, &str); N]) -> [Column; N] {
    named.map(|(name, words)| Column::of(name, words))
}

/// The columns of an estimate.
fn of_estimate() -> [Column; 4] {
    columns([
        ("estimate", "estimate"),
        ("standard_error", "std. error"),
        ("low", "95 % from"),
        ("high", "to"),
    ])
}

/// The step of a scheme that has one, behind the name of the scheme.
fn of_step(step: Option<f64>) -> String {
    step.map_or(String::new(), |h| format!(", step {h:?}"))
}

impl Row {
    /// A row with this label and these cells to its right.
    fn of(label: impl Into<Cell>, cells: impl IntoIterator<Item = impl Into<Cell>>) -> Self {
        let cells = cells.into_iter().map(Into::into);
        Row {
            cells: std::iter::once(label.into()).chain(cells).collect(),
            why: String::new(),
        }
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Cell {
            text: text.into(),
            number: None,
        }
    }
}

impl Cell {
    /// A number, and its text.
    fn number(number: f64, text: impl Into<String>) -> Self {
        Cell {
            text: text.into(),
            number: Some(number),
        }
    }

    /// A number that does not exist, with this text.
    fn missing(text: &str) -> Self {
        Cell::number(f64::NAN, text)
    }

    /// A number with this number of significant digits.
    fn significant(number: f64, digits: usize) -> Self {
        Cell::number(number, significant(number, digits))
    }

    /// Numbers in the format of an estimate with this error.
    fn all<const N: usize>(numbers: [f64; N], error: f64) -> [Self; N] {
        let digits = Digits::of(numbers[0], error);
        numbers.map(|number| Cell::number(number, digits.show(number)))
    }
}

impl Table {
    /// The cells that a format shows, headings first, and the places of the columns that stand to
    /// the left.
    fn shown(&self, format: Format) -> (Vec<Vec<Cell>>, Vec<bool>) {
        let has_text = |i: usize| {
            self.rows
                .iter()
                .any(|row| row.cells.get(i).is_some_and(|cell| !cell.text.is_empty()))
        };
        let is_shown = |i: &usize| {
            !self.columns[*i].not_in.contains(&format) && (format == Format::Csv || has_text(*i))
        };
        let shown: Vec<usize> = (0..self.columns.len()).filter(is_shown).collect();
        let has_reasons = format != Format::Csv && self.rows.iter().any(|row| !row.why.is_empty());
        let heading = |i: &usize| match format {
            Format::Csv => self.columns[*i].name.as_str().into(),
            _ => self.columns[*i].words.as_str().into(),
        };
        let head = shown
            .iter()
            .map(heading)
            .chain(has_reasons.then(Cell::default))
            .collect();
        let rows = self.rows.iter().map(|row| {
            let why = if row.why.is_empty() {
                String::new()
            } else {
                format!("({})", row.why)
            };
            let cells = shown
                .iter()
                .map(|i| row.cells.get(*i).cloned().unwrap_or_default());
            cells.chain(has_reasons.then(|| why.into())).collect()
        });
        let is_left = shown
            .iter()
            .enumerate()
            .map(|(place, i)| place == 0 || self.columns[*i].is_left);
        (
            std::iter::once(head).chain(rows).collect(),
            is_left.chain([true]).collect(),
        )
    }
}
