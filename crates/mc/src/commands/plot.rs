//! `mc plot`: draws a path of a scenario, or the results in a file.

use crate::arguments::overrides::Settings;
use crate::inputs::files;
use crate::inputs::results;
use crate::kinds::{self, SWEEP};
use crate::output::failure::{Failure, note, writable};
use crate::output::numbers::{counted, parse_number_in};
use std::path::{Path, PathBuf};
use stickslip::config::{Override, input_files};
use stickslip::scenario::Scenario;
use stickslip::stats::Statistic;
use stickslip_figure::{Absent, COLUMN, Drawing, DrawnPath, NoPage, Only, Style, Subject, Theme};
use stickslip_files::store;

/// Arguments of `mc plot`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/plot.txt"))]
pub struct Arguments {
    /// A scenario (TOML), or a file of results
    #[arg(value_name = "SCENARIO|FILE.h5")]
    pub subject: PathBuf,
    /// Further sweeps over the same key, drawn on the same axes
    #[arg(value_name = "SWEEP.h5")]
    pub beside: Vec<PathBuf>,
    /// Output file; the extension .svg, .png or .pdf selects the format [default: NAME.svg in the
    /// current directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[arg(long, value_name = "NAME", value_parser = figure,
          help = format!("One figure: {}; or one of its panels, by letter, e.g. sticks.B", Only::names(kinds::figures())))]
    only: Option<Only>,
    /// Number of the path to draw
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub path: u64,
    /// Time at which the drawing of a path begins
    #[arg(
        long,
        value_name = "T",
        allow_hyphen_values = true,
        default_value_t = 0.0
    )]
    from: f64,
    /// Time at which it ends
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    until: Option<String>,
    /// Statistic of a trade [default: the first with an estimate], or of a sweep [default: two of
    /// them]
    #[arg(long, value_name = "NAME", value_parser = crate::arguments::completion::STATISTIC, hide_possible_values = true)]
    pub statistic: Option<Statistic>,
    /// Colours for paper (light) or a dark screen
    #[arg(long, value_name = "light|dark", default_value = "light", value_parser = theme)]
    theme: Theme,
    /// Width of one figure in millimetres; a page is two figures wide
    #[arg(long, value_name = "MM", default_value_t = COLUMN, value_parser = width)]
    width: f64,
    /// Logarithmic vertical axes for densities and fractions
    #[arg(long)]
    log: bool,
    #[command(flatten)]
    set: Settings,
    /// Axis label for a key or its symbol, or for a statistic, of a sweep, e.g. V="speed of the
    /// belt"; repeatable
    #[arg(long, value_name = "KEY=WORDS", value_parser = label)]
    label: Vec<(String, String)>,
    /// Heading of the page; single figures have none
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
        writable(
            &output,
            self.force,
            std::iter::once(&self.subject).chain(&self.beside),
        )?;
        let scene = self.scene(&output)?;
        write(&scene, &output, self.force)?;
        note(&format!("{}: {}", output.display(), size(&scene)));
        if scene.left_out > 0 {
            note(&format!(
                "no room for {}; use a larger --width or an earlier --until",
                counted(scene.left_out as u64, "label")
            ));
        }
        Ok(())
    }

    fn scene(&self, output: &Path) -> Result<Drawing, Failure> {
        let shown = self.subject.display();
        let refused = |problem: String, remedy: &str| Err(Failure::usage(problem, remedy));
        let Some(kind) = files::read(&self.subject, kinds::of)? else {
            let mut overrides = self.set.list()?;
            overrides.extend(self.window());
            let scenario = Scenario::read(&self.subject, &overrides)?;
            writable(output, self.force, input_files(&self.subject, &overrides))?;
            return self.draw(&Subject::Path(self.drawn(&scenario)?));
        };
        let is_sweep = kind.format == SWEEP.format;
        if !self.label.is_empty() && !is_sweep {
            return refused(
                format!("--label applies to sweeps, but {shown} is not one"),
                "remove it",
            );
        }
        if !self.beside.is_empty() && !is_sweep {
            let remedy =
                "several files can be drawn together only if they are sweeps over the same key";
            return refused(format!("{shown} is not a sweep"), remedy);
        }
        if !self.set.list()?.is_empty() {
            let problem = format!("--set changes a scenario, but {shown} is a finished run");
            return refused(
                problem,
                "give the scenario instead of the file, or remove --set",
            );
        }
        files::read(&self.subject, kind.read)?.draw(self)
    }

    /// The path of this scenario that is drawn.
    pub fn drawn<'a>(&self, scenario: &'a Scenario) -> Result<DrawnPath<'a>, Failure> {
        let (from, end) = (self.from, scenario.time.end);
        if (0.0..end.max(f64::MIN_POSITIVE)).contains(&from) {
            return Ok(DrawnPath {
                scenario,
                number: self.path,
                from,
            });
        }
        let problem = format!("--from {from:?} must be between 0 and {end:?}");
        Err(Failure::usage(
            problem,
            "give an earlier time, or a later --until",
        ))
    }

    /// Changes that end a path at `--until`. Events do not depend on the end of the simulation, so
    /// the result is the beginning of the longer path. The start of the counted time does not
    /// matter here.
    pub fn window(&self) -> Vec<Override> {
        let until = self.until.iter();
        until
            .flat_map(|time| {
                [
                    Override::flag("--until", "time.end", time),
                    Override::flag("--until", "statistics.after", "0"),
                ]
            })
            .collect()
    }

    /// Refuses an option that has no effect on the one requested figure.
    fn check_only(&self) -> Result<(), Failure> {
        let Some(Only { figure, .. }) = self.only else {
            return Ok(());
        };
        let options = [
            ("--from", self.from != 0.0, &["path", "overview"][..]),
            ("--until", self.until.is_some(), &["path", "overview"]),
            (
                "--log",
                self.log,
                &["sticks", "sub-phases", "laws", "density", "sweep"],
            ),
        ];
        match options
            .into_iter()
            .find(|(_, is_given, figures)| *is_given && !figures.contains(&figure.name))
        {
            None => Ok(()),
            Some((option, _, figures)) => Err(Failure::usage(
                format!("{option} has no effect on the figure `{}`", figure.name),
                format!("remove it; it applies to {}", figures.join(", ")),
            )),
        }
    }

    /// The requested figure or panel, or the page of all figures.
    pub fn draw(&self, subject: &Subject) -> Result<Drawing, Failure> {
        self.check_only()?;
        let Arguments {
            theme, width, log, ..
        } = *self;
        let style = Style {
            theme,
            width,
            log,
            title: self.title.as_deref(),
            labels: &self.label,
        };
        stickslip_figure::draw(self.only, kinds::figures(), subject, &style).map_err(
            |no| match no {
                NoPage::Without(figure, absent) => self.refused(figure.name, &absent),
                NoPage::Empty => Failure::Run("nothing to draw: every path was lost".to_string()),
                NoPage::Label(name, known) => {
                    let problem = format!(
                        "--label {name}=...: no key of the sweep and no statistic has this name"
                    );
                    Failure::usage(problem, format!("use a statistic, or one of {known}"))
                }
            },
        )
    }

    fn refused(&self, figure: &str, absent: &Absent) -> Failure {
        let problem = format!(
            "cannot draw {figure} of {}: {absent}",
            self.subject.display()
        );
        let remedy = match absent {
            Absent::Elsewhere(_) => "run it first, or choose another figure with --only",
            Absent::Nothing(_) => return Failure::Run(problem),
            Absent::Panel(..) => "choose one of them with --only, or omit the letter to draw all",
            Absent::Lost(_) => "choose another path with --path",
        };
        Failure::usage(problem, remedy)
    }

    /// `NAME.svg`, or `NAME-FIGURE.svg`, in the current directory.
    fn default_output(&self) -> PathBuf {
        let figure = self
            .only
            .map_or_else(String::new, |only| format!("-{only}"));
        results::default_output(&self.subject, &format!("{figure}.svg"))
    }
}

