//! The program as a user meets it: every mistake is answered with the place, the value and what to
//! write instead.

use crate::command::{self, Running};
use std::path::{Path, PathBuf};
use stickslip::config::SHIPPED;
use stickslip::scenario::Scenario;
use tempfile::TempDir;

const RHO025: &str = include_str!("../../../../scenarios/rho025.toml");

/// A folder with one scenario in it, `scene.toml`.
struct Desk {
    folder: TempDir,
}

/// What the program printed, and its exit code.
struct Answer {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Desk {
    fn with(text: &str) -> Desk {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scene.toml"), text).unwrap();
        Desk { folder }
    }

    fn new() -> Desk {
        Desk::with(RHO025)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn mc(&self, arguments: &[&str]) -> Answer {
        let output = command::mc(self.folder.path(), arguments);
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Answer {
            code: output.status.code(),
            out: text(output.stdout),
            err: text(output.stderr),
        }
    }
}

impl Answer {
    /// The command was refused: exit code 2, nothing on standard output, and a message with each of
    /// these parts.
    #[track_caller]
    fn refused(&self, says: &[&str]) {
        assert_eq!(self.code, Some(2), "{}", self.err);
        assert_eq!(self.out, "");
        for part in says {
            assert!(self.err.contains(part), "{part:?} is not in:\n{}", self.err);
        }
    }

