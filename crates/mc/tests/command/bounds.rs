//! Whatever memory, threads and measurements the command gets, it ends: with a result, or with one
//! message and the exit code 1 or 2. It is never aborted, and never runs for ever.

use crate::command::{self, hundred_days, shell, text, within};
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::Output;
use std::time::Duration;
use stickslip::engine::{Run, RunError};
use stickslip::ensemble::ThreadsError;
use stickslip::scenario::Scenario;

const SCENARIOS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios");
const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/bridge");

/// How long a verb may take on a busy machine. A search that does not end takes minutes.
const LIMIT: Duration = Duration::from_secs(60);

/// The verb ended by itself, with a result or with exactly one error.
#[track_caller]
fn assert_ends(output: &Output, what: &str) -> bool {
    let said = text(&output.stderr);
    let errors = said
        .lines()
        .filter(|line| line.starts_with("error: "))
        .count();
    match output.status.code() {
        Some(0) => assert_eq!(errors, 0, "{what}: {said}"),
        Some(1 | 2) => assert!(errors == 1 && said.contains("fix: "), "{what}: {said}"),
        code => panic!("{what}: {code:?} {said}"),
    }
    output.status.success()
}

/// The libraries of the program alone take 60 MB of addresses, so a smaller limit is not a matter
/// of this program.
fn grid(megabytes: &[u64], threads: &[u64]) {
    let here = tempfile::tempdir().expect("a folder");
    let data = hundred_days(here.path());
    let (mut done, mut refused) = (0, 0);
    for mb in megabytes {
        for threads in threads {
            for run in [
                format!(
                    "run {SCENARIOS}/rho025.toml --paths 3000 --threads {threads} --quiet --force -o a.h5"
                ),
                format!(
                    "run {SCENARIOS}/rho025.toml --paths 3000 --scheme event-driven --set record.trajectories=3000 \
                     --set record.events=true --no-bias --threads {threads} --quiet --force -o b.h5"
                ),
                format!("calibrate {EXAMPLE}/bridge.toml {data} --starts 1 --threads {threads}"),
            ] {
                let output = shell(
                    here.path(),
                    &format!("ulimit -v {}; exec \"$0\" {run}", mb * 1000),
                );
                match assert_ends(&output, &format!("{mb} MB: {run}")) {
                    true => done += 1,
                    false => refused += 1,
                }
            }
        }
    }
    assert!(done > 0 && refused > 0, "{done} done, {refused} refused");
}

#[test]
fn with_any_memory_a_verb_succeeds_or_says_what_is_missing() {
    grid(&[80, 120, 250, 500, 4000], &[1, 2, 1024]);
}

/// Last result: not run as it stands; a script with 63 commands of this kind gave 17 results and 46
/// refusals.
#[test]
#[ignore = "takes minutes"]
fn low_memory_and_few_threads_are_reported_or_enough() {
    grid(
        &[80, 100, 120, 150, 200, 250, 300, 400, 600, 1000, 1500, 3000],
        &[1, 2, 4, 16, 64],
    );
}

#[test]
fn a_number_of_threads_that_cannot_be_is_an_error() {
    let scenario = Scenario {
        ..Scenario::shipped("rho025").expect("shipped")
    };
    for threads in [0, 1025, 1 << 63, usize::MAX] {
        let error = Run::of(&scenario)
            .paths(10)
            .threads(threads)
            .simulate()
            .expect_err("refused");
        assert!(
            matches!(error, RunError::Threads(ThreadsError::OutOfRange(said)) if said == threads),
            "{error}"
        );
        assert!(error.to_string().contains("between 1 and 1024"), "{error}");
    }
}

/// Temperatures over 300 hours, one of which or all of which are absurd, and what must be said.
fn hostile() -> Vec<(&'static str, Vec<f64>, Option<&'static str>)> {
    let usual = |i: usize| 15.0 + 8.0 * (TAU * i as f64 / 24.0).cos() + 0.1 * ((i * i) % 17) as f64;
    let with = |at: usize, value: f64| {
        (0..300)
            .map(|i| if i == at { value } else { usual(i) })
            .collect::<Vec<_>>()
    };
    let all = |of: &dyn Fn(usize) -> f64| (0..300).map(of).collect::<Vec<_>>();
    vec![
        ("one of 1e308", with(140, 1e308), Some("data.csv:142:")),
        ("one of -1e308", with(140, -1e308), Some("data.csv:142:")),
        ("the first of 1e200", with(0, 1e200), Some("data.csv:2:")),
        ("one of 1e16", with(299, 1e16), Some("data.csv:301:")),
        ("one of 1e14", with(140, 1e14), None),
        ("one of 1e5", with(140, 1e5), None),
        (
            "all equal",
            vec![15.0; 300],
            Some("the same in all samples"),
        ),
        ("all zero", vec![0.0; 300], Some("the same in all samples")),
        (
            "all equal but one",
            all(&|i| if i == 7 { 15.1 } else { 15.0 }),
            None,
        ),
        (
            "all subnormal",
            all(&|i| 5e-324 * (i % 2) as f64),
            Some("the same in all samples"),
        ),
        ("two values in turn", all(&|i| (i % 2) as f64), None),
        ("a straight line", all(&|i| i as f64), None),
        (
            "all within 1e-200",
            all(&|i| 1e-200 * usual(i)),
            Some("the same in all samples"),
        ),
        (
            "a pure cosine",
            all(&|i| (TAU * i as f64 / 24.0).cos()),
            None,
        ),
        ("from 0 to 1e14", all(&|i| 1e14 * i as f64 / 300.0), None),
        ("a step", all(&|i| if i < 150 { 0.0 } else { 1e14 }), None),
    ]
}

