//! Commands that a page shows can be typed: the tests, examples, benchmarks, scenarios and options
//! in them exist.

use super::markdown::{Page, root};
use std::path::{Path, PathBuf};
use stickslip::config::shipped;

/// The words of every span or line of code that begins with `start`, each with its page and text.
fn commands(start: &str) -> Vec<(String, Vec<String>)> {
    let mut found = Vec::new();
    for page in Page::all() {
        // A line of a table that a program printed is not a command.
        let code = page.code().filter(|line| !line.contains("   "));
        let lines = page
            .spans()
            .into_iter()
            .chain(code)
            .flat_map(|text| text.split(" && "));
        for line in lines
            .map(|line| line.trim_start_matches(['(', ' ']))
            .filter(|line| line.starts_with(start))
        {
            let words = line
                .split_whitespace()
                .map(|word| word.trim_end_matches(['`', ')']).to_string());
            found.push((format!("{}: {line}", page.path.display()), words.collect()));
        }
    }
    assert!(!found.is_empty(), "no page shows {start}");
    found
}

fn after<'a>(words: &'a [String], flag: &str) -> Option<&'a str> {
    let at = words.iter().position(|word| word == flag)?;
    words.get(at + 1).map(String::as_str)
}

/// The texts of all Rust files at or below a path, each after the path.
fn sources(place: &Path) -> Vec<String> {
    match std::fs::read_dir(place) {
        Ok(entries) => entries
            .flat_map(|entry| sources(&entry.expect("readable").path()))
            .collect(),
        Err(_) if place.extension().is_some_and(|extension| extension == "rs") => {
            vec![
                place.to_string_lossy().into_owned()
                    + &std::fs::read_to_string(place).expect("readable"),
            ]
        }
        Err(_) => Vec::new(),
    }
}

/// Where tests lie: those of the engine, and those of each crate.
const TESTS: [&str; 3] = ["tests", "crates/mc/tests", "crates/bearing/tests"];

#[test]
fn tests_that_a_page_names_exist() {
    for (shown, words) in commands("cargo test") {
        let Some(file) = after(&words, "--test") else {
            continue;
        };
        let places = TESTS.map(|folder| root().join(folder).join(file));
        let path: &PathBuf = places
            .iter()
            .find(|path| path.exists())
            .unwrap_or_else(|| panic!("{shown}: no such test"));
        let of_test = |word: &&String| !word.starts_with('-') && **word != file;
        let Some(filter) = words.iter().skip(2).find(of_test) else {
            continue;
        };
        // `module::part_of_a_name`, where either may be missing.
        let has = |text: &str| filter.split("::").all(|part| text.contains(part));
        assert!(
            sources(path).iter().any(|text| has(text)),
            "{shown}: no test named so"
        );
    }
}

#[test]
fn examples_and_benchmarks_that_a_page_names_exist() {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("the manifest");
    let is_declared = |name: &str| manifest.contains(&format!("name = \"{name}\""));
    for (shown, words) in commands("cargo run") {
        let Some(name) = after(&words, "--example") else {
            continue;
        };
        let paths = [
            format!("examples/{name}.rs"),
            format!("examples/{name}/main.rs"),
        ];
        assert!(
            is_declared(name) || paths.iter().any(|path| root().join(path).exists()),
            "{shown}"
        );
    }
    for (shown, words) in commands("cargo bench") {
        let name = after(&words, "--bench").unwrap_or_else(|| panic!("{shown}: names none"));
        assert!(is_declared(name), "{shown}");
    }
}

/// clap declares options from the fields of the arguments, and `--help` shows them.
#[test]
fn options_and_scenarios_that_a_page_gives_to_mc_exist() {
    for (shown, words) in commands("mc ") {
        let verb = words[1].as_str();
        if verb.starts_with('-') || ["help", "completions"].contains(&verb) {
            continue;
        }
        let help = super::command::mc(Path::new("."), &[verb, "--help"]);
        assert!(help.status.success(), "{shown}: there is no such verb");
        let help = String::from_utf8_lossy(&help.stdout).into_owned();
        for option in words
            .iter()
            .map(|word| word.trim_matches(['[', ']']))
            .filter(|word| word.starts_with("--"))
        {
            assert!(help.contains(option), "{shown}: mc {verb} has no {option}");
        }
        for word in words
            .iter()
            .filter_map(|word| word.strip_prefix("scenarios/")?.strip_suffix(".toml"))
        {
            let is_placeholder = word.chars().all(char::is_uppercase);
            assert!(
                is_placeholder || shipped(word).is_some(),
                "{shown}: there is no such scenario"
            );
        }
    }
}

