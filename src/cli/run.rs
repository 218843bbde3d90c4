//! `mc run`: simulate an ensemble, write its statistics, say what came out.

use super::accuracy::{self, Wish};
use super::ending::{Endings, Look, MOST_PATHS};
use super::failure::{Failure, note, print, writable};
use super::interrupt::stop_on_ctrl_c;
use super::overrides::Overrides;
use super::progress::Progress;
use super::report::{self, RunInfo};
use super::results;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use stick_slip::bias::NoBias;
use stick_slip::ensemble::{BLOCK_SIZE, Plan};
use stick_slip::scenario::Scenario;
use stick_slip::scheme::Simulate as _;
use stick_slip::stats::{Statistic, Summary, Totals};
use stick_slip::store::{Status, StoreError};

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

/// What the engine is asked to do.
struct Job<'a> {
    scenario: &'a Scenario,
    /// The most paths to simulate.
    paths: u64,
    endings: Endings,
    threads: usize,
    output: &'a Path,
    force: bool,
    /// Whether the bias of the step is to be estimated.
    with_bias: bool,
}

/// What it did.
struct Outcome {
    summary: Summary,
    status: Status,
    /// Seconds spent on the bias, and why there is none.
    bias: (f64, Option<NoBias>),
    ended_by: Option<String>,
    /// The goals it has missed, and what they would need.
    missed: Vec<String>,
    /// Why it is of no use.
    failure: Option<String>,
}

impl Run {
    pub fn call(&self) -> Result<(), Failure> {
        let (mut scenario, goals) = self.overrides.scenario_and_goals(&self.scenario)?;
        let output = self.output.clone().unwrap_or_else(|| default_output(&self.scenario));
        self.refuse_to_lose(&output)?;
        let threads = self.threads.map_or_else(super::cores, usize::from);
        let stop = stop_on_ctrl_c();
        let mut promise = None;
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
            let wish = Wish { target, named: &self.statistic, max_time: self.max_time, threads, is_quiet: self.quiet };
            (scenario, promise) = wish.choose(&scenario, &stop).map(|(scenario, promise)| (scenario, Some(promise)))?;
        }
        let is_open_ended = !goals.is_empty() && !self.overrides.gives_paths();
        let paths = if is_open_ended { MOST_PATHS } else { scenario.ensemble.paths };
        let endings = Endings { goals, max_time: self.max_time };
        if self.verbose {
            note(&super::check::report(&scenario));
            note(&format!("kernel: {}", scenario.plan().simulation.kernel()));
        }
        let with_bias = !self.no_bias;
        results::warn(&scenario, with_bias && scenario.bias_plan(paths).is_ok());
        let job = Job { scenario: &scenario, paths, endings, threads, output: &output, force: self.force, with_bias };
        let start = Instant::now();
        let mut progress = Progress::new(paths, self.quiet);
        let outcome = execute(&job, &stop, &mut progress);
        progress.finish();
        let Outcome { summary, status, bias, ended_by, missed, failure } = outcome?;

