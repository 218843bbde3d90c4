//! Warnings about a scenario before it is run.
//!
//! A warning is one row of the list below: its name, its class, and the function that returns it if
//! it applies. The functions are in files by subject.

mod case;
mod file;
mod force;
mod noise;
mod noisy_step;
mod quasi_static;
mod question;
mod series;
mod slip;
mod steepness;
mod step;

use crate::scenario::Scenario;
use case::Case;
use std::fmt;

/// A warning about the results of a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    name: &'static str,
    class: Class,
    text: String,
}

/// What a warning is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Paths may grow without bound, because the step is too long.
    Growth,
    /// The step is too long for something that happens in it.
    LongStep,
    /// A rough estimate of the bias of the step, which a run may measure.
    Bias,
    /// The quasi-static recursion leaves out something that matters.
    Approximation,
    /// Anything else.
    Other,
}

/// One warning of the list.
struct WarningRow {
    name: &'static str,
    class: Class,
    says: Says,
}

/// The sentences of a warning for a case.
enum Says {
    Once(fn(&Case) -> Option<String>),
    /// One sentence per affected item.
    Each(fn(&Case) -> Vec<String>),
}

const fn row(name: &'static str, class: Class, says: fn(&Case) -> Option<String>) -> WarningRow {
    WarningRow {
        name,
        class,
        says: Says::Once(says),
    }
}

const fn rows(name: &'static str, class: Class, says: fn(&Case) -> Vec<String>) -> WarningRow {
    WarningRow {
        name,
        class,
        says: Says::Each(says),
    }
}

/// All warnings, the most serious first.
const ALL: &[WarningRow] = &[
    row("step-unstable", Class::Growth, step::unstable),
    row(
        "amplitude-above-critical",
        Class::Growth,
        step::amplitude_above_critical,
    ),
    row("runs-away", Class::Growth, step::runs_away),
    row(
        "step-against-oscillator",
        Class::LongStep,
        step::against_oscillator,
    ),
    rows(
        "step-against-forcing",
        Class::LongStep,
        step::against_forcing,
    ),
    row("step-against-noise", Class::LongStep, step::against_noise),
    row(
        "step-against-stick-band",
        Class::LongStep,
        noise::against_stick_band,
    ),
    row("large-shift", Class::LongStep, noise::large_shift),
    row(
        "incomplete-correction",
        Class::Other,
        noise::incomplete_correction,
    ),
    row("equal-friction", Class::Other, noise::equal_friction),
    row("stick-exit-bias", Class::Bias, noise::stick_exit_bias),
    row("corrected-bias", Class::Bias, noise::corrected_bias),
    rows("coarse-process", Class::Other, series::coarse_process),
    rows("process-repeats", Class::Other, series::repeats),
    row("white-noise", Class::Other, noise::white),
    row("micro-slips", Class::Other, noise::micro_slips),
    row("resolution", Class::Other, noise::unresolved),
    row(
        "never-moves",
        Class::Approximation,
        quasi_static::never_moves,
    ),
    row(
        "forcing-during-slip",
        Class::Approximation,
        quasi_static::forcing_during_slip,
    ),
    row("creep", Class::Approximation, quasi_static::creep),
    rows("doubtful-force", Class::Other, force::force_warning),
    row("friction-jumps", Class::Other, force::friction_jumps),
    row("stiff-damping", Class::Other, force::stiff_damping),
    row("never-slips", Class::Other, question::never_slips),
    row("identical-paths", Class::Other, question::identical_paths),
    row("no-dilatation", Class::Other, question::no_dilatation),
    row("weather-twice", Class::Other, series::noise_over_series),
    rows("repaired-series", Class::Other, series::repaired_series),
    row("few-periods", Class::Other, question::few_periods),
    row("many-periods", Class::Other, question::many_periods),
    row("no-common-period", Class::Other, question::no_common_period),
    row("many-rows", Class::Other, file::many_rows),
    row("large-output", Class::Other, file::large_output),
];

impl Warning {
    /// The names of all warnings.
    pub fn names() -> impl Iterator<Item = &'static str> {
        ALL.iter().map(|row| row.name)
    }

    /// The name of the warning, for programs.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What the warning is about.
    pub fn class(&self) -> Class {
        self.class
    }
}

/// The warning in a sentence or two, for people.
impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Scenario {
    /// The warnings about this scenario, the most serious first.
    pub fn warnings(&self) -> Vec<Warning> {
        let case = Case::new(self);
        let of_row = |&WarningRow {
                          name,
                          class,
                          ref says,
                      }: &WarningRow| {
            let texts = match says {
                Says::Once(says) => says(&case).into_iter().collect(),
                Says::Each(says) => says(&case),
            };
            texts
                .into_iter()
                .map(move |text| Warning { name, class, text })
        };
        ALL.iter().flat_map(of_row).collect()
    }

    /// The warnings for a run. If the run measures the bias of the step, warnings that only
    /// estimate it roughly are left out.
    pub fn warnings_of_run(&self, measures_bias: bool) -> Vec<Warning> {
        let is_due = |warning: &Warning| !(measures_bias && warning.class == Class::Bias);
        self.warnings().into_iter().filter(is_due).collect()
    }
}
