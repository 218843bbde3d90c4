//! The remarks below the table: censored sticks, how the run ended, lost paths, time and file.

use super::RunInfo;
use crate::output::numbers::{Digits, counted, duration, grouped, significant, some_of};
use stickslip::engine::{Program, Provenance, Status};
use stickslip::stats::{
    Dimension, Estimate, LimitCycle, Statistic, SubPhaseCounts, Summary, Transient,
};

/// The lines below the table, with labels: everything, or only what nobody must miss and where to
/// find the rest.
pub fn remarks(summary: &Summary, info: &RunInfo, all: bool) -> Vec<(&'static str, String)> {
    let rest = |line: Option<String>| line.filter(|_| all);
    let file = if all || info.file == RunInfo::NO_FILE {
        info.file.clone()
    } else {
        format!("{0}; details: `mc show {0} --all --notes`", info.file)
    };
    let Provenance {
        program:
            Program {
                version,
                git_hash,
                generator,
                block_size,
            },
        seed,
        ..
    } = &info.provenance;
    let lines = [
        ("sticks", rest(Some(sticks(summary)))),
        ("", rest(multiples(summary))),
        ("slips", rest(Some(slips(summary)))),
        ("", rest(long_slips(summary))),
        (
            "cycle",
            summary.cycle.as_ref().map(|cycle| of_cycle(cycle, info)),
        ),
        ("start", rest(start(summary, info))),
        ("drift", unsettled(summary)),
        ("bias", bias(summary, info, all)),
        ("few", too_few(summary)),
        ("paths", Some(paths(summary, info))),
        (info.loss(), lost(summary, info)),
        ("time", rest(time(summary, info))),
        ("file", Some(file)),
        ("program", rest(Some(format!("mc {version} ({git_hash})")))),
        ("noise", rest(Some(format!("{generator}, seed {seed}")))),
        ("blocks", rest(Some(format!("of {block_size} paths")))),
    ];
    lines
        .into_iter()
        .filter_map(|(label, line)| Some((label, line?)))
        .collect()
}

fn sticks(summary: &Summary) -> String {
    let sticks = &summary.stick_durations;
    format!(
        "{} ended, {} still running (censored); first sticks {} and {}",
        grouped(sticks.completed),
        grouped(sticks.censored),
        grouped(summary.first_sticks.completed),
        grouped(summary.first_sticks.censored)
    )
}

/// Notes that stick durations are multiples of the step, so the interval of their median may have
/// no width.
fn multiples(summary: &Summary) -> Option<String> {
    let sticks = &summary.stick_durations;
    let step = sticks.step.filter(|_| sticks.completed > 0)?;
    Some(format!(
        "durations are multiples of the step, {step:?}, and so is the median"
    ))
}

fn slips(summary: &Summary) -> String {
    let SubPhaseCounts {
        counts, censored, ..
    } = &summary.sub_phases;
    format!(
        "{} ended, {} still running (censored)",
        grouped(counts.iter().sum()),
        grouped(*censored)
    )
}

/// Censored slips are not mentioned below this share of all slips.
const SMALL_SHARE: f64 = 0.02;

/// Notes that many slips are still running at the end. These are mostly long ones, so the
/// statistics of completed slips are biased.
fn long_slips(summary: &Summary) -> Option<String> {
    let SubPhaseCounts {
        counts, censored, ..
    } = &summary.sub_phases;
    let completed: u64 = counts.iter().sum();
    let share = *censored as f64 / (completed + censored) as f64;
    (share > SMALL_SHARE)
        .then(|| "sub_phases_* and jump_* include only completed slips; increase `time.end`".into())
}

fn with_unit(number: String, dimension: Dimension, info: &RunInfo) -> String {
    format!("{number} {}", dimension.label(&info.provenance.units))
        .trim_end()
        .to_string()
}

/// Describes the long-term motion of a scenario without noise.
fn of_cycle(cycle: &LimitCycle, info: &RunInfo) -> String {
    let number = |x: f64, dimension| with_unit(significant(x, 8), dimension, info);
    let amplitude = number(cycle.amplitude, Dimension::LENGTH);
    let Some(repeats) = &cycle.repeats else {
        return match cycle.amplitude {
            0.0 => "at the end, x minus its drift is constant".to_string(),
            _ => format!(
                "no state recurs within the counted time; x minus its drift has amplitude {amplitude}"
            ),
        };
    };
    let period = number(repeats.period, Dimension::TIME);
    let name = match repeats.forcing_periods {
        Some(n) => format!(
            "period-{n}: the motion repeats after {period}, {}",
            counted(n as u64, "period P")
        ),
        None => format!(
            "the motion repeats after {period}, {}",
            counted(repeats.slips as u64, "slip")
        ),
    };
    let advance = match repeats.advance {
        0.0 => String::new(),
        advance => format!(", {} further", number(advance, Dimension::LENGTH)),
    };
    let symmetry = match (repeats.is_symmetric, repeats.advance == 0.0) {
        (true, _) => ", symmetric",
        (false, true) => ", not symmetric",
        (false, false) => "",
    };
    let rest = match repeats.sticks {
        0 => "no stick".to_string(),
        n => {
            format!(
                "{}, {} % of the time at rest",
                counted(n as u64, "stick"),
                significant(100.0 * repeats.at_rest, 4)
            )
        }
    };
    format!("{name}{advance}; amplitude {amplitude}{symmetry}; {rest}")
}

