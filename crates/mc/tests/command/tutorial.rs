//! The tutorial on a bearing: its commands run one after another as they are printed on the page,
//! and print what the page shows.

use std::path::Path;
use std::process::Command;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The code blocks of a page: language and text.
fn blocks(page: &str) -> Vec<(String, String)> {
    let mut blocks = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in page.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(language)) => open = Some((language.to_string(), String::new())),
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some((_, text)), None) => *text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    blocks
}

/// The output of commands in a folder with the examples of the repository, with `mc` on the path.
fn printed(commands: &str, folder: &Path) -> String {
    let bin = Path::new(env!("CARGO_BIN_EXE_mc"))
        .parent()
        .expect("a folder");
    let path = format!(
        "{}:{}",
        bin.display(),
        std::env::var("PATH").expect("a path")
    );
    let output = Command::new("bash")
        .args(["-ec", commands])
        .current_dir(folder)
        .env("PATH", path)
        .output();
    let output = output.expect("bash runs");
    assert!(
        output.status.success(),
        "{commands}\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("text")
}

#[test]
fn every_command_of_the_tutorial_runs_and_prints_what_it_says() {
    let page = std::fs::read_to_string(Path::new(ROOT).join("docs/bearing/tutorial.md"))
        .expect("the page");
    let folder = tempfile::tempdir().expect("a folder");
    std::os::unix::fs::symlink(
        Path::new(ROOT).join("examples"),
        folder.path().join("examples"),
    )
    .expect("a link");
    let (mut said, mut commands, mut compared) = (String::new(), 0, 0);
    for (language, text) in blocks(&page) {
        match language.as_str() {
            "sh" => {
                said = printed(&text, folder.path());
                commands += text.lines().count();
            }
            "text" => {
                assert!(
                    said.contains(&text),
                    "the page says\n{text}\nand the command prints\n{said}"
                );
                compared += 1;
            }
            other => panic!("a block of {other}"),
        }
    }
    assert_eq!((commands, compared), (10, 4));
    for file in ["fit.svg", "year.h5", "years.csv", "twin-1.csv"] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
}
