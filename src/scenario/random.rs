//! Checks of inputs that are drawn anew for each path.

use super::Scenario;
use crate::ensemble::drawn;
use crate::model::{Force, PulseShape, RandomProcess, Sign};
use crate::scheme::CheckError;
use stickslip_text::numbers::short;

/// The most samples, switches or pulses of an input on one path.
const MOST_SAMPLES: f64 = 1e7;

impl Scenario {
    /// The scenario whose model has the realisations of one path of the ensemble, and no random
    /// inputs.
    pub(crate) fn of_path(&self, path: u64) -> Scenario {
        let mut of_path = self.clone();
        let (seed, path) = (
            self.ensemble.seed,
            drawn(&[path], self.ensemble.antithetic)[0],
        );
        let (end, step) = (self.time.end, self.scheme.step());
        let realisations = self.model.realisations(seed, path, end, step);
        of_path.model = self.model.with_inputs(&realisations);
        #[cfg(feature = "toml")]
        {
            of_path.written.realised = realisations;
        }
        of_path
    }

    /// The scenario whose model has the realisations of the first path for its random inputs.
    #[cfg(feature = "toml")]
    pub(crate) fn with_first_path(self) -> Self {
        if self.model.random.is_empty() || self.check_random().is_some() {
            return self;
        }
        let mut first = self.of_path(0);
        first.model.random = self.model.random;
        first
    }

    /// Why these inputs cannot be drawn, or not be used as they are.
    pub(crate) fn check_random(&self) -> Option<CheckError> {
        self.model.random.iter().find_map(|input| {
            let (name, end) = (&input.name, self.time.end);
            let count = match &input.process {
                RandomProcess::Telegraph { rates, .. } => end * rates[0].max(rates[1]),
                RandomProcess::Shot { rate, shape, .. } => match shape {
                    PulseShape::Decay(_) => end * rate + end / input.step,
                    _ => end * rate,
                },
                RandomProcess::Own(_) => 0.0,
                _ => end / input.step,
            };
            if count > MOST_SAMPLES {
                let problem = format!(
                    "`{name}` has about {} samples until `time.end`, more than {MOST_SAMPLES:e}",
                    short(count)
                );
                let remedy = "increase its step, lower its rate, or shorten the run";
                return Some(CheckError::new(&[], problem, remedy));
            }
            if let RandomProcess::Own(own) = &input.process
                && let Some(found) = own.0.count()
                && self.ensemble.paths > found
            {
                let problem = format!(
                    "`{name}` has {found} realisations, fewer than `ensemble.paths` = {}",
                    self.ensemble.paths
                );
                let remedy = "give a file with a column for each path, lower `ensemble.paths`, or write `reuse = true`";
                return Some(CheckError::new(&[], problem, remedy));
            }
            let is_misused = input.process.is_kicks() && !self.adds_kicks(name);
            is_misused.then(|| {
                let problem = format!(
                    "`{name}` consists of kicks, impulses of no duration, and is not added to a force"
                );
                let remedy = "add it to `force.expression`, at most times a number, as in `-k*x^3 + 2*NAME`; \
                              or use `shape = \"rectangle\"`";
                CheckError::new(&[], problem, remedy)
            })
        })
    }

    /// Whether kicks are a force, or a temperature, and nothing else.
    fn adds_kicks(&self, name: &str) -> bool {
        let Some(name) = name.strip_prefix("input.") else {
            return true;
        };
        let Some(force) = &self.model.force else {
            return false;
        };
        let (own, load) = match force.sides() {
            None => (force, None),
            Some(sides) => (sides.own(Sign::Positive), sides.load()),
        };
        let load = load.and_then(Force::expression);
        let is_in_load = load.is_some_and(|load| load.uses_input(name));
        let own = own.expression();
        own.is_some_and(|own| own.adds_input(name)) && !is_in_load
    }
}
