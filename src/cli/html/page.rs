//! A page: what it consists of, and how that is written as HTML.

use super::{filled, list_of_warnings, marked, rows, terms};
use crate::cli::document::JsonWarning;
use crate::cli::table::TableRow;
use base64::Engine as _;
use stick_slip::figure::{self, Drawing, escaped};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");

/// What a page shows, in order.
pub enum Section {
    /// A heading, a table whose first row holds the names of its columns, and a sentence below it.
    Table(&'static str, Vec<TableRow>, String),
    /// A heading, and lines of text that are aligned.
    Lines(&'static str, String),
    /// A heading, and a sentence.
    Words(&'static str, String),
    /// A picture; dark screens invert it.
    Picture(Drawing),
}

/// The page of a file.
pub struct Page<'a> {
    pub title: &'a str,
    pub about: String,
    pub warnings: Vec<JsonWarning>,
    pub parts: Vec<Section>,
    pub scenario: &'a str,
    pub provenance: Vec<(&'a str, String)>,
}

impl Page<'_> {
    /// The page as HTML.
    pub fn html(&self) -> String {
        // Pictures next to each other fill columns, whatever their heights.
        let is_picture = |part: &Section| matches!(part, Section::Picture(_));
        let together = self.parts.chunk_by(|one, other| is_picture(one) && is_picture(other));
        let parts: String = together
            .map(|parts| {
                let html: String = parts.iter().map(Section::html).collect();
                if is_picture(&parts[0]) { format!("<div class=\"pictures\">{html}</div>\n") } else { html }
            })
            .collect();
        filled(
            PAGE,
            &[
                ("title", escaped(self.title)),
                ("style", STYLE.to_string()),
                ("about", escaped(&self.about)),
                ("warnings", list_of_warnings(&self.warnings)),
                ("parts", parts),
                ("scenario", escaped(self.scenario)),
                ("provenance", terms(&self.provenance)),
            ],
        )
    }
}

impl Section {
    fn html(&self) -> String {
        match self {
            Section::Table(heading, table, below) => {
                let cells = |row: &TableRow| row.cells.iter().chain([&row.note]).cloned().collect();
                let table = rows(&table.iter().map(cells).collect::<Vec<Vec<String>>>());
                let below =
                    if below.is_empty() { String::new() } else { format!("<p class=\"note\">{}</p>", marked(below)) };
                format!(
                    "<section><h2>{heading}</h2><div class=\"wide\"><table>{table}</table></div>{below}</section>\n"
                )
            }
            Section::Lines(heading, text) => {
                format!("<section><h2>{heading}</h2><pre>{}</pre></section>\n", escaped(text))
            }
            Section::Words(heading, text) => format!("<section><h2>{heading}</h2><p>{}</p></section>\n", marked(text)),
            Section::Picture(drawing) => {
                let image = base64::engine::general_purpose::STANDARD.encode(figure::svg(drawing));
                let words = escaped(&drawing.title);
                format!("<figure><img alt=\"{words}\" src=\"data:image/svg+xml;base64,{image}\"></figure>\n")
            }
        }
    }
}
