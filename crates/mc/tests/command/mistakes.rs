//! What a user sees after a typical mistake. `cargo test --release --test command mistakes:: --
//! --nocapture` prints all answers, for reading.
//!
//! Each answer names the cause, the place and the remedy, in lines that fit a terminal. Nothing is
//! written. The exit code is 2, or 1 if some work had begun.

use crate::command;
use std::path::Path;

/// The words of a command line, and what its answer must contain.
struct Mistake {
    line: &'static str,
    says: &'static [&'static str],
}

const fn mistake(line: &'static str, says: &'static [&'static str]) -> Mistake {
    Mistake { line, says }
}

/// `scene.toml` is a copy of the shipped rho025, `done.h5` is a run of it, and [`desk`] makes the
/// other files. Words that belong together are joined by `~`.
const MISTAKES: &[Mistake] = &[
    // Mistakes in the verb.
    mistake(
        "scene.toml",
        &["scene.toml", "mc run scene.toml", "mc check scene.toml"],
    ),
    mistake(
        "done.h5",
        &["done.h5", "mc show done.h5", "mc plot done.h5"],
    ),
    mistake("rum scene.toml", &["'rum'", "'run'"]),
    mistake("run", &["SCENARIO", "--help"]),
    mistake("rho025", &["a shipped scenario", "mc run rho025"]),
    mistake("list", &["'list'", "--help"]),
    mistake(
        "run scene.toml --rho 0.3",
        &[
            "unknown option `--rho`",
            "--set temperature.noise.intensity=...",
        ],
    ),
    mistake(
        "run scene.toml -n 1000",
        &["unknown option `-n`", "`--set ensemble.paths=...`"],
    ),
    mistake(
        "run scene.toml --h 0.1",
        &["unknown option `--h`", "`--set time.step=...`"],
    ),
    mistake(
        "show done.h5 --latex",
        &["unknown option `--latex`", "--help"],
    ),
    mistake(
        "plot done.h5 --only survival",
        &["'survival'", "`sticks.B`"],
    ),
    mistake(
        "show done.h5 --zebra",
        &["unknown option `--zebra`", "--help"],
    ),
    mistake(
        "run scene.toml other.toml",
        &["'other.toml'", "Usage: mc run"],
    ),
    mistake("run scene.toml --path 10", &["'--path'", "'--paths'"]),
    mistake(
        "show done.h5 --cite --json",
        &["'--cite'", "'--json'", "cannot be used with"],
    ),
    mistake(
        "run scene.toml -o r.csv",
        &["-o r.csv", "HDF5", "-o r.h5", "mc show r.h5 --format csv"],
    ),
    mistake(
        "replay done.h5 --path 1 -o r.csv",
        &["-o r.csv", "mc show r.h5 --format csv"],
    ),
    mistake(
        "report done.h5 -o r.pdf",
        &["-o r.pdf", "an HTML page", "mc plot done.h5 -o r.pdf"],
    ),
    // Mistakes in the file.
    mistake(
        "run absent.toml",
        &["absent.toml", "No such file", "mc init"],
    ),
    mistake("run shaw.toml", &["shaw.toml", "mc init --from shaw"]),
    mistake("run .", &["it is a directory", "TOML file"]),
    mistake("run done.h5", &["HDF5", "mc show done.h5", "--scenario"]),
    mistake("run latin.toml", &["latin.toml", "line 2", "UTF-8"]),
    mistake(
        "check broken.toml",
        &["broken.toml:2:", "not valid TOML", "key = value"],
    ),
    mistake("check comma.toml", &["comma.toml:2:", "not valid TOML"]),
    mistake(
        "check empty.toml",
        &[
            "missing key `oscillator.mass`",
            "missing key `time.end`",
            "add `mass = ...`",
        ],
    ),
    mistake(
        "check two.toml",
        &[
            "`fricton`; did you mean `friction`",
            "`oscillator.mass` = -1.0",
            "above 0",
        ],
    ),
    mistake(
        "check amplitude.toml",
        &["unknown key `amplitude`", "harmonics = [{ amplitude = 1.0"],
    ),
    mistake(
        "check single.toml",
        &[
            "`temperature.harmonics`",
            "array of tables",
            "harmonics = [{ ... }]",
        ],
    ),
    mistake(
        "check series.toml",
        &["series.toml:", "t.csv", "No such file"],
    ),
    // Mistakes in values.
    mistake(
        "run scene.toml --paths ten",
        &["--paths ten", "whole number from 1", "fix: "],
    ),
    mistake(
        "run scene.toml --paths 0",
        &["--paths 0", "out of range", "from 1"],
    ),
    mistake(
        "run scene.toml --paths -5",
        &["--paths -5", "out of range", "from 1"],
    ),
    mistake(
        "run scene.toml --paths 1.5",
        &["--paths 1.5", "whole number", "from 1"],
    ),
    mistake(
        "run scene.toml --paths 1e20",
        &["--paths 1e20", "whole number", "from 1"],
    ),
    mistake(
        "run scene.toml --paths 10,000",
        &["--paths 10,000", "`10,000` is not a TOML value", "fix: "],
    ),
    mistake(
        "run scene.toml --seed one",
        &["--seed one", "whole number", "from 0"],
    ),
    mistake(
        "run scene.toml --step 0",
        &["--step 0", "above 0", "h, time step"],
    ),
    mistake(
        "run scene.toml --step small",
        &["--step small", "is a string", "above 0"],
    ),
    mistake(
        "run scene.toml --step 0.007",
        &[
            "`time.end` = 60.0",
            "`time.step` = 0.007",
            "the nearest steps are",
        ],
    ),
    mistake(
        "run scene.toml --until -1",
        &["--until -1", "out of range", "0 or above"],
    ),
    mistake(
        "run scene.toml --until never",
        &["--until never", "is a string", "finite number"],
    ),
    mistake(
        "run scene.toml --set friction.static=0.5",
        &["`friction.dynamic` = 1.0", "raise `friction.static`"],
    ),
    mistake(
        "run scene.toml --set friction.static=1,3",
        &["1,3", "not a TOML value", "give a number"],
    ),
    mistake(
        "run scene.toml --set friction.static",
        &["there is no `=`", "friction.static=1.3"],
    ),
    mistake(
        "run scene.toml --set friction.sttic=1.3",
        &["`sttic`", "did you mean `static`"],
    ),
    mistake(
        "run scene.toml --set static=1.3",
        &["`static`", "did you mean `friction.static`"],
    ),
    mistake(
        "run scene.toml --set temperature.harmonics.3.phase=1",
        &["has 1 entries", "number them from 0"],
    ),
    mistake(
        "run scene.toml --set units.time=5",
        &["`units.time` = 5", "a string", "quotes"],
    ),
    mistake(
        "run scene.toml --set ensemble.antithetic=yes",
        &["`ensemble.antithetic`", "true or false"],
    ),
    mistake(
        "run scene.toml --set ensemble.antithetic=true --paths 11",
        &["an even number of paths", "odd", "paths = 12"],
    ),
    mistake(
        "run scene.toml --set statistics.after=100",
        &["`statistics.after` = 100.0", "raise `time.end`"],
    ),
    mistake(
        "run scene.toml --set time.output_step=0.013",
        &["`time.output_step` = 0.013", "0.01 or 0.02"],
    ),
    mistake(
        "run scene.toml --set oscillator.mass=nan",
        &["is not a number", "m, mass"],
    ),
    // Mistakes in schemes.
    mistake(
        "run scene.toml --scheme event_driven",
        &["event_driven", "did you mean \"event-driven\""],
    ),
    mistake(
        "run scene.toml --scheme exact",
        &["exact", "\"discrete-vi\", \"corrected-vi\""],
    ),
    mistake(
        "run scene.toml --scheme event-driven --step 0.01",
        &["--step 0.01", "no time step", "scheme.tolerance"],
    ),
    mistake(
        "run scene.toml --tolerance 1e-3",
        &[
            "--tolerance 1e-3",
            "set by `time.step`",
            "--scheme event-driven",
        ],
    ),
    mistake(
        "run scene.toml --scheme event-driven --tolerance 2",
        &["--tolerance 2", "1e-9 to 0.1"],
    ),
    mistake(
        "run scene.toml --set temperature.noise.1.intensity=1",
        &["`temperature.noise`"],
    ),
    // Mistakes in how a run ends.
    mistake(
        "run scene.toml --until stick_mean~<~1%",
        &[
            "stick_mean",
            "unknown statistic",
            "one of stick_duration_mean",
        ],
    ),
    mistake(
        "run scene.toml --until stick_duration_mean~<~lots",
        &["lots", "stick_duration_mean < 0.5%"],
    ),
    mistake(
        "check scene.toml --until stick_duration_mean~<~1%",
        &["goal of mc run", "remove it here"],
    ),
    mistake(
        "run scene.toml --max-time soon",
        &["'soon'", "--max-time", "4h50m"],
    ),
    mistake("run scene.toml --accuracy 200%", &["'200%'", "--accuracy"]),
    mistake(
        "run scene.toml --accuracy 1% --paths 100",
        &["--paths 100", "remove one of them"],
    ),
    mistake(
        "run scene.toml --statistic mean --accuracy 1%",
        &["'mean'", "one of stick_duration_mean"],
    ),
    mistake("run scene.toml --part 4/3", &["'4/3'", "--part"]),
    mistake(
        "run scene.toml --part 1/2 --max-time 1m",
        &["--part 1/2", "--max-time", "mc resume"],
    ),
    mistake("run scene.toml --threads 0", &["'0'", "--threads", "1..="]),
    mistake(
        "run scene.toml --threads 1025",
        &["'1025'", "--threads", "1..=1024"],
    ),
    mistake(
        "run scene.toml --set temperature.harmonics.0.phase=1e16",
        &["phase", "1e16", "limit of double precision", "fix: "],
    ),
    mistake(
        "run scene.toml --scheme event-driven --until 1e14",
        &["w t reach 2.5e13", "lower `time.end`"],
    ),
    // Mistakes in where results are written.
    mistake(
        "run scene.toml -o nowhere/a.h5",
        &["the directory nowhere", "create it"],
    ),
    mistake(
        "run scene.toml -o done.h5",
        &["done.h5 already exists", "--force"],
    ),
    mistake(
        "run scene.toml -o scene.toml --force",
        &["scene.toml", "is an input", "-o"],
    ),
    mistake("run scene.toml -o -", &["standard output", "-o"]),
    mistake(
        "init -o scene.toml",
        &["scene.toml already exists", "--force"],
    ),
    mistake("plot done.h5 -o fan.gif", &["fan.gif", ".svg"]),
    // Mistakes with results.
    mistake("show absent.h5", &["absent.h5", "No such file"]),
    mistake("show scene.toml", &["scene.toml", "HDF5"]),
    mistake(
        "replay done.h5 --path 9999",
        &["--path 9999", "the ensemble has 256 paths"],
    ),
    mistake("plot done.h5 --only fann", &["'fann'", "fan"]),
    mistake("resume absent.h5", &["absent.h5", "no such file", "fix: "]),
    mistake("merge done.h5 -o all.h5", &["done.h5", "part"]),
    mistake("verify scene.toml", &["scene.toml", "HDF5"]),
    // Mistakes with studies of many runs.
    mistake("sweep scene.toml", &["--vary", "Usage: mc sweep"]),
    mistake(
        "sweep scene.toml --vary friction.sttic=1:2:3",
        &["sttic", "did you mean `static`"],
    ),
    mistake(
        "sweep scene.toml --vary friction.static=1:2",
        &["friction.static=1:2", "--vary"],
    ),
    mistake("trade scene.toml --budget 0", &["'0'", "--budget", "60s"]),
    // Mistakes with measurements.
    mistake(
        "calibrate scene.toml absent.csv",
        &["absent.csv", "No such file"],
    ),
    mistake("fit-temperature words.csv", &["words.csv", "time"]),
];

/// Makes the folder in which the commands run.
fn desk(folder: &Path) {
    const SCENE: &str = include_str!("../../../../scenarios/rho025.toml");
    let write =
        |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).expect("writes");
    let harmonics = "harmonics = [{ amplitude = 1.0, angular_frequency = 0.25 }]";
    assert!(SCENE.contains(harmonics));
    write("scene.toml", SCENE.as_bytes());
    write("latin.toml", b"# a\ntitle = \"\xfcber\"\n");
    write("broken.toml", b"[oscillator]\nmass 1.0\n");
    write("comma.toml", b"[oscillator]\nmass = 1,5\n");
    write("empty.toml", b"");
    write(
        "two.toml",
        SCENE
            .replace("[friction]", "[fricton]")
            .replace("mass = 1.0", "mass = -1.0")
            .as_bytes(),
    );
    write(
        "amplitude.toml",
        SCENE.replace(harmonics, "amplitude = 1.0").as_bytes(),
    );
    write(
        "single.toml",
        SCENE
            .replace(harmonics, "harmonics = { amplitude = 1.0 }")
            .as_bytes(),
    );
    write(
        "series.toml",
        SCENE
            .replace(
                "[temperature.noise]",
                "[temperature.series]\nfile = \"t.csv\"\n[temperature.noise]",
            )
            .as_bytes(),
    );
    write("words.csv", b"When,What\nnow,warm\n");
    let run = command::mc(
        folder,
        &[
            "run",
            "scene.toml",
            "--paths",
            "256",
            "--quiet",
            "-o",
            "done.h5",
        ],
    );
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
}

