//! `mc report`: writes a run as one page for a browser, with its table, its warnings and charts
//! that respond to mouse and keyboard. The page needs no network.
//!
//! ```text
//! page.html   the skeleton of the page, with {{placeholders}} that this module fills
//! style.css   the style for light and dark screens and for paper
//! charts.js   the charts, which Apache ECharts (assets/echarts) draws
//! data        the numbers of the file, as JSON
//! ```

mod data;

use super::document::JsonWarning;
use super::failure::{Failure, note, writable};
use super::files;
use super::report::{self, RunInfo};
use super::results;
use base64::Engine as _;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::PathBuf;
use stick_slip::figure::escaped;
use stick_slip::scenario::Scenario;
use stick_slip::store::{self, Stored};

const EXAMPLES: &str = "\
Examples:
  mc report rho025.h5                      rho025.html, for any browser
  mc report rho025.h5 -o report.html --force

The page is one file. It works without a network, asks for nothing, and sends nothing.";

/// Arguments of `mc report`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Report {
    /// A file that `mc run` wrote
    file: PathBuf,
    /// Where to write the page [default: NAME.html in the current directory]
    #[arg(short, long, value_name = "FILE.html")]
    output: Option<PathBuf>,
    /// Overwrite an earlier page
    #[arg(long)]
    force: bool,
}

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const CHARTS: &str = include_str!("charts.js");
const ECHARTS: &str = include_str!("../../../assets/echarts/echarts.min.js");

impl Report {
    pub fn call(&self) -> Result<(), Failure> {
        let default = || PathBuf::from(self.file.file_stem().unwrap_or("report".as_ref())).with_extension("html");
        let output = self.output.clone().unwrap_or_else(default);
        writable(&output, self.force, [self.file.as_path()])?;
        let stored = files::read(&self.file, store::read)?;
        let scenario = results::scenario("scenario", &stored, &[]).ok();
        let info = super::show::info(&self.file, &stored, scenario.as_ref());
        let page = page(&stored, scenario.as_ref(), &info);
        store::write_whole(&output, page.as_bytes(), self.force)?;
        note(&format!("{}: {} kB", output.display(), page.len() / 1000));
        Ok(())
    }
}

/// The page as HTML.
fn page(stored: &Stored, scenario: Option<&Scenario>, info: &RunInfo) -> String {
    let summary = &stored.summary;
    let header = &stored.header;
    let about = report::table(summary, info).lines().nth(1).unwrap_or_default().to_string();
    let places = [
        ("policy", policy()),
        ("title", escaped(&header.title)),
        ("style", STYLE.to_string()),
        ("about", escaped(&about)),
        ("warnings", list_of_warnings(&results::warnings(summary, scenario))),
        ("statistics", rows(&report::cells(summary, &info.provenance.units))),
        ("scenario", escaped(&header.scenario_text)),
        ("provenance", provenance(stored, info)),
        ("cite", cite(stored)),
        ("data", data::json(stored, info)),
        ("echarts", ECHARTS.to_string()),
        ("charts", CHARTS.to_string()),
    ];
    // All placeholders are filled in one pass, so that a placeholder inside a filled-in text stays
    // as it is.
    let mut parts = PAGE.split("{{");
    let mut out = parts.next().unwrap_or_default().to_string();
    for part in parts {
        let (name, rest) = part.split_once("}}").unwrap_or((part, ""));
        if let Some((_, text)) = places.iter().find(|(place, _)| *place == name) {
            out.push_str(text);
        }
        out.push_str(rest);
    }
    out
}

/// The content security policy: nothing may be loaded, and only the two scripts that are part of
/// the program may run.
fn policy() -> String {
    let hash = |script: &str| base64::engine::general_purpose::STANDARD.encode(Sha256::digest(script.as_bytes()));
    format!(
        "default-src 'none'; script-src 'sha256-{}' 'sha256-{}'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; \
         form-action 'none'",
        hash(ECHARTS),
        hash(CHARTS)
    )
}

fn list_of_warnings(warnings: &[JsonWarning]) -> String {
    if warnings.is_empty() {
        return String::new();
    }
    let items: String = warnings.iter().map(|warning| format!("<li>{}</li>", escaped(&warning.text))).collect();
    format!("<section class=\"warnings\"><h2>Warnings</h2><ul>{items}</ul></section>")
}

/// The rows of the table as HTML. The first row holds the headings.
fn rows(cells: &[Vec<String>]) -> String {
    let row = |cells: &Vec<String>, tag: &str| {
        let sign = |cell: &str| match cell.parse::<f64>() {
            Ok(_) => cell.replace('-', "\u{2212}"),
            Err(_) => cell.replace("+-", "\u{b1}"),
        };
        let cells: String = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(&sign(cell)))).collect();
        format!("<tr>{cells}</tr>")
    };
    let Some((head, body)) = cells.split_first() else { return String::new() };
    let body: String = body.iter().map(|cells| row(cells, "td")).collect();
    format!("<thead>{}</thead><tbody>{body}</tbody>", row(head, "th"))
}

fn provenance(stored: &Stored, info: &RunInfo) -> String {
    let header = &stored.header;
    let mut out = String::new();
    let mut put = |term: &str, text: &str| {
        let _ = write!(out, "<dt>{term}</dt><dd>{}</dd>", escaped(text));
    };
    put("file", &info.file);
    put("program", &format!("mc {} ({})", header.program_version, header.git_hash));
    put("noise", &format!("{}, seed {}", header.generator, header.seed));
    put("blocks", &format!("of {} paths", header.block_size));
    for (term, text) in report::remarks(&stored.summary, info).into_iter().filter(|(term, _)| *term != "file") {
        put(term.trim(), &text);
    }
    out
}

/// How to cite the run.
fn cite(stored: &Stored) -> String {
    report::citation(stored).map(|sentence| format!("<p>{}</p>", escaped(&sentence))).concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_end_what_they_stand_in() {
        assert_eq!(escaped("</script>&\"'\u{0}\u{7f}\n"), "&lt;/script&gt;&amp;&quot;&#39;\u{fffd}\u{fffd}\n");
    }

    /// The policy allows exactly two scripts, each by its hash, and no other source of scripts.
    #[test]
    fn the_policy_names_the_scripts_that_are_there() {
        let policy = policy();
        assert!(policy.starts_with("default-src 'none';") && policy.matches("'sha256-").count() == 2, "{policy}");
        assert!(!policy.contains("unsafe-eval") && !policy.contains("http"), "{policy}");
        // A script that contains the end tag of its own element would be cut there.
        assert!(!CHARTS.contains("</script") && !ECHARTS.contains("</script"));
    }
}
