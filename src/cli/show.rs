//! `mc show`: prints the results in a file and where they come from; several files are printed side
//! by side.

use super::failure::{Failure, note, print, print_data};
use super::files;
use super::report::{self, Chosen, Csv, RunInfo};
use super::results;
use super::table::{TableRow, comma_separated, latex, markdown};
use super::{calibrate, calibrate_report, dataset, sweep, sweep_report, trade_report};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use stick_slip::dataset::Dataset;
use stick_slip::engine::Provenance;
use stick_slip::scenario::Scenario;
use stick_slip::stats::{Statistic, Summary};
use stick_slip::store::{self, Content, FileKind, Stored};

/// Arguments of `mc show`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/show.txt"))]
pub struct Arguments {
    /// Files that `mc run` wrote, or one of `mc sweep`, `mc trade` or `mc calibrate`
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print these statistics, in this order, separated by commas [default: those of sticks, slips
    /// and drift that the paper asks for]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = super::completed::STATISTIC, hide_possible_values = true,
          conflicts_with_all = ["all", "json"])]
    statistics: Vec<Statistic>,
    /// Print all statistics that were measured
    #[arg(long, conflicts_with = "json")]
    all: bool,
    /// Print all notes below the table of a run, and where its numbers come from
    #[arg(long, conflicts_with_all = ["json", "format"])]
    notes: bool,
    /// Print JSON instead: one object, or an array of them for several files
    #[arg(long)]
    json: bool,
    /// Print a table for other programs instead: comma-separated values with all digits, a line for
    /// each statistic of each file or point, all of them unless --statistics names some; or a table
    /// for a paper, with the digits that the error supports
    #[arg(long, value_name = "csv|markdown|latex", conflicts_with = "json", hide_possible_values = true)]
    format: Option<TableFormat>,
    /// Print how to cite a run instead: program, scenario, scheme, seed, paths, and the paper of
    /// the model
    #[arg(long, conflicts_with_all = ["json", "format"])]
    cite: bool,
    /// Print the scenario that the file was made with instead, with every default written out: a
    /// file for mc run
    #[arg(long, conflicts_with_all = ["json", "format", "cite"])]
    scenario: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let has_none = |file: &&PathBuf| {
            matches!(files::read(file, store::kind), Ok(Some(FileKind::Calibration | FileKind::Trade)))
        };
        if let Some(file) = self.files.iter().find(has_none).filter(|_| self.all || !self.statistics.is_empty()) {
            let problem = format!("--statistics and --all are for runs and sweeps, and {} is none", file.display());
            return Err(Failure::usage(problem, "leave them out"));
        }
        match self.format {
            Some(TableFormat::Csv) => return self.print_csv(),
            Some(TableFormat::Markdown) => return print_data(&markdown(&self.rows()?)),
            Some(TableFormat::Latex) => return print_data(&latex(&self.rows()?)),
            None => {}
        }
        if self.cite {
            return self.print_citations();
        }
        if self.scenario {
            return self.print_scenario();
        }
        match self.files.as_slice() {
            [file] => self.print_alone(file),
            files => self.print_several(files),
        }
    }

    /// Prints one file of any kind.
    fn print_alone(&self, file: &Path) -> Result<(), Failure> {
        match files::read(file, store::content)? {
            Content::Run(run) => self.print_one(file, &run),
            Content::Calibration(stored) => {
                calibrate::show(&stored.title, &stored.calibration, &stored.warnings, self.json)
            }
            Content::Trade(trade) => match self.json {
                true => print_data(&dataset::json(&Dataset::of_trade(&trade.scenario, &trade.trade), Some(file))),
                false => print(&trade_report::stored_table(&trade)),
            },
            Content::Sweep(stored) => {
                let sweep = sweep::stored(file, *stored)?;
                match self.json {
                    true => print_data(&dataset::json(&Dataset::of_sweep(&sweep), Some(file))),
                    false => print(&sweep_report::table(&sweep, &self.statistics, file)),
                }
            }
        }
    }

    fn print_scenario(&self) -> Result<(), Failure> {
        let [file] = self.files.as_slice() else {
            return Err(Failure::usage("--scenario prints the scenario of one file", "give one file"));
        };
        let content = files::read(file, store::content)?;
        let (text, is_measured) = content.scenario();
        if is_measured {
            note(
                "measured values are in the file of results and not in the text: run it beside the data files that it names",
            );
        }
        print_data(&text)
    }

    fn print_one(&self, file: &Path, stored: &Stored) -> Result<(), Failure> {
        let scenario = results::scenario("scenario", stored, &[]).ok();
        let info = info(file, stored, scenario.as_ref());
        if let Some(scenario) = &scenario {
            results::warn(scenario, stored.summary.has_bias(), !self.json);
        }
        if let Some(unfinished) = &stored.unfinished {
            note(&format!("this run is not finished; continue it with: mc resume {}", unfinished.display()));
        }
        if self.json {
            let warnings = results::warnings(&stored.summary, scenario.as_ref());
            return print_data(&report::json(&stored.summary, &info, &warnings));
        }
        let table = report::table(&stored.summary, &info, self.chosen(), self.notes);
        print(&if self.notes { table + &provenance(&stored.header) } else { table })
    }

    /// The statistics that a table has.
    fn chosen(&self) -> Chosen<'_> {
        match (self.statistics.as_slice(), self.all) {
            ([], false) => Chosen::First,
            ([], true) => Chosen::All,
            (statistics, _) => Chosen::These(statistics),
        }
    }

    fn print_several(&self, files: &[PathBuf]) -> Result<(), Failure> {
        if let Some(file) = files.iter().find(|file| is_sweep(file)) {
            let problem = format!("{} is a sweep, whose points are many runs", file.display());
            return Err(Failure::usage(problem, "show it alone, or several files with --format csv"));
        }
        let runs = files.iter().map(|file| files::read(file, store::read)).collect::<Result<Vec<_>, _>>()?;
        let infos: Vec<RunInfo> = files.iter().zip(&runs).map(|(file, run)| info(file, run, None)).collect();
        if self.json {
            let warnings =
                |run: &Stored| results::warnings(&run.summary, results::scenario("scenario", run, &[]).ok().as_ref());
            let objects = runs.iter().zip(&infos).map(|(run, info)| report::json(&run.summary, info, &warnings(run)));
            let objects: Vec<String> = objects.map(|object| object.trim_end().to_string()).collect();
            return print_data(&format!("[{}]\n", objects.join(",\n")));
        }
        let summaries: Vec<&Summary> = runs.iter().map(|run| &run.summary).collect();
        print(&report::comparison(&summaries, &infos, self.chosen()))
    }

    fn print_citations(&self) -> Result<(), Failure> {
        let sentences = self.files.iter().map(|file| Ok(report::citation(&files::read(file, store::read)?)));
        let sentences: Vec<[String; 2]> = sentences.collect::<Result<_, Failure>>()?;
        let paper = sentences.first().map(|[_, paper]| paper.clone());
        let lines = sentences.into_iter().map(|[run, _]| run).chain(paper);
        print(&lines.map(|line| line + "\n").collect::<String>())
    }

    /// The table of one file of any kind, or of several runs beside each other, headings first.
    fn rows(&self) -> Result<Vec<TableRow>, Failure> {
        let [file] = self.files.as_slice() else {
            let runs = self.files.iter().map(|file| files::read(file, store::read)).collect::<Result<Vec<_>, _>>()?;
            return Ok(report::compared(&runs.iter().map(|run| &run.summary).collect::<Vec<_>>(), self.chosen()));
        };
        Ok(match files::read(file, store::content)? {
            Content::Run(run) => report::rows(&run.summary, &run.header.units, self.chosen(), None),
            Content::Calibration(stored) => calibrate_report::quantities(&stored.calibration),
            Content::Trade(trade) => trade_report::stored_rows(&trade, Statistic::name),
            Content::Sweep(stored) => sweep_report::rows(&sweep::stored(file, *stored)?, &self.statistics),
        })
    }

    fn print_csv(&self) -> Result<(), Failure> {
        if let [file] = self.files.as_slice()
            && let Ok(Some(FileKind::Calibration | FileKind::Trade)) = files::read(file, store::kind)
        {
            return print_data(&comma_separated(&self.rows()?));
        }
        let mut table = Csv::of(&self.statistics);
        for file in &self.files {
            let name = file.display().to_string();
            if is_sweep(file) {
                table.add_sweep(&name, &sweep::stored(file, files::read(file, store::read_sweep)?)?);
            } else {
                let run = files::read(file, store::read)?;
                table.add(&name, &[], run.summary.reported().copied(), &run.header.units);
            }
        }
        print_data(&table.text())
    }
}