/// Examples that contain this are not run, for this reason.
const NOT_RUN: [(&str, &str); 9] = [
    (
        "mc resume",
        "it needs an interrupted run; tests/files/resume.rs interrupts many",
    ),
    (
        "--accuracy",
        "it measures for eight seconds; the tests of `mc run` do so once",
    ),
    ("man -l", "it needs a program that shows manual pages"),
    (
        "temperature.csv",
        "a record of the reader's own, in two files",
    ),
    (
        "Date,Time",
        "a record of the reader's own, with two columns of times",
    ),
    ("gauge", "a record of the reader's own, with several gauges"),
    (
        "air_degC",
        "a record of the reader's own, with other names of columns",
    ),
    (
        "forecast examples/bridge/",
        "all samples, and the other forecasts have half",
    ),
    (
        "fit-temperature examples/bridge/",
        "all samples, and the other fits have half",
    ),
];

/// Pages whose commands have tests of their own.
const TESTED: [&str; 2] = ["docs/model.md", "docs/bearing/tutorial.md"];

/// Makes the files that examples read. The record of measurements has every other sample of the bridge.
const INPUTS: &str = r#"
    mkdir -p .local/share/man/man1 .local/share/bash-completion/completions
    cp scenarios/rho025.toml rho025.toml; cp rho025.toml mine.toml; cp examples/bridge/bearing.toml .
    sed 's/twin.csv/data.csv/' examples/bridge/bridge.toml > bridge.toml
    awk "NR % 2 == 1" examples/bridge/twin.csv > data.csv; cp data.csv twin.csv
    mc run rho025.toml --paths 5000; cp rho025.h5 mine.h5; cp rho025.h5 coarse.h5
    mc run rho025.toml --paths 512 --scheme event-driven -o fine.h5
    for i in 1 2 3 4; do mc run rho025.toml --paths 1024 --part $i/4 -o part-$i.h5; done
    mc sweep rho025.toml --paths 64 --vary rho=temperature.noise.intensity=0,0.25 -o discrete-vi.h5
    cp discrete-vi.h5 event-driven.h5; cp discrete-vi.h5 rho025-sweep.h5
    mc sweep belt --paths 16 --vary V=temperature.trend=0.2,0.5 -o belt-v.h5
    for g in 0.3 0.5; do printf "time_s,ag\n0,$g\n0.4,$g\n0.4000001,0\n3,0\n" > pulse-$g.csv; done
    cat > floor.toml << END
oscillator = { mass = 1000, stiffness = 0, dilatation = 0 }
friction = { static = 1961.33, dynamic = 1961.33 }
force.expression = "-m*ag"
parameters = { m = 1000 }
input.ag = { file = "pulse-0.3.csv", unit = "g" }
initial.displacement = 0
scheme.kind = "event-driven"
END
    sed 's/-m\*ag/-m*s*ag/; s/m = 1000 }/m = 1000, s = 1 }/' floor.toml > block.toml
    mc trade rho025.toml --budget 1s -o trade.h5
    mc calibrate bridge.toml data.csv --method slips -o fit.h5
    mc fit-temperature data.csv -o weather.toml; cat bearing.toml weather.toml > year.toml
"#;

/// Options with which a command is cheap.
const CHEAP: [(&str, &str, &str); 5] = [
    ("mc calibrate ", "--method", "slips"),
    ("mc sweep ", "--paths", "64"),
    ("mc trade ", "--budget", "1s"),
    ("mc forecast ", "--draws", "2"),
    ("mc forecast ", "--years", "2"),
];

/// The command with these options.
fn cheap(line: &str) -> String {
    let mut line = line.to_string();
    for (verb, option, value) in CHEAP {
        if line.contains(verb) {
            let given = line
                .split_whitespace()
                .skip_while(|word| *word != option)
                .nth(1)
                .map(str::to_string);
            line = match given {
                Some(given) => {
                    line.replace(&format!("{option} {given}"), &format!("{option} {value}"))
                }
                None => line.replace(verb, &format!("{verb}{option} {value} ")),
            };
        }
    }
    line
}

/// A folder in which commands run as in the root of the repository and can write files.
struct Workplace(tempfile::TempDir);