#[test]
fn every_mistake_is_answered_with_cause_place_and_remedy() {
    let folder = tempfile::tempdir().expect("a folder");
    desk(folder.path());
    let names = || {
        let entries = std::fs::read_dir(folder.path()).expect("reads");
        let mut names: Vec<_> = entries
            .map(|entry| entry.expect("reads").file_name())
            .collect();
        names.sort();
        names
    };
    let before = names();
    let mut poor = Vec::new();
    for Mistake { line, says } in MISTAKES {
        let words: Vec<String> = line.split(' ').map(|word| word.replace('~', " ")).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let output = command::mc(folder.path(), &words);
        let message = String::from_utf8_lossy(&output.stderr);
        println!("$ mc {}\n{message}", line.replace('~', " "));
        let mut wrong = Vec::new();
        if output.status.code() != Some(2) {
            wrong.push(format!("exit code {:?}", output.status.code()));
        }
        if !output.stdout.is_empty() {
            wrong.push("something on standard output".to_string());
        }
        wrong.extend(
            says.iter()
                .filter(|part| !message.contains(**part))
                .map(|part| format!("no {part:?}")),
        );
        if !["fix: ", "tip: ", "--help", "["]
            .iter()
            .any(|sign| message.contains(sign))
        {
            wrong.push("no remedy".to_string());
        }
        if message.contains("panicked") {
            wrong.push("a panic".to_string());
        }
        if !wrong.is_empty() {
            poor.push(format!("$ mc {line}\n{message}-> {}\n", wrong.join(", ")));
        }
    }
    assert!(
        poor.is_empty(),
        "{} of {} answers are poor:\n{}",
        poor.len(),
        MISTAKES.len(),
        poor.join("\n")
    );
    assert_eq!(names(), before, "a mistake leaves nothing behind");
}
