//! `mc plot`: the pictures of docs/pictures.md are reproduced, equal pictures have equal bytes, and
//! what cannot be drawn is refused with a reason.

use crate::command::mc;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// A folder with links to the scenarios and the examples.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for seen in ["scenarios", "examples"] {
        std::os::unix::fs::symlink(root().join(seen), folder.path().join(seen)).expect("linked");
    }
    folder
}

#[track_caller]
fn done(folder: &Path, arguments: &[&str]) {
    let output = mc(folder, arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(
        output.status.code(),
        Some(0),
        "mc {}: {error}",
        arguments.join(" ")
    );
}

/// The width, the height, and the three channels of every pixel.
fn pixels(path: &Path) -> (usize, usize, Vec<u8>) {
    let file = std::io::BufReader::new(
        std::fs::File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())),
    );
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("it fits")];
    let info = reader.next_frame(&mut bytes).expect("a picture");
    assert_eq!(info.color_type, png::ColorType::Rgb);
    (info.width as usize, info.height as usize, bytes)
}

/// The side of a block of pixels whose means are compared.
const BLOCK: usize = 4;
/// Two blocks differ if their means differ by more than this, out of 255.
const LEVELS: f64 = 16.0;
/// The share of blocks that may differ, because rasterisers on other processors round the edges of
/// letters differently. A label that moves by a point, or a curve with other dashes, changes ten
/// times as many.
const SHARE: f64 = 3e-4;

/// The share of blocks that differ.
fn difference(one: &Path, other: &Path) -> f64 {
    let ((width, height, one), (other_width, other_height, other)) = (pixels(one), pixels(other));
    assert_eq!(
        (width, height),
        (other_width, other_height),
        "the sizes differ"
    );
    let (columns, rows) = (width / BLOCK, height / BLOCK);
    let mean = |bytes: &[u8], x: usize, y: usize, channel: usize| {
        let at = |i: usize, j: usize| {
            f64::from(bytes[3 * ((BLOCK * y + j) * width + BLOCK * x + i) + channel])
        };
        let sum: f64 = (0..BLOCK)
            .flat_map(|j| (0..BLOCK).map(move |i| (i, j)))
            .map(|(i, j)| at(i, j))
            .sum();
        sum / (BLOCK * BLOCK) as f64
    };
    let differs = |x: usize, y: usize| {
        (0..3).any(|c| (mean(&one, x, y, c) - mean(&other, x, y, c)).abs() > LEVELS)
    };
    let count = (0..rows)
        .flat_map(|y| (0..columns).map(move |x| (x, y)))
        .filter(|(x, y)| differs(*x, *y))
        .count();
    count as f64 / (columns * rows) as f64
}

/// docs/pictures.sh lists the commands that draw the pictures; its lines are run here.
#[test]
fn the_pictures_of_the_documentation_come_out_again() {
    let folder = folder();
    let script = std::fs::read_to_string(root().join("docs/pictures.sh")).expect("the script");
    for line in script
        .lines()
        .filter_map(|line| line.strip_prefix("mc "))
        .filter(|line| !line.starts_with("()"))
    {
        done(folder.path(), &line.split_whitespace().collect::<Vec<_>>());
    }
    let drawn: Vec<PathBuf> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "png"))
        .collect();
    assert_eq!(drawn.len(), 31);
    for path in drawn {
        let kept = root()
            .join("docs/pictures")
            .join(path.file_name().expect("a name"));
        let share = difference(&path, &kept);
        println!("{}: {share:.1e}", kept.display());
        assert!(
            share <= SHARE,
            "{}: {share:.1e} of it differ; docs/pictures.sh draws it again",
            kept.display()
        );
    }
}

/// The bytes are equal in two processes, in each format, and for a file and the scenario that it
/// was run from.
#[test]
fn equal_pictures_have_equal_bytes() {
    let folder = folder();
    let path = folder.path();
    let run = [
        "run",
        "scenarios/rho025.toml",
        "--paths",
        "256",
        "--no-bias",
        "--quiet",
        "-o",
        "run.h5",
    ];
    done(path, &run);
    for (ending, start) in [
        ("svg", &b"<svg"[..]),
        ("png", b"\x89PNG"),
        ("pdf", b"%PDF-"),
    ] {
        let read = |name: &str| std::fs::read(path.join(name)).expect("drawn");
        let names = ["a", "b"].map(|name| format!("{name}.{ending}"));
        for name in &names {
            done(path, &["plot", "run.h5", "-o", name]);
        }
        assert!(
            read(&names[0]).starts_with(start) && read(&names[0]) == read(&names[1]),
            "{ending}"
        );
    }
    done(
        path,
        &[
            "plot", "run.h5", "--only", "path", "--path", "41", "-o", "file.svg",
        ],
    );
    done(
        path,
        &[
            "plot",
            "scenarios/rho025.toml",
            "--only",
            "path",
            "--path",
            "41",
            "-o",
            "scenario.svg",
        ],
    );
    let [file, scenario] = ["file.svg", "scenario.svg"]
        .map(|name| std::fs::read_to_string(path.join(name)).expect("drawn"));
    assert!(
        file == scenario,
        "the path of the ensemble is that of the scenario"
    );
}