impl Workplace {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["scenarios", "examples"] {
            std::os::unix::fs::symlink(root().join(name), folder.path().join(name))
                .expect("a link");
        }
        Workplace(folder)
    }

    /// The output of commands of a shell, which must succeed.
    fn shell(&self, commands: &str) -> Vec<u8> {
        let bin = Path::new(env!("CARGO_BIN_EXE_mc"))
            .parent()
            .expect("a folder");
        let path = format!(
            "{}:{}",
            bin.display(),
            std::env::var("PATH").expect("a path")
        );
        let mut bash = std::process::Command::new("bash");
        let output = bash
            .args(["-ec", commands])
            .current_dir(&self.0)
            .env("PATH", path)
            .output()
            .expect("bash runs");
        assert!(
            output.status.success(),
            "{commands}\n{}",
            String::from_utf8_lossy(&output.stderr)
        );
        output.stdout
    }

    /// Copies the inputs that a command reads and that are not here.
    fn fill(&self, inputs: &Self, line: &str) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let written: Vec<&str> = words
            .windows(2)
            .filter(|pair| ["-o", ">"].contains(&pair[0]))
            .map(|pair| pair[1])
            .collect();
        for entry in std::fs::read_dir(&inputs.0).expect("inputs") {
            let (entry, here) = entry
                .map(|entry| (entry.path(), self.0.path().join(entry.file_name())))
                .expect("an input");
            let name = here
                .file_name()
                .and_then(|name| name.to_str())
                .expect("a name");
            let is_named = words.iter().any(|word| {
                *word == name
                    || word
                        .strip_suffix("*.h5")
                        .is_some_and(|start| name.starts_with(start))
            });
            // The scenario of the bridge names its record.
            let is_read = is_named
                || name == "data.csv" && words.contains(&"bridge.toml")
                || name.starts_with("pulse-")
                    && ["floor.toml", "block.toml"]
                        .iter()
                        .any(|scene| words.contains(scene));
            if entry.is_file() && is_read && !written.contains(&name) && !here.exists() {
                std::fs::copy(&entry, &here).expect("copied");
            }
        }
    }

    /// Runs an example. The keys that it reads by `jq` must exist: `jq` prints null for one that
    /// does not.
    fn run(&self, inputs: &Self, line: &str) {
        if NOT_RUN.iter().any(|(part, _)| line.contains(part)) {
            return;
        }
        self.fill(inputs, line);
        let line = line.replace("~/", &format!("{}/", inputs.0.path().display()));
        let (command, keys) = line.split_once(" | jq ").unwrap_or((&line, ""));
        let printed = self.shell(&cheap(command));
        if !keys.is_empty() {
            let value: serde_json::Value = serde_json::from_slice(&printed).expect("JSON");
            let found = value.pointer(&keys.trim_matches('\'').replace('.', "/"));
            assert!(
                found.is_some_and(|found| !found.is_null()),
                "{line}: there is no {keys}"
            );
        }
    }
}

/// The commands of a page run one after the other in one folder, and each of a help text in its own.
#[test]
fn every_example_of_the_help_texts_and_pages_runs() {
    let inputs = Workplace::new();
    inputs.shell(INPUTS);
    let mut counts = [0, 0];
    for text in std::fs::read_dir(root().join("crates/mc/src/commands/help")).expect("help texts") {
        let text = std::fs::read_to_string(text.expect("readable").path()).expect("a text");
        for line in text.lines().filter_map(|line| line.strip_prefix("  ")) {
            // An explanation follows after two spaces or more.
            Workplace::new().run(&inputs, line.split("  ").next().expect("an example"));
            counts[0] += 1;
        }
    }
    for page in Page::all()
        .into_iter()
        .filter(|page| !TESTED.iter().any(|path| page.path == Path::new(path)))
    {
        let here = Workplace::new();
        for block in page.text.split("\n```sh\n").skip(1) {
            let block = block
                .split("\n```")
                .next()
                .expect("a block")
                .replace("\\\n", " ");
            for line in block.lines().filter(|line| line.starts_with("mc ")) {
                here.run(
                    &inputs,
                    line.split("  #").next().expect("a command").trim_end(),
                );
                counts[1] += 1;
            }
        }
    }
    assert!(
        counts[0] > 70 && counts[1] > 30,
        "examples are recognised: {counts:?}"
    );
}
