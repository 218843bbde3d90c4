//! `mc run`: simulate an ensemble, write its statistics, say what came out.

use super::accuracy::{self, Chooser};
use super::ending;
use super::failure::{Failure, note, print, writable};
use super::interrupt::stop_on_ctrl_c;
use super::overrides::Overrides;
use super::progress::Progress;
use super::report::{self, RunInfo};
use super::results;
use std::path::{Path, PathBuf};
use std::time::Duration;
use stick_slip::engine::{self, EndedBy, MOST_PATHS, Outcome, Status};
use stick_slip::scenario::Scenario;
use stick_slip::scheme::Simulate as _;
use stick_slip::stats::Statistic;
use stick_slip::store::FileSink;
use stick_slip::study::accuracy::{Accuracy, Decision};

const EXAMPLES: &str = "\
Examples:
  mc run scenarios/rho025.toml --paths 10000
  mc run scenarios/rho025.toml --scheme event-driven -o exact.h5
  mc run scenarios/rho025.toml --step 0.001 -o fine.h5
  mc run scenarios/rho025.toml --set friction.static=1.3 -o stronger.h5
  mc run scenarios/rho025.toml --accuracy 1% --statistic stick_duration_mean
  mc run scenarios/rho025.toml --until 'stick_duration_mean < 0.5%' --max-time 10m
  mc run scenarios/shaw.toml --json | jq .statistics.stick_duration_mean

A path's noise depends on the seed and the number of the path alone: the result is the same for any number of threads.
`corrected` in the table is the estimate with the error of the step taken off, shown where that error exceeds its
uncertainty, +-. Where it does not, keep the estimate: to subtract `bias` would add more noise than it removes.
Ctrl-C finishes the blocks in flight and leaves a valid file; a second one stops at once.";

/// Arguments of `mc run`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Run {
    /// The scenario, a TOML file
    scenario: PathBuf,
    #[command(flatten)]
    overrides: Overrides,
    /// Choose scheme, step or tolerance, and number of paths for this relative error, e.g. 1e-2 or 1%, from a pilot of some seconds
    #[arg(long, value_name = "EPS", value_parser = accuracy::target, allow_hyphen_values = true)]
    accuracy: Option<f64>,
    /// The statistic that is to be so accurate; repeatable [default: all]
    #[arg(long, value_name = "NAME", value_parser = super::trade::statistic, requires = "accuracy")]
    statistic: Vec<Statistic>,
    /// End the run after so long: 90, 90s, 15m, 2h; the file says after which block
    #[arg(long, value_name = "TIME", value_parser = super::numbers::parse_duration, allow_hyphen_values = true)]
    max_time: Option<Duration>,
    /// Show the running estimate of this statistic and its relative error [default: that of --until or --accuracy]
    #[arg(long, value_name = "NAME", value_parser = super::trade::statistic)]
    watch: Option<Statistic>,
    /// Threads [default: one a core]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Where to write the results [default: SCENARIO.h5 in the current directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite the results of another run
    #[arg(long)]
    force: bool,
    /// Do not estimate the bias that the step gives each statistic; saves up to 15 % of the time
    #[arg(long)]
    no_bias: bool,
    /// Print nothing but warnings and errors
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
    /// Print the resolved scenario and what follows from it before the run
    #[arg(short, long)]
    verbose: bool,
}

impl Run {
    pub fn call(&self) -> Result<(), Failure> {
        let (mut scenario, goals) = self.overrides.scenario_and_goals(&self.scenario)?;
        let output = self.output.clone().unwrap_or_else(|| default_output(&self.scenario));
        self.refuse_to_lose(&output)?;
        let threads = self.threads.map_or_else(super::cores, usize::from);
        let stop = stop_on_ctrl_c();
        let mut decision = None;
        if let Some(target) = self.accuracy {
            if let Some(decided) = self.overrides.decides(&accuracy::CHOSEN) {
                let problem =
                    format!("--accuracy chooses scheme, step or tolerance, and paths; {decided} does so as well");
                return Err(Failure::usage(problem, "leave out one of them"));
            }
            if !goals.is_empty() {
                let problem = "--accuracy and a goal of --until both decide the number of paths";
                return Err(Failure::usage(problem, "leave out one of them"));
            }
            let accuracy = Accuracy { target, named: &self.statistic, max_time: self.max_time, threads };
            let chosen = Chooser { accuracy, is_quiet: self.quiet }.choose(&scenario, &stop)?;
            scenario = chosen.scenario.clone();
            decision = Some(chosen);
        }
        let is_open_ended = !goals.is_empty() && !self.overrides.gives_paths();
        let paths = if is_open_ended { MOST_PATHS } else { scenario.ensemble.paths };
        if self.verbose {
            note(&super::check::report(&scenario));
            note(&format!("kernel: {}", scenario.plan().simulation.kernel()));
        }
        results::warn(&scenario, !self.no_bias && scenario.bias_plan(paths).is_ok());

        let of_goal = || goals.first().map(|goal| goal.statistic);
        let watched =
            self.watch.or_else(of_goal).or_else(|| decision.as_ref().map(|decision| decision.choice.decisive));
        let mut progress = Progress::new(paths, self.quiet, watched);
        let mut file = FileSink::new(&output, self.force);
        let run = engine::Run::of(&scenario).paths(paths).threads(threads).until(goals).within(self.max_time);
        let run = if self.no_bias { run.without_bias() } else { run };
        let outcome = run.stopped_by(&stop).told(&mut progress).into_sink(&mut file).simulate();
        progress.finish();
        self.print(&scenario, &outcome?, &output, decision)
    }

