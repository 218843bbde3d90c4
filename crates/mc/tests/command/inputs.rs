//! `mc` with measured inputs and numbers that name a parameter: what is read, said, stored and
//! refused.

use crate::command::{done, json, mc, refused, text};
use crate::measured::slid;
use std::f64::consts::PI;
use std::path::Path;

const GRAVITY: f64 = 9.80665;
const STEP: f64 = 0.02;

/// 500 rows of quiet noise with one sine pulse of 0.5 g for 0.08 s, in g.
fn quiet_with_a_pulse() -> Vec<f64> {
    let noise = |i: usize| 1e-4 * ((i * 7919 % 1000) as f64 / 500.0 - 1.0);
    let pulse = |i: usize| {
        if (250..=254).contains(&i) {
            0.5 * ((i - 250) as f64 * PI / 4.0).sin()
        } else {
            0.0
        }
    };
    (0..500)
        .map(|i| ((noise(i) + pulse(i)) * 1e7).round() / 1e7)
        .collect()
}

fn csv(names: &str, samples: &[f64]) -> String {
    let rows = samples
        .iter()
        .enumerate()
        .map(|(i, a)| format!("{:.2},{a}\n", STEP * i as f64));
    format!("{names}\n{}", rows.collect::<String>())
}

/// A block that begins to slide at 0.2 g on ground that is shaken by `quake.csv`.
const BLOCK: &str = "[oscillator]\nmass = 1\nstiffness = 0\ndilatation = 0\n[friction]\nstatic = 1.96133\ndynamic = 1.96133\n\
     [input.ag]\nfile = \"quake.csv\"\ncolumn = \"acc\"\n[force]\nexpression = \"m*ag\"\n[parameters]\nm = 1\n[initial]\n\
     displacement = 0\n[scheme]\nkind = \"event-driven\"\n";

fn block(csv: &str) -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("quake.csv"), csv).expect("written");
    std::fs::write(here.path().join("block.toml"), BLOCK).expect("written");
    here
}

fn run(here: &Path, scenario: &str, set: &[&str]) -> f64 {
    done(
        here,
        &[
            &["run", scenario, "-o", "block.h5", "--force", "--paths", "1"],
            set,
        ]
        .concat(),
    );
    let shown = json(&done(here, &["show", "block.h5", "--json"]));
    shown["statistics"]["displacement_end_mean"]["estimate"]
        .as_f64()
        .expect("a number")
}

/// Every value acts, in g, as a header, a key or a row of units says it; what the test steps through
/// in 2e5 parts of a row slides as far, within 1e-7 of 6 mm.
#[test]
fn a_block_slides_as_far_as_a_record_in_any_unit_takes_it() {
    let samples = quiet_with_a_pulse();
    let si: Vec<f64> = samples.iter().map(|a| a * GRAVITY).collect();
    let wanted = slid(&si, STEP, 0.2 * GRAVITY);
    assert!(wanted > 6e-3, "{wanted}");
    let gal: Vec<f64> = si.iter().map(|a| a * 100.0).collect();
    let kilonewton: Vec<f64> = si.iter().map(|a| a / 1000.0).collect();
    for (names, samples, said) in [
        (
            "time_s,acc (g's)",
            &samples,
            "from g to m/s2, times 9.80665",
        ),
        ("time_s,acc [m/s^2]", &si, "in m/s2"),
        ("time_s,acc\ns,m/s\u{b2}", &si, "in m/s2"),
        ("Time (s),acc gal", &gal, "from gal to m/s2, times 0.01"),
        ("Time (s),acc [kN]", &kilonewton, "from kN to N, times 1000"),
        ("time_s,acc", &si, "read in SI units (no unit given)"),
    ] {
        let here = block(&csv(names, samples));
        let checked = done(here.path(), &["check", "block.toml"]);
        let line = checked
            .lines()
            .find(|line| line.starts_with("# input ag"))
            .expect("a line");
        assert!(
            line.contains(said) && line.contains("500 samples to t = 9.98"),
            "{line}"
        );
        let found = run(here.path(), "block.toml", &[]);
        assert!((found - wanted).abs() < 1e-7, "{names}: {found} {wanted}");
    }
    let here = block(&csv("time_s,acc", &samples));
    let found = run(here.path(), "block.toml", &["--set", "input.ag.unit=g"]);
    assert!((found - wanted).abs() < 1e-7, "{found} {wanted}");
}