    #[track_caller]
    fn done(&self) -> &str {
        assert_eq!(self.code, Some(0), "{}", self.err);
        &self.out
    }
}

/// Runs `mc check` on the scenario after one piece of text is replaced.
#[track_caller]
fn check_with(from: &str, to: &str) -> Answer {
    // The text is replaced below the opening comment, which mentions keys as well.
    let (comment, body) = RHO025.split_at(RHO025.find("title = ").unwrap());
    assert!(body.contains(from), "{from}");
    Desk::with(&format!("{comment}{}", body.replacen(from, to, 1))).mc(&["check", "scene.toml"])
}

/// The number of the first line that starts with this text.
fn line_of(start: &str) -> usize {
    RHO025
        .lines()
        .position(|line| line.starts_with(start))
        .unwrap()
        + 1
}

#[test]
fn a_missing_file_is_named() {
    Desk::new().mc(&["check", "absent.toml"]).refused(&[
        "absent.toml",
        "no such file",
        "fix: ",
        "mc init",
    ]);
    Desk::new()
        .mc(&["run", "absent.toml"])
        .refused(&["absent.toml", "no such file", "fix: "]);
    Desk::new()
        .mc(&["check", "shaw.toml"])
        .refused(&["`shaw`, which is shipped", "`mc init --from shaw`"]);
}

#[test]
fn a_directory_is_no_scenario() {
    Desk::new()
        .mc(&["check", "."])
        .refused(&["cannot read .: it is a directory", "fix: "]);
}

#[test]
fn bad_toml_is_located() {
    let place = format!("scene.toml:{}:", line_of("mass"));
    check_with("mass = 1.0", "mass 1.0").refused(&[
        &place,
        "not valid TOML",
        "mass 1.0",
        "^",
        "fix: ",
    ]);
    check_with("mass = 1.0", "mass = 1.0.0").refused(&[&place, "not valid TOML", "fix: "]);
    check_with("[friction]", "[friction").refused(&["not valid TOML", "fix: "]);
    check_with("mass = 1.0", "mass = 1.0\nmass = 2.0").refused(&[
        "duplicate key",
        "mass = 2.0",
        "fix: ",
    ]);
}

#[test]
fn an_unknown_key_comes_with_a_suggestion() {
    let place = format!("scene.toml:{}:33: ", line_of("harmonics"));
    let says = [
        &place,
        "unknown key `frequncy`; did you mean `angular_frequency`?",
        "^^^^^^^^",
        "fix: write `angular",
    ];
    check_with("angular_frequency", "frequncy").refused(&says);
    check_with("[friction]", "[fricton]")
        .refused(&["unknown key `fricton`; did you mean `friction`?"]);
    check_with("stiffness", "k").refused(&["unknown key `k`; did you mean `stiffness`?"]);
}

#[test]
fn a_missing_key_is_named_with_its_meaning() {
    check_with("mass = 1.0", "").refused(&[
        "missing key `oscillator.mass`",
        "[oscillator]",
        "add `mass = ...`",
        "above 0",
    ]);
    check_with("[initial]", "[units]\n#")
        .refused(&["`displacement`; did you mean `initial.displacement`"]);
}

#[test]
fn a_wrong_type_is_named() {
    let place = format!(
        "scene.toml:{}:8: `oscillator.mass` = \"heavy\" is a string",
        line_of("mass")
    );
    check_with("mass = 1.0", "mass = \"heavy\"").refused(&[
        &place,
        "must be a finite number above 0",
        "fix: ",
    ]);
    check_with("paths = 10000", "paths = 1e-4").refused(&[
        "`ensemble.paths` = 1e-4",
        "whole number",
        "fix: give",
    ]);
    check_with("harmonics = [", "harmonics = 3 #")
        .refused(&["`temperature.harmonics`", "array of tables"]);
}

#[test]
fn a_value_out_of_range_is_located() {
    for (from, to, key) in [
        ("mass = 1.0", "mass = -1.0", "oscillator.mass` = -1.0"),
        ("mass = 1.0", "mass = 0", "oscillator.mass` = 0"),
        (
            "stiffness = 1.0",
            "stiffness = -2",
            "oscillator.stiffness` = -2",
        ),
        ("static = 1.2", "static = -1.2", "friction.static` = -1.2"),
        (
            "intensity = 0.25",
            "intensity = -0.25",
            "temperature.noise.intensity` = -0.25",
        ),
        (
            "relaxation_rate = 1.0",
            "relaxation_rate = 0.0",
            "temperature.noise.relaxation_rate` = 0.0",
        ),
        ("end = 60.0", "end = -60.0", "time.end` = -60.0"),
        ("step = 0.01", "step = 0.0", "time.step` = 0.0"),
        (
            "angular_frequency = 0.25",
            "angular_frequency = -0.25",
            "temperature.harmonics.0.angular_frequency` = -0.25",
        ),
    ] {
        check_with(from, to).refused(&[
            "scene.toml:",
            key,
            "out of range: it must be a",
            "^",
            "fix: ",
        ]);
    }
}

#[test]
fn dynamic_friction_above_static_is_refused() {
    let place = format!("scene.toml:{}:11: ", line_of("dynamic"));
    check_with("dynamic = 1.0", "dynamic = 2.0").refused(&[
        &place,
        "`friction.dynamic` = 2.0 must not exceed `friction.static` = 1.2",
        "fix: lower `friction.dynamic`",
    ]);
}

#[test]
fn nan_and_infinity_are_refused() {
    check_with("mass = 1.0", "mass = nan")
        .refused(&["`oscillator.mass` = nan is not a number", "fix: "]);
    check_with("end = 60.0", "end = inf").refused(&["`time.end` = inf is not finite", "fix: "]);
    check_with("mass = 1.0", "mass = 1e400")
        .refused(&["`oscillator.mass` = 1e400 is not finite", "fix: "]);
}

#[test]
fn a_step_that_does_not_divide_the_end_names_the_nearest() {
    let place = format!("scene.toml:{}:8: ", line_of("step"));
    check_with("step = 0.01 ", "step = 0.007 ").refused(&[
        &place,
        "`time.end` = 60.0 is not a whole number of steps `time.step` = 0.007",
        "the nearest ends are 59.997 or 60.004",
    ]);
    Desk::new()
        .mc(&["check", "scene.toml", "--step", "0.007"])
        .refused(&["--step 0.007: ", "fix: the nearest steps"]);
    Desk::new()
        .mc(&["check", "scene.toml", "--until", "59.995"])
        .refused(&["--until 59.995: ", "59.99 or 60.0"]);
}

#[test]
fn a_bad_override_is_named() {
    let set = |text: &str| Desk::new().mc(&["check", "scene.toml", "--set", text]);
    set("friction.static").refused(&[
        "--set friction.static: there is no `=`",
        "fix: write key=value",
    ]);
    set("friction.statc=1").refused(&["--set friction.statc=1: ", "did you mean `static`?"]);
    set("friction.static=abc").refused(&["--set friction.static=abc: ", "is a string", "fix: "]);
    set("friction.static=1 2").refused(&[
        "--set friction.static=1 2: ",
        "not a TOML value",
        "fix: ",
    ]);
    set("friction.static.x=1")
        .refused(&["`friction.static` is a number, so there is no `friction.static.x`"]);
    set("temperature.harmonics.7.amplitude=1")
        .refused(&["has 1 entries", "fix: number them from 0"]);
    set("=1").refused(&["is not a key", "fix: "]);
    set("time.step=nan").refused(&[
        "--set time.step=nan: `time.step` = nan is not a number",
        "fix: ",
    ]);
}

#[test]
fn a_bad_flag_is_named() {
    let check =
        |arguments: &[&str]| Desk::new().mc(&[&["check", "scene.toml"], arguments].concat());
    check(&["--paths", "0"]).refused(&["--paths 0: `ensemble.paths` = 0", "from 1 to", "fix: "]);
    check(&["--paths", "-5"]).refused(&["--paths -5: `ensemble.paths` = -5", "from 1 to", "fix: "]);
    check(&["--paths", "many"]).refused(&["--paths many: ", "must be a whole number", "fix: "]);
    check(&["--paths", "99999999999999999999999"]).refused(&["out of range", "fix: "]);
    check(&["--seed", "-1"]).refused(&["--seed -1: ", "from 0 to 18446744073709551615"]);
    Desk::new()
        .mc(&["run", "scene.toml", "--threads", "0"])
        .refused(&["--threads", "1..="]);
    Desk::new()
        .mc(&["run", "scene.toml", "--thread", "2"])
        .refused(&["--thread", "--threads"]);
}

#[test]
fn an_unknown_verb_is_answered_with_a_similar_one() {
    Desk::new()
        .mc(&["ru"])
        .refused(&["unrecognized subcommand 'ru'", "run"]);
    Desk::new().mc(&["run"]).refused(&["SCENARIO"]);
    assert_eq!(Desk::new().mc(&[]).code, Some(2));
}

#[test]
fn results_are_never_overwritten_silently() {
    let desk = Desk::new();
    std::fs::write(desk.path("scene.h5"), "precious").unwrap();
    desk.mc(&["run", "scene.toml"]).refused(&[
        "scene.h5 already exists",
        "fix: ",
        "-o FILE",
        "--force",
    ]);
    std::fs::write(desk.path("other.h5"), "precious").unwrap();
    desk.mc(&["run", "scene.toml", "-o", "other.h5"])
        .refused(&["other.h5 already exists"]);
    for name in ["scene.h5", "other.h5"] {
        assert_eq!(
            std::fs::read_to_string(desk.path(name)).unwrap(),
            "precious"
        );
    }
}

#[test]
fn results_need_a_place() {
    let desk = Desk::new();
    desk.mc(&["run", "scene.toml", "-o", "no/such/place.h5"])
        .refused(&["the directory no/such", "fix: create it"]);
    desk.mc(&["run", "scene.toml", "-o", "."])
        .refused(&["is a directory", "fix: "]);
    desk.mc(&["run", "scene.toml", "-o", "scene.toml", "--force"])
        .refused(&["is an input of this command", "fix: "]);
    assert_eq!(
        std::fs::read_to_string(desk.path("scene.toml")).unwrap(),
        RHO025
    );
}

#[test]
fn a_file_that_is_not_a_result_is_refused_by_show_and_replay() {
    Desk::new().mc(&["show", "absent.h5"]).refused(&[
        "absent.h5: No such file",
        "fix: give a file that mc run wrote",
    ]);
    Desk::new().mc(&["show", "."]).refused(&[
        ".: ",
        "directory",
        "fix: give a file that mc run wrote",
    ]);
    Desk::new()
        .mc(&["replay", "absent.h5", "--path", "3"])
        .refused(&["absent.h5: No such file", "give a file"]);
    Desk::new()
        .mc(&["show", "scene.toml"])
        .refused(&["scene.toml: not an HDF5 file"]);
    Desk::new()
        .mc(&["replay", "absent.h5"])
        .refused(&["--path"]);
}

#[test]
fn every_shipped_scenario_passes_the_check() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        // Data files lie beside the scenario that names them.
        if path.extension().is_some_and(|ending| ending != "toml") {
            continue;
        }
        let answer = Desk::new().mc(&["check", path.to_str().unwrap()]);
        assert!(
            answer.done().contains("# Derived quantities"),
            "{}",
            path.display()
        );
        seen += 1;
    }
    assert_eq!(seen, SHIPPED.len());
}

