//! `mc run`: simulates an ensemble, writes its statistics and prints them.

use crate::arguments::accuracy;
use crate::arguments::extension::writable_hdf5;
use crate::arguments::overrides::Overrides;
use crate::inputs::results;
use crate::session::cost;
use crate::session::run::{RunOptions, Session};
use crate::{Failure, note, stop_on_signals};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use stickslip::engine::{self, MOST_PATHS, Part};
use stickslip::ensemble::BLOCK_SIZE;
use stickslip::scenario::Scenario;
use stickslip::scheme::Simulate as _;
use stickslip::stats::{Goal, Statistic};
use stickslip::study::accuracy::{Accuracy, Decision};
use stickslip_files::store::FileSink;

/// Arguments of `mc run`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/run.txt"))]
pub struct Arguments {
    /// The scenario: a TOML file, the name of a shipped one, or - for standard input
    scenario: PathBuf,
    #[command(flatten)]
    overrides: Overrides,
    /// Choose scheme, step or tolerance, and number of paths for this relative error, e.g. 1e-2 or
    /// 1%, after a pilot run of a few seconds
    #[arg(long, value_name = "EPS", value_parser = accuracy::target, allow_hyphen_values = true)]
    accuracy: Option<f64>,
    /// The statistic that --accuracy is for; repeatable [default: all]
    #[arg(long, value_name = "NAME", value_parser = crate::arguments::completion::STATISTIC, hide_possible_values = true, requires = "accuracy")]
    statistic: Vec<Statistic>,
    /// Limit the run time: 90, 90s, 15m, 4h50m; the file records after which block the run ended
    #[arg(long, value_name = "TIME", value_parser = crate::output::numbers::parse_duration, allow_hyphen_values = true)]
    max_time: Option<Duration>,
    /// Simulate only one part of the run, e.g. 3/16 for the third of 16; mc merge joins the parts
    #[arg(long, value_name = "I/N")]
    part: Option<Part>,
    /// Output file [default: SCENARIO.h5 in the current directory, stdin.h5 for standard input]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite the results of another run
    #[arg(long)]
    force: bool,
    /// Do not estimate the discretisation bias; saves up to an eighth of the time
    #[arg(long)]
    no_bias: bool,
    /// Print the resolved scenario and derived quantities before the run
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,
    #[command(flatten)]
    options: RunOptions,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let (mut scenario, goals) = self.overrides.scenario_and_goals(&self.scenario)?;
        let output = self
            .output
            .clone()
            .unwrap_or_else(|| results::default_output(&self.scenario, ".h5"));
        writable_hdf5(&output, self.force, self.overrides.inputs(&self.scenario)?)?;
        let threads = self.options.threads();
        let is_open_ended = !goals.is_empty() && !self.overrides.gives_paths();
        let paths_of = |scenario: &Scenario| {
            if is_open_ended {
                MOST_PATHS
            } else {
                scenario.ensemble.paths
            }
        };
        cost::check_memory(&scenario, paths_of(&scenario), threads)?;
        if self.accuracy.is_none() && !self.options.quiet {
            cost::announce(&scenario, scenario.ensemble.paths, threads);
        }
        let stop = stop_on_signals()?;
        let decision = self
            .accuracy
            .map(|target| self.decide(target, &scenario, &goals, &stop))
            .transpose()?;
        scenario = decision
            .as_ref()
            .map_or(scenario, |chosen| chosen.scenario.clone());
        self.check_part(&scenario, &goals)?;
        let paths = paths_of(&scenario);
        if self.verbose {
            note(&crate::commands::check::report(&scenario));
            note(&format!("kernel: {}", scenario.plan().simulation.kernel()));
        }
        let has_table = !self.options.json && !self.options.quiet;
        results::warn(
            &scenario,
            !self.no_bias && scenario.bias_plan(paths).is_ok(),
            has_table,
        );

        let accuracy_goal = decision.map(|decision| decision.accuracy_goal());
        let note =
            accuracy_goal.map_or_else(String::new, |accuracy_goal| accuracy_goal.to_string());
        let mut file = FileSink::new(&output, self.force).with_note(note);
        let run = engine::Run::of(&scenario)
            .paths(paths)
            .part(self.part)
            .until(goals)
            .within(self.max_time);
        let run = if self.no_bias {
            run.without_bias()
        } else {
            run
        };
        let name = self.scenario.display().to_string();
        let session = Session::of(&self.options, &scenario, &output, &stop);
        Session {
            name,
            accuracy_goal,
            ..session
        }
        .simulate(run.question(), None, &mut file)
    }

    /// Chooses how to run a scenario for this relative error.
    fn decide(
        &self,
        target: f64,
        scenario: &Scenario,
        goals: &[Goal],
        stop: &AtomicBool,
    ) -> Result<Decision, Failure> {
        let conflict = |problem: String| Err(Failure::usage(problem, "remove one of them"));
        if let Some(decided) = self.overrides.decides(&accuracy::CHOSEN) {
            return conflict(format!(
                "--accuracy chooses scheme, step or tolerance, and paths, which {decided} also sets"
            ));
        }
        if !goals.is_empty() {
            return conflict(
                "--accuracy and a goal of --until both set the number of paths".to_string(),
            );
        }
        let (threads, max_time) = (self.options.threads(), self.max_time);
        let accuracy = Accuracy {
            target,
            named: &self.statistic,
            max_time,
            threads,
        };
        accuracy::choose(&accuracy, self.options.quiet, scenario, stop)
    }

    /// Refuses options that apply only to a whole run, such as a goal, and more parts than blocks.
    fn check_part(&self, scenario: &Scenario, goals: &[Goal]) -> Result<(), Failure> {
        let Some(part) = self.part else { return Ok(()) };
        let refuse = |what: &str, why: &str, remedy: &str| {
            Err(Failure::usage(
                format!("--part {part} cannot be combined with {what}: {why}"),
                remedy,
            ))
        };
        let number = "give the number of paths of the whole run with --paths";
        if !goals.is_empty() {
            return refuse(
                "a goal of --until",
                "whether it is reached depends on all parts together",
                number,
            );
        }
        if self.accuracy.is_some() {
            let why = "each part would make its own choice";
            return refuse(
                "--accuracy",
                why,
                "choose once with `mc trade`, then give --scheme and --paths",
            );
        }
        if self.max_time.is_some() {
            let why = "a part that ends early cannot be merged with the others";
            let remedy = "let the scheduler send a signal, which saves the part; continue it with `mc resume`";
            return refuse("--max-time", why, remedy);
        }
        let blocks = scenario.ensemble.paths.div_ceil(BLOCK_SIZE);
        if part.of() > blocks {
            let problem = format!(
                "--part {part}: {} paths are {blocks} blocks of {BLOCK_SIZE}",
                scenario.ensemble.paths
            );
            return Err(Failure::usage(
                problem,
                format!("use at most {blocks} parts"),
            ));
        }
        Ok(())
    }
}
