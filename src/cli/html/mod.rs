//! `mc report`: writes a file as one page for a browser, with its table, its warnings and, for a run,
//! charts that respond to mouse and keyboard. The page needs no network.
//!
//! ```text
//! page.html   the skeleton of the page, with {{placeholders}} that this module fills
//! study.html  that of a sweep, a trade, a calibration and a forecast, with pictures for charts
//! style.css   the style for light and dark screens and for paper
//! charts.js   the charts, which Apache ECharts (assets/echarts) draws
//! data        the numbers of the file, as JSON
//! ```

pub mod bearing;
mod data;
pub mod study;

use super::document::JsonWarning;
use super::failure::{Failure, note, writable};
use super::files;
use super::report::{self, RunInfo};
use super::{results, sweep_report, trade_report};
use base64::Engine as _;
use sha2::{Digest as _, Sha256};
use std::path::PathBuf;
use stick_slip::figure::{FIGURES, Only, Style, Subject, escaped};
use stick_slip::scenario::Scenario;
use stick_slip::stats::Statistic;
use stick_slip::store::{self, Content, Stored, StoredSweep, StoredTrade};
use study::{Part, StudyPage};

const EXAMPLES: &str = "\
Examples:
  mc report rho025.h5                      rho025.html, for any browser
  mc report rho025.h5 -o report.html --force
  mc report fit.h5                         a calibration, with its pictures
  mc forecast bridge.toml data.csv -o bridge.html

The page is one file. It works without a network, asks for nothing, and sends nothing.";

/// Arguments of `mc report`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Report {
    /// A file that `mc run`, `mc sweep`, `mc trade` or `mc calibrate` wrote
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
        let page = match files::read(&self.file, store::content)? {
            Content::Run(stored) => {
                let scenario = results::scenario("scenario", &stored, &[]).ok();
                let info = super::show::info(&self.file, &stored, scenario.as_ref());
                page(&stored, scenario.as_ref(), &info)
            }
            Content::Calibration(stored) => bearing::page(&stored, Vec::new(), Vec::new()),
            Content::Sweep(stored) => self.page_of_sweep(*stored)?,
            Content::Trade(stored) => self.page_of_trade(&stored)?,
        };
        store::write_whole(&output, page.as_bytes(), self.force)?;
        note(&format!("{}: {} kB", output.display(), page.len() / 1000));
        Ok(())
    }

    fn page_of_sweep(&self, stored: StoredSweep) -> Result<String, Failure> {
        let (text, by) = (stored.scenario_text.clone(), stored.other_program.clone());
        let sweep = super::sweep::stored(&self.file, stored)?;
        let sweeps = [(String::new(), &sweep)];
        let subject = Subject::Sweep { sweeps: &sweeps, statistics: &[] };
        let table = sweep_report::table(&sweep, &[], &self.file);
        let (title, rest) = table.split_once('\n').unwrap_or(("", &table));
        let (about, rest) = rest.split_once('\n').unwrap_or(("", rest));
        let parts = std::iter::once(Part::Lines("Results", in_words(rest.trim())));
        let page = StudyPage {
            title,
            about: about.to_string(),
            warnings: sweep_report::remarks(&sweep)
                .into_iter()
                .map(|text| JsonWarning { name: "sweep".into(), text })
                .collect(),
            parts: parts.chain(pictures(&subject)).collect(),
            scenario: &text,
            provenance: vec![("file", self.file.display().to_string()), ("program", program(by.as_deref()))],
        };
        Ok(page.html())
    }

    fn page_of_trade(&self, stored: &StoredTrade) -> Result<String, Failure> {
        let prices = files::read(&self.file, |path| store::read_prices(path, None))?;
        let table = trade_report::stored_rows(stored, Statistic::words);
        let parts = std::iter::once(Part::Table("Cheapest runs", table, trade_report::LEGEND.to_string()));
        let page = StudyPage {
            title: &stored.title,
            about: "what accuracy costs".to_string(),
            warnings: Vec::new(),
            parts: parts.chain(pictures(&Subject::Trade(&prices))).collect(),
            scenario: &stored.scenario_text,
            provenance: vec![("file", self.file.display().to_string())],
        };
        Ok(page.html())
    }
}

/// The figures of a subject, one after the other.
fn pictures(subject: &Subject) -> Vec<Part> {
    FIGURES.iter().filter_map(|figure| figure.draw(subject, &Style::default()).ok()).map(Part::Picture).collect()
}

