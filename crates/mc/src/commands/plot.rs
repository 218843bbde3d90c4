//! `mc plot`: draws a path of a scenario, a run, a trade, a sweep or a calibration.

use crate::arguments::overrides::Settings;
use crate::commands::sweep;
use crate::inputs::files;
use crate::inputs::results;
use crate::output::failure::{Failure, note, writable};
use crate::output::numbers::{counted, parse_number_in};
use std::path::{Path, PathBuf};
use stickslip::config::{Override, input_files};
use stickslip::scenario::Scenario;
use stickslip::stats::Statistic;
use stickslip::study::sweep::Sweep;
use stickslip_figure::{Absent, COLUMN, Drawing, DrawnPath, NoPage, Only, Style, Subject, Theme};
use stickslip_files::store::{self, Content, FileKind, Stored};

/// Arguments of `mc plot`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/plot.txt"))]
pub struct Arguments {
    /// A scenario (TOML), or a file that `mc run`, `mc trade`, `mc sweep` or `mc calibrate` wrote
    #[arg(value_name = "SCENARIO|FILE.h5")]
    subject: PathBuf,
    /// Further sweeps over the same key, drawn in the same axes
    #[arg(value_name = "SWEEP.h5")]
    beside: Vec<PathBuf>,
    /// Where to write the picture; the ending .svg, .png or .pdf selects the format [default:
    /// NAME.svg in the current directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[arg(long, value_name = "NAME", value_parser = Only::named,
          help = format!("One figure: {}; or one of its panels by its letter, e.g. sticks.B", Only::names()))]
    only: Option<Only>,
    /// The number of the path to draw
    #[arg(long, value_name = "N", default_value_t = 0)]
    path: u64,
    /// The time at which the drawing of a path begins
    #[arg(long, value_name = "T", allow_hyphen_values = true, default_value_t = 0.0)]
    from: f64,
    /// The time at which it ends
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    until: Option<String>,
    /// The statistic of a trade [default: the first that the trade has an answer for], or of a
    /// sweep [default: two of them]
    #[arg(long, value_name = "NAME", value_parser = crate::arguments::completion::STATISTIC, hide_possible_values = true)]
    statistic: Option<Statistic>,
    /// Colours for paper or for a dark screen
    #[arg(long, value_name = "light|dark", default_value = "light", value_parser = theme)]
    theme: Theme,
    /// Width of one figure in millimetres; a page is two figures wide
    #[arg(long, value_name = "MM", default_value_t = COLUMN, value_parser = width)]
    width: f64,
    /// Logarithmic vertical axes for densities and shares
    #[arg(long)]
    log: bool,
    #[command(flatten)]
    set: Settings,
    /// Words at the axes for a key or its symbol, or for a statistic, e.g. V="speed of the belt";
    /// repeatable; for sweeps
    #[arg(long, value_name = "KEY=WORDS", value_parser = label)]
    label: Vec<(String, String)>,
    /// The heading of the page; a figure by itself has none
    #[arg(long, value_name = "WORDS", conflicts_with = "only")]
    title: Option<String>,
    /// Overwrite an earlier picture
    #[arg(long)]
    force: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let output = self.output.clone().unwrap_or_else(|| self.default_output());
        writing(&output)?;
        writable(&output, self.force, std::iter::once(&self.subject).chain(&self.beside))?;
        let scene = self.scene(&output)?;
        write(&scene, &output, self.force)?;
        note(&format!("{}: {}", output.display(), size(&scene)));
        if scene.left_out > 0 {
            note(&format!(
                "{} had no room; a larger --width or an earlier --until makes some",
                counted(scene.left_out as u64, "label")
            ));
        }
        Ok(())
    }

    fn scene(&self, output: &Path) -> Result<Drawing, Failure> {
        let shown = self.subject.display();
        let refused = |problem: String, remedy: &str| Err(Failure::usage(problem, remedy));
        match files::read(&self.subject, store::kind)? {
            None => {
                let mut overrides = self.set.list()?;
                overrides.extend(self.window());
                let scenario = Scenario::read(&self.subject, &overrides)?;
                writable(output, self.force, input_files(&self.subject, &overrides))?;
                return self.draw(&Subject::Path(self.drawn(&scenario)?));
            }
            Some(FileKind::Sweep) => {}
            _ if !self.label.is_empty() => {
                return refused(
                    format!("--label names keys at the axes of a sweep, and {shown} is none"),
                    "leave it out",
                );
            }
            _ if !self.beside.is_empty() => {
                let remedy = "several files are drawn together if they are sweeps over the same key";
                return refused(format!("{shown} is no sweep"), remedy);
            }
            _ => {}
        }
        if !self.set.list()?.is_empty() {
            let problem = format!("--set changes a scenario, and {shown} says what was run");
            return refused(problem, "give the scenario instead of the file, or leave --set out");
        }
        match files::read(&self.subject, store::content)? {
            Content::Run(stored) => self.scene_of_run(&stored),
            Content::Sweep(_) => self.scene_of_sweeps(),
            Content::Calibration(stored) => {
                self.draw(&Subject::Calibration { title: &stored.title, calibration: &stored.calibration })
            }
            Content::Trade(stored) => {
                let nothing = || {
                    Failure::run_of(
                        &self.subject,
                        "no statistic in it has prices",
                        "measure again with a larger --budget",
                    )
                };
                self.draw(&Subject::Trade(&stored.prices(self.statistic).ok_or_else(nothing)?))
            }
        }
    }

    fn scene_of_sweeps(&self) -> Result<Drawing, Failure> {
        let read = |file: &PathBuf| -> Result<(String, Sweep), Failure> {
            let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            Ok((name, sweep::stored(file, files::read(file, store::read_sweep)?)?))
        };
        let sweeps = std::iter::once(&self.subject).chain(&self.beside).map(read).collect::<Result<Vec<_>, _>>()?;
        self.draw(&Subject::Sweep { sweeps: &sweeps, statistics: self.statistic.as_slice() })
    }

    fn scene_of_run(&self, stored: &Stored) -> Result<Drawing, Failure> {
        results::check_path(stored, self.path)?;
        let name = self.subject.display().to_string();
        let scenario = results::scenario(&name, stored, &[])?;
        let shorter = results::scenario(&name, stored, &self.window())?;
        self.draw(&Subject::Run { scenario: &scenario, summary: &stored.summary, path: self.drawn(&shorter)? })
    }

    /// The path that is drawn, of this scenario.
    fn drawn<'a>(&self, scenario: &'a Scenario) -> Result<DrawnPath<'a>, Failure> {
        let (from, end) = (self.from, scenario.time.end);
        if (0.0..end.max(f64::MIN_POSITIVE)).contains(&from) {
            return Ok(DrawnPath { scenario, number: self.path, from });
        }
        let problem = format!("--from {from:?}: the path lasts from 0 to {end:?}");
        Err(Failure::usage(problem, "give a time before its end, or a later --until"))
    }

    /// What ends a path at `--until`. Events do not depend on the end of the simulation, so it is the
    /// beginning of the longer path; how much of it statistics leave out does not matter to it.
    fn window(&self) -> Vec<Override> {
        let until = self.until.iter();
        until
            .flat_map(|time| {
                [Override::flag("--until", "time.end", time), Override::flag("--until", "statistics.after", "0")]
            })
            .collect()
    }

    /// Refuses an option that would change nothing in the one figure that is asked for.
    fn check_only(&self) -> Result<(), Failure> {
        let Some(Only { figure, .. }) = self.only else { return Ok(()) };
        let options = [
            ("--from", self.from != 0.0, &["path", "overview"][..]),
            ("--until", self.until.is_some(), &["path", "overview"]),
            ("--log", self.log, &["sticks", "sub-phases", "laws", "density", "sweep"]),
        ];
        match options.into_iter().find(|(_, is_given, figures)| *is_given && !figures.contains(&figure.name)) {
            None => Ok(()),
            Some((option, _, figures)) => Err(Failure::usage(
                format!("{option} changes nothing in the figure `{}`", figure.name),
                format!("leave it out; it is for {}", figures.join(", ")),
            )),
        }
    }

    fn draw(&self, subject: &Subject) -> Result<Drawing, Failure> {
        self.check_only()?;
        let Arguments { theme, width, log, .. } = *self;
        let style = Style { theme, width, log, title: self.title.as_deref(), labels: &self.label };
        stickslip_figure::draw(self.only, subject, &style).map_err(|no| match no {
            NoPage::Without(figure, absent) => self.refused(figure.name, &absent),
            NoPage::Empty => Failure::Run("there is nothing to draw: every path was lost".to_string()),
            NoPage::Label(name, known) => {
                let problem = format!("--label {name}=...: the sweep has no such key, and there is no such statistic");
                Failure::usage(problem, format!("name a statistic, or one of {known}"))
            }
        })
    }

    fn refused(&self, figure: &str, absent: &Absent) -> Failure {
        let problem = format!("no figure {figure} of {}: {absent}", self.subject.display());
        let remedy = match absent {
            Absent::Elsewhere(_) => "run it first, or choose another figure with --only",
            Absent::Nothing(_) => return Failure::Run(problem),
            Absent::Panel(..) => "choose one of them with --only, or leave the letter out for all",
            Absent::Lost(_) => "choose another path with --path",
        };
        Failure::usage(problem, remedy)
    }

    /// `NAME.svg`, or `NAME-FIGURE.svg`, in the current directory.
    fn default_output(&self) -> PathBuf {
        let figure = self.only.map_or_else(String::new, |only| format!("-{only}"));
        results::default_output(&self.subject, &format!("{figure}.svg"))
    }
}

