//! `mc fit-temperature`, `mc forecast` and measurements in two files, as a person uses them.

use crate::command::{TWIN as DATA, done, hundred_days, json, mc, refused};
use serde_json::Value;
use std::fs;
use std::path::Path;

const BEARING: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/bridge/bearing.toml"
);
const TRUTH: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/bridge/bridge.toml"
);

/// These columns of measurements, from this row on.
fn columns(data: &Path, of: &[usize], from: usize) -> String {
    let text = fs::read_to_string(data).expect("measurements");
    let mut lines = text.lines();
    let mut cut = String::new();
    for line in lines.next().into_iter().chain(lines.skip(from)) {
        let cells: Vec<&str> = line.split(',').collect();
        cut += &(of.iter().map(|i| cells[*i]).collect::<Vec<_>>().join(",") + "\n");
    }
    cut
}

/// Temperatures and displacements in two files give the same as in one file, also if the
/// displacements begin a week later.
#[test]
fn two_files_say_what_one_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let data = hundred_days(path);
    let all = path.join(data);
    for (name, of, from) in [
        ("t.csv", [0, 1], 0),
        ("z.csv", [0, 2], 0),
        ("late.csv", [0, 2], 1008),
    ] {
        fs::write(path.join(name), columns(&all, &of, from)).expect("written");
    }
    let calibrated = |data: &str, more: &[&str]| {
        let arguments = [
            &["calibrate", BEARING, data, "--method", "slips", "--json"],
            more,
        ]
        .concat();
        json(&done(path, &arguments))
    };
    let one = calibrated(data, &[]);
    assert_eq!(calibrated("z.csv", &["--temperature-file", "t.csv"]), one);
    let late = calibrated("late.csv", &["--temperature-file", "t.csv"]);
    let slips = |reported: &Value| {
        let times = reported["slips"]
            .as_array()
            .expect("slips")
            .iter()
            .map(|slip| slip["time"].as_f64().expect("a time"));
        times
            .filter(|time| *time > 8.0 * 86_400.0)
            .collect::<Vec<_>>()
    };
    // The same slips are found at the same times, except for a few that the noise hides.
    let (of_one, of_late) = (slips(&one), slips(&late));
    let found = of_one.iter().filter(|time| of_late.contains(time)).count();
    assert!(
        found * 100 >= of_one.len() * 95,
        "{found} of {}",
        of_one.len()
    );

    fs::write(path.join("n.csv"), "time_s,displacement_mm\n0,1\n600,1.1\n").expect("written");
    let arguments = [
        "calibrate",
        BEARING,
        "n.csv",
        "--temperature-file",
        "t.csv",
        "--set",
        "temperature.series.time=time_s",
    ];
    refused(path, &arguments, 2, &["n.csv: its times are numbers"]);
}

/// A footer is refused with its line and a fix, left out and counted where that is asked for; a list
/// of marks is refused.
#[test]
fn a_footer_is_left_out_where_that_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let text = columns(Path::new(DATA), &[0, 1], 0);
    let rows: Vec<&str> = text.lines().take(2000).collect();
    fs::write(path.join("t.csv"), rows.join("\n") + "\nEnd of record\n").expect("written");
    let plain = ["fit-temperature", "t.csv", "--periods", "none"];
    let footer = ["t.csv:2001: 1 cell", "`--skip-bad`"];
    refused(path, &plain, 2, &footer);
    let skipping = mc(path, &[&plain[..], &["--skip-bad"]].concat());
    let said = String::from_utf8_lossy(&skipping.stderr);
    assert!(
        said.contains("left out 1 line that cannot be read, the first in line 2001"),
        "{said}"
    );
    let marks = [&plain[..], &["--missing=-999,-9999"]].concat();
    refused(path, &marks, 2, &["write --missing once for each mark"]);
}

