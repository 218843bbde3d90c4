//! Reports, independent of the output format: tables and remarks, with sensible digits. Each kind
//! of result is turned into a [`Report`]; the command line has the writers.

use stickslip_text::numbers::{Digits, significant};

/// The report of a result.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// The title, one line.
    pub title: String,
    /// Lines below the title.
    pub about: String,
    /// The tables, in order.
    pub tables: Vec<Table>,
    /// Commands to be pasted, each in one line.
    pub commands: Vec<String>,
    /// Labelled remarks in addition to the tables.
    pub remarks: Vec<(&'static str, String)>,
}

/// A table. A column without any text is shown to programs only.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The heading; empty if there is none.
    pub heading: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, each with a cell for each column, or for the first of them.
    pub rows: Vec<Row>,
    /// A sentence below it.
    pub below: String,
    /// The formats that leave it out.
    pub not_in: &'static [Format],
}

/// The description of a column.
#[derive(Clone, Debug)]
pub struct Column {
    /// The name for programs.
    pub name: String,
    /// The heading for people.
    pub words: String,
    /// Whether it is aligned to the left, like words.
    pub is_left: bool,
    /// The formats that leave it out.
    pub not_in: &'static [Format],
}

/// One row of a table.
#[derive(Clone, Debug)]
pub struct Row {
    /// The cells, the label first.
    pub cells: Vec<Cell>,
    /// Why a number in it is missing, or a remark about it.
    pub why: String,
}

/// A text with sensible digits, and the number that it represents, if any.
#[derive(Clone, Debug, Default)]
pub struct Cell {
    /// The text.
    pub text: String,
    /// The number; none for plain text.
    pub number: Option<f64>,
}

/// The formats in which reports are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Text for a terminal.
    Text,
    /// Text for a terminal that is too narrow for it.
    Narrow,
    /// Comma-separated values, with all digits.
    Csv,
    /// Markdown and LaTeX.
    Paper,
    /// A page for a browser.
    Html,
}

/// The formats that people read.
pub const FOR_PEOPLE: &[Format] = &[Format::Text, Format::Narrow, Format::Paper, Format::Html];
/// All but text.
pub const NO_TEXT: &[Format] = &[Format::Csv, Format::Paper, Format::Html];
/// Text, of any width.
pub const TEXT: &[Format] = &[Format::Text, Format::Narrow];

impl Column {
    /// A column of numbers.
    pub fn of(name: impl Into<String>, words: impl Into<String>) -> Self {
        Column {
            name: name.into(),
            words: words.into(),
            is_left: false,
            not_in: &[],
        }
    }

    /// The column of units.
    pub fn unit(words: &str) -> Self {
        Column {
            is_left: true,
            ..Column::of("unit", words)
        }
    }

    /// The column, left out by these formats.
    pub fn not_in(self, formats: &'static [Format]) -> Self {
        Column {
            not_in: formats,
            ..self
        }
    }
}

/// Columns of numbers, each with its name for programs and its heading for people.
pub fn columns<const N: usize>(named: [(&str, &str); N]) -> [Column; N] {
    named.map(|(name, words)| Column::of(name, words))
}

impl Row {
    /// A row with this label and these cells to its right.
    pub fn of(label: impl Into<Cell>, cells: impl IntoIterator<Item = impl Into<Cell>>) -> Self {
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
    pub fn number(number: f64, text: impl Into<String>) -> Self {
        Cell {
            text: text.into(),
            number: Some(number),
        }
    }

    /// A number that does not exist, with this text.
    pub fn missing(text: &str) -> Self {
        Cell::number(f64::NAN, text)
    }

    /// A number with this number of significant digits.
    pub fn significant(number: f64, digits: usize) -> Self {
        Cell::number(number, significant(number, digits))
    }

    /// Numbers in the format of an estimate with this error.
    pub fn all<const N: usize>(numbers: [f64; N], error: f64) -> [Self; N] {
        let digits = Digits::of(numbers[0], error);
        numbers.map(|number| Cell::number(number, digits.show(number)))
    }
}

impl Table {
    /// The cells that a format shows, headings first, and the places of the left-aligned columns.
    pub fn shown(&self, format: Format) -> (Vec<Vec<Cell>>, Vec<bool>) {
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