/// Describes what the statistics exclude because it happened before the counted time.
fn start(summary: &Summary, info: &RunInfo) -> Option<String> {
    let Transient {
        end,
        sticks,
        slips,
        displacement,
        ..
    } = summary.transient?;
    let digits = Digits::of(displacement.estimate, displacement.standard_error);
    Some(format!(
        "excluded: phases that began before t = {} ({} sticks, {} slips); until then the mean displacement \
            was {} (std. error {})",
        with_unit(format!("{end:?}"), Dimension::TIME, info),
        grouped(sticks),
        grouped(slips),
        with_unit(digits.show(displacement.estimate), Dimension::LENGTH, info),
        digits.show(displacement.standard_error),
    ))
}

/// What may mislead a reader of the statistics: the names of warnings, and their sentences.
pub fn found(summary: &Summary) -> Vec<(String, String)> {
    let all = [
        (
            "dominating-bias",
            beyond_intervals(summary).map(|words| format!("bias {words}")),
        ),
        ("unsettled", unsettled(summary)),
        ("too-few-events", too_few(summary)),
    ];
    all.into_iter()
        .filter_map(|(name, text)| Some((name.to_string(), text?)))
        .collect()
}

/// Notes that the motion has not settled, in which case the drift is a transient.
fn unsettled(summary: &Summary) -> Option<String> {
    let limit = |statistic| match statistic {
        Statistic::DriftVelocity => summary.periods.drift_limit.unwrap_or(0.0),
        _ => 0.0,
    };
    let words = |statistic: Statistic| {
        format!(
            "{} ({} in the long run)",
            statistic.name(),
            limit(statistic)
        )
    };
    let off: Vec<String> = summary.unsettled()?.into_iter().map(words).collect();
    (!off.is_empty()).then(|| {
        format!(
            "x has not settled: {} {} significantly from this limit (level 1 %); increase \
             `statistics.after` to exclude more of the start",
            off.join(" and "),
            if off.len() == 1 { "differs" } else { "differ" },
        )
    })
}

/// States how large the bias is and what its columns mean, or why there are none.
fn bias(summary: &Summary, info: &RunInfo, all: bool) -> Option<String> {
    if summary.has_bias() {
        let meaning = "+- at 95 %; `corrected` subtracts it where it exceeds +-";
        let words =
            beyond_intervals(summary).unwrap_or("of the step".into()) + &uncertain_biases(summary);
        return Some(if all {
            format!("{words}; {meaning}")
        } else {
            words
        });
    }
    info.no_bias
        .as_ref()
        .map(|reason| format!("not estimated: {reason}"))
}

/// Lists the statistics without a bias although others have one.
fn uncertain_biases(summary: &Summary) -> String {
    let is_without = |e: &&Estimate| e.estimate.is_finite() && e.low < e.high && e.bias.is_none();
    let names: Vec<&str> = summary
        .reported()
        .filter(is_without)
        .map(|e| e.statistic.name())
        .collect();
    if names.is_empty() {
        names.concat()
    } else {
        format!("; too uncertain to be stated for {}", some_of(&names))
    }
}

/// States for how many statistics the bias of the step is certain and exceeds the statistical
/// interval, and what to do. None if there is no such statistic.
fn beyond_intervals(summary: &Summary) -> Option<String> {
    let dominated = summary.dominated_by_bias();
    (!dominated.is_empty()).then(|| {
        format!(
            "of the step exceeds the interval for {} of {} statistics; `event-driven` has none",
            dominated.len(),
            summary.asked.len(),
        )
    })
}

/// Lists the numbers without an interval, because too few paths determine them.
fn too_few(summary: &Summary) -> Option<String> {
    let is_without =
        |e: &&Estimate| e.estimate.is_finite() && e.standard_error.is_finite() && e.low.is_nan();
    let names: Vec<&str> = summary
        .estimates
        .iter()
        .filter(is_without)
        .map(|e| e.statistic.name())
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "too few paths determine {}, so it has no interval; run more paths",
            some_of(&names)
        )
    })
}