/// The program that wrote a file; this one if it was no other.
fn program(other: Option<&str>) -> String {
    other.map_or_else(|| format!("mc {}", crate::cli::version()), |other| format!("mc {other}"))
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
        ("path", scenario.and_then(|scenario| path(stored, scenario)).unwrap_or_default()),
        ("scenario", escaped(&header.scenario_text)),
        ("provenance", provenance(stored, info)),
        ("cite", cite(stored)),
        ("data", data::json(stored, info)),
        ("echarts", ECHARTS.to_string()),
        ("charts", CHARTS.to_string()),
    ];
    filled(PAGE, &places)
}

/// The skeleton with all placeholders filled. They are filled in one pass, so that a placeholder
/// inside a filled-in text stays as it is.
fn filled(skeleton: &str, places: &[(&str, String)]) -> String {
    let mut parts = skeleton.split("{{");
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
    let items: String = warnings.iter().map(|warning| format!("<li>{}</li>", marked(&warning.text))).collect();
    format!("<section class=\"warnings\"><h2>Warnings</h2><ul>{items}</ul></section>")
}

/// A text with the names of statistics in words.
fn in_words(text: &str) -> String {
    let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = text.split_inclusive(|c| !is_of_name(c)).map(|word| {
        let name = word.trim_end_matches(|c| !is_of_name(c));
        Statistic::from_name(name).map_or(word.to_string(), |statistic| word.replacen(name, statistic.words(), 1))
    });
    words.collect()
}

/// A text as HTML: the names of statistics in words, what stands between back-ticks in letters for
/// code, and a true plus-minus sign.
fn marked(text: &str) -> String {
    let escaped = escaped(&in_words(text).replace("+-", "\u{b1}"));
    let parts: Vec<&str> = escaped.split('`').collect();
    // A back-tick without a partner stays.
    let pairs = (parts.len() - 1) / 2 * 2;
    let tag = |i: usize| match i {
        _ if i >= pairs => ["", "`"][usize::from(i + 1 < parts.len())],
        _ if i.is_multiple_of(2) => "<code>",
        _ => "</code>",
    };
    parts.iter().enumerate().map(|(i, part)| format!("{part}{}", tag(i))).collect()
}

/// The first path of the run, simulated again; none if it was lost.
fn path(stored: &Stored, scenario: &Scenario) -> Option<String> {
    let subject = Subject::Run { scenario, summary: &stored.summary, path: 0 };
    let drawing = Only::named("path").ok()?.draw(&subject, &Style::default()).ok()?;
    let picture = Part::Picture(drawing).html();
    Some(format!("<section id=\"path\"><h2>One path, the one with number 0</h2>{picture}</section>"))
}

/// The rows of the table as HTML. The first row holds the headings.
fn rows(cells: &[Vec<String>]) -> String {
    let row = |cells: &Vec<String>, tag: &str| {
        let sign = |cell: &str| match cell.parse::<f64>() {
            Ok(_) => cell.replace('-', "\u{2212}"),
            Err(_) => cell.replace("+-", "\u{b1}"),
        };
        let cells: String =
            cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(&in_words(&sign(cell))))).collect();
        format!("<tr>{cells}</tr>")
    };
    let Some((head, body)) = cells.split_first() else { return String::new() };
    let body: String = body.iter().map(|cells| row(cells, "td")).collect();
    format!("<thead>{}</thead><tbody>{body}</tbody>", row(head, "th"))
}

fn provenance(stored: &Stored, info: &RunInfo) -> String {
    let header = &stored.header;
    let own = [
        ("file", info.file.clone()),
        ("program", format!("mc {} ({})", header.program_version, header.git_hash)),
        ("noise", format!("{}, seed {}", header.generator, header.seed)),
        ("blocks", format!("of {} paths", header.block_size)),
    ];
    let remarks = report::remarks(&stored.summary, info);
    let remarks = remarks.into_iter().filter(|(term, _)| *term != "file").map(|(term, text)| (term.trim(), text));
    terms(&own.into_iter().chain(remarks).collect::<Vec<_>>())
}

/// Terms and what they are, as the inside of a list.
fn terms(of: &[(&str, String)]) -> String {
    of.iter().map(|(term, text)| format!("<dt>{term}</dt><dd>{}</dd>", marked(text))).collect()
}

/// How to cite the run.
fn cite(stored: &Stored) -> String {
    report::citation(stored).map(|sentence| format!("<p>{}</p>", escaped(&sentence))).concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_code_come_in_pairs() {
        let code = marked("raise `a<b` or `c` by 1 +- 2, drift_velocity");
        assert_eq!(code, "raise <code>a&lt;b</code> or <code>c</code> by 1 \u{b1} 2, drift velocity");
        assert_eq!([marked("a`b"), marked("`a` b`c")], ["a`b", "<code>a</code> b`c"]);
    }

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
