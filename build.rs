//! Makes the commit available to the program as MC_GIT_HASH. It is "unknown" without git, or
//! outside the repository of this package. Where the commit does not say what the program was built
//! from, a fingerprint of the sources follows: two programs of different sources must not pass for
//! the same, because their numbers may differ.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the program is built from. `target` is not among it, because it changes with every build.
const SOURCES: [&str; 5] = ["build.rs", "Cargo.toml", "Cargo.lock", "src", "scenarios"];

fn main() {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    for watched in SOURCES {
        watch(&root.join(watched));
    }
    let hash = match commit(&root) {
        Some((hash, false)) => hash,
        Some((hash, true)) => format!("{hash}-dirty-{}", fingerprint(&root)),
        None => format!("unknown-{}", fingerprint(&root)),
    };
    println!("cargo:rustc-env=MC_GIT_HASH={hash}");
}

/// A fingerprint of the sources, FNV-1a of their names and contents in 64 bits.
fn fingerprint(root: &Path) -> String {
    let mut files: Vec<PathBuf> = Vec::new();
    SOURCES.iter().for_each(|source| list(&root.join(source), &mut files));
    files.sort();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bytes: &[u8]| {
        for byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for file in &files {
        add(file.strip_prefix(root).unwrap_or(file).as_os_str().as_encoded_bytes());
        add(&fs::read(file).unwrap_or_default());
    }
    format!("{hash:016x}")
}

/// Adds a file, or all files of a folder.
fn list(path: &Path, files: &mut Vec<PathBuf>) {
    match fs::read_dir(path) {
        Ok(entries) => entries.flatten().for_each(|entry| list(&entry.path(), files)),
        Err(_) if path.is_file() => files.push(path.to_owned()),
        Err(_) => {}
    }
}

/// The commit, and whether the sources are others than its own.
fn commit(root: &Path) -> Option<(String, bool)> {
    // An unpacked copy of this package inside another repository has no commit of its own.
    let top = git(root, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    let branch = git(root, &["symbolic-ref", "-q", "HEAD"]);
    // The log changes with every commit, even if the branch has no file of its own because it is
    // packed.
    for name in ["HEAD", "logs/HEAD", "packed-refs"].into_iter().chain(branch.as_deref()) {
        if let Some(path) = git(root, &["rev-parse", "--git-path", name]) {
            watch(&root.join(path));
        }
    }
    let hash = git(root, &["rev-parse", "--short=12", "HEAD"])?;
    let changes = git(root, &["status", "--porcelain", "--untracked-files=no"])?;
    Some((hash, !changes.is_empty()))
}

/// Makes cargo run this script again when the path changes. A path that does not exist is left out,
/// because cargo would run the script at every build.
fn watch(path: &Path) {
    if path.exists() {
        println!("cargo:rerun-if-changed={}", path.display());
    }
}

fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let mut git = Command::new("git");
    git.current_dir(root).args(arguments).env("GIT_OPTIONAL_LOCKS", "0");
    // Git sets these variables inside a hook, where they would select the repository of the hook.
    git.env_remove("GIT_DIR").env_remove("GIT_WORK_TREE").env_remove("GIT_INDEX_FILE");
    let output = git.output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_string())
}
