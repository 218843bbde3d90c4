//! A report as one page for a browser, with its warnings and its pictures. The page has no script and
//! needs no network.

use super::{Format, Report, Table};
use crate::report::text::MOST_ROWS;
use base64::Engine as _;
use stickslip::stats::Statistic;
use stickslip_figure::{Drawing, escaped};

/// The page of a file.
pub struct Page<'a> {
    pub report: Report,
    /// The most important sentences, and a picture for them.
    pub lead: String,
    pub leading_picture: Option<Drawing>,
    pub warnings: Vec<String>,
    /// Headings, each with one or more sentences.
    pub words: Vec<(&'static str, String)>,
    /// Dark screens invert them.
    pub pictures: Vec<Drawing>,
    pub scenario: &'a str,
    /// Where the numbers come from: terms and their descriptions.
    pub provenance: Vec<(&'static str, String)>,
}

impl Page<'_> {
    /// The page as HTML.
    pub fn html(&self) -> String {
        let Page {
            report,
            lead,
            leading_picture,
            warnings,
            words,
            pictures,
            scenario,
            provenance,
        } = self;
        let section = |heading: &str, inside: &str| {
            format!("<section><h2>{}</h2>{inside}</section>\n", marked(heading))
        };
        let warnings: String = warnings
            .iter()
            .map(|warning| format!("<li>{}</li>", marked(warning)))
            .collect();
        let warnings = match warnings.is_empty() {
            true => String::new(),
            false => format!(
                "<section class=\"warnings\"><h2>Warnings</h2><ul>{warnings}</ul></section>"
            ),
        };
        let lead = match lead.is_empty() {
            true => String::new(),
            false => format!("<p class=\"lead\">{}</p>", marked(lead)),
        };
        let first = leading_picture.iter().map(picture).collect::<String>();
        let tables = report
            .tables
            .iter()
            .filter(|table| !table.not_in.contains(&Format::Html));
        let tables = tables.map(|table| {
            let heading = if table.heading.is_empty() {
                "Results"
            } else {
                &table.heading
            };
            section(heading, &of_table(table))
        });
        let words = words
            .iter()
            .map(|(heading, words)| section(heading, &format!("<p>{}</p>", marked(words))));
        let pictures: String = pictures.iter().map(picture).collect();
        // Pictures next to each other fill columns, whatever their heights.
        let pictures = format!("<div class=\"pictures\">{pictures}</div>\n");
        let terms = provenance.iter().chain(&report.remarks);
        let terms = terms.map(|(term, text)| format!("<dt>{term}</dt><dd>{}</dd>", marked(text)));
        format!(
            include_str!("page.html"),
            title = escaped(&report.title),
            style = include_str!("style.css"),
            about = escaped(&report.about),
            lead = lead,
            warnings = warnings,
            parts = [first]
                .into_iter()
                .chain(tables)
                .chain([pictures])
                .chain(words)
                .collect::<String>(),
            scenario = escaped(scenario),
            provenance = terms.collect::<String>(),
        )
    }
}

fn of_table(table: &Table) -> String {
    // The numbers of a range have minus signs, too.
    let sign = |word: &str| match word.parse::<f64>() {
        Ok(_) => word.replace('-', "\u{2212}"),
        Err(_) => word.replace("+-", "\u{b1}"),
    };
    let signs = |text: &str| text.split(' ').map(sign).collect::<Vec<_>>().join(" ");
    let words = |cell: &super::Cell| escaped(&in_words(&signs(&cell.text)));
    let mut rows = table.shown(Format::Html).0.into_iter();
    let headings: Vec<String> = rows.next().unwrap_or_default().iter().map(words).collect();
    let head: String = headings
        .iter()
        .map(|heading| format!("<th>{heading}</th>"))
        .collect();
    // On a phone each row is a card, in which every number has its heading.
    let cell = |(heading, cell): (&String, &super::Cell)| {
        format!("<td data-heading=\"{heading}\">{}</td>", words(cell))
    };
    let row = |cells: Vec<super::Cell>| {
        let cells: String = headings.iter().zip(&cells).map(cell).collect();
        format!("<tr>{cells}</tr>")
    };
    let body: String = rows.take(MOST_ROWS).map(row).collect();
    let below = if table.below.is_empty() {
        String::new()
    } else {
        format!("<p class=\"note\">{}</p>", marked(&table.below))
    };
    format!(
        "<div class=\"wide\"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>{below}"
    )
}

fn picture(drawing: &Drawing) -> String {
    let image = base64::engine::general_purpose::STANDARD.encode(stickslip_figure::svg(drawing));
    let words = escaped(&drawing.title);
    // The heading of the page names the scenario.
    let caption = words.split(": ").next().unwrap_or_default();
    format!(
        "<figure><figcaption>{caption}</figcaption><img alt=\"{words}\" src=\"data:image/svg+xml;base64,{image}\"></figure>\n"
    )
}

/// A text with the names of statistics in words.
fn in_words(text: &str) -> String {
    let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = text.split_inclusive(|c| !is_of_name(c)).map(|word| {
        let name = word.trim_end_matches(|c| !is_of_name(c));
        Statistic::from_name(name).map_or(word.to_string(), |statistic| {
            word.replacen(name, statistic.words(), 1)
        })
    });
    words.collect()
}

/// A text as HTML: names of statistics in words, text between back-ticks as code, and a true
/// plus-minus sign.
fn marked(text: &str) -> String {
    let escaped = escaped(&in_words(text).replace("+-", "\u{b1}"));
    let parts: Vec<&str> = escaped.split('`').collect();
    // An unpaired back-tick is kept.
    let pairs = (parts.len() - 1) / 2 * 2;
    let tag = |i: usize| match i {
        _ if i >= pairs => ["", "`"][usize::from(i + 1 < parts.len())],
        _ if i.is_multiple_of(2) => "<code>",
        _ => "</code>",
    };
    parts
        .iter()
        .enumerate()
        .map(|(i, part)| format!("{part}{}", tag(i)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_code_come_in_pairs() {
        let code = marked("raise `a<b` or `c` by 1 +- 2, drift_velocity");
        assert_eq!(
            code,
            "raise <code>a&lt;b</code> or <code>c</code> by 1 \u{b1} 2, drift velocity"
        );
        assert_eq!(
            [marked("a`b"), marked("`a` b`c")],
            ["a`b", "<code>a</code> b`c"]
        );
    }

    #[test]
    fn texts_cannot_end_what_they_stand_in() {
        assert_eq!(
            escaped("</script>&\"'\u{0}\u{7f}\n"),
            "&lt;/script&gt;&amp;&quot;&#39;\u{fffd}\u{fffd}\n"
        );
    }
}
