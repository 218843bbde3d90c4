//! The flags that change a scenario; each is a key of it by another name.

use std::path::Path;
use stick_slip::scenario::{Override, Scenario, ScenarioError};

/// Flags shared by every verb that reads a scenario.
#[derive(Debug, Default, clap::Args)]
pub struct Overrides {
    // Strings here, numbers there: the scenario's own check has the better messages.
    /// Number of paths [ensemble.paths]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    paths: Option<String>,
    /// Seed; with the number of a path, determines its noise [ensemble.seed]
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    seed: Option<String>,
    /// Scheme: discrete-vi, corrected-vi, event-driven or quasi-static [scheme.kind]
    #[arg(long, value_name = "KIND", allow_hyphen_values = true)]
    scheme: Option<String>,
    /// Relative error that discretisation may leave; event-driven and quasi-static schemes [scheme.tolerance]
    #[arg(long, value_name = "TOL", allow_hyphen_values = true)]
    tolerance: Option<String>,
    /// Time step h; discrete-vi and corrected-vi schemes [time.step]
    #[arg(long, value_name = "H", allow_hyphen_values = true)]
    step: Option<String>,
    /// End of the simulation [time.end]
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    until: Option<String>,
    /// Any key of the scenario, e.g. friction.static=1.3 or temperature.harmonics.0.amplitude=2; repeatable
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
}

impl Overrides {
    /// Read a scenario with the flags laid over it: `--set` in order, then the flags with names of their own.
    pub fn scenario(&self, path: &Path) -> Result<Scenario, ScenarioError> {
        Scenario::read(path, &self.list()?)
    }

    fn list(&self) -> Result<Vec<Override>, ScenarioError> {
        let mut list = self.set.iter().map(|text| Override::set(text)).collect::<Result<Vec<_>, _>>()?;
        let named = [
            ("--paths", "ensemble.paths", &self.paths),
            ("--seed", "ensemble.seed", &self.seed),
            ("--scheme", "scheme.kind", &self.scheme),
            ("--tolerance", "scheme.tolerance", &self.tolerance),
            ("--step", "time.step", &self.step),
            ("--until", "time.end", &self.until),
        ];
        for (flag, key, value) in named {
            list.extend(value.iter().map(|value| Override::flag(flag, key, value)));
        }
        Ok(list)
    }
}
