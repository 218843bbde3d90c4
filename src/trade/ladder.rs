//! Which settings a scene can sensibly be run with.

use super::Setting;
use crate::scenario::{Scenario, SchemeKind, Time, Warning};

/// Most steps of the ladder, each half of the one before.
const MOST_STEPS: usize = 9;

/// Halvings in search of a step that is fine enough.
const MOST_HALVINGS: i32 = 60;

/// Tolerances of the event-driven scheme, the tightest last.
const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// The settings to measure.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// Time-stepping schemes, all with the same steps.
    pub stepping: Vec<SchemeKind>,
    /// h, h/2, h/4, ...: from the coarsest that is stable and resolves what moves.
    pub steps: Vec<f64>,
    /// Schemes without a step: event-driven from the loosest tolerance to the tightest, then quasi-static.
    pub free: Vec<SchemeKind>,
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
    /// For a scene; its own scheme and step do not matter, except that steps are fractions of a grid its times lie on.
    pub fn of(scenario: &Scenario) -> Self {
        let mut ladder = Ladder { stepping: Vec::new(), steps: Vec::new(), free: Vec::new(), left_out: Vec::new() };
        let mut coarsest = f64::INFINITY;
        for scheme in [SchemeKind::DiscreteVi, SchemeKind::CorrectedVi] {
            match coarsest_step(scenario, scheme) {
                Ok(step) => {
                    coarsest = coarsest.min(step);
                    ladder.stepping.push(scheme);
                }
                Err(why) => ladder.left_out.push(LeftOut { what: scheme.name().into(), why }),
            }
        }
        if !ladder.stepping.is_empty() {
            ladder.steps = (0..MOST_STEPS).map(|k| coarsest / f64::powi(2.0, k as i32)).collect();
        }
        // Where nothing is random the cascade is exact at any tolerance.
        let tolerances = if scenario.model.temperature.is_random() { &TOLERANCES[..] } else { &TOLERANCES[1..2] };
        ladder.free.extend(tolerances.iter().map(|&tolerance| SchemeKind::EventDriven { tolerance }));
        match quasi_static(scenario) {
            Ok(scheme) => ladder.free.push(scheme),
            Err(why) => ladder.left_out.push(LeftOut { what: "quasi-static".into(), why }),
        }
        ladder
    }
}

/// The coarsest halving of the grid at which the scheme is stable and resolves oscillator, forcing, noise and corridor, as far as
/// [`Scenario::warnings`] can tell; otherwise the last thing that stood against it.
fn coarsest_step(scenario: &Scenario, scheme: SchemeKind) -> Result<f64, String> {
    let grid = grid(&scenario.time);
    let mut why = String::new();
    for halvings in 0..=MOST_HALVINGS {
        let step = grid / 2f64.powi(halvings);
        let candidate = match (Setting { scheme, step: Some(step) }).of(scenario) {
            Ok(candidate) => candidate,
            Err(error) => {
                why = error.to_string().lines().next().unwrap_or_default().to_string();
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
fn grid(time: &Time) -> f64 {
    match time.step {
        Some(h) => gcd((time.end / h).round() as u64, (time.output_step / h).round() as u64) as f64 * h,
        None => time.output_step,
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Warnings that a smaller step takes away, and under which a scheme is not worth running. Bias is not among them: it is measured.
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

/// The quasi-static recursion, where the forcing is slow enough for it.
fn quasi_static(scenario: &Scenario) -> Result<SchemeKind, String> {
    let setting = Setting { scheme: SchemeKind::ALL[3], step: None };
    let candidate = setting.of(scenario).map_err(|error| error.to_string())?;
    let against = |warning: &Warning| {
        matches!(warning, Warning::ForcingDuringSlip { .. } | Warning::Creep { .. } | Warning::NeverMoves)
    };
    match candidate.warnings().into_iter().find(against) {
        Some(warning) => Err(warning.to_string()),
        None => Ok(setting.scheme),
    }
}