/// A column without a unit is taken as it is, with a warning of the run; one in a unit that is not
/// known, or of marks of missing values, is not taken silently either.
#[test]
fn a_run_warns_of_an_input_without_a_unit() {
    let said = |names: &str, set: &[&str]| {
        let here = block(&csv(names, &quiet_with_a_pulse()));
        let output = mc(
            here.path(),
            &[&["run", "block.toml", "--paths", "1"], set].concat(),
        );
        (output.status.code(), text(&output.stderr))
    };
    let warns = "in SI units (no unit given";
    let (code, stderr) = said("time_s,acc", &[]);
    assert!(
        code == Some(0) && stderr.contains("warning: quake.csv") && stderr.contains(warns),
        "{stderr}"
    );
    for set in ["input.ag.unit=g", "input.ag.unit=none"] {
        let (code, stderr) = said("time_s,acc", &["--set", set]);
        assert!(code == Some(0) && !stderr.contains(warns), "{stderr}");
    }
    let (code, stderr) = said("time_s,acc_ft/s", &["--set", "input.ag.column=acc_ft/s"]);
    assert!(
        code == Some(2) && stderr.contains("the unknown unit `ft/s`"),
        "{stderr}"
    );
    // The name of an input in capitals finds its column.
    let here = block(&csv("time_s,AG_mg", &quiet_with_a_pulse()));
    let capitals = BLOCK
        .replace("input.ag", "input.AG")
        .replace("m*ag", "m*AG")
        .replace("column = \"acc\"\n", "");
    std::fs::write(here.path().join("capitals.toml"), capitals).expect("written");
    let checked = done(here.path(), &["check", "capitals.toml"]);
    assert!(
        checked.contains("from mg to m/s2, times 0.00980665"),
        "{checked}"
    );
}

/// A file of values alone, with the step that the scenario gives, is the same record; what check
/// prints can be run.
#[test]
fn values_with_a_step_are_the_same_as_in_csv() {
    let samples = quiet_with_a_pulse();
    let here = block(&csv("time_s,acc (g)", &samples));
    let by_csv = run(here.path(), "block.toml", &[]);
    let rows: Vec<String> = samples.iter().map(|a| format!("9 {a}\n")).collect();
    std::fs::write(here.path().join("a.txt"), rows.concat()).expect("written");
    let keys = "file = \"a.txt\"\nstep = 0.02\nunit = \"g\"\ncolumn = \"2\"";
    let stepped = BLOCK.replace("file = \"quake.csv\"\ncolumn = \"acc\"", keys);
    std::fs::write(here.path().join("step.toml"), &stepped).expect("written");
    assert!((run(here.path(), "step.toml", &[]) - by_csv).abs() < 1e-12);
    std::fs::write(
        here.path().join("checked.toml"),
        done(here.path(), &["check", "step.toml"]),
    )
    .expect("written");
    assert!((run(here.path(), "checked.toml", &[]) - by_csv).abs() < 1e-12);
    refused(
        here.path(),
        &["check", "step.toml", "--set", "input.ag.step=0"],
        2,
        &["input.ag.step", "above 0"],
    );
}

