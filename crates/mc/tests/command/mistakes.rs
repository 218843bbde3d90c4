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
        &["unknown option `-n`", "fix: write `--paths`"],
    ),
    mistake(
        "run scene.toml --h 0.1",
        &["unknown option `--h`", "fix: write `--step`"],
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
    mistake("run scene.toml --path 10", &["`--path`", "`--paths`"]),
    // Options as similar tools call them.
    mistake("run scene.toml --cores 4", &["fix: write `--threads`"]),
    mistake("run scene.toml --format json", &["fix: write `--json`"]),
    mistake("run scene.toml --end 5", &["fix: write `--until`"]),
    mistake("run scene.toml --duration 5", &["fix: write `--until`"]),
    mistake("init --template shaw", &["fix: write `--from`"]),
    mistake("run scene.toml --particles 9", &["fix: write `--paths`"]),
    mistake("run scene.toml -p 100", &["fix: write `--paths`"]),
    mistake("run scene.toml --dt 0.1", &["fix: write `--step`"]),
    mistake("run scene.toml --out a.h5", &["fix: write `--output`"]),
    mistake(
        "calibrate scene.toml z.csv --timezone UTC",
        &["fix: write `--zone`"],
    ),
    mistake(
        "calibrate scene.toml z.csv t.csv",
        &["t.csv", "`--temperature-file t.csv`"],
    ),
    mistake(
        "run scene.toml --period 10",
        &["`--set statistics.period=...`"],
    ),
    // Only options of the command are suggested.
    mistake("show done.h5 --rho 1", &["fix: `mc show --help` lists"]),
    mistake("report done.h5 --dt 1", &["fix: `mc report --help` lists"]),
    mistake(
        "verify done.h5 --seed 1",
        &["fix: `mc verify --help` lists"],
    ),
    mistake("replay done.h5 --n 1", &["fix: `mc replay --help` lists"]),
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
        &["absent.toml", "no such file", "mc init"],
    ),
    mistake("run shaw.toml", &["shaw.toml", "mc init --from shaw"]),
    mistake("run .", &["it is a directory", "TOML file"]),
    mistake(
        "plot absent.h5",
        &["absent.h5", "no such file", "an existing file"],
    ),
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
    mistake(
        "check step.toml",
        &["`time.step`", "or `scheme.kind = \"event-driven\"`"],
    ),
    mistake(
        "check period.toml",
        &["`period`", "write `angular_frequency` = 2 pi / period"],
    ),
    // Mistakes in an input.
    mistake("check dt.toml", &["`dt`; did you mean `step`"]),
    mistake("check path.toml", &["`path`; did you mean `file`"]),
    mistake(
        "check scale.toml",
        &["`scale`", "write `force.expression` with the factor in it"],
    ),
    mistake(
        "check block.toml --set input.ag.step=0.01",
        &["AT2 record", "fix: remove `step`"],
    ),
    mistake(
        "check block.toml --set input.ag.unit=m/s2",
        &["the unit `G`, but `unit` = \"m/s2\"", "fix: remove `unit`"],
    ),
    mistake(
        "check block.toml --set input.ag={file=\"two.txt\",step=0.01}",
        &["2 numbers in each line", "fix: remove `step`"],
    ),
    mistake(
        "check sub/block.toml --set input.ag.file=b.AT2",
        &["b.AT2", "relative to the current directory"],
    ),
    mistake(
        "check sub/other.toml",
        &["sub/b.AT2", "relative to the folder of the scenario"],
    ),
    // Mistakes in values.
    mistake(
        "run scene.toml --until 1h",
        &["--until 1h", "if `units.time` = \"s\", a duration"],
    ),
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
            "scheme.kind = \"event-driven\"",
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
    mistake(
        "sweep block.toml --vary record=a.AT2",
        &["`a.AT2` is not", "write input.ag.file=a.at2,b.at2"],
    ),
    mistake(
        "sweep block.toml --vary input.ag.file=*.at2",
        &["no file matches", "relative to the current directory"],
    ),
    mistake("trade scene.toml --budget 0", &["'0'", "--budget", "60s"]),
    // Mistakes with measurements.
    mistake(
        "calibrate scene.toml absent.csv",
        &["absent.csv", "No such file"],
    ),
    mistake("fit-temperature words.csv", &["words.csv", "time"]),
    mistake(
        "fit-temperature german.csv --zone UTC",
        &["german.csv", "`--temperature Weg`"],
    ),
];

/// A block on ground that moves as the record `a.AT2`, as `block.toml` here and in `sub/`, and with
/// other keys in its input.
fn block(folder: &Path) {
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("writes");
    let text = "[oscillator]\nmass = 1\nstiffness = 0\ndilatation = 0\n[friction]\nstatic = 1\ndynamic = 1\n\
                [input.ag]\nfile = \"a.AT2\"\n[force]\nexpression = \"-ag\"\n[initial]\ndisplacement = 0\n\
                [scheme]\nkind = \"event-driven\"\n[units]\ntime = \"s\"\n";
    let record = "PEER\nPLACE\nACCELERATION IN UNITS OF G\nNPTS= 4, DT= .01 SEC\n0.1 0.2 -0.1 0\n";
    std::fs::create_dir(folder.join("sub")).expect("a folder");
    for folder in ["", "sub/"] {
        write(&format!("{folder}a.AT2"), record);
        write(&format!("{folder}block.toml"), text);
    }
    write("sub/other.toml", &text.replace("a.AT2", "b.AT2"));
    write("two.txt", "0.00 1\n0.01 -2\n0.02 3\n");
    for key in ["dt = 0.01", "path = \"a.AT2\"", "scale = 2"] {
        let name = key.split(' ').next().expect("a key");
        let line = format!("[input.ag]\n{key}\n");
        write(
            &format!("{name}.toml"),
            &text.replace("[input.ag]\n", &line),
        );
    }
}

/// A path on the command line is relative to the current directory, as a shell completes it, and one
/// in a scenario to its folder.
#[test]
fn a_file_is_found_from_where_it_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    block(folder.path());
    std::fs::create_dir(folder.path().join("rho025")).expect("a folder");
    for line in [
        "check sub/block.toml",
        "check sub/block.toml --set input.ag.file=sub/a.AT2",
        "check sub/block.toml --until 10ms",
        "sweep sub/block.toml --paths 1 --no-bias --vary input.ag.file=*.AT2,sub/*.AT2",
        // A directory does not hide a shipped scenario.
        "check rho025",
    ] {
        let output = command::mc(folder.path(), &line.split(' ').collect::<Vec<_>>());
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}: {message}");
    }
    let output = command::mc(folder.path(), &["show", "block-sweep.h5"]);
    let shown = String::from_utf8_lossy(&output.stdout);
    assert!(shown.contains("sub/a.AT2"), "{shown}");
}

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
    write(
        "german.csv",
        b"Datum;Uhrzeit;Weg\n13.08.2015;00:00;1,5\n13.08.2015;00:10;1,6\n",
    );
    let replaced = |name: &str, from: &str, to: &str| {
        assert!(SCENE.contains(from), "{from}");
        write(name, SCENE.replace(from, to).as_bytes());
    };
    replaced("step.toml", "step = 0.01", "");
    replaced("period.toml", "angular_frequency = 0.25", "period = 25");
    block(folder);
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
