//! Files by others that are part of the program: they are unchanged, and their licences are beside
//! them.

use std::path::Path;
use std::process::Command;

fn assets() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../figure/assets")
}

#[test]
fn no_asset_has_changed() {
    let checked = Command::new("sha256sum")
        .args(["--check", "--strict", "SHA256SUMS"])
        .current_dir(assets())
        .output();
    let checked = checked.expect("sha256sum of the core utilities");
    assert!(
        checked.status.success(),
        "{}{}",
        String::from_utf8_lossy(&checked.stdout),
        String::from_utf8_lossy(&checked.stderr)
    );
}

#[test]
fn every_asset_has_a_hash_and_every_folder_a_licence() {
    let sums = std::fs::read_to_string(assets().join("SHA256SUMS")).expect("the hashes");
    let folders = std::fs::read_dir(assets())
        .expect("assets")
        .map(|entry| entry.expect("readable").path());
    for folder in folders.filter(|path| path.is_dir()) {
        let name = folder
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let files = std::fs::read_dir(&folder)
            .expect("a folder")
            .map(|entry| entry.expect("readable").file_name());
        let files: Vec<String> = files
            .map(|file| file.to_string_lossy().into_owned())
            .collect();
        assert!(
            files.iter().any(|file| file.starts_with("LICENSE")),
            "{name} has no licence"
        );
        for file in files {
            assert!(
                sums.lines()
                    .any(|line| line.ends_with(&format!("  {name}/{file}"))),
                "{name}/{file} has no hash"
            );
        }
    }
}