/// A record in the format AT2 is the same numbers as in CSV, but for the rounding of the times.
#[test]
fn an_at2_file_is_the_same_numbers_as_in_csv() {
    let samples = quiet_with_a_pulse();
    let here = block(&csv("time_s,acc (g)", &samples));
    let by_csv = run(here.path(), "block.toml", &[]);
    let values: Vec<String> = samples.iter().map(|a| format!("{a:15.7E}")).collect();
    let rows: String = values.chunks(5).map(|row| row.concat() + "\n").collect();
    let record = |header: &str, rows: &str| {
        let head = format!(
            "A RECORD\nA PLACE, 1/1/2000\nACCELERATION TIME SERIES IN UNITS OF G\n{header}\n"
        );
        std::fs::write(here.path().join("quake.AT2"), head + rows).expect("written");
    };
    std::fs::write(
        here.path().join("at2.toml"),
        BLOCK.replace("quake.csv\"\ncolumn = \"acc\"", "quake.AT2\""),
    )
    .expect("written");
    record("NPTS=    500, DT=   .0200 SEC,", &rows);
    let is_same = |scenario: &str| (run(here.path(), scenario, &[]) - by_csv).abs() < 1e-12;
    assert!(is_same("at2.toml"));
    // What check prints can be run, and says the unit.
    let checked = done(here.path(), &["check", "at2.toml"]);
    assert!(checked.contains("unit = \"g\""), "{checked}");
    std::fs::write(here.path().join("checked.toml"), checked).expect("written");
    assert!(is_same("checked.toml"));
    for (header, rows, says) in [
        (
            "NPTS=    501, DT=   .0200 SEC,",
            rows.clone(),
            "has 500 values, but its header says NPTS = 501",
        ),
        (
            "NPTS=    500, DT=  -.0200 SEC,",
            rows.clone(),
            "is not the header of a record",
        ),
        (
            "NPTS=    500, DT=   .0200 SEC,",
            rows.replacen(&values[7], "  none", 1),
            "quake.AT2:6: `none` is not a number",
        ),
    ] {
        record(header, &rows);
        refused(
            here.path(),
            &["check", "at2.toml"],
            2,
            &[says, "input.ag.file", "fix: "],
        );
    }
}

/// A run is shown, replayed, verified and run again without the file of its input.
#[test]
fn results_hold_their_inputs() {
    let here = block(&csv("time_s,acc (g)", &quiet_with_a_pulse()));
    let here = here.path();
    let slid = run(here, "block.toml", &[]);
    std::fs::remove_file(here.join("quake.csv")).expect("removed");
    let shown = done(here, &["show", "block.h5", "--scenario"]);
    assert!(
        shown.contains("[input.ag]") && shown.contains("unit = \"g\"") && shown.contains("hash = "),
        "{shown}"
    );
    done(
        here,
        &["replay", "block.h5", "--path", "0", "-o", "path.h5"],
    );
    done(here, &["verify", "block.h5", "--again"]);
    let file = hdf5::File::open(here.join("block.h5")).expect("opens");
    let rows = |name: &str| {
        file.dataset(name)
            .expect("there")
            .read_raw::<f64>()
            .expect("numbers")
    };
    assert_eq!(
        (rows("input_time").len(), rows("input_value")[252]),
        (500, 9.80665 * quiet_with_a_pulse()[252])
    );
    assert!(slid > 6e-3);
}