fn csv(folder: &Path, temperatures: &[f64]) {
    let mut text = "time,temperature_degC,displacement_mm\n".to_string();
    for (i, temperature) in temperatures.iter().enumerate() {
        let moved = 1.5 * (i as f64 / 9.0).cos().round();
        text += &format!(
            "2015-08-{:02}T{:02}:00:00Z,{temperature:e},{moved}\n",
            13 + i / 24,
            i % 24
        );
    }
    fs::write(folder.join("data.csv"), text).expect("room");
}

#[test]
fn a_fit_of_any_series_ends() {
    let here = tempfile::tempdir().expect("a folder");
    let bridge = format!("{EXAMPLE}/bridge.toml");
    for (name, temperatures, says) in hostile() {
        csv(here.path(), &temperatures);
        for verb in [
            &["fit-temperature", "data.csv", "--periods", "1d"][..],
            &[
                "calibrate",
                &bridge,
                "data.csv",
                "--method=both",
                "--starts=2",
            ],
            &[
                "forecast", &bridge, "data.csv", "--draws", "2", "--years", "2",
            ],
        ] {
            let output = within(LIMIT, here.path(), verb);
            let is_done = assert_ends(&output, &format!("{name}: {verb:?}"));
            let said = text(&output.stderr);
            let is_named = says
                .is_none_or(|says| !is_done && said.contains(says) && said.contains("data.csv"));
            assert!(is_named, "{name}: {verb:?}: {said}");
        }
    }
}

/// Times are refused like values; the reader knows the line.
#[test]
fn a_fit_of_any_times_ends() {
    let here = tempfile::tempdir().expect("a folder");
    for (last, says) in [
        ("1e308", Some("data.csv:302:")),
        ("1e17", Some("data.csv:302:")),
        ("1e14", None),
    ] {
        let rows: String = (0..300)
            .map(|i| format!("{},{}\n", 600 * i, (i * i) % 17))
            .collect();
        fs::write(
            here.path().join("data.csv"),
            format!("time_s,temperature\n{rows}{last},3\n"),
        )
        .expect("room");
        let output = within(
            LIMIT,
            here.path(),
            &[
                "fit-temperature",
                "data.csv",
                "--time",
                "time_s",
                "--periods",
                "none",
            ],
        );
        assert_ends(&output, last);
        let said = text(&output.stderr);
        assert!(
            says.is_none_or(|says| said.contains(says) && said.contains("too large for a time")),
            "{said}"
        );
    }
}

/// A title and units that would end an attribute of either kind of quotation marks, or an element.
const FORGED: &str = "'onmouseover='alert(1)' \"onload=\"x\" </title><script>&";

#[test]
fn no_text_of_a_scenario_becomes_markup() {
    let here = tempfile::tempdir().expect("a folder");
    let scenario = fs::read_to_string(format!("{SCENARIOS}/rho025.toml")).expect("shipped");
    let rest: Vec<&str> = scenario
        .lines()
        .filter(|line| !line.starts_with("title"))
        .collect();
    let (kept, _) = rest
        .iter()
        .position(|line| line.trim() == "[units]")
        .map_or((&rest[..], &[][..]), |at| rest.split_at(at));
    let quoted = toml::Value::from(FORGED).to_string();
    let text_of = format!(
        "title = {quoted}\n{}\n[units]\ntime = {quoted}\nlength = {quoted}\n",
        kept.join("\n")
    );
    fs::write(here.path().join("s.toml"), text_of).expect("room");
    command::done(
        here.path(),
        &["run", "s.toml", "--paths", "300", "--quiet", "-o", "a.h5"],
    );
    command::done(here.path(), &["plot", "a.h5", "-o", "a.svg"]);
    command::done(here.path(), &["report", "a.h5", "-o", "a.html"]);
    for name in ["a.svg", "a.html"] {
        let page = fs::read_to_string(here.path().join(name)).expect("written");
        assert!(
            page.contains(
                "&#39;onmouseover=&#39;alert(1)&#39; &quot;onload=&quot;x&quot; &lt;/title&gt;"
            ),
            "{name}"
        );
        // The numbers of a page are JSON in an element of their own, where quotation marks are its
        // own escapes.
        let outside = page
            .split("<script")
            .map(|part| part.split_once("</script>").map_or(part, |(_, rest)| rest));
        let outside: String = outside.collect();
        assert!(
            !outside.contains("'onmouseover") && !outside.contains("\"onload"),
            "{name}"
        );
        assert!(!page.contains("</title><script>&"), "{name}");
    }
}
