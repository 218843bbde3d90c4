//! The tables of reports, joined into one, as CSV (RFC 4180) with all digits, and as Markdown and
//! LaTeX with the digits that the error supports.

use super::{Cell, Column, Format, Report, Row, Table};
use stickslip::stats::Statistic;

/// The tables joined into one, whose columns are the union of theirs by name.
fn joined(tables: Vec<Table>, format: Format) -> Vec<Vec<Cell>> {
    let mut all = Table::default();
    for table in tables
        .into_iter()
        .filter(|table| !table.not_in.contains(&format))
    {
        for column in &table.columns {
            if all.columns.iter().all(|known| known.name != column.name) {
                all.columns.push(column.clone());
            }
        }
        let place = |known: &Column| {
            table
                .columns
                .iter()
                .position(|column| column.name == known.name)
        };
        let places: Vec<Option<usize>> = all.columns.iter().map(place).collect();
        let taken = |row: &Row, at: &Option<usize>| {
            at.and_then(|at| row.cells.get(at))
                .cloned()
                .unwrap_or_default()
        };
        let row = |row: Row| Row {
            cells: places.iter().map(|at| taken(&row, at)).collect(),
            ..row
        };
        all.rows.extend(table.rows.into_iter().map(row));
    }
    all.shown(format).0
}

fn written(
    rows: &[Vec<Cell>],
    cell: impl Fn(&Cell) -> String,
    [first, between, last]: [&str; 3],
) -> Vec<String> {
    let line = |row: &Vec<Cell>| row.iter().map(&cell).collect::<Vec<_>>().join(between);
    rows.iter()
        .map(|row| format!("{first}{}{last}\n", line(row)))
        .collect()
}

/// The tables of these files. A missing number is an empty cell, and the end of an interval without
/// a bound is `inf`.
pub fn comma_separated(reports: Vec<(String, Report)>) -> String {
    let mut tables = Vec::new();
    for (file, report) in reports {
        for mut table in report.tables {
            table.columns.insert(0, Column::of("file", ""));
            table
                .rows
                .iter_mut()
                .for_each(|row| row.cells.insert(0, file.as_str().into()));
            tables.push(table);
        }
    }
    let cell = |cell: &Cell| match cell.number {
        Some(number) if number.is_nan() => String::new(),
        Some(number) => format!("{number:?}"),
        None => quoted(&cell.text),
    };
    written(&joined(tables, Format::Csv), cell, ["", ",", ""]).concat()
}

/// A text as one cell of comma-separated values. Text that a spreadsheet would take for a formula,
/// and that is not a number, is marked as text in the way of spreadsheets.
fn quoted(text: &str) -> String {
    let is_formula =
        text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.contains(char::is_alphanumeric);
    let mark = if is_formula && text.parse::<f64>().is_err() {
        "'"
    } else {
        ""
    };
    let is_plain = !text.contains([',', '"', '\n', '\r']);
    if is_plain {
        format!("{mark}{text}")
    } else {
        format!("\"{mark}{}\"", text.replace('"', "\"\""))
    }
}

/// The tables as one of Markdown.
pub fn markdown(report: Report) -> String {
    let rows = joined(report.tables, Format::Paper);
    let mut lines = written(
        &rows,
        |cell| cell.text.replace('|', "\\|"),
        ["| ", " | ", " |"],
    );
    lines.insert(
        1,
        format!("|---|{}\n", "---:|".repeat(rows[0].len().saturating_sub(1))),
    );
    lines.concat()
}

/// The tables as one `tabular` of LaTeX with the rules of the package booktabs.
pub fn latex(report: Report) -> String {
    let rows = joined(report.tables, Format::Paper);
    let lines = written(&rows, |cell| latex_cell(&cell.text), ["", " & ", " \\\\"]);
    let columns = "r".repeat(rows[0].len().saturating_sub(1));
    let body = lines[1..].concat();
    format!(
        "% needs \\usepackage{{booktabs}}\n\\begin{{tabular}}{{l{columns}}}\n\\toprule\n{}\\midrule\n{body}\\bottomrule\n\\end{{tabular}}\n",
        lines[0]
    )
}