#[test]
fn what_cannot_be_drawn_is_refused_in_words() {
    let folder = folder();
    let path = folder.path();
    done(
        path,
        &["run", "scenarios/shaw.toml", "--quiet", "-o", "run.h5"],
    );
    std::fs::write(path.join("old.svg"), "mine").expect("written");
    std::fs::write(path.join("torn.h5"), b"\x89HDF\r\n\x1a\nand then nothing").expect("written");
    let never = [
        "run",
        "scenarios/never-slips.toml",
        "--quiet",
        "--paths",
        "2",
        "-o",
        "never.h5",
    ];
    done(path, &never);
    for (arguments, code, says) in [
        (
            &["run.h5", "-o", "old.svg"][..],
            2,
            "old.svg already exists",
        ),
        (&["run.h5", "-o", "picture.jpg"], 2, ".svg, .png or .pdf"),
        (&["run.h5", "--only", "ventilator"], 2, "path, fan, sticks"),
        (
            &["run.h5", "--only", "path.D"],
            2,
            "no panel D; panels are A to C",
        ),
        (
            &["run.h5", "--only", "path.b"],
            2,
            "panels are named by capital letters",
        ),
        (&["run.h5", "--width", "5"], 2, "between 60 and 400"),
        (&["run.h5", "--theme", "pink"], 2, "light or dark"),
        (&["run.h5", "--path", "1"], 2, "the ensemble has 1 path\n"),
        (&["run.h5", "--only", "trade"], 2, "the result of a trade"),
        (
            &["run.h5", "--set", "friction.static=2"],
            2,
            "is a finished run",
        ),
        (
            &["scenarios/shaw.toml", "--only", "fan"],
            2,
            "the result of a run",
        ),
        (&["scenarios/shaw.toml", "--until", "-1"], 2, "time.end"),
        (&["scenarios/absent.toml"], 2, "absent.toml"),
        (&["torn.h5"], 1, "torn.h5"),
        (&["never.h5", "--only", "sticks"], 1, "no stick"),
        (
            &["never.h5", "--only", "passages"],
            1,
            "set statistics.levels",
        ),
        (&["never.h5", "--only", "sub-phases"], 1, "no slip"),
        (&["run.h5", "-o", "absent/a.svg"], 2, "the directory absent"),
    ] {
        let output = mc(path, &[&["plot"], arguments].concat());
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            (output.status.code(), error.contains(says)),
            (Some(code), true),
            "{says}: {error}"
        );
        assert!(!error.contains("panicked"), "{error}");
    }
    assert_eq!(
        std::fs::read_to_string(path.join("old.svg")).expect("kept"),
        "mine"
    );
}

/// Slips on the belt have one sub-phase, so the share of longer ones is zero everywhere.
#[test]
fn a_sweep_draws_no_statistic_that_is_zero_everywhere() {
    let folder = folder();
    let vary = "temperature.trend=0.1,0.2";
    let sweep = [
        "sweep", "belt", "--vary", vary, "--paths", "20", "--quiet", "-o", "a.h5",
    ];
    done(folder.path(), &sweep);
    done(folder.path(), &["plot", "a.h5", "-o", "a.svg"]);
    let svg = std::fs::read_to_string(folder.path().join("a.svg")).expect("drawn");
    assert!(svg.contains(": mean stick duration, share of time spent static</title>"));
}

/// A path of every shipped scene, with its units and scales, can be drawn in both themes, and its
/// texts are valid XML.
#[test]
fn every_shipped_scene_can_be_drawn() {
    let folder = folder();
    for entry in std::fs::read_dir(root().join("scenarios")).expect("scenarios") {
        let name = entry
            .expect("readable")
            .file_name()
            .to_string_lossy()
            .into_owned();
        if !name.ends_with(".toml") {
            continue;
        }
        let scenario = format!("scenarios/{name}");
        let title = "title=\"<b> & \\\"quoted\\\" \u{1d54f} 50 %\"";
        done(
            folder.path(),
            &[
                "plot", &scenario, "--set", title, "--theme", "dark", "-o", "a.svg", "--force",
            ],
        );
        let svg = std::fs::read_to_string(folder.path().join("a.svg")).expect("drawn");
        assert!(
            svg.contains("&lt;b&gt; &amp; &quot;quoted&quot; \u{1d54f} 50 %</title>"),
            "{name}"
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
        // A PNG is rasterised from the SVG, so this also tests that the SVG can be parsed.
        done(
            folder.path(),
            &["plot", &scenario, "--set", title, "-o", "a.png", "--force"],
        );
    }
}