/// Two loggers with their own separators, names, dates, marks, units and encodings say what the one
/// file says, by flags and by a scenario, and two refusals are enough to learn how.
#[test]
fn two_loggers_say_what_one_file_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let data = hundred_days(path);
    let text = fs::read_to_string(path.join(data)).expect("measurements");
    let rows: Vec<Vec<&str>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let mut air = String::from("Messstelle 7\nZeitpunkt;Luft \u{b0}C\n");
    let mut gauge = String::from("Plot Title: pier 3\nWhen,At,gauge 3\n,,mm\n");
    for row in &rows {
        let (date, time) = row[0]
            .trim_end_matches('Z')
            .split_once('T')
            .expect("a stamp");
        let [year, month, day] = [&date[..4], &date[5..7], &date[8..]];
        air += &format!("{day}.{month}.{year} {time};{}\n", row[1].replace('.', ","));
        let hour: u32 = time[..2].parse().expect("an hour");
        let (half, hour) = (
            if hour < 12 { "AM" } else { "PM" },
            if hour.is_multiple_of(12) {
                12
            } else {
                hour % 12
            },
        );
        gauge += &format!(
            "{month}/{day}/{},{hour}:{} {half},{}\n",
            &year[2..],
            &time[3..],
            row[2]
        );
    }
    air += "01.01.2030 00:00;9999,9\n";
    let latin: Vec<u8> = air.chars().map(|c| c as u8).collect();
    fs::write(path.join("air.csv"), latin).expect("written");
    fs::write(path.join("gauge.csv"), gauge).expect("written");
    let base = [
        "calibrate",
        BEARING,
        "gauge.csv",
        "--temperature-file",
        "air.csv",
        "--method",
        "slips",
        "--json",
    ];
    let columns = [
        "--temperature",
        "Luft \u{b0}C",
        "--temperature-time",
        "Zeitpunkt",
        "--time",
        "When,At",
        "--displacement",
        "gauge 3",
    ];
    let rest = ["--zone", "UTC"];
    refused(
        path,
        &base,
        2,
        &[
            "air.csv",
            "gauge.csv",
            "--temperature-time",
            "--temperature ",
            "--displacement ",
        ],
    );
    refused(
        path,
        &[&base[..], &columns].concat(),
        2,
        &["air.csv", "gauge.csv", "--zone UTC"],
    );
    let mut two = json(&done(path, &[&base[..], &columns, &rest].concat()));
    let mut one = json(&done(
        path,
        &["calibrate", BEARING, data, "--method", "slips", "--json"],
    ));
    // The repairs name the files.
    for document in [&mut two, &mut one] {
        document
            .as_object_mut()
            .expect("an object")
            .remove("repairs");
    }
    assert_eq!(two, one);
    // The same in the scenario, without flags.
    let series = "\n[temperature.series]\nfile = \"air.csv\"\ntime = \"Zeitpunkt\"\nvalue = \"Luft \u{b0}C\"\nzone = \"UTC\"\n\
                  dates = \"dmy\"\n[displacement.series]\nfile = \"gauge.csv\"\ntime = \"When,At\"\nvalue = \"gauge 3\"\n\
                  dates = \"mdy\"\n";
    fs::write(
        path.join("two.toml"),
        fs::read_to_string(BEARING).expect("a bearing") + series,
    )
    .expect("written");
    let named = json(&done(
        path,
        &["calibrate", "two.toml", "--method", "slips", "--json"],
    ));
    assert_eq!(named["parameters"], one["parameters"]);
    refused(
        path,
        &["calibrate", BEARING],
        2,
        &["no measurement given", "[displacement.series]"],
    );
    refused(
        path,
        &[
            "calibrate",
            "two.toml",
            "--set",
            "displacement.series.dats=dmy",
        ],
        2,
        &["dates"],
    );
}