        let info = RunInfo { ended_by, ..info(&self.scenario, &job, status, start.elapsed().as_secs_f64(), bias) };
        if self.json {
            print(&report::json(&summary, &info))?;
        } else if !self.quiet {
            print(&report::table(&summary, &info))?;
        }
        if let Some(line) = report::lost(&summary, &info).filter(|_| self.json || self.quiet) {
            note(&format!("warning: {line}"));
        }
        results::warn_of_bias(&summary);
        let kept = promise.and_then(|promise| promise.missed(summary.completed_paths));
        for line in missed.into_iter().chain(kept) {
            note(&format!("warning: {line}"));
        }
        match (failure, status) {
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

fn info(
    scenario_path: &Path,
    job: &Job<'_>,
    status: Status,
    seconds: f64,
    (bias_seconds, no_bias): (f64, Option<NoBias>),
) -> RunInfo {
    let Scenario { title, scheme, ensemble, units, .. } = job.scenario;
    RunInfo {
        scenario: scenario_path.display().to_string(),
        title: title.clone(),
        scheme: scheme.name().to_string(),
        step: scheme.step(),
        resolution: job.scenario.resolution().map(|resolution| resolution.shortest_slip),
        seed: ensemble.seed,
        paths: job.paths,
        threads: Some(job.threads),
        seconds: Some(seconds),
        bias_seconds: Some(bias_seconds),
        no_bias: no_bias.map(|reason| reason.to_string()),
        steps_per_path: job.scenario.steps(),
        file: job.output.display().to_string(),
        status,
        ended_by: None,
        units: units.clone(),
    }
}

/// Simulate, write the file, sum up. `progress` is told the paths done so far, once a block; when `stop` is raised, the
/// blocks in flight are finished and the outcome is interrupted.
fn execute(job: &Job<'_>, stop: &AtomicBool, progress: &mut Progress) -> Result<Outcome, Failure> {
    let plan = Plan { paths: job.paths, ..job.scenario.plan() };
    let mut writer = results::create(job.scenario, job.paths, job.output, job.force)?;
    let mut totals = Totals::empty(plan.model(), plan.timeline());
    let (start, mut ending) = (Instant::now(), Look::GoOn(None));
    let completed = plan.run_into(job.threads, stop, |block| {
        totals.merge(&block.totals);
        writer.append(&block)?;
        let done = block.first_path + block.paths;
        ending = job.endings.look(done.div_ceil(BLOCK_SIZE), &totals, start);
        progress.update(done);
        Ok::<_, StoreError>(match ending {
            Look::GoOn(needed) => {
                progress.expect(needed.unwrap_or(plan.paths).min(plan.paths));
                ControlFlow::Continue(())
            }
            Look::Done(_) | Look::Hopeless(_) => ControlFlow::Break(()),
        })
    })?;
    let mut summary = totals.summary();
    let (status, ended_by, failure) = match ending {
        Look::Done(reason) => (Status::Ended, Some(reason), None),
        Look::Hopeless(reason) => (Status::Ended, Some("a goal that cannot be reached".to_string()), Some(reason)),
        Look::GoOn(_) if completed == plan.paths => (Status::Complete, None, None),
        Look::GoOn(_) => (Status::Interrupted, None, None),
    };
    let start = Instant::now();
    let no_bias = if job.with_bias { add_bias(job, completed, stop, progress, &mut summary).err() } else { None };
    let bias = (start.elapsed().as_secs_f64(), no_bias);
    if let Some(reason) = &ended_by {
        writer.ended_by(reason)?;
    }
    writer.finish(&summary, status)?;
    let is_done = failure.is_none() && status != Status::Interrupted;
    let missed = if is_done { job.endings.missed(&totals, completed) } else { Vec::new() };
    let failure = failure.or_else(|| all_lost(&summary, job.scenario.scheme.step().is_some()));
    Ok(Outcome { summary, status, bias, ended_by, missed, failure })
}

/// Estimate the bias of the step from some of the paths that the run came to, and add it to the summary.
fn add_bias(
    job: &Job<'_>,
    paths: u64,
    stop: &AtomicBool,
    progress: &mut Progress,
    summary: &mut Summary,
) -> Result<(), NoBias> {
    let plan = job.scenario.bias_plan(paths)?;
    progress.conclude("estimating the bias of the step");
    let biases = plan.estimate(summary, job.threads, stop)?;
    summary.set_biases(&biases);
    Ok(())
}

/// What to say where no path is left.
fn all_lost(summary: &Summary, has_step: bool) -> Option<String> {
    let lost = summary.diverged.len() as u64;
    let message = if has_step {
        "every path diverged, so there are no statistics\n  fix: a smaller step, or --scheme corrected-vi or event-driven; mc check \
         says how long a step may be"
    } else {
        "every path was given up, so there are no statistics: it takes more than 10^8 evaluations, or meets a number that is not finite\n  \
         fix: a shorter --until; or --scheme discrete-vi, whose work is its number of steps"
    };
    (lost > 0 && lost == summary.completed_paths).then(|| message.to_string())
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
