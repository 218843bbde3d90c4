//! One way to run a scene: a scheme with its step or its tolerance.

use crate::scenario::{Override, Scenario, ScenarioError, SchemeKind};
use std::fmt;

/// A scheme and its step, if it has steps. (A tolerance is part of the scheme.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// The scheme, with its tolerance.
    pub scheme: SchemeKind,
    /// h, for time-stepping schemes.
    pub step: Option<f64>,
}

impl Setting {
    /// The scenario, run this way; an error where `mc run` would refuse it.
    pub fn of(self, scenario: &Scenario) -> Result<Scenario, ScenarioError> {
        let mut overrides = vec![Override::flag("--scheme", "scheme.kind", self.scheme.name())];
        overrides.extend(self.step.map(|h| Override::flag("--step", "time.step", &format!("{h:?}"))));
        let tolerance = self.scheme.tolerance();
        overrides.extend(tolerance.map(|t| Override::flag("--tolerance", "scheme.tolerance", &format!("{t:?}"))));
        Scenario::parse(&scenario.title, &scenario.to_toml(), &overrides)
    }

    /// The step or the tolerance: what is made smaller for a smaller bias.
    pub fn knob(self) -> f64 {
        self.step.or(self.scheme.tolerance()).unwrap_or(f64::NAN)
    }
}

/// As on the command line of `mc run`.
impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "--scheme {}", self.scheme.name())?;
        if let Some(h) = self.step {
            write!(f, " --step {h:?}")?;
        }
        if let Some(tolerance) = self.scheme.tolerance() {
            write!(f, " --tolerance {tolerance:?}")?;
        }
        Ok(())
    }
}