/// The output of `mc check` without the time of the run, which differs from one call to the next.
fn timeless(out: &str) -> Vec<&str> {
    out.lines()
        .filter(|line| !line.starts_with("# run time here"))
        .collect()
}

#[test]
fn what_check_prints_is_the_same_scenario() {
    let desk = Desk::new();
    let first = desk.mc(&[
        "check",
        "scene.toml",
        "--set",
        "friction.static=1.3",
        "--step",
        "0.005",
    ]);
    std::fs::write(desk.path("resolved.toml"), first.done()).unwrap();
    assert!(
        first.out.contains("static = 1.3")
            && first.out.contains("step = 0.005")
            && first.out.contains("seed = 1")
    );
    assert_eq!(
        timeless(desk.mc(&["check", "resolved.toml"]).done()),
        timeless(&first.out)
    );
    let json = desk.mc(&["check", "scene.toml", "--json"]);
    let value: serde_json::Value = serde_json::from_str(json.done()).unwrap();
    // 60 million path-steps take a tenth of a second. The bounds allow for a machine a hundred
    // times slower.
    let seconds = value["cpu_seconds"].as_f64().unwrap();
    assert!((0.005..10.0).contains(&seconds), "{seconds}");
}

#[test]
fn a_scenario_is_read_from_standard_input() {
    let desk = Desk::new();
    let piped = |line: &str| {
        let output = command::shell(desk.folder.path(), line);
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Answer {
            code: output.status.code(),
            out: text(output.stdout),
            err: text(output.stderr),
        }
    };
    assert!(
        piped("\"$0\" check - < scene.toml")
            .done()
            .contains("rho = 0.25")
    );
    piped("sed s/1.2/0.2/ scene.toml | \"$0\" check -")
        .refused(&["standard input:", "`friction.dynamic` = 1.0"]);
    piped("\"$0\" run - --paths 256 --quiet < scene.toml").done();
    assert!(desk.path("stdin.h5").is_file());
    // A sweep reads its scenario again for each point, and standard input can be read only once.
    let sweep = "--vary rho=temperature.noise.intensity=0.1:0.2:2 --paths 256 --no-bias --until 5";
    let from_file = format!("\"$0\" sweep scene.toml {sweep} --json -o file.h5");
    let second_point = |answer: Answer| {
        let sweep: serde_json::Value = serde_json::from_str(answer.done()).unwrap();
        sweep["data_vars"]["estimate"]["data"][1].to_string()
    };
    let from_pipe = format!("\"$0\" sweep - {sweep} --json -o again.h5 < scene.toml");
    assert_eq!(
        second_point(piped(&from_pipe)),
        second_point(piped(&from_file))
    );
    // A file of results also contains its scenario.
    piped("\"$0\" show stdin.h5 --scenario > again.toml").done();
    let [first, again] = ["scene.toml", "again.toml"]
        .map(|name| Scenario::read(&desk.path(name), &[]).unwrap().model);
    assert_eq!(first, again);
}