/// A daily record needs no option, and what its samples cannot tell is refused by name.
#[test]
fn harmonics_are_those_that_the_samples_tell() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    // 900 days, and as many half days, with a wave of a year of samples and a noise that is the same
    // in each run. Of half days, the wave lasts half a year.
    let mut state = 12_345u64;
    let mut weather = 0.0;
    let mut daily = String::from("time_d,temperature_degC\n");
    let mut half = String::from("time_h,temperature_degC\n");
    for day in 0..900u32 {
        state = (1_103_515_245 * state + 12_345) % (1 << 31);
        weather = 0.7 * weather + 3.0 * (state as f64 / (1u64 << 31) as f64 - 0.5);
        let value = 10.0 + 9.0 * (f64::from(day) * std::f64::consts::TAU / 365.25).cos() + weather;
        daily += &format!("{day},{value:.2}\n");
        half += &format!("{},{value:.2}\n", 12 * day);
    }
    fs::write(path.join("daily.csv"), daily).expect("written");
    fs::write(path.join("half.csv"), half).expect("written");
    let found = json(&done(
        path,
        &["fit-temperature", "daily.csv", "--processes", "1", "--json"],
    ));
    let harmonics = found["harmonics"].as_array().expect("harmonics");
    assert_eq!(harmonics.len(), 1);
    assert!(
        (harmonics[0]["amplitude"].as_f64().expect("a number") - 9.0).abs() < 2.0,
        "{found}"
    );
    let half = ["fit-temperature", "half.csv", "--periods", "1d"];
    refused(
        path,
        &half,
        1,
        &["samples are 12 h apart, too far to resolve a harmonic of 1 d"],
    );
}

/// The section that is written reads back as the temperature that is printed, and makes a scenario
/// together with the bearing.
#[test]
fn a_fitted_temperature_is_a_part_of_a_scenario() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let reported = json(&done(
        path,
        &["fit-temperature", DATA, "--json", "-o", "weather.toml"],
    ));
    let part = fs::read_to_string(path.join("weather.toml")).expect("the part");
    let read: toml::Table = part.parse().expect("TOML");
    let temperature = &read["temperature"];
    let number = |value: &toml::Value| value.as_float().expect("a number");
    // JSON is read to a unit in the last place.
    let ratio = number(&temperature["harmonics"][0]["amplitude"])
        / reported["mean"][0].as_f64().expect("a mean");
    assert!((ratio - 1.0).abs() < 1e-15, "{ratio}");
    for (i, process) in reported["processes"]
        .as_array()
        .expect("processes")
        .iter()
        .enumerate()
    {
        let noise = &temperature["noise"][i];
        let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        near(
            number(&noise["intensity"]),
            process["sd"].as_f64().expect("an sd"),
        );
        near(
            number(&noise["relaxation_rate"]),
            process["relaxation_rate"].as_f64().expect("a rate"),
        );
        // v has the standard deviation 1.
        near(
            number(&noise["diffusion"]).powi(2),
            2.0 * number(&noise["relaxation_rate"]),
        );
    }
    let year = fs::read_to_string(BEARING).expect("a bearing") + &part;
    fs::write(path.join("year.toml"), &year).expect("written");
    let checked = done(path, &["check", "year.toml"]);
    assert_eq!(
        checked.matches("[[temperature.noise]]").count(),
        2,
        "{checked}"
    );

    refused(
        path,
        &[
            "check",
            "year.toml",
            "--scheme",
            "discrete-vi",
            "--step",
            "1",
        ],
        2,
        &["two noises", "event-driven"],
    );
    let third = "\n[[temperature.noise]]\nintensity = 1.0\n";
    fs::write(path.join("three.toml"), year + third).expect("written");
    refused(
        path,
        &["check", "three.toml"],
        2,
        &["a third noise", "three.toml:", "| intensity = 1.0\n"],
    );
    refused(
        path,
        &["fit-temperature", DATA, "--periods", "3000d"],
        1,
        &["half a period", "leave it out"],
    );
    refused(
        path,
        &["fit-temperature", DATA, "--periods", "often"],
        2,
        &["365.25d"],
    );
    refused(
        path,
        &["fit-temperature", DATA, "--periods", "1d,24h"],
        2,
        &["lists a period twice", "each period once"],
    );
    refused(
        path,
        &["fit-temperature", DATA, "-o", DATA, "--force"],
        2,
        &["is an input of this command"],
    );
}