    /// Say what came out, and how sure that is.
    fn print(
        &self,
        scenario: &Scenario,
        outcome: &Outcome,
        output: &Path,
        decision: Option<Decision>,
    ) -> Result<(), Failure> {
        let (summary, info) = (&outcome.summary, info(&self.scenario, scenario, outcome, output));
        if self.json {
            print(&report::json(summary, &info))?;
        } else if !self.quiet {
            print(&report::table(summary, &info))?;
        }
        if let Some(line) = report::lost(summary, &info).filter(|_| self.json || self.quiet) {
            note(&format!("warning: {line}"));
        }
        if let Some(line) = report::unsettled(summary).filter(|_| self.json || self.quiet) {
            note(&format!("warning: {line}"));
        }
        results::warn_of_bias(summary);
        let missed = outcome.missed.iter().map(|missed| ending::missed(missed, missed.paths_needed()));
        let broken = decision.and_then(|decision| accuracy::missed(&decision, summary.completed_paths));
        for line in missed.chain(broken) {
            note(&format!("warning: {line}"));
        }
        let failure = match &outcome.ended_by {
            Some(EndedBy::Hopeless(reason)) => Some(ending::hopeless(reason)),
            _ if outcome.is_all_lost() => Some(all_lost(scenario.scheme.step().is_some()).to_string()),
            _ => None,
        };
        match (failure, outcome.status) {
            (Some(reason), _) => Err(Failure::Run(format!("{reason}\n  what was simulated is in {}", info.file))),
            (None, Status::Complete | Status::Ended) => Ok(()),
            (None, Status::Interrupted | Status::Running) => Err(Failure::Interrupted),
        }
    }

    fn refuse_to_lose(&self, output: &Path) -> Result<(), Failure> {
        let same = |a: &Path, b: &Path| a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b));
        if same(output, &self.scenario) {
            let problem = format!("{} is the scenario itself", output.display());
            return Err(Failure::usage(problem, "choose another file for the results with -o"));
        }
        writable(output, self.force)
    }
}

/// `<scenario>.h5` in the current directory.
fn default_output(scenario: &Path) -> PathBuf {
    let mut name = scenario.file_stem().unwrap_or("run".as_ref()).to_os_string();
    name.push(".h5");
    PathBuf::from(name)
}

fn info(scenario_path: &Path, scenario: &Scenario, outcome: &Outcome, output: &Path) -> RunInfo {
    RunInfo {
        scenario: scenario_path.display().to_string(),
        title: scenario.title.clone(),
        scheme: scenario.scheme.name().to_string(),
        step: scenario.scheme.step(),
        resolution: scenario.resolution().map(|resolution| resolution.shortest_slip),
        seed: scenario.ensemble.seed,
        paths: outcome.paths,
        antithetic: scenario.ensemble.antithetic,
        threads: Some(outcome.threads),
        seconds: Some(outcome.seconds),
        bias_seconds: Some(outcome.bias.seconds),
        no_bias: outcome.bias.absence.as_ref().map(|reason| reason.to_string()),
        steps_per_path: scenario.steps(),
        file: output.display().to_string(),
        status: outcome.status,
        ended_by: outcome.ended_by.as_ref().map(EndedBy::to_string),
        units: scenario.units.clone(),
    }
}

/// What to say where no path is left.
fn all_lost(has_step: bool) -> &'static str {
    if has_step {
        "every path diverged, so there are no statistics\n  fix: a smaller step, or --scheme corrected-vi or event-driven; mc check \
         says how long a step may be"
    } else {
        "every path was given up, so there are no statistics: it takes more than 10^8 evaluations, or meets a number that is not finite\n  \
         fix: a shorter --until; or --scheme discrete-vi, whose work is its number of steps"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_named_after_the_scenario_and_stay_in_the_current_directory() {
        assert_eq!(default_output(Path::new("scenarios/rho025.toml")), Path::new("rho025.h5"));
        assert_eq!(default_output(Path::new("my.study.toml")), Path::new("my.study.h5"));
    }
}