/// A format of a table for other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum TableFormat {
    Csv,
    Markdown,
    Latex,
}

/// Whether the file holds a sweep. A file that cannot be read counts as no sweep here, because the
/// reader that comes next reports the error.
fn is_sweep(file: &Path) -> bool {
    matches!(files::read(file, store::kind), Ok(Some(FileKind::Sweep)))
}

pub(super) fn info(file: &Path, stored: &Stored, scenario: Option<&Scenario>) -> RunInfo {
    let Stored { header, status, part, ended_by, .. } = stored;
    RunInfo {
        scenario: header.title.clone(),
        provenance: header.clone(),
        part: *part,
        threads: None,
        seconds: None,
        bias_seconds: None,
        no_bias: scenario
            .and_then(|scenario| scenario.bias_plan(stored.summary.completed_paths).err())
            .map(|reason| reason.to_string()),
        period: scenario.and_then(Scenario::period),
        steps_per_path: scenario.and_then(Scenario::steps),
        file: file.display().to_string(),
        status: *status,
        ended_by: ended_by.clone(),
    }
}

fn provenance(header: &Provenance) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "written by mc {} ({})", header.program_version, header.git_hash);
    let _ = writeln!(text, "noise   {}, seed {}", header.generator, header.seed);
    let _ = writeln!(text, "blocks  of {} paths\n", header.block_size);
    let _ = writeln!(text, "scenario:");
    for line in header.scenario_text.lines() {
        let _ = writeln!(text, "{}", format!("  {line}").trim_end());
    }
    text
}
