//! The commit that the program is built from, as the variable `STICKSLIP_COMMIT` of the compiler.

use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = output
        .status
        .success()
        .then(|| String::from_utf8(output.stdout).ok())??;
    Some(text.trim().to_string())
}

fn main() {
    // Git writes a line to this log whenever HEAD moves.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
    let is_tracked = git(&["ls-files", "--error-unmatch", "Cargo.toml"]).is_some();
    let commit = is_tracked
        .then(|| {
            git(&[
                "describe",
                "--always",
                "--exclude=*",
                "--dirty",
                "--abbrev=12",
            ])
        })
        .flatten();
    println!(
        "cargo::rustc-env=STICKSLIP_COMMIT={}",
        commit.as_deref().unwrap_or("unknown")
    );
}
