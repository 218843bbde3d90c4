//! The command line: one file per verb, each of them parse, call, print.

mod accuracy;
mod calibrate;
mod calibrate_report;
mod check;
mod completions;
mod cost;
mod ending;
mod failure;
mod fit_temperature;
mod forecast;
mod html;
mod init;
mod interrupt;
mod measurements;
mod merge;
mod numbers;
mod overrides;
mod plot;
mod progress;
mod ranks;
mod replay;
mod report;
mod results;
mod resume;
mod run;
mod safe;
mod show;
mod sitting;
mod sweep;
mod sweep_report;
mod table;
mod terminal;
mod trade;
mod trade_report;
mod twin;
mod verify;

pub use failure::Failure;
pub use ranks::once;

use std::process::ExitCode;
use stick_slip::stats::Statistic;

/// Version and commit, as `--version` shows them.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("MC_GIT_HASH"), ")");

const EXAMPLES: &str = "\
Examples:
  mc init --from rho025 -o mine.toml        write a scenario to start from
  mc check mine.toml                        is it sound, and what will it cost?
  mc run mine.toml --paths 10000            simulate; results in mine.h5
  mc run mine.toml --accuracy 1%            choose scheme, step and paths for an error of 1 %
  mc run mine.toml --set friction.static=1.3 -o stronger.h5
  mc resume mine.h5                         continue a run that was interrupted
  mc merge part-*.h5 -o mine.h5             join the parts that mc run --part made
  mc show mine.h5                           the table again, from the file
  mc plot mine.h5                           all of it in pictures, in mine.svg
  mc report mine.h5                         a page for the browser, in mine.html
  mc replay mine.h5 --path 4711             one path alone, event by event
  mc verify mine.h5                         is the file what its scenario and seed come to?
  mc trade mine.toml                        which scheme, step and paths for which accuracy
  mc sweep mine.toml --vary friction.static=1.1:1.5:9   statistics as functions of a key
  mc calibrate bridge.toml data.csv         friction of a bearing from its temperature and displacement
  mc twin bridge.toml -o twin.csv           synthetic data of a bearing, to try that on
  mc fit-temperature data.csv -o weather.toml   a measured temperature as harmonics and noise
  mc forecast bridge.toml data.csv          what years to come do to the bearing

Exit codes: 0 done, 1 the run failed, 2 the arguments or the scenario are wrong, 130 interrupted (128 + the number of the signal).";

/// Monte Carlo of an oscillator with dry friction: when it sticks, when it slips, and how sure that is.
#[derive(Debug, clap::Parser)]
#[command(name = "mc", version = VERSION, after_help = EXAMPLES, arg_required_else_help = true)]
pub struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, clap::Subcommand)]
enum Verb {
    /// Simulate an ensemble and write its statistics
    Run(run::Run),
    /// Continue a run that was interrupted or killed
    Resume(resume::Resume),
    /// Join the parts of a run
    Merge(merge::Merge),
    /// Validate a scenario; print it in full, what follows from it, and warnings
    Check(check::Check),
    /// Print the results in a file again
    Show(show::Show),
    /// Draw a run, a path or a trade as SVG, PNG or PDF
    Plot(plot::Plot),
    /// A run as one page for a browser: table, warnings, and charts to hover over
    Report(html::Report),
    /// Rerun one path of a stored ensemble alone, keeping its events and its trajectory
    Replay(replay::Replay),
    /// Check a file against its checksum, and some of its paths against a second simulation
    Verify(verify::Verify),
    /// What accuracy costs: every scheme over a ladder of settings, and the cheapest for a target
    Trade(trade::Trade),
    /// Statistics as functions of keys of the scenario, with sharp differences; or what each key does to them
    Sweep(sweep::Sweep),
    /// Friction, stiffness and dilatation of a bearing, from measured temperatures and displacements
    Calibrate(calibrate::Calibrate),
    /// Synthetic measurements of a bearing whose truth is known, to try a calibration on
    Twin(twin::Twin),
    /// Harmonics and noise of a scenario, from a measured temperature
    FitTemperature(fit_temperature::FitTemperature),
    /// What years to come do to a measured bearing: sliding path, slips, displacements, forces
    Forecast(forecast::Forecast),
    /// Write a commented scenario to start from
    Init(init::Init),
    /// Print a completion script for a shell
    Completions(completions::Completions),
}

impl Arguments {
    /// Call the verb.
    pub fn call(&self) -> Result<(), Failure> {
        if ranks::crew().is_some() && !matches!(self.verb, Verb::Run(_) | Verb::Resume(_)) {
            let problem = "several ranks share the work of `mc run` and `mc resume`, and of no other verb";
            return Err(Failure::usage(problem, "leave out mpirun"));
        }
        match &self.verb {
            Verb::Run(run) => run.call(),
            Verb::Resume(resume) => resume.call(),
            Verb::Merge(merge) => merge.call(),
            Verb::Check(check) => check.call(),
            Verb::Show(show) => show.call(),
            Verb::Plot(plot) => plot.call(),
            Verb::Report(report) => report.call(),
            Verb::Replay(replay) => replay.call(),
            Verb::Verify(verify) => verify.call(),
            Verb::Trade(trade) => trade.call(),
            Verb::Sweep(sweep) => sweep.call(),
            Verb::Calibrate(calibrate) => calibrate.call(),
            Verb::Twin(twin) => twin.call(),
            Verb::FitTemperature(fit) => fit.call(),
            Verb::Forecast(forecast) => forecast.call(),
            Verb::Init(init) => init.call(),
            Verb::Completions(completions) => completions.call(),
        }
    }
}

/// Help, the version, or what is wrong with the arguments, which are shown as they can be.
pub fn answer(answer: &clap::Error) -> ExitCode {
    let plain = answer.to_string();
    // Colours are lost only where something would be done to the terminal.
    if safe::text(&plain) == plain {
        let _ = answer.print();
    } else {
        failure::note(plain.trim_end());
    }
    ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(2))
}

/// How many threads this process runs at once.
fn cores() -> usize {
    ranks::threads(std::thread::available_parallelism().map_or(1, usize::from))
}

/// The names of all statistics, to choose from.
fn statistic_names() -> String {
    Statistic::ALL.map(Statistic::name).join(", ")
}
