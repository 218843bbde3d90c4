//! Makes the commit available to the program as MC_GIT_HASH. It is "unknown" without git, or
//! outside the repository of this package.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    // The files whose changes make a commit "-dirty". `target` is not among them, because it
    // changes with every build.
    for watched in ["build.rs", "Cargo.toml", "Cargo.lock", "src", "scenarios"] {
        watch(&root.join(watched));
    }
    let hash = commit(&root).unwrap_or_else(|| "unknown".into());
    println!("cargo:rustc-env=MC_GIT_HASH={hash}");
}

fn commit(root: &Path) -> Option<String> {
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
    Some(if changes.is_empty() { hash } else { format!("{hash}-dirty") })
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