/// Width and height in words.
fn size(scene: &Drawing) -> String {
    let millimetres = |points: f64| points * 25.4 / 72.0;
    format!("{:.0} mm x {:.0} mm", millimetres(scene.width), millimetres(scene.height))
}

/// Resolution of a PNG.
const DOTS_PER_INCH: f64 = 300.0;

/// How a picture is written in the format that belongs to the ending of a file's name.
type Writing = fn(&Drawing) -> Result<Vec<u8>, String>;

fn writing(path: &Path) -> Result<Writing, Failure> {
    match crate::arguments::extension::ending(path).as_str() {
        "svg" => Ok(|scene| Ok(stickslip_figure::svg(scene).into_bytes())),
        "png" => Ok(|scene| stickslip_figure::png(scene, DOTS_PER_INCH).map_err(|error| error.to_string())),
        "pdf" => Ok(|scene| stickslip_figure::pdf(scene).ok_or_else(|| "a flaw in the program: no PDF".to_string())),
        _ => {
            let problem = format!("-o {}: the ending does not tell a format", path.display());
            Err(Failure::usage(problem, "write a name that ends in .svg, .png or .pdf"))
        }
    }
}

/// Writes a picture under a temporary name and then renames it, so that the file under its name is
/// always complete.
pub fn write(scene: &Drawing, output: &Path, force: bool) -> Result<(), Failure> {
    let bytes = writing(output)?(scene).map_err(Failure::Run)?;
    Ok(store::write_whole(output, &bytes, force)?)
}

fn theme(name: &str) -> Result<Theme, String> {
    match name {
        "light" => Ok(Theme::Light),
        "dark" => Ok(Theme::Dark),
        _ => Err("write light or dark".to_string()),
    }
}

fn label(text: &str) -> Result<(String, String), String> {
    let (name, words) = text.split_once('=').ok_or("write KEY=WORDS")?;
    Ok((name.trim().to_string(), words.trim().to_string()))
}

/// The widths at which letters of 8 points are neither crowded nor too small beside the figure, in
/// millimetres.
const WIDTHS: std::ops::RangeInclusive<f64> = 60.0..=400.0;

fn width(text: &str) -> Result<f64, String> {
    parse_number_in(
        text,
        &WIDTHS,
        &format!("write a number of millimetres from {} to {}", WIDTHS.start(), WIDTHS.end()),
    )
}
