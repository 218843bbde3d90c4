//! Aligned columns, for the tables that people read.

use std::fmt::Write as _;

/// One line of a table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TableRow {
    /// One text for each column.
    pub cells: Vec<String>,
    /// Text behind the last cell. It begins at the same column in every row.
    pub note: String,
}

impl TableRow {
    /// A row with a label in the first column and these cells to its right.
    pub fn labelled<C: Into<String>>(label: impl Into<String>, cells: impl IntoIterator<Item = C>) -> Self {
        let cells = cells.into_iter().map(C::into);
        TableRow { cells: std::iter::once(label.into()).chain(cells).collect(), note: String::new() }
    }

    /// The row with this text behind its last cell.
    pub fn noted(self, note: impl Into<String>) -> Self {
        TableRow { note: note.into(), ..self }
    }
}

/// The rows as text. The first column is aligned to the left, the others to the right, with `gap`
/// between them. Lines do not end with spaces.
pub fn aligned(rows: &[TableRow], gap: &str) -> String {
    let columns = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.cells.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for TableRow { cells, note } in rows {
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

/// The rows as comma-separated values (RFC 4180), headings first; numbers are not grouped.
pub fn comma_separated(rows: &[TableRow]) -> String {
    let cell = |cell: &String| {
        let is_number = cell.chars().all(|letter| letter.is_ascii_digit() || letter == ' ');
        if is_number { cell.replace(' ', "") } else { quoted(cell) }
    };
    let line = |cells: &Vec<String>| cells.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
    full(rows).iter().map(line).collect()
}

/// A text as one cell of comma-separated values. What a spreadsheet would take for a formula, and
/// is no number, is marked as a text in the way of spreadsheets.
pub fn quoted(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.contains(char::is_alphanumeric);
    let mark = if is_formula && text.parse::<f64>().is_err() { "'" } else { "" };
    let is_plain = !text.contains([',', '"', '\n', '\r']);
    if is_plain { format!("{mark}{text}") } else { format!("\"{mark}{}\"", text.replace('"', "\"\"")) }
}

/// The rows as a table of Markdown, headings first.
pub fn markdown(rows: &[TableRow]) -> String {
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let rows = full(rows);
    let Some((headings, rest)) = rows.split_first() else { return String::new() };
    let rule = format!("|---|{}\n", "---:|".repeat(headings.len().saturating_sub(1)));
    line(headings) + &rule + &rest.iter().map(|row| line(row)).collect::<String>()
}

/// The rows as a `tabular` of LaTeX, headings first, which needs no package.
pub fn latex(rows: &[TableRow]) -> String {
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| latex_cell(cell)).collect();
        format!("{} \\\\\n", cells.join(" & "))
    };
    let rows = full(rows);
    let Some((headings, rest)) = rows.split_first() else { return String::new() };
    let columns = "r".repeat(headings.len().saturating_sub(1));
    let body: String = rest.iter().map(|row| line(row)).collect();
    format!("\\begin{{tabular}}{{l{columns}}}\n\\hline\n{}\\hline\n{body}\\hline\n\\end{{tabular}}\n", line(headings))
}

/// A number as mathematics, and anything else as text.
fn latex_cell(cell: &str) -> String {
    if cell == "+-" {
        return "$\\pm$".into();
    }
    if cell.parse::<f64>().is_ok_and(f64::is_finite) {
        return match cell.split_once('e') {
            Some((digits, power)) => format!("${digits}\\times10^{{{power}}}$"),
            None => format!("${cell}$"),
        };
    }
    let mut text = String::new();
    for letter in cell.chars() {
        match letter {
            '_' | '%' | '&' | '#' | '$' | '{' | '}' => text.extend(['\\', letter]),
            '\\' => text.push_str("\\textbackslash{}"),
            '^' => text.push_str("\\^{}"),
            '~' => text.push_str("\\~{}"),
            _ => text.push(letter),
        }
    }
    text
}

/// Cells and notes of all rows, in as many columns as are in use.
fn full(rows: &[TableRow]) -> Vec<Vec<String>> {
    let columns = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let has_notes = rows.iter().any(|row| !row.note.is_empty());
    let filled = |row: &TableRow| {
        let mut cells = row.cells.clone();
        cells.resize(columns, String::new());
        cells.extend(has_notes.then(|| row.note.clone()));
        cells
    };
    rows.iter().map(filled).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_spreadsheet_would_compute_is_marked_as_a_text() {
        for (text, cell) in [
            ("=cmd.h5", "'=cmd.h5"),
            ("=HYPERLINK(\"http://a.b\",\"c\")", "\"'=HYPERLINK(\"\"http://a.b\"\",\"\"c\"\")\""),
            ("+1+cmd|' /C calc'!A0", "'+1+cmd|' /C calc'!A0"),
            ("-2+3", "'-2+3"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("\t=1", "'\t=1"),
            ("-1.5e-3", "-1.5e-3"),
            ("+4", "+4"),
            ("-inf", "-inf"),
            ("+-", "+-"),
            ("-", "-"),
            ("", ""),
            ("a=b", "a=b"),
            ("a,\"b\"", "\"a,\"\"b\"\"\""),
        ] {
            assert_eq!(quoted(text), cell, "{text}");
            assert_eq!(comma_separated(&[TableRow::labelled(text, ["1 000"])]), format!("{cell},1000\n"), "{text}");
        }
    }

    #[test]
    fn a_table_for_a_paper_has_numbers_as_mathematics_and_text_escaped() {
        let rows = [
            TableRow::labelled("a_b", ["95 % from", "+-"]).noted("unit"),
            TableRow::labelled("x|y", ["-0.9e-4", "none"]),
        ];
        assert_eq!(
            markdown(&rows),
            "| a_b | 95 % from | +- | unit |\n|---|---:|---:|---:|\n| x\\|y | -0.9e-4 | none |  |\n"
        );
        assert_eq!(
            latex(&rows),
            "\\begin{tabular}{lrrr}\n\\hline\na\\_b & 95 \\% from & $\\pm$ & unit \\\\\n\\hline\n\
             x|y & $-0.9\\times10^{-4}$ & none &  \\\\\n\\hline\n\\end{tabular}\n"
        );
    }

    #[test]
    fn cells_stand_under_each_other_and_lines_end_without_spaces() {
        let rows = [
            TableRow::labelled("name", ["value", "sd"]).noted("unit"),
            TableRow::labelled("x", ["1.25", "±0.5"]).noted("µm"),
            TableRow::labelled("longer", ["7"]),
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