#[test]
fn shells_complete_schemes_statistics_and_keys() {
    for shell in ["bash", "zsh", "fish"] {
        let script = Desk::new().mc(&["completions", shell]);
        for word in [
            "event-driven",
            "stick_duration_mean",
            "friction.static=",
            "temperature.harmonics.0.amplitude=",
        ] {
            assert!(script.done().contains(word), "{shell}: {word}");
        }
    }
}

#[test]
fn check_derives_and_warns() {
    let out = Desk::new().mc(&["check", "scene.toml"]);
    for part in [
        "w/w0, forcing                                 0.25\n",
        "critical amplitude of the step           127.324",
        "half stick band in v        1.13137",
        "6e7",
        "roughly",
    ] {
        assert!(out.done().contains(part), "{part}\n{}", out.out);
    }
    let equal = Desk::new().mc(&["check", "scene.toml", "--set", "friction.dynamic=1.2"]);
    assert!(
        equal.done().contains("f_s = f_d under noise"),
        "{}",
        equal.out
    );
}

#[test]
fn check_in_json_is_json_alone() {
    let answer = Desk::new().mc(&["check", "scene.toml", "--json"]);
    let value: serde_json::Value = serde_json::from_str(answer.done()).unwrap();
    assert_eq!(value["derived"]["steps"], 6000);
    assert_eq!(value["derived"]["largest_step"], serde_json::Value::Null);
    assert_eq!(value["warnings"][0]["name"], "stick-exit-bias");
    assert!(value["resolved"].as_str().unwrap().contains("mass = 1.0"));
}