/// The number of paths, and how the run ended.
fn paths(summary: &Summary, info: &RunInfo) -> String {
    let completed = grouped(summary.completed_paths);
    // Lost paths, which another line reports, are not completed.
    let done = if summary.diverged.is_empty() {
        "completed"
    } else {
        "simulated"
    };
    let of_all = format!("{completed} of {} {done}", grouped(info.provenance.paths));
    match info.status {
        Status::Complete => {
            of_all
                + &info
                    .seconds
                    .map_or_else(String::new, |seconds| format!(" in {}", duration(seconds)))
        }
        Status::Ended => format!(
            "{completed} {done}; ended by {}",
            info.ended_by.as_deref().unwrap_or("request")
        ),
        Status::Part => {
            format!(
                "{of_all}: part {} of the run",
                info.part.map_or_else(String::new, |part| part.to_string())
            )
        }
        Status::Interrupted => format!("{of_all}: the run was interrupted"),
        Status::Running => format!("{of_all}: the run is not finished"),
    }
}

/// How long the run took, if known.
fn time(summary: &Summary, info: &RunInfo) -> Option<String> {
    let parts = [
        info.threads
            .map(|threads| format!(" on {}", counted(threads as u64, "thread"))),
        info.us_per_path(summary.completed_paths)
            .map(|us| format!(", {} us a path", significant(us, 3))),
        info.ns_per_path_step(summary.completed_paths)
            .map(|ns| format!(", {} ns per path-step", significant(ns, 3))),
        info.bias_seconds
            .filter(|_| summary.has_bias())
            .map(|seconds| format!(", including {} s for the bias", significant(seconds, 2))),
    ];
    Some(duration(info.seconds?) + &parts.into_iter().flatten().collect::<String>())
}

/// The maximum number of lost paths listed in a table. The file contains all of them.
const LISTED_PATHS: usize = 10;

