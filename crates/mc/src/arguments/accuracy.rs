//! `mc run --accuracy`: asks `study::accuracy` to choose scheme, step or tolerance, and number of
//! paths, and prints what was chosen and why.

use crate::output::failure::{Failure, note};
use crate::output::numbers::{grouped, parse_share_in, percent, significant, time, wrapped};
use crate::report::without_answer;
use crate::session::progress::measuring;
use std::sync::atomic::{AtomicBool, Ordering};
use stickslip::scenario::Scenario;
use stickslip::study::accuracy::{
    Accuracy, AccuracyError, AccuracyGoal, Alternative, Decision, FEWEST_PATHS, PILOT, TARGETS,
};
use stickslip::study::trade::{Choice, Standing, Trade, TradeError};

/// The keys of a scenario whose values are chosen.
pub const CHOSEN: [&str; 5] = [
    "ensemble.antithetic",
    "ensemble.paths",
    "scheme.kind",
    "scheme.tolerance",
    "time.step",
];

/// A run for all statistics that takes longer than this, in seconds, is announced, with a way to
/// shorten it.
const NOTABLE: f64 = 20.0;

/// Chooses how to run the scenario and prints the choice with its reasons, unless only errors are
/// printed. Returns `Failure::Interrupted` if `stop` is raised in the meantime.
pub fn choose(
    accuracy: &Accuracy,
    is_quiet: bool,
    scenario: &Scenario,
    stop: &AtomicBool,
) -> Result<Decision, Failure> {
    let say = |sentence: &str| {
        if !is_quiet {
            note(wrapped(sentence, "  ").trim_end());
        }
    };
    say(&format!(
        "pilot run of about {} s to choose scheme, step and paths",
        PILOT.as_secs()
    ));
    let chosen = measuring(PILOT, is_quiet, stop, |limits| {
        accuracy.choose(scenario, limits)
    });
    if stop.load(Ordering::Relaxed) {
        note("interrupted during the pilot run: nothing was written");
        return Err(Failure::Interrupted);
    }
    let (decision, trade) = chosen.map_err(failure)?;
    explanation(accuracy, scenario, &trade, &decision)
        .iter()
        .for_each(|sentence| say(sentence));
    Ok(decision)
}

/// What was chosen and why, in sentences.
fn explanation(
    accuracy: &Accuracy,
    scenario: &Scenario,
    trade: &Trade,
    decision: &Decision,
) -> Vec<String> {
    let Accuracy {
        target,
        named,
        threads,
        ..
    } = *accuracy;
    let (asked, choice) = (&decision.asked, &decision.choice);
    let of = match named {
        [] => format!("{} statistics", asked.len()),
        named => named
            .iter()
            .map(|statistic| statistic.name())
            .collect::<Vec<_>>()
            .join(" and "),
    };
    let mut said = vec![
        format!(
            "chosen for a relative error of {} of {of}:",
            percent(target)
        ),
        format!(
            "  --scheme {} --paths {}{}",
            // The parameter has the name of its option.
            choice.scheme.to_string().replacen(' ', " --", 1),
            choice.paths,
            pairs(choice)
        ),
        reason(choice),
    ];
    if choice.paths > 1 {
        said.push("the error is a root mean square; a 95 % interval extends about twice this to each side".into());
    }
    for &statistic in asked.iter() {
        if let Standing::Deviation(deviation) = trade.standing(statistic) {
            let unit = statistic.dimension().label(&scenario.units);
            said.push(format!(
                "{} is zero within its error in the pilot run: {} refers to its standard deviation per path \
                instead, an error of {} {unit}",
                statistic.name(),
                percent(target),
                significant(target * deviation, 2),
            ));
        }
    }
    if named.is_empty() {
        let seconds = choice.seconds / threads as f64;
        if seconds > NOTABLE {
            said.push(format!(
                "{} alone decides the cost, about {} here; select statistics with --statistic to \
                shorten the run, or bound it with --max-time; Ctrl-C saves it",
                choice.decisive.name(),
                time(seconds)
            ));
        }
        let without = without_answer(trade).into_iter();
        said.extend(
            without.map(|(names, standing)| {
                format!("no accuracy is guaranteed for {names}: {standing}")
            }),
        );
    }
    said
}