/// What is wrong with an input, and its remedy.
#[test]
fn what_is_no_input_is_refused_with_its_row_and_a_remedy() {
    let sound = csv("time_s,acc (g)", &quiet_with_a_pulse());
    let file = |from: &str, to: &str, says: &[&str]| {
        let here = block(&sound.replacen(from, to, 1));
        refused(
            here.path(),
            &["check", "block.toml"],
            2,
            &[says, &["fix: "]].concat(),
        );
    };
    let row = sound.lines().nth(3).expect("a row");
    file(
        row,
        "0.04,",
        &[
            "quake.csv:4",
            "`acc (g)` = \"\" is not a number",
            "not repaired",
        ],
    );
    file(
        row,
        "0.04,NaN",
        &["quake.csv:4", "`acc (g)` = \"NaN\" is not a number"],
    );
    file(
        row,
        "0.04,strong",
        &["quake.csv:4", "`acc (g)` = \"strong\" is not a number"],
    );
    file(
        row,
        "0.01,0.5",
        &[
            "quake.csv:4",
            "the time of this row is before that of line 3",
            "sort the rows",
        ],
    );
    file(
        row,
        "0.02,0.5\n0.02,0.7",
        &[
            "quake.csv:5",
            "a third value of `acc (g)` at the time of line 4",
        ],
    );
    file(
        "acc (g)",
        "acc (furlong)",
        &["unknown unit `furlong`", "m/s2, cm/s2, mm/s2"],
    );
    file("acc (g)", "speed", &["no column is called `acc`"]);
    let here = block(&sound);
    let set = |set: &str, says: &[&str]| {
        refused(
            here.path(),
            &["check", "block.toml", "--set", set],
            2,
            &[says, &["fix: "]].concat(),
        );
    };
    set(
        "time.end=20",
        &[
            "beyond the last sample of the input `ag` (quake.csv), at 9.98",
            "lower `time.end`",
        ],
    );
    set(
        "units.length=mm",
        &["is converted to m/s2, but `units.length` is \"mm\""],
    );
    set("units.time=ms", &["has times in seconds"]);
    set(
        "input.ag.max_gap=1",
        &["unknown key `max_gap`", "`input` takes file, time, column"],
    );
    set(
        "input.ag.hash=abc",
        &["the samples differ from those of `input.ag.hash`"],
    );
    set("input.ag={}", &["missing key `input.ag.file`"]);
    set(
        "input.ag=3",
        &["`input.ag` = 3 is a whole number", "a table"],
    );
    set(
        "force.expression=m*x",
        &[
            "`input.ag` is not used in any expression",
            "use `ag` in `force.expression`",
        ],
    );
    for (name, says) in [
        ("t", "must not contain the reserved name `t`"),
        ("xdot", "must not contain the reserved name `xdot`"),
        (
            "direction",
            "must not contain the reserved name `direction`",
        ),
        ("max", "must not contain the reserved name `max`"),
        ("m", "a parameter and an input are called `m`"),
        ("a-b", "`a-b` cannot be the name of an input"),
    ] {
        let text = BLOCK.replace("input.ag", &format!("input.{name}"));
        std::fs::write(here.path().join("named.toml"), text).expect("written");
        refused(
            here.path(),
            &["check", "named.toml"],
            2,
            &[says, "named.toml:", "fix: "],
        );
    }
    std::fs::write(
        here.path().join("other.toml"),
        BLOCK.replace("m*ag", "m*at"),
    )
    .expect("written");
    refused(
        here.path(),
        &["check", "other.toml"],
        2,
        &["unknown name `at`", "the input ag"],
    );
}

/// Two inputs, in force and in load, with stamps and with seconds.
#[test]
fn inputs_with_stamps_begin_together() {
    let here = block(&csv("time_s,acc (g)", &quiet_with_a_pulse()));
    let rows = |minute: usize| {
        format!(
            "time,n [kN]\n2020-01-01T00:0{minute}:00Z,0.001\n2020-01-01T00:0{minute}:30Z,0.002\n"
        )
    };
    for (name, minute) in [("a.csv", 0), ("b.csv", 1)] {
        std::fs::write(here.path().join(name), rows(minute)).expect("written");
    }
    let two = |other: &str| {
        let more = format!(
            "[input.n]\nfile = \"a.csv\"\n[input.p]\nfile = \"{other}\"\ncolumn = \"n\"\n[input.ag]"
        );
        let text = BLOCK
            .replace("[input.ag]", &more)
            .replace("static = 1.96133", "static = 1.96133\nload = \"n + 0*p\"");
        std::fs::write(here.path().join("two.toml"), text).expect("written");
    };
    two("a.csv");
    let checked = done(here.path(), &["check", "two.toml"]);
    assert!(
        checked.contains("# input n") && checked.contains("from kN to N"),
        "{checked}"
    );
    assert!(
        checked.contains("time.end") || checked.contains("end = 9.98"),
        "{checked}"
    );
    two("b.csv");
    refused(
        here.path(),
        &["check", "two.toml"],
        2,
        &["both must begin at t = 0", "common start"],
    );
}