/// A number as mathematics, a statistic in words, and anything else as text.
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
    let escaped = |letter: char| match letter {
        '_' | '%' | '&' | '#' | '$' | '{' | '}' => format!("\\{letter}"),
        '\\' => "\\textbackslash{}".to_string(),
        '^' | '~' => format!("\\{letter}{{}}"),
        _ => letter.to_string(),
    };
    Statistic::from_name(cell)
        .map_or(cell, |statistic| statistic.words())
        .chars()
        .map(escaped)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample_tests::{info, set, summary};
    use super::*;
    use crate::report::{ShownStatistics, run};
    use stickslip::stats::Bias;

    #[test]
    fn what_a_spreadsheet_would_compute_is_marked_as_a_text() {
        for (text, cell) in [
            ("=cmd.h5", "'=cmd.h5"),
            (
                "=HYPERLINK(\"http://a.b\",\"c\")",
                "\"'=HYPERLINK(\"\"http://a.b\"\",\"\"c\"\")\"",
            ),
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
        }
    }

    #[test]
    fn latex_tables_typeset_numbers_and_escape_text() {
        let report = || {
            let columns = vec![
                Column::of("", "a_b"),
                Column::of("low", "95 % from"),
                Column::of("pm", "+-"),
                Column::unit("unit"),
            ];
            let rows = vec![
                Row::of("x|y", ["-0.9e-4", "none", "m"]),
                Row::of("z", ["1", "2", ""]),
            ];
            Report {
                tables: vec![Table {
                    columns,
                    rows,
                    ..Table::default()
                }],
                ..Report::default()
            }
        };
        assert_eq!(
            markdown(report()),
            "| a_b | 95 % from | +- | unit |\n|---|---:|---:|---:|\n| x\\|y | -0.9e-4 | none | m |\n| z | 1 | 2 |  |\n"
        );
        assert_eq!(
            latex(report()),
            "% needs \\usepackage{booktabs}\n\\begin{tabular}{lrrr}\n\\toprule\na\\_b & 95 \\% from & $\\pm$ & unit \\\\\n\\midrule\n\
             x|y & $-0.9\\times10^{-4}$ & none & m \\\\\nz & $1$ & $2$ &  \\\\\n\\bottomrule\n\\end{tabular}\n"
        );
        assert_eq!(latex_cell("stick_duration_mean"), "mean stick duration");
    }

    #[test]
    fn a_line_has_every_digit_and_a_file_of_any_name() {
        let mut summary = summary();
        set(&mut summary, Statistic::DriftVelocity, f64::NAN);
        summary.estimates[0].estimate = 0.1 + 0.2;
        summary.estimates[0].bias = Some(Bias {
            estimate: 0.05,
            uncertainty: 0.01,
            order: None,
        });
        summary.estimates[1].high = f64::INFINITY;
        let whole = (
            "a, \"b\".h5".to_string(),
            run(&summary, &info(), ShownStatistics::All, false),
        );
        let mut point = run(
            &summary,
            &info(),
            ShownStatistics::These(&[Statistic::StickDurationMean]),
            false,
        );
        point.tables[0]
            .columns
            .insert(0, Column::of("friction.static", "f_s"));
        point.tables[0].rows[0]
            .cells
            .insert(0, Cell::number(1.25, "1.2"));
        let text = comma_separated(vec![whole, ("point.h5".to_string(), point)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2 + summary.asked.len());
        assert!(
            lines[0].starts_with(
                "file,statistic,estimate,standard_error,low,high,bias,bias_uncertainty,estimate_corrected,"
            )
        );
        assert!(
            lines[1].starts_with("\"a, \"\"b\"\".h5\",stick_duration_mean,0.30000000000000004,"),
            "{}",
            lines[1]
        );
        let cells = |line: &str| line.rsplitn(12, ',').map(String::from).collect::<Vec<_>>();
        let column = |name: &str| {
            cells(lines[0])
                .iter()
                .position(|cell| cell == name)
                .expect("a column")
        };
        assert_eq!(
            ["bias", "bias_uncertainty"].map(|name| cells(lines[1])[column(name)].clone()),
            ["0.05", "0.01"]
        );
        assert_eq!(cells(lines[2])[column("high")], "inf");
        assert_eq!(
            cells(lines[1 + Statistic::DriftVelocity.index()])[column("estimate")],
            ""
        );
        assert!(
            lines[22].starts_with("point.h5,stick_duration_mean,0.30000000000000004,")
                && lines[22].ends_with(",1.25")
        );
    }
}