#[test]
fn init_writes_a_scenario_that_passes_and_never_overwrites() {
    let desk = Desk::new();
    desk.mc(&["init"]).done();
    desk.mc(&["check", "rho025.toml"]).done();
    desk.mc(&["init"])
        .refused(&["rho025.toml already exists", "--force"]);
    desk.mc(&["init", "--from", "shaw", "-o", "scene.toml"])
        .refused(&["scene.toml already exists"]);
    assert_eq!(
        std::fs::read_to_string(desk.path("scene.toml")).unwrap(),
        RHO025
    );
    desk.mc(&["init", "--from", "shaw", "-o", "scene.toml", "--force"])
        .done();
    assert!(
        std::fs::read_to_string(desk.path("scene.toml"))
            .unwrap()
            .contains("Shaw")
    );
    let whole = desk.mc(&["init", "--from", "rho025", "-o", "-"]);
    let scene =
        |text: &str| Scenario::parse("rho025", text, &[]).map_err(|error| error.to_string());
    assert_eq!(scene(whole.done()), scene(RHO025));
    // Every section is present. One that is not used takes effect when its `#` is removed.
    for section in [
        "[[temperature.harmonics]]",
        "[temperature.noise]",
        "[scheme]",
        "[statistics]",
        "[record]",
        "[units]",
    ] {
        assert!(whole.out.contains(&format!("\n{section}")), "{section}");
    }
    for (section, key) in [("[bearing]", "offset"), ("[temperature.series]", "max_gap")] {
        let part = whole.out.split_once(&format!("# {section}")).unwrap().1;
        let lines = part
            .lines()
            .take_while(|line| !line.is_empty())
            .map(|line| line.trim_start_matches("# "));
        let part: String = format!(
            "{section}{}",
            lines.map(|line| format!("{line}\n")).collect::<String>()
        );
        assert!(part.contains(key), "{part}");
        let error = scene(&(whole.out.clone() + &part)).err();
        // The CSV file of the example must be provided by the user.
        assert!(
            error
                .as_ref()
                .is_none_or(|error| error.contains("temperature.csv")),
            "{section}: {error:?}"
        );
    }
    let [noise, omega, f_s] = [
        "temperature.noise.intensity=0.4",
        "temperature.harmonics.0.angular_frequency=0.5",
        "friction.static=1.4",
    ];
    let flags = [
        "--set", f_s, "--set", omega, "--set", noise, "--title", "1.5", "--paths", "20k", "-o", "-",
    ];
    let changed = desk.mc(&[&["init"], &flags[..]].concat());
    let made = scene(changed.done()).unwrap();
    let temperature = &made.model.temperature;
    assert_eq!(
        (
            temperature.noises[0].intensity,
            temperature.harmonics[0].angular_frequency
        ),
        (0.4, 0.5)
    );
    assert_eq!(
        (
            made.model.friction.static_force,
            made.title.as_str(),
            made.ensemble.paths
        ),
        (1.4, "1.5", 20_000)
    );
    assert!(
        changed.out.starts_with(&format!(
            "# The shipped scenario rho025, with --set {f_s} --set {omega} --set {noise}"
        )),
        "{}",
        changed.out
    );
    let untitled = desk.mc(&["init", "--set", noise, "-o", "-"]);
    let title = scene(untitled.done()).unwrap().title;
    let change = noise.replace('=', " = ");
    assert!(title.ends_with(&format!("(changed: {change})")), "{title}");
    desk.mc(&["init", "--set", "friction.static=0.5", "-o", "-"])
        .refused(&["`friction.dynamic` = 1.0 must not exceed", "fix: "]);
    desk.mc(&["init", "--from", "nowhere"])
        .refused(&["nowhere", "rho025", "shaw"]);
}

