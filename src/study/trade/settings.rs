//! The settings with which a scenario can sensibly be run.

use crate::advice::{Class, Warning};
use crate::scenario::Scenario;
use crate::scheme::{DEFAULT_TOLERANCE, Discretisation, Kind, Parameter, Scheme};

/// Largest number of steps in the grid; each is half of the one before.
const MOST_STEPS: usize = 9;

/// Largest number of halvings in the search for a step that is fine enough.
const MOST_HALVINGS: i32 = 60;

/// The settings to measure.
#[derive(Clone, Debug)]
pub struct SettingGrid {
    /// Schemes with a step, which are all run with the same steps.
    pub stepping: Vec<Kind>,
    /// The steps h, h/2, h/4, ..., from the coarsest one that is stable and resolves all time
    /// scales.
    pub steps: Vec<f64>,
    /// Schemes without a step, each from its loosest to its tightest tolerance.
    pub free: Vec<Scheme>,
    /// Settings excluded by the scenario.
    pub left_out: Vec<LeftOut>,
}

/// Something that is not measured.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Its name.
    pub what: String,
    /// The reason, in words.
    pub why: String,
}

impl SettingGrid {
    /// The grid of a scenario. Its own scheme and step do not matter, except that steps are
    /// fractions of a grid on which its times lie.
    pub fn of(scenario: &Scenario) -> Self {
        let mut grid = SettingGrid {
            stepping: Vec::new(),
            steps: Vec::new(),
            free: Vec::new(),
            left_out: Vec::new(),
        };
        let mut coarsest = f64::INFINITY;
        for &scheme in Kind::ALL {
            let tried = match scheme.parameter() {
                Parameter::Step => coarsest_step(scenario, scheme).map(|step| {
                    coarsest = coarsest.min(step);
                    grid.stepping.push(scheme);
                }),
                Parameter::Tolerance { grid: tolerances } => suits(scenario, scheme).map(|()| {
                    // Without noise the cascade is exact at any tolerance, so one tolerance is
                    // enough.
                    let one = [DEFAULT_TOLERANCE];
                    let tolerances = if scenario.model.is_random() {
                        tolerances
                    } else {
                        &one
                    };
                    grid.free
                        .extend(tolerances.iter().map(|&tolerance| scheme.with(tolerance)));
                }),
            };
            grid.left_out.extend(tried.err().map(|why| LeftOut {
                what: scheme.name().into(),
                why,
            }));
        }
        if !grid.stepping.is_empty() {
            grid.steps = (0..MOST_STEPS)
                .map(|k| coarsest / f64::powi(2.0, k as i32))
                .collect();
        }
        grid
    }
}

/// The coarsest step, found by halving the grid, at which the scheme is stable and resolves
/// oscillator, forcing, noise and band, as far as [`Scenario::warnings`] can judge. If there is
/// none, the error is the last reason against a step.
fn coarsest_step(scenario: &Scenario, scheme: Kind) -> Result<f64, String> {
    let grid = grid(scenario);
    let mut why = String::new();
    for halvings in 0..=MOST_HALVINGS {
        let step = grid / 2f64.powi(halvings);
        let candidate = match scenario.with_scheme(scheme.with(step)) {
            Ok(candidate) => candidate,
            Err(check_error) => {
                why = format!("step {step:?}: {}", check_error.sentence());
                continue;
            }
        };
        match candidate.warnings().into_iter().find(is_against_step) {
            None => return Ok(step),
            Some(warning) => why = warning.to_string(),
        }
    }
    Err(format!("no suitable step: {why}"))
}

/// A time of which both the end and the output step are whole multiples, if there is one.
fn grid(scenario: &Scenario) -> f64 {
    let time = &scenario.time;
    match scenario.scheme.step() {
        Some(h) => {
            gcd(
                (time.end / h).round() as u64,
                (time.output_step / h).round() as u64,
            ) as f64
                * h
        }
        None => time.output_step,
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Whether a warning means that a scheme should not be run at its step, and that a smaller step
/// would help. Warnings of bias are not among these, because the bias is measured.
fn is_against_step(warning: &Warning) -> bool {
    matches!(warning.class(), Class::Growth | Class::LongStep)
}

/// Check that a scheme without a step suits the scenario, as far as [`Scenario::warnings`] can
/// judge; the error is the reason why it does not.
fn suits(scenario: &Scenario, scheme: Kind) -> Result<(), String> {
    let scheme = scheme.with(DEFAULT_TOLERANCE);
    // A scheme that is exact up to its tolerance suits every scenario, and the others are measured
    // against it.
    if is_exact(scheme) {
        return Ok(());
    }
    let candidate = scenario
        .with_scheme(scheme)
        .map_err(|check_error| check_error.to_string())?;
    let against = |warning: &Warning| warning.class() == Class::Approximation;
    match candidate.warnings().into_iter().find(against) {
        Some(warning) => Err(warning.to_string()),
        None => Ok(()),
    }
}

/// Whether the bias of a scheme is at most its tolerance, so that other schemes can be measured
/// against it.
pub(super) fn is_exact(scheme: Scheme) -> bool {
    matches!(scheme.discretisation(), Discretisation::Tolerance { .. })
}
