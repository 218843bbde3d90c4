//! `mc report`: writes a file as one page for a browser, with its table, its warnings and its
//! pictures. The page has no script and needs no network.
//!
//! ```text
//! page        what a page consists of, as HTML
//! page.html   the skeleton of the page, with {{placeholders}}
//! style.css   the style for light and dark screens and for paper
//! bearing     the page of a calibration and of a forecast
//! ```

pub mod bearing;
pub mod page;

use super::document::JsonWarning;
use super::failure::{Failure, note, writable};
use super::files;
use super::report::{self, Chosen, RunInfo};
use super::{results, sweep_report, trade_report};
use page::{Page, Section};
use std::path::PathBuf;
use stick_slip::figure::{DrawnPath, FIGURES, Style, Subject, escaped};
use stick_slip::stats::Statistic;
use stick_slip::store::{self, Content, Stored, StoredSweep, StoredTrade};

/// Arguments of `mc report`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("../help/report.txt"))]
pub struct Arguments {
    /// A file that `mc run`, `mc sweep`, `mc trade` or `mc calibrate` wrote
    file: PathBuf,
    /// Where to write the page [default: NAME.html in the current directory]
    #[arg(short, long, value_name = "FILE.html")]
    output: Option<PathBuf>,
    /// Overwrite an earlier page
    #[arg(long)]
    force: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let default = || PathBuf::from(self.file.file_stem().unwrap_or("report".as_ref())).with_extension("html");
        let output = self.output.clone().unwrap_or_else(default);
        writable(&output, self.force, [self.file.as_path()])?;
        super::promise::check_page(&output, &self.file)?;
        let page = match files::read(&self.file, store::content)? {
            Content::Run(stored) => self.page_of_run(&stored),
            Content::Calibration(stored) => bearing::page(&stored, Vec::new(), Vec::new()),
            Content::Sweep(stored) => self.page_of_sweep(*stored)?,
            Content::Trade(stored) => self.page_of_trade(&stored),
        };
        store::write_whole(&output, page.as_bytes(), self.force)?;
        note(&format!("{}: {} kB", output.display(), page.len() / 1000));
        Ok(())
    }

    fn page_of_run(&self, stored: &Stored) -> String {
        let Stored { summary, header, .. } = stored;
        let scenario = results::scenario("scenario", stored, &[]).ok();
        let info = super::show::info(&self.file, stored, scenario.as_ref());
        let subject = scenario.as_ref().map(|scenario| Subject::Run {
            scenario,
            summary,
            path: DrawnPath { scenario, number: 0, from: 0.0 },
        });
        let statistics = report::rows(summary, &header.units, Chosen::All, info.period);
        let numbers = format!(
            "The single path is the one with number 0. `mc show {} --format csv` prints the statistics with all digits, and the \
             curves are variables of the file.",
            self.file.display()
        );
        let before =
            [Section::Table("Statistics", statistics, INTERVALS.to_string()), Section::Words("Pictures", numbers)];
        let cite = Section::Words("How to cite", report::citation(stored).join(" "));
        let page = Page {
            title: &header.title,
            about: report::table(summary, &info, Chosen::First, false).lines().nth(1).unwrap_or_default().to_string(),
            warnings: results::warnings(summary, scenario.as_ref()),
            parts: before.into_iter().chain(subject.iter().flat_map(pictures)).chain([cite]).collect(),
            scenario: &header.scenario_text,
            provenance: provenance(stored, &info),
        };
        page.html()
    }

    fn page_of_sweep(&self, stored: StoredSweep) -> Result<String, Failure> {
        let (text, by) = (stored.scenario_text.clone(), stored.other_program.clone());
        let sweep = super::sweep::stored(&self.file, stored)?;
        let sweeps = [(String::new(), &sweep)];
        let subject = Subject::Sweep { sweeps: &sweeps, statistics: &[] };
        let parts = sweep_report::usual(&sweep).into_iter().map(|(statistic, mut rows)| {
            let more = format!("`mc show {} --format csv` prints all points and statistics.", self.file.display());
            rows.truncate(1 + sweep_report::MOST_ROWS);
            Section::Table(statistic.words(), rows, more)
        });
        let page = Page {
            title: &sweep.question.scenario.title,
            about: sweep_report::table(&sweep, &[], &self.file).lines().nth(1).unwrap_or_default().to_string(),
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

    fn page_of_trade(&self, stored: &StoredTrade) -> String {
        let (table, prices) = (trade_report::stored_rows(stored, Statistic::words), stored.prices(None));
        let parts = std::iter::once(Section::Table("Cheapest runs", table, trade_report::LEGEND.to_string()));
        let page = Page {
            title: &stored.scenario.title,
            about: "what accuracy costs".to_string(),
            warnings: Vec::new(),
            parts: parts.chain(prices.iter().flat_map(|prices| pictures(&Subject::Trade(prices)))).collect(),
            scenario: &stored.scenario.to_toml(),
            provenance: vec![("file", self.file.display().to_string())],
        };
        page.html()
    }
}

/// What stands below the statistics of a run.
const INTERVALS: &str = "Intervals have 95 %, with the path as the unit. A bias is that of the time step: the estimate less its \
                         value without one; the corrected estimate is shown where the bias exceeds its uncertainty.";

/// The figures of a subject, one after the other. The panels of an overview are in the others.
fn pictures(subject: &Subject) -> Vec<Section> {
    let figures = FIGURES.iter().filter(|figure| figure.name != "overview");
    figures.filter_map(|figure| figure.draw(subject, &Style::default()).ok()).map(Section::Picture).collect()
}

/// The program that wrote a file; this one if it was no other.
fn program(other: Option<&str>) -> String {
    other.map_or_else(|| format!("mc {}", crate::cli::version()), |other| format!("mc {other}"))
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

fn provenance(stored: &Stored, info: &RunInfo) -> Vec<(&'static str, String)> {
    let header = &stored.header;
    let own = [
        ("file", info.file.clone()),
        ("program", format!("mc {} ({})", header.program_version, header.git_hash)),
        ("noise", format!("{}, seed {}", header.generator, header.seed)),
        ("blocks", format!("of {} paths", header.block_size)),
    ];
    let remarks = report::remarks(&stored.summary, info, true);
    let remarks = remarks.into_iter().filter(|(term, _)| *term != "file").map(|(term, text)| (term.trim(), text));
    own.into_iter().chain(remarks).collect()
}

/// Terms and what they are, as the inside of a list.
fn terms(of: &[(&str, String)]) -> String {
    of.iter().map(|(term, text)| format!("<dt>{term}</dt><dd>{}</dd>", marked(text))).collect()
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
}
