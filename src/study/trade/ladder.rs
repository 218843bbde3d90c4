//! Which settings a scene can sensibly be run with.

use crate::advice::Warning;
use crate::scenario::Scenario;
use crate::scheme::{DEFAULT_TOLERANCE, Discretisation, Kind, Parameter, Scheme};

/// Most steps of the ladder, each half of the one before.
const MOST_STEPS: usize = 9;

/// Halvings in search of a step that is fine enough.
const MOST_HALVINGS: i32 = 60;

/// The settings to measure.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// Schemes with a step, all with the same ones.
    pub stepping: Vec<Kind>,
    /// h, h/2, h/4, ...: from the coarsest that is stable and resolves what moves.
    pub steps: Vec<f64>,
    /// Schemes without a step, each from its loosest tolerance to its tightest.
    pub free: Vec<Scheme>,
    /// What the scene rules out.
    pub left_out: Vec<LeftOut>,
}

/// Something that was not measured.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// What.
    pub what: String,
    /// Why, in words.
    pub why: String,
}

impl Ladder {
    /// For a scene; its own scheme and step do not matter, except that steps are fractions of a
    /// grid its times lie on.
    pub fn of(scenario: &Scenario) -> Self {
        let mut ladder = Ladder { stepping: Vec::new(), steps: Vec::new(), free: Vec::new(), left_out: Vec::new() };
        let mut coarsest = f64::INFINITY;
        for &scheme in Kind::ALL {
            let tried = match scheme.parameter() {
                Parameter::Step => coarsest_step(scenario, scheme).map(|step| {
                    coarsest = coarsest.min(step);
                    ladder.stepping.push(scheme);
                }),
                Parameter::Tolerance { ladder: tolerances } => suits(scenario, scheme).map(|()| {
                    // Where nothing is random the cascade is exact at any tolerance.
                    let one = [DEFAULT_TOLERANCE];
                    let tolerances = if scenario.model.temperature.is_random() { tolerances } else { &one };
                    ladder.free.extend(tolerances.iter().map(|&tolerance| scheme.with(tolerance)));
                }),
            };
            ladder.left_out.extend(tried.err().map(|why| LeftOut { what: scheme.name().into(), why }));
        }
        if !ladder.stepping.is_empty() {
            ladder.steps = (0..MOST_STEPS).map(|k| coarsest / f64::powi(2.0, k as i32)).collect();
        }
        ladder
    }
}

/// The coarsest halving of the grid at which the scheme is stable and resolves oscillator, forcing,
/// noise and corridor, as far as [`Scenario::warnings`] can tell; otherwise the last thing that
/// stood against it.
fn coarsest_step(scenario: &Scenario, scheme: Kind) -> Result<f64, String> {
    let grid = grid(scenario);
    let mut why = String::new();
    for halvings in 0..=MOST_HALVINGS {
        let step = grid / 2f64.powi(halvings);
        let candidate = match scenario.with_scheme(scheme.with(step)) {
            Ok(candidate) => candidate,
            Err(misfit) => {
                why = format!("--step {step:?}: {}", misfit.sentence());
                continue;
            }
        };
        match candidate.warnings().into_iter().find(is_against_step) {
            None => return Ok(step),
            Some(warning) => why = warning.to_string(),
        }
    }
    Err(format!("no step suits it: {why}"))
}

/// A length of which both the end and the output step are whole multiples, if they have one.
fn grid(scenario: &Scenario) -> f64 {
    let time = &scenario.time;
    match scenario.scheme.step() {
        Some(h) => gcd((time.end / h).round() as u64, (time.output_step / h).round() as u64) as f64 * h,
        None => time.output_step,
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Warnings that a smaller step takes away, and under which a scheme is not worth running. Bias is
/// not among them: it is measured.
fn is_against_step(warning: &Warning) -> bool {
    matches!(
        warning,
        Warning::StepUnstable { .. }
            | Warning::AmplitudeAboveCritical { .. }
            | Warning::StepAgainstOscillator { .. }
            | Warning::StepAgainstForcing { .. }
            | Warning::StepAgainstNoise { .. }
            | Warning::StepAgainstCorridor { .. }
            | Warning::LargeShift { .. }
    )
}

/// Whether a scheme without a step suits the scene, as far as [`Scenario::warnings`] can tell;
/// otherwise what stands against it.
fn suits(scenario: &Scenario, scheme: Kind) -> Result<(), String> {
    let scheme = scheme.with(DEFAULT_TOLERANCE);
    // A scheme that is exact but for its tolerance suits every scene, and the others are measured
    // against it.
    if is_exact(scheme) {
        return Ok(());
    }
    let candidate = scenario.with_scheme(scheme).map_err(|misfit| misfit.to_string())?;
    let against = |warning: &Warning| {
        matches!(warning, Warning::ForcingDuringSlip(_) | Warning::Creep(_) | Warning::NeverMoves(_))
    };
    match candidate.warnings().into_iter().find(against) {
        Some(warning) => Err(warning.to_string()),
        None => Ok(()),
    }
}

/// Whether the bias of a scheme is no larger than its tolerance, so that others can be measured
/// against it.
pub(super) fn is_exact(scheme: Scheme) -> bool {
    matches!(scheme.discretisation(), Discretisation::Tolerance { .. })
}
