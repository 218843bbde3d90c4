//! Puts the commit into the program: MC_GIT_HASH, "unknown" without git or outside the repository
//! of this package.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    // What "-dirty" speaks of; `target` must not be watched, it changes with every build.
    for watched in ["build.rs", "Cargo.toml", "Cargo.lock", "src", "scenarios"] {
        watch(&root.join(watched));
    }
    let hash = commit(&root).unwrap_or_else(|| "unknown".into());
    println!("cargo:rustc-env=MC_GIT_HASH={hash}");
}

fn commit(root: &Path) -> Option<String> {
    // An unpacked copy inside somebody else's repository has no commit of its own.
    let top = git(root, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    let branch = git(root, &["symbolic-ref", "-q", "HEAD"]);
    // The log moves with every commit, even where the branch has no file of its own because it is
    // packed.
    for name in ["HEAD", "logs/HEAD", "packed-refs"].into_iter().chain(branch.as_deref()) {
        if let Some(path) = git(root, &["rev-parse", "--git-path", name]) {
            watch(&root.join(path));
        }
    }
    let hash = git(root, &["rev-parse", "--short=12", "HEAD"])?;
    let changes = git(root, &["status", "--porcelain", "--untracked-files=no"])?;
    Some(if changes.is_empty() { hash } else { format!("{hash}-dirty") })
}

/// Run again when this changes. A path that does not exist would make every build run it.
fn watch(path: &Path) {
    if path.exists() {
        println!("cargo:rerun-if-changed={}", path.display());
    }
}

fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let mut git = Command::new("git");
    git.current_dir(root).args(arguments).env("GIT_OPTIONAL_LOCKS", "0");
    // Set inside a git hook, where they would point at the hook's repository.
    git.env_remove("GIT_DIR").env_remove("GIT_WORK_TREE").env_remove("GIT_INDEX_FILE");
    let output = git.output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_string())
}
