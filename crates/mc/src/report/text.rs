//! A report as text for people, as wide as the terminal.

use super::{Format, Report, Table};
use crate::output::numbers::{fitted, grouped, wrapped};
use crate::output::terminal::columns;

/// The space between two columns.
const GAP: &str = "  ";
/// The longest line without a terminal, in characters, if narrow gaps make it fit.
const LINE: usize = 80;
/// The maximum number of rows of a table shown to people. The file contains all of them.
pub const MOST_ROWS: usize = 100;
/// A reason with more characters than this does not fit in its row.
const LONG: usize = 40;

/// The report as text.
pub fn text(report: &Report) -> String {
    let Report {
        title,
        about,
        tables,
        commands,
        remarks,
    } = report;
    let head = if title.is_empty() {
        String::new()
    } else {
        format!("{title}\n{}", paragraph(about))
    };
    let tables = tables
        .iter()
        .filter(|table| !table.not_in.contains(&Format::Text));
    let mut parts: Vec<String> = std::iter::once(head)
        .chain(tables.map(|table| of_table(table, columns())))
        .collect();
    if let Some(last) = parts.last_mut() {
        last.extend(commands.iter().map(|command| format!("{command}\n")));
    }
    let width = remarks
        .iter()
        .map(|(label, _)| label.len())
        .fold(7, usize::max);
    let line = |(label, text): &(&str, String)| {
        fitted(&format!("{label:<width$} {text}"), &" ".repeat(width + 1))
    };
    parts.push(remarks.iter().map(line).collect());
    parts.retain(|part| !part.is_empty());
    parts.join("\n")
}

/// A sentence in lines; nothing if there is none.
fn paragraph(sentence: &str) -> String {
    if sentence.is_empty() {
        String::new()
    } else {
        wrapped(sentence, "")
    }
}

/// A table without the columns that do not fit.
pub(super) fn of_table(table: &Table, columns: Option<usize>) -> String {
    let most = columns.unwrap_or(LINE);
    let is_narrow = |table: &Table, format| width(table, format) > most;
    let (mut table, mut below) = (table.clone(), paragraph(&table.below));
    let more = table.rows.len().saturating_sub(MOST_ROWS);
    if more > 0 {
        table.rows.truncate(MOST_ROWS);
        below = format!(
            "... and {} more rows in the file\n{below}",
            grouped(more as u64)
        );
    }
    let has_no_room = columns.is_some() && is_narrow(&table, Format::Text);
    let reasons = footnotes(&mut table, has_no_room);
    let mut format = Format::Text;
    if columns.is_some()
        && is_narrow(&table, format)
        && width(&table, Format::Narrow) < width(&table, format)
    {
        format = Format::Narrow;
        below.insert_str(0, "(not all columns fit; use a wider terminal or --json)\n");
    }
    let heading = if table.heading.is_empty() {
        String::new()
    } else {
        format!("{}\n", table.heading)
    };
    heading
        + &drawn(
            &table,
            format,
            if is_narrow(&table, format) { " " } else { GAP },
        )
        + &reasons
        + &below
}

fn drawn(table: &Table, format: Format, gap: &str) -> String {
    let (rows, is_left) = table.shown(format);
    let rows: Vec<Vec<String>> = rows
        .into_iter()
        .map(|row| row.into_iter().map(|cell| cell.text).collect())
        .collect();
    let has_head = rows[0].iter().any(|cell| !cell.is_empty());
    aligned(&rows[usize::from(!has_head)..], &is_left, gap)
}

/// The length of the longest line of a table.
fn width(table: &Table, format: Format) -> usize {
    drawn(table, format, GAP)
        .lines()
        .map(|line| line.chars().count())
        .max()
        .unwrap_or(0)
}

/// Replaces reasons by letters, and returns each reason once as a footnote. A reason of only one
/// row stays there, unless it is long or the terminal is too narrow.
fn footnotes(table: &mut Table, is_narrow: bool) -> String {
    let all: Vec<String> = table.rows.iter().map(|row| row.why.clone()).collect();
    let is_shared = |reason: &String| all.iter().filter(|other| *other == reason).count() > 1;
    let mut below: Vec<&String> = Vec::new();
    for (row, reason) in table
        .rows
        .iter_mut()
        .zip(&all)
        .filter(|(_, reason)| !reason.is_empty())
    {
        if is_narrow || reason.len() > LONG || is_shared(reason) {
            if !below.contains(&reason) {
                below.push(reason);
            }
            row.why = mark(
                below
                    .iter()
                    .position(|known| *known == reason)
                    .unwrap_or_default(),
            )
            .to_string();
        }
    }
    let numbered = below.iter().enumerate();
    numbered
        .map(|(number, reason)| wrapped(&format!("({}) {reason}", mark(number)), "    "))
        .collect()
}

/// The mark of a footnote: a, b, c, ... There are fewer reasons than letters.
fn mark(number: usize) -> char {
    (b'a'..=b'z').nth(number).map_or('z', char::from)
}

/// The rows as text, with `gap` between columns, which are aligned to the left or to the right.
/// Lines do not end with spaces.
pub fn aligned(rows: &[Vec<String>], is_left: &[bool], gap: &str) -> String {
    let length = |cell: &String| cell.chars().count();
    let width = |column| {
        rows.iter()
            .filter_map(|row| row.get(column))
            .map(length)
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..is_left.len()).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row
            .iter()
            .zip(&widths)
            .zip(is_left)
            .map(|((cell, width), is_left)| match is_left {
                true => format!("{cell:<width$}"),
                false => format!("{cell:>width$}"),
            });
        cells.collect::<Vec<_>>().join(gap).trim_end().to_string() + "\n"
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_under_each_other_and_lines_end_without_spaces() {
        let rows = [
            ["name", "value", "sd", "unit"],
            ["x", "1.25", "\u{b1}0.5", "\u{b5}m"],
            ["longer", "7", "", ""],
        ]
        .map(|row| row.map(String::from).to_vec());
        let expected = "name    value    sd  unit\n\
                        x        1.25  \u{b1}0.5  \u{b5}m\n\
                        longer      7\n";
        assert_eq!(aligned(&rows, &[true, false, false, true], "  "), expected);
        assert_eq!(aligned(&[], &[], " "), "");
    }
}