/// There are forces only if K_BP is known. The output is the same for any number of threads, and
/// all years are written.
#[test]
fn a_forecast_says_what_can_be_known() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let few = [
        "forecast", BEARING, DATA, "--draws", "4", "--years", "3", "--json",
    ];
    let reported = done(
        path,
        &[&few[..], &["--threads", "1", "-o", "years.csv"]].concat(),
    );
    assert_eq!(
        done(path, &[&few[..], &["--threads", "2"]].concat()),
        reported
    );
    let reported = json(&reported);
    assert_eq!(reported["warnings"].as_array().map(Vec::len), Some(0));
    let names = reported["coords"]["quantity"]["data"]
        .as_array()
        .expect("names")
        .clone();
    let place = |name: &str| {
        names
            .iter()
            .position(|known| known == name)
            .expect("a quantity")
    };
    let expected = |name: &str| reported["data_vars"]["expected"]["data"][place(name)].as_f64();
    // The shipped measurements have 112 slips of 0.497 mm each in 300 days.
    let slips = expected("slips").expect("slips");
    assert!((100.0..230.0).contains(&slips), "{slips}");
    let jump = expected("sliding_path").expect("a path") / slips;
    assert!((jump / 4.97e-4 - 1.0).abs() < 0.05, "{jump}");
    // Friction is at most f_s = 4.69e5 N.
    let force = expected("force_abs_max").expect("a force");
    assert!((force / 4.69e5 - 1.0).abs() < 0.05, "{force}");
    let csv = fs::read_to_string(path.join("years.csv")).expect("years");
    assert_eq!(csv.lines().count(), 1 + 4 * 3);
    assert!(csv.starts_with("draw,year,sliding_path_m,slips,"), "{csv}");

    for other in ["a.csv", "./a.csv"] {
        refused(
            path,
            &["forecast", BEARING, DATA, "-o", "a.csv", "-o", other],
            2,
            &["is given twice", "fix: "],
        );
    }
    let soft = fs::read_to_string(BEARING)
        .expect("a bearing")
        .replace("stiffness = 2.0e9\n", "");
    fs::write(path.join("soft.toml"), soft).expect("written");
    let without = [
        "forecast",
        "soft.toml",
        DATA,
        "--draws",
        "4",
        "--years",
        "3",
        "--json",
    ];
    let known = json(&done(path, &without))["coords"]["quantity"]["data"].to_string();
    assert!(
        !known.contains("force_abs_max") && known.contains("slips"),
        "{known}"
    );
}

/// The remedy for a forecast that cannot be made is a longer measurement: it has neither the
/// methods of a calibration nor the periods of a fit.
#[test]
fn a_forecast_that_cannot_be_says_what_to_measure() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let text = fs::read_to_string(DATA).expect("the twin");
    let lines = |count: usize| {
        text.lines()
            .take(1 + count)
            .map(|line| format!("{line}\n"))
            .collect::<String>()
    };
    fs::write(path.join("season.csv"), lines(90 * 144)).expect("written");
    let held = [
        "--set",
        "friction.static=1e9",
        "--set",
        "friction.dynamic=9e8",
    ];
    done(
        path,
        &[&["twin", TRUTH, "-o", "still.csv"], &held[..]].concat(),
    );
    for (data, says) in [
        ("season.csv", "measure for at least half a year"),
        ("still.csv", "measure for longer"),
    ] {
        let refused = mc(path, &["forecast", BEARING, data]);
        let said = String::from_utf8_lossy(&refused.stderr);
        assert_eq!(refused.status.code(), Some(1), "{said}");
        assert!(
            said.contains(says) && !said.contains("--periods") && !said.contains("--method"),
            "{said}"
        );
    }
}
