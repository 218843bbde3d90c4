//! `mc report`: a page is either refused or complete. tests/browser.sh tests it in a browser.

use crate::command::{done, mc};
use stickslip_text::numbers::significant;

const RHO025: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/rho025.toml");

#[test]
fn a_page_is_whole_and_asks_for_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let title = "title=\"</script><script>window.stolen=1</script> {{data}} <!--\"";
    let run = [
        "run", RHO025, "--paths", "512", "--quiet", "--set", title, "-o", "run.h5",
    ];
    assert!(mc(folder.path(), &run).status.success());
    for name in ["a.html", "b.html"] {
        let output = mc(folder.path(), &["report", "run.h5", "-o", name]);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    let page = std::fs::read_to_string(folder.path().join("a.html")).expect("UTF-8");
    assert_eq!(
        page,
        std::fs::read_to_string(folder.path().join("b.html")).expect("UTF-8")
    );
    assert!(
        page.len() < 1_000_000 && page.ends_with("</html>\n"),
        "{}",
        page.len()
    );
    assert_eq!(
        (
            page.matches("<script").count(),
            page.matches("</script>").count()
        ),
        (0, 0)
    );
    assert!(
        page.contains("default-src 'none'")
            && page.contains("Warnings")
            && page.contains("{{data}} &lt;!--")
    );
    for statistic in stickslip::stats::Statistic::asked_by(&stickslip::stats::Record::NOTHING) {
        assert!(
            page.contains(&format!(
                "<td data-heading=\"statistic\">{}</td>",
                statistic.words()
            )),
            "{}",
            statistic.name()
        );
    }
    assert!(page.contains("<figcaption>Stick durations</figcaption>"));
    assert_eq!(page.matches("src=\"data:image/svg+xml;base64,").count(), 5);
    assert!(
        page.contains("<code>mc show run.h5 --format csv</code>") && page.contains("How to cite")
    );
}

/// A sweep, a trade, a calibration and a forecast have pages without scripts, with their tables and
/// pictures; those of a bearing speak of a year, in dates and in words.
#[test]
fn every_file_has_a_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let bridge = |name: &str| {
        format!(
            "{}/../../examples/bridge/{name}",
            env!("CARGO_MANIFEST_DIR")
        )
    };
    let (scenario, data) = (bridge("bridge.toml"), bridge("twin.csv"));
    done(
        path,
        &[
            "sweep",
            RHO025,
            "--vary",
            "friction.static=1.0:1.2:3",
            "--paths",
            "200",
            "-o",
            "sweep.h5",
        ],
    );
    done(path, &["trade", RHO025, "--budget", "2s", "-o", "trade.h5"]);
    done(
        path,
        &[
            "calibrate",
            &scenario,
            &data,
            "--method",
            "slips",
            "-o",
            "fit.h5",
        ],
    );
    for file in ["sweep", "trade", "fit"] {
        done(path, &["report", &format!("{file}.h5")]);
    }
    let few = [
        "--draws",
        "4",
        "--years",
        "3",
        "--title",
        "Pier 7",
        "-o",
        "year.html",
        "-o",
        "years.csv",
    ];
    done(path, &[&["forecast", &scenario, &data], &few[..]].concat());
    let of_bearing = [
        "slips were detected",
        "2015-08-13 to 2016-06-07",
        "friction force at which the bearing slips",
        "Traffic",
    ];
    let years = std::fs::read_to_string(path.join("years.csv")).expect("UTF-8");
    let paths: Vec<f64> = (years.lines().skip(1))
        .map(|line| {
            line.split(',')
                .nth(2)
                .expect("a path")
                .parse()
                .expect("a number")
        })
        .collect();
    let mean_path = paths.iter().sum::<f64>() / paths.len() as f64;
    let sweep = std::fs::read_to_string(path.join("sweep.html")).expect("UTF-8");
    assert!(
        sweep.find("<img") < sweep.find("<table"),
        "the picture is first"
    );
    for (page, says) in [
        (
            "sweep.html",
            &["mean stick duration", "(varied: friction.static)"][..],
        ),
        ("trade.html", &["Cheapest runs"]),
        (
            "fit.html",
            &[&of_bearing[..], &["The joint moves"]].concat(),
        ),
        (
            "year.html",
            &[
                &of_bearing[..],
                &[
                    "In a typical year the bearing slides",
                    "<th>90 % range of one year</th>",
                    "data-heading=\"mean\"",
                    "z is the reading of the displacement sensor",
                    "largest force |F| on the pier (kN)",
                    "alt=\"Years to come: Pier 7",
                    "<title>Pier 7",
                    &format!("slides {} mm", significant(1e3 * mean_path, 3)),
                ],
            ]
            .concat(),
        ),
    ] {
        let text = std::fs::read_to_string(path.join(page)).expect("UTF-8");
        assert!(
            text.ends_with("</html>\n") && !text.contains("<script"),
            "{page}"
        );
        assert!(
            text.contains("src=\"data:image/svg+xml;base64,") && !text.contains("{{"),
            "{page}"
        );
        says.iter()
            .for_each(|words| assert!(text.contains(words), "{page}: {words}"));
        assert!(
            !text.contains(" to -"),
            "{page}: a range without minus signs"
        );
    }
    let other = mc(path, &["forecast", &scenario, &data, "-o", "years.txt"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&other.stderr).contains("use .csv or .html"));
}

