//! `mc show`: prints the results in a file and where they come from; several files are printed side
//! by side.

use crate::inputs::files;
use crate::kinds::{self, Shown};
use crate::output::failure::{Failure, note, print, print_data};
use crate::report::{self, Report, RunInfo, ShownStatistics};
use std::path::{Path, PathBuf};
use stickslip::stats::{Statistic, Summary};
use stickslip_files::store;

/// Arguments of `mc show`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/show.txt"))]
pub struct Arguments {
    /// Files that `mc run` wrote, or one file of results of any kind
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print these statistics, in this order, separated by commas [default: the main statistics of
    /// sticks, slips and drift]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = crate::arguments::completion::STATISTIC, hide_possible_values = true,
          conflicts_with_all = ["all", "json"])]
    statistics: Vec<Statistic>,
    /// Print all statistics that were measured; for a trade, every measurement
    #[arg(long, conflicts_with = "json")]
    all: bool,
    /// Print all notes below the table of a run, and its provenance
    #[arg(long, conflicts_with_all = ["json", "format"])]
    notes: bool,
    /// Print JSON: one object, or an array for several files
    #[arg(long)]
    json: bool,
    /// Print a table for other programs: CSV with all digits, one line per statistic of each file
    /// or point (all statistics unless --statistics selects some); or a table for a paper, with the
    /// digits that the error supports
    #[arg(
        long,
        value_name = "csv|markdown|latex",
        conflicts_with = "json",
        hide_possible_values = true
    )]
    format: Option<TableFormat>,
    /// Print how to cite a run: program, scenario, scheme, seed, paths, and the paper of the model
    #[arg(long, conflicts_with_all = ["json", "format"])]
    cite: bool,
    /// Print the scenario of the file, with every default written out: a file for mc run
    #[arg(long, conflicts_with_all = ["json", "format", "cite"])]
    scenario: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        if self.cite {
            return self.print_citations();
        }
        if self.scenario {
            return self.print_scenario();
        }
        if self.json {
            let objects = self
                .files
                .iter()
                .map(|file| kinds::read(file)?.json(file))
                .collect::<Result<Vec<_>, _>>()?;
            let [object] = objects.as_slice() else {
                let objects: Vec<&str> = objects.iter().map(|object| object.trim_end()).collect();
                return print_data(&format!("[{}]\n", objects.join(",\n")));
            };
            return print_data(object);
        }
        match self.format {
            Some(TableFormat::Csv) => {
                let named = |file: &PathBuf| Ok((file.display().to_string(), self.report(file)?));
                print_data(&report::comma_separated(
                    self.files
                        .iter()
                        .map(named)
                        .collect::<Result<_, Failure>>()?,
                ))
            }
            Some(TableFormat::Markdown) => print_data(&report::markdown(self.all()?)),
            Some(TableFormat::Latex) => print_data(&report::latex(self.all()?)),
            None => {
                let mut text = report::text(&self.all()?);
                if self.notes
                    && let [file] = self.files.as_slice()
                {
                    let scenario = kinds::read(file)?.scenario().0;
                    let lines = scenario
                        .lines()
                        .map(|line| format!("  {line}").trim_end().to_string() + "\n");
                    text += &format!("\nscenario:\n{}", lines.collect::<String>());
                }
                print(&text)
            }
        }
    }

    /// The report of one file, or of several runs side by side.
    fn all(&self) -> Result<Report, Failure> {
        let [file] = self.files.as_slice() else {
            if let Some(file) = self.files.iter().find(|file| !kinds::is_run(file)) {
                let problem = format!("{} is not a run; only runs can be compared", file.display());
                return Err(Failure::usage(
                    problem,
                    "show it alone, or use --format csv for several files",
                ));
            }
            let runs = self
                .files
                .iter()
                .map(|file| files::read(file, store::read))
                .collect::<Result<Vec<_>, _>>()?;
            let infos: Vec<RunInfo> = self
                .files
                .iter()
                .zip(&runs)
                .map(|(file, run)| kinds::info(file, run, None))
                .collect();
            let summaries: Vec<&Summary> = runs.iter().map(|run| &run.summary).collect();
            return Ok(report::comparison(&summaries, &infos, self.chosen()));
        };
        self.report(file)
    }

    /// The report of a file of any kind. Warnings are printed if it is text.
    fn report(&self, file: &Path) -> Result<Report, Failure> {
        let shown = Shown {
            chosen: self.chosen(),
            all: self.all,
            notes: self.notes,
            is_text: self.format.is_none(),
        };
        kinds::read(file)?.report(file, &shown)
    }

    /// The statistics that a table has.
    fn chosen(&self) -> ShownStatistics<'_> {
        match (
            self.statistics.as_slice(),
            self.all || self.format == Some(TableFormat::Csv),
        ) {
            ([], false) => ShownStatistics::First,
            ([], true) => ShownStatistics::All,
            (statistics, _) => ShownStatistics::These(statistics),
        }
    }

    fn print_scenario(&self) -> Result<(), Failure> {
        let [file] = self.files.as_slice() else {
            return Err(Failure::usage("--scenario takes one file", "give one file"));
        };
        let (text, is_measured) = kinds::read(file)?.scenario();
        if is_measured {
            note(
                "measured values are stored in the result file, not in this text; to run it, keep the data files it names",
            );
        }
        print_data(&text)
    }

    fn print_citations(&self) -> Result<(), Failure> {
        let sentences = self
            .files
            .iter()
            .map(|file| Ok(report::citation(&files::read(file, store::read)?)));
        let sentences: Vec<[String; 2]> = sentences.collect::<Result<_, Failure>>()?;
        let paper = sentences.first().map(|[_, paper]| paper.clone());
        let lines = sentences.into_iter().map(|[run, _]| run).chain(paper);
        print(&lines.map(|line| line + "\n").collect::<String>())
    }
}

/// A format of a table for other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum TableFormat {
    Csv,
    Markdown,
    Latex,
}