#[test]
fn help_has_examples_and_version_has_a_commit() {
    let desk = Desk::new();
    assert!(
        desk.mc(&["--help"])
            .done()
            .contains("Start here:\n  mc init")
    );
    for verb in ["run", "check", "show", "init", "completions", "replay"] {
        assert!(
            desk.mc(&[verb, "--help"]).done().contains("Example"),
            "{verb}"
        );
    }
    let version = desk.mc(&["--version"]);
    let commit = version
        .done()
        .trim()
        .rsplit_once(" (")
        .unwrap()
        .1
        .trim_end_matches(')')
        .to_string();
    let is_hash = |text: &str, length: usize| {
        text.len() >= length && text.chars().all(|c| c.is_ascii_hexdigit())
    };
    // Where the commit is not all that the program was built from, a fingerprint of the sources
    // distinguishes it from other such programs.
    assert!(
        match commit.split('-').collect::<Vec<_>>()[..] {
            [hash] => is_hash(hash, 12),
            ["unknown", sources] => is_hash(sources, 16),
            [hash, "dirty", sources] => is_hash(hash, 12) && is_hash(sources, 16),
            _ => false,
        },
        "{commit}"
    );
}

/// The verbs that a help text lists.
fn verbs(help: &str) -> Vec<String> {
    let lines = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty());
    let verbs = lines.filter_map(|line| {
        line.strip_prefix("  ")
            .filter(|rest| !rest.starts_with(' '))
    });
    verbs
        .filter_map(|line| line.split_whitespace().next())
        .map(String::from)
        .collect()
}

/// The options that a help text lists, by their long names.
fn options(help: &str) -> Vec<String> {
    let lines = help
        .lines()
        .skip_while(|line| *line != "Options:")
        .skip(1)
        .take_while(|line| !line.is_empty());
    let lines = lines
        .map(str::trim_start)
        .filter(|line| line.starts_with('-'));
    let words = lines.flat_map(|line| line.split_whitespace().take(2));
    words
        .filter(|word| word.starts_with("--"))
        .map(String::from)
        .collect()
}

