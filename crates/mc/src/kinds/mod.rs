//! What each command does with a result, whatever its kind. A kind is a row of [`crate::KINDS`], and
//! its results are [`AnyResult`]s.

mod run;
mod sweep;
mod trade;

pub use run::{RUN, info, is_run};
pub use sweep::SWEEP;
pub use trade::TRADE;

use crate::KINDS;
use crate::arguments::threads::Threads;
use crate::commands::plot;
use crate::inputs::files;
use crate::output::failure::Failure;
use crate::report::html::Page;
use crate::report::{Report, ShownStatistics};
use std::path::Path;
use stickslip::dataset::Format;
use stickslip_figure::{Drawing, Figure, Style, Subject};
use stickslip_files::saved::Verified;
use stickslip_files::store::{self, CheckedBytes, StoreError};

/// A kind of result stored in files.
pub struct Kind {
    /// Its name in messages, with the article.
    pub name: &'static str,
    /// Its format, by which files are recognised.
    pub format: Format,
    /// Whether `mc resume` continues an unfinished one.
    pub is_resumable: bool,
    /// Reads the file of such a result.
    pub read: fn(&Path) -> Result<Box<dyn StoredResult>, StoreError>,
    /// Its figures, in the order in which a page shows them.
    pub figures: &'static [Figure],
}

/// A result. `file` is where it is; it is empty if it is not in a file.
pub trait AnyResult {
    /// Its report. Warnings are printed if it is text.
    fn report(&self, file: &Path, shown: &Shown) -> Result<Report, Failure>;

    /// The result as one JSON object. Warnings are printed.
    fn json(&self, file: &Path) -> Result<String, Failure>;

    /// The result as a page for a browser.
    fn page(&self, file: &Path) -> Result<String, Failure>;
}

/// A result that was read from a file.
pub trait StoredResult: AnyResult {
    /// The text of the scenario, and whether the file also holds the measured values that the text
    /// names.
    fn scenario(&self) -> (String, bool);

    /// The program that wrote it, if it was a different one.
    fn other_program(&self) -> Option<String>;

    /// The requested figures.
    fn draw(&self, asked: &plot::Arguments) -> Result<Drawing, Failure>;

    /// Computes the result again as far as possible, and compares it with its file.
    fn again(
        &self,
        file: &Path,
        threads: &Threads,
        checked: CheckedBytes,
    ) -> Result<Again, Failure>;
}

/// How a report is shown.
pub struct Shown<'a> {
    /// The statistics in its table.
    pub chosen: ShownStatistics<'a>,
    /// Whether everything that was measured is shown.
    pub all: bool,
    /// Whether all notes are shown.
    pub notes: bool,
    /// Whether it is text for people.
    pub is_text: bool,
}

/// What was computed again and compared.
pub struct Again {
    /// What was computed again, for people.
    pub simulated: String,
    /// What was compared with that.
    pub compared: &'static str,
    pub found: Verified,
}

/// The kind of result in a file; none if the file is not one of results.
pub fn of(path: &Path) -> Result<Option<&'static Kind>, StoreError> {
    let Some(name) = store::format(path)? else {
        return Ok(None);
    };
    let known = KINDS.into_iter().find(|kind| kind.format.0 == name);
    let foreign = || StoreError::Foreign {
        path: path.to_owned(),
    };
    known.map(Some).ok_or_else(foreign)
}

/// The result in a file of any kind. Any other file is read as a run, whose reader reports the
/// error.
pub fn read(path: &Path) -> Result<Box<dyn StoredResult>, Failure> {
    let kind = of(path).ok().flatten().unwrap_or(&RUN);
    files::read(path, kind.read)
}

/// The figures of all kinds.
pub fn figures() -> impl Iterator<Item = &'static Figure> + Clone {
    KINDS.into_iter().flat_map(|kind| kind.figures)
}

/// The figures of a result for its page, in order, except the one with this name.
pub fn pictures(figures: &[Figure], subject: &Subject, left_out: &str) -> Vec<Drawing> {
    let figures = figures.iter().filter(|figure| figure.name != left_out);
    figures
        .filter_map(|figure| figure.draw(subject, &Style::default()).ok())
        .collect()
}

/// A page with only its provenance.
fn page<'a>(file: &Path, scenario: &'a str) -> Page<'a> {
    let digits = format!(
        "`mc show {} --format csv` prints all digits.",
        file.display()
    );
    Page {
        report: Report::default(),
        lead: String::new(),
        leading_picture: None,
        warnings: Vec::new(),
        words: vec![("All digits", digits)],
        pictures: Vec::new(),
        scenario,
        provenance: Vec::new(),
    }
}

/// The file and the program that wrote it, where `other` is not this one.
fn provenance(file: &Path, other: Option<&str>) -> Vec<(&'static str, String)> {
    let program = other.map_or_else(|| format!("mc {}", crate::version()), str::to_string);
    vec![("file", file.display().to_string()), ("program", program)]
}