/// Why scheme, step and paths were chosen.
fn reason(choice: &Choice) -> String {
    let decisive = choice.decisive.name();
    let cost = time(choice.seconds);
    let bias = percent(choice.bias);
    let paths = match choice.paths {
        1 => "the scenario is deterministic, so one path is enough".into(),
        FEWEST_PATHS => format!("intervals need at least {FEWEST_PATHS} paths"),
        _ => format!("{decisive} needs the most paths"),
    };
    let mut why = format!(
        "the cheapest run found, about {cost} of CPU time; {paths}; the bias of {decisive} is at most {bias}"
    );
    if !choice.is_measured {
        why += ", extrapolated from coarser steps: this step itself was not measured";
    }
    why
}

/// Says why nothing was chosen, and what to ask for instead.
fn failure(error: AccuracyError) -> Failure {
    let problem = format!("--accuracy: {error}");
    let remedy = match error {
        AccuracyError::Pilot(TradeError::BudgetTooSmall { .. }) => {
            return Failure::run(
                problem,
                "choose --scheme and --paths yourself, or measure longer with mc \
                trade --budget",
            );
        }
        AccuracyError::Pilot(error) => return error.into(),
        AccuracyError::CheckError(error) => return error.into(),
        AccuracyError::NoAnswer { .. } => {
            "choose another one with --statistic, or increase `time.end`".into()
        }
        AccuracyError::Unasked { .. } => {
            "give the distances, e.g. `--set 'statistics.levels=[3.0]'`".into()
        }
        AccuracyError::NothingToChoose => "remove --accuracy; mc trade gives details".into(),
        AccuracyError::OutOfReach { instead, .. } | AccuracyError::TooLong { instead, .. } => {
            alternative(instead)
        }
    };
    Failure::usage(problem, remedy)
}

/// The part of a command line that asks for antithetic pairs; empty where the choice has none.
pub fn pairs(choice: &Choice) -> &'static str {
    if choice.is_antithetic {
        " --set ensemble.antithetic=true"
    } else {
        ""
    }
}

/// The message of a run that ended after `completed` paths, before it had the accuracy that it was
/// chosen for. None if this number of paths is enough.
pub fn missed(accuracy_goal: &AccuracyGoal, completed: u64) -> Option<String> {
    let AccuracyGoal {
        target,
        paths,
        decisive,
        ..
    } = accuracy_goal;
    accuracy_goal.error_after(completed).map(|error| {
        format!(
            "the relative error of {} was not reached: {} of {} paths give about {} of {}",
            percent(*target),
            grouped(completed),
            grouped(*paths),
            percent(error),
            decisive.name()
        )
    })
}

/// The remedy: the accuracy that is within reach, if there is one.
fn alternative(instead: Option<Alternative>) -> String {
    match instead {
        Some(Alternative { target, seconds }) => format!(
            "use --accuracy {}, which takes about {}; mc trade gives details",
            percent(target).replace(' ', ""),
            time(seconds)
        ),
        None => "allow more time with --max-time, or select fewer statistics with --statistic; mc trade gives \
            details"
            .into(),
    }
}

/// Reads a relative error, e.g. `1e-2` or `1%`.
pub fn target(text: &str) -> Result<f64, String> {
    parse_share_in(
        text,
        &TARGETS,
        "write a relative error from 1e-6 to 0.5, e.g. 1e-2 or 1%",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_a_share_or_a_percentage() {
        assert_eq!(
            (target("1e-2"), target("0.5%"), target(" 10 % ")),
            (Ok(0.01), Ok(0.005), Ok(0.1))
        );
        for text in ["", "0", "-1%", "60%", "1e-7", "nan", "one"] {
            assert!(target(text).is_err(), "{text}");
        }
    }
}