/// Every verb that `mc --help` lists and every option that `mc VERB --help` lists is in the script
/// of every shell.
#[test]
fn completions_know_every_verb_and_every_option() {
    let desk = Desk::new();
    let verbs = verbs(desk.mc(&["--help"]).done());
    assert!(
        verbs.len() >= 8 && verbs.contains(&"run".to_string()),
        "{verbs:?}"
    );
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = desk.mc(&["completions", shell]).done().to_string();
        for verb in &verbs {
            assert!(script.contains(verb.as_str()), "{shell}: {verb}");
            if verb == "help" {
                continue;
            }
            let options = options(desk.mc(&[verb, "--help"]).done());
            assert!(
                options.contains(&"--help".to_string()),
                "{verb}: {options:?}"
            );
            for option in options {
                // The script for fish has the options without hyphens.
                let word = if shell == "fish" {
                    format!("-l {}", &option[2..])
                } else {
                    option.clone()
                };
                let ends =
                    |next: Option<char>| next.is_none_or(|c| !c.is_alphanumeric() && c != '-');
                let is_known = script
                    .match_indices(&word)
                    .any(|(at, _)| ends(script[at + word.len()..].chars().next()));
                assert!(is_known, "{shell}: {verb} {option}");
            }
        }
    }
    desk.mc(&["completions", "cmd"]).refused(&["cmd", "bash"]);
}

/// The completions of bash for the beginnings of a verb, of options and of a value.
#[test]
fn bash_completes_verbs_options_and_values() {
    let desk = Desk::new();
    std::fs::write(
        desk.path("mc.bash"),
        desk.mc(&["completions", "bash"]).done(),
    )
    .unwrap();
    let complete = |words: &[&str]| {
        let (last, before) = (words[words.len() - 1], words[words.len() - 2]);
        let script = format!(
            "source mc.bash; COMP_WORDS=({}); COMP_CWORD={}; _mc mc '{last}' '{before}'; echo \"${{COMPREPLY[@]}}\"",
            words.join(" "),
            words.len() - 1
        );
        let mut bash = assert_cmd::Command::new("bash");
        let output = bash
            .current_dir(desk.folder.path())
            .args(["-c", &script])
            .timeout(command::LONGEST)
            .output();
        let output = output.expect("bash");
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        String::from_utf8(output.stdout).unwrap().trim().to_string()
    };
    assert_eq!(complete(&["mc", "ru"]), "run");
    assert_eq!(complete(&["mc", "t"]), "trade twin");
    assert_eq!(complete(&["mc", "run", "--path"]), "--paths");
    assert_eq!(
        complete(&["mc", "run", "--s"]),
        "--seed --scheme --step --set --statistic"
    );
    assert_eq!(complete(&["mc", "replay", "--p"]), "--path");
    assert_eq!(complete(&["mc", "completions", "z"]), "zsh");
}

/// The output grid has at most 100 000 rows, including the first one. One more row is refused, and
/// the message proposes a grid that is allowed, with a step and without one.
#[test]
fn a_hundred_thousand_rows_are_kept_and_one_more_is_refused() {
    let check = |scheme: &str, end: &str| {
        let flags = [
            "--scheme",
            scheme,
            "--step",
            "0.25",
            "--until",
            end,
            "--set",
            "time.output_step=1",
        ];
        let flags = if scheme == "event-driven" {
            [&flags[..2], &flags[4..]].concat()
        } else {
            flags.to_vec()
        };
        Desk::new().mc(&[&["check", "scene.toml"][..], &flags].concat())
    };
    for scheme in ["discrete-vi", "corrected-vi", "event-driven"] {
        check(scheme, "99999").done();
        let says = [
            "an output grid of 100001 rows",
            "at most 100000 are supported",
            "fix: write `time.output_step` = ",
        ];
        check(scheme, "100000").refused(&says);
    }
}

#[test]
fn a_closed_pipe_is_a_quiet_exit() {
    for arguments in [
        &["check", "scene.toml"][..],
        &["init", "-o", "-"],
        &["completions", "bash"],
        &["--help"],
    ] {
        let desk = Desk::new();
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Running::mc_into(writer.into(), desk.folder.path(), arguments).end();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{arguments:?}");
    }
}

