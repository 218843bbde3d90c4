//! Aligned columns, for the tables that people read.

use std::fmt::Write as _;

/// One line of a table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// One text for each column.
    pub cells: Vec<String>,
    /// Text behind the last cell. It begins at the same column in every row.
    pub note: String,
}

impl Row {
    /// A row with a label in the first column and these cells to its right.
    pub fn labelled<C: Into<String>>(label: impl Into<String>, cells: impl IntoIterator<Item = C>) -> Self {
        let cells = cells.into_iter().map(C::into);
        Row { cells: std::iter::once(label.into()).chain(cells).collect(), note: String::new() }
    }

    /// The row with this text behind its last cell.
    pub fn noted(self, note: impl Into<String>) -> Self {
        Row { note: note.into(), ..self }
    }
}

/// The rows as text. The first column is aligned to the left, the others to the right, with `gap`
/// between them. Lines do not end with spaces.
pub fn aligned(rows: &[Row], gap: &str) -> String {
    let columns = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.cells.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for Row { cells, note } in rows {
        let mut line = String::new();
        for (column, (cell, width)) in cells.iter().zip(&widths).enumerate() {
            let _ = match column {
                0 => write!(line, "{cell:<width$}"),
                _ => write!(line, "{gap}{cell:>width$}"),
            };
        }
        let _ = write!(line, "{gap}{note}");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_under_each_other_and_lines_end_without_spaces() {
        let rows = [
            Row::labelled("name", ["value", "sd"]).noted("unit"),
            Row::labelled("x", ["1.25", "±0.5"]).noted("µm"),
            Row::labelled("longer", ["7"]),
        ];
        let expected = "name    value    sd  unit\n\
                        x        1.25  ±0.5  µm\n\
                        longer      7\n";
        assert_eq!(aligned(&rows, "  "), expected);
    }

    #[test]
    fn a_table_without_rows_is_no_text() {
        assert_eq!(aligned(&[], " "), "");
    }
}
