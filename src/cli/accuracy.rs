//! `mc run --accuracy`: from an error that is good enough to the scheme, its step or tolerance, and the number of paths.

use super::failure::{Failure, note};
use super::numbers::{duration, grouped, significant, wrapped};
use std::time::Duration;
use stick_slip::scenario::Scenario;
use stick_slip::stats::Statistic;
use stick_slip::trade;

/// How long the pilot may take.
const PILOT: Duration = Duration::from_secs(8);

/// The scenario run the cheapest way that makes the relative root mean square error of each statistic `target`; of all that a run can
/// answer, if none is named. Says what it chose and why.
pub fn choose(scenario: &Scenario, target: f64, named: &[Statistic], threads: usize) -> Result<Scenario, Failure> {
    note(&format!("choosing how to run it: measuring for about {} s", PILOT.as_secs()));
    let trade = trade::measure_within(scenario, PILOT, threads)?;
    if let Some(statistic) = named.iter().find(|statistic| trade.standing(**statistic).scale().is_none()) {
        let why = format!("--accuracy: {}: {}", statistic.name(), trade.standing(*statistic));
        return Err(Failure::usage(why, "name another one with --statistic"));
    }
    let asked = if named.is_empty() { trade.answerable() } else { named.to_vec() };
    if asked.is_empty() {
        return Err(Failure::usage("--accuracy: no statistic of this scene can be answered", "mc trade says why"));
    }
    let percent = significant(100.0 * target, 3);
    let choice = trade.best(None, &asked, target).map_err(|refusal| {
        Failure::usage(
            format!("--accuracy: {percent} % cannot be promised: {refusal}"),
            "ask for less; mc trade says more",
        )
    })?;
    let mut chosen = choice.setting.of(scenario)?;
    chosen.ensemble.paths = choice.paths;
    let of = if named.is_empty() { format!("all {} statistics", asked.len()) } else { names(named) };
    let reason = format!(
        "chosen for a relative error of {percent} % of {of}: {} --paths {} (about {} of CPU). It is the cheapest of what was measured; {} \
         asks for {} paths, and its bias is at most {} % there{}",
        choice.setting,
        choice.paths,
        duration(choice.seconds),
        choice.decisive.name(),
        grouped(choice.paths),
        significant(100.0 * choice.bias, 2),
        if choice.is_measured { "" } else { ", by the law of the coarser steps" },
    );
    note(wrapped(&reason, "  ").trim_end());
    for statistic in asked.iter().filter(|s| matches!(trade.standing(**s), trade::Standing::Deviation(_))) {
        note(&format!("{}: {}", statistic.name(), trade.standing(*statistic)));
    }
    Ok(chosen)
}

fn names(statistics: &[Statistic]) -> String {
    statistics.iter().map(|statistic| statistic.name()).collect::<Vec<_>>().join(" and ")
}

/// A target as it is typed: 1e-2 or 1%.
pub fn target(text: &str) -> Result<f64, String> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text.trim(), 1.0), |percent| (percent.trim(), 0.01));
    let target = number.parse::<f64>().map(|number| number * unit).unwrap_or(f64::NAN);
    if (1e-6..=0.5).contains(&target) {
        Ok(target)
    } else {
        Err("write a relative error from 1e-6 to 0.5, e.g. 1e-2 or 1%".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_a_share_or_a_percentage() {
        assert_eq!((target("1e-2"), target("0.5%"), target(" 10 % ")), (Ok(0.01), Ok(0.005), Ok(0.1)));
        for text in ["", "0", "-1%", "60%", "1e-7", "nan", "one"] {
            assert!(target(text).is_err(), "{text}");
        }
    }
}
