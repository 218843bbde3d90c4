//! `mc sweep`: computes statistics as functions of keys of the scenario, or how strongly a key
//! affects them.

use crate::arguments::extension::writable_hdf5;
use crate::arguments::overrides::Overrides;
use crate::inputs::results;
use crate::output::numbers::{bytes, counted, duration, grouped, parse_share_in};
use crate::report::{self, Report};
use crate::session::sweep::SweepSession;
use crate::{Failure, Threads, print};
use std::path::PathBuf;
use stickslip::config::{Override, symbol_and_meaning};
use stickslip::scenario::Scenario;
use stickslip::stats::Statistic;
use stickslip::study::sweep::{
    Design, DesignError, RELATIVE_STEPS, Seeds, Setting, StarError, SweepAxis, SweepQuestion,
    estimated_seconds,
};
use stickslip_files::store::sweep_bytes;

/// Arguments of `mc sweep`.
#[derive(Debug, clap::Args)]
#[command(after_help = include_str!("help/sweep.txt"))]
pub struct Arguments {
    /// The scenario: a TOML file, or the name of a shipped one
    scenario: PathBuf,
    /// A key and its values, e.g. rho=temperature.noise.intensity=0:1:21 or
    /// friction.static=log:1:2:11; repeatable
    #[arg(
        long,
        value_name = "[NAME=]KEY=VALUES",
        allow_hyphen_values = true,
        required_unless_present = "elasticity"
    )]
    vary: Vec<String>,
    /// Pair the values of all --vary (first with first, and so on) instead of crossing them
    #[arg(long, requires = "vary")]
    zip: bool,
    /// Report elasticities with respect to these keys: the relative change of each statistic per
    /// relative change of the key
    #[arg(
        long,
        value_name = "KEY,KEY",
        value_delimiter = ',',
        conflicts_with = "vary"
    )]
    elasticity: Vec<String>,
    /// For --elasticity: relative change of each key, in both directions
    #[arg(long, value_name = "SHARE", default_value = "5%", value_parser = share, requires = "elasticity",
          allow_hyphen_values = true)]
    relative_step: f64,
    /// Give every point its own seed: errors of points are independent, but differences are less
    /// precise
    #[arg(long)]
    independent: bool,
    #[command(flatten)]
    overrides: Overrides,
    /// Print the number of points and paths, the time and the disk space, without simulating
    #[arg(long)]
    dry_run: bool,
    /// Statistic to print; repeatable [default: a selection; the file contains all]
    #[arg(long, value_name = "NAME", value_parser = crate::arguments::completion::STATISTIC, hide_possible_values = true)]
    statistic: Vec<Statistic>,
    /// Do not estimate the discretisation bias
    #[arg(long)]
    no_bias: bool,
    #[command(flatten)]
    threads: Threads,
    /// Output file [default: SCENARIO-sweep.h5 in the current directory]
    #[arg(short, long, value_name = "FILE.h5")]
    output: Option<PathBuf>,
    /// Overwrite the results of another run or sweep
    #[arg(long)]
    force: bool,
    /// Print nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
    /// Print only one JSON object to standard output
    #[arg(long)]
    json: bool,
}

impl Arguments {
    pub fn call(&self) -> Result<(), Failure> {
        let question = self.question()?;
        if self.dry_run {
            return print(&report::text(&outlook(&question, self.threads.number())));
        }
        let output = self
            .output
            .clone()
            .unwrap_or_else(|| results::default_output(&self.scenario, "-sweep.h5"));
        // An existing file is read first: it may contain this sweep, finished or not.
        writable_hdf5(&output, true, self.overrides.inputs(&self.scenario)?)?;
        let Arguments {
            force,
            threads,
            statistic: statistics,
            quiet,
            json,
            ..
        } = self;
        SweepSession {
            output: &output,
            force: *force,
            threads,
            statistics,
            quiet: *quiet,
            json: *json,
        }
        .simulate(question)
    }

    /// The requested sweep, with the scenario of every point checked.
    fn question(&self) -> Result<SweepQuestion, Failure> {
        let scenario = self.overrides.scenario(&self.scenario)?;
        if let Some(key) = scenario.record.curve() {
            let remedy = format!(
                "turn it off with --set {key}=false, or run each point with `mc run --set KEY=VALUE`"
            );
            return Err(Failure::usage(
                format!("{key} = true: a sweep stores statistics only, no curves"),
                remedy,
            ));
        }
        let (design, shown) = if self.elasticity.is_empty() {
            self.grid()?
        } else {
            self.star(&scenario)?
        };
        let point = |settings: &[Setting]| {
            self.overrides
                .scenario_with(&self.scenario, &overrides(settings, &shown))
        };
        let seeds = if self.independent {
            Seeds::Independent
        } else {
            Seeds::Common
        };
        SweepQuestion::at_each(design, seeds, !self.no_bias, point)
    }