/// Width and height in words.
fn size(scene: &Drawing) -> String {
    let millimetres = |points: f64| points * 25.4 / 72.0;
    format!(
        "{:.0} mm x {:.0} mm",
        millimetres(scene.width),
        millimetres(scene.height)
    )
}

/// Resolution of a PNG.
const DOTS_PER_INCH: f64 = 300.0;

/// Writes a picture in the format of a file's extension.
type Writing = fn(&Drawing) -> Result<Vec<u8>, String>;

fn writing(path: &Path) -> Result<Writing, Failure> {
    match crate::arguments::extension::ending(path).as_str() {
        "svg" => Ok(|scene| Ok(stickslip_figure::svg(scene).into_bytes())),
        "png" => Ok(|scene| {
            stickslip_figure::png(scene, DOTS_PER_INCH).map_err(|error| error.to_string())
        }),
        "pdf" => Ok(|scene| {
            stickslip_figure::pdf(scene).ok_or_else(|| "internal error: no PDF".to_string())
        }),
        _ => {
            let problem = format!("-o {}: unknown file extension", path.display());
            Err(Failure::usage(problem, "use .svg, .png or .pdf"))
        }
    }
}

/// Writes a picture under a temporary name and then renames it, so that the file under its name is
/// always complete.
pub fn write(scene: &Drawing, output: &Path, force: bool) -> Result<(), Failure> {
    let bytes = writing(output)?(scene).map_err(Failure::Run)?;
    Ok(store::write_whole(output, &bytes, force)?)
}

fn figure(text: &str) -> Result<Only, String> {
    Only::named(text, kinds::figures())
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

/// Widths in millimetres at which text of 8 points is neither crowded nor too small for the figure.
const WIDTHS: std::ops::RangeInclusive<f64> = 60.0..=400.0;

fn width(text: &str) -> Result<f64, String> {
    parse_number_in(
        text,
        &WIDTHS,
        &format!("must be between {} and {} mm", WIDTHS.start(), WIDTHS.end()),
    )
}
