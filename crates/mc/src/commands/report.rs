//! `mc report`: writes a file as one page for a browser, with its table, its warnings and its
//! pictures.

use crate::commands::show;
use crate::inputs::files;
use crate::inputs::results;
use crate::output::failure::{Failure, note, writable};
use crate::report::{self, Chosen, Report, html::Page};
use std::path::PathBuf;
use stickslip::scenario::BridgeScene;
use stickslip_bearing::forecast::BearingForecast;
use stickslip_figure::{Drawing, DrawnPath, FIGURES, Style, Subject};
use stickslip_files::store::{self, Content, Stored, StoredCalibration, StoredSweep, StoredTrade};

/// Arguments of `mc report`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/report.txt"))]
pub struct Arguments {
    /// A file that `mc run`, `mc sweep`, `mc trade` or `mc calibrate` wrote
    file: PathBuf,
    /// Output file [default: NAME.html in the current directory]
    #[arg(short, long, value_name = "FILE.html")]
    output: Option<PathBuf>,
    /// Overwrite an earlier page
    #[arg(long)]
    force: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let output = self
            .output
            .clone()
            .unwrap_or_else(|| results::default_output(&self.file, ".html"));
        writable(&output, self.force, [self.file.as_path()])?;
        crate::arguments::extension::check_page(&output, &self.file)?;
        let page = self.page(files::read(&self.file, store::content)?)?;
        store::write_whole(&output, page.as_bytes(), self.force)?;
        note(&format!("{}: {} kB", output.display(), page.len() / 1000));
        Ok(())
    }

    fn page(&self, content: Content) -> Result<String, Failure> {
        let scenario = content.scenario().0;
        let digits = format!(
            "`mc show {} --format csv` prints all digits.",
            self.file.display()
        );
        let mut page = Page {
            report: Report::default(),
            lead: String::new(),
            leading_picture: None,
            warnings: Vec::new(),
            words: vec![("All digits", digits)],
            pictures: Vec::new(),
            scenario: &scenario,
            provenance: Vec::new(),
        };
        match content {
            Content::Calibration(stored) => return Ok(of_bearing(&stored, None)),
            Content::Run(stored) => self.fill_with_run(&mut page, &stored),
            Content::Sweep(stored) => self.fill_with_sweep(&mut page, *stored),
            Content::Trade(stored) => self.fill_with_trade(&mut page, &stored),
        }
        Ok(page.html())
    }

    fn fill_with_run(&self, page: &mut Page<'_>, stored: &Stored) {
        let scenario = results::scenario("scenario", stored, &[]).ok();
        let info = show::info(&self.file, stored, scenario.as_ref());
        let summary = &stored.summary;
        if let Some(scenario) = &scenario {
            let path = DrawnPath {
                scenario,
                number: 0,
                from: 0.0,
            };
            page.pictures = pictures(&Subject::Run {
                scenario,
                summary,
                path,
            });
        }
        page.words.push(("Intervals", INTERVALS.into()));
        let citation = report::citation(stored).join(" ");
        page.words.push(("How to cite", citation));
        page.report = report::run(summary, &info, Chosen::All, true);
        // The warnings say these.
        page.report
            .remarks
            .retain(|(label, _)| !["drift", "few"].contains(label));
        page.warnings = results::warnings(summary, scenario.as_ref())
            .into_iter()
            .map(|(_, text)| text)
            .collect();
    }

    fn fill_with_sweep(&self, page: &mut Page<'_>, stored: StoredSweep) {
        page.provenance = self.provenance(stored.other_program.as_deref());
        let sweeps = [(String::new(), stored.sweep)];
        let [(_, sweep)] = &sweeps;
        page.pictures = pictures(&Subject::Sweep {
            sweeps: &sweeps,
            statistics: &[],
        });
        page.report = report::sweep(sweep, Chosen::First, &self.file);
        page.warnings = report::warnings(sweep);
    }

    fn fill_with_trade(&self, page: &mut Page<'_>, stored: &StoredTrade) {
        if let Some(prices) = stored.prices(None) {
            page.pictures = pictures(&Subject::Trade(&prices));
        }
        page.report = report::prices(&stored.scenario.title, &stored.trade, Chosen::First);
        page.provenance = self.provenance(stored.other_program.as_deref());
    }

    /// The file and the program that wrote it, where `other` is not this one.
    fn provenance(&self, other: Option<&str>) -> Vec<(&'static str, String)> {
        let program = other.map_or_else(crate::version, str::to_string);
        vec![
            ("file", self.file.display().to_string()),
            ("program", format!("mc {program}")),
        ]
    }
}

/// What stands below the statistics of a run.
const INTERVALS: &str = "Intervals are 95 % confidence intervals, with paths as independent units. Bias is \
                         the effect of the time step on the estimate; the corrected estimate is shown where \
                         the bias exceeds its uncertainty. The single path is number 0.";

/// What neither fit nor forecast knows of.
const LEFT_OUT: &str = "Traffic, wind and braking, which move a bearing faster than the weather; wear, which \
                        changes friction; and a climate different from that of the record. Movements that \
                        they cause add to the sliding path.";

/// The page of a forecast.
pub fn of_forecast(scene: &BridgeScene, found: &BearingForecast) -> String {
    let stored = StoredCalibration::of(&scene.title, &scene.text, found.calibration.clone());
    of_bearing(&stored, Some(found))
}

/// The page of a calibration, after a forecast if there is one, in words for readers who did not
/// make them.
fn of_bearing(stored: &StoredCalibration, found: Option<&BearingForecast>) -> String {
    let StoredCalibration {
        title,
        scenario_text,
        calibration,
        ..
    } = stored;
    let mut report = report::bearing::calibration(title, calibration, true);
    let years = found.map(|found| report::bearing::forecast(title, &found.forecast, true).tables);
    report.tables.splice(0..0, years.unwrap_or_default());
    let warnings = found.map_or_else(|| stored.warnings.clone(), BearingForecast::warnings);
    let program = stored.other_program.clone().unwrap_or_else(crate::version);
    let page = Page {
        report,
        lead: match found {
            Some(found) => report::bearing::typical_year(&found.forecast),
            None => report::bearing::found(calibration),
        },
        leading_picture: found
            .map(|found| stickslip_figure::years(title, &found.forecast, &Style::default())),
        warnings: warnings.into_iter().map(|(_, text)| text).collect(),
        words: vec![
            (
                "Results from the record",
                report::bearing::seen(calibration),
            ),
            ("Symbols", report::bearing::SYMBOLS.into()),
            ("Not included", LEFT_OUT.into()),
        ],
        pictures: pictures(&Subject::Calibration { title, calibration }),
        scenario: scenario_text,
        provenance: vec![("program", format!("mc {program}"))],
    };
    page.html()
}

/// The figures of a subject, one after the other. The panels of an overview are in the others, and
/// readers who did not calibrate do not need the residuals.
fn pictures(subject: &Subject) -> Vec<Drawing> {
    let figures = FIGURES
        .iter()
        .filter(|figure| !["overview", "residuals"].contains(&figure.name));
    figures
        .filter_map(|figure| figure.draw(subject, &Style::default()).ok())
        .collect()
}