    fn grid(&self) -> Result<(Design, QuotedWords), Failure> {
        let symbol = |key: &str| symbol_and_meaning(key).map(|(symbol, _)| symbol.to_string());
        let wrong = |error| Failure::Refused(format!("--vary: {error}"));
        let axes = self
            .vary
            .iter()
            .map(|text| SweepAxis::parse(text, symbol).map_err(wrong));
        let axes = axes.collect::<Result<Vec<_>, _>>()?;
        let shown = axes
            .iter()
            .zip(&self.vary)
            .map(|(axis, text)| (axis.key.clone(), format!("--vary {text}, at")));
        let shown = shown.collect();
        Ok((Design::of(axes, self.zip)?, shown))
    }

    fn star(&self, scenario: &Scenario) -> Result<(Design, QuotedWords), Failure> {
        let keys: Vec<String> = self
            .elasticity
            .iter()
            .map(|key| key.trim().to_string())
            .collect();
        let star = Design::star(&keys, self.relative_step, |key| scenario.number_at(key));
        let design = star.or_else(|(key, error)| {
            let flag = format!("--elasticity {key}");
            let remedy = match error {
                StarError::NoNumber => {
                    // The check of the scenario has the best message about an unknown key.
                    let tried = Override::flag(&format!("{flag}, tried at"), &key, "1");
                    self.overrides.scenario_with(&self.scenario, &[tried])?;
                    "`mc check` prints every key with its value".to_string()
                }
                StarError::Zero => format!("give it a value with --set, or --vary {key}=0:1:5"),
                StarError::Twice => "list it once".to_string(),
            };
            Err(Failure::usage(format!("{flag}: {error}"), remedy))
        })?;
        let keys = keys
            .iter()
            .filter_map(|key| Some((key, scenario.number_at(key)?)));
        let shown =
            keys.map(|(key, value)| (key.clone(), format!("--elasticity {key}, {value} moved to")));
        Ok((design, shown.collect()))
    }
}

/// For each key, the part of the command line that messages about its value quote.
type QuotedWords = Vec<(String, String)>;

/// These settings as changes of a scenario.
fn overrides(settings: &[Setting], quoted: &[(String, String)]) -> Vec<Override> {
    let laid = |setting: &Setting| {
        let typed = quoted
            .iter()
            .find(|(of, _)| *of == setting.key)
            .map_or(setting.key.as_str(), |(_, typed)| typed);
        setting.change(typed)
    };
    settings.iter().map(laid).collect()
}

impl From<DesignError> for Failure {
    fn from(error: DesignError) -> Self {
        let remedy = match error {
            DesignError::Name(_) => "give it a name: --vary NAME=KEY=VALUES",
            DesignError::Key(_) => "remove one of them",
            DesignError::Lengths(..) => {
                "give equal numbers of values, or remove --zip to cross them"
            }
            DesignError::Points(_) => "give fewer values",
        };
        Failure::usage(format!("--vary: {error}"), remedy)
    }
}

/// The number of points and paths, and an estimate of time and disk space.
fn outlook(question: &SweepQuestion, threads: usize) -> Report {
    let design = &question.design;
    let shape = design
        .shape()
        .iter()
        .map(usize::to_string)
        .collect::<Vec<_>>()
        .join(" x ");
    let names = design
        .axes()
        .iter()
        .map(|axis| axis.name.as_str())
        .collect::<Vec<_>>()
        .join(", ");
    let of = if names.is_empty() {
        String::new()
    } else {
        format!(" ({shape}: {names})")
    };
    let paths = question.points.iter().map(|point| point.ensemble.paths);
    let all = paths.fold(0_u64, u64::saturating_add);
    let each = report::paths_of_each(question).map_or_else(String::new, |each| each + ", ");
    let time = estimated_seconds(question, threads)
        .map_or_else(|| "an unknown time".to_string(), duration);
    let remarks = vec![
        ("points", format!("{}{of}", grouped(design.points() as u64))),
        ("paths", format!("{each}{} in all", grouped(all))),
        (
            "time",
            format!("about {time} on {}", counted(threads as u64, "thread")),
        ),
        (
            "disk",
            format!("about {}", bytes(sweep_bytes(design) as f64)),
        ),
    ];
    Report {
        remarks,
        ..Report::default()
    }
}

fn share(text: &str) -> Result<f64, String> {
    parse_share_in(
        text,
        &RELATIVE_STEPS,
        "must be between 1e-6 and 50%, e.g. 5% or 0.05",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_a_number_or_a_percentage() {
        assert_eq!(
            [share("5%"), share("0.05"), share(" 50 %")],
            [Ok(0.05), Ok(0.05), Ok(0.5)]
        );
        for text in ["", "0", "-5%", "51%", "nan", "five"] {
            assert!(share(text).is_err(), "{text}");
        }
    }
}
