//! Which warnings are due for a scenario, the most serious first.

use super::noise::NoisyStep;
use super::*;
use crate::advice::derived::Derived;
use crate::scenario::Scenario;
use crate::scheme::Discretisation;

impl Scenario {
    /// What the user should know before trusting the run, the most serious first.
    pub fn warnings(&self) -> Vec<Warning> {
        let derived = self.derived();
        let noisy_step = |h| NoisyStep::of(&self.model, &derived, h);
        let of_scheme = match self.scheme.discretisation() {
            Discretisation::Step { h } => [of_step(self, &derived, h), of_noise(noisy_step(h))].concat(),
            Discretisation::CorrectedStep { h } => [of_step(self, &derived, h), of_correction(noisy_step(h))].concat(),
            Discretisation::Tolerance { .. } => listed([Unresolved::due(&derived).map(Warning::from)]),
            Discretisation::Approximation => listed([
                NeverMoves::due(&self.model).map(Warning::from),
                ForcingDuringSlip::due(&self.model).map(Warning::from),
                Creep::due(&self.model).map(Warning::from),
            ]),
        };
        [of_scheme, of_question(self, &derived)].concat()
    }

    /// The warnings for a run. If the run measures the bias of the step, warnings that only give a
    /// guess of it are left out.
    pub fn warnings_of_run(&self, measures_bias: bool) -> Vec<Warning> {
        let is_guess =
            |warning: &Warning| matches!(warning, Warning::StickExitBias { .. } | Warning::CorrectedBias { .. });
        let is_due = |warning: &Warning| !(measures_bias && is_guess(warning));
        self.warnings().into_iter().filter(is_due).collect()
    }
}

/// Warnings about a step that is long for the oscillator, the forcing or the noise.
fn of_step(scenario: &Scenario, derived: &Derived, h: f64) -> Vec<Warning> {
    let temperature = &scenario.model.temperature;
    let mut warnings = listed([
        StepUnstable::due(derived, h).map(Warning::from),
        AmplitudeAboveCritical::due(derived, h, scenario.time.end).map(Warning::from),
        StepAgainstOscillator::due(derived, h).map(Warning::from),
    ]);
    let harmonics = temperature.harmonics.iter().filter_map(|harmonic| StepAgainstForcing::due(harmonic, h));
    warnings.extend(harmonics.map(Warning::from));
    warnings
        .extend(temperature.effective_noise().and_then(|noise| StepAgainstNoise::due(&noise, h)).map(Warning::from));
    warnings
}

/// Warnings about stick exits that are checked only once a step.
fn of_noise(step: Option<NoisyStep>) -> Vec<Warning> {
    let Some(step) = step else { return Vec::new() };
    listed([
        StepAgainstCorridor::due(&step).map(Warning::from),
        EqualFriction::due(&step).map(Warning::from),
        StickExitBias::due(&step).map(Warning::from),
        MicroSlips::due(&step).map(Warning::from),
    ])
}

/// Warnings about stick exits that are checked only once a step, by the scheme that corrects for
/// this.
fn of_correction(step: Option<NoisyStep>) -> Vec<Warning> {
    let Some(step) = step else { return Vec::new() };
    listed([
        LargeShift::due(&step).map(Warning::from),
        IncompleteCorrection::due(&step).map(Warning::from),
        EqualFriction::due(&step).map(Warning::from),
        CorrectedBias::due(&step).map(Warning::from),
        MicroSlips::due(&step).map(Warning::from),
    ])
}

/// Warnings that do not depend on the scheme.
fn of_question(scenario: &Scenario, derived: &Derived) -> Vec<Warning> {
    let Scenario { model, measured, ensemble, time, .. } = scenario;
    listed([
        NeverSlips::due(model).map(Warning::from),
        IdenticalPaths::due(model, ensemble.paths).map(Warning::from),
        NoDilatation::due(model).map(Warning::from),
        NoiseOverSeries::due(model).map(Warning::from),
        RepairedSeries::due(measured.as_ref()).map(Warning::from),
        FewPeriods::due(&scenario.timeline()).map(Warning::from),
        ManyPeriods::due(derived, time.end).map(Warning::from),
        NoCommonPeriod::due(&model.temperature).map(Warning::from),
        ManyRows::due(derived).map(Warning::from),
        LargeOutput::due(derived).map(Warning::from),
    ])
}

fn listed<const N: usize>(warnings: [Option<Warning>; N]) -> Vec<Warning> {
    warnings.into_iter().flatten().collect()
}