/// A belt whose speed is one number for the line and for the friction that falls with speed.
const BELT: &str = "oscillator = { mass = 1, stiffness = 1, dilatation = 1 }\nfriction = { static = 1.2, dynamic = 1.0, load = \"1 + 0*x0*mu\" }\n\
     temperature.trend = \"V\"\nforce.expression = \"mu*(1 - exp(-abs(xdot)/V))*sign(xdot)\"\n\
     parameters = { mu = 0.3, V = 0.5, x0 = 0.25 }\ninitial = { displacement = \"x0\", velocity = 0 }\ntime.end = 20\nscheme.kind = \"event-driven\"\n";

#[test]
fn a_number_may_name_a_parameter() {
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    std::fs::write(here.join("belt.toml"), BELT).expect("written");
    let checked = done(here, &["check", "belt.toml"]);
    assert!(
        checked.contains("trend = \"V\"") && checked.contains("displacement = \"x0\""),
        "{checked}"
    );
    let sweep = [
        "sweep",
        "belt.toml",
        "--vary",
        "V=0.2,0.4",
        "--paths",
        "1",
        "-o",
        "v.h5",
    ];
    done(here, &sweep);
    let swept = json(&done(here, &["show", "v.h5", "--json"]));
    let text = swept.to_string();
    for speed in ["0.2", "0.4"] {
        let numbers = BELT
            .replace("\"V\"", speed)
            .replace("\"x0\"", "0.25")
            .replace("V = 0.5", &format!("V = {speed}"));
        std::fs::write(here.join("numbers.toml"), numbers).expect("written");
        let found = run(here, "numbers.toml", &[]);
        assert!(
            text.contains(&found.to_string()),
            "{speed}: {found}: {text}"
        );
    }
    // It is stored as it is written, and run again from the file.
    done(here, &["run", "belt.toml", "-o", "run.h5", "--paths", "1"]);
    assert!(done(here, &["show", "run.h5", "--scenario"]).contains("trend = \"V\""));
    done(here, &["verify", "run.h5", "--again"]);
    // A parameter that is 0 stays in the text, and so in use.
    let zero = [
        "--set",
        "force.expression=mu*V*x^3",
        "--set",
        "V=0",
        "--set",
        "initial.velocity=V",
    ];
    done(
        here,
        &[
            &["run", "belt.toml", "-o", "zero.h5", "--paths", "1"],
            &zero[..],
        ]
        .concat(),
    );
    done(here, &["verify", "zero.h5", "--again"]);
    // A value of its own takes its place.
    let own = done(
        here,
        &["check", "belt.toml", "--set", "temperature.trend=0.1"],
    );
    assert!(own.contains("trend = 0.1"), "{own}");
    let wrong = BELT.replace("trend = \"V\"", "trend = \"W\"");
    std::fs::write(here.join("wrong.toml"), wrong).expect("written");
    let says = [
        "wrong.toml:3:21",
        "\"W\"",
        "is neither a number nor a parameter",
        "name a parameter: \"mu\", \"V\", \"x0\"",
        "^",
    ];
    refused(here, &["check", "wrong.toml"], 2, &says);
}

/// A parameter that only a number names is used; one that nothing names is not.
#[test]
fn a_parameter_of_numbers_alone_is_used() {
    let here = tempfile::tempdir().expect("a folder");
    let text = BELT.replace("abs(xdot)/V", "abs(xdot)/0.1");
    std::fs::write(here.path().join("belt.toml"), &text).expect("written");
    done(here.path(), &["check", "belt.toml"]);
    std::fs::write(here.path().join("belt.toml"), text.replace("\"V\"", "0.5")).expect("written");
    refused(
        here.path(),
        &["check", "belt.toml"],
        2,
        &["`parameters.V` is not used"],
    );
}
