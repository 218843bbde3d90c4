//! The commit that a program is built from, for its `main`. It is "unknown" without git, or outside
//! the repository of this package. Where the commit does not say what the program was built from, a
//! fingerprint of the sources follows: two programs of different sources must not pass for the
//! same, because their numbers may differ.

use proc_macro::TokenStream;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the program is built from. `target` is not among it, because it changes with every build.
const SOURCES: [&str; 5] = ["Cargo.toml", "Cargo.lock", "packages", "src", "scenarios"];

/// The commit as a text. The argument is the path from the package that is compiled to the folder
/// of the sources, such as `".."`.
///
/// What is compiled with the text is compiled again after every commit, and whenever the library
/// is, on which it depends.
#[proc_macro]
pub fn commit(from: TokenStream) -> TokenStream {
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let root = package.join(from.to_string().trim_matches('"'));
    let text = match commit_of(&root) {
        Some((hash, false)) => hash,
        Some((hash, true)) => format!("{hash}-dirty-{}", fingerprint(&root)),
        None => format!("unknown-{}", fingerprint(&root)),
    };
    // Git writes a line to this log whenever HEAD moves.
    let log = git(&root, &["rev-parse", "--git-path", "logs/HEAD"]).map(|path| root.join(path));
    let watch = log
        .filter(|log| log.is_file())
        .and_then(|log| log.canonicalize().ok())
        .map_or_else(String::new, |log| format!("const _: &[u8] = include_bytes!({log:?});"));
    format!("{{ {watch} {text:?} }}").parse().unwrap_or_default()
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
fn commit_of(root: &Path) -> Option<(String, bool)> {
    // An unpacked copy of this package inside another repository has no commit of its own.
    let top = git(root, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    let hash = git(root, &["rev-parse", "--short=12", "HEAD"])?;
    let sources = [&["status", "--porcelain", "--untracked-files=no", "--"], &SOURCES[..]].concat();
    let changes = git(root, &sources)?;
    Some((hash, !changes.is_empty()))
}

fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let mut git = Command::new("git");
    git.current_dir(root).args(arguments).env("GIT_OPTIONAL_LOCKS", "0");
    // Git sets these variables inside a hook, where they would select the repository of the hook.
    git.env_remove("GIT_DIR").env_remove("GIT_WORK_TREE").env_remove("GIT_INDEX_FILE");
    let output = git.output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_string())
}