/// The number of paths that diverged or were given up, and the first of their path numbers; none if
/// no path was lost.
pub fn lost(summary: &Summary, info: &RunInfo) -> Option<String> {
    let n = summary.diverged.len();
    let numbers: Vec<String> = summary
        .diverged
        .iter()
        .take(LISTED_PATHS)
        .map(u64::to_string)
        .collect();
    let more = if n > LISTED_PATHS { ", ..." } else { "" };
    (n > 0).then(|| {
        let (paths, loss) = (counted(n as u64, "path"), info.loss());
        let why = if info.provenance.step.is_some() {
            ""
        } else {
            "; mc replay shows why"
        };
        format!(
            "{paths} {loss}, excluded from all statistics: number {}{more}{why}",
            numbers.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::sample_tests::table;
    use super::super::sample_tests::{info, info_in, set, summary};
    use super::*;
    use stickslip::scenario::Units;
    use stickslip::stats::{Bias, Statistic, Transient};
    use stickslip::sums::Measurement;

    /// A text without its line breaks.
    fn unbroken(text: &str) -> String {
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn the_table_says_how_long_and_where() {
        let short = remarks(&summary(), &info(), false);
        assert_eq!(
            short.iter().map(|(label, _)| *label).collect::<Vec<_>>(),
            ["drift", "paths", "file"]
        );
        let table = table(&summary(), &info());
        assert!(
            table.contains("0.60 s on 2 threads, 60 us a path, 10 ns per path-step"),
            "{table}"
        );
        assert!(
            table.contains("rho025.h5") && table.contains("812 still running (censored)"),
            "{table}"
        );
    }

    #[test]
    fn numbers_without_an_interval_are_named() {
        let mut summary = summary();
        assert!(!table(&summary, &info()).contains("too few"));
        for statistic in [Statistic::StickDurationSd, Statistic::StickDurationMean] {
            let e = &mut summary.estimates[statistic.index()];
            (e.estimate, e.standard_error, e.low, e.high) = (1.0, 0.5, f64::NAN, f64::NAN);
        }
        let line = "too few paths determine stick_duration_mean, stick_duration_sd";
        assert_eq!(
            too_few(&summary).map(|text| text.starts_with(line)),
            Some(true),
            "{:?}",
            too_few(&summary)
        );
        // A single path has no errors at all, and another line says so.
        summary
            .estimates
            .iter_mut()
            .for_each(|e| e.standard_error = f64::NAN);
        assert_eq!(too_few(&summary), None);
    }

    #[test]
    fn a_median_of_multiples_of_the_step_is_explained() {
        let mut summary = summary();
        let line = "durations are multiples of the step, 0.01, and so is the median";
        assert!(!table(&summary, &info()).contains("multiples"));
        summary.stick_durations.step = Some(0.01);
        assert!(
            table(&summary, &info()).contains(line),
            "{}",
            table(&summary, &info())
        );
        summary.stick_durations.completed = 0;
        assert!(!table(&summary, &info()).contains("multiples"));
    }

    #[test]
    fn many_slips_that_have_not_ended_are_mentioned() {
        let mut summary = summary();
        let line = "sub_phases_* and jump_* include only completed slips";
        summary.sub_phases.counts = vec![900, 80];
        for (censored, is_mentioned) in [(19, false), (21, true)] {
            summary.sub_phases.censored = censored;
            let reported = table(&summary, &info());
            assert!(reported.contains(&format!(
                "slips   980 ended, {censored} still running (censored)"
            )));
            assert_eq!(reported.contains(line), is_mentioned, "{reported}");
        }
        summary.sub_phases = SubPhaseCounts {
            counts: vec![0; 2],
            censored: 0,
            ..summary.sub_phases
        };
        assert!(!table(&summary, &info()).contains(line));
    }

    #[test]
    fn what_a_burn_in_leaves_out_is_told() {
        let mut summary = summary();
        assert!(!table(&summary, &info()).contains("excluded"));
        let displacement = Measurement {
            estimate: -1.25,
            standard_error: 0.05,
            low: -1.35,
            high: -1.15,
        };
        let transient = Transient {
            end: 25.5,
            sticks: 31_000,
            slips: 42_000,
            displacement,
        };
        summary.transient = Some(transient);
        let units = Units {
            time: "s".into(),
            length: "mm".into(),
            ..Units::default()
        };
        let line = "start   excluded: phases that began before t = 25.5 s (31 000 sticks, 42 000 slips); until then the mean \
                    displacement was -1.250 mm (std. error 0.050)";
        let reported = table(&summary, &info_in(units));
        assert!(unbroken(&reported).contains(&unbroken(line)), "{reported}");
    }

    #[test]
    fn a_drift_of_a_motion_that_has_not_settled_is_said_to_be_one() {
        let mut summary = summary();
        let reported = |summary: &Summary| unbroken(&table(summary, &info()));
        summary.periods.time = vec![25.1, 50.3, 75.4, 100.5];
        // Both estimates are 1 +- 0.01.
        let line = "drift   x has not settled: drift_velocity (0 in the long run) and diffusion_coefficient (0 in the long run) differ";
        assert!(
            reported(&summary).contains(&unbroken(line)),
            "{}",
            reported(&summary)
        );
        let put = |summary: &mut Summary, statistic: Statistic, estimate: f64| {
            summary.estimates[statistic.index()].estimate = estimate;
        };
        // The 99.75 % quantile of the normal distribution is 2.807.
        put(&mut summary, Statistic::DriftVelocity, -0.0281);
        put(&mut summary, Statistic::DiffusionCoefficient, 0.028);
        assert!(
            reported(&summary)
                .contains("has not settled: drift_velocity (0 in the long run) differs"),
            "{}",
            reported(&summary)
        );
        put(&mut summary, Statistic::DriftVelocity, 0.028);
        assert!(
            !reported(&summary).contains("settled"),
            "{}",
            reported(&summary)
        );
    }

    #[test]
    fn diverged_paths_are_counted_and_named() {
        let mut summary = summary();
        summary.diverged = (0..12).map(|i| 4711 + i).collect();
        let table = table(&summary, &info());
        assert!(
            table.contains("12 paths diverged, excluded from all statistics: number 4711, 4712"),
            "{table}"
        );
        assert!(
            table.contains("4720, ...") && !table.contains("4721"),
            "{table}"
        );
        summary.diverged = (0..10_000).collect();
        set(&mut summary, Statistic::DisplacementEndMean, f64::NAN);
        assert!(
            super::super::sample_tests::table(&summary, &info()).contains("every path diverged")
        );
        let without_step = RunInfo {
            provenance: Provenance {
                step: None,
                ..info().provenance
            },
            ..info()
        };
        let table = super::super::sample_tests::table(&summary, &without_step);
        assert!(
            table.contains("10 000 paths given up, excluded from all statistics")
                && !table.contains("paths diverged"),
            "{table}"
        );
    }

    #[test]
    fn a_bias_beyond_the_interval_is_told() {
        let bias = |estimate, uncertainty| {
            Some(Bias {
                estimate,
                uncertainty,
                order: None,
            })
        };
        let mut summary = summary();
        assert_eq!(beyond_intervals(&summary), None);
        // The half-widths of the intervals of the sample are 0.00052, 0.0143 and 0.0314.
        summary.estimates[0].bias = bias(0.0005, 0.0001);
        assert_eq!(beyond_intervals(&summary), None, "within the interval");
        summary.estimates[0].bias = bias(0.0955, 0.1);
        assert_eq!(beyond_intervals(&summary), None, "in doubt");
        summary.estimates[0].bias = bias(0.0955, 0.0311);
        summary.estimates[1].bias = bias(0.5, 0.1);
        let line = beyond_intervals(&summary).expect("two are dominated");
        assert!(
            line.contains("exceeds the interval for 2 of 21 statistics"),
            "{line}"
        );
    }
}