#[test]
fn what_is_no_run_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("old.html"), "mine").expect("written");
    for (arguments, says) in [
        (&["old.h5"][..], "old.html already exists"),
        (&["absent.h5", "-o", "a.html"], "absent.h5"),
        (&["old.html", "-o", "a.html"], "not an HDF5 file"),
    ] {
        let output = mc(folder.path(), &[&["report"], arguments].concat());
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            (output.status.code(), error.contains(says)),
            (Some(2), true),
            "{says}: {error}"
        );
    }
    assert_eq!(
        std::fs::read_to_string(folder.path().join("old.html")).expect("kept"),
        "mine"
    );
}

/// A citation distinguishes a run from other runs, and is the same for the same run.
#[test]
fn a_citation_names_program_scenario_scheme_seed_and_paths() {
    let folder = tempfile::tempdir().expect("a folder");
    let cited = |name: &str, more: &[&str]| {
        let run = [
            &[
                "run",
                RHO025,
                "--paths",
                "256",
                "--quiet",
                "--no-bias",
                "-o",
                name,
            ][..],
            more,
        ]
        .concat();
        assert!(mc(folder.path(), &run).status.success());
        let output = mc(folder.path(), &["show", "--cite", name]);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        String::from_utf8(output.stdout).expect("UTF-8")
    };
    let first = cited("a.h5", &["--threads", "1"]);
    assert_eq!(first, cited("b.h5", &["--threads", "2"]));
    let file = hdf5::File::open(folder.path().join("a.h5")).expect("HDF5");
    let attribute = |name: &str| {
        let text = file
            .attr(name)
            .and_then(|a| a.read_scalar::<hdf5::types::VarLenUnicode>())
            .expect("a text");
        text.as_str().to_string()
    };
    use sha2::Digest as _;
    let hash: String = sha2::Sha256::digest(attribute("scenario"))
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let lines: Vec<&str> = first.lines().collect();
    let run = format!(
        "stick-slip (mc) {} ({}), scenario \"{}\" (SHA-256 {}), scheme discrete-vi, step 0.01, seed 1, 256 paths.",
        env!("CARGO_PKG_VERSION"),
        attribute("git_hash"),
        attribute("title"),
        &hash[..16]
    );
    assert_eq!(lines[0], run);
    assert!(
        lines.len() == 2 && lines[1].contains("A. Bensoussan"),
        "{first}"
    );
    for (name, other) in [
        ("c.h5", ["--seed", "2"]),
        ("d.h5", ["--set", "friction.static=1.3"]),
    ] {
        let other = cited(name, &other);
        assert_ne!(
            other.split("SHA-256").nth(1),
            first.split("SHA-256").nth(1),
            "{other}"
        );
    }
}