#[test]
fn a_scheme_is_answered_with_what_it_takes() {
    let check =
        |arguments: &[&str]| Desk::new().mc(&[&["check", "scene.toml"], arguments].concat());
    check(&["--tolerance", "1e-4"]).refused(&[
        "--tolerance 1e-4: `scheme.tolerance`",
        "discrete-vi",
        "fix: remove it",
    ]);
    check(&["--scheme", "corrected-vi", "--tolerance", "1e-4"])
        .refused(&["corrected-vi", "event-driven"]);
    check(&["--scheme", "event-driven", "--tolerance", "0"])
        .refused(&["from 1e-9 to 0.1", "fix: "]);
    check(&["--scheme", "event-drivn"])
        .refused(&["--scheme event-drivn: ", "did you mean \"event-driven\"?"]);
    check(&["--scheme", "euler"])
        .refused(&["\"discrete-vi\", \"corrected-vi\", \"event-driven\", \"quasi-static\""]);
    check(&["--scheme", "event-driven", "--step", "0.1"]).refused(&[
        "--step 0.1: ",
        "has no time step",
        "scheme.kind = ",
    ]);
    check(&[
        "--scheme",
        "corrected-vi",
        "--step",
        "1",
        "--set",
        "time.output_step=1",
    ])
    .refused(&[
        "--step 1: `time.step` = 1.0",
        "f_s",
        "shift",
        "fix: choose `time.step` below 0.471",
    ]);
    let place = format!("scene.toml:{}:", line_of("[ensemble]") + 1);
    check_with("[ensemble]", "[scheme]\ntolerance = 1e-3\n[ensemble]")
        .refused(&[&place, "`scheme.tolerance`"]);
    let stepless = RHO025
        .lines()
        .filter(|line| !line.starts_with("step"))
        .collect::<Vec<_>>()
        .join("\n");
    Desk::with(&stepless)
        .mc(&["check", "scene.toml"])
        .refused(&["missing key `time.step`"]);
    Desk::with(&stepless)
        .mc(&["check", "scene.toml", "--scheme", "event-driven"])
        .done();
}

#[test]
fn check_says_what_a_scheme_does_with_the_step() {
    let check =
        |arguments: &[&str]| Desk::new().mc(&[&["check", "scene.toml"], arguments].concat());
    for scheme in ["event-driven", "quasi-static"] {
        let out = check(&["--scheme", scheme]);
        for part in [
            &*format!("# no step: the {scheme} scheme does not use one"),
            "tolerance = 0.001",
        ] {
            assert!(out.done().contains(part), "{part}\n{}", out.out);
        }
        assert!(
            !out.out.contains("stability") && !out.out.contains("sqrt(h)"),
            "{}",
            out.out
        );
        let desk = Desk::with(&out.out);
        assert_eq!(
            timeless(desk.mc(&["check", "scene.toml"]).done()),
            timeless(&out.out)
        );
        // The tolerance is dropped when another scheme is chosen.
        desk.mc(&[
            "check",
            "scene.toml",
            "--scheme",
            "discrete-vi",
            "--step",
            "0.01",
        ])
        .done();
    }
    assert!(
        check(&["--scheme", "corrected-vi"])
            .done()
            .contains("shift of f_s")
    );
    let equal = check(&["--scheme", "event-driven", "--set", "friction.dynamic=1.2"]);
    assert!(
        equal.done().contains("shortest slip resolved")
            && equal.out.contains("depend on that resolution")
    );
    let json = check(&["--scheme", "event-driven", "--json"]);
    let value: serde_json::Value = serde_json::from_str(json.done()).unwrap();
    assert_eq!(
        (
            value["derived"]["tolerance"].as_f64(),
            value["derived"]["steps"].is_null()
        ),
        (Some(1e-3), true)
    );
    assert_eq!(value["warnings"].as_array().map(Vec::len), Some(1));
    assert_eq!(value["warnings"][0]["name"], "few-periods");
}
